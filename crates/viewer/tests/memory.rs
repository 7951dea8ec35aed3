//! What the window says of the memory that past states take up, beside what they do take up.

use std::time::Duration;

use scene::Scene;
use viewer::session::Session;

/// Memory of this process, bytes; other systems than Linux do not tell it so.
fn memory() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    let pages: f64 = text.split_ascii_whitespace().nth(1)?.parse().ok()?;
    Some(4096.0 * pages)
}

#[test]
fn the_memory_of_past_states_is_told_within_a_factor_of_two() {
    if memory().is_none() {
        return;
    }
    // What is freed would be used again, and count for nothing.
    let mut kept = Vec::new();
    for (name, states) in [("hundred-cubes", 1900), ("kepler", 3500), ("bin", 800)] {
        let scene = Scene::load(name).expect("in the gallery");
        let mut session = Session::new(scene).expect("a world");
        session.start();
        let step = Duration::from_secs_f64(session.world().settings().dt);
        let run = |session: &mut Session, states: usize| {
            while session.playback().len() < states {
                if let Some(job) = session.due(step) {
                    session.accept(job.run(|| Duration::ZERO));
                }
            }
        };
        run(&mut session, 100);
        let before = (memory().expect("it was told"), session.playback().bytes());
        let most = session.playback().capacity();
        run(&mut session, states.min(most));
        let grown = memory().expect("it was told") - before.0;
        let told = (session.playback().bytes() - before.1) as f64;
        let ratio = grown / told;
        println!("{name}: {grown} bytes, told {told}");
        assert!(
            (0.5..2.0).contains(&ratio),
            "{name}: {grown} bytes, told {told}"
        );
        kept.push(session);
    }
}
