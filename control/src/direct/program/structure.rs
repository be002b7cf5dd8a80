//! Which unknowns and rows the staged program of a motion has, and where they stand.

use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::ends::{Ends, Tie};
use crate::direct::limits::side::Limited;
use crate::direct::motion::spline::Spline;
use costate_nlp::{Element, Layout, Rows, Scales};
use std::ops::Range;

/// The least typical size of a joint, as a part of the largest one.
const LEAST_SIZE: f64 = 0.1;

/// A column of an element, and the derivative of an unknown of the spline by it; zero for what is given.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Column {
    pub at: usize,
    pub factor: f64,
}

impl Column {
    /// Adds a derivative by its unknown to those by all columns.
    #[inline(always)]
    pub fn add(self, derivative: f64, to: &mut [f64]) {
        if self.factor != 0.0 {
            to[self.at] += self.factor * derivative;
        }
    }
}

/// An equation, or a value with a range: both sides of a limit are one row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    /// Its entry of the barrier; of both sides of a limit the first one.
    pub entry: usize,
    /// Its value is `sign d + offset` with the distance d of the entry; without offset for an equation, whose
    /// value is its residual.
    pub sign: f64,
    pub offset: f64,
    /// The entry of the other side of the limit, if it has one.
    pub other: Option<usize>,
}

impl Row {
    /// The multiplier of the row by those of its entries.
    pub fn multiplier(&self, barrier: &Barrier) -> f64 {
        let of_other = self.other.map_or(0.0, |other| barrier.multiplier[other]);
        self.sign * (of_other - barrier.multiplier[self.entry])
    }
}

/// The rows of all elements, with lower and upper bounds of the values with ranges.
#[derive(Clone, Debug, Default)]
struct RowLists {
    equalities: Vec<Row>,
    ranges: Vec<Row>,
    bounds: [Vec<f64>; 2],
}

/// The structure of the program of a motion on one mesh.
///
/// The nodes of the program are those of the mesh. Their unknowns are q and q' (with continuous accelerations
/// q'' too) but for what is given, or shared by both ends, at the ends of phases; those of an interval are
/// the bubbles; shared ones are the parameters of the times and what both ends share. Rows at points and
/// Gauss's points belong to intervals, limits of positions and rates at nodes to these, rows of one end of a
/// phase to its node.
#[derive(Clone, Debug)]
pub(crate) struct Structure {
    pub layout: Layout,
    pub scales: Scales,
    rows: RowLists,
    /// Room for those of another motion on this mesh.
    other_rows: RowLists,
    /// What is given or shared by both ends: nodes and places there.
    removed: Vec<(usize, usize)>,
    tied: Vec<Tie>,
    /// How far each joint goes.
    ways: Vec<f64>,
    /// For each interval the columns of its unknowns: inner ones, those of the left and of the right node.
    columns: Vec<Column>,
    /// Number of these of an interval.
    width: usize,
    /// Unknowns of a node, and of an interval.
    pub(super) node: usize,
    pub(super) inner: usize,
    /// For each entry of a step the unknown of the spline that it moves; those of the shared ones are not
    /// here.
    pub unknowns: Vec<usize>,
}

impl Structure {
    /// For a motion with the entries of the barrier on its mesh. The first rows at ends, so many, depend on
    /// both ends; `size` is a typical cost.
    pub fn new(spline: &Spline, barrier: &Barrier, ends: &Ends, (of_both, size): (usize, f64)) -> Self {
        let (shape, mesh, n) = (spline.mesh.shape, &spline.mesh, spline.dof);
        let (node, inner, last) = (shape.node() * n, shape.inner() * n, mesh.intervals());
        let mut is_free = vec![true; node * (last + 1)];
        ends.removed(mesh).for_each(|(k, i)| is_free[node * k + i] = false);
        let free = |k: usize| (0..node).filter(|i| is_free[node * k + i]).collect::<Vec<_>>();
        let nodes: Vec<Vec<usize>> = (0..=last).map(free).collect();
        let counts = nodes.iter().map(Vec::len).collect();
        let mut rows = RowLists::default();
        let layout = Layout::new(counts, vec![inner; last], ends.shared())
            .with_rows_of(|element| rows.add(element, spline, barrier, of_both));
        let mut found = Self {
            columns: Vec::new(),
            width: inner + 2 * node,
            scales: Scales::ones(&layout),
            unknowns: vec![0; layout.steps() - ends.shared()],
            layout,
            other_rows: rows.clone(),
            rows,
            removed: ends.removed(mesh).collect(),
            tied: ends.tied.clone(),
            ways: vec![0.0; n],
            node,
            inner,
        };
        found.place_columns(&nodes, ends);
        for (k, nodes) in nodes.iter().enumerate() {
            for (at, i) in found.layout.node(k).zip(nodes) {
                found.unknowns[at] = node * k + i;
            }
            for (i, at) in (k < last).then(|| found.layout.private(k)).into_iter().flatten().enumerate() {
                found.unknowns[at] = node * (last + 1) + inner * k + i;
            }
        }
        found.set_scales(spline, barrier, ends, size);
        found
    }

    /// Becomes that of another motion on as many intervals, with other limits and ends, if that has the same
    /// unknowns and rows. Whether it has; nothing changed otherwise. It allocates nothing.
    pub fn renew(
        &mut self,
        spline: &Spline,
        barrier: &Barrier,
        ends: &Ends,
        (of_both, size): (usize, f64),
    ) -> bool {
        let (shape, mesh) = (spline.mesh.shape, &spline.mesh);
        let is_same = [self.node, self.inner]
            == [shape.node(), shape.inner()].map(|count| count * spline.dof)
            && self.layout.intervals() == mesh.intervals()
            && self.layout.shared().len() == ends.shared()
            && self.tied == ends.tied
            && self.removed.iter().copied().eq(ends.removed(mesh));
        if !is_same {
            return false;
        }
        let Self { layout, other_rows, .. } = self;
        other_rows.clear();
        let same_rows = |element| other_rows.add(element, spline, barrier, of_both) == layout.rows(element);
        if !layout.elements().all(same_rows) {
            return false;
        }
        std::mem::swap(&mut self.rows, &mut self.other_rows);
        self.set_scales(spline, barrier, ends, size);
        true
    }

    /// The equations.
    pub fn equalities(&self) -> &[Row] {
        &self.rows.equalities
    }

    /// The values with ranges.
    pub fn ranges(&self) -> &[Row] {
        &self.rows.ranges
    }

    /// Their lower and upper bounds.
    pub fn bounds(&self) -> [&[f64]; 2] {
        self.rows.bounds.each_ref().map(Vec::as_slice)
    }

    /// The columns of the unknowns of an interval: inner ones, those of the left and of the right node.
    #[inline(always)]
    pub(super) fn columns(&self, k: usize) -> &[Column] {
        &self.columns[self.width * k..][..self.width]
    }

    /// The column of an unknown at node k among those of the element of the node.
    pub(super) fn column_at(&self, k: usize, i: usize) -> Column {
        let last = self.layout.intervals();
        // As at the left of the next interval, or at the right of the last one.
        let (interval, first) = if k < last { (k, self.inner) } else { (k - 1, self.inner + self.node) };
        let column = self.columns(interval)[first + i];
        let shared = self.first_shared(interval);
        if column.at >= shared {
            return Column { at: column.at - shared + self.layout.node(k).len(), ..column };
        }
        let before = if k < last { 0 } else { self.layout.node(k - 1).len() + self.inner };
        Column { at: column.at.saturating_sub(before), ..column }
    }

    /// The columns of an unknown of the first node and of one of the last node in the element of both ends.
    pub(super) fn columns_of_ends(&self, i: usize, j: usize) -> [Column; 2] {
        let last = self.layout.intervals();
        let [first, own] = [0, last].map(|k| self.layout.node(k).len());
        let (start, end) = (self.column_at(0, i), self.column_at(last, j));
        let moved = |column: Column, by: usize| Column { at: column.at + by, ..column };
        [if start.at < first { start } else { moved(start, own) }, moved(end, first)]
    }

    /// The unknown of the spline at this place among those of an interval; `None` for those of a right node,
    /// which is the left one of the next interval.
    #[inline(always)]
    pub(super) fn unknown(&self, k: usize, slot: usize) -> Option<usize> {
        let (node, inner, last) = (self.node, self.inner, self.layout.intervals());
        match slot.checked_sub(inner) {
            None => Some(node * (last + 1) + inner * k + slot),
            Some(i) if i < node || k + 1 == last => Some(node * k + i),
            Some(_) => None,
        }
    }

    /// The equations of an element, and its values with ranges.
    pub(super) fn rows_of(&self, element: Element) -> [&[Row]; 2] {
        let Self { layout, rows, .. } = self;
        [&rows.equalities[layout.equalities_of(element)], &rows.ranges[layout.ranges_of(element)]]
    }

    /// The first column of an interval that is that of a shared unknown.
    #[inline(always)]
    pub(super) fn first_shared(&self, k: usize) -> usize {
        self.layout.node(k).len() + self.inner + self.layout.node(k + 1).len()
    }

    /// Whether no unknown of an interval is given or shared.
    #[inline(always)]
    pub(super) fn is_whole(&self, k: usize) -> bool {
        self.first_shared(k) == self.width
    }

    fn place_columns(&mut self, nodes: &[Vec<usize>], ends: &Ends) {
        let (node, inner, last) = (self.node, self.inner, self.layout.intervals());
        let times = ends.times.count();
        for k in 0..last {
            let mut columns = vec![Column::default(); self.width];
            let [left, right] = [k, k + 1].map(|k| &nodes[k]);
            for (i, column) in columns[..inner].iter_mut().enumerate() {
                *column = Column { at: left.len() + i, factor: 1.0 };
            }
            for (side, own, first) in [(0, left, 0), (1, right, left.len() + inner)] {
                for (at, i) in own.iter().enumerate() {
                    columns[inner + node * side + i] = Column { at: first + at, factor: 1.0 };
                }
            }
            let shared = left.len() + inner + right.len() + times;
            for (at, tie) in ends.tied.iter().enumerate() {
                if k == 0 {
                    columns[inner + tie.start] = Column { at: shared + at, factor: 1.0 };
                }
                if let Some(end) = tie.end.filter(|_| k + 1 == last) {
                    columns[inner + node + end] = Column { at: shared + at, factor: tie.sign };
                }
            }
            self.columns.extend(columns);
        }
    }

    /// Typical sizes: how far joints go, ranges of limits, the cost.
    fn set_scales(&mut self, spline: &Spline, barrier: &Barrier, ends: &Ends, size: f64) {
        let (n, nodes) = (spline.dof, spline.mesh.nodes.len());
        let Self { ways, node, .. } = self;
        for (i, way) in ways.iter_mut().enumerate() {
            let positions = (0..nodes).map(|k| spline.unknowns[*node * k + i]);
            let [least, most] = positions
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], q| [least.min(q), most.max(q)]);
            *way = most - least;
        }
        let ways = &self.ways;
        let longest = ways.iter().fold(0.0, |most: f64, &way| most.max(way));
        let of = |i: usize| if longest > 0.0 { ways[i % n].max(LEAST_SIZE * longest) } else { 1.0 };
        let inner = self.node * nodes;
        for (scale, &unknown) in self.scales.steps.iter_mut().zip(&self.unknowns) {
            let width = match unknown.checked_sub(inner) {
                Some(inner) => spline.mesh.width(inner / self.inner),
                None => 1.0,
            };
            *scale = of(unknown) * width * width;
        }
        let shared = self.layout.shared();
        let times = spline.duration() / spline.times.len() as f64;
        self.scales.steps[shared.start..shared.start + ends.times.count()].fill(times);
        for (scale, tie) in self.scales.steps[shared.start + ends.times.count()..].iter_mut().zip(&ends.tied)
        {
            *scale = of(tie.start);
        }
        let Self { scales: Scales { equalities, ranges, .. }, rows, .. } = self;
        for (scales, rows) in [(equalities, &rows.equalities), (ranges, &rows.ranges)] {
            scales.iter_mut().zip(rows).for_each(|(scale, row)| *scale = barrier.side(row.entry).range);
        }
        self.scales.cost = size;
    }
}

impl RowLists {
    fn clear(&mut self) {
        let Self { equalities, ranges, bounds: [lower, upper] } = self;
        equalities.clear();
        ranges.clear();
        lower.clear();
        upper.clear();
    }

    /// Adds the rows of an element. Returns how many.
    fn add(&mut self, element: Element, spline: &Spline, barrier: &Barrier, of_both: usize) -> Rows {
        let before = [self.equalities.len(), self.ranges.len()];
        let mesh = &spline.mesh;
        match element {
            Element::Node(k) => {
                self.add_place(barrier, barrier.at_node(k));
                if let Some(end) = mesh.end_at(k) {
                    let of_one = barrier.at_ends().skip(of_both);
                    let own = of_one.filter(|&at| barrier.end_of(at) == end);
                    own.for_each(|at| self.add_place(barrier, at..at + 1));
                }
            }
            Element::Interval(k) => {
                let first = mesh.first_point(k);
                let points = first..first + mesh.own_points(k);
                points.for_each(|p| self.add_place(barrier, barrier.at_point(p)));
                let count = mesh.gauss_points() / mesh.intervals();
                let points = count * k..count * (k + 1);
                points.for_each(|p| self.add_place(barrier, barrier.at_gauss_point(p)));
            }
            Element::Ends => {
                barrier.at_ends().take(of_both).for_each(|at| self.add_place(barrier, at..at + 1));
            }
        }
        Rows::new(self.equalities.len() - before[0], self.ranges.len() - before[1])
    }

    /// Adds the rows of the entries of one place, where both sides of a limit stand together.
    fn add_place(&mut self, barrier: &Barrier, entries: Range<usize>) {
        let Self { equalities, ranges, bounds } = self;
        let mut last: Option<(Limited, usize, bool)> = None;
        for at in entries.filter(|&at| barrier.weight[at] > 0.0) {
            let side = barrier.side(at);
            let row = Row { entry: at, sign: side.sign, offset: 0.0, other: None };
            if side.is_equation {
                equalities.push(row);
                continue;
            }
            let bound = side.bound - side.sign * barrier.moved_by(at);
            let is_hull = barrier.side_index(at).is_some_and(|side| barrier.is_hull(side));
            let value = Some((side.limited, side.joint, is_hull));
            match ranges.last_mut().filter(|_| last == value) {
                Some(row) => row.other = Some(at),
                None => {
                    ranges.push(Row { offset: bound, ..row });
                    bounds[0].push(f64::NEG_INFINITY);
                    bounds[1].push(f64::INFINITY);
                }
            }
            bounds[usize::from(side.sign < 0.0)][ranges.len() - 1] = bound;
            last = value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Structure;
    use crate::direct::interior::iterate::Interior;
    use crate::direct::interior::iterate::tests::{started, started_with};
    use crate::direct::motion::shape::Shape;
    use crate::direct::points::values::PointDynamics;
    use crate::problem::Via;

    fn of<D: PointDynamics>(interior: &Interior<D>, size: f64) -> Structure {
        let of_both = interior.model.tasks.rows_of_both_ends();
        Structure::new(&interior.spline, &interior.barrier, &interior.ends, (of_both, size))
    }

    /// That of another motion within other limits, against one that is made for it.
    #[test]
    fn structures_are_renewed_on_their_mesh_and_on_no_other_one() {
        for shape in [Shape::Quartic, Shape::Quintic] {
            let mut interior = started_with(shape, &[Via::at(&[0.4, 0.3]).with_q_free(&[1])]);
            let mut structure = of(&interior, 1.0);
            interior.spline.unknowns.iter_mut().for_each(|unknown| *unknown *= 1.5);
            interior.spline.times[0] *= 2.0;
            let side = interior.barrier.at_point(1).find(|&at| interior.barrier.is_limit(at)).unwrap();
            let side = interior.barrier.side_index(side).unwrap();
            interior.barrier.move_inside(1, side, 0.01, 1.0);
            let expected = of(&interior, 2.0);
            let of_both = interior.model.tasks.rows_of_both_ends();
            let mut renew = |interior: &Interior<_>| {
                structure.renew(&interior.spline, &interior.barrier, &interior.ends, (of_both, 2.0))
            };
            assert!(renew(&interior));
            assert!(!renew(&started(shape)), "it has no via");
            // What is free at an end, and rows that do not count.
            let mut other = started_with(shape, &[Via::at(&[0.4, 0.3]).with_q_free(&[1])]);
            other.ends.given[2][0] ^= true;
            assert!(!renew(&other));
            let own = interior.barrier.at_point(4);
            interior.barrier.weight[own].fill(0.0);
            assert!(!renew(&interior));
            let shown = |found: &Structure| {
                let rows = (found.equalities(), found.ranges(), found.bounds());
                format!("{rows:?} {:?} {:?} {:?}", found.scales, found.columns, found.unknowns)
            };
            assert_eq!(shown(&structure), shown(&expected));
        }
    }
}
