//! Two bodies head on, the second one approaching the first.

use std::sync::Arc;

use kit::meshes::builtin;
use sim_core::collide::touch::first_touch;
use sim_core::{Bvh, DVec3, Mesh};

use super::{Form, Goal, Item, Known, Scene};

/// Two bodies, and the position at which the second one, moving along a direction, touches the first.
pub struct Pair {
    forms: [Form; 2],
    way: DVec3,
    touching: DVec3,
    normal: DVec3,
}

impl Pair {
    /// Finds the first contact by one search over the whole path.
    pub fn new(forms: [Form; 2], way: DVec3) -> Pair {
        let way = way.normalize();
        let [first, second] = forms.each_ref().map(|form| Bvh::build(&mesh(form)));
        let (from, motion) = (-16.0 * way, 32.0 * way);
        let touch = first_touch(&first, &second, from, motion);
        let touch = touch.unwrap_or_else(|| unreachable!("they are aimed at each other"));
        Pair {
            forms,
            way,
            touching: from + touch.time * motion,
            normal: touch.normal,
        }
    }

    /// The scene in which they touch after a time, s.
    pub fn scene(&self, speed: f64, impact: f64) -> Scene {
        let [first, second] = self.forms.clone();
        let velocity = speed * self.way;
        Scene::new(vec![
            Item::resting(first, DVec3::ZERO),
            Item::new(second, self.touching - velocity * impact, velocity),
        ])
    }

    /// The scene with its final state: equal masses exchange their velocities along the normal.
    pub fn known(&self, speed: f64, impact: f64, duration: f64) -> Known {
        let (velocity, rest) = (speed * self.way, duration - impact);
        let given = velocity.dot(self.normal) * self.normal;
        Known {
            scene: self.scene(speed, impact),
            duration,
            impact: Some(impact),
            goal: Goal::Places {
                at: vec![rest * given, self.touching + rest * (velocity - given)],
                way: speed,
            },
        }
    }
}

/// The cube of the gallery has edges of 1 m.
fn mesh(form: &Form) -> Arc<Mesh> {
    match form {
        Form::Mesh(mesh) => mesh.clone(),
        Form::Cube(0.5) => builtin("cube.obj"),
        form => unreachable!("pairs are of meshes and cubes of 1 m: {form:?}"),
    }
}
