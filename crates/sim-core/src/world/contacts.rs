//! Lasting contacts of bodies, and the cost in accuracy of solving many contacts at once.

use glam::DVec3;

use super::World;

/// Two bodies that stay in contact: they touched at the start of a step, or came to rest on each other.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RestingContact {
    /// The bodies, the lower index first.
    pub bodies: (usize, usize),
    /// Unit normal, from the first body to the second.
    pub normal: DVec3,
    /// The contact point on the surface of the first body, at the end of the step, m.
    pub point: DVec3,
    /// The gap when it was last measured, m. Bodies in contact keep a gap of some 1e-12 of their coordinates; wider
    /// gaps belong to future contacts in a heap.
    pub gap: f64,
    /// Force on the second body in the last solution, N: the normal force, and friction perpendicular to it.
    pub force: DVec3,
    /// Whether the bodies overlap; then the contact keeps them from getting deeper.
    pub is_overlap: bool,
}

/// The error of the last step from solving the contacts of heaps once a step, with their gaps.
///
/// If bodies come to rest on each other again and again within a step, the contacts of all bodies that lie together
/// with them are solved at once: contacts stop closing before their gaps are closed, and there are no flights shorter
/// than a step. Distances shrink with the step: from 60 to 960 Hz by a factor of 12 to 70 in `wall`, `funnel` and `bin`
/// of the gallery (example `heap_energy` of the crate `scene`).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Bundled {
    /// The number of bodies in heaps.
    pub bodies: usize,
    /// Kinetic energy that contacts have taken from them, J. It is more than the cost of bundling, because it
    /// includes the energy that impacts without restitution take in any case.
    pub energy: f64,
    /// The greatest distance by which a contact was closed too early, or a body was kept from flying, m.
    pub distance: f64,
}

impl World {
    /// The lasting contacts at the end of the last step; none outside of
    /// [`Collision::Continuous`](super::Collision::Continuous).
    pub fn contacts(&self) -> impl Iterator<Item = RestingContact> {
        self.contacts.all().iter().map(|contact| {
            let (i, j) = contact.bodies;
            let closing = contact.load_speed / self.settings.dt;
            let along = closing / (1.0 / self.bodies.mass[i] + 1.0 / self.bodies.mass[j]);
            RestingContact {
                bodies: contact.bodies,
                normal: contact.normal,
                point: self.current.position[i] + contact.point,
                gap: contact.gap,
                force: along.max(0.0) * contact.normal + contact.friction,
                is_overlap: contact.is_overlap,
            }
        })
    }

    /// Steps that have ended with bodies in contact, since the world was made.
    pub fn contact_steps(&self) -> u64 {
        self.record.contact_steps
    }

    /// The error of the last step from bundling the contacts of heaps.
    pub fn bundled(&self) -> Bundled {
        self.continuous.bundled
    }
}
