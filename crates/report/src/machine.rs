//! What the figures depend on: machine, flags, versions, date, command.

use std::path::Path;
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

/// Facts with their names.
pub(crate) fn facts() -> Vec<(&'static str, String)> {
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    let flags = match env!("REPORT_FLAGS") {
        "" => "no RUSTFLAGS".into(),
        flags => format!("RUSTFLAGS {flags}"),
    };
    vec![
        (
            "Processor",
            format!(
                "{}, {threads} threads for this program; the report uses one",
                cpu()
            ),
        ),
        (
            "System",
            format!("{} on {}", std::env::consts::OS, std::env::consts::ARCH),
        ),
        (
            "Compiled by",
            format!("{} for {}", env!("REPORT_RUSTC"), env!("REPORT_TARGET")),
        ),
        (
            "Flags",
            format!(
                "profile {}, opt-level {}, codegen-units 1 for sim-core, the peers, the cases and the report \
                 alike, {flags}, target features {}",
                env!("REPORT_PROFILE"),
                env!("REPORT_OPT_LEVEL"),
                env!("REPORT_FEATURES"),
            ),
        ),
        ("Versions", versions()),
        ("Date", date()),
        ("Command", command()),
    ]
}

fn cpu() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = info.lines().find(|line| line.starts_with("model name"));
    let name = line.and_then(|line| line.split(':').nth(1));
    name.map_or_else(|| std::env::consts::ARCH.into(), |name| name.trim().into())
}

/// Crates whose versions matter.
const CRATES: [&str; 6] = [
    "ode_solvers",
    "differential-equations",
    "rapier3d-f64",
    "parry3d-f64",
    "nalgebra",
    "kuva",
];

fn versions() -> String {
    let own = format!(
        "sim-core and report {}{}",
        env!("CARGO_PKG_VERSION"),
        commit()
    );
    let lock = include_str!("../../../Cargo.lock");
    let found = CRATES
        .iter()
        .flat_map(|name| locked(lock, name).map(move |version| format!("{name} {version}")));
    [own]
        .into_iter()
        .chain(found)
        .collect::<Vec<_>>()
        .join(", ")
}

/// Versions of a crate in a lock file.
fn locked<'a>(lock: &'a str, name: &'a str) -> impl Iterator<Item = &'a str> {
    let packages = lock.split("[[package]]").filter(move |package| {
        let line = package
            .lines()
            .find_map(|line| line.strip_prefix("name = "));
        line.is_some_and(|quoted| quoted.trim_matches('"') == name)
    });
    packages.filter_map(|package| {
        let version = package
            .lines()
            .find_map(|line| line.strip_prefix("version = "));
        version.map(|quoted| quoted.trim_matches('"'))
    })
}

/// The commit, if this is a clone and git is there to ask.
fn commit() -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut git = Command::new("git");
    let git = git
        .current_dir(folder)
        .args(["describe", "--always", "--dirty"]);
    let output = git.output().ok().filter(|output| output.status.success());
    output.map_or(String::new(), |output| {
        format!(
            " (commit {})",
            String::from_utf8_lossy(&output.stdout).trim()
        )
    })
}

fn date() -> String {
    let since = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .unwrap_or_default();
    let [year, month, day] = civil(since.as_secs() / 86_400);
    let minutes = since.as_secs() / 60 % 1440;
    format!(
        "{year}-{month:02}-{day:02} {:02}:{:02} UTC",
        minutes / 60,
        minutes % 60
    )
}

/// Year, month and day of a day since 1970-01-01 (Hinnant, "chrono-compatible low-level date
/// algorithms", civil_from_days): years are counted from March, so that the leap day is the last.
fn civil(days: u64) -> [u64; 3] {
    let from_march_of_0 = days + 719_468;
    let (era, day_of_era) = (from_march_of_0 / 146_097, from_march_of_0 % 146_097);
    let leap = day_of_era / 1460 + day_of_era / 146_096;
    let year_of_era = (day_of_era + day_of_era / 36_524 - leap) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month + 2) / 5 + 1;
    let year = year_of_era + 400 * era + u64::from(month >= 10);
    [year, if month < 10 { month + 3 } else { month - 9 }, day]
}

/// The command that makes this page again.
fn command() -> String {
    let args: Vec<String> = std::env::args().skip(1).collect();
    match args.is_empty() {
        true => "cargo run --release -p report".into(),
        false => format!("cargo run --release -p report -- {}", args.join(" ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_counted_as_calendars_do() {
        assert_eq!(civil(0), [1970, 1, 1]);
        assert_eq!(civil(11_016), [2000, 2, 29]);
        assert_eq!(civil(11_017), [2000, 3, 1]);
        assert_eq!(civil(20_453), [2025, 12, 31]);
        assert_eq!(civil(20_454), [2026, 1, 1]);
    }

    #[test]
    fn the_lock_file_has_the_peers() {
        for name in ["ode_solvers", "differential-equations"] {
            assert!(versions().contains(name), "{name}");
        }
    }
}
