//! A ball against a mesh. Not there yet: they pass through each other.

use glam::DVec3;

use super::form::Contact;
use crate::bvh::Bvh;

pub(super) fn meets(_: &Bvh, _: DVec3, _: f64) -> bool {
    false
}

pub(super) fn first_touch(_: &Bvh, _: DVec3, _: f64, _: DVec3) -> Option<Contact> {
    None
}

pub(super) fn parting_normal(_: &Bvh, _: DVec3, _: f64) -> alloc::vec::Vec<DVec3> {
    alloc::vec![]
}
