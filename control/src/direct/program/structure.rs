//! Which unknowns and rows the staged program of a motion has, and where they stand.

use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::ends::Ends;
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
    pub bounds: [Vec<f64>; 2],
    pub scales: Scales,
    pub equalities: Vec<Row>,
    pub ranges: Vec<Row>,
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
        let (mut equalities, mut ranges, mut bounds) = (Vec::new(), Vec::new(), [Vec::new(), Vec::new()]);
        let layout = Layout::new(counts, vec![inner; last], ends.shared()).with_rows_of(|element| {
            let before = [equalities.len(), ranges.len()];
            for entries in entries_of(element, spline, barrier, of_both) {
                add_rows(barrier, entries, &mut equalities, (&mut ranges, &mut bounds));
            }
            Rows::new(equalities.len() - before[0], ranges.len() - before[1])
        });
        let mut found = Self {
            columns: Vec::new(),
            width: inner + 2 * node,
            bounds,
            scales: Scales::ones(&layout),
            unknowns: vec![0; layout.steps() - ends.shared()],
            layout,
            equalities,
            ranges,
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
        let Self { layout, equalities, ranges, .. } = self;
        [&equalities[layout.equalities_of(element)], &ranges[layout.ranges_of(element)]]
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
        let way = |i: usize| {
            let positions = (0..nodes).map(|k| spline.unknowns[self.node * k + i]);
            let [least, most] = positions
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], q| [least.min(q), most.max(q)]);
            most - least
        };
        let ways: Vec<f64> = (0..n).map(way).collect();
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
        for (scales, rows) in
            [(&mut self.scales.equalities, &self.equalities), (&mut self.scales.ranges, &self.ranges)]
        {
            scales.iter_mut().zip(rows).for_each(|(scale, row)| *scale = barrier.side(row.entry).range);
        }
        self.scales.cost = size;
    }
}

/// The entries of the barrier that belong to an element, those of each place apart.
fn entries_of(element: Element, spline: &Spline, barrier: &Barrier, of_both: usize) -> Vec<Range<usize>> {
    let mesh = &spline.mesh;
    let at_ends = |which: &dyn Fn(usize, usize) -> bool| {
        let ends = barrier.at_ends().enumerate();
        ends.filter(|&(row, at)| which(row, at)).map(|(_, at)| at..at + 1).collect::<Vec<_>>()
    };
    match element {
        Element::Node(k) => {
            let end = mesh.end_at(k);
            let rows = at_ends(&|row, at| row >= of_both && Some(barrier.end_of(at)) == end);
            std::iter::once(barrier.at_node(k)).chain(rows).collect()
        }
        Element::Interval(k) => {
            let first = mesh.first_point(k);
            let points = (first..first + mesh.own_points(k)).map(|p| barrier.at_point(p));
            let count = mesh.gauss_points() / mesh.intervals();
            points.chain((count * k..count * (k + 1)).map(|p| barrier.at_gauss_point(p))).collect()
        }
        Element::Ends => at_ends(&|row, _| row < of_both),
    }
}

/// Adds the rows of the entries of one place, where both sides of a limit stand together, with lower and
/// upper bounds of the values with ranges.
fn add_rows(
    barrier: &Barrier,
    entries: Range<usize>,
    equalities: &mut Vec<Row>,
    (ranges, bounds): (&mut Vec<Row>, &mut [Vec<f64>; 2]),
) {
    let mut last: Option<(Limited, usize, bool)> = None;
    for at in entries.filter(|&at| barrier.weight[at] > 0.0) {
        let side = barrier.side(at);
        let row = Row { entry: at, sign: side.sign, offset: 0.0 };
        if side.is_equation {
            equalities.push(row);
            continue;
        }
        let bound = side.bound - side.sign * barrier.moved_by(at);
        let row = Row { offset: bound, ..row };
        let is_hull = barrier.side_index(at).is_some_and(|side| barrier.is_hull(side));
        let value = Some((side.limited, side.joint, is_hull));
        if last != value {
            ranges.push(row);
            bounds[0].push(f64::NEG_INFINITY);
            bounds[1].push(f64::INFINITY);
        }
        bounds[usize::from(side.sign < 0.0)][ranges.len() - 1] = bound;
        last = value;
    }
}
