//! The structure of a staged program: its unknowns, its rows, and which rows depend on which unknowns.

use std::ops::Range;

/// A part of the program whose functions depend on few unknowns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Element {
    /// Node k: its functions depend on (x_k, p).
    Node(usize),
    /// Interval k, between nodes k and k + 1: its functions depend on (x_k, w_k, x_k+1, p).
    Interval(usize),
    /// Both ends: (x_0, x_N, p); of a single node (x_0, p).
    Ends,
}

/// Numbers of rows of one element.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rows {
    /// Equations c = 0.
    pub equalities: usize,
    /// Functions g with `lower <= g <= upper`.
    pub ranges: usize,
}

impl Rows {
    /// So many equations, and so many functions with ranges.
    pub fn new(equalities: usize, ranges: usize) -> Self {
        Self { equalities, ranges }
    }
}

/// Numbers of unknowns and rows of a program with nodes 0, 1, .. N and the intervals between them.
///
/// The unknowns are x_k of each node, w_k of each interval, which no other interval shares, and p, shared by
/// all. A step has their displacements in the order x_0, w_0, x_1, w_1, .. x_N, p. Rows are in the order of
/// the elements: node 0, interval 0, node 1, .. node N, both ends.
///
/// ```
/// use costate_nlp::{Element, Layout, Rows};
///
/// // Twenty intervals with two states and one control; dynamics on the intervals, a bound of the control.
/// let mut layout = Layout::uniform(20, 2, 1, 0);
/// for k in 0..20 {
///     layout = layout.with_rows(Element::Interval(k), Rows::new(2, 1));
/// }
/// let layout = layout.with_rows(Element::Node(0), Rows::new(2, 0));
/// assert_eq!((layout.steps(), layout.equalities(), layout.ranges()), (62, 42, 20));
/// assert_eq!(layout.unknowns(Element::Interval(1)), [3..5, 5..6, 6..8, 62..62]);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    nodes: Vec<usize>,
    private: Vec<usize>,
    shared: usize,
    rows: Vec<Rows>,
    couples_ends: bool,
    /// Where the displacement of each node begins, and the end of the last one: that of the shared unknowns.
    starts: Vec<usize>,
    /// Where the rows of each element begin, and their numbers at the end.
    row_starts: Vec<Rows>,
}

impl Layout {
    /// For nodes and intervals with these numbers of unknowns.
    ///
    /// # Panics
    /// Unless there is one node more than there are intervals.
    pub fn new(nodes: Vec<usize>, private: Vec<usize>, shared: usize) -> Self {
        assert_eq!(nodes.len(), private.len() + 1, "{} nodes, {} intervals", nodes.len(), private.len());
        let mut starts = vec![0];
        for (k, node) in nodes.iter().enumerate() {
            starts.push(starts[k] + node + private.get(k).copied().unwrap_or(0));
        }
        let elements = 2 * nodes.len();
        let none = vec![Rows::default(); elements];
        Self {
            nodes,
            private,
            shared,
            rows: none.clone(),
            couples_ends: false,
            starts,
            row_starts: [none, vec![Rows::default()]].concat(),
        }
    }

    /// For so many intervals, with the same numbers of unknowns in each node and each interval.
    pub fn uniform(intervals: usize, node: usize, private: usize, shared: usize) -> Self {
        Self::new(vec![node; intervals + 1], vec![private; intervals], shared)
    }

    /// With these rows of an element; [`with_rows_of`](Self::with_rows_of) takes those of all at once.
    ///
    /// # Panics
    /// If there is no such element.
    #[must_use]
    pub fn with_rows(mut self, element: Element, rows: Rows) -> Self {
        let at = self.position(element);
        self.rows[at] = rows;
        self.add_up();
        self
    }

    /// With these rows of all elements.
    ///
    /// ```
    /// use costate_nlp::{Element, Layout, Rows};
    ///
    /// let rows = |element| match element {
    ///     Element::Interval(_) => Rows::new(2, 1),
    ///     Element::Node(0) => Rows::new(2, 0),
    ///     _ => Rows::default(),
    /// };
    /// let layout = Layout::uniform(20, 2, 1, 0).with_rows_of(rows);
    /// assert_eq!((layout.equalities(), layout.ranges()), (42, 20));
    /// ```
    #[must_use]
    pub fn with_rows_of(mut self, rows: impl FnMut(Element) -> Rows) -> Self {
        self.rows = self.elements().map(rows).collect();
        self.add_up();
        self
    }

    /// Adds up where the rows begin.
    fn add_up(&mut self) {
        let mut start = Rows::default();
        for (to, rows) in self.row_starts[1..].iter_mut().zip(&self.rows) {
            start = Rows::new(start.equalities + rows.equalities, start.ranges + rows.ranges);
            *to = start;
        }
    }

    /// With a cost of both ends, (x_0, x_N, p). It is not needed where there are rows of both ends.
    #[must_use]
    pub fn with_cost_of_ends(mut self) -> Self {
        self.couples_ends = true;
        self
    }

    /// Whether functions depend on both ends.
    pub fn couples_ends(&self) -> bool {
        self.couples_ends || self.rows[self.rows.len() - 1] != Rows::default()
    }

    /// Number of intervals, N.
    pub fn intervals(&self) -> usize {
        self.private.len()
    }

    /// Number of entries of a step.
    pub fn steps(&self) -> usize {
        self.starts[self.nodes.len()] + self.shared
    }

    /// Number of equations.
    pub fn equalities(&self) -> usize {
        self.row_starts[self.rows.len()].equalities
    }

    /// Number of functions with ranges.
    pub fn ranges(&self) -> usize {
        self.row_starts[self.rows.len()].ranges
    }

    /// All elements, in the order of their rows.
    pub fn elements(&self) -> impl Iterator<Item = Element> + use<> {
        let last = self.intervals();
        (0..=2 * last + 1).map(move |at| match at {
            _ if at == 2 * last + 1 => Element::Ends,
            _ if at % 2 == 0 => Element::Node(at / 2),
            _ => Element::Interval(at / 2),
        })
    }

    /// Number of an element in that order.
    ///
    /// # Panics
    /// If there is no such element.
    pub fn position(&self, element: Element) -> usize {
        let last = self.intervals();
        let (at, exists) = match element {
            Element::Node(k) => (2 * k, k <= last),
            Element::Interval(k) => (2 * k + 1, k < last),
            Element::Ends => (2 * last + 1, true),
        };
        assert!(exists, "there is no {element:?} among {last} intervals");
        at
    }

    /// The entries of a step that belong to node k.
    pub fn node(&self, k: usize) -> Range<usize> {
        self.starts[k]..self.starts[k] + self.nodes[k]
    }

    /// Those of the unknowns of interval k alone.
    pub fn private(&self, k: usize) -> Range<usize> {
        self.starts[k] + self.nodes[k]..self.starts[k + 1]
    }

    /// Those of the shared unknowns.
    pub fn shared(&self) -> Range<usize> {
        let start = self.starts[self.nodes.len()];
        start..start + self.shared
    }

    /// The unknowns that the functions of an element depend on, in the order of the columns of its block:
    /// ranges of the entries of a step, some of them empty.
    pub fn unknowns(&self, element: Element) -> [Range<usize>; 4] {
        let (shared, last) = (self.shared(), self.intervals());
        match element {
            Element::Node(k) => [self.node(k), 0..0, 0..0, shared],
            Element::Interval(k) => [self.node(k), self.private(k), self.node(k + 1), shared],
            Element::Ends if last == 0 => [self.node(0), 0..0, 0..0, shared],
            Element::Ends => [self.node(0), 0..0, self.node(last), shared],
        }
    }

    /// Number of these unknowns.
    pub fn width(&self, element: Element) -> usize {
        self.unknowns(element).iter().map(ExactSizeIterator::len).sum()
    }

    /// Numbers of rows of an element.
    pub fn rows(&self, element: Element) -> Rows {
        self.rows[self.position(element)]
    }

    /// Its equations among all equations.
    pub fn equalities_of(&self, element: Element) -> Range<usize> {
        let at = self.position(element);
        self.row_starts[at].equalities..self.row_starts[at + 1].equalities
    }

    /// Its functions with ranges among all of them.
    pub fn ranges_of(&self, element: Element) -> Range<usize> {
        let at = self.position(element);
        self.row_starts[at].ranges..self.row_starts[at + 1].ranges
    }

    /// The element of an equation.
    pub fn element_of_equality(&self, row: usize) -> Option<Element> {
        self.elements().find(|&element| self.equalities_of(element).contains(&row))
    }

    /// The element of a function with a range.
    pub fn element_of_range(&self, row: usize) -> Option<Element> {
        self.elements().find(|&element| self.ranges_of(element).contains(&row))
    }
}

#[cfg(test)]
mod tests {
    use super::{Element, Layout, Rows};

    #[test]
    fn elements_unknowns_and_rows_are_in_order() {
        use Element::{Ends, Interval, Node};
        let layout = Layout::new(vec![2, 3, 1], vec![4, 0], 2)
            .with_rows(Interval(1), Rows::new(1, 2))
            .with_rows(Node(0), Rows::new(3, 0))
            .with_rows(Ends, Rows::new(2, 1));
        let elements: Vec<Element> = layout.elements().collect();
        assert_eq!(elements, [Node(0), Interval(0), Node(1), Interval(1), Node(2), Ends]);
        assert!(elements.iter().enumerate().all(|(at, &element)| layout.position(element) == at));
        assert_eq!(layout.unknowns(Interval(0)), [0..2, 2..6, 6..9, 10..12]);
        assert_eq!(layout.unknowns(Interval(1)), [6..9, 9..9, 9..10, 10..12]);
        assert_eq!(layout.unknowns(Ends), [0..2, 0..0, 9..10, 10..12]);
        assert_eq!((layout.steps(), layout.equalities(), layout.ranges()), (12, 6, 3));
        assert_eq!((layout.equalities_of(Interval(1)), layout.ranges_of(Ends)), (3..4, 2..3));
        assert_eq!(layout.element_of_equality(4), Some(Ends));
        assert_eq!(layout.element_of_range(0), Some(Interval(1)));
        assert_eq!(layout.element_of_range(3), None);
    }
}
