//! Laws from outside. What they do not say is assumed at its worst.

use glam::DVec3;

use super::{
    BodyLaw, BodyMotion, Force, Law, PairLaw, PairMotion,
    described::{Description, Field, Nature, Tie},
    law::{BuiltIn, OneBody, TwoBodies},
};
use crate::Jacobians;

const DESCRIPTION: Description = Description {
    kind: "custom",
    title: "Custom",
    law: "A law from outside",
};

const NATURE: Nature = Nature {
    depends_on_velocity: true,
    is_unbounded: true,
    dissipates: true,
    drives: true,
    tie: Tie::Nothing,
};

#[derive(Debug)]
pub(super) struct OnBody<'a> {
    pub(super) body: Option<usize>,
    pub(super) law: &'a Law<dyn BodyLaw>,
}

impl BodyLaw for OnBody<'_> {
    #[inline]
    fn force(&self, at: &BodyMotion) -> DVec3 {
        self.law.0.force(at)
    }

    fn jacobians(&self, at: &BodyMotion) -> Jacobians {
        self.law.0.jacobians(at)
    }

    fn potential(&self, at: &BodyMotion) -> Option<f64> {
        self.law.0.potential(at)
    }
}

impl BuiltIn for OnBody<'_> {
    fn description(&self) -> Description {
        DESCRIPTION
    }

    fn nature(&self) -> Nature {
        NATURE
    }

    fn fields(&mut self, see: &mut dyn FnMut(Field<'_>)) {
        see(Field::any_body(&mut self.body));
    }

    fn whole(&self) -> Force {
        Force::Body {
            body: self.body,
            law: self.law.clone(),
        }
    }
}

impl OneBody for OnBody<'_> {
    fn body(&self) -> Option<usize> {
        self.body
    }

    fn point(&self) -> Option<DVec3> {
        None
    }
}

#[derive(Debug)]
pub(super) struct OnPair<'a> {
    pub(super) bodies: Option<[usize; 2]>,
    pub(super) law: &'a Law<dyn PairLaw>,
}

impl PairLaw for OnPair<'_> {
    #[inline]
    fn force(&self, at: &PairMotion) -> DVec3 {
        self.law.0.force(at)
    }

    fn jacobians(&self, at: &PairMotion) -> Jacobians {
        self.law.0.jacobians(at)
    }

    fn potential(&self, at: &PairMotion) -> Option<f64> {
        self.law.0.potential(at)
    }
}

impl BuiltIn for OnPair<'_> {
    fn description(&self) -> Description {
        DESCRIPTION
    }

    fn nature(&self) -> Nature {
        NATURE
    }

    fn fields(&mut self, see: &mut dyn FnMut(Field<'_>)) {
        see(Field::any_bodies(&mut self.bodies));
    }

    fn whole(&self) -> Force {
        Force::Pair {
            bodies: self.bodies,
            law: self.law.clone(),
        }
    }
}

impl TwoBodies for OnPair<'_> {
    fn bodies(&self) -> Option<[usize; 2]> {
        self.bodies
    }

    fn points(&self) -> Option<[DVec3; 2]> {
        None
    }
}
