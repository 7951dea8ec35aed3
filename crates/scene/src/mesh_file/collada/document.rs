//! Access to an XML document as COLLADA: elements by id, numbers, and errors that name the element.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use roxmltree::{Node, NodeId};

use crate::mesh_file::soup::ReadError;
use crate::shown;

/// A COLLADA document.
pub(super) struct Document<'d, 'x> {
    pub(super) root: Node<'d, 'x>,
    /// The elements by tag and id. Some exporters give one id to elements of different kinds.
    by_id: HashMap<(&'d str, &'d str), Node<'d, 'x>>,
    /// The arrays read so far, because several sources may use the same array.
    arrays: RefCell<HashMap<NodeId, Rc<Vec<f64>>>>,
}

impl<'d, 'x> Document<'d, 'x> {
    pub(super) fn new(xml: &'d roxmltree::Document<'x>) -> Result<Self, ReadError> {
        let root = xml.root_element();
        let mut by_id = HashMap::new();
        for node in root.descendants() {
            if let Some(id) = node.attribute("id") {
                by_id.entry((node.tag_name().name(), id)).or_insert(node);
            }
        }
        let document = Document {
            root,
            by_id,
            arrays: RefCell::default(),
        };
        if tag(root) != "COLLADA" {
            let what = "the root element must be <COLLADA>: is it a COLLADA file?";
            return Err(document.error(root, what));
        }
        Ok(document)
    }

    /// An error about an element, named with its id and line.
    pub(super) fn error(&self, node: Node, what: impl std::fmt::Display) -> ReadError {
        // The element itself may have no id; then an ancestor has it.
        let owner = node.ancestors().find(|n| n.has_attribute("id"));
        let name = match owner {
            Some(owner) if owner == node => {
                let (tag, id) = (shown::name(tag(node)), shown::name(id(node)));
                format!("<{tag} id=\"{id}\">")
            }
            Some(owner) => {
                let (outer, id) = (shown::name(tag(owner)), shown::name(id(owner)));
                format!("<{}> in <{outer} id=\"{id}\">", shown::name(tag(node)))
            }
            None => format!("<{}>", shown::name(tag(node))),
        };
        let line = node.document().text_pos_at(node.range().start).row as usize;
        ReadError::at(line, format!("{name}: {what}"))
    }

    /// A required attribute.
    pub(super) fn attribute(&self, node: Node<'d, 'x>, name: &str) -> Result<&'d str, ReadError> {
        node.attribute(name)
            .ok_or_else(|| self.error(node, format!("the attribute `{name}` is missing")))
    }

    /// The element that an attribute refers to by `#id`, which must have one of the tags.
    pub(super) fn target(
        &self,
        node: Node<'d, 'x>,
        attribute: &str,
        tags: &[&'static str],
    ) -> Result<Node<'d, 'x>, ReadError> {
        let reference = self.attribute(node, attribute)?;
        let Some(id) = reference.trim().strip_prefix('#') else {
            let what = format!(
                "{attribute} is `{}`: it must be `#` and an id of this document; references to \
                 other files are not followed",
                shown::name(reference)
            );
            return Err(self.error(node, what));
        };
        // In a URL `%` and two hexadecimal digits stand for any byte; an id may also contain a literal `%`.
        let found = self
            .with_id(tags, id)
            .or_else(|| self.with_id(tags, &percent_decoded(id)?));
        found.ok_or_else(|| {
            let id = shown::name(id);
            let what = format!("there is no <{}> with the id `{id}`", tags.join("> or <"));
            self.error(node, what)
        })
    }

    fn with_id(&self, tags: &[&str], id: &str) -> Option<Node<'d, 'x>> {
        let mut nodes = tags.iter().map(|&tag| self.by_id.get(&(tag, id)));
        nodes.find_map(Option::<&Node>::copied)
    }

    /// The text of an element, including the parts between comments.
    pub(super) fn text(&self, node: Node<'d, 'x>) -> String {
        node.children()
            .filter(|child| child.is_text())
            .filter_map(|child| child.text())
            .collect()
    }

    /// The finite numbers in the text of an element.
    pub(super) fn numbers(&self, node: Node<'d, 'x>) -> Result<Vec<f64>, ReadError> {
        self.words(node, "a finite number", |word| {
            word.parse().ok().filter(|number: &f64| number.is_finite())
        })
    }

    /// The finite numbers of an array, read once.
    pub(super) fn array(&self, node: Node<'d, 'x>) -> Result<Rc<Vec<f64>>, ReadError> {
        if let Some(known) = self.arrays.borrow().get(&node.id()) {
            return Ok(known.clone());
        }
        let numbers = Rc::new(self.numbers(node)?);
        self.arrays.borrow_mut().insert(node.id(), numbers.clone());
        Ok(numbers)
    }

    /// Exactly `N` finite numbers in the text of an element.
    pub(super) fn exactly<const N: usize>(
        &self,
        node: Node<'d, 'x>,
    ) -> Result<[f64; N], ReadError> {
        let numbers = self.numbers(node)?;
        let count = numbers.len();
        numbers.try_into().map_err(|_| {
            let what = format!("it must hold {N} numbers and holds {count}");
            self.error(node, what)
        })
    }

    /// The indices in the text of an element.
    pub(super) fn indices(&self, node: Node<'d, 'x>) -> Result<Vec<u32>, ReadError> {
        self.words(node, "an index (a whole number from 0)", |word| {
            word.parse().ok()
        })
    }

    fn words<T>(
        &self,
        node: Node<'d, 'x>,
        expected: &str,
        parse: impl Fn(&str) -> Option<T>,
    ) -> Result<Vec<T>, ReadError> {
        let text = self.text(node);
        let words = text.split_ascii_whitespace().enumerate();
        words
            .map(|(i, word)| {
                parse(word).ok_or_else(|| {
                    let word = shown::name(word);
                    let what = format!("value {} is `{word}`: it must be {expected}", i + 1);
                    self.error(node, what)
                })
            })
            .collect()
    }

    /// An attribute that is a whole number, or `default` if it is absent.
    pub(super) fn whole(
        &self,
        node: Node<'d, 'x>,
        name: &str,
        default: usize,
    ) -> Result<usize, ReadError> {
        node.attribute(name).map_or(Ok(default), |text| {
            text.trim().parse().map_err(|_| {
                let text = shown::name(text);
                let what = format!("{name} is `{text}`: it must be a whole number from 0");
                self.error(node, what)
            })
        })
    }
}

/// The tag without its namespace. The namespaces of versions 1.4 and 1.5 differ, but nothing that is read here does.
pub(super) fn tag<'x>(node: Node<'_, 'x>) -> &'x str {
    node.tag_name().name()
}

/// The first child element with the tag.
pub(super) fn child<'d, 'x>(node: Node<'d, 'x>, name: &str) -> Option<Node<'d, 'x>> {
    node.children().find(|child| tag(*child) == name)
}

/// Decodes `%` and two hexadecimal digits to a byte. `None` if the result is not text.
fn percent_decoded(text: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let digits = after.first_chunk::<2>().filter(|_| first == b'%');
        let byte = digits.and_then(|digits| {
            let digit = |at: usize| char::from(digits[at]).to_digit(16);
            u8::try_from(16 * digit(0)? + digit(1)?).ok()
        });
        bytes.push(byte.unwrap_or(first));
        rest = if byte.is_some() { &after[2..] } else { after };
    }
    String::from_utf8(bytes).ok()
}

fn id<'d>(node: Node<'d, '_>) -> &'d str {
    node.attribute("id").unwrap_or_default()
}
