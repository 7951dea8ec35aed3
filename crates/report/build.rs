//! Keeps how the report was compiled, for the page to say.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let rustc = std::env::var("RUSTC").unwrap_or_default();
    let version = std::process::Command::new(rustc).arg("--version").output();
    let version = version.map(|out| String::from_utf8_lossy(&out.stdout).trim().to_owned());
    println!(
        "cargo::rustc-env=REPORT_RUSTC={}",
        version.unwrap_or_default()
    );
    for (name, of_cargo) in [
        ("TARGET", "TARGET"),
        ("PROFILE", "PROFILE"),
        ("OPT_LEVEL", "OPT_LEVEL"),
        ("FEATURES", "CARGO_CFG_TARGET_FEATURE"),
        ("FLAGS", "CARGO_ENCODED_RUSTFLAGS"),
    ] {
        let value = std::env::var(of_cargo).unwrap_or_default();
        // Flags are separated by a character that no flag contains.
        println!(
            "cargo::rustc-env=REPORT_{name}={}",
            value.replace('\u{1f}', " ")
        );
    }
}
