//! A spring and a damper between two bodies.

use glam::DVec3;

use super::{
    Force, PairLaw, PairMotion,
    described::{Description, Field, Nature, Tie},
    law::{BuiltIn, TwoBodies},
    vectors::{along, along_slopes, dot, spring, spring_energy, spring_slope},
};
use crate::Jacobians;

pub(super) const START: Force = Force::Spring {
    bodies: [0, 1],
    points: None,
    rest_length: 1.0,
    stiffness: 10.0,
    damping: 0.0,
};

#[derive(Debug)]
pub(super) struct Spring {
    pub(super) bodies: [usize; 2],
    pub(super) points: Option<[DVec3; 2]>,
    pub(super) rest_length: f64,
    pub(super) stiffness: f64,
    pub(super) damping: f64,
}

impl PairLaw for Spring {
    #[inline]
    fn force(&self, at: &PairMotion) -> DVec3 {
        spring(self.stiffness, self.rest_length, at.position)
            + self.damping * along(at.position, at.velocity)
    }

    fn jacobians(&self, at: &PairMotion) -> Jacobians {
        let (of_position, of_velocity) = along_slopes(at.position, at.velocity);
        Jacobians {
            position: spring_slope(self.stiffness, self.rest_length, at.position)
                + self.damping * of_position,
            velocity: self.damping * of_velocity,
        }
    }

    fn potential(&self, at: &PairMotion) -> Option<f64> {
        Some(spring_energy(self.stiffness, self.rest_length, at.position))
    }
}

impl BuiltIn for Spring {
    fn description(&self) -> Description {
        Description {
            kind: "spring",
            title: "Spring between bodies",
            law: "F = k (|d| - L) + c d|d|/dt along the line d: the stretch and its rate",
        }
    }

    fn nature(&self) -> Nature {
        Nature {
            depends_on_velocity: self.damping > 0.0,
            is_unbounded: false,
            dissipates: self.damping > 0.0,
            drives: false,
            tie: Tie::SpringBetween,
        }
    }

    fn fields(&mut self, see: &mut dyn FnMut(Field<'_>)) {
        see(Field::bodies(&mut self.bodies));
        see(Field::maybe_points(&mut self.points));
        see(Field::rest_length(&mut self.rest_length));
        see(Field::stiffness(&mut self.stiffness));
        see(Field::damping(&mut self.damping));
    }

    fn whole(&self) -> Force {
        let &Spring {
            bodies,
            points,
            rest_length,
            stiffness,
            damping,
        } = self;
        Force::Spring {
            bodies,
            points,
            rest_length,
            stiffness,
            damping,
        }
    }
}

impl TwoBodies for Spring {
    fn bodies(&self) -> Option<[usize; 2]> {
        Some(self.bodies)
    }

    fn points(&self) -> Option<[DVec3; 2]> {
        self.points
    }

    #[inline]
    fn change(&self, at: &PairMotion, dx: DVec3, dv: DVec3) -> DVec3 {
        let &Spring {
            rest_length,
            stiffness,
            damping,
            ..
        } = self;
        let squared = dot(at.position, at.position);
        if squared == 0.0 {
            return stiffness * dx + damping * dv;
        }
        let inverse = 1.0 / libm::sqrt(squared);
        let n = inverse * at.position;
        let (stretch, speed) = (dot(n, dx), dot(n, at.velocity));
        let across = dx - stretch * n;
        let slack = stiffness * (1.0 - rest_length * inverse) + damping * inverse * speed;
        let turned = damping * inverse * dot(at.velocity, across);
        (stiffness * stretch + turned + damping * dot(n, dv)) * n + slack * across
    }
}
