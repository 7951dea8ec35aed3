//! Newton's drag.

use glam::{DMat3, DVec3};

use super::{
    BodyLaw, BodyMotion, Force,
    described::{Description, Field, Nature, Tie},
    law::{BuiltIn, OneBody},
    vectors::{direction, length, outer},
};
use crate::Jacobians;

pub(super) const START: Force = Force::QuadraticDrag {
    body: None,
    coefficient: 0.1,
};

#[derive(Debug)]
pub(super) struct QuadraticDrag {
    pub(super) body: Option<usize>,
    pub(super) coefficient: f64,
}

impl BodyLaw for QuadraticDrag {
    #[inline]
    fn force(&self, at: &BodyMotion) -> DVec3 {
        -self.coefficient * length(at.velocity) * at.velocity
    }

    fn jacobians(&self, at: &BodyMotion) -> Jacobians {
        let speed = length(at.velocity);
        let along = direction(at.velocity).map_or(DMat3::ZERO, |n| outer(n, n));
        Jacobians {
            velocity: -self.coefficient * speed * (DMat3::IDENTITY + along),
            ..Jacobians::ZERO
        }
    }
}

impl BuiltIn for QuadraticDrag {
    fn description(&self) -> Description {
        Description {
            kind: "quadratic-drag",
            title: "Quadratic drag",
            law: "F = -c |v| v",
        }
    }

    fn nature(&self) -> Nature {
        Nature {
            depends_on_velocity: true,
            is_unbounded: false,
            dissipates: self.coefficient > 0.0,
            drives: false,
            tie: Tie::Nothing,
        }
    }

    fn fields(&mut self, see: &mut dyn FnMut(Field<'_>)) {
        see(Field::any_body(&mut self.body));
        let about = [
            "coefficient",
            "Coefficient",
            "kg/m",
            "c of F = -c |v| v, from 0",
        ];
        see(Field::number(about, 0.0, &mut self.coefficient));
    }

    fn whole(&self) -> Force {
        let &QuadraticDrag { body, coefficient } = self;
        Force::QuadraticDrag { body, coefficient }
    }
}

impl OneBody for QuadraticDrag {
    fn body(&self) -> Option<usize> {
        self.body
    }

    fn point(&self) -> Option<DVec3> {
        None
    }
}
