//! Figures of the running world.

use egui::RichText;
use scene::shown;
use sim_core::{Impact, Overlap, Shape};

use super::{field, style};
use crate::number;
use crate::session::{Session, State, turns};
use crate::words::say;

/// The most overlapping pairs that are named; more would cover the picture.
const OVERLAPS: usize = 4;

/// Shows the figures.
pub(super) fn show(ui: &mut egui::Ui, session: &mut Session) {
    ui.spacing_mut().item_spacing.y = 1.0;
    ui.spacing_mut().interact_size.y = 17.0;
    figures(ui, session);
    impacts(ui, session);
    overlaps(ui, session);
}

fn figures(ui: &mut egui::Ui, session: &Session) {
    let (world, figures, drift) = (session.world(), session.figures(), session.drift());
    let none = || "-".to_owned();
    field::figure(
        ui,
        "Time",
        "Simulated time of the picture. Within a step the other figures are those of its end",
        time(session),
    );
    field::figure(
        ui,
        "Steps",
        "Steps since the start, and those taken in the last frame",
        format!("{}  ({} a frame)", world.steps(), figures.steps_per_frame),
    );
    field::figure(
        ui,
        "Step cost",
        "Real time that one step takes, averaged over the last ones",
        figures.cost.seconds().map_or_else(none, number::seconds),
    );
    field::figure(
        ui,
        "Frame time",
        "Real time from one picture to the next while running",
        figures.frame.seconds().map_or_else(none, number::seconds),
    );
    field::figure(
        ui,
        "Behind",
        "Real time given up since the start because steps came too late",
        number::seconds(figures.behind.as_secs_f64()),
    );
    let (kinetic, potential) = (world.kinetic_energy(), world.potential_energy());
    field::figure(
        ui,
        "Energy",
        "Kinetic and potential energy of all bodies together, E = Σ ½ m v² + U",
        number::energy(kinetic + potential),
    );
    field::figure(
        ui,
        "  parts",
        "Kinetic energy Σ ½ m v², and potential energy U of the forces that have one: 0 for a constant force \
         at the origin, a spring at rest, and masses infinitely far apart",
        format!(
            "{} kin.  {} pot.",
            number::energy(number::beside(kinetic, potential)),
            number::energy(number::beside(potential, kinetic))
        ),
    );
    let (name, meaning) = match drift.energy_is_error() {
        false if drift.driven => (
            "  change",
            "Change of the energy since the start or the last edit, (E - E₀)/|E₀|, and \
             in J: a driven body or a law from outside may change it, so it is no error",
        ),
        false => (
            "  change",
            "Change of the energy since the start or the last edit, (E - E₀)/|E₀|, and \
             in J: friction or inelastic impacts take it, so a loss is no error",
        ),
        true => (
            "  drift",
            "Error of the energy since the start or the last edit, (E - E₀)/|E₀|, and in \
             J: nothing that acts here would have changed it so",
        ),
    };
    field::figure(ui, name, meaning, drift.energy_text());
    let p = world.momentum();
    field::figure(
        ui,
        "Momentum",
        "Sum of mass times velocity, p = Σ m v, kg m/s",
        [p.x, p.y, p.z]
            .map(|part| number::figure(number::beside(part, drift.pushes)))
            .join("  ")
            + " kg m/s",
    );
    field::figure(
        ui,
        "  drift",
        "Error of the momentum since the start or the last edit, relative to what moved then and the \
         impulses of the forces since, and in kg m/s. Unknown where a spring, drag or attraction acts \
         from outside, or an immovable body was there to be hit",
        drift.momentum_text().unwrap_or_else(none),
    );
    if turns(world) {
        let l = world.angular_momentum_about(sim_core::DVec3::ZERO);
        field::figure(
            ui,
            "Angular m.",
            "Angular momentum about the origin, L = Σ x × m v + I ω, kg m²/s",
            number::figure(l.length()) + " kg m²/s",
        );
        field::figure(
            ui,
            "Turning",
            "What of the kinetic energy is in how bodies turn, Σ ½ L · ω",
            number::energy(world.turning_energy()),
        );
    }
    field::figure(
        ui,
        "Path error",
        "Largest distance of a body from where it would be exactly, of those for which that is known: \
         under constant forces, off floors and walls too, springs to points, linear drag and one \
         attraction, until bodies come together",
        session
            .path_error()
            .map_or_else(none, |away| format!("{} m", number::figure(away))),
    );
}

/// The time of the picture, with enough digits to distinguish instants within a step.
fn time(session: &Session) -> String {
    match session.is_between() && session.state() == State::Paused {
        true => format!("{:.6} s, within a step", session.shown_time()),
        false => format!("{:.3} s", session.shown_time()),
    }
}

fn impacts(ui: &mut egui::Ui, session: &Session) {
    let world = session.world();
    let bodies = 0..world.len();
    let triangles = bodies.clone().filter_map(|i| world.mesh(i));
    let triangles: usize = triangles.map(|mesh| mesh.triangles().len()).sum();
    field::figure(
        ui,
        "Bodies",
        "Bodies, those of them that can move and stand still, and triangles of all meshes",
        format!(
            "{}, {} at rest; {} triangles",
            world.len(),
            bodies.filter(|&i| session.is_at_rest(i)).count(),
            number::count(triangles as f64)
        ),
    );
    field::figure(
        ui,
        "Contacts",
        "Contacts that last, in the continuous mode",
        session
            .playback()
            .sample()
            .map_or_else(|| "-".to_owned(), |sample| sample.contacts.to_string()),
    );
    field::figure(
        ui,
        "Impacts",
        "Collisions answered since the start",
        world.impacts().to_string(),
    );
    let name = |i: usize| {
        session
            .scene()
            .bodies
            .get(i)
            .map_or_else(|| "?".to_owned(), |b| shown::name(&b.name))
    };
    if let Some(impact) = world.last_impact() {
        let (a, b) = impact.bodies;
        field::figure(
            ui,
            "  last",
            "The last collision: when and between which bodies",
            format!("{:.3} s  {} and {}", impact.time, name(a), name(b)),
        );
        let (first, second) = (part_name(session, impact, 0), part_name(session, impact, 1));
        field::figure(
            ui,
            "  touching",
            "What of each body touched in the last collision: a corner, an edge or a face of its \
             mesh. It is violet in the picture",
            format!("{} {} {}", say(first), say("and"), say(second)),
        );
        let (approaching, parting) = impact.speeds;
        field::figure(
            ui,
            "  impulse",
            "The impulse exchanged in the last collision, J = (1 + e) v / (1/m₁ + 1/m₂), and the speeds v \
             along its normal at which the bodies approached and part",
            format!(
                "{} N s  {} → {} m/s",
                number::figure(impact.impulse),
                number::figure(approaching),
                number::figure(parting)
            ),
        );
    }
}

/// The part of a body that touches in an impact.
fn part_name(session: &Session, impact: &Impact, which: usize) -> &'static str {
    let (i, j) = impact.bodies;
    let body = [i, j][which];
    match (session.touching(impact)[which], session.world().shape(body)) {
        (Some(part), _) => part.name(),
        (None, Some(Shape::Sphere { .. })) => "ball",
        (None, Some(Shape::HalfSpace { .. })) => "plane",
        (None, Some(Shape::Mesh(_))) => "surface",
        (None, None) => "point",
    }
}

fn overlaps(ui: &mut egui::Ui, session: &mut Session) {
    let found: Vec<Overlap> = session.overlaps().to_vec();
    if found.is_empty() {
        return;
    }
    let name = |i: usize| {
        let body = session.scene().bodies.get(i);
        shown::name(body.map_or("?", |body| body.name.as_str()))
    };
    for overlap in found.iter().take(OVERLAPS) {
        let (a, b) = overlap.bodies;
        let depth = number::figure(overlap.depth);
        let (a, b) = (name(a), name(b));
        let text = match overlap.is_least {
            true => format!("{a} and {b} overlap, {depth} m deep"),
            false => format!("{a} and {b} overlap, up to {depth} m deep"),
        };
        ui.label(RichText::new(say(text)).color(style::AMBER.of(ui.visuals())))
            .on_hover_text(say(
                "They began inside each other. They get no deeper, and may part.",
            ));
    }
    if let Some(more) = found.len().checked_sub(OVERLAPS).filter(|&more| more > 0) {
        ui.label(
            RichText::new(say(format!("and {more} more pairs")))
                .color(style::AMBER.of(ui.visuals())),
        );
    }
    let hint = "Move all that overlap out of each other, by the least that does it, heavy bodies less. \
                In the layout that changes the set-up.";
    if ui
        .button(say("Separate"))
        .on_hover_text(say(hint))
        .clicked()
    {
        session.separate();
    }
}
