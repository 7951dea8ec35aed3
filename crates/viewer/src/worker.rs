//! A thread that takes steps or measures, so that the window never waits for what is slow.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

use crate::stopwatch::Stopwatch;

/// The other end of the thread. Dropped, it lets the thread end after its present job.
pub struct Worker<Job, Done> {
    jobs: Sender<Job>,
    results: Receiver<Done>,
    thread: JoinHandle<()>,
    busy: bool,
}

impl<Job: Send + 'static, Done: Send + 'static> Worker<Job, Done> {
    /// Starts a thread that does jobs by `run`.
    pub fn start(name: &str, run: fn(Job, &Stopwatch) -> Done) -> std::io::Result<Self> {
        let (jobs, to_do) = channel::<Job>();
        let (finished, results) = channel();
        let stopwatch = Stopwatch::start();
        let thread = std::thread::Builder::new()
            .name(name.to_owned())
            .spawn(move || {
                for job in to_do {
                    if finished.send(run(job, &stopwatch)).is_err() {
                        break;
                    }
                }
            })?;
        Ok(Self {
            jobs,
            results,
            thread,
            busy: false,
        })
    }

    /// Hands over a job.
    pub fn hand_over(&mut self, job: Job) {
        // If the thread is gone, `is_gone` tells.
        self.busy = self.jobs.send(job).is_ok();
    }

    /// A result, if one comes within this time.
    pub fn result(&mut self, within: Duration) -> Option<Done> {
        let done = self.results.recv_timeout(within).ok()?;
        self.busy = false;
        Some(done)
    }

    /// Whether a job is under way.
    pub fn is_busy(&self) -> bool {
        self.busy
    }

    /// Whether the thread has broken down.
    pub fn is_gone(&self) -> bool {
        self.thread.is_finished()
    }
}
