//! Elements of a file and their numbers.

use roxmltree::Node;

/// The first child of this name.
pub fn child<'a, 'b>(node: Node<'a, 'b>, name: &str) -> Option<Node<'a, 'b>> {
    node.children().find(|child| child.has_tag_name_of(name))
}

/// Names of elements without their space of names.
pub trait Named {
    fn has_tag_name_of(&self, name: &str) -> bool;
}

impl Named for Node<'_, '_> {
    fn has_tag_name_of(&self, name: &str) -> bool {
        self.is_element() && self.tag_name().name() == name
    }
}

/// The numbers of an element.
pub fn numbers<T: std::str::FromStr>(node: Node<'_, '_>) -> Result<Vec<T>, String> {
    let words = node.text().unwrap_or_default().split_ascii_whitespace();
    let found: Result<Vec<T>, _> = words.map(str::parse).collect();
    found.map_err(|_| {
        format!("<{}> has a word that is no such number; write it again", node.tag_name().name())
    })
}
