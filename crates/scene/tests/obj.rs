//! OBJ files: what they may hold, and what is wrong with the others.

use std::path::Path;

use scene::mesh_file::{self, Format};
use scene::{FORMATS, LoadedMesh, MeshFileError};

fn read(text: impl AsRef<[u8]>) -> Result<LoadedMesh, MeshFileError> {
    let path = Path::new("test.obj");
    mesh_file::read(Format::of(path)?, path, text.as_ref())
}

/// A tetrahedron, its faces outward, with `faces` in place of its own.
fn tetrahedron(faces: &str) -> String {
    format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n{faces}")
}

const FACES: &str = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

#[test]
fn the_same_tetrahedron_in_many_spellings() {
    let valid: &[(&str, Vec<u8>)] = &[
        ("plain", tetrahedron(FACES).into()),
        ("no newline at the end", tetrahedron(FACES.trim_end()).into()),
        ("CRLF", tetrahedron(FACES).replace('\n', "\r\n").into()),
        ("CR alone", tetrahedron(&format!("# f 9 9 9\n{FACES}")).replace('\n', "\r").into()),
        ("byte order mark", format!("\u{feff}{}", tetrahedron(FACES)).into()),
        (
            "indices from the last vertex back",
            tetrahedron("f -4 -2 -3\nf -4 -3 -1\nf -4 -1 -2\nf -3 -2 -1").into(),
        ),
        (
            "texture coordinates and normals, also missing ones",
            tetrahedron("vt 0 0\nvn nonsense\nf 1/1 3/1 2/1\nf 1//1 2//1 4//1\nf 1/1/1 4/1/1 3/1/1\nf 2/9/9 3/9/9 4")
                .into(),
        ),
        (
            "objects, groups and materials make one mesh",
            tetrahedron("o a\nmtllib /etc/passwd\nusemtl x\nf 1 3 2\nusemtl y\nf 1 2 4\ng b\nf 1 4 3\ns off\no c d\nf 2 3 4")
                .into(),
        ),
        (
            "comments, blank lines, leading space, tabs",
            tetrahedron("\n  # v nan\n#f 0\n\tf\t1 3 2 # first\nf 1  2 4\nf 1 4 3#\nf 2 3 4\n\n").into(),
        ),
        (
            "comments in another encoding",
            [b"# caf\xe9\n", tetrahedron(FACES).as_bytes(), b"# \xff\ng \xfe\n"].concat(),
        ),
        (
            "lines, points, curves are left out",
            tetrahedron(&format!("l 1 2 3\nl 1 99\np 7\ncurv 0 1 \\\nf 9 9 9\n{FACES}")).into(),
        ),
        ("statements over several lines", tetrahedron("f 1 \\\n3 \\\r\n2\nf 1 2 4\nf 1 4 3\nf 2 3 4").into()),
        ("a face before its vertices", format!("{FACES}{}", tetrahedron("")).into()),
        (
            "weights and colours",
            format!("v 0 0 0 1\nv 1 0 0 2\nv 0 1 0 1 0.5 0\nv 0 0 1 red\n{FACES}").into(),
        ),
        ("vertices that need welding", {
            let shifted = "f 5 7 6\nf 1 2 4\nf 1 4 3\nf 6 7 8";
            (tetrahedron("") + &tetrahedron(shifted)).into()
        }),
    ];
    let expected = read(tetrahedron(FACES)).expect("a tetrahedron").mesh;
    for (name, text) in valid {
        let loaded = read(text).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(loaded.format, "obj", "{name}");
        assert_eq!(loaded.mesh.vertices().len(), 4, "{name}");
        assert_eq!(loaded.mesh.volume(), expected.volume(), "{name}");
    }
    assert_eq!(expected.volume(), Some(1.0 / 6.0));
}

#[test]
fn repairs_count_what_the_file_had() {
    let loaded = read(tetrahedron(FACES)).expect("a tetrahedron");
    assert!(loaded.repairs.is_empty(), "{:?}", loaded.repairs);
    let mended = tetrahedron(&format!(
        "v 9 9 9\nv 0 0 0\n{FACES}f 1 2 2\nf 3 2 1\nf 2 6 4\n"
    ));
    let repairs = read(mended).expect("a tetrahedron").repairs;
    assert_eq!(repairs.unreferenced_vertices, 1);
    assert_eq!(repairs.degenerate_triangles, 1);
    assert_eq!(repairs.welded_vertices, 1);
}

#[test]
fn polygons_are_cut_where_they_are_not_convex() {
    // An L of 3 m2, extruded by 1 m.
    let mut text = String::new();
    let outline = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)];
    for z in [0, 1] {
        for (x, y) in outline {
            text += &format!("v {x} {y} {z}\n");
        }
    }
    text += "f 6 5 4 3 2 1\nf 7 8 9 10 11 12\n";
    for i in 0..6 {
        let j = (i + 1) % 6;
        text += &format!("f {} {} {} {}\n", i + 1, j + 1, j + 7, i + 7);
    }
    let loaded = read(text).expect("an L");
    assert!(loaded.repairs.is_empty(), "{:?}", loaded.repairs);
    assert_eq!(loaded.mesh.triangles().len(), 20);
    assert_eq!(loaded.mesh.volume(), Some(3.0));
}

#[test]
fn wrong_files_get_a_message_with_the_line() {
    let collapsed = "v 1 1 1\n".repeat(3) + "f 1 2 3";
    let cases: &[(&str, Vec<u8>, &str)] = &[
        ("empty", b"".to_vec(), "test.obj: has no faces"),
        (
            "only vertices",
            tetrahedron("").into(),
            "test.obj: has no faces",
        ),
        (
            "only lines",
            tetrahedron("l 1 2 3").into(),
            "test.obj: has no faces",
        ),
        (
            "garbage",
            vec![0, 159, 146, 150, 10, 255, 13],
            "test.obj: has no faces",
        ),
        (
            "lines of another file",
            tetrahedron(&format!("call faces.obj\n{FACES}")).into(),
            "test.obj:5: `call` puts the lines of another file here",
        ),
        (
            "no number",
            "v 0 0 0\nv 0 x 0".into(),
            "test.obj:2: y of the vertex is `x`",
        ),
        (
            "short vertex",
            "\nv 0 0".into(),
            "test.obj:2: the vertex has no z",
        ),
        (
            "nan",
            "v 0 0 0\n\nv 0 0 nan".into(),
            "test.obj:3: z of the vertex is `nan`",
        ),
        (
            "inf",
            "v -inf 0 0".into(),
            "test.obj:1: x of the vertex is `-inf`",
        ),
        (
            "infinity",
            "v 0 infinity 0".into(),
            "finite number below 3.4e38",
        ),
        (
            "overflow",
            "v 0 1e39 0".into(),
            "test.obj:1: y of the vertex is `1e39`",
        ),
        (
            "not text",
            b"# x\nv 0 0 \xff\n".to_vec(),
            "test.obj:2: z of the vertex is `\u{fffd}`",
        ),
        (
            "index too high",
            tetrahedron("f 1 2 5").into(),
            "test.obj:5: a face uses vertex 5, but the vertices are 1 to 4",
        ),
        (
            "index 0",
            tetrahedron("f 1 2 3\nf 0 1 2").into(),
            "test.obj:6: a face uses vertex 0",
        ),
        (
            "index too far back",
            tetrahedron("f -5 2 3").into(),
            "test.obj:5: a face uses vertex -5",
        ),
        (
            "largest index",
            tetrahedron("f 1 2 9223372036854775807").into(),
            "test.obj:5: a face uses vertex 9223372036854775807",
        ),
        (
            "least index",
            tetrahedron("f 1 2 -9223372036854775808").into(),
            "test.obj:5: a face uses vertex -92233",
        ),
        (
            "index beyond all",
            tetrahedron("f 1 2 99999999999999999999").into(),
            "test.obj:5: `99999999999999999999` is not a corner",
        ),
        (
            "no vertices",
            "f 1 2 3".into(),
            "test.obj:1: a face uses vertex 3, but there are no vertices",
        ),
        (
            "broken corner",
            tetrahedron("f 1 /2 3").into(),
            "test.obj:5: `/2` is not a corner",
        ),
        (
            "two corners",
            tetrahedron("f 1 2").into(),
            "test.obj:5: the face has 2 corners",
        ),
        (
            "no corners",
            tetrahedron("f").into(),
            "test.obj:5: the face has 0 corners",
        ),
        (
            "unfinished",
            tetrahedron("f 1 2\\").into(),
            "test.obj:5: the face has 2 corners",
        ),
        (
            "later lines count on",
            tetrahedron("f 1 \\\n2 3\nf 1 2 x").into(),
            "test.obj:7: `x` is not",
        ),
        (
            "no area at all",
            collapsed.into(),
            "test.obj: the mesh has no triangle",
        ),
    ];
    for (name, text, expected) in cases {
        let error = read(text).expect_err(name).to_string();
        assert!(error.contains(expected), "{name}: {error}");
    }
}

#[test]
fn a_large_polygon_that_is_not_convex_is_refused() {
    let mut text = String::new();
    let mut face = "f".to_owned();
    for i in 0..5000 {
        let angle = f64::from(i) / 5000.0 * std::f64::consts::TAU;
        let radius = if i == 7 { 0.5 } else { 1.0 };
        text += &format!("v {} {} 0\n", radius * angle.cos(), radius * angle.sin());
        face += &format!(" {}", i + 1);
    }
    let error = read(text + &face).expect_err("too many ears").to_string();
    assert!(error.contains("5000 corners that is not convex"), "{error}");
}

#[test]
fn paths_choose_the_format_and_errors_name_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("written");
        path
    };
    let loaded = mesh_file::load(&file("a.OBJ", &tetrahedron(FACES))).expect("an OBJ file");
    assert_eq!(loaded.format, "obj");

    let directory = folder.path().join("folder.obj");
    std::fs::create_dir(&directory).expect("a folder");
    let cases = [
        (file("a.3ds", ""), "the extension must be .obj or .dae"),
        (file("obj", ""), "the extension must be .obj or .dae"),
        (
            folder.path().join("missing.obj"),
            "cannot read the mesh file",
        ),
        (directory, "not a regular file"),
        (file("b.obj", "v 0 0"), "b.obj:1: the vertex has no z"),
    ];
    for (path, expected) in cases {
        let error = mesh_file::load(&path).expect_err(expected).to_string();
        assert!(error.contains(expected), "{error}");
        assert!(error.contains(&path.display().to_string()), "{error}");
    }
}

#[test]
fn a_material_library_is_not_opened() {
    // Opening a folder as a library would fail; a pipe would wait for ever.
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.obj");
    std::fs::create_dir(folder.path().join("a.mtl")).expect("a folder");
    std::fs::write(&path, format!("mtllib a.mtl\n{}", tetrahedron(FACES))).expect("written");
    assert!(mesh_file::load(&path).is_ok());
}

#[test]
fn formats_have_their_own_names_and_extensions() {
    for (i, a) in FORMATS.iter().enumerate() {
        assert!(!a.title.is_empty() && !a.extensions.is_empty());
        for b in &FORMATS[..i] {
            assert_ne!(a.name, b.name);
            assert!(
                a.extensions
                    .iter()
                    .all(|known| !b.extensions.contains(known))
            );
        }
        for extension in a.extensions {
            assert_eq!(*extension, extension.to_lowercase());
        }
    }
}
