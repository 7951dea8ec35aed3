//! Traverses the node tree of a scene and collects the instances of geometries in one soup.

use std::collections::HashMap;
use std::rc::Rc;

use glam::DMat4;
use roxmltree::{Node, NodeId};

use super::document::{Document, child, tag};
use super::geometry::{self, Geometry};
use super::transform;
use crate::mesh_file::soup::{MAX_TRIANGLES, MAX_VERTICES, ReadError, Soup};

/// The largest depth of nested nodes and instances of nodes.
const MAX_DEPTH: usize = 128;

/// The most parts (elements and the text between them) to which the nodes may expand. This limits instances of
/// instances even if they contain no geometry.
const MAX_PARTS: usize = 1_000_000;

/// The data collected so far from one document.
pub(super) struct Assembly<'r, 'd, 'x> {
    pub(super) soup: Soup,
    document: &'r Document<'d, 'x>,
    geometries: HashMap<NodeId, Rc<Geometry>>,
    /// The nodes from the scene to the current one, each the child of the previous.
    path: Vec<NodeId>,
    parts: usize,
}

impl<'r, 'd, 'x> Assembly<'r, 'd, 'x> {
    pub(super) fn new(document: &'r Document<'d, 'x>) -> Self {
        Assembly {
            soup: Soup::default(),
            document,
            geometries: HashMap::new(),
            path: Vec::new(),
            parts: 0,
        }
    }

    /// Adds every geometry of the libraries once.
    pub(super) fn add_all_geometries(&mut self, placement: DMat4) -> Result<(), ReadError> {
        let libraries = self.document.root.children();
        for library in libraries.filter(|child| tag(*child) == "library_geometries") {
            for geometry in library.children().filter(|n| tag(*n) == "geometry") {
                self.add_geometry(geometry, geometry, placement)?;
            }
        }
        Ok(())
    }

    /// Adds the geometries of the nodes in `parent`; `placement` maps its frame to the soup's.
    pub(super) fn add_nodes(
        &mut self,
        parent: Node<'d, 'x>,
        placement: DMat4,
    ) -> Result<(), ReadError> {
        for element in parent.children() {
            self.parts += 1;
            if self.parts > MAX_PARTS {
                let what = format!("the instances expand to more than {MAX_PARTS} elements");
                return Err(self.document.error(element, what));
            }
            match tag(element) {
                "node" => self.add_node(element, element, placement)?,
                "instance_node" => {
                    let node = self.document.target(element, "url", &["node"])?;
                    self.add_node(element, node, placement)?;
                }
                "instance_geometry" => {
                    let geometry = self.document.target(element, "url", &["geometry"])?;
                    self.add_geometry(element, geometry, placement)?;
                }
                "instance_controller" => self.add_controller(element, placement)?,
                _ => {}
            }
        }
        Ok(())
    }

    /// Adds a node. Errors name `at`, the node itself or the instance of it.
    fn add_node(
        &mut self,
        at: Node<'d, 'x>,
        node: Node<'d, 'x>,
        placement: DMat4,
    ) -> Result<(), ReadError> {
        if self.path.contains(&node.id()) {
            return Err(self.document.error(at, "the node instances itself"));
        }
        if self.path.len() == MAX_DEPTH {
            let what = format!("nodes nest deeper than {MAX_DEPTH}");
            return Err(self.document.error(at, what));
        }
        self.path.push(node.id());
        let placement = placement * transform::of_node(self.document, node)?;
        self.add_nodes(node, placement)?;
        self.path.pop();
        Ok(())
    }

    /// Adds the source geometry of a skin or morph, in the bind shape.
    fn add_controller(
        &mut self,
        instance: Node<'d, 'x>,
        mut placement: DMat4,
    ) -> Result<(), ReadError> {
        const SOURCES: &[&str] = &["geometry", "controller"];
        let mut target = self.document.target(instance, "url", &["controller"])?;
        // A skin may refer to a morph; longer chains are not in use.
        for _ in 0..3 {
            if tag(target) == "geometry" {
                return self.add_geometry(instance, target, placement);
            }
            let source = child(target, "skin").or_else(|| child(target, "morph"));
            let source = source.ok_or_else(|| {
                let what = "there is neither a <skin> nor a <morph>";
                self.document.error(target, what)
            })?;
            if let Some(bind) = child(source, "bind_shape_matrix") {
                placement *= transform::matrix(self.document, bind)?;
            }
            target = self.document.target(source, "source", SOURCES)?;
        }
        let what = "its controllers lead to no geometry";
        Err(self.document.error(instance, what))
    }

    fn add_geometry(
        &mut self,
        instance: Node<'d, 'x>,
        geometry: Node<'d, 'x>,
        placement: DMat4,
    ) -> Result<(), ReadError> {
        let geometry = match self.geometries.get(&geometry.id()) {
            Some(known) => known.clone(),
            None => {
                let read = Rc::new(geometry::read(self.document, geometry)?);
                self.geometries.insert(geometry.id(), read.clone());
                read
            }
        };
        let determinant = placement.determinant();
        if !determinant.is_finite() {
            let what = "the transforms blow the geometry up beyond all numbers";
            return Err(self.document.error(instance, what));
        }
        // Exporters scale helper objects to zero, and so do animations that hide something.
        if determinant == 0.0 {
            self.soup.flat_instances += 1;
            return Ok(());
        }
        let soup = &mut self.soup;
        if soup.triangles.len() + geometry.triangles.len() > MAX_TRIANGLES
            || soup.vertices.len() + geometry.vertices.len() > MAX_VERTICES
        {
            let what = format!(
                "the instances expand to more than {MAX_TRIANGLES} triangles or {MAX_VERTICES} \
                 vertices"
            );
            return Err(self.document.error(instance, what));
        }
        let first = soup.vertices.len() as u32;
        for vertex in &geometry.vertices {
            let placed = placement.transform_point3(*vertex).as_vec3();
            if !placed.is_finite() {
                let what = format!("a vertex ends up at {placed}, beyond 3.4e38 m");
                return Err(self.document.error(instance, what));
            }
            soup.vertices.push(placed);
        }
        for &[a, b, c] in &geometry.triangles {
            // A reflection reverses the orientation of the triangles.
            let corners = if determinant > 0.0 {
                [a, b, c]
            } else {
                [a, c, b]
            };
            soup.triangles.push(corners.map(|corner| first + corner));
        }
        Ok(())
    }
}
