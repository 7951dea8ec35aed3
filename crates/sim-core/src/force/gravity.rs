//! Weight.

use glam::DVec3;

use super::{
    BodyMotion, Force,
    described::{Description, Field, Nature, Tie},
    law::BuiltIn,
    vectors::dot,
};

pub(super) const START: Force = Force::Gravity {
    acceleration: DVec3::new(0.0, -9.81, 0.0),
};

pub(super) struct Gravity {
    pub(super) acceleration: DVec3,
}

impl Gravity {
    pub(super) fn potential(&self, at: &BodyMotion) -> f64 {
        -at.mass * dot(self.acceleration, at.position)
    }
}

impl BuiltIn for Gravity {
    fn description(&self) -> Description {
        Description {
            kind: "gravity",
            title: "Gravity",
            law: "Weight, F = m g: every body falls with the same acceleration",
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
        let about = ["acceleration", "g", "m/s²", "Acceleration of every body"];
        see(Field::vector(about, &mut self.acceleration));
    }

    fn whole(&self) -> Force {
        let &Gravity { acceleration } = self;
        Force::Gravity { acceleration }
    }
}
