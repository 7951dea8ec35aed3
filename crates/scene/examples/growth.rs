//! How loading and stepping grow with the number of bodies.
//!
//! `cargo run --release -p scene --example growth`; with a number, up to so many bodies.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

use glam::DVec3;
use scene::{MeshRef, Scene};
use sim_core::{Body, Collision, Settings, Shape, World};

fn main() -> Result<(), Box<dyn Error>> {
    let most = std::env::args().nth(1).map(|most| most.parse());
    let most: usize = most.transpose()?.unwrap_or(100_000);
    let counts = [10, 100, 1_000, 10_000, 100_000];
    let counts = || counts.into_iter().filter(|&n| n <= most);
    let cube = MeshRef::builtin("cube.obj").ok_or("there is no cube")?;
    let cube = Shape::Mesh(cube.mesh().clone());

    println!("bodies apart in a slow crowd, ms\n");
    println!("| what | mode | n | add | overlaps | first step | a step |");
    println!("|---|---|---|---|---|---|---|");
    for (what, shape) in [("cubes", Some(&cube)), ("balls of n radii", None)] {
        for mode in [Collision::Continuous, Collision::Bvh, Collision::Naive] {
            for n in counts() {
                crowd(what, shape, mode, n)?;
            }
        }
    }

    println!("\ncubes in one place, ms\n");
    println!("| n | add | overlaps |");
    println!("|---|---|---|");
    for n in [100, 200, 400, 800] {
        let mut world = World::new(Settings::default())?;
        let (added, adding) = time(|| (0..n).try_for_each(|_| add(&mut world, &cube, DVec3::ZERO)));
        added?;
        let (pairs, seeking) = time(|| world.overlapping().len());
        assert_eq!(pairs, n * (n - 1) / 2);
        println!("| {n} | {adding:.2} | {seeking:.2} |");
    }

    println!("\nscene files, ms\n");
    println!("| what | bodies | read | world | overlaps | first step |");
    println!("|---|---|---|---|---|---|");
    for n in counts() {
        file("cubes, a table each", &tables(n), true)?;
        file("the same, turned in two ways", &turned(n), true)?;
        file("ten tables of copies", &copies(n / 10), true)?;
        file("a chain of springs", &chain(n), true)?;
    }
    let text = (0..800).fold(HEADER.to_owned(), |text, i| {
        text + &format!("[[body]]\nname = \"{i}\"\nmesh = \"cube.obj\"\n")
    });
    // To part them is another matter.
    file("cubes in one place", &text, false)
}

/// Bodies in a grid, each 3 m from the next.
fn crowd(
    what: &str,
    shape: Option<&Shape>,
    collision: Collision,
    n: usize,
) -> Result<(), Box<dyn Error>> {
    let mut world = World::new(Settings {
        collision,
        ..Settings::default()
    })?;
    let (added, adding) = time(|| {
        (0..n).try_for_each(|i| {
            let radius = 0.5 + i as f64 / (4 * n) as f64;
            let ball = Shape::Sphere { radius };
            add(&mut world, shape.unwrap_or(&ball), place(i, n))
        })
    });
    added?;
    let (pairs, seeking) = time(|| world.overlapping().len());
    assert_eq!(pairs, 0);
    let (stepped, first) = time(|| world.step());
    stepped?;
    let (stepped, steps) = time(|| (0..20).try_for_each(|_| world.step()));
    stepped?;
    let step = steps / 20.0;
    println!(
        "| {what} | {collision:?} | {n} | {adding:.2} | {seeking:.2} | {first:.2} | {step:.3} |"
    );
    Ok(())
}

fn place(i: usize, n: usize) -> DVec3 {
    let side = (n as f64).cbrt().ceil() as usize;
    let [x, y, z] = [i % side, i / side % side, i / side / side].map(|place| place as f64);
    3.0 * DVec3::new(x, y, z)
}

fn add(world: &mut World, shape: &Shape, position: DVec3) -> Result<(), Box<dyn Error>> {
    let number = world.len() as f64;
    let [x, y, z] = [1.7, 2.3, 3.1].map(|by| (by * number).sin());
    world.add(Body {
        shape: Some(shape.clone()),
        position,
        velocity: DVec3::new(x, y, z),
        ..Body::default()
    })?;
    Ok(())
}

const HEADER: &str = "rate = 60\n";

fn tables(n: usize) -> String {
    (0..n).fold(HEADER.to_owned(), |mut text, i| {
        let DVec3 { x, y, z } = place(i, n);
        let _ = writeln!(text, "[[body]]\nmesh = \"cube.obj\"\nname = \"cube {i}\"");
        let _ = writeln!(text, "position = [{x}, {y}, {z}]");
        text
    })
}

fn turned(n: usize) -> String {
    let mut turns = [15, 30].into_iter().cycle();
    tables(n).lines().fold(String::new(), |mut text, line| {
        let _ = writeln!(text, "{line}");
        if line.starts_with("position") {
            let _ = writeln!(text, "rotation = [0, {}, 0]", turns.next().unwrap_or(0));
        }
        text
    })
}

fn chain(n: usize) -> String {
    let text = tables(n).replace("mesh = \"cube.obj\"", "sphere = 0.1");
    (1..n).fold(text, |mut text, i| {
        let ends = format!("[\"cube {}\", \"cube {i}\"]", i - 1);
        let _ = writeln!(text, "[[force]]\nkind = \"spring\"\nbodies = {ends}");
        let _ = writeln!(text, "rest_length = 3\nstiffness = 10");
        text
    })
}

fn copies(each: usize) -> String {
    let side = 6.0 * (each as f64).cbrt().ceil();
    (0..10).fold(HEADER.to_owned(), |mut text, i| {
        let near = 2.0 * side * f64::from(i);
        let far = near + side;
        let _ = writeln!(text, "[[body]]\nmesh = \"cube.obj\"\nname = \"cubes {i}\"");
        let _ = writeln!(text, "rotation = [0, 15, 0]\ncopies = {each}");
        let _ = writeln!(text, "inside = [[{near}, 0, 0], [{far}, {side}, {side}]]");
        text
    })
}

fn file(what: &str, text: &str, is_stepped: bool) -> Result<(), Box<dyn Error>> {
    let (scene, reading) = time(|| Scene::parse(text, Path::new("growth.toml")));
    let scene = scene?;
    let (world, loading) = time(|| scene.world());
    let mut world = world?;
    let (_, seeking) = time(|| world.overlapping().len());
    print!(
        "| {what} | {} | {reading:.1} | {loading:.1} | {seeking:.1} |",
        world.len()
    );
    if is_stepped {
        let (stepped, first) = time(|| world.step());
        stepped?;
        print!(" {first:.1}");
    }
    println!(" |");
    Ok(())
}

/// What something gives, and how many milliseconds it takes.
fn time<T>(act: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let given = act();
    (given, 1e3 * start.elapsed().as_secs_f64())
}
