//! The preferences of the user, kept from one start of the program to the next.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use etcetera::BaseStrategy;
use serde::{Deserialize, Serialize};

use crate::words::Language;

/// The number of recently opened files that are remembered.
pub const MOST_RECENT: usize = 8;

/// The settings that outlive the window. A setting that a file does not name has its default.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// The language of the window.
    pub language: Language,
    /// Light panels rather than dark ones.
    pub light: bool,
    /// Scale factor of the panels.
    pub zoom: f32,
    /// Whether the side panel is shown.
    pub panel: bool,
    /// Whether the live figures are shown.
    pub figures: bool,
    /// Whether the plots are shown.
    pub plots: bool,
    /// Whether the ground grid is drawn.
    pub grid: bool,
    /// Whether the axes have numbers.
    pub numbers: bool,
    /// Whether all bodies are named in the picture.
    pub names: bool,
    /// Whether edges are drawn over all meshes.
    pub wireframe: bool,
    /// Whether the projection is parallel.
    pub parallel: bool,
    /// Files that were opened or saved, the latest first.
    pub recent: Vec<PathBuf>,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            language: Language::English,
            light: false,
            zoom: 1.0,
            panel: true,
            figures: true,
            plots: true,
            grid: true,
            numbers: true,
            names: false,
            wireframe: false,
            parallel: false,
            recent: Vec::new(),
        }
    }
}

impl Preferences {
    /// The defaults for a new user: in the language of the system, if it is supported.
    pub fn first(locale: Option<&str>) -> Self {
        let chinese = locale.is_some_and(|locale| locale.to_lowercase().starts_with("zh"));
        Self {
            language: match chinese {
                true => Language::Chinese,
                false => Language::English,
            },
            ..Self::default()
        }
    }
}

/// The file of the preferences.
pub struct Store {
    /// `None` if the system has no place for it.
    path: Option<PathBuf>,
    /// The contents of the file.
    kept: Option<Preferences>,
}

impl Store {
    /// The file in the system's place for preferences.
    pub fn of_the_system() -> Self {
        let folders = etcetera::choose_base_strategy().ok();
        let file = Path::new("cowbell").join("preferences.json");
        Self::at(folders.map(|folders| folders.config_dir().join(file)))
    }

    /// A file at a path; without a path nothing is kept.
    pub fn at(path: Option<PathBuf>) -> Self {
        Self { path, kept: None }
    }

    /// The contents of the file; `None` if it does not exist. Errors name the file.
    pub fn load(&mut self) -> Result<Option<Preferences>> {
        let Some(path) = self.path.as_deref().filter(|path| path.exists()) else {
            return Ok(None);
        };
        let place = || scene::shown::path(path);
        let text = std::fs::read(path).with_context(|| format!("cannot read {}", place()))?;
        let kept: Preferences = serde_json::from_slice(&text)
            .with_context(|| format!("{} is passed over: delete it, or mend it", place()))?;
        self.kept = Some(kept.clone());
        Ok(Some(kept))
    }

    /// Writes preferences if they differ from those in the file. Errors name the file.
    pub fn keep(&mut self, wanted: &Preferences) -> Result<()> {
        let Some(path) = &self.path else {
            return Ok(());
        };
        if self.kept.as_ref() == Some(wanted) {
            return Ok(());
        }
        // A failed write is not repeated until the preferences change.
        self.kept = Some(wanted.clone());
        write(path, wanted)
            .with_context(|| format!("preferences are not kept in {}", scene::shown::path(path)))
    }
}

fn write(path: &Path, wanted: &Preferences) -> Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let text = serde_json::to_string_pretty(wanted)?;
    Ok(scene::file::write(path, text.as_bytes())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn preferences_are_kept_and_a_broken_file_is_told() {
        let folder =
            std::env::temp_dir().join(format!("cowbell-preferences-{}", std::process::id()));
        let path = folder.join("deeper").join("preferences.json");
        let mut store = Store::at(Some(path.clone()));
        assert_eq!(store.load().expect("no file yet"), None);
        let wanted = Preferences {
            language: Language::Chinese,
            zoom: 1.25,
            recent: vec!["a.toml".into()],
            ..Preferences::default()
        };
        store.keep(&wanted).expect("written");
        let again = Store::at(Some(path.clone())).load().expect("read");
        assert_eq!(again, Some(wanted));
        std::fs::write(&path, "{\"zoom\": 2.0, \"of later\": 1}").expect("written");
        let partly = Store::at(Some(path.clone())).load().expect("read");
        assert_eq!(partly.map(|p| (p.zoom, p.plots)), Some((2.0, true)));
        std::fs::write(&path, "{\"zoom\": tw").expect("written");
        let error = Store::at(Some(path)).load().expect_err("broken");
        assert!(
            format!("{error:#}").contains("preferences.json"),
            "{error:#}"
        );
        std::fs::remove_dir_all(folder).expect("removed");
    }

    #[test]
    fn the_first_language_is_that_of_the_system() {
        for (locale, language) in [
            (Some("zh-CN"), Language::Chinese),
            (Some("zh_TW.UTF-8"), Language::Chinese),
            (Some("de-DE"), Language::English),
            (None, Language::English),
        ] {
            assert_eq!(Preferences::first(locale).language, language, "{locale:?}");
        }
    }
}
