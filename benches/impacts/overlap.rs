//! The depth of overlaps, measured alike for every engine from the positions of the bodies.

use cases::scenes::{Form, Item, Scene};
use sim_core::collide::tree::intersect;
use sim_core::{Bvh, DVec3};

/// The bodies of a scene in the form for measuring: each kind of mesh has its tree.
pub(crate) struct Depths<'a> {
    items: &'a [Item],
    half: Vec<DVec3>,
    tree: Option<Bvh>,
    fixed: usize,
}

impl Depths<'_> {
    /// For a scene whose first bodies are immovable, and whose meshes are all the same.
    pub(crate) fn new(scene: &Scene, fixed: usize) -> Depths<'_> {
        let half = scene.items.iter().map(|item| item.half()).collect();
        let mesh = scene.items.iter().find_map(|item| match &item.form {
            Some(Form::Mesh(mesh)) => Some(Bvh::build(mesh)),
            _ => None,
        });
        Depths {
            items: &scene.items,
            half,
            tree: mesh,
            fixed,
        }
    }

    /// The greatest depth of overlap of a body with another one or with a wall, m.
    pub(crate) fn deepest(&self, position: impl Fn(usize) -> DVec3) -> f64 {
        let at: Vec<DVec3> = (0..self.items.len()).map(position).collect();
        let mut deepest: f64 = 0.0;
        for (&place, &half) in at.iter().zip(&self.half).skip(self.fixed) {
            for wall in 0..self.fixed {
                deepest = deepest.max(self.in_wall(wall, place, half));
            }
        }
        // Sorted from left to right, so that only neighbouring bodies are compared.
        let mut order: Vec<usize> = (self.fixed..at.len()).collect();
        order.sort_unstable_by(|&i, &j| at[i].x.total_cmp(&at[j].x));
        for (k, &i) in order.iter().enumerate() {
            for &j in &order[k + 1..] {
                let (offset, reach) = (at[j] - at[i], self.half[i] + self.half[j]);
                if offset.x >= reach.x {
                    break;
                }
                if offset.abs().cmplt(reach).all() {
                    deepest = deepest.max(self.of_pair(i, offset, reach));
                }
            }
        }
        deepest
    }

    fn in_wall(&self, wall: usize, at: DVec3, half: DVec3) -> f64 {
        let item = &self.items[wall];
        match item.form {
            Some(Form::Wall(normal)) => normal.abs().dot(half) - normal.dot(at - item.position),
            _ => 0.0,
        }
    }

    fn of_pair(&self, first: usize, offset: DVec3, reach: DVec3) -> f64 {
        match &self.items[first].form {
            Some(Form::Ball(radius)) => 2.0 * radius - offset.length(),
            Some(Form::Cube(_)) => (reach - offset.abs()).min_element(),
            Some(Form::Mesh(_)) => self.of_meshes(offset, reach),
            _ => 0.0,
        }
    }

    /// The shortest translation that separates the surfaces, along an axis or along the line of centres.
    fn of_meshes(&self, offset: DVec3, reach: DVec3) -> f64 {
        let Some(tree) = &self.tree else { return 0.0 };
        if !intersect(tree, tree, offset) {
            return 0.0;
        }
        let mut least = (reach - offset.abs()).min_element();
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let ways = axes.into_iter().flat_map(|axis| [axis, -axis]);
        for way in ways.chain(offset.try_normalize()) {
            if intersect(tree, tree, offset + least * way) {
                continue;
            }
            let (mut meets, mut apart) = (0.0, least);
            for _ in 0..30 {
                let middle = 0.5 * (meets + apart);
                match intersect(tree, tree, offset + middle * way) {
                    true => meets = middle,
                    false => apart = middle,
                }
            }
            least = apart;
        }
        least
    }
}
