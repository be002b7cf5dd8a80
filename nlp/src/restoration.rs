//! Restoration: the least violation near a point, as a staged program of its own.
//!
//! $$ \min \sum_i (p_i + n_i) + \tfrac12 \zeta \| D (z - z_R) \|^2 \quad \text{subject to} \quad
//! c - p + n = 0, \qquad l \le g - p + n \le u, \qquad p, n \ge 0 $$
//!
//! Waechter and Biegler 2006, section 3.3. The elastic variables p and n of a row are unknowns of an interval
//! that it belongs to, those of both ends are shared: the rows of nodes become rows of intervals.

use crate::blocks::{Block, Blocks, Values, Weights};
use crate::iterate::Iterate;
use crate::layout::{Element, Layout, Rows};
use crate::problem::StagedProblem;
use crate::scales::Scales;
use std::error::Error;
use std::ops::Range;

/// zeta, for displacements and violations in units of their scales. IPOPT has sqrt(mu) / 1000, which rounding
/// hides beside the curvatures z / s of ranges that are held: minima that are not strict are then found
/// slowly.
const PROXIMITY: f64 = 1e-3;

/// The elastic program of another one, about its point `centre`.
pub(crate) struct Elastic<'a, E> {
    original: &'a mut dyn StagedProblem<Error = E>,
    places: &'a Places,
    centre: &'a [f64],
    room: &'a mut ElasticRoom,
}

/// Arrays of an elastic program.
#[derive(Clone, Debug)]
pub(crate) struct ElasticRoom {
    /// Of z, from the centre; zeta D^2.
    displacement: Vec<f64>,
    proximity: Vec<f64>,
    values: Values,
    blocks: Blocks,
    /// Rows of the original program.
    weights: [Vec<f64>; 2],
    bounds: [Vec<f64>; 2],
    scales: Scales,
}

/// Where the rows and unknowns of a program stand in its elastic one.
#[derive(Clone, Debug)]
pub(crate) struct Places {
    pub layout: Layout,
    /// For each element of the program.
    parts: Vec<Part>,
    /// The unknowns of the program among those of the elastic one.
    unknowns: Vec<usize>,
}

/// An element of the program, and the one that takes its rows.
#[derive(Clone, Debug)]
struct Part {
    element: Element,
    to: Element,
    /// The first of its equations and ranges among the rows of `to`.
    rows: Rows,
    /// Its elastic variables among all unknowns: two for each of its equations, then for each of its ranges.
    elastic: Range<usize>,
    /// Columns of its unknowns in the block of `to`, then those of the elastic variables.
    columns: Vec<usize>,
    elastic_columns: Range<usize>,
    /// Its unknowns that no element before it has, and their columns in the block of `to`.
    first: Vec<(usize, usize)>,
}

impl Places {
    pub fn new(layout: &Layout) -> Self {
        let last = layout.intervals();
        // A single node has no interval: its elastic variables are shared.
        let target = |element| match element {
            Element::Node(k) if last > 0 => Element::Interval(k.min(last - 1)),
            Element::Node(_) => Element::Ends,
            other => other,
        };
        let elastic_of = |rows: Rows| 2 * (rows.equalities + rows.ranges);
        let mut private: Vec<usize> = (0..last).map(|k| layout.private(k).len()).collect();
        let mut shared = layout.shared().len();
        let mut rows = vec![Rows::default(); 2 * last + 2];
        let mut parts = Vec::new();
        for element in layout.elements() {
            let (own, to) = (layout.rows(element), target(element));
            let taken = &mut rows[layout.position(to)];
            let first = *taken;
            *taken =
                Rows::new(taken.equalities + own.equalities, taken.ranges + own.ranges + elastic_of(own));
            let count = match to {
                Element::Interval(k) => &mut private[k],
                _ => &mut shared,
            };
            let start = *count;
            *count += elastic_of(own);
            parts.push(Part {
                element,
                to,
                rows: first,
                elastic: start..*count,
                columns: Vec::new(),
                elastic_columns: 0..0,
                first: Vec::new(),
            });
        }
        let nodes = (0..=last).map(|k| layout.node(k).len()).collect();
        let mut rows = rows.into_iter();
        let mut elastic =
            Layout::new(nodes, private, shared).with_rows_of(|_| rows.next().unwrap_or_default());
        if layout.couples_ends() {
            elastic = elastic.with_cost_of_ends();
        }
        let mut unknowns = Vec::new();
        for k in 0..=last {
            unknowns.extend(elastic.node(k));
            if k < last {
                unknowns.extend(elastic.private(k).take(layout.private(k).len()));
            }
        }
        unknowns.extend(elastic.shared().take(layout.shared().len()));
        let mut is_new = vec![true; unknowns.len()];
        for part in &mut parts {
            let all: Vec<usize> = elastic.unknowns(part.to).into_iter().flatten().collect();
            let place = |unknown: usize| all.iter().position(|&other| other == unknown).unwrap_or(usize::MAX);
            let own = layout.unknowns(part.element).into_iter().flatten();
            for unknown in own {
                let column = place(unknowns[unknown]);
                part.columns.push(column);
                if std::mem::take(&mut is_new[unknown]) {
                    part.first.push((unknown, column));
                }
            }
            let start = match part.to {
                Element::Interval(k) => elastic.private(k).start,
                _ => elastic.shared().start,
            };
            part.elastic = start + part.elastic.start..start + part.elastic.end;
            if !part.elastic.is_empty() {
                let first = place(part.elastic.start);
                part.elastic_columns = first..first + part.elastic.len();
            }
        }
        Self { layout: elastic, parts, unknowns }
    }

    /// The displacement of the program's point in a step of the elastic one.
    fn take(&self, from: &[f64], to: &mut [f64]) {
        to.iter_mut().zip(&self.unknowns).for_each(|(to, &place)| *to = from[place]);
    }

    /// The point of the program in one of the elastic one.
    pub fn original_point<'b>(&self, point: &'b [f64]) -> &'b [f64] {
        &point[self.layout.steps()..]
    }

    /// The equations and the ranges of a part, in the program and in the elastic one.
    fn rows(&self, layout: &Layout, part: &Part) -> [[Range<usize>; 2]; 2] {
        let own = [layout.equalities_of(part.element), layout.ranges_of(part.element)];
        let first = [
            self.layout.equalities_of(part.to).start + part.rows.equalities,
            self.layout.ranges_of(part.to).start + part.rows.ranges,
        ];
        let taken = [0, 1].map(|k| first[k]..first[k] + own[k].len());
        [own, taken]
    }

    /// The violation of the program at an iterate of the elastic one, both scaled: `sum |c| + sum |g - s|`,
    /// with s the slacks of the ranges there, which go to `slacks` with their gaps.
    pub fn violation(
        &self,
        layout: &Layout,
        scales: &[f64],
        iterate: &Iterate,
        (slacks, gaps): (&mut [f64], &mut [Vec<f64>; 2]),
    ) -> f64 {
        let mut sum = 0.0;
        for part in &self.parts {
            let [[equalities, ranges], taken] = self.rows(layout, part);
            let elastic = |i: usize| {
                let p = part.elastic.start + 2 * i;
                (iterate.point[p] - iterate.point[p + 1]) / scales[p]
            };
            for (i, row) in taken[0].clone().enumerate() {
                sum += (iterate.values.equalities[row] + elastic(i)).abs();
            }
            for (i, (row, own)) in taken[1].clone().zip(ranges).enumerate() {
                let slack = iterate.slacks[row];
                slacks[own] = slack;
                gaps.iter_mut().zip(&iterate.gaps).for_each(|(to, gaps)| to[own] = gaps[row]);
                sum += (iterate.values.ranges[row] + elastic(equalities.len() + i) - slack).abs();
            }
        }
        sum
    }

    /// For each equation and each range of the program, its elastic variables p and n in a point.
    pub fn elastic<'a>(&'a self, layout: &'a Layout) -> impl Iterator<Item = (bool, usize, [usize; 2])> + 'a {
        self.parts.iter().flat_map(move |part| {
            let (equalities, ranges) = (layout.equalities_of(part.element), layout.ranges_of(part.element));
            let rows = equalities.map(|row| (true, row)).chain(ranges.map(|row| (false, row)));
            rows.zip(part.elastic.clone().step_by(2))
                .map(|((is_equality, row), p)| (is_equality, row, [p, p + 1]))
        })
    }
}

impl ElasticRoom {
    /// For the elastic program of one with this layout.
    pub fn new(layout: &Layout, places: &Places) -> Self {
        let all = &places.layout;
        Self {
            displacement: vec![0.0; layout.steps()],
            proximity: vec![0.0; layout.steps()],
            values: Values::new(layout),
            blocks: Blocks::new(layout),
            weights: [vec![0.0; layout.equalities()], vec![0.0; layout.ranges()]],
            bounds: [vec![0.0; all.ranges()], vec![f64::INFINITY; all.ranges()]],
            scales: Scales::ones(all),
        }
    }

    /// Takes the bounds of a program, and its typical sizes.
    pub fn take(&mut self, layout: &Layout, places: &Places, bounds: [&[f64]; 2], sizes: &Scales) {
        let Self { proximity, bounds: [lower, upper], scales, .. } = self;
        for (&place, &size) in places.unknowns.iter().zip(&sizes.steps) {
            scales.steps[place] = size;
        }
        for part in &places.parts {
            let [[equalities, ranges], [to_equalities, to_ranges]] = places.rows(layout, part);
            scales.equalities[to_equalities].copy_from_slice(&sizes.equalities[equalities.clone()]);
            scales.ranges[to_ranges.clone()].copy_from_slice(&sizes.ranges[ranges.clone()]);
            lower[to_ranges.clone()].copy_from_slice(&bounds[0][ranges.clone()]);
            upper[to_ranges.clone()].copy_from_slice(&bounds[1][ranges.clone()]);
            let of_rows = sizes.equalities[equalities].iter().chain(&sizes.ranges[ranges.clone()]);
            for (i, (&size, p)) in of_rows.zip(part.elastic.clone().step_by(2)).enumerate() {
                for side in 0..2 {
                    scales.steps[p + side] = size;
                    scales.ranges[to_ranges.end + 2 * i + side] = size;
                }
            }
        }
        // D measures in units of the scales.
        for (proximity, size) in proximity.iter_mut().zip(&sizes.steps) {
            *proximity = PROXIMITY / (size * size);
        }
    }

    /// Where a solution begins: the centre, with elastic variables that satisfy all rows, and the conditions
    /// of optimality of p and n at the barrier parameter mu. Values and slacks are those of the scaled
    /// program.
    pub fn start(
        &self,
        (layout, places): (&Layout, &Places),
        centre: &[f64],
        (values, slacks, mu): (&Values, &[f64], f64),
        start: &mut [f64],
    ) {
        let (elastic, point) = start.split_at_mut(places.layout.steps());
        elastic.fill(0.0);
        for (is_equality, row, [p, n]) in places.elastic(layout) {
            let c = if is_equality { values.equalities[row] } else { values.ranges[row] - slacks[row] };
            let scale = self.scales.steps[p];
            // (31) to (33).
            let half = 0.5 * (mu - c);
            let negative = half + (half * half + 0.5 * mu * c).max(0.0).sqrt();
            (elastic[p], elastic[n]) = ((c + negative) * scale, negative * scale);
        }
        point.copy_from_slice(centre);
    }

    /// Typical sizes of steps.
    pub fn step_scales(&self) -> &[f64] {
        &self.scales.steps
    }
}

impl<'a, E: Error> Elastic<'a, E> {
    /// About a point; `room` has [taken](ElasticRoom::take) the program's bounds and sizes.
    pub fn new(
        original: &'a mut dyn StagedProblem<Error = E>,
        (places, room): (&'a Places, &'a mut ElasticRoom),
        centre: &'a [f64],
    ) -> Self {
        Self { original, places, centre, room }
    }
}

/// A point has the elastic variables and displacements of all other unknowns from the centre in its first
/// entries, and the point of the program in the last ones.
impl<E: Error> StagedProblem for Elastic<'_, E> {
    type Error = E;

    fn layout(&self) -> &Layout {
        &self.places.layout
    }

    fn bounds(&self) -> [&[f64]; 2] {
        self.room.bounds.each_ref().map(Vec::as_slice)
    }

    fn point_len(&self) -> usize {
        self.places.layout.steps() + self.centre.len()
    }

    fn scales(&self) -> Option<&Scales> {
        Some(&self.room.scales)
    }

    fn retract(&self, point: &[f64], step: &[f64], moved: &mut [f64]) {
        let n = step.len();
        let (elastic, moved) = moved.split_at_mut(n);
        // From the current point, not from the centre: displacements of manifolds do not add up. There is
        // room for the step of the program where the elastic variables stand next.
        let own = &mut elastic[..self.places.unknowns.len()];
        self.places.take(step, own);
        self.original.retract(&point[n..], own, moved);
        for ((to, from), step) in elastic.iter_mut().zip(point).zip(step) {
            *to = from + step;
        }
    }

    fn evaluate(&mut self, point: &[f64], values: &mut Values) -> Result<(), E> {
        let Self { original, places, room, .. } = self;
        let ElasticRoom { displacement, proximity, values: own, scales, .. } = &mut **room;
        original.evaluate(&point[places.layout.steps()..], own)?;
        if !own.cost.is_finite() {
            values.cost = f64::NAN;
            return Ok(());
        }
        places.take(point, displacement);
        let squares = displacement.iter().zip(&*proximity).map(|(d, weight)| weight * d * d);
        values.cost = 0.5 * squares.sum::<f64>();
        let layout = original.layout();
        for part in &places.parts {
            let [[equalities, ranges], [to_equalities, to_ranges]] = places.rows(layout, part);
            let of_rows = own.equalities[equalities.clone()].iter().chain(&own.ranges[ranges]);
            for (i, (&value, p)) in of_rows.zip(part.elastic.clone().step_by(2)).enumerate() {
                let moved = value - point[p] + point[p + 1];
                match i.checked_sub(equalities.len()) {
                    None => values.equalities[to_equalities.start + i] = moved,
                    Some(i) => values.ranges[to_ranges.start + i] = moved,
                }
                for side in 0..2 {
                    values.ranges[to_ranges.end + 2 * i + side] = point[p + side];
                    values.cost += point[p + side] / scales.steps[p + side];
                }
            }
        }
        Ok(())
    }

    fn linearise(&mut self, point: &[f64], weights: Weights<'_>, blocks: &mut Blocks) -> Result<(), E> {
        let Self { original, places, room, .. } = self;
        let ElasticRoom { displacement, proximity, blocks: own, weights: [y, v], scales, .. } = &mut **room;
        let n = places.layout.steps();
        for part in &places.parts {
            let [[equalities, ranges], [from_equalities, from_ranges]] = places.rows(original.layout(), part);
            y[equalities].copy_from_slice(&weights.equalities[from_equalities]);
            v[ranges].copy_from_slice(&weights.ranges[from_ranges]);
        }
        own.fill_zero();
        original.linearise(&point[n..], Weights { cost: 0.0, equalities: y, ranges: v }, own)?;
        places.take(point, displacement);
        let layout = original.layout();
        for (part, block) in places.parts.iter().zip(own.all()) {
            let to = blocks.of(part.to);
            add_block(part, block, layout.rows(part.element), to);
            for (column, p) in part.elastic_columns.clone().zip(part.elastic.clone()) {
                to.gradient[column] += scales.steps[p].recip();
            }
        }
        // The distance from the centre, once for each unknown.
        for part in &places.parts {
            let block = blocks.of(part.to);
            for &(unknown, column) in &part.first {
                block.gradient[column] += proximity[unknown] * displacement[unknown];
                block.hessian[(column, column)] += weights.cost * proximity[unknown];
            }
        }
        Ok(())
    }
}

/// Adds the rows of an element, and their elastic variables; nothing of its cost.
fn add_block(part: &Part, from: &Block, rows: Rows, to: &mut Block) {
    let columns = &part.columns;
    for (i, &row) in columns.iter().enumerate() {
        for (j, &column) in columns.iter().enumerate().skip(i) {
            to.hessian[(row.min(column), row.max(column))] += from.hessian[(i, j)];
        }
    }
    let elastic = part.elastic_columns.start;
    for i in 0..rows.equalities {
        let at = part.rows.equalities + i;
        for (&column, &entry) in columns.iter().zip(from.equalities.row(i)) {
            to.equalities[(at, column)] += entry;
        }
        to.equalities[(at, elastic + 2 * i)] = -1.0;
        to.equalities[(at, elastic + 2 * i + 1)] = 1.0;
    }
    for i in 0..rows.ranges {
        let at = part.rows.ranges + i;
        for (&column, &entry) in columns.iter().zip(from.ranges.row(i)) {
            to.ranges[(at, column)] += entry;
        }
        let first = elastic + 2 * (rows.equalities + i);
        to.ranges[(at, first)] = -1.0;
        to.ranges[(at, first + 1)] = 1.0;
    }
    for i in 0..part.elastic_columns.len() {
        to.ranges[(part.rows.ranges + rows.ranges + i, elastic + i)] = 1.0;
    }
}
