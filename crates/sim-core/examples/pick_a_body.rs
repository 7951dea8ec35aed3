//! Which body is under the cursor? A ray from the eye, and the body that it hits first.

use sim_core::{Body, DVec3, Settings, Shape, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut world = World::new(Settings::default())?;
    let shape = Some(Shape::Sphere { radius: 0.5 });
    for i in 0..5 {
        let position = DVec3::new(2.0 * f64::from(i), 0.0, 0.0);
        world.add(Body {
            shape: shape.clone(),
            position,
            ..Body::default()
        })?;
    }
    // The eye stands in the first body, which is left out.
    let eye = DVec3::ZERO;
    let is_other = |body: usize| body != 0;
    match world.cast_ray(eye, DVec3::new(1.0, 0.1, 0.0), is_other)? {
        Some((body, hit)) => println!(
            "body {body} at {}, with the normal {}",
            hit.points[0], hit.normal
        ),
        None => println!("nothing"),
    }
    Ok(())
}
