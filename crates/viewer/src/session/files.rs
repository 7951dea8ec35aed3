//! Loads scenes and meshes from files, and saves scenes.

use std::path::{Path, PathBuf};

use scene::{MeshRef, MeshReport, Scene, SceneBody, SceneShape, shown};

use super::Session;
use super::record::is_run_file;
use crate::number;

impl Session {
    /// A session on a scene from `name_or_path`: the name of a gallery scene, or a path. A scene file is saved to
    /// itself.
    pub fn of_file(scene: Scene, name_or_path: &Path) -> anyhow::Result<Self> {
        let mut session = Self::new(scene)?;
        session.file = is_scene_file(name_or_path).then(|| name_or_path.to_owned());
        Ok(session)
    }

    /// Opens a scene of the gallery, by name, or of a file, by path. On failure the present scene stays.
    pub fn open(&mut self, name_or_path: impl AsRef<Path>) {
        let name_or_path = name_or_path.as_ref();
        let opened = match is_run_file(name_or_path) {
            true => self.open_run(name_or_path),
            false => Scene::load(name_or_path)
                .map_err(anyhow::Error::new)
                .and_then(|scene| Session::of_file(scene, name_or_path)),
        };
        match opened {
            Ok(session) => self.give_way(session),
            Err(error) => self.notices.error("open", error.to_string()),
        }
    }

    /// Begins an empty scene.
    pub(super) fn begin_scene(&mut self) {
        let settings = sim_core::Settings::default();
        let scene = Scene {
            name: "untitled".to_owned(),
            title: "New scene".to_owned(),
            about: String::new(),
            dt: settings.dt,
            method: settings.method,
            collision: settings.collision,
            tolerance: settings.tolerance,
            ends: None,
            bodies: Vec::new(),
            forces: Vec::new(),
        };
        match Session::new(scene) {
            Ok(session) => self.give_way(session),
            Err(error) => self.notices.error("open", error.to_string()),
        }
    }

    /// Replaces this scene by another; the view settings stay.
    fn give_way(&mut self, session: Session) {
        let (mut display, edition) = (self.display, self.edition + 1);
        let (parallel, profiled) = (self.camera.parallel, self.profiled);
        let opening = self.opening.next();
        let mut compare = std::mem::take(&mut self.compare);
        compare.forget();
        let variants = self.variants.edition + 1;
        display.trails = session.display.trails;
        display.spins = session.display.spins;
        display.spin_metres = session.display.spin_metres;
        display.momentum_metres = session.display.momentum_metres;
        *self = session;
        self.display = display;
        self.camera.parallel = parallel;
        self.profiled = profiled;
        self.compare = compare;
        self.edition = edition;
        self.variants.edition = variants;
        self.opening = opening;
    }

    /// Reads the scene's files again, and opens the scene if it has changed. Unsaved edits are kept instead. A file
    /// that is incomplete, invalid or missing changes nothing; a message says so.
    pub fn reread(&mut self) {
        let Some(path) = self.file.clone() else {
            return;
        };
        self.file_gone = !path.exists();
        if self.tell_of_gone() {
            return;
        }
        match Scene::load(&path) {
            Ok(scene) if scene == self.scene => self.notices.dismiss("file"),
            Ok(_) if self.has_edits() => {
                let text = "The file has changed. Your edits are kept: open it again to see what is in it.";
                self.notices.error("file", text.to_owned());
            }
            Ok(_) => {
                let camera = self.camera;
                self.open(&path);
                self.camera = camera;
                let text = "The file has changed and was read again.";
                self.notices.info("file", text.to_owned());
            }
            Err(error) => self.notices.error("file", error.to_string()),
        }
    }

    /// Shows a message about the first missing file of the scene. Returns whether one is missing.
    fn tell_of_gone(&mut self) -> bool {
        let Some(gone) = self.files().find(|path| !path.exists()) else {
            return false;
        };
        let name = shown::path(gone);
        let text = match self.file.as_deref() == Some(gone) {
            true => format!(
                "{name} is gone. The scene stays here as it is: save it, or put the file back."
            ),
            false => format!(
                "The mesh {name} is gone. The scene stays here as it is, and cannot be opened again before the mesh is back."
            ),
        };
        self.notices.error("file", text);
        true
    }

    /// The files of the scene, if it has one of its own: the scene file and its mesh files.
    pub fn files(&self) -> impl Iterator<Item = &Path> + Clone {
        let meshes = self
            .scene
            .bodies
            .iter()
            .filter_map(|body| body.mesh()?.path());
        let own = self.file.as_deref();
        own.into_iter().chain(meshes.filter(move |_| own.is_some()))
    }

    /// The file that the scene was read from or last saved to.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// Adds a body of 1 kg at rest with the mesh of a file, beside all others. The session first returns to the layout
    /// state.
    pub fn import(&mut self, path: &Path) {
        match MeshRef::load_reporting(path) {
            Ok((mesh, report)) => {
                let name = path.file_stem().unwrap_or_default().to_string_lossy();
                self.add(&name, SceneShape::Mesh(mesh));
                self.frame();
                let lines = report_lines(&shown::path(path), &report);
                self.notices.keep("import", &lines);
            }
            Err(error) => self.notices.error("import", error.to_string()),
        }
    }

    /// Adds a body of a shape beside all others, at rest. The session first returns to the layout state.
    pub fn add(&mut self, name: &str, shape: SceneShape) {
        self.reset();
        self.add_body(SceneBody::new(name.to_owned(), shape));
    }

    /// Writes the set-up to a scene file; the extension `.toml` is added if it is missing. A file that is not the
    /// scene's own is overwritten only with `overwrite`.
    pub fn save(&mut self, path: &Path, overwrite: bool) {
        let mut file = path.as_os_str().to_owned();
        // The user has agreed to overwrite only a name that does not change here.
        let agreed = overwrite && is_scene_file(path);
        if !is_scene_file(path) {
            file.push(".toml");
        }
        let path = PathBuf::from(file);
        let own = self.file.as_deref() == Some(path.as_path());
        if path.exists() && !own && !agreed {
            let text = format!("{} exists: choose another name.", shown::path(&path));
            self.notices.error("save", text);
            return;
        }
        match self.scene.save(&path) {
            Ok(()) => {
                self.notices
                    .info("save", format!("Saved {}.", shown::path(&path)));
                self.name_after(&path);
                self.file = Some(path);
                self.mark_saved();
                self.tell_of_gone();
            }
            Err(error) => self.notices.error("save", error.to_string()),
        }
    }

    /// An unused path in the working directory, named after the scene.
    pub(super) fn new_file(&self, ending: &str) -> PathBuf {
        let plain = |c: char| match c.is_alphanumeric() || "-_ ".contains(c) {
            true => c,
            false => '-',
        };
        let stem: String = self.scene.name.chars().take(60).map(plain).collect();
        let names = std::iter::once(format!("{stem}.{ending}"))
            .chain((2..).map(|n| format!("{stem}-{n}.{ending}")));
        let mut free = names.map(PathBuf::from).filter(|path| !path.exists());
        free.next().unwrap_or_default()
    }

    /// Writes a result of the run to a new file in the working directory, with the scene's name and this extension. A
    /// message names the file.
    pub fn export(&mut self, ending: &str, bytes: &[u8]) {
        let path = self.new_file(ending);
        self.export_to(&path, bytes);
    }

    pub(super) fn export_to(&mut self, path: &Path, bytes: &[u8]) {
        let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        match scene::file::write(path, bytes) {
            Ok(()) => {
                let text = format!("Wrote {}.", shown::path(&whole));
                self.notices.info("export", text);
            }
            Err(error) => {
                let text = format!("Cannot write {}: {error}", shown::path(&whole));
                self.notices.error("export", text);
            }
        }
    }
}

/// A report about an imported mesh, with one line for each finding.
fn report_lines(name: &str, report: &MeshReport) -> Vec<String> {
    let count = |count: usize| number::count(count as f64);
    let [x, y, z] = report.extent.map(number::short);
    let mut lines = vec![
        format!("{name}: {} triangles.", count(report.triangles)),
        format!("Size: {x} by {y} by {z} m."),
    ];
    let mut tell = |is: bool, line: String| lines.extend(is.then_some(line));
    match report.volume {
        Some(volume) => tell(
            true,
            format!("Closed, volume {} m³.", number::short(volume)),
        ),
        None => tell(
            report.closed,
            "Closed, but its sides are not all turned alike.".to_owned(),
        ),
    }
    tell(!report.closed, "Open: it has borders.".to_owned());
    tell(
        report.components > 1,
        format!("Pieces: {}.", count(report.components)),
    );
    if let Some(unit) = report.unit {
        tell(true, format!("Unit of the file: {unit} m."));
    }
    if let Some(axis) = report.up_axis {
        tell(true, format!("Up in the file: {axis}."));
    }
    let merged = report.welded_vertices;
    tell(merged > 0, format!("Vertices merged: {}.", count(merged)));
    let dropped = report.degenerate_triangles + report.duplicate_triangles;
    tell(
        dropped > 0,
        format!("Triangles left out: {}.", count(dropped)),
    );
    let turned = report.flipped_triangles;
    tell(
        turned > 0,
        format!("Triangles turned over: {}.", count(turned)),
    );
    lines
}

pub(super) fn is_scene_file(path: &Path) -> bool {
    path.extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("toml"))
}
