//! Dormand and Prince's method of order eight, with error control.

use super::{Method, adaptive};
use crate::ode::DormandPrince8;

pub(super) static METHOD: Method = Method {
    name: "dop853",
    title: "Dormand-Prince 8(5,3)",
    order: 8,
    stability: "as many steps within dt as stability and the tolerance ask for",
    source: "Hairer, Nørsett, Wanner 1993, Solving Ordinary Differential Equations I, sec. II.5 and II.10",
    symplectic: false,
    reversible: false,
    adaptive: true,
    fall: Some(0.5),
    step: adaptive::step::<DormandPrince8>,
};
