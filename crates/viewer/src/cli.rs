//! The command line.
//!
//! Exit codes: 0 done; 1 a run failed on the way; 2 the arguments or a file were refused;
//! 3 no display or graphics adapter; 130 a run was interrupted, and its result is what was reached.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::builder::PossibleValuesParser;
use clap::{Args, Parser, Subcommand, ValueEnum};
use scene::{Scene, shown};
use sim_core::{Collision, FixedStep, METHODS, Method, Settings};

use crate::interrupt::{Interrupt, survive_file_limits};
use crate::session::{Record, Session, is_run_file};
use crate::{app, failure::Failure, film, headless, shot, soak};

/// The scene of the window if the command line names none.
const FIRST_SCENE: &str = "cube-cow";

/// Exit code after an interrupt, as in shells.
pub const INTERRUPTED: u8 = 130;

/// Explains the figures of `run` whose names do not suffice.
const FIGURES: &str = "\
Figures, by their names in --json; drifts and errors count from the start, and null is unknown:
  energy_drift     change of kinetic and potential energy, relative to the energy at the start;
                   null where that is 0 or unbounded
  energy_error     the same in J
  dissipates       friction or inelastic impacts may have taken energy: a loss is no error
  driven           moving immovable bodies may have given or taken it: no change is an error
  momentum_drift   momentum less the impulse of constant forces and of what it was, relative to the
                   sum of mass times speed at the start and of force times time since; null where
                   that is 0, and where a force or an immovable body may have changed it from outside
  momentum_error   the same in kg m/s
  path_error       largest distance of a body from its exact place, m, among those whose exact path
                   is known: under constant forces and bounces off what nothing moves, springs to
                   points, linear drag, one attraction, until bodies come together
  overlaps         pairs of bodies in each other at the start, after --separate: depth, m, and the
                   direction in which the second leaves the first; where is_least is false, the depth
                   is an upper bound. They are kept from getting deeper
  separated        bodies that --separate has moved
  contacts         what lasts at the end: count, the vertices, edges and faces that touch; gap, m;
                   normal, from the first body to the second
  state_hash       64 bits over motion, time and impacts, in hexadecimal digits: runs of a scene with
                   equal ones are equal to the last bit
  potential_energy, total_energy
                   J; null at a centre of attraction, where they are unbounded";

/// Explains the output of `compare`.
const COMPARISON: &str = "\
Every combination of the methods, steps, collisions and tolerances is run from the start of the scene, and
the exact solution beside them where it is known. Errors are distances from it, energy is its change since
the start, relative where it can be. In --csv, run names the method, the rate and how collisions are found.";

/// Explains the output of `replay`.
const REPLAY: &str = "\
A record has the scene, what was done to it on the way, and a hash of every state. Exit code 1: the replay
has given another state than the record; the step is told.";

/// Cowbell simulates colliding triangle meshes. Without a command it opens its window.
#[derive(Parser)]
#[command(
    name = "cowbell",
    version,
    args_conflicts_with_subcommands = true,
    after_help = "Exit codes: 0 done; 1 a run failed on the way; 2 arguments or a file refused; \
                  3 no display or graphics adapter; 130 a run was interrupted (Ctrl-C)."
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    /// Scene to open: a name from the gallery, or the path of a .toml file, a recorded run (.run) or a mesh
    #[arg(value_name = "NAME|PATH", default_value = FIRST_SCENE)]
    scene: PathBuf,
    #[command(flatten)]
    settings: SettingArgs,
}

#[derive(Subcommand)]
enum Command {
    /// Run a scene without a window and print its final state
    #[command(after_help = FIGURES)]
    Run {
        /// Name from the gallery, or path of a .toml file or a mesh
        #[arg(value_name = "NAME|PATH")]
        scene: PathBuf,
        /// Number of steps
        #[arg(long, value_name = "N", default_value_t = 600)]
        steps: u64,
        /// Print one JSON object instead of a table
        #[arg(long)]
        json: bool,
        /// First move bodies that overlap out of each other, by the least that does it
        #[arg(long)]
        separate: bool,
        /// Print the figures of every state as a table of comma-separated values
        #[arg(long, conflicts_with = "json")]
        csv: bool,
        /// Print the hash of the final state alone: equal ones mean equal states, to the last bit
        #[arg(long, conflicts_with_all = ["json", "csv"])]
        hash: bool,
        /// Record the run, with a hash of every state, in a file for `replay`
        #[arg(long, value_name = "FILE.run", conflicts_with_all = ["csv", "separate"])]
        record: Option<PathBuf>,
        #[command(flatten)]
        settings: SettingArgs,
    },
    /// Run a recorded run again: in the window, or without one to see that every state is the same
    #[command(after_help = REPLAY)]
    Replay {
        /// Recorded run: a file that `run --record` or the window has written
        #[arg(value_name = "FILE.run")]
        file: PathBuf,
        /// Compare every state with the record, without a window
        #[arg(long)]
        verify: bool,
    },
    /// Run a scene in several ways and print what each costs and how far it is off
    #[command(after_help = COMPARISON)]
    Compare {
        /// Name from the gallery, or path of a .toml file or a mesh
        #[arg(value_name = "NAME|PATH")]
        scene: PathBuf,
        /// Simulated time of each run, s
        #[arg(long, value_name = "SECONDS", default_value = "4", value_parser = positive, allow_negative_numbers = true)]
        time: f64,
        /// Print one JSON array instead of a table
        #[arg(long)]
        json: bool,
        /// Print the figures of every state of every run as comma-separated values
        #[arg(long, conflicts_with = "json")]
        csv: bool,
        #[command(flatten)]
        ways: WayArgs,
    },
    /// Read a mesh file and say what is in it
    Check {
        /// Mesh file
        file: PathBuf,
        /// Print one JSON object instead of text
        #[arg(long)]
        json: bool,
    },
    /// Run a scene, or the whole gallery, for minutes or days, and look at it after each step
    #[command(
        after_help = "After each step motion is finite, nothing overlaps by the exact test, energy has not \
                            grown where no force varies, and momentum is kept where nothing changes it. \
                            Figures: the worst drifts, the time of a step at the start and at the end, and \
                            what memory has grown by."
    )]
    Soak {
        /// Name from the gallery, path of a .toml file, or `all`
        #[arg(value_name = "NAME|PATH|all")]
        scene: PathBuf,
        /// Minutes in all, in equal parts for each scene
        #[arg(long, value_name = "N", value_parser = positive, allow_negative_numbers = true, default_value_t = 1.0)]
        minutes: f64,
        #[command(flatten)]
        settings: SettingArgs,
    },
    /// Draw a scene into a PNG file, without a window
    Shot {
        /// Name from the gallery, or path of a .toml file or a mesh
        #[arg(value_name = "NAME|PATH")]
        scene: PathBuf,
        #[command(flatten)]
        shot: ShotArgs,
        #[command(flatten)]
        settings: SettingArgs,
    },
    /// Draw a scene into a moving picture (GIF or animated PNG), without a window
    Gif {
        /// Name from the gallery, or path of a .toml file or a mesh
        #[arg(value_name = "NAME|PATH")]
        scene: PathBuf,
        #[command(flatten)]
        film: FilmArgs,
        #[command(flatten)]
        settings: SettingArgs,
    },
}

/// What a scene file says that the command line may overrule.
#[derive(Args)]
struct SettingArgs {
    /// Integrator
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(METHODS.map(|m| m.name)))]
    method: Option<String>,
    /// Length of a step, s
    #[arg(long, value_name = "SECONDS", value_parser = positive, allow_negative_numbers = true, conflicts_with = "rate")]
    dt: Option<f64>,
    /// Steps per simulated second, Hz
    #[arg(long, value_name = "HZ", value_parser = positive, allow_negative_numbers = true)]
    rate: Option<f64>,
    /// Error that adaptive methods may make in a step, from 1e-15 to 1
    #[arg(long, value_name = "ERROR", value_parser = tolerance, allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// How collisions are found
    #[arg(long, value_name = "HOW")]
    collision: Option<CollisionArg>,
}

/// In which ways to run a scene: every combination of these.
#[derive(Args)]
struct WayArgs {
    /// Integrators, separated by commas; course: the four of the course
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = PossibleValuesParser::new(METHODS.map(|m| m.name).into_iter().chain(["course"])))]
    method: Vec<String>,
    /// Lengths of a step, s
    #[arg(long, value_name = "SECONDS", value_delimiter = ',', value_parser = step_length, allow_negative_numbers = true, conflicts_with = "rate")]
    dt: Vec<f64>,
    /// Steps per simulated second, Hz
    #[arg(long, value_name = "HZ", value_delimiter = ',', value_parser = positive, allow_negative_numbers = true)]
    rate: Vec<f64>,
    /// Errors that adaptive methods may make in a step, from 1e-15 to 1
    #[arg(long, value_name = "ERRORS", value_delimiter = ',', value_parser = tolerance, allow_negative_numbers = true)]
    tolerance: Vec<f64>,
    /// How collisions are found
    #[arg(long, value_name = "HOW", value_delimiter = ',')]
    collision: Vec<CollisionArg>,
}

/// What to draw, and where to.
#[derive(Args)]
pub struct ShotArgs {
    /// Steps to run before drawing
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub step: u64,
    /// PNG file to write
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Size of the picture in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x800", value_parser = size)]
    pub size: [u32; 2],
    /// Draw the bounding boxes of one depth of the hierarchies, or of all
    #[arg(long, value_name = "DEPTH|all", value_parser = depth)]
    pub bvh: Option<Depth>,
    /// Select the body of this name
    #[arg(long, value_name = "NAME")]
    pub select: Option<String>,
}

/// What to draw as a moving picture, and where to.
#[derive(Args)]
pub struct FilmArgs {
    /// File to write; its ending says how: .gif, or .png (APNG)
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Simulated time to begin at, s
    #[arg(long, value_name = "SECONDS", default_value = "0", value_parser = not_negative, allow_negative_numbers = true)]
    pub from: f64,
    /// Simulated time to show, s
    #[arg(long, value_name = "SECONDS", default_value = "3", value_parser = positive, allow_negative_numbers = true)]
    pub time: f64,
    /// Simulated seconds in a second of the picture: slow motion below 1, through impacts at their time
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = positive, allow_negative_numbers = true)]
    pub speed: f64,
    /// Frames a second, to the nearest hundredth of a second between two
    #[arg(long, value_name = "HZ", default_value = "25", value_parser = frame_rate, allow_negative_numbers = true)]
    pub fps: f64,
    /// Size of the picture in pixels
    #[arg(long, value_name = "WxH", default_value = "640x400", value_parser = size)]
    pub size: [u32; 2],
    /// Draw the bounding boxes of one depth of the hierarchies, or of all
    #[arg(long, value_name = "DEPTH|all", value_parser = depth)]
    pub bvh: Option<Depth>,
    /// Draw where bodies have been
    #[arg(long)]
    pub trails: bool,
    /// How many times nearer than the opening view
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = positive, allow_negative_numbers = true)]
    pub zoom: f64,
    /// Select the body of this name
    #[arg(long, value_name = "NAME")]
    pub select: Option<String>,
}

/// Levels of a bounding volume hierarchy.
#[derive(Clone, Copy)]
pub enum Depth {
    /// Every level.
    All,
    /// One level; 0 is the root.
    Level(usize),
}

#[derive(Clone, Copy, ValueEnum)]
enum CollisionArg {
    /// Every edge against every triangle
    Naive,
    /// Through bounding volume hierarchies
    Bvh,
    /// At the time of impact within the step
    Continuous,
}

/// Runs the program with the arguments of the process.
pub fn main() -> ExitCode {
    survive_file_limits();
    let interrupt = Interrupt::default();
    let done = match Cli::try_parse() {
        Ok(cli) => obey(cli, &interrupt),
        Err(error) if error.use_stderr() => Err(Failure::Refused(one_line(&error))),
        // Help and version are errors of clap with a text for stdout.
        Err(error) => Ok(error.render().to_string()),
    };
    match done {
        Ok(text) => {
            let code = print(&text);
            if interrupt.came() && code == ExitCode::SUCCESS {
                return ExitCode::from(INTERRUPTED);
            }
            code
        }
        Err(failure) => {
            // If stderr cannot be written either, nothing more can be done.
            let _ = writeln!(
                std::io::stderr(),
                "cowbell: {}",
                shown::message(failure.message())
            );
            ExitCode::from(failure.code())
        }
    }
}

/// Starts a drawing command again without the Mesa layer that asks Wayland for the preferred adapter: without Wayland
/// it prints lines that begin with `error:`. The environment of a running program cannot be changed safely.
/// environment of a program that runs.
#[cfg(target_os = "linux")]
fn silence_mesa() {
    use std::os::unix::process::CommandExt;
    const LAYER_OFF: &str = "NODEVICE_SELECT";
    let is_set = |name| std::env::var_os(name).is_some();
    if is_set("XDG_RUNTIME_DIR") || is_set(LAYER_OFF) {
        return;
    }
    if let Ok(program) = std::env::current_exe() {
        let mut again = std::process::Command::new(program);
        again.args(std::env::args_os().skip(1)).env(LAYER_OFF, "1");
        // `exec` returns only if it fails; then the lines are printed.
        let _ = again.exec();
    }
}

#[cfg(not(target_os = "linux"))]
fn silence_mesa() {}

/// Runs a command and returns the text for stdout.
fn obey(cli: Cli, interrupt: &Interrupt) -> Result<String, Failure> {
    if matches!(
        cli.command,
        Some(Command::Shot { .. } | Command::Gif { .. })
    ) {
        silence_mesa();
    }
    let opens_window = matches!(
        cli.command,
        None | Some(Command::Replay { verify: false, .. })
    );
    if !opens_window {
        interrupt
            .begin()
            .map_err(|error| Failure::Run(format!("cannot listen for Ctrl-C: {error}")))?;
    }
    match cli.command {
        None => {
            let session = match is_run_file(&cli.scene) {
                true => replaying(&cli.scene)?,
                false => {
                    let scene = load(&cli.scene, &cli.settings)?;
                    Session::of_file(scene, &cli.scene).map_err(Failure::refused)?
                }
            };
            app::run(session)?;
            Ok(String::new())
        }
        Some(Command::Run {
            scene,
            steps,
            json,
            csv,
            separate,
            hash,
            record,
            settings,
        }) => {
            let scene = load(&scene, &settings)?;
            if csv {
                return headless::run_csv(&scene, steps, interrupt);
            }
            let form = match (json, hash) {
                (true, _) => headless::RunForm::Json,
                (_, true) => headless::RunForm::Hash,
                _ => headless::RunForm::Table,
            };
            headless::run(
                &scene,
                steps,
                (form, separate),
                record.as_deref(),
                interrupt,
            )
        }
        Some(Command::Replay { file, verify }) => match verify {
            true => headless::replay(&file, interrupt),
            false => {
                app::run(replaying(&file)?)?;
                Ok(String::new())
            }
        },
        Some(Command::Compare {
            scene,
            time,
            json,
            csv,
            ways,
        }) => {
            let scene = Scene::load(&scene).map_err(Failure::refused)?;
            let form = match (json, csv) {
                (true, _) => headless::Form::Json,
                (_, true) => headless::Form::Csv,
                _ => headless::Form::Table,
            };
            let settings = ways.settings(&scene)?;
            headless::compare(&scene, &settings, time, form, interrupt)
        }
        Some(Command::Check { file, json }) => headless::check(&file, json),
        Some(Command::Soak {
            scene,
            minutes,
            settings,
        }) => {
            let scenes = match scene.to_str() {
                Some("all") => soak::gallery()?
                    .into_iter()
                    .map(|(name, scene)| Ok((name, overruled(scene, &settings)?)))
                    .collect::<Result<_, Failure>>()?,
                _ => vec![(shown::path(&scene), load(&scene, &settings)?)],
            };
            soak::run(&scenes, minutes, interrupt)
        }
        Some(Command::Shot {
            scene,
            shot,
            settings,
        }) => shot::write(load(&scene, &settings)?, &shot, interrupt),
        Some(Command::Gif {
            scene,
            film,
            settings,
        }) => film::write(load(&scene, &settings)?, &film, interrupt),
    }
}

impl WayArgs {
    /// Every combination, in the order given; settings that are not given come from the scene.
    fn settings(&self, scene: &Scene) -> Result<Vec<Settings>, Failure> {
        let or = |given: Vec<f64>, own: f64| if given.is_empty() { vec![own] } else { given };
        let mut methods: Vec<&'static Method> = Vec::new();
        for name in &self.method {
            match name.as_str() {
                "course" => methods.extend(METHODS.iter().take(4)),
                name => methods.extend(Method::named(name)),
            }
        }
        if methods.is_empty() {
            methods.push(scene.method);
        }
        for rate in &self.rate {
            check_rate(*rate)?;
        }
        let rates = self.rate.iter().map(|rate| 1.0 / rate);
        let lengths = or(rates.chain(self.dt.iter().copied()).collect(), scene.dt);
        let tolerances = or(self.tolerance.clone(), scene.tolerance);
        let collisions: Vec<Collision> = match self.collision.is_empty() {
            true => vec![scene.collision],
            false => self.collision.iter().map(|how| (*how).into()).collect(),
        };
        let mut all = Vec::new();
        for &method in &methods {
            for &dt in &lengths {
                for &collision in &collisions {
                    for &tolerance in &tolerances {
                        let settings = Settings {
                            method,
                            dt,
                            collision,
                            // Methods without error control ignore the tolerance.
                            tolerance: if method.adaptive {
                                tolerance
                            } else {
                                scene.tolerance
                            },
                        };
                        if !all.contains(&settings) {
                            all.push(settings);
                        }
                    }
                }
            }
        }
        Ok(all)
    }
}

impl From<CollisionArg> for Collision {
    fn from(how: CollisionArg) -> Collision {
        match how {
            CollisionArg::Naive => Collision::Naive,
            CollisionArg::Bvh => Collision::Bvh,
            CollisionArg::Continuous => Collision::Continuous,
        }
    }
}

/// Opens a session at the start of a recorded run.
fn replaying(file: &Path) -> Result<Session, Failure> {
    let record = Record::read(file).map_err(Failure::refused)?;
    Session::replaying(record).map_err(Failure::refused)
}

/// Checks the rate here, because the world's error would name a dt that the user did not give.
fn check_rate(rate: f64) -> Result<(), Failure> {
    if FixedStep::DT_RANGE.contains(&(1.0 / rate)) {
        return Ok(());
    }
    let what = format!("--rate {rate:e}: must be from 1e-3 to 1e9 Hz");
    Err(Failure::Refused(what))
}

/// Loads a scene and applies the settings of the arguments.
fn load(name_or_path: &Path, settings: &SettingArgs) -> Result<Scene, Failure> {
    overruled(
        Scene::load(name_or_path).map_err(Failure::refused)?,
        settings,
    )
}

fn overruled(mut scene: Scene, settings: &SettingArgs) -> Result<Scene, Failure> {
    if let Some(method) = settings.method.as_deref().and_then(Method::named) {
        scene.method = method;
    }
    if let Some(dt) = settings.dt.or(settings.rate.map(|rate| 1.0 / rate)) {
        if let Some(rate) = settings.rate {
            check_rate(rate)?;
        }
        scene.dt = dt;
    }
    if let Some(tolerance) = settings.tolerance {
        scene.tolerance = tolerance;
    }
    if let Some(how) = settings.collision {
        scene.collision = how.into();
    }
    Ok(scene)
}

/// Writes to stdout. A closed pipe, as after `head`, is not a failure.
fn print(text: &str) -> ExitCode {
    let mut stdout = std::io::stdout().lock();
    match stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
    {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(
                std::io::stderr(),
                "cowbell: cannot write the result: {error}"
            );
            ExitCode::FAILURE
        }
    }
}

/// The message of clap above its usage, in one line.
fn one_line(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let text = text.strip_prefix("error: ").unwrap_or(&text);
    let lines = text.lines().take_while(|line| !line.starts_with("Usage:"));
    let words: Vec<&str> = lines
        .filter(|line| !line.contains("--help"))
        .flat_map(str::split_whitespace)
        .collect();
    format!("{}; see cowbell --help", words.join(" "))
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("must be a number above 0".to_owned()),
    }
}

fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value >= 0.0 && value.is_finite() => Ok(value),
        _ => Err("must be a number from 0".to_owned()),
    }
}

fn frame_rate(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (1.0..=50.0).contains(&value) => Ok(value),
        _ => Err("must be a number from 1 to 50".to_owned()),
    }
}

fn step_length(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if FixedStep::DT_RANGE.contains(&value) => Ok(value),
        _ => Err("must be a number from 1e-9 to 1e3".to_owned()),
    }
}

fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if Settings::TOLERANCES.contains(&value) => Ok(value),
        _ => Err("must be a number from 1e-15 to 1".to_owned()),
    }
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let side = |text: &str| text.parse().ok().filter(|side| (1..=8192).contains(side));
    text.split_once('x')
        .and_then(|(width, height)| Some([side(width)?, side(height)?]))
        .ok_or_else(|| "must be WIDTHxHEIGHT, each from 1 to 8192".to_owned())
}

fn depth(text: &str) -> Result<Depth, String> {
    match text {
        "all" => Ok(Depth::All),
        level => level
            .parse()
            .map(Depth::Level)
            .map_err(|_| "must be a depth from 0, or all".to_owned()),
    }
}
