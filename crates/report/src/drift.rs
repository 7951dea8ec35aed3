//! Energy and momentum over a long time, by every method.

use cases::drift;
use sim_core::{METHODS, Method};

use crate::scope::Scope;

/// What a method does to the invariants of a planet's motion, and to the momentum of seven stars.
#[derive(Debug)]
pub(crate) struct Drift {
    pub(crate) method: &'static Method,
    pub(crate) planet: drift::Drift,
    pub(crate) pleiades: Result<f64, String>,
}

/// Watches every method.
pub(crate) fn measure(scope: Scope) -> Vec<Drift> {
    let drifts = METHODS.into_iter().map(|method| Drift {
        method,
        planet: drift::orbits(method, scope.orbits()),
        pleiades: drift::pleiades(method),
    });
    drifts.collect()
}
