//! Keeps unsaved edits in a file while the window is open. So they survive the loss of the display, a failure of the
//! driver and a power failure. A window that is closed normally leaves no file.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use etcetera::BaseStrategy;
use scene::shown;

use crate::session::Session;

/// The extension of the file, which has the name of the lock. It exists as long as there are edits.
const ENDING: &str = "toml";

/// The most windows with rescue files at the same time.
const MOST: usize = 64;

/// Keeps the edits of one window.
pub struct Rescue {
    /// `None` if the system has no place for it.
    folder: Option<PathBuf>,
    own: Option<Own>,
    /// The number of the edit in the file.
    kept: Option<u64>,
}

/// The files of one window.
struct Own {
    scene: PathBuf,
    /// Locked while the window is open, so that other windows do not use the two files.
    lock: File,
    lock_path: PathBuf,
}

impl Rescue {
    /// In the system's place for such files.
    pub fn of_the_system() -> Self {
        let folders = etcetera::choose_base_strategy().ok();
        let folder = Path::new("cowbell").join("unsaved");
        Self::at(folders.map(|folders| folders.data_dir().join(folder)))
    }

    /// In a folder; without a folder nothing is kept.
    pub fn at(folder: Option<PathBuf>) -> Self {
        Self {
            folder,
            own: None,
            kept: None,
        }
    }

    /// Writes the edits if they differ from those in the file and have not changed for a moment.
    pub fn keep(&mut self, session: &Session) -> Result<()> {
        if session.is_settling() {
            return Ok(());
        }
        let edit = session.unsaved();
        if edit == self.kept {
            return Ok(());
        }
        // A failed write is not repeated until the next edit.
        self.kept = edit;
        if edit.is_none() {
            self.forget();
            return Ok(());
        }
        let Some(folder) = &self.folder else {
            return Ok(());
        };
        let place = || format!("edits are not kept in {}", shown::path(folder));
        let own = match self.own.take() {
            Some(own) => own,
            None => Own::in_folder(folder).with_context(place)?,
        };
        let written = session.scene().save(&own.scene);
        self.own = Some(own);
        written.with_context(place)
    }

    /// Writes the edits when the window ends on its own, including those that changed just now.
    pub fn keep_at_once(&mut self, session: &mut Session) -> Result<()> {
        session.settle_at_once();
        self.keep(session)
    }

    /// The file with the edits, if there are edits that no other file has.
    pub fn file(&self) -> Option<&Path> {
        let own = self.own.as_ref()?;
        own.scene.exists().then_some(own.scene.as_path())
    }

    /// Removes the file: the edits are saved elsewhere or discarded.
    pub fn forget(&mut self) {
        if let Some(own) = self.own.take() {
            // If the file cannot be removed, the next window reports it.
            let _ = fs::remove_file(&own.scene);
            drop(own.lock);
            let _ = fs::remove_file(&own.lock_path);
        }
        self.kept = None;
    }

    /// Files of windows that ended without being closed. Each is returned once.
    pub fn left_behind(&self) -> Vec<PathBuf> {
        let Some(folder) = &self.folder else {
            return Vec::new();
        };
        let mut found = Vec::new();
        for number in 0..MOST {
            let (scene, lock_path) = names(folder, number);
            if !scene.exists() || Own::locked(&lock_path).is_err() {
                continue;
            }
            let left = free_name(folder);
            if fs::rename(&scene, &left).is_ok() {
                // A lock without its scene belongs to no window.
                let _ = fs::remove_file(&lock_path);
                found.push(left);
            }
        }
        found
    }
}

impl Own {
    /// Files that no other window uses.
    fn in_folder(folder: &Path) -> Result<Self> {
        fs::create_dir_all(folder)?;
        for number in 0..MOST {
            let (scene, lock_path) = names(folder, number);
            let Ok(lock) = Self::locked(&lock_path) else {
                continue;
            };
            if !scene.exists() {
                return Ok(Self {
                    scene,
                    lock,
                    lock_path,
                });
            }
        }
        anyhow::bail!("too many windows have left edits there")
    }

    /// Locks the file, if no other window has locked it.
    fn locked(path: &Path) -> Result<File> {
        let file = File::options()
            .create(true)
            .truncate(false)
            .write(true)
            .open(path)?;
        file.try_lock()?;
        Ok(file)
    }
}

fn names(folder: &Path, number: usize) -> (PathBuf, PathBuf) {
    let of = |ending| folder.join(format!("window-{number}.{ending}"));
    (of(ENDING), of("lock"))
}

/// A file name that is not in use.
fn free_name(folder: &Path) -> PathBuf {
    let names = (1..).map(|n| folder.join(format!("rescued-{n}.{ENDING}")));
    let mut free = names.filter(|path| !path.exists());
    free.next().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Scene;
    use std::time::Duration;

    const LONG: Duration = Duration::from_secs(9);

    fn folder(name: &str) -> PathBuf {
        let name = format!("cowbell-rescue-{}-{name}", std::process::id());
        std::env::temp_dir().join(name)
    }

    fn session() -> Session {
        let scene = Scene::load("two-cubes").expect("in the gallery");
        Session::new(scene).expect("a world")
    }

    fn edited(mass: f64) -> Session {
        let mut session = session();
        session.select(Some(0));
        session.set_mass(mass);
        session.settle(LONG);
        session
    }

    #[test]
    fn edits_outlive_a_window_that_ends_and_are_told_once() {
        let folder = folder("end");
        let mut rescue = Rescue::at(Some(folder.clone()));
        rescue.keep(&session()).expect("nothing to keep");
        assert!(rescue.file().is_none() && !folder.exists());
        rescue.keep(&edited(7.0)).expect("kept");
        // Another window has its own file and does not take the first one's.
        let mut beside = Rescue::at(Some(folder.clone()));
        assert!(beside.left_behind().is_empty(), "its window is open");
        beside.keep(&edited(8.0)).expect("kept");
        assert_ne!(rescue.file(), beside.file());
        drop((rescue, beside));
        let next = Rescue::at(Some(folder.clone()));
        let left = next.left_behind();
        let masses = left.iter().map(|path| {
            let scene = Scene::load(path).expect("a scene");
            scene.bodies[0].mass
        });
        assert_eq!(masses.collect::<Vec<_>>(), [7.0, 8.0]);
        assert!(next.left_behind().is_empty(), "told once");
        fs::remove_dir_all(folder).expect("removed");
    }

    #[test]
    fn the_last_edit_is_kept_until_it_is_saved_or_the_window_closed() {
        let folder = folder("last");
        let mut rescue = Rescue::at(Some(folder.clone()));
        let mut session = edited(7.0);
        rescue.keep(&session).expect("kept");
        session.set_mass(9.0);
        rescue.keep(&session).expect("still being edited");
        let file = rescue.file().expect("a file").to_owned();
        let mass = |file: &Path| Scene::load(file).expect("a scene").bodies[0].mass;
        assert_eq!(mass(&file), 7.0);
        session.settle(LONG);
        rescue.keep(&session).expect("kept");
        assert_eq!(mass(&file), 9.0);
        session.set_mass(9.5);
        rescue.keep_at_once(&mut session).expect("kept");
        assert_eq!(mass(&file), 9.5);
        session.save(&folder.join("mine"), false);
        rescue.keep(&session).expect("saved");
        assert!(rescue.file().is_none() && !file.exists());
        session.set_mass(10.0);
        session.settle(LONG);
        rescue.keep(&session).expect("kept");
        assert!(rescue.file().is_some());
        rescue.forget();
        let names = fs::read_dir(&folder).expect("the folder");
        let names = names.map(|entry| entry.expect("a name").file_name());
        assert_eq!(names.collect::<Vec<_>>(), ["mine.toml"]);
        fs::remove_dir_all(folder).expect("removed");
    }

    #[test]
    fn where_nothing_can_be_kept_it_is_told_once() {
        let folder = folder("no");
        fs::write(&folder, "a file").expect("written");
        let mut rescue = Rescue::at(Some(folder.clone()));
        let session = edited(7.0);
        let error = rescue.keep(&session).expect_err("no folder");
        assert!(format!("{error:#}").contains("edits are not kept in "));
        rescue.keep(&session).expect("told");
        fs::remove_file(folder).expect("removed");
        let mut nowhere = Rescue::at(None);
        nowhere.keep(&session).expect("nowhere to keep it");
        assert!(nowhere.left_behind().is_empty());
    }
}
