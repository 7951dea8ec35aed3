//! Stokes' drag.

use glam::{DMat3, DVec3};

use super::{
    BodyLaw, BodyMotion, Force,
    described::{Description, Field, Nature, Tie},
    law::{BuiltIn, OneBody},
};
use crate::Jacobians;

pub(super) const START: Force = Force::LinearDrag {
    body: None,
    coefficient: 0.5,
};

#[derive(Debug)]
pub(super) struct LinearDrag {
    pub(super) body: Option<usize>,
    pub(super) coefficient: f64,
}

impl BodyLaw for LinearDrag {
    #[inline]
    fn force(&self, at: &BodyMotion) -> DVec3 {
        -self.coefficient * at.velocity
    }

    fn jacobians(&self, _at: &BodyMotion) -> Jacobians {
        Jacobians {
            velocity: DMat3::from_diagonal(DVec3::splat(-self.coefficient)),
            ..Jacobians::ZERO
        }
    }
}

impl BuiltIn for LinearDrag {
    fn description(&self) -> Description {
        Description {
            kind: "linear-drag",
            title: "Linear drag",
            law: "F = -c v",
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
            "kg/s",
            "c of F = -c v, from 0",
        ];
        see(Field::number(about, 0.0, &mut self.coefficient));
    }

    fn whole(&self) -> Force {
        let &LinearDrag { body, coefficient } = self;
        Force::LinearDrag { body, coefficient }
    }
}

impl OneBody for LinearDrag {
    fn body(&self) -> Option<usize> {
        self.body
    }

    fn point(&self) -> Option<DVec3> {
        None
    }
}
