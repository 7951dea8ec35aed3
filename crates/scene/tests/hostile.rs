//! Broken files of every kind: a message or a mesh, never a panic.

use std::path::Path;
use std::sync::OnceLock;

use proptest::prelude::*;
use scene::mesh_file::{self, Format};
use scene::{FORMATS, SCENES, Scene};

const CUBE: &str = include_str!("../assets/meshes/cube.obj");

/// A bit of everything that the COLLADA reader knows.
const DOCUMENT: &str = r##"<?xml version="1.0"?>
<COLLADA><asset><unit meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="a" count="15">0 0 0 1 0 0 1 1 0 0 1 0 0 0 1</float_array>
<technique_common><accessor source="#a" offset="0" count="5" stride="3"><param name="X"/><param name="Y"/><param name="Z"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="2"><input semantic="VERTEX" source="#v" offset="1"/><input semantic="NORMAL" source="#n" offset="0"/><p>0 0 0 2 0 1 0 0 0 3 0 2</p></triangles>
<polylist count="1"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4 3</vcount><p>0 1 2 3 0 1 4</p></polylist>
<polygons><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 3</p></polygons>
<trifans><input semantic="VERTEX" source="#v" offset="0"/><p>4 0 1 2 3 0</p></trifans>
<tristrips><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 3 4</p></tristrips>
</mesh></geometry></library_geometries>
<library_controllers><controller id="c"><skin source="#g"><bind_shape_matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</bind_shape_matrix></skin></controller></library_controllers>
<library_nodes><node id="n"><matrix>1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 1</matrix><instance_geometry url="#g"/></node></library_nodes>
<library_visual_scenes><visual_scene id="w">
<node id="m"><translate>1 2 3</translate><rotate>0 0 1 90</rotate><scale>1 2 3</scale><skew>30 1 0 0 0 1 0</skew><lookat>1 2 3 0 0 0 0 1 0</lookat>
<instance_node url="#n"/><node id="k"><instance_controller url="#c"/></node></node>
</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#w"/></scene></COLLADA>"##;

fn read(format: &'static Format, bytes: &[u8]) {
    if let Ok(loaded) = mesh_file::read(format, Path::new("hostile"), bytes) {
        assert!(loaded.mesh.vertices().iter().all(|v| v.is_finite()));
    }
}

/// What a mutation puts into a file.
fn scrap() -> impl Strategy<Value = Vec<u8>> {
    const WORDS: &[&str] = &[
        "",
        " ",
        "\n",
        "\\\n",
        "-",
        "0",
        "-1",
        "3",
        "99999",
        "18446744073709551615",
        "nan",
        "inf",
        "1e39",
        "1e999",
        "-0",
        "#g",
        "#n",
        "#m",
        "#",
        "<",
        ">",
        "\"",
        "/",
        "<p>",
        "</p>",
        "<!--",
        "<!DOCTYPE a>",
        "<instance_node url=\"#n\"/>",
        "<instance_node url=\"#m\"/>",
        "f 1 2 3",
        "v 1 2 3",
        "f -1 -2 -3",
        "[[body]]",
        "=",
        "[",
        "]",
        "'",
        "\u{0}",
        "é",
    ];
    prop_oneof![
        proptest::sample::select(WORDS).prop_map(|word| word.as_bytes().to_vec()),
        proptest::collection::vec(any::<u8>(), 0..8),
    ]
}

/// A valid file with some stretches replaced.
fn mutated(text: &'static str) -> impl Strategy<Value = Vec<u8>> {
    let edit = (any::<prop::sample::Index>(), 0..12_usize, scrap());
    proptest::collection::vec(edit, 1..6).prop_map(move |edits| {
        let mut bytes = text.as_bytes().to_vec();
        for (at, length, scrap) in edits {
            let start = at.index(bytes.len() + 1);
            let end = (start + length).min(bytes.len());
            bytes.splice(start..end, scrap);
        }
        bytes
    })
}

/// A mutation that keeps the numbers apart: whole words are replaced.
fn reworded(text: &'static str) -> impl Strategy<Value = Vec<u8>> {
    let edit = (any::<prop::sample::Index>(), scrap());
    proptest::collection::vec(edit, 1..4).prop_map(move |edits| {
        let is_end = |c: char| c.is_whitespace() || "<>\"#=,[]".contains(c);
        let mut words: Vec<Vec<u8>> = text
            .split_inclusive(is_end)
            .map(|word| word.as_bytes().to_vec())
            .collect();
        for (at, mut scrap) in edits {
            let word = at.get_mut(&mut words);
            scrap.extend(word.last());
            *word = scrap;
        }
        words.concat()
    })
}

fn scene_text() -> &'static str {
    static TEXT: OnceLock<String> = OnceLock::new();
    TEXT.get_or_init(|| {
        SCENES
            .iter()
            .find(|s| s.name == "two-cubes")
            .expect("it is there")
            .text
            .to_owned()
    })
}

#[test]
fn the_files_to_be_broken_are_valid() {
    let format = |name| FORMATS.iter().find(|f| f.name == name).expect("a format");
    for (name, text) in [("obj", CUBE), ("dae", DOCUMENT)] {
        let loaded = mesh_file::read(format(name), Path::new(name), text.as_bytes());
        loaded.unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn every_cut_is_refused_or_read() {
    for (text, format) in [(CUBE, &FORMATS[0]), (DOCUMENT, &FORMATS[1])] {
        for end in 0..text.len() {
            read(format, &text.as_bytes()[..end]);
        }
    }
    for end in 0..scene_text().len() {
        if let Some(text) = scene_text().get(..end) {
            let _ = Scene::parse(text, Path::new("cut.toml"));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn random_bytes(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        for format in FORMATS {
            read(format, &bytes);
        }
        let _ = Scene::parse(&String::from_utf8_lossy(&bytes), Path::new("random.toml"));
    }

    #[test]
    fn random_statements(words in proptest::collection::vec(scrap(), 0..40)) {
        let bytes = words.join(&b' ');
        for format in FORMATS {
            read(format, &bytes);
        }
    }

    #[test]
    fn mutated_obj(bytes in prop_oneof![mutated(CUBE), reworded(CUBE)]) {
        read(&FORMATS[0], &bytes);
    }

    #[test]
    fn mutated_collada(bytes in prop_oneof![mutated(DOCUMENT), reworded(DOCUMENT)]) {
        read(&FORMATS[1], &bytes);
    }

    #[test]
    fn mutated_scenes(bytes in prop_oneof![mutated(scene_text()), reworded(scene_text())]) {
        if let Ok(scene) = Scene::parse(&String::from_utf8_lossy(&bytes), Path::new("mutated.toml")) {
            let _ = scene.world();
        }
    }
}
