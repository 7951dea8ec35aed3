//! STL and PLY, what COLLADA and OBJ writers do besides, and the figures of a loaded mesh.

use std::path::Path;

use scene::{LoadedMesh, MeshFileError, mesh_file};

fn read(name: &str, bytes: &[u8]) -> Result<LoadedMesh, MeshFileError> {
    let path = Path::new(name);
    mesh_file::read(mesh_file::Format::of(path)?, path, bytes)
}

fn refusal(name: &str, bytes: &[u8]) -> String {
    read(name, bytes).expect_err("it is refused").to_string()
}

/// Corners of a tetrahedron of 4/3 m³, and its faces seen from outside.
const CORNERS: [[f32; 3]; 4] = [[0., 0., 0.], [2., 0., 0.], [0., 2., 0.], [0., 0., 2.]];
const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

fn is_the_tetrahedron(loaded: &LoadedMesh) {
    let report = loaded.report();
    assert_eq!((report.vertices, report.triangles), (4, 4));
    assert!(report.closed && report.oriented);
    let volume = report.volume.expect("a volume");
    assert!((volume - 4.0 / 3.0).abs() < 1e-12, "{volume}");
    assert_eq!((report.components, report.boundary_edges), (1, 0));
    assert_eq!(report.extent, [2.0; 3]);
}

fn text_stl() -> String {
    let facets = FACES.map(|face| {
        let corners = face.map(|i| CORNERS[i]);
        let vertices = corners.map(|[x, y, z]| format!("  vertex {x} {y} {z:e}\r\n"));
        let vertices = vertices.concat();
        format!("facet normal 0 0 0\n outer loop\n{vertices} endloop\nendfacet\n")
    });
    format!("solid a name with words\n{}endsolid\n", facets.concat())
}

fn binary_stl(header: &[u8]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, b' ');
    bytes.extend(4_u32.to_le_bytes());
    for face in FACES {
        bytes.extend([0; 12]);
        bytes.extend(
            face.iter()
                .flat_map(|&i| CORNERS[i])
                .flat_map(f32::to_le_bytes),
        );
        bytes.extend([0xff; 2]);
    }
    bytes
}

#[test]
fn stl_is_read_as_text_and_binary() {
    is_the_tetrahedron(&read("a.stl", text_stl().as_bytes()).expect("text"));
    is_the_tetrahedron(&read("a.STL", text_stl().to_uppercase().as_bytes()).expect("text"));
    for header in [&b"made by a test"[..], b"solid all the same", b""] {
        is_the_tetrahedron(&read("a.stl", &binary_stl(header)).expect("binary"));
    }
    let loaded = read("a.stl", &binary_stl(b"")).expect("binary");
    assert_eq!(loaded.report().welded_vertices, 8);
    // What some exporters add at the end.
    let longer = [binary_stl(b""), b"more".to_vec()].concat();
    is_the_tetrahedron(&read("a.stl", &longer).expect("binary"));
}

/// Blanks of any kind stand between the words of a text, so a facet may take one line, or all of them.
#[test]
fn stl_text_has_no_lines_but_for_names() {
    let text = text_stl();
    let facets = text.replace("\r\n", " ").replace("\n outer", " outer");
    let facets = facets.replace("endloop\n", "endloop ");
    let one_line = text.replace("\r\n", " ").replace('\n', "\t");
    let two_solids = text.replacen("endfacet\n", "endfacet\nendsolid a\nsolid b\n", 1);
    for (what, text) in [
        ("a facet a line", facets),
        ("all in one line", one_line),
        (
            "ends of lines of old systems",
            text.replace("\r\n", "\n").replace('\n', "\r"),
        ),
        ("two solids", two_solids),
        (
            "a name like a word of the format",
            text.replace("a name with words", "facet solid"),
        ),
        (
            "no numbers for a normal",
            text.replace("normal 0 0 0", "normal nan -nan(ind) 0"),
        ),
        ("no normals", text.replace("normal 0 0 0", "")),
    ] {
        let loaded = read("a.stl", text.as_bytes());
        is_the_tetrahedron(&loaded.unwrap_or_else(|error| panic!("{what}: {error}")));
    }
}

#[test]
fn bad_stl_is_refused_with_a_reason() {
    let whole = binary_stl(b"");
    for length in [0, 5, 79, 83, 84, 100, whole.len() - 1] {
        assert!(read("a.stl", &whole[..length]).is_err(), "{length}");
    }
    let mut counts = whole.clone();
    counts[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(refusal("a.stl", &counts).contains("10000000 triangles"));
    let mut nan = whole;
    nan[96..100].copy_from_slice(&f32::NAN.to_le_bytes());
    assert!(refusal("a.stl", &nan).contains("triangle 1 has a corner that is not finite"));
    for (text, reason) in [
        (
            "solid\nfacet\nouter loop\nvertex 0 0\n",
            "a.stl:4: the vertex has no z",
        ),
        (
            "solid\nfacet\nouter loop\nvertex 0 0 inf\n",
            "a.stl:4: z is `inf`",
        ),
        (
            "solid\nouter loop\nvertex 0 0 0\nendloop\n",
            "a.stl:4: the facet has 1 corners",
        ),
        (
            "solid\nvertex 0 0 0\n",
            "a.stl:2: `vertex` stands where `facet`",
        ),
        (
            "solid\rfacet normal 0 0 1\router\rvertex 0 0 0\r",
            "a.stl:4: `vertex` stands where `loop`",
        ),
        (
            "solid\r\nfacet\r\nouter loop\r\nvertex 0 0\r\nvertex 0 0 0\r\n",
            "a.stl:4: the vertex has no z",
        ),
        (
            "solid\nouter loop vertex 0 0 0\n vertex 1 1 1 1\n",
            "a.stl:3: `1` stands where `vertex` or `endloop`",
        ),
        ("solid\nouter loop\nvertex 0 0 0\n", "cut off"),
        (
            "solid\nfacet colour 0 0 1\nouter loop\n",
            "a.stl:2: `colour` stands where `normal` or `outer loop`",
        ),
        ("solid\nendsolid\n", "no facets"),
    ] {
        let message = refusal("a.stl", text.as_bytes());
        assert!(message.contains(reason), "{message}");
    }
    let all = text_stl();
    for length in 0..all.len() - "\n".len() {
        let cut = read("a.stl", &all.as_bytes()[..length]);
        assert!(cut.is_err(), "{length}");
    }
}

fn ply_header(format: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment of a test\nelement vertex 4\nproperty double x\n\
         property float y\nproperty uchar red\nproperty float z\nelement edge 1\n\
         property int vertex1\nelement face 4\nproperty uchar flags\n\
         property list uchar int vertex_indices\nend_header\n"
    )
}

fn text_ply() -> String {
    let vertices = CORNERS.map(|[x, y, z]| format!("{x} {y} 255 {z}\n"));
    let faces = FACES.map(|[a, b, c]| format!("0 3 {a} {b} {c}\n"));
    ply_header("ascii") + &vertices.concat() + "7\n" + &faces.concat()
}

fn binary_ply(big: bool) -> Vec<u8> {
    fn put<const N: usize>(out: &mut Vec<u8>, big: bool, mut little: [u8; N]) {
        if big {
            little.reverse();
        }
        out.extend(little);
    }
    let format = if big {
        "binary_big_endian"
    } else {
        "binary_little_endian"
    };
    let mut out = ply_header(format).into_bytes();
    for [x, y, z] in CORNERS {
        put(&mut out, big, f64::from(x).to_le_bytes());
        put(&mut out, big, y.to_le_bytes());
        out.push(255);
        put(&mut out, big, z.to_le_bytes());
    }
    put(&mut out, big, 7_i32.to_le_bytes());
    for face in FACES {
        out.extend([0, 3]);
        for index in face {
            put(&mut out, big, (index as i32).to_le_bytes());
        }
    }
    out
}

#[test]
fn ply_is_read_as_text_and_in_both_byte_orders() {
    is_the_tetrahedron(&read("a.ply", text_ply().as_bytes()).expect("text"));
    let crlf = text_ply().replace('\n', "\r\n");
    is_the_tetrahedron(&read("a.ply", crlf.as_bytes()).expect("text"));
    is_the_tetrahedron(&read("a.ply", &binary_ply(false)).expect("little"));
    is_the_tetrahedron(&read("a.ply", &binary_ply(true)).expect("big"));
    let old = text_ply().replace('\n', "\r");
    is_the_tetrahedron(&read("a.ply", old.as_bytes()).expect("ends of lines of old systems"));
    let message = refusal(
        "a.ply",
        old.replacen("2 0 255 0", "2 nan 255 0", 1).as_bytes(),
    );
    assert!(message.contains("a.ply:16: vertex 1"), "{message}");
    let box_text = "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar uint vertex_index\n\
                    element vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                    end_header\n4 0 1 2 3\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    let loaded = read("a.ply", box_text.as_bytes()).expect("faces before vertices");
    assert_eq!(loaded.mesh.triangles().len(), 2);
}

#[test]
fn bad_ply_is_refused_with_a_reason() {
    let good = text_ply();
    for (from, to, reason) in [
        ("ply\n", "plx\n", "a.ply:1: does not start with `ply`"),
        ("ascii", "morse", "a.ply:2: `format morse 1.0` is no line"),
        ("double x", "float128 x", "a.ply:5: "),
        ("property float z\n", "", "no property `z`"),
        ("vertex_indices", "corners", "no list `vertex_indices`"),
        ("end_header", "end", "a.ply:14: "),
        (
            "2 0 255 0\n",
            "2 nan 255 0\n",
            "a.ply:16: vertex 1 is not finite",
        ),
        (
            "0 3 0 1 3",
            "0 3 0 1 4",
            "a.ply:21: a face uses vertex 4, but there are 4",
        ),
        ("0 3 0 1 3", "0 3 0 1 -1", "a face uses vertex -1"),
        ("0 3 0 1 3", "0 2 0 1", "a face has 2 corners"),
        ("0 3 0 1 3", "0 1e30 0 1", "the length 1e30"),
        ("0 3 0 1 3", "0 three 0 1", "`three` is not a number"),
        ("face 4", "face 4000000000", "cut off"),
        ("vertex 4", "vertex 18446744073709551615", "a.ply"),
        ("vertex 4", "vertex 18446744073709551616", "a.ply:4: "),
        ("element face 4", "element strip 4", "no faces"),
    ] {
        assert!(good.contains(from), "{from}");
        let message = refusal("a.ply", good.replacen(from, to, 1).as_bytes());
        assert!(message.contains(reason), "{message}, not {reason}");
    }
    for whole in [good.into_bytes(), binary_ply(false), binary_ply(true)] {
        let least = whole.len() - 2;
        for length in 0..least {
            assert!(read("a.ply", &whole[..length]).is_err(), "{length}");
        }
    }
    let nothing = "ply\nformat ascii 1.0\nelement nothing 18446744073709551615\nend_header\n";
    assert!(refusal("a.ply", nothing.as_bytes()).contains("no faces"));
}

/// What a header says must be known: it may mean that all else is to be read in another way.
#[test]
fn ply_of_another_version_or_that_says_a_thing_twice_is_refused() {
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for version in ["2.0", "0.9", "1", "1.0.1"] {
            let header = ply_header(format).replace(" 1.0\n", &format!(" {version}\n"));
            let message = refusal("a.ply", header.as_bytes());
            let expected = format!("a.ply:2: the version is `{version}`: only 1.0 is known");
            assert!(message.contains(&expected), "{message}");
        }
    }
    let good = text_ply();
    let corners = "property list uchar int vertex_indices\n";
    for (from, to, reason) in [
        (
            "comment of a test\n",
            "format binary_little_endian 1.0\n",
            "a.ply:3: the header has a second line `format`",
        ),
        (
            "property uchar red",
            "property uchar x",
            "its vertices have more than one property `x`",
        ),
        (
            "element edge 1",
            "element vertex 1",
            "a.ply:9: the header has a second element `vertex`",
        ),
        (
            "element edge 1",
            "element face 1",
            "a.ply:11: the header has a second element `face`",
        ),
        (
            corners,
            &format!("{corners}property list uchar int vertex_index\n"),
            "its faces have more than one list of corners",
        ),
    ] {
        assert!(good.contains(from), "{from}");
        let message = refusal("a.ply", good.replacen(from, to, 1).as_bytes());
        assert!(message.contains(reason), "{message}, not {reason}");
    }
}

#[test]
fn collada_of_another_version_is_refused() {
    let text = dae("", "g", BOX, ONCE);
    let of = |version: &str| text.replace("<COLLADA>", &format!("<COLLADA version='{version}'>"));
    for version in ["1.4", "1.4.0", "1.4.1", "1.5.0"] {
        is_the_box(&read("a.dae", of(version).as_bytes()).expect(version));
    }
    for version in ["1.3.1", "2.0", "14", "", "1.4.1 beta"] {
        let message = refusal("a.dae", of(version).as_bytes());
        let expected = format!("a.dae:1: <COLLADA>: the version is `{version}`");
        assert!(message.contains(&expected), "{message}");
    }
}

/// A part of a document may have a unit and an up axis of its own.
#[test]
fn collada_parts_in_another_unit_than_the_document_are_refused() {
    let asset = "<unit meter='0.5'/><up_axis>Z_UP</up_axis>";
    let with = |part: &str, own: &str| {
        let text = dae(asset, "g", BOX, ONCE);
        text.replacen(part, &format!("{part}<asset>{own}</asset>"), 1)
    };
    for part in [
        "<geometry id='g'>",
        "<library_geometries>",
        "<visual_scene id='s'>",
        "<node>",
    ] {
        for own in [
            "",
            "<unit meter='0.50'/>",
            asset,
            "<unit/><up_axis> Z_UP </up_axis>",
        ] {
            let loaded = read("a.dae", with(part, own).as_bytes());
            assert_eq!(loaded.expect(own).report().volume, Some(3.0));
        }
        for own in ["<unit meter='0.01'/>", "<up_axis>Y_UP</up_axis>"] {
            let message = refusal("a.dae", with(part, own).as_bytes());
            assert!(
                message.contains("another one than the document's"),
                "{message}"
            );
        }
    }
}

#[test]
fn gltf_is_refused_by_name() {
    for name in ["a.gltf", "a.GLB"] {
        let message = refusal(name, b"");
        assert!(
            message.contains("glTF") && message.contains(".stl"),
            "{message}"
        );
    }
}

/// A COLLADA document of a box of 24 m³; the arguments are what differs.
fn dae(asset: &str, id: &str, faces: &str, nodes: &str) -> String {
    format!(
        "<COLLADA><asset>{asset}</asset><library_geometries><geometry id='{id}'><mesh>\
         <source id='p'><float_array id='n'>0 0 0 2 0 0 2 3 0 0 3 0 0 0 4 2 0 4 2 3 4 0 3 4 \
         0.5 0.5 0 1.5 0.5 0 0.5 2.5 0 1.5 2.5 0</float_array><technique_common>\
         <accessor source='#n' count='12' stride='3'/></technique_common></source>\
         <vertices id='v'><input semantic='POSITION' source='#p'/></vertices>{faces}</mesh>\
         </geometry></library_geometries><library_visual_scenes><visual_scene id='s'>{nodes}\
         </visual_scene></library_visual_scenes>\
         <scene><instance_visual_scene url='#s'/></scene></COLLADA>"
    )
}

const BOX: &str = "<polylist count='6'><input semantic='VERTEX' source='#v' offset='0'/>\
                   <vcount>4 4 4 4 4 4</vcount><p>0 3 2 1 4 5 6 7 0 1 5 4 1 2 6 5 2 3 7 6 3 0 4 7</p>\
                   </polylist>";
const ONCE: &str = "<node><instance_geometry url='#g'/></node>";

fn is_the_box(loaded: &LoadedMesh) {
    let report = loaded.report();
    assert_eq!((report.triangles, report.volume), (12, Some(24.0)));
    assert!(report.closed && report.boundary_edges == 0);
}

#[test]
fn collada_comes_in_any_declared_encoding() {
    let body = dae(
        "",
        "Käfig",
        BOX,
        "<node><instance_geometry url='#Käfig'/></node>",
    );
    let utf16 = |text: &str, big: bool| -> Vec<u8> {
        let order = if big {
            u16::to_be_bytes
        } else {
            u16::to_le_bytes
        };
        text.encode_utf16().flat_map(order).collect()
    };
    let declared = format!("<?xml version='1.0' encoding='utf-16'?>\n{body}");
    for big in [false, true] {
        let marked = utf16(&format!("\u{feff}{declared}"), big);
        is_the_box(&read("a.dae", &marked).expect("with a mark"));
        is_the_box(&read("a.dae", &utf16(&declared, big)).expect("without a mark"));
    }
    for name in ["iso-8859-1", "Windows-1252", "ISO-8859-15"] {
        let text = format!("<?xml version=\"1.0\" encoding = \"{name}\"?>\n{body}");
        let latin1: Vec<u8> = text
            .chars()
            .map(|c| u8::try_from(c).expect("a byte"))
            .collect();
        is_the_box(&read("a.dae", &latin1).expect(name));
    }
    is_the_box(&read("a.dae", format!("\u{feff}{body}").as_bytes()).expect("UTF-8 with a mark"));
    let unknown = format!("<?xml version='1.0' encoding='rot13'?>{body}");
    assert!(refusal("a.dae", unknown.as_bytes()).contains("`rot13` is not known"));
    assert!(refusal("a.dae", b"<a>\n\xe4</a>").contains("a.dae:2: is not UTF-8"));
}

#[test]
fn collada_urls_may_write_bytes_as_percent() {
    for (id, url) in [
        ("Käfig", "K%C3%A4fig"),
        ("a b", "a%20b"),
        ("100%", "100%"),
        ("%41", "%41"),
    ] {
        let nodes = format!("<node><instance_geometry url='#{url}'/></node>");
        is_the_box(&read("a.dae", dae("", id, BOX, &nodes).as_bytes()).expect(url));
    }
    for url in ["%", "%4", "%zz", "%ff", "%e4"] {
        let nodes = format!("<node><instance_geometry url='#{url}'/></node>");
        assert!(refusal("a.dae", dae("", "g", BOX, &nodes).as_bytes()).contains("no <geometry>"));
    }
}

#[test]
fn collada_polygons_may_have_holes() {
    let area = |holes: &str| {
        let faces = format!(
            "<polygons><input semantic='VERTEX' source='#v' offset='0'/>\
             <ph><p>0 1 2 3</p>{holes}</ph></polygons>"
        );
        read("a.dae", dae("", "g", &faces, ONCE).as_bytes()).map(|loaded| {
            let corners = (0..loaded.mesh.triangles().len()).map(|i| loaded.mesh.corners(i));
            let areas = corners.map(|[a, b, c]| (b - a).cross(c - a).z / 2.0);
            let areas: Vec<f32> = areas.collect();
            assert!(areas.iter().all(|&area| area > 0.0), "{areas:?}");
            (areas.len(), areas.iter().sum::<f32>())
        })
    };
    // Of both windings; two holes; none.
    for (holes, expected) in [
        ("<h>8 10 9</h>", (7, 5.0)),
        ("<h>8 9 10</h>", (7, 5.0)),
        ("<h>8 9 11 10</h>", (8, 4.0)),
        ("", (2, 6.0)),
    ] {
        assert_eq!(area(holes).expect(holes), expected, "{holes}");
    }
    for (holes, reason) in [
        ("<h>8 9</h>", "a hole has 2 corners"),
        ("<h>8 9 99</h>", "uses vertex 99"),
    ] {
        let message = area(holes).expect_err(reason).to_string();
        assert!(message.contains(reason), "{message}");
    }
}

#[test]
fn collada_instances_without_extent_are_left_out_and_counted() {
    let flat = "<node><scale>1 1 0</scale><instance_geometry url='#g'/></node>";
    let loaded = read(
        "a.dae",
        dae("", "g", BOX, &(ONCE.to_owned() + flat)).as_bytes(),
    );
    let loaded = loaded.expect("a box");
    is_the_box(&loaded);
    assert_eq!(loaded.report().flat_instances, 1);
    assert!(refusal("a.dae", dae("", "g", BOX, flat).as_bytes()).contains("flatten all 1"));
}

#[test]
fn collada_forgives_rounding_and_empty_elements() {
    let moved = |row: &str| {
        let matrix = format!("<matrix>1 0 0 2 0 1 0 0 0 0 1 0 {row}</matrix>");
        let nodes = format!("<node>{matrix}<instance_geometry url='#g'/></node>");
        read(
            "a.dae",
            dae("<unit meter=''/><up_axis/>", "g", BOX, &nodes).as_bytes(),
        )
    };
    for row in ["0 0 0 1", "0 -2.2e-17 0 1", "1e-8 0 0 0.9999999"] {
        let loaded = moved(row).expect(row);
        is_the_box(&loaded);
        assert_eq!(loaded.mesh.bounds().min.x, 2.0);
        assert_eq!((loaded.unit, loaded.up_axis), (None, None));
    }
    for row in ["0 0.1 0 1", "0 0 0 2", "0 0 0 0"] {
        assert!(moved(row).is_err(), "{row}");
    }
    // Elements of faces that list none, as some exporters write them for unused materials.
    for kind in ["triangles", "polylist", "polygons"] {
        let faces = format!("<{kind} count='0' material='unused'/>{BOX}");
        is_the_box(&read("a.dae", dae("", "g", &faces, ONCE).as_bytes()).expect(kind));
    }
    let asset = "<unit meter='0.5'/><up_axis>Z_UP</up_axis>";
    let report = read("a.dae", dae(asset, "g", BOX, ONCE).as_bytes())
        .expect("a box")
        .report();
    assert_eq!((report.unit, report.up_axis), (Some(0.5), Some('z')));
    assert_eq!((report.extent, report.volume), ([1.0, 2.0, 1.5], Some(3.0)));
}

#[test]
fn obj_continues_over_blanks_and_names_what_is_no_number() {
    let vertices = "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\n";
    let faces = "f 1 2 4\nf 2 3 4\nf 3 1 4\n";
    for end in ["\\\n", "\\ \n", "\\\t \r\n", " \\  \n \\ \n"] {
        let text = format!("{vertices}f 1 3 {end} 2\ng a {end} f\n{faces}");
        is_the_tetrahedron(&read("a.obj", text.as_bytes()).expect(end));
    }
    let message = refusal("a.obj", b"v 0 0 0\nv 1\xc2\xa00 0 x\n");
    assert!(
        message.contains("a.obj:2: x of the vertex is `1"),
        "{message}"
    );
    let message = refusal("a.obj", b"v 0 0 \xff\n");
    assert!(
        message.contains("z of the vertex is `\u{fffd}`"),
        "{message}"
    );
}

#[test]
fn text_comes_in_utf16_with_a_mark_or_without() {
    let obj = "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    for (name, text) in [
        ("a.obj", obj.to_owned()),
        ("a.stl", text_stl()),
        ("a.ply", text_ply()),
    ] {
        for mark in ["\u{feff}", ""] {
            let units = || mark.encode_utf16().chain(text.encode_utf16());
            let little: Vec<u8> = units().flat_map(u16::to_le_bytes).collect();
            let big: Vec<u8> = units().flat_map(u16::to_be_bytes).collect();
            let marked = format!("{mark}{text}").into_bytes();
            for bytes in [little, big, marked] {
                let loaded = read(name, &bytes);
                is_the_tetrahedron(&loaded.unwrap_or_else(|error| panic!("{error}")));
            }
        }
    }
}

#[test]
fn triangles_without_area_are_no_mesh() {
    let text = "v 0 0 0\nv 1 1 1\nv 3 3 3\nf 1 2 3\n";
    let message = refusal("a.obj", text.as_bytes());
    assert!(message.contains("no triangle with an area"), "{message}");
}

#[test]
fn the_report_counts_what_a_mesh_is_made_of() {
    // A tetrahedron, inside out, and a fan of three triangles about one edge, apart from it.
    let text = "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n";
    let report = read("a.obj", text.as_bytes()).expect("a mesh").report();
    assert_eq!((report.flipped_triangles, report.components), (4, 1));
    let fan = "v 5 0 0\nv 5 1 0\nv 6 0 0\nv 5 0 1\nv 5 0 -1\nf 5 6 7\nf 5 6 8\nf 5 6 9\n\
               f 5 6 9\nf 5 5 6\n";
    let report = read("a.obj", format!("{text}{fan}").as_bytes())
        .expect("a mesh")
        .report();
    assert_eq!((report.components, report.non_manifold_edges), (2, 1));
    assert_eq!(report.boundary_edges, 6);
    assert_eq!(
        (report.duplicate_triangles, report.degenerate_triangles),
        (1, 1)
    );
    assert!(!report.closed && report.volume.is_none());
    assert_eq!(report.extent, [6.0, 2.0, 3.0]);
}
