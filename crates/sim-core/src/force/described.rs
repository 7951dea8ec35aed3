//! What a force says about itself, as data: its name and law, its fields with units and ranges, its nature. Scene files,
//! panels and checks are made from this.

use core::slice;
use glam::DVec3;

use super::ForceError;

/// What a force is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Description {
    /// Name of its kind, as in scene files.
    pub kind: &'static str,
    /// The same for people.
    pub title: &'static str,
    /// Its law, in one line.
    pub law: &'static str,
}

/// What follows from a force beside its value, for its present numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nature {
    /// Whether it depends on velocities.
    pub depends_on_velocity: bool,
    /// Whether it may grow without bound at places near which bodies can be.
    pub is_unbounded: bool,
    /// Whether it may take energy.
    pub dissipates: bool,
    /// Whether it may give energy although every body that it names is movable or at rest.
    pub drives: bool,
    /// What a picture shows of it.
    pub tie: Tie,
}

/// What a picture shows of a force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tie {
    /// Nothing.
    Nothing,
    /// A point that attracts, m.
    Centre(DVec3),
    /// A spring from this point, m, to the body.
    SpringFrom(DVec3),
    /// A spring between the two bodies.
    SpringBetween,
}

impl Tie {
    /// The fixed point, m, if there is one.
    pub fn point(self) -> Option<DVec3> {
        match self {
            Tie::Centre(point) | Tie::SpringFrom(point) => Some(point),
            Tie::Nothing | Tie::SpringBetween => None,
        }
    }
}

/// A field of a force, with its value to read and to change.
#[derive(Debug)]
pub struct Field<'a> {
    /// Its name in scene files and errors.
    pub name: &'static str,
    /// The same for people.
    pub title: &'static str,
    /// The unit of its numbers; empty if it has none.
    pub unit: &'static str,
    /// Its meaning, in a few words.
    pub meaning: &'static str,
    /// Its value.
    pub value: Value<'a>,
}

/// The value of a field.
#[derive(Debug)]
pub enum Value<'a> {
    /// A number.
    Number {
        /// The number, at most [`Value::LARGEST`].
        value: &'a mut f64,
        /// The smallest one: 0 or `-LARGEST`.
        least: f64,
        /// The number that a file need not give.
        default: Option<f64>,
    },
    /// A vector, each component within `±LARGEST`.
    Vector(&'a mut DVec3),
    /// The body on which it acts.
    Body(&'a mut usize),
    /// The same, or every body.
    AnyBody(&'a mut Option<usize>),
    /// The two bodies between which it acts.
    Bodies(&'a mut [usize; 2]),
    /// The same, or every two bodies.
    AnyBodies(&'a mut Option<[usize; 2]>),
    /// The point of the body on which it acts, in the frame of its shape, m, if not its position.
    Point(&'a mut Option<DVec3>),
    /// The same for the two bodies.
    Points(&'a mut Option<[DVec3; 2]>),
}

impl Value<'_> {
    /// The largest absolute value of a number.
    pub const LARGEST: f64 = 1e100;

    /// The bodies that it names.
    pub fn bodies(&mut self) -> &mut [usize] {
        match self {
            Value::Body(body) => slice::from_mut(*body),
            Value::AnyBody(body) => body.as_mut_slice(),
            Value::Bodies(bodies) => &mut bodies[..],
            Value::AnyBodies(bodies) => bodies.as_mut().map_or(&mut [], |bodies| &mut bodies[..]),
            Value::Number { .. } | Value::Vector(_) | Value::Point(_) | Value::Points(_) => &mut [],
        }
    }
}

impl<'a> Field<'a> {
    /// A number from `least`, which is 0 or `-LARGEST`, with its name, title, unit and meaning.
    pub(super) fn number(
        [name, title, unit, meaning]: [&'static str; 4],
        least: f64,
        value: &'a mut f64,
    ) -> Field<'a> {
        let default = None;
        Field {
            name,
            title,
            unit,
            meaning,
            value: Value::Number {
                value,
                least,
                default,
            },
        }
    }

    /// The same number, which may be left out and is 0 then.
    pub(super) fn or_zero(mut self) -> Field<'a> {
        if let Value::Number { default, .. } = &mut self.value {
            *default = Some(0.0);
        }
        self
    }

    /// The length at which a spring is at rest.
    pub(super) fn rest_length(value: &'a mut f64) -> Field<'a> {
        let meaning = "Length without force, from 0";
        Field::number(["rest_length", "Rest length", "m", meaning], 0.0, value).or_zero()
    }

    /// The stiffness of a spring.
    pub(super) fn stiffness(value: &'a mut f64) -> Field<'a> {
        Field::number(["stiffness", "Stiffness", "N/m", "From 0"], 0.0, value)
    }

    /// The damping of a spring.
    pub(super) fn damping(value: &'a mut f64) -> Field<'a> {
        Field::number(["damping", "Damping", "kg/s", "From 0"], 0.0, value).or_zero()
    }

    /// A vector, with its name, title, unit and meaning.
    pub(super) fn vector(
        [name, title, unit, meaning]: [&'static str; 4],
        value: &'a mut DVec3,
    ) -> Field<'a> {
        Field {
            name,
            title,
            unit,
            meaning,
            value: Value::Vector(value),
        }
    }

    /// The body on which it acts.
    pub(super) fn body(body: &'a mut usize) -> Field<'a> {
        Field::acts("body", "Body", Value::Body(body))
    }

    /// The body on which it acts, or every one.
    pub(super) fn any_body(body: &'a mut Option<usize>) -> Field<'a> {
        Field::acts("body", "Body", Value::AnyBody(body))
    }

    /// The bodies between which it acts.
    pub(super) fn bodies(bodies: &'a mut [usize; 2]) -> Field<'a> {
        Field::acts("bodies", "Bodies", Value::Bodies(bodies))
    }

    /// The bodies between which it acts, or every two.
    pub(super) fn any_bodies(bodies: &'a mut Option<[usize; 2]>) -> Field<'a> {
        Field::acts("bodies", "Bodies", Value::AnyBodies(bodies))
    }

    fn acts(name: &'static str, title: &'static str, value: Value<'a>) -> Field<'a> {
        Field {
            name,
            title,
            unit: "",
            meaning: "The body that the force acts on",
            value,
        }
    }

    /// The point of the body on which it always acts.
    pub(super) fn point(point: &'a mut DVec3) -> Field<'a> {
        Field::vector(["point", "Point", "m", POINT], point)
    }

    /// The point of the body on which it acts, if not its position.
    pub(super) fn maybe_point(point: &'a mut Option<DVec3>) -> Field<'a> {
        Field {
            name: "point",
            title: "Tied at a point of the body",
            unit: "m",
            meaning: POINT,
            value: Value::Point(point),
        }
    }

    /// The points of the bodies between which it acts, if not their positions.
    pub(super) fn maybe_points(points: &'a mut Option<[DVec3; 2]>) -> Field<'a> {
        Field {
            name: "points",
            title: "Tied at points of the bodies",
            unit: "m",
            meaning: POINT,
            value: Value::Points(points),
        }
    }

    /// Whether all numbers are in range.
    pub(super) fn check(&self) -> Result<(), ForceError> {
        let field = self.name;
        let vector = |value: DVec3| {
            if value.abs().cmple(DVec3::splat(Value::LARGEST)).all() {
                Ok(())
            } else {
                Err(ForceError::Vector { field, value })
            }
        };
        match &self.value {
            &Value::Number {
                value: &mut value,
                least,
                ..
            } => match (least..=Value::LARGEST).contains(&value) {
                true => Ok(()),
                false if least < 0.0 => Err(ForceError::Signed { field, value }),
                false => Err(ForceError::Number { field, value }),
            },
            Value::Vector(value) => vector(**value),
            Value::Point(point) => point.map_or(Ok(()), vector),
            Value::Points(points) => points.iter().flatten().try_for_each(|point| vector(*point)),
            Value::Body(_) | Value::AnyBody(_) | Value::Bodies(_) | Value::AnyBodies(_) => Ok(()),
        }
    }
}

const POINT: &str = "Where the force acts, in the frame of the body's shape";
