//! `cowbell run --record` and `cowbell replay --verify`: runs that must reproduce the same states.

use std::path::Path;

use scene::shown;

use crate::errors::step_error;
use crate::failure::Failure;
use crate::interrupt::{Interrupt, Progress};
use crate::session::{MOST_RECORDED, Record, ReplayError, is_run_file, verify};

/// Checks that a run of so many steps can be recorded in a file.
pub(super) fn check_recordable(path: &Path, steps: u64) -> Result<(), Failure> {
    if !is_run_file(path) {
        let path = shown::path(path);
        let what = format!("--record {path}: must end in .run");
        return Err(Failure::Refused(what));
    }
    if steps > MOST_RECORDED as u64 {
        return Err(Failure::Refused(format!(
            "--record: {steps} steps are too many, {MOST_RECORDED} the most"
        )));
    }
    Ok(())
}

/// Runs a recorded run again and compares every state. The first different state is a failure.
pub fn replay(file: &Path, interrupt: &Interrupt) -> Result<String, Failure> {
    let record = Record::read(file).map_err(Failure::refused)?;
    let (scene, recorded) = (record.scene.clone(), record.steps());
    let name = shown::path(file);
    interrupt.listen();
    let mut progress = Progress::new(recorded);
    let verdict = verify(record, |steps| {
        progress.at(steps);
        !interrupt.came()
    });
    progress.end();
    let verdict = verdict.map_err(|error| match error {
        ReplayError::Scene(error) => Failure::refused(error),
        ReplayError::Step(error) => Failure::Run(step_error(&scene, &error)),
        ReplayError::Input(step, error) => {
            let why = error.text(&scene);
            Failure::Run(format!(
                "{name}: the input after step {step} is refused: {why}"
            ))
        }
    })?;
    if let Some(divergence) = verdict.divergence {
        return Err(Failure::Run(format!("{name}: it {divergence}")));
    }
    let (steps, inputs) = (verdict.steps, verdict.inputs);
    interrupt.tell(steps, recorded, "steps");
    let hash = verdict.world.state_hash();
    Ok(format!(
        "{name}: {steps} of {recorded} steps and {inputs} inputs, every state the same; state hash {hash:016x}\n"
    ))
}
