//! Many bodies in a closed box.

use kit::random::Random;
use sim_core::DVec3;

use super::{Form, Item, Scene};

/// Separate bodies in a closed box, with speeds up to 2 m/s along each axis; cubes fill an eighth of the volume. Also
/// returns half the box's side, m.
pub fn crowd(count: usize, form: &Form) -> (Scene, f64) {
    let side = (count as f64).cbrt().ceil() as usize;
    let half_box = 0.5 * side as f64;
    let mut random = Random::splitmix(count as u64);
    let mut vector = || random.vector();
    let mut items: Vec<Item> = [DVec3::X, DVec3::Y, DVec3::Z]
        .into_iter()
        .flat_map(|axis| [axis, -axis])
        .map(|normal| Item::new(Form::Wall(normal), -half_box * normal, DVec3::ZERO))
        .collect();
    for i in 0..count {
        let cell = [i % side, i / side % side, i / side / side].map(|c| c as f64 + 0.5);
        let position = DVec3::from_array(cell) - half_box + 0.2 * vector();
        // The bodies are slow enough without continuous detection between them; all fast bodies are swept against
        // walls.
        items.push(Item {
            velocity: 2.0 * vector(),
            ..Item::resting(form.clone(), position)
        });
    }
    (Scene::new(items), half_box)
}
