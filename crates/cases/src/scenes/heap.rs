//! Bodies that fall between walls and form a heap.

use kit::random::Random;
use sim_core::DVec3;

use super::{Form, Item, Scene};

/// Layers of `side` by `side` bodies, a fifth of a body apart, above a floor.
pub fn heap(form: &Form, count: usize, side: usize, restitution: f64, friction: f64) -> Scene {
    let half_of_one = Item::resting(form.clone(), DVec3::ZERO).half();
    let pitch = 2.4 * half_of_one;
    let half = 0.5 * pitch * side as f64;
    let mut random = Random::splitmix(5);
    let mut items = vec![Item::resting(Form::Wall(DVec3::Y), DVec3::ZERO)];
    for normal in [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z] {
        items.push(Item::resting(Form::Wall(normal), -half * normal));
    }
    for i in 0..count {
        let cell = [i % side, i / side / side, i / side % side].map(|c| c as f64 + 0.5);
        let shake = 0.08 * half_of_one * random.vector();
        let at = DVec3::from_array(cell) * pitch - DVec3::new(half.x, 0.0, half.z) + shake;
        items.push(Item::resting(form.clone(), at));
    }
    Scene {
        restitution,
        friction,
        may_sleep: true,
        ..Scene::falling(items)
    }
}
