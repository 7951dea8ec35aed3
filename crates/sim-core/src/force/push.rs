//! A constant force at a point.

use glam::DVec3;

use super::{
    BodyLaw, BodyMotion, Force,
    described::{Description, Field, Nature, Tie},
    law::{BuiltIn, OneBody},
    vectors::dot,
};
use crate::Jacobians;

pub(super) const START: Force = Force::Push {
    body: 0,
    point: DVec3::ZERO,
    force: DVec3::Y,
};

#[derive(Debug)]
pub(super) struct Push {
    pub(super) body: usize,
    pub(super) point: DVec3,
    pub(super) force: DVec3,
}

impl BodyLaw for Push {
    #[inline]
    fn force(&self, _at: &BodyMotion) -> DVec3 {
        self.force
    }

    fn jacobians(&self, _at: &BodyMotion) -> Jacobians {
        Jacobians::ZERO
    }

    fn potential(&self, at: &BodyMotion) -> Option<f64> {
        Some(-dot(self.force, at.position))
    }
}

impl BuiltIn for Push {
    fn description(&self) -> Description {
        Description {
            kind: "push",
            title: "Push at a point",
            law: "A constant force at a point of the body, with the torque r × F about its centre of mass",
        }
    }

    fn nature(&self) -> Nature {
        Nature {
            depends_on_velocity: false,
            is_unbounded: false,
            dissipates: false,
            drives: false,
            tie: Tie::Nothing,
        }
    }

    fn fields(&mut self, see: &mut dyn FnMut(Field<'_>)) {
        see(Field::body(&mut self.body));
        see(Field::point(&mut self.point));
        let about = ["force", "Force", "N", "The constant force at that point"];
        see(Field::vector(about, &mut self.force));
    }

    fn whole(&self) -> Force {
        let &Push { body, point, force } = self;
        Force::Push { body, point, force }
    }
}

impl OneBody for Push {
    fn body(&self) -> Option<usize> {
        Some(self.body)
    }

    fn point(&self) -> Option<DVec3> {
        Some(self.point)
    }
}
