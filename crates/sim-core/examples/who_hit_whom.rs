//! Who hit whom, how hard, and who lies on whom? The contacts that began, persisted and ended in each step.

use sim_core::{Body, BodyKind, ContactEventKind, DVec3, Force, Settings, Shape, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut world = World::new(Settings::default())?;
    world.add(Body {
        shape: Some(Shape::HalfSpace { normal: DVec3::Y }),
        kind: BodyKind::Static,
        restitution: 0.3,
        ..Body::default()
    })?;
    world.add(Body {
        shape: Some(Shape::Sphere { radius: 0.5 }),
        position: DVec3::new(0.0, 2.0, 0.0),
        restitution: 0.3,
        ..Body::default()
    })?;
    world.add_force(Force::Gravity {
        acceleration: DVec3::new(0.0, -9.81, 0.0),
    })?;

    world.list_contact_events(true);
    let mut persisting = 0;
    while world.time() < 3.0 {
        world.step()?;
        for event in world.contact_events() {
            match event.kind {
                ContactEventKind::Persisting => persisting += 1,
                kind => println!(
                    "{:.3} s: {kind:?} {:?} at {:.3}, {:.3} N s",
                    world.time(),
                    event.bodies,
                    event.point,
                    event.impulse.length()
                ),
            }
        }
    }
    println!("and {persisting} steps on the floor");
    Ok(())
}
