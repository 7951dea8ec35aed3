//! A spring and a damper to a fixed point.

use glam::{DMat3, DVec3};

use super::{
    BodyLaw, BodyMotion, Force,
    described::{Description, Field, Nature, Tie},
    law::{BuiltIn, OneBody},
    vectors::{spring, spring_energy, spring_slope},
};
use crate::Jacobians;

pub(super) const START: Force = Force::Anchor {
    body: 0,
    point: None,
    anchor: DVec3::Y,
    rest_length: 1.0,
    stiffness: 10.0,
    damping: 0.0,
};

#[derive(Debug)]
pub(super) struct Anchor {
    pub(super) body: usize,
    pub(super) point: Option<DVec3>,
    pub(super) anchor: DVec3,
    pub(super) rest_length: f64,
    pub(super) stiffness: f64,
    pub(super) damping: f64,
}

impl BodyLaw for Anchor {
    #[inline]
    fn force(&self, at: &BodyMotion) -> DVec3 {
        let pull = spring(self.stiffness, self.rest_length, at.position - self.anchor);
        -pull - self.damping * at.velocity
    }

    fn jacobians(&self, at: &BodyMotion) -> Jacobians {
        let d = at.position - self.anchor;
        Jacobians {
            position: -spring_slope(self.stiffness, self.rest_length, d),
            velocity: DMat3::from_diagonal(DVec3::splat(-self.damping)),
        }
    }

    fn potential(&self, at: &BodyMotion) -> Option<f64> {
        let d = at.position - self.anchor;
        Some(spring_energy(self.stiffness, self.rest_length, d))
    }
}

impl BuiltIn for Anchor {
    fn description(&self) -> Description {
        Description {
            kind: "anchor",
            title: "Spring to a point",
            law: "F = -k (1 - L/|d|) d - c v, with d from the point to the body",
        }
    }

    fn nature(&self) -> Nature {
        Nature {
            depends_on_velocity: self.damping > 0.0,
            is_unbounded: false,
            dissipates: self.damping > 0.0,
            drives: false,
            tie: Tie::SpringFrom(self.anchor),
        }
    }

    fn fields(&mut self, see: &mut dyn FnMut(Field<'_>)) {
        see(Field::body(&mut self.body));
        see(Field::maybe_point(&mut self.point));
        let about = ["anchor", "Anchor", "m", "The fixed point"];
        see(Field::vector(about, &mut self.anchor));
        see(Field::rest_length(&mut self.rest_length));
        see(Field::stiffness(&mut self.stiffness));
        see(Field::damping(&mut self.damping));
    }

    fn whole(&self) -> Force {
        let &Anchor {
            body,
            point,
            anchor,
            rest_length,
            stiffness,
            damping,
        } = self;
        Force::Anchor {
            body,
            point,
            anchor,
            rest_length,
            stiffness,
            damping,
        }
    }
}

impl OneBody for Anchor {
    fn body(&self) -> Option<usize> {
        Some(self.body)
    }

    fn point(&self) -> Option<DVec3> {
        self.point
    }
}
