//! Cases 9 to 27 and 29: impacts.

pub(super) mod balls;
pub mod chains;
pub(super) mod crowd;
pub(super) mod meshes;
pub(super) mod pairs;
pub(super) mod symmetry;

use std::sync::Arc;

use sim_core::{
    Body, BodyKind, Collision, DVec3, Impact, Mesh, Method, Settings, Shape, StepError, Vec3,
    World, WorldError,
};

use super::{Finding, Tried};

const ULP: f64 = f64::EPSILON;
const DT: f64 = 1.0 / 60.0;
const PHASES: u32 = 16;

fn settings(dt: f64) -> Settings {
    Settings {
        dt,
        collision: Collision::Continuous,
        // Exact in flight.
        method: Method::named("velocity-verlet").unwrap_or(Settings::default().method),
        ..Settings::default()
    }
}

fn world(settings: Settings, bodies: &[Body]) -> Result<World, WorldError> {
    let mut world = World::new(settings)?;
    for body in bodies {
        world.add(body.clone())?;
    }
    Ok(world)
}

fn run(world: &mut World, steps: u64) -> Result<Vec<Impact>, StepError> {
    let mut impacts = Vec::new();
    for _ in 0..steps {
        world.step_reporting(&mut impacts)?;
    }
    Ok(impacts)
}

fn body(shape: Shape, position: DVec3, velocity: DVec3) -> Body {
    Body {
        shape: Some(shape),
        position,
        velocity,
        ..Body::default()
    }
}

fn ball(radius: f64, position: DVec3, velocity: DVec3) -> Body {
    body(Shape::Sphere { radius }, position, velocity)
}

fn mesh(mesh: &Arc<Mesh>, position: DVec3, velocity: DVec3) -> Body {
    body(Shape::Mesh(mesh.clone()), position, velocity)
}

fn immovable(body: Body) -> Body {
    Body {
        kind: BodyKind::Kinematic,
        ..body
    }
}

fn wall(normal: DVec3, position: DVec3, velocity: DVec3) -> Body {
    immovable(body(Shape::HalfSpace { normal }, position, velocity))
}

fn builtin(name: &str) -> anyhow::Result<Arc<Mesh>> {
    scene::mesh_file::builtin(name).ok_or_else(|| anyhow::anyhow!("no mesh {name}"))
}

/// A box about a point, made of the cube.
fn cuboid(half: Vec3, middle: Vec3) -> anyhow::Result<Mesh> {
    let cube = builtin("cube.obj")?;
    let vertices = cube.vertices().iter().map(|&v| middle + 2.0 * v * half);
    Ok(Mesh::new(vertices.collect(), cube.triangles().to_vec())?)
}

/// Several meshes as one.
fn joined(parts: &[Mesh]) -> anyhow::Result<Mesh> {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for part in parts {
        let first = vertices.len() as u32;
        vertices.extend_from_slice(part.vertices());
        triangles.extend(part.triangles().iter().map(|t| t.map(|v| v + first)));
    }
    Ok(Mesh::new(vertices, triangles)?)
}

/// The greatest of some figures; a figure that is none is the greatest.
fn worst(figures: impl IntoIterator<Item = f64>) -> f64 {
    figures
        .into_iter()
        .fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a })
}

/// Relative change of the kinetic energy, and change of the momentum, of the sum of momenta.
fn lost(world: &World, start: &World) -> f64 {
    let energy = world.kinetic_energy() / start.kinetic_energy() - 1.0;
    let all = (0..start.len()).filter(|&i| start.kind(i).is_movable());
    let momenta: f64 = all
        .map(|i| start.mass(i) * start.velocity(i).length())
        .sum();
    let momentum = (world.momentum() - start.momentum()).length() / momenta;
    energy.abs().max(momentum)
}

fn motions(world: &World) -> Vec<(DVec3, DVec3)> {
    (0..world.len())
        .map(|i| (world.position(i), world.velocity(i)))
        .collect()
}

/// Greatest difference of positions and velocities, by component.
fn apart(first: &[(DVec3, DVec3)], second: &[(DVec3, DVec3)]) -> f64 {
    worst(first.iter().zip(second).map(|(a, b)| {
        let (x, v) = ((a.0 - b.0).abs(), (a.1 - b.1).abs());
        x.max_element().max(v.max_element())
    }))
}
