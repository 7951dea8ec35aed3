//! Writes pictures of all that the renderer draws into a folder, to look at:
//! `cargo run --release -p viewer --example pictures -- FOLDER [MESH.obj]`.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use anyhow::Context;
use glam::{DQuat, DVec3, Vec3};
use sim_core::{Bvh, Mesh};
use viewer::camera::Camera;
use viewer::picture::{Arrow, Line, Model, PALETTE, Picture};
use viewer::render::offscreen::Offscreen;

const SIZE: [u32; 2] = [1280, 800];

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().context("which folder?")?;
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    let cube = Arc::new(cuboid(Vec3::splat(0.5))?);
    let shape = Arc::new(match arguments.next() {
        Some(path) => scene::mesh_file::load(Path::new(&path))?.mesh,
        None => torus(96, 48)?,
    });
    let mut offscreen = Offscreen::new()?;
    let mut take = |name: &str, picture: &Picture, size: [u32; 2]| -> anyhow::Result<()> {
        let before = Instant::now();
        let image = offscreen.shot(picture, size)?;
        println!("{name}: {:.1} ms", before.elapsed().as_secs_f64() * 1e3);
        image.save(folder.join(format!("{name}.png")))?;
        Ok(())
    };

    let mut picture = Picture {
        grid: true,
        ..Picture::default()
    };
    picture.models = vec![model(&cube, DVec3::new(0.0, 0.5, 0.0), 0)];
    take("cube", &picture, SIZE)?;
    picture.models[0].selected = true;
    take("cube-selected", &picture, SIZE)?;

    picture.models = vec![
        model(&cube, DVec3::new(-1.5, 0.5, 0.0), 0),
        model(&cube, DVec3::new(1.5, 1.5, 0.0), 1),
    ];
    picture.arrows = vec![
        arrow(DVec3::new(-1.5, 0.5, 0.0), DVec3::new(0.2, 0.5, 0.0)),
        arrow(DVec3::new(1.5, 1.5, 0.0), DVec3::new(1.0, 2.6, 0.5)),
    ];
    take("two-cubes", &picture, SIZE)?;
    picture.camera.orbit(1.0, -0.32);
    take("two-cubes-grazing", &picture, SIZE)?;
    picture.camera.orbit(0.0, 10.0);
    take("two-cubes-above", &picture, SIZE)?;

    let bounds = shape.bounds();
    let radius = bounds.half_extent().length();
    let lift = DVec3::new(0.0, f64::from(-bounds.min.y), 0.0);
    let mut picture = Picture {
        grid: true,
        models: vec![model(&shape, lift, 4)],
        ..Picture::default()
    };
    picture.camera.frame(bounds.centre() + lift, radius);
    take("shape", &picture, SIZE)?;
    picture.models[0].selected = true;
    take("shape-selected", &picture, SIZE)?;
    let close = Camera {
        distance: 0.25 * picture.camera.distance,
        ..picture.camera
    };
    let far = std::mem::replace(&mut picture.camera, close);
    take("shape-selected-close", &picture, SIZE)?;
    picture.camera = far;
    picture.models[0].selected = false;
    picture.lines = Bvh::build(&shape)
        .boxes_at(5)
        .flat_map(|bounds| box_lines(bounds.min.as_dvec3() + lift, bounds.max.as_dvec3() + lift))
        .collect();
    take("shape-boxes", &picture, SIZE)?;

    picture.lines.clear();
    picture.models = (0..400u32)
        .map(|index| {
            let (row, column) = (index / 20, index % 20);
            let at = DVec3::new(f64::from(column), 0.3, f64::from(row)) * 3.0 * radius;
            model(&shape, at + lift, index as usize)
        })
        .collect();
    picture
        .camera
        .frame(DVec3::new(30.0, 1.0, 30.0) * radius, 30.0 * radius);
    take("herd", &picture, SIZE)?;

    for (name, distance) in [("far-30m", 30.0), ("far-200m", 200.0), ("far-3km", 3e3)] {
        let mut picture = Picture {
            grid: true,
            models: vec![model(&cube, DVec3::Y, 0)],
            ..Picture::default()
        };
        picture.camera.distance = distance;
        take(name, &picture, SIZE)?;
    }
    Ok(())
}

fn model(mesh: &Arc<Mesh>, position: DVec3, colour: usize) -> Model {
    Model {
        mesh: Arc::clone(mesh),
        position,
        rotation: DQuat::IDENTITY,
        colour: PALETTE[colour % PALETTE.len()],
        selected: false,
    }
}

fn arrow(from: DVec3, to: DVec3) -> Arrow {
    Arrow {
        from,
        to,
        colour: [0.85, 0.2, 0.3],
        radius: 0.04,
    }
}

fn box_lines(min: DVec3, max: DVec3) -> Vec<Line> {
    let corner = |index: usize| {
        let pick = |bit: usize, low, high| if index & bit == 0 { low } else { high };
        DVec3::new(
            pick(1, min.x, max.x),
            pick(2, min.y, max.y),
            pick(4, min.z, max.z),
        )
    };
    let ends = (0..8).flat_map(|from| [1, 2, 4].map(|bit| (from, from | bit)));
    ends.filter(|(from, to)| from != to)
        .map(|(from, to)| Line {
            from: corner(from),
            to: corner(to),
            colour: [0.1, 0.35, 0.75, 0.8],
            width: 1.2,
        })
        .collect()
}

fn cuboid(half: Vec3) -> anyhow::Result<Mesh> {
    let vertices = (0..8)
        .map(|index| {
            let sign = |bit: u32| if index & bit == 0 { -1.0 } else { 1.0 };
            half * Vec3::new(sign(1), sign(2), sign(4))
        })
        .collect();
    let faces = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let triangles = faces
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    Ok(Mesh::new(vertices, triangles)?)
}

fn torus(around: u32, across: u32) -> anyhow::Result<Mesh> {
    let angle = |index: u32, count: u32| std::f32::consts::TAU * index as f32 / count as f32;
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for u in 0..around {
        for v in 0..across {
            let ((sin_u, cos_u), (sin_v, cos_v)) =
                (angle(u, around).sin_cos(), angle(v, across).sin_cos());
            let reach = 1.0 + 0.4 * cos_v;
            vertices.push(Vec3::new(reach * cos_u, 0.4 * sin_v, reach * sin_u));
            let at = |u: u32, v: u32| (u % around) * across + v % across;
            triangles.push([at(u, v), at(u, v + 1), at(u + 1, v + 1)]);
            triangles.push([at(u, v), at(u + 1, v + 1), at(u + 1, v)]);
        }
    }
    Ok(Mesh::repaired(vertices, triangles)?.0)
}
