//! COLLADA files: geometry, node transforms, instances, and what is wrong with the others.

use std::path::Path;

use glam::{DVec3, Vec3};
use scene::mesh_file::{self, Format};
use scene::{LoadedMesh, MeshFileError};

fn read(text: impl AsRef<[u8]>) -> Result<LoadedMesh, MeshFileError> {
    let path = Path::new("test.dae");
    mesh_file::read(Format::of(path)?, path, text.as_ref())
}

fn document(asset: &str, body: &str) -> String {
    format!(
        r#"<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset>{asset}</asset>
{body}
</COLLADA>"#
    )
}

/// A source of positions and the vertices that use it.
const CORNERS: &str = r##"<source id="s"><float_array id="a" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array>
<technique_common><accessor source="#a" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>"##;

const INPUT: &str = r##"<input semantic="VERTEX" source="#v" offset="0"/>"##;

fn geometry(mesh: &str) -> String {
    format!(
        "<library_geometries><geometry id=\"g\"><mesh>{mesh}</mesh></geometry></library_geometries>"
    )
}

fn triangles() -> String {
    format!("{CORNERS}<triangles>{INPUT}<p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>")
}

fn tetrahedron() -> String {
    geometry(&triangles())
}

fn scene(nodes: &str) -> String {
    format!(
        "<library_visual_scenes><visual_scene id=\"scene\">{nodes}</visual_scene>\
         </library_visual_scenes><scene><instance_visual_scene url=\"#scene\"/></scene>"
    )
}

const HERE: &str = r##"<instance_geometry url="#g"/>"##;

#[test]
fn every_kind_of_primitive_gives_the_tetrahedron() {
    let two_inputs = r##"<input semantic="NORMAL" source="#n" offset="0"/><input semantic="VERTEX" source="#v" offset="1"/>"##;
    let strided = CORNERS
        .replace(
            "0 0 0 1 0 0 0 1 0 0 0 1",
            "9 0 9 0 0 1 9 0 0 0 9 1 0 0 9 0 1",
        )
        .replace("stride=\"3\"", "stride=\"4\" offset=\"1\"")
        .replace(
            "<param name=\"Y\"",
            "<param type=\"float\"/><param name=\"Y\"",
        );
    let cases: &[(&str, String)] = &[
        ("triangles", triangles()),
        (
            "triangles with two inputs",
            format!(
                "{CORNERS}<triangles>{two_inputs}<p>7 0 7 2 7 1 7 0 7 1 7 3 7 0 7 3 7 2 7 1 7 2 7 3</p></triangles>"
            ),
        ),
        (
            "two elements",
            format!(
                "{CORNERS}<triangles>{INPUT}<p>0 2 1</p></triangles><triangles>{INPUT}<p>0 1 3 0 3 2 1 2 3</p></triangles>"
            ),
        ),
        (
            "polylist",
            format!(
                "{CORNERS}<polylist>{INPUT}<vcount>3 3 3 3</vcount><p>0 2 1 0 1 3 0 3 2 1 2 3</p></polylist>"
            ),
        ),
        (
            "polygons",
            format!(
                "{CORNERS}<polygons>{INPUT}<p>0 2 1</p><p>0 1 3</p><p>0 3 2</p><p>1 2 3</p></polygons>"
            ),
        ),
        (
            "a fan around the origin and the last face",
            format!(
                "{CORNERS}<trifans>{INPUT}<p>0 2 1 3 2</p></trifans><triangles>{INPUT}<p>1 2 3</p></triangles>"
            ),
        ),
        (
            "strips",
            format!("{CORNERS}<tristrips>{INPUT}<p>0 2 1 3 0 2</p></tristrips>"),
        ),
        (
            "lines are left out",
            format!(
                "{}<lines>{INPUT}<p>99 98</p></lines><linestrips/>",
                triangles()
            ),
        ),
        (
            "comments in the numbers",
            triangles().replace("0 2 1 0", "0 2 <!-- 7 --> 1 0"),
        ),
        (
            "stride, offset and named parameters",
            triangles().replace(CORNERS, &strided),
        ),
        ("no parameters", {
            let start = CORNERS.find("<param").expect("parameters");
            let end = CORNERS.find("</accessor>").expect("an accessor");
            triangles().replace(&CORNERS[start..end], "")
        }),
    ];
    for (name, mesh) in cases {
        let text = document("", &geometry(mesh));
        let loaded = read(text).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(loaded.format, "dae");
        assert_eq!(loaded.mesh.triangles().len(), 4, "{name}");
        assert_eq!(loaded.mesh.volume(), Some(1.0 / 6.0), "{name}");
        assert!(loaded.repairs.is_empty(), "{name}: {:?}", loaded.repairs);
    }
}

#[test]
fn nodes_place_what_they_instance() {
    let cases: &[(&str, &str, [f64; 3], f64)] = &[
        // Name, node contents around the instance, image of (1, 0, 0), volume times six.
        ("nothing", "{}", [1., 0., 0.], 1.),
        (
            "translate",
            "<translate>1 2 3</translate>{}",
            [2., 2., 3.],
            1.,
        ),
        (
            "rotate",
            "<rotate sid=\"z\">0 0 2 90</rotate>{}",
            [0., 1., 0.],
            1.,
        ),
        (
            "no rotation about no axis",
            "<rotate>0 0 0 0</rotate>{}",
            [1., 0., 0.],
            1.,
        ),
        ("scale", "<scale>2 3 4</scale>{}", [2., 0., 0.], 24.),
        (
            "document order",
            "<translate>1 0 0</translate><rotate>0 0 1 90</rotate><scale>2 2 2</scale>{}",
            [1., 2., 0.],
            8.,
        ),
        (
            "row by row",
            "<matrix>1 0 0 5  0 0 -1 6  0 1 0 7  0 0 0 1</matrix>{}",
            [6., 6., 7.],
            1.,
        ),
        (
            "look at",
            "<lookat>1 2 3  1 2 -9  0 1 0</lookat>{}",
            [2., 2., 3.],
            1.,
        ),
        ("skew", "<skew>45 1 0 0 0 1 0</skew>{}", [1., 1., 0.], 1.),
        (
            "a mirror keeps it outward",
            "<scale>-1 1 1</scale>{}",
            [-1., 0., 0.],
            1.,
        ),
        (
            "nested nodes",
            "<translate>1 0 0</translate><node><rotate>0 0 1 90</rotate><node>{}</node></node>",
            [1., 1., 0.],
            1.,
        ),
    ];
    for (name, contents, image, volume) in cases {
        let node = format!("<node>{}</node>", contents.replace("{}", HERE));
        let text = document("", &(tetrahedron() + &scene(&node)));
        let mesh = read(text)
            .unwrap_or_else(|error| panic!("{name}: {error}"))
            .mesh;
        let near = |v: &Vec3| (v.as_dvec3() - DVec3::from(*image)).length() < 1e-6;
        assert!(
            mesh.vertices().iter().any(near),
            "{name}: {:?}",
            mesh.vertices()
        );
        let got = mesh.volume().expect("a volume") * 6.0;
        assert!((got - volume).abs() < 1e-5, "{name}: {got}");
    }
}

#[test]
fn instances_are_copies() {
    let library = "<library_nodes><node id=\"pair\"><translate>0 0 2</translate><node><instance_geometry url=\"#g\"/></node>\
        <node><translate>0 0 4</translate><instance_geometry url=\"#g\"/></node></node></library_nodes>";
    let nodes = "<node><instance_node url=\"#pair\"/></node>\
        <node><translate>9 0 0</translate><instance_node url=\"#pair\"/><instance_geometry url=\"#g\"/></node>";
    let mesh = read(document("", &(tetrahedron() + library + &scene(nodes))))
        .expect("copies")
        .mesh;
    assert_eq!(mesh.triangles().len(), 5 * 4);
    let volume = mesh.volume().expect("a volume");
    assert!((volume - 5.0 / 6.0).abs() < 1e-6, "{volume}");
    assert_eq!(mesh.bounds().max, Vec3::new(10.0, 1.0, 7.0));
}

#[test]
fn skins_come_in_their_bind_shape() {
    let controllers = "<library_controllers><controller id=\"c\"><skin source=\"#m\">\
        <bind_shape_matrix>1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 1</bind_shape_matrix></skin></controller>\
        <controller id=\"m\"><morph source=\"#g\"/></controller></library_controllers>";
    let nodes = "<node><translate>0 1 0</translate><instance_controller url=\"#c\"/></node>";
    let mesh = read(document("", &(tetrahedron() + controllers + &scene(nodes))))
        .expect("a skin")
        .mesh;
    assert_eq!(mesh.bounds().min, Vec3::new(5.0, 1.0, 0.0));
}

#[test]
fn units_and_axes_become_metres_and_y_up() {
    let cases = [
        ("", [1., 0., 0.], [0., 0., 1.]),
        (
            "<unit meter=\"0.01\" name=\"cm\"/><up_axis>Y_UP</up_axis>",
            [0.01, 0., 0.],
            [0., 0., 0.01],
        ),
        // The document's x stays to the right and its z goes up.
        ("<up_axis>Z_UP</up_axis>", [1., 0., 0.], [0., 1., 0.]),
        (
            "<up_axis> X_UP </up_axis><unit/>",
            [0., 1., 0.],
            [0., 0., 1.],
        ),
    ];
    for (asset, x, z) in cases {
        let mesh = read(document(asset, &tetrahedron())).expect(asset).mesh;
        for image in [x, z] {
            let image = DVec3::from(image).as_vec3();
            assert!(
                mesh.vertices().contains(&image),
                "{asset}: {:?}",
                mesh.vertices()
            );
        }
        assert!(mesh.volume().expect("a volume") > 0.0, "{asset}");
    }
}

#[test]
fn wrong_files_get_a_message_with_element_and_line() {
    let good = document(
        "",
        &(tetrahedron() + &scene(&format!("<node id=\"n\">{HERE}</node>"))),
    );
    assert!(read(&good).is_ok());
    // Name, what is replaced in the good document, by what, part of the message.
    let cases: &[(&str, &str, &str, &str)] = &[
        (
            "another document",
            "COLLADA",
            "svg",
            "test.dae:2: <svg>: the root element must be <COLLADA>",
        ),
        ("cut off", "</COLLADA>", "", "test.dae:"),
        (
            "document type",
            "<COLLADA xml",
            "<!DOCTYPE x [<!ENTITY a \"b\">]><COLLADA xml",
            "DTD",
        ),
        (
            "unit",
            "<asset>",
            "<asset><unit meter=\"-1\"/>",
            "test.dae:3: <unit>: meter is `-1`",
        ),
        (
            "unit",
            "<asset>",
            "<asset><unit meter=\"nan\"/>",
            "meter is `nan`",
        ),
        (
            "up axis",
            "<asset>",
            "<asset><up_axis>UP</up_axis>",
            "must be X_UP, Y_UP or Z_UP",
        ),
        (
            "missing scene",
            "url=\"#scene\"",
            "url=\"#other\"",
            "there is no <visual_scene> with the id `other`",
        ),
        (
            "missing geometry",
            "url=\"#g\"",
            "url=\"#h\"",
            "<instance_geometry> in <node id=\"n\">: there is no <geometry> with the id `h`",
        ),
        (
            "other file",
            "url=\"#g\"",
            "url=\"b.dae#g\"",
            "other files are not followed",
        ),
        ("no url", "url=\"#g\"", "", "the attribute `url` is missing"),
        (
            "cycle",
            HERE,
            "<instance_node url=\"#n\"/>",
            "the node instances itself",
        ),
        (
            "cycle below",
            HERE,
            "<node id=\"o\"><instance_node url=\"#n\"/></node>",
            "the node instances itself",
        ),
        (
            "nan",
            "0 0 0 1 0 0",
            "0 0 nan 1 0 0",
            "test.dae:4: <float_array id=\"a\">: value 3 is `nan`: it must be a finite number",
        ),
        (
            "overflow of f64",
            "0 0 0 1 0 0",
            "0 0 1e999 1 0 0",
            "value 3 is `1e999`",
        ),
        (
            "overflow of f32",
            "0 0 0 1 0 0",
            "0 0 1e39 1 0 0",
            "beyond 3.4e38",
        ),
        ("word", "0 0 0 1 0 0", "0 0 x 1 0 0", "value 3 is `x`"),
        (
            "missing source",
            "id=\"s\"",
            "id=\"t\"",
            "there is no <source> with the id `s`",
        ),
        (
            "missing vertices",
            "id=\"v\"",
            "id=\"w\"",
            "there is no <vertices> with the id `v`",
        ),
        (
            "missing array",
            "id=\"a\"",
            "id=\"b\"",
            "there is no <float_array> or <int_array> with the id `a`",
        ),
        (
            "missing accessor",
            "accessor",
            "access",
            "<source id=\"s\">: there is no <accessor>",
        ),
        (
            "no position",
            "POSITION",
            "NORMAL",
            "<vertices id=\"v\">: there is no <input> with semantic=\"POSITION\"",
        ),
        (
            "no vertex",
            "VERTEX",
            "NORMAL",
            "there is no <input> with semantic=\"VERTEX\"",
        ),
        (
            "huge count",
            "count=\"4\"",
            "count=\"4000000000000000000\"",
            "the array holds only 4 positions",
        ),
        (
            "broken count",
            "count=\"4\"",
            "count=\"-4\"",
            "count is `-4`: it must be a whole number",
        ),
        (
            "huge stride",
            "stride=\"3\"",
            "stride=\"18446744073709551615\"",
            "holds only 1 positions",
        ),
        (
            "huge array offset",
            "stride=\"3\"",
            "stride=\"3\" offset=\"18446744073709551615\"",
            "holds only 0 positions",
        ),
        (
            "no stride",
            "stride=\"3\"",
            "",
            "stride is 1: it must be at least 3",
        ),
        (
            "no stride at all",
            "stride=\"3\"",
            "stride=\"0\"",
            "stride is 0: it must be at least 3",
        ),
        (
            "huge input offset",
            "offset=\"0\"",
            "offset=\"18446744073709551615\"",
            "make no whole corners",
        ),
        (
            "index",
            "1 2 3</p>",
            "1 2 4</p>",
            "<p> in <geometry id=\"g\">: a corner uses vertex 4, but there are only 4",
        ),
        (
            "negative index",
            "1 2 3</p>",
            "1 2 -3</p>",
            "value 12 is `-3`: it must be an index",
        ),
        (
            "half a triangle",
            "1 2 3</p>",
            "1 2</p>",
            "11 corners make no whole triangles",
        ),
        (
            "half a corner",
            "offset=\"0\"",
            "offset=\"4\"",
            "12 indices make no whole corners of 5 inputs",
        ),
        (
            "flat",
            "<node id=\"n\">",
            "<node id=\"n\"><scale>1 0 1</scale>",
            "transforms flatten all 1 instances",
        ),
        (
            "blown up",
            "<node id=\"n\">",
            "<node id=\"n\"><scale>1e200 1e200 1</scale>",
            "blow the geometry up",
        ),
        (
            "short matrix",
            "<node id=\"n\">",
            "<node id=\"n\"><matrix>1 2 3</matrix>",
            "<matrix> in <node id=\"n\">: it must hold 16 numbers and holds 3",
        ),
        (
            "perspective",
            "<node id=\"n\">",
            "<node id=\"n\"><matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1</matrix>",
            "the last row must be 0 0 0 1",
        ),
        (
            "no axis",
            "<node id=\"n\">",
            "<node id=\"n\"><rotate>0 0 0 30</rotate>",
            "the axis has no direction",
        ),
        (
            "no direction",
            "<node id=\"n\">",
            "<node id=\"n\"><lookat>0 0 0 0 0 0 0 1 0</lookat>",
            "in line",
        ),
        (
            "skew too far",
            "<node id=\"n\">",
            "<node id=\"n\"><skew>95 1 0 0 0 1 0</skew>",
            "the angle must turn between the axes",
        ),
        (
            "hull",
            "<mesh>",
            "<convex_mesh/><mesh>",
            "convex hulls are not supported",
        ),
        ("empty scene", HERE, "", "shows no triangles"),
        (
            "hole",
            "<p>",
            "<ph><p>0 1 2</p><h>1 2 3</h></ph><p>",
            "a hole of the polygon crosses",
        ),
        (
            "controller",
            HERE,
            "<instance_controller url=\"#g\"/>",
            "there is no <controller> with the id `g`",
        ),
    ];
    for (name, from, to, expected) in cases {
        assert!(good.contains(from), "{name}");
        let error = read(good.replace(from, to)).expect_err(name).to_string();
        assert!(error.contains(expected), "{name}: {error}");
        assert!(error.starts_with("test.dae:"), "{name}: {error}");
    }
    for (text, expected) in [
        (&b""[..], "is not well-formed XML"),
        (b"\x00\x01\x02", "is not well-formed XML"),
        (b"<a>\n\xff</a>", "test.dae:2: is not UTF-8"),
        (b"<COLLADA/>", "shows no triangles"),
    ] {
        let error = read(text).expect_err(expected).to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn polylists_must_agree_with_their_counts() {
    for (counts, indices, expected) in [
        ("3 3", "0 1 2", "ends before the last polygon"),
        ("3", "0 1 2 3", "1 corners are more than <vcount> says"),
        ("2", "0 1", "a polygon has 2 corners"),
        ("0", "", "a polygon has 0 corners"),
        ("4000000000", "0 1 2", "ends before the last polygon"),
    ] {
        let list = format!(
            "{CORNERS}<polylist>{INPUT}<vcount>{counts}</vcount><p>{indices}</p></polylist>"
        );
        let error = read(document("", &geometry(&list)))
            .expect_err(counts)
            .to_string();
        assert!(error.contains(expected), "{error}");
    }
    let without = format!("{CORNERS}<polylist>{INPUT}<vcount>3</vcount></polylist>");
    let error = read(document("", &geometry(&without)))
        .expect_err("no <p>")
        .to_string();
    assert!(error.contains("<p> is missing"), "{error}");
}

/// Nodes that each show the next one twice.
fn doubling(levels: usize, last: &str) -> String {
    let mut nodes = String::new();
    for i in 0..levels {
        let twice = format!("<instance_node url=\"#n{}\"/>", i + 1).repeat(2);
        nodes += &format!("<node id=\"n{i}\">{twice}</node>");
    }
    nodes += &format!("<node id=\"n{levels}\">{last}</node>");
    let library = format!("<library_nodes>{nodes}</library_nodes>");
    document(
        "",
        &(tetrahedron() + &library + &scene("<instance_node url=\"#n0\"/>")),
    )
}

#[test]
fn instances_of_instances_end() {
    let error = read(doubling(60, "")).expect_err("too many").to_string();
    assert!(
        error.contains("expand to more than 1000000 elements"),
        "{error}"
    );
    // 200,000 triangles, 100 times.
    let fan = format!(
        "{CORNERS}<trifans>{INPUT}<p>0{}</p></trifans>",
        " 1 2".repeat(100_000)
    );
    let nodes = format!("<node>{}</node>", HERE.repeat(100));
    let error = read(document("", &(geometry(&fan) + &scene(&nodes)))).expect_err("too many");
    let error = error.to_string();
    assert!(
        error.contains("expand to more than 10000000 triangles"),
        "{error}"
    );
    let error = read(doubling(200, HERE)).expect_err("too deep").to_string();
    assert!(error.contains("deeper than 128"), "{error}");
}

#[test]
fn deep_nesting_is_refused_not_overflowed() {
    let nested = |depth: usize| {
        let nodes = "<node>".repeat(depth) + HERE + &"</node>".repeat(depth);
        read(document("", &(tetrahedron() + &scene(&nodes))))
    };
    assert!(nested(128).is_ok());
    for (depth, expected) in [
        (129, "nodes nest deeper than 128"),
        (100_000, "nests deeper than 512"),
    ] {
        let error = nested(depth).expect_err(expected).to_string();
        assert!(error.contains(expected), "{error}");
    }
    let error = read("<a>".repeat(500)).expect_err("unclosed").to_string();
    assert!(error.contains("not well-formed"), "{error}");
}
