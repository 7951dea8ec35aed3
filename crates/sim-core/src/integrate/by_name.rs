//! Methods of the table, serialized by their names.

use alloc::{format, string::String};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de, ser};

use super::Method;

pub(crate) fn serialize<S: Serializer>(method: &&'static Method, to: S) -> Result<S::Ok, S::Error> {
    let known = Method::named(method.name);
    match known.is_some_and(|known| core::ptr::eq(known, *method)) {
        true => method.name.serialize(to),
        false => Err(ser::Error::custom(format!(
            "method {} is not in the table: it is code, which has no text",
            method.name
        ))),
    }
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<&'static Method, D::Error> {
    let name = String::deserialize(from)?;
    let known = Method::named(&name);
    known.ok_or_else(|| de::Error::custom(format!("there is no method {name:?}")))
}
