//! Newton's gravitation.

use glam::{DMat3, DVec3};

use super::{
    Force, PairLaw, PairMotion,
    described::{Description, Field, Nature, Tie},
    law::{BuiltIn, TwoBodies},
    vectors::{dot, inverse_square, inverse_square_slope, length},
};
use crate::Jacobians;

pub(super) const START: Force = Force::Gravitation { constant: 1.0 };

#[derive(Debug)]
pub(super) struct Gravitation {
    pub(super) constant: f64,
}

impl PairLaw for Gravitation {
    #[inline]
    fn force(&self, at: &PairMotion) -> DVec3 {
        self.constant * at.mass[0] * at.mass[1] * inverse_square(at.position)
    }

    fn jacobians(&self, at: &PairMotion) -> Jacobians {
        Jacobians {
            position: self.constant * at.mass[0] * at.mass[1] * inverse_square_slope(at.position),
            velocity: DMat3::ZERO,
        }
    }

    fn potential(&self, at: &PairMotion) -> Option<f64> {
        Some(-self.constant * at.mass[0] * at.mass[1] / length(at.position))
    }
}

impl BuiltIn for Gravitation {
    fn description(&self) -> Description {
        Description {
            kind: "gravitation",
            title: "Gravitation",
            law: "F = G m m / r² between every two bodies",
        }
    }

    fn nature(&self) -> Nature {
        Nature {
            depends_on_velocity: false,
            is_unbounded: true,
            dissipates: false,
            drives: false,
            tie: Tie::Nothing,
        }
    }

    fn fields(&mut self, see: &mut dyn FnMut(Field<'_>)) {
        let about = ["constant", "Constant", "m³/(kg s²)", "G, from 0"];
        see(Field::number(about, 0.0, &mut self.constant));
    }

    fn whole(&self) -> Force {
        let &Gravitation { constant } = self;
        Force::Gravitation { constant }
    }
}

impl TwoBodies for Gravitation {
    fn bodies(&self) -> Option<[usize; 2]> {
        None
    }

    fn points(&self) -> Option<[DVec3; 2]> {
        None
    }

    #[inline]
    fn change(&self, at: &PairMotion, dx: DVec3, _dv: DVec3) -> DVec3 {
        let squared = dot(at.position, at.position);
        let strength = self.constant * at.mass[0] * at.mass[1];
        let cubed = squared * libm::sqrt(squared);
        let along = 3.0 * dot(at.position, dx) / squared;
        strength / cubed * (dx - along * at.position)
    }
}
