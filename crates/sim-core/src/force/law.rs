//! What the world asks of a law, and the one place that knows which law a force has.
//!
//! Each law has a file of its own. The questions have no answer by default where a wrong one could pass unseen, so that
//! the compiler asks them all of a new law.

use glam::DVec3;

use super::{
    BodyLaw, BodyMotion, Force, PairLaw, PairMotion, anchor, attraction,
    described::{Description, Field, Nature},
    gravitation, gravity, linear_drag, outside, push, quadratic_drag, spring,
};
use crate::Jacobians;

/// What every law says about itself.
pub(super) trait BuiltIn {
    fn description(&self) -> Description;

    fn nature(&self) -> Nature;

    /// Shows all fields, in the order in which people read and files write them.
    fn fields(&mut self, see: &mut dyn FnMut(Field<'_>));

    /// The force that has this law.
    fn whole(&self) -> Force;
}

/// A law of one body's motion.
pub(super) trait OneBody: BuiltIn + BodyLaw {
    /// The body on which it acts; `None` for every body.
    fn body(&self) -> Option<usize>;

    /// The point of the body on which it acts; `None` for the body's position.
    fn point(&self) -> Option<DVec3>;
}

/// A law of two bodies' relative motion.
pub(super) trait TwoBodies: BuiltIn + PairLaw {
    /// The bodies between which it acts; `None` for every two.
    fn bodies(&self) -> Option<[usize; 2]>;

    /// The points of the bodies on which it acts; `None` for their positions.
    fn points(&self) -> Option<[DVec3; 2]>;

    /// The change of the force by a small relative motion. A law may compute the product without the matrices.
    fn change(&self, at: &PairMotion, dx: DVec3, dv: DVec3) -> DVec3 {
        let slopes = self.jacobians(at);
        slopes.position * dx + slopes.velocity * dv
    }
}

/// A law, by what it acts on.
enum Role<'a> {
    /// Every body has the same constant acceleration.
    Weight(&'a mut gravity::Gravity),
    One(&'a mut dyn OneBody),
    Two(&'a mut dyn TwoBodies),
}

impl<'a> Role<'a> {
    fn built_in(self) -> &'a mut dyn BuiltIn {
        match self {
            Role::Weight(law) => law,
            Role::One(law) => law,
            Role::Two(law) => law,
        }
    }
}

/// The bodies on which a force acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reach {
    /// Every body with the same constant acceleration.
    Weight,
    Body(usize),
    EachBody,
    Pair([usize; 2]),
    EachPair,
}

impl Force {
    /// Gives the law of this force to `answer`. It is inlined with `answer` in each arm, where the law is known, so
    /// that no call is indirect. What methods ask in their inner loops is a function each, since all laws inside such a
    /// loop would leave it no registers.
    #[inline(always)]
    fn ask<T>(&self, answer: impl FnOnce(Role<'_>) -> T) -> T {
        match *self {
            Force::Gravity { acceleration } => {
                answer(Role::Weight(&mut gravity::Gravity { acceleration }))
            }
            Force::LinearDrag { body, coefficient } => {
                answer(Role::One(&mut linear_drag::LinearDrag {
                    body,
                    coefficient,
                }))
            }
            Force::QuadraticDrag { body, coefficient } => {
                answer(Role::One(&mut quadratic_drag::QuadraticDrag {
                    body,
                    coefficient,
                }))
            }
            Force::Anchor {
                body,
                point,
                anchor,
                rest_length,
                stiffness,
                damping,
            } => answer(Role::One(&mut anchor::Anchor {
                body,
                point,
                anchor,
                rest_length,
                stiffness,
                damping,
            })),
            Force::Spring {
                bodies,
                points,
                rest_length,
                stiffness,
                damping,
            } => answer(Role::Two(&mut spring::Spring {
                bodies,
                points,
                rest_length,
                stiffness,
                damping,
            })),
            Force::Push { body, point, force } => {
                answer(Role::One(&mut push::Push { body, point, force }))
            }
            Force::Attraction {
                body,
                centre,
                strength,
            } => answer(Role::One(&mut attraction::Attraction {
                body,
                centre,
                strength,
            })),
            Force::Gravitation { constant } => {
                answer(Role::Two(&mut gravitation::Gravitation { constant }))
            }
            Force::Body { body, ref law } => answer(Role::One(&mut outside::OnBody { body, law })),
            Force::Pair { bodies, ref law } => {
                answer(Role::Two(&mut outside::OnPair { bodies, law }))
            }
        }
    }

    /// What it is called.
    pub fn description(&self) -> Description {
        self.ask(|law| law.built_in().description())
    }

    /// What follows from it beside its value.
    pub fn nature(&self) -> Nature {
        self.ask(|law| law.built_in().nature())
    }

    /// Shows all fields to `see`, which may change their values. A world checks them when it is given the force.
    pub fn fields(&mut self, mut see: impl FnMut(Field<'_>)) {
        *self = self.seen(&mut see);
    }

    /// The same, with the changed force as a new one.
    pub(super) fn seen(&self, see: &mut dyn FnMut(Field<'_>)) -> Force {
        self.ask(|law| {
            let law = law.built_in();
            law.fields(see);
            law.whole()
        })
    }

    /// Whether it acts between two bodies, on both with opposite signs.
    pub fn is_mutual(&self) -> bool {
        self.ask(|law| match law {
            Role::Two(_) => true,
            Role::Weight(_) | Role::One(_) => false,
        })
    }

    #[inline]
    pub(crate) fn reach(&self) -> Reach {
        self.ask(|law| match law {
            Role::Weight(_) => Reach::Weight,
            Role::One(law) => law.body().map_or(Reach::EachBody, Reach::Body),
            Role::Two(law) => law.bodies().map_or(Reach::EachPair, Reach::Pair),
        })
    }

    /// The point of the body on which it acts, in the frame of its shape, m; `None` for the body's position.
    #[inline]
    pub fn point(&self) -> Option<DVec3> {
        self.ask(|law| match law {
            Role::One(law) => law.point(),
            Role::Weight(_) | Role::Two(_) => None,
        })
    }

    /// The same for the two bodies between which it acts.
    #[inline]
    pub fn points(&self) -> Option<[DVec3; 2]> {
        self.ask(|law| match law {
            Role::Two(law) => law.points(),
            Role::Weight(_) | Role::One(_) => None,
        })
    }

    /// Force on one body, N; zero for a force between bodies, and for weight, which is part of the constant
    /// acceleration.
    #[inline(never)]
    pub(crate) fn on_body(&self, at: &BodyMotion) -> DVec3 {
        self.ask(|law| match law {
            Role::One(law) => law.force(at),
            Role::Weight(_) | Role::Two(_) => DVec3::ZERO,
        })
    }

    /// The derivatives of this force.
    #[inline(never)]
    pub(crate) fn body_jacobians(&self, at: &BodyMotion) -> Jacobians {
        self.ask(|law| match law {
            Role::One(law) => law.jacobians(at),
            Role::Weight(_) | Role::Two(_) => Jacobians::ZERO,
        })
    }

    /// The potential energy of this force or weight, J.
    pub(crate) fn body_potential(&self, at: &BodyMotion) -> Option<f64> {
        self.ask(|law| match law {
            Role::Weight(law) => Some(law.potential(at)),
            Role::One(law) => law.potential(at),
            Role::Two(_) => None,
        })
    }

    /// Force on the first of two bodies, N; zero for a force that does not act between bodies.
    #[inline(never)]
    pub(crate) fn on_pair(&self, at: &PairMotion) -> DVec3 {
        self.ask(|law| match law {
            Role::Two(law) => law.force(at),
            Role::Weight(_) | Role::One(_) => DVec3::ZERO,
        })
    }

    /// The derivatives of this force with respect to the relative motion.
    #[inline(never)]
    pub(crate) fn pair_jacobians(&self, at: &PairMotion) -> Jacobians {
        self.ask(|law| match law {
            Role::Two(law) => law.jacobians(at),
            Role::Weight(_) | Role::One(_) => Jacobians::ZERO,
        })
    }

    /// The change of this force by a small relative motion: the product of the Jacobians with `dx` and `dv`.
    #[inline]
    pub(crate) fn pair_change(&self, at: &PairMotion, dx: DVec3, dv: DVec3) -> DVec3 {
        self.ask(|law| match law {
            Role::Two(law) => law.change(at, dx, dv),
            Role::Weight(_) | Role::One(_) => DVec3::ZERO,
        })
    }

    /// The potential energy of this force, J.
    pub(crate) fn pair_potential(&self, at: &PairMotion) -> Option<f64> {
        self.ask(|law| match law {
            Role::Two(law) => law.potential(at),
            Role::Weight(_) | Role::One(_) => None,
        })
    }
}
