//! The polygons of one `<geometry>`, in its own frame.

use std::collections::HashMap;

use glam::DVec3;
use roxmltree::{Node, NodeId};

use super::document::{Document, child, tag};
use crate::mesh_file::polygon::{MAX_CONCAVE_CORNERS, pierced, triangulate};
use crate::mesh_file::soup::{MAX_TRIANGLES, MAX_VERTICES, ReadError};

/// Triangles of one geometry.
#[derive(Default)]
pub(super) struct Geometry {
    pub(super) vertices: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Reads a `<geometry>`. A geometry without surface (a spline) gives no triangles.
pub(super) fn read<'d, 'x>(
    document: &Document<'d, 'x>,
    geometry: Node<'d, 'x>,
) -> Result<Geometry, ReadError> {
    let mut reader = Reader {
        document,
        read: Geometry::default(),
        sources: HashMap::new(),
    };
    if let Some(convex) = child(geometry, "convex_mesh") {
        let what = "convex hulls are not supported: export the geometry as a <mesh>";
        return Err(document.error(convex, what));
    }
    if let Some(mesh) = child(geometry, "mesh") {
        for element in mesh.children() {
            reader.primitives(element)?;
        }
    }
    Ok(reader.read)
}

struct Reader<'r, 'd, 'x> {
    document: &'r Document<'d, 'x>,
    read: Geometry,
    /// The vertices made from each source: the first one and their number.
    sources: HashMap<NodeId, (usize, usize)>,
}

/// How an element of primitives stores its positions.
struct Layout {
    /// The number of indices per corner, and which of them is the position.
    stride: usize,
    offset: usize,
    /// The vertex of index 0, and the number of vertices.
    first: usize,
    count: usize,
}

impl<'d, 'x> Reader<'_, 'd, 'x> {
    fn primitives(&mut self, element: Node<'d, 'x>) -> Result<(), ReadError> {
        let kind = tag(element);
        if !matches!(
            kind,
            "triangles" | "polylist" | "polygons" | "trifans" | "tristrips"
        ) {
            return Ok(());
        }
        // An element without primitives needs no inputs.
        if !element
            .children()
            .any(|child| matches!(tag(child), "p" | "ph" | "vcount"))
        {
            return Ok(());
        }
        let layout = self.layout(element)?;
        let mut arities = match child(element, "vcount") {
            Some(vcount) if kind == "polylist" => self.document.indices(vcount)?,
            _ => Vec::new(),
        };
        arities.reverse();
        for p in element.children().filter(|child| tag(*child) == "p") {
            let corners = self.corners(p, &layout)?;
            match kind {
                "triangles" => {
                    if corners.len() % 3 != 0 {
                        let what = format!("{} corners make no whole triangles", corners.len());
                        return Err(self.document.error(p, what));
                    }
                    for triangle in corners.chunks_exact(3) {
                        self.polygon(p, triangle)?;
                    }
                }
                "polylist" => {
                    let mut rest = corners.as_slice();
                    while let Some(arity) = arities.pop() {
                        let Some((face, after)) = rest.split_at_checked(arity as usize) else {
                            let what = "it ends before the last polygon that <vcount> promises";
                            return Err(self.document.error(p, what));
                        };
                        self.polygon(p, face)?;
                        rest = after;
                    }
                    if !rest.is_empty() {
                        let what = format!("{} corners are more than <vcount> says", rest.len());
                        return Err(self.document.error(p, what));
                    }
                }
                "polygons" => self.polygon(p, &corners)?,
                "trifans" => {
                    for pair in corners.get(1..).unwrap_or_default().windows(2) {
                        self.polygon(p, &[corners[0], pair[0], pair[1]])?;
                    }
                }
                _ => {
                    for (i, t) in corners.windows(3).enumerate() {
                        // Every other triangle of a strip has the opposite order of corners.
                        let (a, b) = if i % 2 == 0 { (0, 1) } else { (1, 0) };
                        self.polygon(p, &[t[a], t[b], t[2]])?;
                    }
                }
            }
        }
        for pierced in element.children().filter(|child| tag(*child) == "ph") {
            self.pierced(pierced, &layout)?;
        }
        if !arities.is_empty() {
            return Err(self
                .document
                .error(element, "<vcount> has polygons but <p> is missing"));
        }
        Ok(())
    }

    /// Finds the positions through the inputs, and reads them if that has not been done.
    fn layout(&mut self, element: Node<'d, 'x>) -> Result<Layout, ReadError> {
        let document = self.document;
        let mut stride = 0;
        let mut vertex = None;
        for input in element.children().filter(|child| tag(*child) == "input") {
            let offset = document.whole(input, "offset", 0)?;
            stride = stride.max(offset.saturating_add(1));
            if document.attribute(input, "semantic")? == "VERTEX" {
                vertex = Some((input, offset));
            }
        }
        let Some((input, offset)) = vertex else {
            let what = "there is no <input> with semantic=\"VERTEX\"";
            return Err(document.error(element, what));
        };
        let vertices = document.target(input, "source", &["vertices"])?;
        let positions = vertices
            .children()
            .find(|child| tag(*child) == "input" && child.attribute("semantic") == Some("POSITION"))
            .ok_or_else(|| {
                document.error(vertices, "there is no <input> with semantic=\"POSITION\"")
            })?;
        let source = document.target(positions, "source", &["source"])?;
        let (first, count) = match self.sources.get(&source.id()) {
            Some(&known) => known,
            None => {
                let first = self.read.vertices.len();
                read_positions(document, source, &mut self.read.vertices)?;
                let count = self.read.vertices.len() - first;
                self.sources.insert(source.id(), (first, count));
                (first, count)
            }
        };
        Ok(Layout {
            stride,
            offset,
            first,
            count,
        })
    }

    /// The vertices of the corners in a `<p>`; their indices are checked.
    fn corners(&self, p: Node<'d, 'x>, layout: &Layout) -> Result<Vec<u32>, ReadError> {
        let indices = self.document.indices(p)?;
        if indices.len() % layout.stride != 0 {
            let what = format!(
                "{} indices make no whole corners of {} inputs each",
                indices.len(),
                layout.stride
            );
            return Err(self.document.error(p, what));
        }
        let positions = indices.iter().skip(layout.offset).step_by(layout.stride);
        positions
            .map(|&index| {
                if index as usize >= layout.count {
                    let what = format!(
                        "a corner uses vertex {index}, but there are only {} (from 0)",
                        layout.count
                    );
                    return Err(self.document.error(p, what));
                }
                Ok((layout.first + index as usize) as u32)
            })
            .collect()
    }

    /// A polygon with holes.
    fn pierced(&mut self, ph: Node<'d, 'x>, layout: &Layout) -> Result<(), ReadError> {
        let document = self.document;
        let outline = child(ph, "p").ok_or_else(|| document.error(ph, "<p> is missing"))?;
        let mut face = self.corners(outline, layout)?;
        if face.len() < 3 {
            let what = format!(
                "a polygon has {} corners: it needs at least three",
                face.len()
            );
            return Err(document.error(outline, what));
        }
        let mut rings = vec![face.len()];
        for hole in ph.children().filter(|child| tag(*child) == "h") {
            let corners = self.corners(hole, layout)?;
            if corners.len() < 3 {
                let what = format!(
                    "a hole has {} corners: it needs at least three",
                    corners.len()
                );
                return Err(document.error(hole, what));
            }
            rings.push(corners.len());
            face.extend(corners);
        }
        if let [_] = rings[..] {
            return self.polygon(outline, &face);
        }
        let at = |&i: &u32| self.read.vertices[i as usize];
        let corners: Vec<DVec3> = face.iter().map(at).collect();
        let cut = pierced(&corners, &rings).map_err(|what| document.error(ph, what))?;
        if self.read.triangles.len() + cut.len() > MAX_TRIANGLES {
            let what = format!("there are more than {MAX_TRIANGLES} triangles: simplify the mesh");
            return Err(document.error(ph, what));
        }
        let triangles = cut.iter().map(|t| t.map(|corner| face[corner]));
        self.read.triangles.extend(triangles);
        Ok(())
    }

    fn polygon(&mut self, p: Node<'d, 'x>, face: &[u32]) -> Result<(), ReadError> {
        let n = face.len();
        if n < 3 {
            let what = format!("a polygon has {n} corners: it needs at least three");
            return Err(self.document.error(p, what));
        }
        if self.read.triangles.len() + n - 2 > MAX_TRIANGLES {
            let what = format!("there are more than {MAX_TRIANGLES} triangles: simplify the mesh");
            return Err(self.document.error(p, what));
        }
        if let &[a, b, c] = face {
            self.read.triangles.push([a, b, c]);
            return Ok(());
        }
        let at = |&i: &u32| self.read.vertices[i as usize];
        let corners: Vec<DVec3> = face.iter().map(at).collect();
        let mut cut = Vec::new();
        if !triangulate(&corners, &mut cut) {
            let what = format!(
                "a polygon with {n} corners is not convex: cut those of more than \
                 {MAX_CONCAVE_CORNERS} corners before export"
            );
            return Err(self.document.error(p, what));
        }
        let triangles = cut.iter().map(|t| t.map(|corner| face[corner]));
        self.read.triangles.extend(triangles);
        Ok(())
    }
}

/// Appends the positions of a `<source>`, selected from the array by its accessor.
fn read_positions<'d, 'x>(
    document: &Document<'d, 'x>,
    source: Node<'d, 'x>,
    out: &mut Vec<DVec3>,
) -> Result<(), ReadError> {
    let accessor = child(source, "technique_common")
        .and_then(|technique| child(technique, "accessor"))
        .ok_or_else(|| document.error(source, "there is no <accessor> in <technique_common>"))?;
    let array = document.target(accessor, "source", &["float_array", "int_array"])?;
    let values = document.array(array)?;
    let stride = document.whole(accessor, "stride", 1)?;
    let offset = document.whole(accessor, "offset", 0)?;
    let axes = axes(accessor);
    let last_axis = axes.iter().max().map_or(0, |&last| last);
    if stride <= last_axis {
        let what = format!(
            "stride is {stride}: it must be at least {}, the place of X, Y and Z",
            last_axis + 1
        );
        return Err(document.error(accessor, what));
    }
    let held = values.len().saturating_sub(offset);
    // The last position may be followed by less than its full stride.
    let held = held / stride + usize::from(held % stride > last_axis);
    let count = document.whole(accessor, "count", held)?;
    if count > held {
        let what = format!("count is {count}, but the array holds only {held} positions");
        return Err(document.error(accessor, what));
    }
    if out.len() + count > MAX_VERTICES {
        let what = format!("there are more than {MAX_VERTICES} vertices: simplify the mesh");
        return Err(document.error(accessor, what));
    }
    out.extend((0..count).map(|i| {
        let at = offset + i * stride;
        DVec3::from(axes.map(|axis| values[at + axis]))
    }));
    Ok(())
}

/// The indices of X, Y and Z among the parameters; 0, 1 and 2 if the parameters have no such names.
fn axes(accessor: Node) -> [usize; 3] {
    let parameters: Vec<Option<&str>> = accessor
        .children()
        .filter(|child| tag(*child) == "param")
        .map(|parameter| parameter.attribute("name"))
        .collect();
    let place = |name| parameters.iter().position(|known| *known == Some(name));
    match (place("X"), place("Y"), place("Z")) {
        (Some(x), Some(y), Some(z)) => [x, y, z],
        _ => [0, 1, 2],
    }
}
