//! File formats.

use crate::mesh::CowMesh;
use std::io::{self, Write};

/// Writes `mesh` as Wavefront OBJ. Numbers have the digits that give the same
/// `f32` again.
///
/// # Errors
///
/// Those of `out`.
pub fn obj(mesh: &CowMesh, out: &mut impl Write) -> io::Result<()> {
    let count = mesh.triangles.len();
    writeln!(
        out,
        "# The cow of Cowbell, {count} triangles, made by its crate `cow`."
    )?;
    writeln!(
        out,
        "# Metres, y up, facing -x; closed, counterclockwise from outside."
    )?;
    writeln!(
        out,
        "# CC0 1.0: https://creativecommons.org/publicdomain/zero/1.0/"
    )?;
    writeln!(out, "o cow")?;
    for [x, y, z] in &mesh.vertices {
        writeln!(out, "v {x} {y} {z}")?;
    }
    for [a, b, c] in mesh.triangles.iter().map(|t| t.map(|i| i + 1)) {
        writeln!(out, "f {a} {b} {c}")?;
    }
    Ok(())
}

/// Writes `mesh` as COLLADA 1.4.1: one geometry, at one node of one scene.
///
/// # Errors
///
/// Those of `out`.
pub fn dae(mesh: &CowMesh, out: &mut impl Write) -> io::Result<()> {
    let vertices = mesh.vertices.len();
    let triangles = mesh.triangles.len();
    let positions = spaced(mesh.vertices.as_flattened());
    let indices = spaced(mesh.triangles.as_flattened());
    // The date that the format asks for is the model's, so that the same mesh
    // gives the same file.
    write!(
        out,
        r##"<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset>
    <contributor>
      <authoring_tool>Cowbell, crate cow {version}</authoring_tool>
      <copyright>CC0 1.0: https://creativecommons.org/publicdomain/zero/1.0/</copyright>
    </contributor>
    <created>2026-11-22T00:00:00Z</created>
    <modified>2026-11-22T00:00:00Z</modified>
    <unit name="meter" meter="1"/>
    <up_axis>Y_UP</up_axis>
  </asset>
  <library_geometries>
    <geometry id="cow-mesh" name="cow">
      <mesh>
        <source id="cow-positions">
          <float_array id="cow-positions-array" count="{floats}">{positions}</float_array>
          <technique_common>
            <accessor source="#cow-positions-array" count="{vertices}" stride="3">
              <param name="X" type="float"/>
              <param name="Y" type="float"/>
              <param name="Z" type="float"/>
            </accessor>
          </technique_common>
        </source>
        <vertices id="cow-vertices">
          <input semantic="POSITION" source="#cow-positions"/>
        </vertices>
        <triangles count="{triangles}">
          <input semantic="VERTEX" source="#cow-vertices" offset="0"/>
          <p>{indices}</p>
        </triangles>
      </mesh>
    </geometry>
  </library_geometries>
  <library_visual_scenes>
    <visual_scene id="scene" name="scene">
      <node id="cow" name="cow" type="NODE">
        <instance_geometry url="#cow-mesh"/>
      </node>
    </visual_scene>
  </library_visual_scenes>
  <scene>
    <instance_visual_scene url="#scene"/>
  </scene>
</COLLADA>
"##,
        version = env!("CARGO_PKG_VERSION"),
        floats = 3 * vertices,
    )
}

fn spaced<T: ToString>(numbers: &[T]) -> String {
    let words: Vec<_> = numbers.iter().map(T::to_string).collect();
    words.join(" ")
}
