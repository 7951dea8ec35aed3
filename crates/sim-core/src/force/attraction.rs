//! Attraction to a fixed point.

use glam::{DMat3, DVec3};

use super::{
    BodyLaw, BodyMotion, Force,
    described::{Description, Field, Nature, Tie},
    law::{BuiltIn, OneBody},
    vectors::{inverse_square, inverse_square_slope, length},
};
use crate::Jacobians;

pub(super) const START: Force = Force::Attraction {
    body: None,
    centre: DVec3::ZERO,
    strength: 1.0,
};

#[derive(Debug)]
pub(super) struct Attraction {
    pub(super) body: Option<usize>,
    pub(super) centre: DVec3,
    pub(super) strength: f64,
}

impl BodyLaw for Attraction {
    #[inline]
    fn force(&self, at: &BodyMotion) -> DVec3 {
        -at.mass * self.strength * inverse_square(at.position - self.centre)
    }

    fn jacobians(&self, at: &BodyMotion) -> Jacobians {
        Jacobians {
            position: -at.mass * self.strength * inverse_square_slope(at.position - self.centre),
            velocity: DMat3::ZERO,
        }
    }

    fn potential(&self, at: &BodyMotion) -> Option<f64> {
        Some(-at.mass * self.strength / length(at.position - self.centre))
    }
}

impl BuiltIn for Attraction {
    fn description(&self) -> Description {
        Description {
            kind: "attraction",
            title: "Attraction to a point",
            law: "F = -m G M / r², to the point",
        }
    }

    fn nature(&self) -> Nature {
        Nature {
            depends_on_velocity: false,
            is_unbounded: true,
            dissipates: false,
            drives: false,
            tie: Tie::Centre(self.centre),
        }
    }

    fn fields(&mut self, see: &mut dyn FnMut(Field<'_>)) {
        see(Field::any_body(&mut self.body));
        let about = ["centre", "Centre", "m", "The point that attracts"];
        see(Field::vector(about, &mut self.centre));
        let about = ["strength", "Strength", "m³/s²", "G M, from 0"];
        see(Field::number(about, 0.0, &mut self.strength));
    }

    fn whole(&self) -> Force {
        let &Attraction {
            body,
            centre,
            strength,
        } = self;
        Force::Attraction {
            body,
            centre,
            strength,
        }
    }
}

impl OneBody for Attraction {
    fn body(&self) -> Option<usize> {
        self.body
    }

    fn point(&self) -> Option<DVec3> {
        None
    }
}
