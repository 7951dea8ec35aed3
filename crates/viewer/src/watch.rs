//! Watches the scene's files, so that changes by an editor, and deletions, are noticed at once.

use std::collections::HashSet;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use notify::{Event, RecommendedWatcher, RecursiveMode, Watcher};

/// A watch on some files. If the system does not support it, changes are never noticed.
pub struct Watch {
    wake: Arc<dyn Fn() + Send + Sync>,
    watcher: Option<RecommendedWatcher>,
    files: Vec<PathBuf>,
    touched: Arc<AtomicBool>,
}

impl Watch {
    /// A watch without files; `wake` is called on another thread when a watched file changes.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        Self {
            wake: Arc::new(wake),
            watcher: None,
            files: Vec::new(),
            touched: Arc::default(),
        }
    }

    /// Watches exactly these files from now on.
    pub fn follow<'a>(&mut self, files: impl Iterator<Item = &'a Path> + Clone) {
        let known = self.files.iter().map(|path| path.as_os_str());
        if known.eq(files.clone().map(Path::as_os_str)) {
            return;
        }
        self.files = files.map(Path::to_path_buf).collect();
        self.touched = Arc::default();
        self.watcher = match self.files.is_empty() {
            true => None,
            false => self.watcher().ok(),
        };
    }

    /// Whether a file has changed since the last call.
    pub fn take(&self) -> bool {
        self.touched.swap(false, Ordering::Relaxed)
    }

    /// Many editors write another file and rename it, so the folders are watched. A file of the same name in another of
    /// these folders counts as changed too; the reader then finds no change.
    fn watcher(&self) -> notify::Result<RecommendedWatcher> {
        let (mut names, mut folders) = (HashSet::<OsString>::new(), HashSet::new());
        for file in &self.files {
            let file = std::path::absolute(file)?;
            names.extend(file.file_name().map(ToOwned::to_owned));
            folders.insert(file.parent().unwrap_or(Path::new(".")).to_owned());
        }
        let (touched, wake) = (self.touched.clone(), self.wake.clone());
        let seen = move |event: notify::Result<Event>| {
            let Ok(event) = event else { return };
            let is_change =
                event.kind.is_create() || event.kind.is_modify() || event.kind.is_remove();
            let mut of = event.paths.iter().filter_map(|path| path.file_name());
            if is_change && of.any(|name| names.contains(name)) {
                touched.store(true, Ordering::Relaxed);
                wake();
            }
        };
        let mut watcher = notify::recommended_watcher(seen)?;
        for folder in folders {
            // A missing folder must not prevent watching the others.
            let _ = watcher.watch(&folder, RecursiveMode::NonRecursive);
        }
        Ok(watcher)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;
    use std::time::Duration;

    #[test]
    fn files_that_are_written_replaced_or_removed_are_seen_and_no_others() {
        let folder = std::env::temp_dir().join(format!("cowbell-watch-{}", std::process::id()));
        let deeper = folder.join("meshes");
        std::fs::create_dir_all(&deeper).expect("a folder");
        let (file, mesh) = (folder.join("scene.toml"), deeper.join("mesh.obj"));
        std::fs::write(&file, "a").expect("written");
        std::fs::write(&mesh, "a").expect("written");
        let (wakes, woken) = mpsc::channel();
        let mut watch = Watch::new(move || {
            // Sending fails only when the test is over.
            let _ = wakes.send(());
        });
        watch.follow([&*file, &*mesh].into_iter());
        let other = folder.join("other.toml");
        std::fs::write(&other, "c").expect("written");
        let changes: [(&str, &dyn Fn()); 5] = [
            ("written", &|| std::fs::write(&file, "b").expect("written")),
            ("renamed", &|| {
                std::fs::rename(&other, &file).expect("renamed")
            }),
            ("mesh written", &|| {
                std::fs::write(&mesh, "b").expect("written")
            }),
            ("mesh removed", &|| {
                std::fs::remove_file(&mesh).expect("removed")
            }),
            ("removed", &|| std::fs::remove_file(&file).expect("removed")),
        ];
        for (what, change) in changes {
            std::thread::sleep(Duration::from_millis(200));
            watch.take();
            while woken.try_recv().is_ok() {}
            change();
            woken.recv_timeout(Duration::from_secs(20)).expect(what);
            assert!(watch.take(), "{what}");
        }
        std::thread::sleep(Duration::from_millis(200));
        watch.take();
        std::fs::write(&other, "d").expect("written");
        std::thread::sleep(Duration::from_millis(300));
        assert!(!watch.take(), "another file");
        watch.follow([].into_iter());
        std::fs::write(&file, "e").expect("written");
        std::thread::sleep(Duration::from_millis(300));
        assert!(!watch.take(), "nothing is watched");
        std::fs::remove_dir_all(folder).expect("removed");
    }
}
