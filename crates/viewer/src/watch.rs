//! Watching the scene's file, so that what an editor writes there is seen at once.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use notify::{Event, RecommendedWatcher, RecursiveMode, Watcher};

/// Watches one file. Where the system cannot, nothing is ever seen.
pub struct Watch {
    wake: Arc<dyn Fn() + Send + Sync>,
    watcher: Option<RecommendedWatcher>,
    file: Option<PathBuf>,
    touched: Arc<AtomicBool>,
}

impl Watch {
    /// Watches nothing yet; `wake` is called, from another thread, when what is watched is touched.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        Self {
            wake: Arc::new(wake),
            watcher: None,
            file: None,
            touched: Arc::default(),
        }
    }

    /// Watches this file from now on, and no other.
    pub fn follow(&mut self, file: Option<&Path>) {
        if self.file.as_deref() == file {
            return;
        }
        self.file = file.map(Path::to_path_buf);
        self.touched = Arc::default();
        self.watcher = file.and_then(|file| self.watcher(file).ok());
    }

    /// Whether the file was touched since this was last asked.
    pub fn take(&self) -> bool {
        self.touched.swap(false, Ordering::Relaxed)
    }

    /// Many editors write another file and rename it, so the folder is watched.
    fn watcher(&self, file: &Path) -> notify::Result<RecommendedWatcher> {
        let file = std::path::absolute(file)?;
        let name = file.file_name().map(ToOwned::to_owned);
        let (touched, wake) = (self.touched.clone(), self.wake.clone());
        let seen = move |event: notify::Result<Event>| {
            let Ok(event) = event else { return };
            let is_change = event.kind.is_create() || event.kind.is_modify();
            let mut names = event.paths.iter().map(|path| path.file_name());
            if is_change && names.any(|other| other == name.as_deref()) {
                touched.store(true, Ordering::Relaxed);
                wake();
            }
        };
        let mut watcher = notify::recommended_watcher(seen)?;
        let folder = file.parent().unwrap_or(Path::new("."));
        watcher.watch(folder, RecursiveMode::NonRecursive)?;
        Ok(watcher)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;
    use std::time::Duration;

    #[test]
    fn a_file_that_is_written_or_replaced_is_seen_and_no_other() {
        let folder = std::env::temp_dir().join(format!("cowbell-watch-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let file = folder.join("scene.toml");
        std::fs::write(&file, "a").expect("written");
        let (wakes, woken) = mpsc::channel();
        let mut watch = Watch::new(move || {
            // Fails only when the test is over.
            let _ = wakes.send(());
        });
        watch.follow(Some(&file));
        let wait = || woken.recv_timeout(Duration::from_secs(20));
        std::fs::write(&file, "b").expect("written");
        wait().expect("seen");
        assert!(watch.take());
        std::thread::sleep(Duration::from_millis(200));
        watch.take();
        while woken.try_recv().is_ok() {}
        let other = folder.join("other.toml");
        std::fs::write(&other, "c").expect("written");
        std::fs::rename(&other, &file).expect("renamed");
        wait().expect("seen");
        assert!(watch.take());
        std::thread::sleep(Duration::from_millis(200));
        watch.take();
        std::fs::write(&other, "d").expect("written");
        std::thread::sleep(Duration::from_millis(300));
        assert!(!watch.take(), "another file");
        watch.follow(None);
        std::fs::write(&file, "e").expect("written");
        std::thread::sleep(Duration::from_millis(300));
        assert!(!watch.take(), "nothing is watched");
        std::fs::remove_dir_all(folder).expect("removed");
    }
}
