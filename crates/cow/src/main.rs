//! Writes a cow to a file.

use anyhow::{Context, bail};
use clap::Parser;
use cow::CowMesh;
use std::{
    ffi::OsStr,
    fs::File,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

/// Makes a cow: 2.5 m long, y up, facing -x, closed and free of self-intersections.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    /// Number of triangles, from 1000 to 400000
    #[arg(short, long, default_value_t = 6000)]
    triangles: usize,
    /// File to write, .obj or .dae
    #[arg(short, long, required_unless_present = "check")]
    output: Option<PathBuf>,
    /// Print the validation of the mesh
    #[arg(long)]
    check: bool,
}

type Writer = fn(&CowMesh, &mut BufWriter<File>) -> io::Result<()>;

/// The writer of the format that the path's extension names.
fn writer(path: &Path) -> anyhow::Result<Writer> {
    match path.extension().and_then(OsStr::to_str) {
        Some("obj") => Ok(cow::write::obj),
        Some("dae") => Ok(cow::write::dae),
        _ => bail!(
            "{}: unknown format; name the file .obj or .dae",
            path.display()
        ),
    }
}

fn main() -> anyhow::Result<()> {
    let arguments = Arguments::parse();
    let output = arguments.output.as_deref();
    let write = output.map(writer).transpose()?;
    let mesh = cow::cow(arguments.triangles)?;
    if let (Some(path), Some(write)) = (output, write) {
        let saved = File::create(path).and_then(|file| {
            let mut out = BufWriter::new(file);
            write(&mesh, &mut out)?;
            out.flush()
        });
        saved.with_context(|| format!("cannot write {}", path.display()))?;
    }
    if arguments.check {
        println!("{}", cow::check::check(&mesh));
    }
    Ok(())
}
