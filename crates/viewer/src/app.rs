//! The window: handles events and draws frames. It sleeps while nothing moves.

use std::panic;
use std::sync::Arc;
use std::time::Duration;

use egui::ViewportId;
use scene::shown;
use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Window, WindowId};

use crate::canvas::{self, UiFrame};
use crate::failure::Failure;
use crate::film;
use crate::gpu::{Gpu, Shown};
use crate::picture::Picture;
use crate::preferences::{Preferences, Store};
use crate::reopening::{Loss, Reopening};
use crate::rescue::Rescue;
use crate::session::{
    Done, Job, Leaving, Outlook, STEP_BUDGET, Session, Shooting, State, Trial, Tried, VariantJob,
    VariantsDone,
};
use crate::stopwatch::Stopwatch;
use crate::ui::{self, Ui};
use crate::watch::Watch;
use crate::worker::Worker;

/// The shortest time between frames, in case the display does not limit the rate.
const SHORTEST_FRAME: Duration = Duration::from_millis(4);
/// The time between frames while the window is hidden or a single step takes long.
const UNSEEN_FRAME: Duration = Duration::from_millis(100);

/// How long to wait after the last change of the scene's file before it is read, so that its writer can finish.
const WRITING: Duration = Duration::from_millis(200);

/// Opens the window on a session and returns when it is closed.
pub fn run(mut session: Session) -> Result<(), Failure> {
    let event_loop = event_loop()?;
    let mut store = Store::of_the_system();
    let preferences = store.load().unwrap_or_else(|error| {
        session.notices().error("preferences", format!("{error:#}"));
        None
    });
    let mut preferences =
        preferences.unwrap_or_else(|| Preferences::first(sys_locale::get_locale().as_deref()));
    let rescue = Rescue::of_the_system();
    for file in rescue.left_behind() {
        let text = format!(
            "A window has ended before its edits were saved. They are in {}: open that file.",
            shown::path(&file)
        );
        session.notices().error("rescue", text);
        preferences.recent.insert(0, file);
    }
    let proxy = event_loop.create_proxy();
    let mut app = App {
        watch: Watch::new(move || {
            // Sending fails only when the window has closed.
            let _ = proxy.send_event(Redraw(WRITING));
        }),
        touched: None,
        rescue,
        store,
        preferences: Some(preferences),
        session,
        ui: Ui::default(),
        worker: None,
        measurer: None,
        runner: None,
        filmer: None,
        scout: None,
        stopwatch: Stopwatch::start(),
        proxy: event_loop.create_proxy(),
        open: None,
        lost: None,
        reopening: Reopening::default(),
        failure: None,
        last_frame: Duration::ZERO,
        next_frame: None,
    };
    let ran = event_loop.run_app(&mut app);
    if app.session.is_closing() {
        app.rescue.forget();
    } else {
        // If this fails, the file of the edits written before is named below.
        let _ = app.rescue.keep_at_once(&mut app.session);
    }
    let ended = match (app.failure.take(), ran) {
        (Some(failure), _) => failure,
        (None, Err(error)) => no_display(&error.to_string()),
        (None, Ok(())) => return Ok(()),
    };
    Err(match (ended, app.rescue.file()) {
        (Failure::NoDisplay(why), Some(file)) => {
            let file = shown::path(file);
            Failure::NoDisplay(format!("{why}. Edits that were not saved are in {file}"))
        }
        (failure, _) => failure,
    })
}

/// The bytes of a picture file; `None` if drawing was cancelled.
type Shot = Result<Option<Vec<u8>>, String>;

/// The control panel requests a frame after this time.
#[derive(Debug)]
struct Redraw(Duration);

struct App {
    /// Watches the scene's files for changes.
    watch: Watch,
    /// The time of their last change, if they must be read again.
    touched: Option<Duration>,
    /// Keeps unsaved edits.
    rescue: Rescue,
    /// The file of the preferences.
    store: Store,
    /// The preferences of the previous start, until the window opens.
    preferences: Option<Preferences>,
    session: Session,
    ui: Ui,
    /// Takes the steps; `None` while no step runs.
    worker: Option<Worker<Job, Done>>,
    /// Measures naive against BVH; `None` while that is off.
    measurer: Option<Worker<Trial, Tried>>,
    /// Runs the variants; `None` if there are none.
    runner: Option<Worker<VariantJob, VariantsDone>>,
    /// Draws pictures into files; `None` if there are none to draw.
    filmer: Option<Worker<Shooting, Shot>>,
    /// Computes the opening view; `None` once it is found.
    scout: Option<Worker<Outlook, Outlook>>,
    stopwatch: Stopwatch,
    proxy: EventLoopProxy<Redraw>,
    open: Option<Open>,
    /// The window whose graphics are lost, until they are open again.
    lost: Option<Lost>,
    reopening: Reopening,
    failure: Option<Failure>,
    /// When the last frame began.
    last_frame: Duration,
    /// When the next frame is due; `None` while nothing moves.
    next_frame: Option<Duration>,
}

/// A window without graphics.
struct Lost {
    window: Arc<Window>,
    /// The panels, which keep their state.
    context: egui::Context,
    loss: Loss,
    /// When the graphics are opened again.
    due: Duration,
}

/// A window with everything needed to draw in it.
struct Open {
    window: Arc<Window>,
    /// The title of the window.
    title: String,
    egui: egui_winit::State,
    gpu: Gpu,
}

impl Open {
    fn new(
        event_loop: &ActiveEventLoop,
        window: Arc<Window>,
        proxy: &EventLoopProxy<Redraw>,
    ) -> Result<Self, Failure> {
        let gpu = Gpu::new(event_loop, window.clone()).map_err(|error| no_adapter(&error))?;
        let context = egui::Context::default();
        ui::apply_style(&context);
        let proxy = proxy.clone();
        context.set_request_repaint_callback(move |request| {
            // Sending fails only when the window has closed.
            let _ = proxy.send_event(Redraw(request.delay));
        });
        let egui = egui_winit::State::new(
            context,
            ViewportId::ROOT,
            event_loop,
            Some(window.scale_factor() as f32),
            None,
            Some(gpu.max_texture_side()),
        );
        Ok(Self {
            window,
            title: String::new(),
            egui,
            gpu,
        })
    }
}

impl App {
    /// Requests a frame at `time`, or keeps an earlier one that is already due.
    fn schedule(&mut self, time: Duration) {
        self.next_frame = Some(self.next_frame.map_or(time, |next| next.min(time)));
    }

    fn fail(&mut self, event_loop: &ActiveEventLoop, failure: Failure) {
        self.failure = Some(failure);
        event_loop.exit();
    }

    /// Closes the graphics of the window after they were lost, and opens them again soon.
    fn lose(&mut self, event_loop: &ActiveEventLoop, loss: Loss, now: Duration) {
        let Some(open) = self.open.take() else { return };
        let context = open.egui.egui_ctx().clone();
        let window = open.window.clone();
        // Two surfaces of one window would conflict.
        drop(open);
        match self.reopening.lost(loss, now) {
            Some(due) => {
                self.lost = Some(Lost {
                    window,
                    context,
                    loss,
                    due,
                });
            }
            None => self.fail(event_loop, given_up(loss)),
        }
    }

    /// Opens the graphics of the window again if that is due. A failed try is repeated after a pause, in which the
    /// window can be closed.
    fn reopen(&mut self, event_loop: &ActiveEventLoop) {
        let now = self.stopwatch.read();
        let Some(mut lost) = self.lost.take_if(|lost| lost.due <= now) else {
            return;
        };
        let opened = Open::new(event_loop, lost.window.clone(), &self.proxy);
        let now = self.stopwatch.read();
        match opened {
            Ok(reopened) => {
                self.reopening.opened(now);
                self.ui.move_to(&lost.context, reopened.egui.egui_ctx());
                reopened.window.request_redraw();
                self.open = Some(reopened);
                // The time without graphics is no time of the run.
                self.last_frame = now;
                let notices = self.session.notices();
                match self.reopening.sparing(now) {
                    None => notices.info("graphics", lost.loss.mended().to_owned()),
                    Some(_) => notices.error("graphics", canvas::NO_MEMORY.to_owned()),
                }
            }
            Err(failure) => match self.reopening.again(now) {
                Some(due) => {
                    lost.due = due;
                    self.lost = Some(lost);
                }
                None => self.fail(event_loop, failure),
            },
        }
    }

    /// Advances the physics. It waits for steps no longer than a frame allows.
    fn steps(&mut self, elapsed: Duration) {
        if let Some(worker) = &mut self.worker {
            if let Some(done) = worker.result(Duration::ZERO) {
                self.session.accept(done);
            } else if worker.is_gone() {
                self.worker = None;
                self.session.pause();
                let text = "A step broke down. This is a fault of the program: please report it.";
                self.session.notices().error("step", text.to_owned());
            }
        }
        let Some(job) = self.session.due(elapsed) else {
            return;
        };
        // A worker that is still busy computes outdated steps. It ends by itself after it is dropped.
        self.worker = self.worker.take().filter(|worker| !worker.is_busy());
        if self.worker.is_none() {
            self.worker = Worker::start("steps", |job: Job, time| job.run(|| time.read())).ok();
        }
        let done = match &mut self.worker {
            Some(worker) => {
                worker.hand_over(job);
                worker.result(2 * STEP_BUDGET)
            }
            None => Some(job.run(|| self.stopwatch.read())),
        };
        if let Some(done) = done {
            self.session.accept(done);
        }
    }

    /// Advances the measurements without waiting for them.
    fn measure(&mut self, elapsed: Duration) {
        if let Some(measurer) = &mut self.measurer {
            if let Some(tried) = measurer.result(Duration::ZERO) {
                self.session.accept_trial(tried);
            } else if measurer.is_gone() {
                self.measurer = None;
                self.session.drop_trial();
                let text =
                    "A measurement broke down. This is a fault of the program: please report it.";
                self.session.notices().error("compare", text.to_owned());
            }
        }
        if !self.session.compare.on {
            self.measurer = None;
        } else if let Some(trial) = self.session.trial_due(elapsed) {
            if self.measurer.is_none() {
                let run = |trial: Trial, time: &Stopwatch| trial.run(|| time.read());
                self.measurer = Worker::start("measuring", run).ok();
            }
            match &mut self.measurer {
                Some(measurer) => measurer.hand_over(trial),
                None => self.session.drop_trial(),
            }
        }
    }

    /// Advances the variants to the time of the run without waiting for them.
    fn run_variants(&mut self) {
        if let Some(runner) = &mut self.runner {
            if let Some(done) = runner.result(Duration::ZERO) {
                self.session.accept_variants(done);
            } else if runner.is_gone() {
                self.runner = None;
                self.session.drop_variants();
                let text =
                    "A variant broke down. This is a fault of the program: please report it.";
                self.session.notices().error("compare", text.to_owned());
            }
        }
        if self.session.variants().is_empty() {
            self.runner = None;
        } else if self.runner.as_ref().is_none_or(|runner| !runner.is_busy())
            && let Some(job) = self.session.variants_due()
        {
            if self.runner.is_none() {
                let run = |job: VariantJob, time: &Stopwatch| job.run(|| time.read());
                self.runner = Worker::start("variants", run).ok();
            }
            match &mut self.runner {
                Some(runner) => runner.hand_over(job),
                None => self.session.drop_variants(),
            }
        }
    }

    /// Advances the search for the opening view of a new scene without waiting for it.
    fn look_ahead(&mut self) {
        if let Some(outlook) = self.session.outlook() {
            let run = |outlook: Outlook, time: &Stopwatch| outlook.run(|| time.read());
            self.scout = Worker::start("opening view", run).ok();
            if let Some(scout) = &mut self.scout {
                scout.hand_over(outlook);
            }
        }
        let Some(scout) = &mut self.scout else { return };
        if let Some(seen) = scout.result(Duration::ZERO) {
            self.session.accept_outlook(&seen);
            self.scout = None;
        } else if scout.is_gone() {
            // The bodies are in view even without the opening view.
            self.scout = None;
        }
    }

    /// Advances the drawing of pictures into files without waiting for it.
    fn film(&mut self) {
        if let Some(shooting) = self.session.shooting_due() {
            let run = |shooting: Shooting, _: &Stopwatch| film::shoot(&shooting);
            self.filmer = Worker::start("pictures", run).ok();
            match &mut self.filmer {
                Some(filmer) => filmer.hand_over(shooting),
                None => self.session.accept_shooting(Ok(None)),
            }
        }
        let Some(filmer) = &mut self.filmer else {
            return;
        };
        if let Some(outcome) = filmer.result(Duration::ZERO) {
            self.session.accept_shooting(outcome);
            self.filmer = None;
        } else if filmer.is_gone() {
            self.filmer = None;
            let text = "The drawing of pictures broke down. This is a fault of the program: please report it.";
            self.session.accept_shooting(Err(text.to_owned()));
        }
    }

    /// Reads the scene's files again once they have not changed for a moment.
    fn reread(&mut self, now: Duration) {
        self.watch.follow(self.session.files());
        if self.watch.take() {
            self.touched = Some(now);
        }
        if let Some(touched) = self.touched {
            if now >= touched + WRITING {
                self.touched = None;
                self.session.reread();
            } else {
                self.schedule(touched + WRITING);
            }
        }
    }

    /// Advances the physics, lays out the control panel and paints both. Nothing happens while graphics are lost.
    fn frame(&mut self, event_loop: &ActiveEventLoop) {
        if self.lost.is_some() {
            return;
        }
        let now = self.stopwatch.read();
        let elapsed = now.saturating_sub(self.last_frame);
        self.steps(elapsed);
        self.measure(elapsed);
        self.run_variants();
        self.look_ahead();
        self.film();
        self.reread(now);
        self.session.notices().pass(elapsed);
        self.session.settle(elapsed);
        if let Err(error) = self.rescue.keep(&self.session) {
            self.session.notices().error("rescue", format!("{error:#}"));
        }
        if self.session.is_closing() {
            return event_loop.exit();
        }
        self.last_frame = now;

        let Some(open) = &mut self.open else { return };
        let size = open.window.inner_size();
        let sparing = self.reopening.sparing(now);
        let shown = if size.width == 0 || size.height == 0 {
            Shown::Nothing
        } else {
            let input = open.egui.take_egui_input(&open.window);
            let context = open.egui.egui_ctx().clone();
            if let Some(wanted) = self.preferences.take() {
                self.ui.prefer(&context, &mut self.session, &wanted);
            }
            let mut place = egui::Rect::ZERO;
            let output = context.run_ui(input, |root| {
                place = self.ui.show(root, &mut self.session, open.gpu.picture_id());
            });
            let preferred = self.ui.preferences(&context, &self.session);
            if let Err(error) = self.store.keep(&preferred) {
                self.session
                    .notices()
                    .error("preferences", format!("{error:#}"));
            }
            open.egui
                .handle_platform_output(&open.window, output.platform_output);
            let pixels = place.size() * output.pixels_per_point;
            let frame = UiFrame {
                primitives: context.tessellate(output.shapes, output.pixels_per_point),
                textures: output.textures_delta,
                pixels_per_point: output.pixels_per_point,
            };
            let pixels = [pixels.x.round() as u32, pixels.y.round() as u32];
            let title = title(&self.session);
            if title != open.title {
                open.window.set_title(&title);
                open.title = title;
            }
            match sparing {
                None => open.gpu.paint(&self.session.picture(), pixels, frame),
                Some(_) => open.gpu.paint(&Picture::default(), [1, 1], frame),
            }
        };
        if let Some(error) = open.gpu.take_error() {
            self.session.notices().error("graphics", error);
        }
        #[cfg(debug_assertions)]
        if is_fault_wanted() {
            open.gpu.lose();
        }
        if let Some(loss) = open.gpu.loss() {
            return self.lose(event_loop, loss, now);
        }
        match sparing {
            Some(until) => self.schedule(until),
            None if self.reopening.resumes() => {
                let text = Loss::Memory.mended().to_owned();
                self.session.notices().info("graphics", text);
            }
            None => {}
        }
        let compare = &self.session.compare;
        let measuring = compare.on && (compare.is_under_way() || self.session.wants_trial());
        let moves = self.session.state() == State::Running || self.session.awaits_variants();
        if moves && shown == Shown::Frame {
            self.schedule(now + SHORTEST_FRAME);
        } else if moves
            || shown == Shown::Older
            || self.session.awaits_steps()
            || measuring
            || self.scout.is_some()
            || self.session.reel().is_some()
            || self.session.is_settling()
            || self.session.notices().is_passing()
        {
            self.schedule(now + UNSEEN_FRAME);
        }
    }
}

impl ApplicationHandler<Redraw> for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.open.is_some() || self.lost.is_some() {
            return;
        }
        let attributes = Window::default_attributes()
            .with_title("Cowbell")
            .with_inner_size(first_size(event_loop));
        let opened = match event_loop.create_window(attributes) {
            Ok(window) => Open::new(event_loop, Arc::new(window), &self.proxy),
            Err(error) => Err(no_display(&error.to_string())),
        };
        match opened {
            Ok(open) => {
                self.reopening.opened(self.stopwatch.read());
                open.window.request_redraw();
                self.open = Some(open);
            }
            Err(failure) => self.fail(event_loop, failure),
        }
    }

    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        if cause == StartCause::Init {
            self.last_frame = self.stopwatch.read();
        }
    }

    fn user_event(&mut self, _: &ActiveEventLoop, Redraw(delay): Redraw) {
        // egui requests a frame in the far future when it needs none.
        if let Some(time) = self.stopwatch.read().checked_add(delay) {
            self.schedule(time);
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        if event == WindowEvent::RedrawRequested {
            return self.frame(event_loop);
        }
        if let Some(lost) = &self.lost {
            // Without graphics nothing can be asked about edits: they stay in a file.
            if event == WindowEvent::CloseRequested {
                self.fail(event_loop, given_up(lost.loss));
            }
            return;
        }
        let Some(open) = &mut self.open else { return };
        let response = open.egui.on_window_event(&open.window, &event);
        if response.repaint {
            open.window.request_redraw();
        }
        match event {
            WindowEvent::CloseRequested => {
                self.session.leave(Leaving::Close);
                open.window.request_redraw();
            }
            WindowEvent::Resized(_) | WindowEvent::Occluded(false) => open.window.request_redraw(),
            WindowEvent::DroppedFile(path) => {
                self.session.take_in(&path);
                open.window.request_redraw();
            }
            _ => {}
        }
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        self.reopen(event_loop);
        if let Some(lost) = &self.lost {
            let wait = lost.due.saturating_sub(self.stopwatch.read());
            return event_loop.set_control_flow(ControlFlow::wait_duration(wait));
        }
        let Some(open) = &self.open else { return };
        event_loop.set_control_flow(match self.next_frame {
            None => ControlFlow::Wait,
            Some(time) => match time.checked_sub(self.stopwatch.read()) {
                Some(wait) if !wait.is_zero() => ControlFlow::wait_duration(wait),
                _ => {
                    self.next_frame = None;
                    open.window.request_redraw();
                    ControlFlow::Wait
                }
            },
        });
    }
}

/// Whether `.ci/window-faults` requests that the device be lost: once for each file that it puts at the path in this
/// variable.
#[cfg(debug_assertions)]
fn is_fault_wanted() -> bool {
    std::env::var_os("COWBELL_LOSE_DEVICE").is_some_and(|path| std::fs::remove_file(path).is_ok())
}

/// The title of the window: the scene, marked if it has unsaved edits.
fn title(session: &Session) -> String {
    let mark = if session.is_changed() { "*" } else { "" };
    format!("{}{mark} - Cowbell", shown::name(&session.scene().name))
}

/// The initial size of the window, in points: a comfortable size, limited by the monitor.
fn first_size(event_loop: &ActiveEventLoop) -> LogicalSize<f64> {
    let mut size = LogicalSize::<f64>::new(1360.0, 880.0);
    let monitor = event_loop
        .primary_monitor()
        .or_else(|| event_loop.available_monitors().next());
    if let Some(monitor) = monitor {
        let room = monitor.size().to_logical::<f64>(monitor.scale_factor());
        if room.width > 0.0 && room.height > 0.0 {
            size.width = size.width.min(0.95 * room.width);
            size.height = size.height.min(0.9 * room.height);
        }
    }
    size
}

/// The connection to the display. winit panics instead of failing if libraries of the display are missing; both are
/// reported in the same way.
fn event_loop() -> Result<EventLoop<Redraw>, Failure> {
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|_| {}));
    let built = panic::catch_unwind(|| EventLoop::with_user_event().build());
    panic::set_hook(hook);
    match built {
        Ok(built) => built.map_err(|error| no_display(&error.to_string())),
        Err(panic) => Err(no_display(
            panic
                .downcast_ref::<String>()
                .map(String::as_str)
                .or_else(|| panic.downcast_ref::<&str>().copied())
                .unwrap_or("the display's libraries are incomplete"),
        )),
    }
}

fn no_display(reason: &str) -> Failure {
    // winit adds the source line of its failure, which does not help a user.
    let reason = match reason.split_once(".rs:") {
        Some((_, place)) => place.split_once(": ").map_or(place, |(_, reason)| reason),
        None => reason,
    };
    Failure::NoDisplay(format!(
        "no window: {}. Start it on a desktop with X11 (libx11, libxkbcommon-x11) or Wayland, \
         or do without a window: cowbell run cube-cow",
        reason.trim_end_matches('.')
    ))
}

fn no_adapter(error: &anyhow::Error) -> Failure {
    let text = format!("{error:#}");
    let loss = error.downcast_ref::<Loss>().copied();
    if let Some(loss) = loss.or(canvas::is_short(&text).then_some(Loss::Memory)) {
        return given_up(loss);
    }
    Failure::NoDisplay(format!(
        "no window: {text}. Install a Vulkan or OpenGL driver (on Debian \
         mesa-vulkan-drivers), or do without a window: cowbell run cube-cow"
    ))
}

fn given_up(loss: Loss) -> Failure {
    Failure::NoDisplay(format!(
        "no window: {loss}, or do without a window: cowbell run cube-cow"
    ))
}
