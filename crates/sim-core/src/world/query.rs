//! Queries about all bodies of a world at their places: ray and shape casts, bodies that meet a shape, the nearest
//! body.

use alloc::{boxed::Box, vec::Vec};
use core::sync::atomic::{AtomicU32, Ordering};
use glam::DVec3;
use once_cell::race::OnceBox;

use super::{World, bodies::Bodies};
use crate::{
    collide::{BoxTree, Swept},
    query::{self, Hit, Placed, QueryError, Ray, distance_within, first_hit, ray_hit},
};

/// Up to this many bodies are tested one by one.
const FEW: usize = 32;

/// Up to this many queries at the same positions are answered body by body: to put many bodies into a tree takes as
/// long as this many answers.
const FEW_QUESTIONS: u32 = 4;

/// A tree of the bodies' boxes, built once it pays. A copy starts without it.
#[derive(Debug, Default)]
pub(super) struct Index {
    questions: AtomicU32,
    tree: OnceBox<Tree>,
}

#[derive(Debug)]
struct Tree {
    boxes: BoxTree,
    /// Half-spaces, which have no bounding box.
    walls: Vec<usize>,
}

impl Clone for Index {
    fn clone(&self) -> Index {
        Index::default()
    }
}

impl Index {
    /// Removes the tree, because bodies have moved or changed.
    #[inline]
    pub(super) fn forget(&mut self) {
        if *self.questions.get_mut() > 0 {
            *self = Index::default();
        }
    }

    /// Visits bodies that have a shape. `near` returns a lower bound on the distance or time for the contents of a
    /// box, and infinity for a box to skip. `visit` receives a body and returns the limit for the next ones.
    fn visit(
        &self,
        bodies: &Bodies,
        at: &[DVec3],
        near: impl Fn(&Swept) -> f64,
        mut limit: f64,
        mut visit: impl FnMut(usize) -> f64,
    ) {
        let swept = |body: usize| bodies.swept_box(body, at[body], at[body]);
        let solid = &bodies.solid;
        // Saturates; greater numbers of queries do not matter.
        let asked = self.questions.load(Ordering::Relaxed);
        self.questions
            .store(asked.saturating_add(1), Ordering::Relaxed);
        if solid.len() <= FEW || asked < FEW_QUESTIONS {
            for &body in solid {
                if bodies.is_half_space(body) || near(&swept(body)) <= limit {
                    limit = visit(body);
                }
            }
            return;
        }
        let tree = self.tree.get_or_init(|| {
            let (walls, boxed): (Vec<usize>, Vec<usize>) =
                solid.iter().partition(|&&body| bodies.is_half_space(body));
            let boxes = BoxTree::of(&boxed, swept);
            Box::new(Tree { boxes, walls })
        });
        for &body in &tree.walls {
            limit = visit(body);
        }
        tree.boxes.visit(near, limit, visit);
    }
}

/// The best answer so far: the least time or distance; of equal ones, that of the lowest body.
struct Best {
    found: Option<(usize, Hit)>,
    limit: f64,
}

impl Best {
    fn within(limit: f64) -> Best {
        Best { found: None, limit }
    }

    /// A limit slightly above the best answer, so that among equal answers the lowest body wins, whatever the order
    /// of visits.
    fn loose(&self) -> f64 {
        (self.limit * (1.0 + 4.0 * f64::EPSILON)).next_up()
    }

    fn take(&mut self, body: usize, hit: Option<Hit>, measure: impl Fn(&Hit) -> f64) -> f64 {
        if let Some(hit) = hit {
            let new = measure(&hit);
            let is_better = match self.found {
                Some((known, _)) => (new, body) < (self.limit, known),
                None => new <= self.limit,
            };
            if is_better {
                (self.found, self.limit) = (Some((body, hit)), new);
            }
        }
        self.limit
    }
}

impl World {
    /// The shape of a body at its current place, for the functions of [`query`]; `None` for a point without a shape.
    /// The tree of a mesh is built when it is first needed.
    pub fn placed(&self, body: usize) -> Option<Placed<'_>> {
        self.bodies.need_bvh(body);
        let form = self.bodies.form(body)?;
        Some(Placed {
            form,
            position: self.current.position[body],
        })
    }

    /// The body that a ray from `origin` (m) along `direction` (of any length but 0) hits first, among those for
    /// which `among` holds, and where ([`query::ray`]): at `origin + time · direction`. A ray hits surfaces from
    /// either side. Of several bodies hit at the same time the result is the one of the lowest index.
    ///
    /// Takes a box test for each body. A world of many bodies that is queried more than a few times between two steps
    /// builds a tree of their boxes once.
    ///
    /// ```
    /// # use sim_core::{Body, DVec3, Settings, Shape, World};
    /// let mut world = World::new(Settings::default())?;
    /// let shape = Some(Shape::Sphere { radius: 1.0 });
    /// let ball = world.add(Body { shape, position: 5.0 * DVec3::X, ..Body::default() })?;
    /// let (body, hit) = world.cast_ray(DVec3::ZERO, DVec3::X, |_| true)?.expect("a hit");
    /// assert_eq!((body, hit.time, hit.normal), (ball, 4.0, DVec3::NEG_X));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`query::ray`].
    pub fn cast_ray(
        &self,
        origin: DVec3,
        direction: DVec3,
        among: impl Fn(usize) -> bool,
    ) -> Result<Option<(usize, Hit)>, QueryError> {
        let ray = Ray::new(origin, direction)?;
        let mut best = Best::within(f64::INFINITY);
        let near = |swept: &Swept| entry(&ray, swept.min, swept.max);
        self.visit(near, best.limit, |body| {
            let within = best.loose();
            let hit = || ray_hit(self.placed(body)?, &ray, within);
            let hit = among(body).then(hit).flatten();
            best.take(body, hit, |hit| hit.time)
        });
        Ok(best.found)
    }

    /// The shape cast: the body that a shape hits first on a straight line by `motion`, m, among those for which
    /// `among` holds, and the hit ([`query::time_of_impact`]; the body is the first shape). Bodies stay at their
    /// places. Of several bodies hit at the same time the result is the one of the lowest index.
    ///
    /// # Errors
    ///
    /// Those of [`query::time_of_impact`].
    pub fn cast_shape(
        &self,
        shape: Placed<'_>,
        motion: DVec3,
        among: impl Fn(usize) -> bool,
    ) -> Result<Option<(usize, Hit)>, QueryError> {
        query::check_motion(motion)?;
        let mut best = Best::within(1.0);
        // The ray of the shape's motion, against boxes extended by the shape's box.
        let ray = Ray {
            origin: shape.position,
            direction: motion,
        };
        let bounds = shape.bounds();
        let near = |swept: &Swept| match bounds {
            Some([low, high]) => {
                let rounding = 4.0
                    * f64::EPSILON
                    * (low.abs().max(high.abs()) + swept.min.abs() + swept.max.abs());
                entry(
                    &ray,
                    swept.min - high - rounding,
                    swept.max - low + rounding,
                )
            }
            None => 0.0,
        };
        self.visit(near, best.limit, |body| {
            let hit = || first_hit(self.placed(body)?, shape, motion);
            let hit = among(body).then(hit).flatten();
            best.take(body, hit, |hit| hit.time)
        });
        Ok(best.found)
    }

    /// The bodies that share a point with a shape, in order of their indices ([`query::intersects`]): none if
    /// its place is free.
    pub fn bodies_meeting(&self, shape: Placed<'_>) -> Vec<usize> {
        let mut found = Vec::new();
        let own = shape.bounds().map(|[low, high]| {
            let at = shape.position;
            let rounding = 8.0 * f64::EPSILON * (at.abs() + low.abs().max(high.abs()));
            Swept {
                min: at + low - rounding,
                max: at + high + rounding,
                body: usize::MAX,
            }
        });
        let near = |swept: &Swept| match own {
            Some(own) if !own.meets(swept) => f64::INFINITY,
            _ => 0.0,
        };
        self.visit(near, 0.0, |body| {
            if self
                .placed(body)
                .is_some_and(|placed| query::intersects(placed, shape))
            {
                found.push(body);
            }
            0.0
        });
        found.sort_unstable();
        found
    }

    /// The body whose shape is nearest to a point, m, among those for which `among` holds, and its distance
    /// ([`query::distance`]; the body is the first shape, the point the second). Meshes are surfaces: from
    /// inside of one the distance is that to its surface. Of several bodies at the same distance the result is the
    /// one of the lowest index.
    ///
    /// # Errors
    ///
    /// [`QueryError::Vector`] if a component of `point` is not a number within ±1e100 m.
    pub fn nearest(
        &self,
        point: DVec3,
        among: impl Fn(usize) -> bool,
    ) -> Result<Option<(usize, Hit)>, QueryError> {
        let shape = Placed::sphere(0.0, point)?;
        let mut best = Best::within(f64::INFINITY);
        let near = |swept: &Swept| {
            let way = (swept.min - point).max(point - swept.max).max(DVec3::ZERO);
            // A lower bound, despite rounding.
            way.length() * (1.0 - 8.0 * f64::EPSILON)
        };
        self.visit(near, best.limit, |body| {
            let within = best.loose();
            let hit = || distance_within(self.placed(body)?, shape, within);
            let hit = among(body).then(hit).flatten();
            best.take(body, hit, |hit| hit.distance)
        });
        Ok(best.found)
    }

    fn visit(&self, near: impl Fn(&Swept) -> f64, limit: f64, visit: impl FnMut(usize) -> f64) {
        let at = &self.current.position;
        self.index.visit(&self.bodies, at, near, limit, visit);
    }
}

/// A lower bound on the time when a ray enters a box, in lengths of its direction; infinity if it misses the box.
fn entry(ray: &Ray, min: DVec3, max: DVec3) -> f64 {
    let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        let (from, along) = (ray.origin[axis], ray.direction[axis]);
        let (low, high) = (min[axis] - from, max[axis] - from);
        if along == 0.0 {
            if low > 0.0 || high < 0.0 {
                return f64::INFINITY;
            }
            continue;
        }
        let (one, other) = (low / along, high / along);
        enter = enter.max(one.min(other));
        leave = leave.min(one.max(other));
    }
    let rounding = 4.0 * f64::EPSILON;
    match enter * (1.0 - rounding) <= leave * (1.0 + rounding) {
        true => enter * (1.0 - rounding),
        false => f64::INFINITY,
    }
}
