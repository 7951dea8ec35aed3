//! Runs and checks without a window, as text or JSON. They need neither display nor graphics adapter.

mod compare;
mod replay;

pub use compare::{Form, compare};
pub use replay::replay;

use std::fmt::Write;
use std::path::Path;

use scene::{MeshReport, Scene, file, mesh_file, shown};
use serde::Serialize;
use sim_core::{DVec3, Overlap, World};

use crate::errors::{NAMED, names, separate_error, step_error};
use crate::failure::Failure;
use crate::interrupt::{Interrupt, Progress};
use crate::number;
use crate::session::{Drift, Exact, Halt, Record, Reference, Runner, csv_head, csv_line, turns};
use crate::stopwatch::Stopwatch;

/// The final state of a run. Numbers are f64 and stay equal bit for bit in JSON.
#[derive(Serialize)]
struct RunReport<'a> {
    time: f64,
    steps: u64,
    impacts: u64,
    kinetic_energy: f64,
    /// The rotational part of the kinetic energy, if there are turning bodies.
    #[serde(skip_serializing_if = "Option::is_none")]
    turning_energy: Option<f64>,
    potential_energy: Option<f64>,
    total_energy: Option<f64>,
    /// The relative change of the total energy since the start; `None` if the energy was 0.
    energy_drift: Option<f64>,
    /// The change in J.
    energy_error: Option<f64>,
    /// Whether friction or an inelastic impact may have dissipated energy; a loss is then no error.
    dissipates: bool,
    /// Whether something may have added or removed energy; then no change is an error.
    driven: bool,
    momentum_drift: Option<f64>,
    momentum_error: Option<f64>,
    path_error: Option<f64>,
    momentum: [f64; 3],
    last_impact: Option<ImpactReport<'a>>,
    /// The overlaps at the start.
    overlaps: Vec<OverlapReport<'a>>,
    /// Names of the bodies that were moved apart before the start.
    separated: Vec<&'a str>,
    /// The contacts at the end.
    contacts: Vec<ContactReport<'a>>,
    /// [`World::state_hash`], in hexadecimal digits.
    state_hash: String,
    bodies: Vec<BodyReport<'a>>,
}

/// The latest impact.
#[derive(Serialize)]
struct ImpactReport<'a> {
    time: f64,
    bodies: [&'a str; 2],
    point: [f64; 3],
    normal: [f64; 3],
    impulse: f64,
    approaching: f64,
    parting: f64,
}

/// Two bodies in overlap.
#[derive(Serialize)]
struct OverlapReport<'a> {
    bodies: [&'a str; 2],
    depth: f64,
    /// Whether the depth is the least one; otherwise it is an upper bound.
    is_least: bool,
    normal: [f64; 3],
}

/// Two bodies in contact along a normal.
#[derive(Serialize)]
struct ContactReport<'a> {
    bodies: [&'a str; 2],
    /// The number of touching features.
    count: usize,
    normal: [f64; 3],
    gap: f64,
    is_overlap: bool,
}

/// The initial data of a run.
struct Start<'a> {
    overlaps: Vec<OverlapReport<'a>>,
    separated: Vec<&'a str>,
}

#[derive(Serialize)]
struct BodyReport<'a> {
    name: &'a str,
    /// The mass; `None` for an immovable body.
    mass: Option<f64>,
    /// The position of its origin.
    position: [f64; 3],
    velocity: [f64; 3],
    #[serde(flatten)]
    turn: Option<TurnReport>,
}

/// The rotational state of a turning body.
#[derive(Serialize)]
struct TurnReport {
    /// A unit quaternion: x, y, z, w.
    rotation: [f64; 4],
    spin: [f64; 3],
    /// The angular momentum about its centre of mass.
    angular_momentum: [f64; 3],
}

/// The contents of a mesh file.
#[derive(Serialize)]
struct CheckReport {
    format: &'static str,
    vertices: usize,
    triangles: usize,
    closed: bool,
    oriented: bool,
    volume: Option<f64>,
    boundary_edges: usize,
    non_manifold_edges: usize,
    components: usize,
    extent: [f64; 3],
    unit: Option<f64>,
    up_axis: Option<char>,
    repairs: Vec<RepairReport>,
}

#[derive(Serialize)]
struct RepairReport {
    kind: &'static str,
    count: usize,
}

/// The output of `run` for the final state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunForm {
    /// A table.
    Table,
    /// A JSON object.
    Json,
    /// The hash of the state.
    Hash,
}

/// Takes `steps` steps of a scene, fewer after an interrupt, and returns the final state in the given format. With
/// `separate`, bodies in overlap are first moved apart. With a path, the run is recorded in that file.
pub fn run(
    scene: &Scene,
    steps: u64,
    (form, separate): (RunForm, bool),
    record: Option<&Path>,
    interrupt: &Interrupt,
) -> Result<String, Failure> {
    let mut world = scene.world().map_err(Failure::refused)?;
    let separated = match separate {
        true => world.separate().map_err(|error| {
            let name = shown::name(&scene.name);
            Failure::Refused(format!("scene `{name}`: {}", separate_error(scene, &error)))
        })?,
        false => Vec::new(),
    };
    let name = |body: usize| scene.bodies[body].name.as_str();
    let overlap = |overlap: Overlap| OverlapReport {
        bodies: [overlap.bodies.0, overlap.bodies.1].map(name),
        depth: overlap.depth,
        is_least: overlap.is_least,
        normal: overlap.normal.to_array(),
    };
    let start = Start {
        overlaps: world.overlaps().into_iter().map(overlap).collect(),
        separated: separated.into_iter().map(name).collect(),
    };
    let (reference, mut exact) = (Reference::of(&world), Exact::of(&world));
    interrupt.listen();
    let mut recorded = match record {
        Some(path) => {
            replay::check_recordable(path, steps)?;
            Some(Record::begin(scene, &world))
        }
        None => None,
    };
    let mut progress = Progress::new(steps);
    let stopwatch = Stopwatch::start();
    while world.steps() < steps && !interrupt.came() {
        let stepped = world.step();
        if let Err(error) = stepped {
            progress.end();
            return Err(Failure::Run(step_error(scene, &error)));
        }
        if let Some(recorded) = &mut recorded {
            recorded.push(world.steps(), world.state_hash());
        }
        progress.at(world.steps());
    }
    let seconds_per_step = stopwatch.read().as_secs_f64() / world.steps().max(1) as f64;
    progress.end();
    interrupt.tell(world.steps(), steps, "steps");
    if let Some((path, recorded)) = record.zip(recorded) {
        let text = recorded.text_at(path).map_err(Failure::refused)?;
        file::write(path, text.as_bytes()).map_err(|error| {
            let path = shown::path(path);
            Failure::Refused(format!("cannot write {path}: {error}"))
        })?;
    }
    let drift = reference.drift(&world);
    let report = RunReport::of(scene, &world, start, (&drift, exact.error(&world)));
    Ok(match form {
        RunForm::Json => to_json(&report),
        RunForm::Hash => format!("{}\n", report.state_hash),
        RunForm::Table => report.table(scene, &drift, seconds_per_step),
    })
}

/// Takes `steps` steps of a scene, fewer after an interrupt, and returns the figures of every state as CSV.
pub fn run_csv(scene: &Scene, steps: u64, interrupt: &Interrupt) -> Result<String, Failure> {
    let world = scene.world().map_err(Failure::refused)?;
    let runner = Runner::stepping(&world, *world.settings()).map_err(Failure::refused)?;
    let mut runner = runner.profiled();
    interrupt.listen();
    let mut text = csv_head(false) + &csv_line(None, &runner.snapshot(None, 0).sample);
    let mut progress = Progress::new(steps);
    let stopwatch = Stopwatch::start();
    for step in 1..=steps {
        if interrupt.came() {
            break;
        }
        match runner.step(&|| stopwatch.read()) {
            Ok(snapshot) => text += &csv_line(None, &snapshot.sample),
            Err(Halt::Step(error)) => {
                progress.end();
                return Err(Failure::Run(step_error(scene, &error)));
            }
            Err(Halt::Unknown) => break,
        }
        progress.at(step);
    }
    progress.end();
    Ok(text)
}

/// Reads a mesh file and returns its figures as JSON or text.
pub fn check(file: &Path, json: bool) -> Result<String, Failure> {
    let loaded = mesh_file::load(file).map_err(Failure::refused)?;
    let figures = loaded.report();
    let report = CheckReport {
        format: loaded.format,
        vertices: figures.vertices,
        triangles: figures.triangles,
        closed: figures.closed,
        oriented: figures.oriented,
        volume: figures.volume,
        boundary_edges: figures.boundary_edges,
        non_manifold_edges: figures.non_manifold_edges,
        components: figures.components,
        extent: figures.extent,
        unit: figures.unit,
        up_axis: figures.up_axis,
        repairs: repairs(&figures),
    };
    Ok(if json {
        to_json(&report)
    } else {
        report.text()
    })
}

fn to_json(report: &impl Serialize) -> String {
    // Serializing cannot fail, because these are plain structs of numbers and text.
    serde_json::to_string(report).map_or_else(
        |error| error.to_string(),
        |text| {
            let mut safe = String::with_capacity(text.len() + 1);
            for character in text.chars() {
                if shown::is_unsafe(character) {
                    // Such characters occur only in strings, and there the escape is equivalent.
                    for unit in character.encode_utf16(&mut [0; 2]) {
                        let _ = write!(safe, "\\u{unit:04x}");
                    }
                } else {
                    safe.push(character);
                }
            }
            safe + "\n"
        },
    )
}

fn repairs(repairs: &MeshReport) -> Vec<RepairReport> {
    [
        ("welded_vertices", repairs.welded_vertices),
        ("degenerate_triangles", repairs.degenerate_triangles),
        ("duplicate_triangles", repairs.duplicate_triangles),
        ("unreferenced_vertices", repairs.unreferenced_vertices),
        ("flipped_triangles", repairs.flipped_triangles),
        ("flat_instances", repairs.flat_instances),
    ]
    .into_iter()
    .filter(|&(_, count)| count > 0)
    .map(|(kind, count)| RepairReport { kind, count })
    .collect()
}

impl<'a> RunReport<'a> {
    fn of(
        scene: &'a Scene,
        world: &World,
        start: Start<'a>,
        (drift, path_error): (&Drift, Option<f64>),
    ) -> Self {
        let name = |body: usize| scene.bodies[body].name.as_str();
        Self {
            time: world.time(),
            steps: world.steps(),
            impacts: world.impacts(),
            kinetic_energy: world.kinetic_energy(),
            turning_energy: turns(world).then(|| world.turning_energy()),
            potential_energy: Some(world.potential_energy()).filter(|energy| energy.is_finite()),
            total_energy: Some(world.kinetic_energy() + world.potential_energy())
                .filter(|energy| energy.is_finite()),
            energy_drift: drift.relative_energy,
            energy_error: drift.energy,
            dissipates: drift.dissipates,
            driven: drift.driven,
            momentum_drift: drift.relative_momentum,
            momentum_error: drift.momentum,
            path_error,
            momentum: world.momentum().to_array(),
            last_impact: world.last_impact().map(|impact| ImpactReport {
                time: impact.time,
                bodies: [impact.bodies.0, impact.bodies.1].map(name),
                point: impact.point.to_array(),
                normal: impact.normal.to_array(),
                impulse: impact.impulse,
                approaching: impact.speeds.0,
                parting: impact.speeds.1,
            }),
            overlaps: start.overlaps,
            separated: start.separated,
            contacts: world
                .contacts()
                .map(|contact| ContactReport {
                    bodies: [contact.bodies.0, contact.bodies.1].map(name),
                    count: world.contact_features(&contact).len(),
                    normal: contact.normal.to_array(),
                    gap: contact.gap,
                    is_overlap: contact.is_overlap,
                })
                .collect(),
            state_hash: format!("{:016x}", world.state_hash()),
            bodies: scene
                .bodies
                .iter()
                .enumerate()
                .map(|(i, body)| BodyReport {
                    name: &body.name,
                    mass: world.kind(i).is_movable().then(|| world.mass(i)),
                    position: world.origin(i).to_array(),
                    velocity: world.velocity(i).to_array(),
                    turn: world.turns(i).then(|| TurnReport {
                        rotation: world.rotation(i).to_array(),
                        spin: world.spin(i).to_array(),
                        angular_momentum: world.angular_momentum(i).to_array(),
                    }),
                })
                .collect(),
        }
    }

    fn table(&self, scene: &Scene, drift: &Drift, seconds_per_step: f64) -> String {
        let mut text = String::new();
        let settings = format!(
            "{} steps of {} s, {}, {}",
            self.steps,
            scene.dt,
            scene.method.name,
            collision_name(scene)
        );
        let lines = [
            ("Scene", shown::part(&scene.title)),
            ("Run", settings),
            ("Time", format!("{} s", self.time)),
            ("Impacts", self.impacts.to_string()),
            (
                "Last impact",
                self.last_impact
                    .as_ref()
                    .map_or_else(|| "none".to_owned(), ImpactReport::text),
            ),
            ("Contacts", self.contacts_text()),
            ("Kinetic energy", self.kinetic_text()),
            ("Potential", joules(self.potential_energy)),
            ("Total energy", joules(self.total_energy)),
            (
                "Momentum",
                format!("{} kg m/s", vector(self.momentum.into()).trim_start()),
            ),
            ("Speed", format!("{:.3} µs a step", seconds_per_step * 1e6)),
            ("State hash", self.state_hash.clone()),
            ("Energy drift", energy_drift(drift)),
            (
                "Momentum drift",
                drift.momentum_text().unwrap_or_else(|| {
                    "unknown: what acts from outside, or is immovable, changes it".to_owned()
                }),
            ),
            (
                "Path error",
                self.path_error.map_or_else(
                    || "unknown: no exact path is known of a body, or not any more".to_owned(),
                    |away| format!("{} m", number::figure(away)),
                ),
            ),
        ];
        for (what, value) in lines {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{what:<15} {value}");
        }
        self.add_overlaps(&mut text);
        let width = self
            .bodies
            .iter()
            .map(|body| shown::name(body.name).chars().count())
            .max()
            .unwrap_or(0)
            .max(4);
        let _ = writeln!(
            text,
            "\n{:<width$} {:>10} {:>38} {:>38}",
            "Body", "mass, kg", "position, m", "velocity, m/s"
        );
        for body in &self.bodies {
            let _ = writeln!(
                text,
                "{:<width$} {:>10} {:>38} {:>38}",
                shown::name(body.name),
                body.mass
                    .map_or_else(|| "immovable".to_owned(), |mass| mass.to_string()),
                vector(body.position.into()),
                vector(body.velocity.into())
            );
        }
        text
    }
}

impl RunReport<'_> {
    fn kinetic_text(&self) -> String {
        let turning = self.turning_energy;
        let turning = turning.map_or_else(String::new, |j| format!(", {j} J of it in turning"));
        format!("{} J{turning}", self.kinetic_energy)
    }

    fn contacts_text(&self) -> String {
        let mut pairs: Vec<_> = self.contacts.iter().map(|c| c.bodies).collect();
        pairs.sort_unstable();
        pairs.dedup();
        match pairs.len() {
            0 => "none".to_owned(),
            1 => "of one pair of bodies".to_owned(),
            count => format!("of {count} pairs of bodies"),
        }
    }

    /// Adds the overlaps of the start, or the bodies that were moved apart.
    fn add_overlaps(&self, text: &mut String) {
        if !self.separated.is_empty() {
            let names = names(&self.separated);
            let _ = writeln!(text, "{:<15} {names}, moved out of overlap", "Separated");
        }
        for overlap in self.overlaps.iter().take(NAMED) {
            let _ = writeln!(text, "{:<15} {}", "Overlap", overlap.text());
        }
        if self.overlaps.len() > NAMED {
            let more = self.overlaps.len() - NAMED;
            let _ = writeln!(text, "{:<15} and {more} more pairs", "");
        }
        if !self.overlaps.is_empty() {
            let _ = writeln!(
                text,
                "{:<15} they get no deeper and may part; --separate moves them apart first",
                ""
            );
        }
    }
}

impl OverlapReport<'_> {
    fn text(&self) -> String {
        let [first, second] = self.bodies.map(shown::name);
        let depth = number::figure(self.depth);
        let bound = if self.is_least { "" } else { "up to " };
        format!("{first} and {second} at the start, {bound}{depth} m deep")
    }
}

impl ImpactReport<'_> {
    fn text(&self) -> String {
        format!(
            "{} s, {} and {}, {} N s, {} m/s before and {} m/s after",
            self.time,
            shown::name(self.bodies[0]),
            shown::name(self.bodies[1]),
            self.impulse,
            number::figure(self.approaching),
            number::figure(self.parting)
        )
    }
}

/// The change of the energy, and whether it is an error if that is not obvious.
fn energy_drift(drift: &Drift) -> String {
    let why = match (drift.energy, drift.energy_is_error()) {
        (None, _) => "",
        (_, true) if drift.dissipates => ", an error: friction and impacts only take energy",
        (_, true) => "",
        (_, false) if drift.driven => ", no error: what drives the bodies changes it",
        (_, false) => ", no error: friction or impacts take it",
    };
    drift.energy_text() + why
}

fn joules(energy: Option<f64>) -> String {
    energy.map_or_else(
        || "unbounded: a body is at a centre of attraction".to_owned(),
        |energy| format!("{energy} J"),
    )
}

fn vector(v: DVec3) -> String {
    let cell = |part: f64| {
        // Very small and very large numbers get an exponent, so that the columns stay aligned.
        let text = if part == 0.0 || (1e-4..1e5).contains(&part.abs()) {
            format!("{part:.6}")
        } else {
            format!("{part:.4e}")
        };
        format!("{text:>12}")
    };
    v.to_array().map(cell).join(" ")
}

fn collision_name(scene: &Scene) -> &'static str {
    match scene.collision {
        sim_core::Collision::Naive => "naive",
        sim_core::Collision::Bvh => "bvh",
        sim_core::Collision::Continuous => "continuous",
    }
}

impl CheckReport {
    fn text(&self) -> String {
        let yes = |is| if is { "yes" } else { "no" };
        let volume = self.volume.map_or_else(
            || "none: the surface does not enclose one".to_owned(),
            |volume| format!("{volume} m^3"),
        );
        let unsaid = || "not said in the file".to_owned();
        let unit = self.unit.map_or_else(unsaid, |unit| format!("{unit} m"));
        let up_axis = self.up_axis.map_or_else(unsaid, |axis| axis.to_string());
        let mut text = format!(
            "Format     {}\nVertices   {}\nTriangles  {}\nClosed     {}\nOriented   {}\nVolume     {volume}\n\
             Edges      {} of one triangle, {} of more than two\nPieces     {}\n\
             Extent     {} by {} by {} m\nUnit       {unit}\nUp axis    {up_axis}\n",
            self.format,
            self.vertices,
            self.triangles,
            yes(self.closed),
            yes(self.oriented),
            self.boundary_edges,
            self.non_manifold_edges,
            self.components,
            self.extent[0],
            self.extent[1],
            self.extent[2],
        );
        for repair in &self.repairs {
            let _ = writeln!(text, "Repaired   {}: {}", repair.kind, repair.count);
        }
        text
    }
}
