//! Numbers of a scene file: whole numbers may be written without a decimal point.

use std::fmt;

use glam::DVec3;
use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};
use serde::ser::{Serialize, Serializer};

/// A number, whole or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Number(pub(super) f64);

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Number, D::Error> {
        deserializer.deserialize_any(NumberVisitor)
    }
}

struct NumberVisitor;

impl Visitor<'_> for NumberVisitor {
    type Value = Number;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Number, E> {
        Ok(Number(value))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Number, E> {
        Ok(Number(value as f64))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Number, E> {
        Ok(Number(value as f64))
    }

    fn visit_i128<E: Error>(self, value: i128) -> Result<Number, E> {
        Ok(Number(value as f64))
    }

    fn visit_u128<E: Error>(self, value: u128) -> Result<Number, E> {
        Ok(Number(value as f64))
    }
}

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        // A whole number of up to 15 digits is exact and short; -0 is not a whole number.
        let whole = self.0 as i64;
        if self.0.abs() < 1e15 && (whole as f64).to_bits() == self.0.to_bits() {
            serializer.serialize_i64(whole)
        } else {
            serializer.serialize_f64(self.0)
        }
    }
}

/// Three numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Triple(pub(super) DVec3);

impl<'de> Deserialize<'de> for Triple {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Triple, D::Error> {
        deserializer.deserialize_seq(TripleVisitor)
    }
}

struct TripleVisitor;

impl<'de> Visitor<'de> for TripleVisitor {
    type Value = Triple;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("three numbers")
    }

    /// Unlike serde's own arrays, refuses a fourth number.
    fn visit_seq<A: SeqAccess<'de>>(self, mut values: A) -> Result<Triple, A::Error> {
        let mut triple = [0.0; 3];
        for (i, component) in triple.iter_mut().enumerate() {
            let next: Option<Number> = values.next_element()?;
            *component = next.ok_or_else(|| Error::invalid_length(i, &self))?.0;
        }
        match values.next_element::<Number>()? {
            Some(_) => Err(Error::invalid_length(4, &self)),
            None => Ok(Triple(DVec3::from(triple))),
        }
    }
}

impl Serialize for Triple {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.to_array().map(Number).serialize(serializer)
    }
}

/// A scale: one number for all axes or one for each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale(pub(super) DVec3);

impl<'de> Deserialize<'de> for Scale {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Scale, D::Error> {
        deserializer.deserialize_any(ScaleVisitor)
    }
}

struct ScaleVisitor;

impl<'de> Visitor<'de> for ScaleVisitor {
    type Value = Scale;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number or three numbers")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Scale, E> {
        Ok(Scale(DVec3::splat(value)))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Scale, E> {
        self.visit_f64(value as f64)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<Scale, A::Error> {
        Ok(Scale(TripleVisitor.visit_seq(values)?.0))
    }
}

impl Serialize for Scale {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let [x, y, z] = self.0.to_array();
        if x == y && y == z {
            Number(x).serialize(serializer)
        } else {
            Triple(self.0).serialize(serializer)
        }
    }
}
