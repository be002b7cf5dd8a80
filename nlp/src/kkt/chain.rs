//! Symmetric indefinite factorisation of a chain of stages with a border.
//!
//! The matrix of a Newton step,
//!
//! $$ \begin{pmatrix} W & C^T \\\\ C & 0 \end{pmatrix} $$
//!
//! couples the unknowns of neighbouring nodes, and the shared ones. Stage k assembles node k and interval k;
//! it eliminates x_k, w_k and the multipliers of their equations, and hands the Schur complement on to stage
//! k + 1: that of x_k+1 and of the border, and rows that found no acceptable pivot. The border (the shared
//! unknowns, and x_0 if functions depend on both ends) is the last stage. There everything is eliminated:
//! pivots that are zero then belong to equations that depend on others, or to unknowns without effect. The
//! inertia is the sum over all stages (Haynsworth).

use super::factors::Factors;
use super::front::{Front, Pivot};
use crate::dense::Dense;
use crate::layout::{Element, Layout};
use crate::tiles::{LANES, Sums};
use costate_numerics::in_widest;
use std::ops::Range;

/// Numbers of positive, negative and zero eigenvalues; zero up to rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Inertia {
    pub positive: usize,
    pub negative: usize,
    pub zero: usize,
}

/// One stage: what it assembles, and its factors.
#[derive(Clone, Debug)]
struct Stage {
    /// Unknowns and multipliers that it can eliminate, and unknowns that it shares with later stages; rows
    /// that wait, and those beside the equations, stand between them.
    own: Vec<usize>,
    shared: Vec<usize>,
    /// Places of what the stage before shares, among its own and shared ones.
    places: Vec<usize>,
    parts: Vec<Assembled>,
    factors: Factors,
}

/// Rows of one element beside its equations, in one factorisation: ranges that are held, or nearly so.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kept {
    /// Their numbers.
    pub rows: Vec<usize>,
    /// The derivatives of one row after the other.
    pub entries: Vec<f64>,
    /// Their entries on the diagonal of the matrix.
    pub diagonal: Vec<f64>,
}

impl Kept {
    /// With room for so many rows.
    pub fn with_room(rows: usize, width: usize) -> Self {
        Self {
            rows: Vec::with_capacity(rows),
            entries: Vec::with_capacity(rows * width),
            diagonal: Vec::with_capacity(rows),
        }
    }

    pub fn clear(&mut self) {
        self.rows.clear();
        self.entries.clear();
        self.diagonal.clear();
    }
}

/// The matrices of all elements.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Matrices<'a, J> {
    /// The upper triangles of W.
    pub hessians: &'a [Dense],
    /// The Jacobian of the equations of each element.
    pub jacobian: J,
    /// Rows beside them; of none where there are none.
    pub kept: &'a [Kept],
}

/// An element, and the place of each of its columns, and of its equations, among the rows of a stage.
#[derive(Clone, Debug)]
struct Assembled {
    element: usize,
    columns: Vec<usize>,
    equalities: Vec<usize>,
    /// For each column, the places of the columns from it on, and for each equation the places of all
    /// columns: runs of consecutive ones on one side of it, and of what stands between.
    runs: Vec<Vec<(usize, usize)>>,
    equality_runs: Vec<Vec<(usize, usize)>>,
    /// The same for rows between.
    kept_runs: Vec<(usize, usize)>,
    /// Whether the columns are all rows of the stage in their order.
    is_whole: bool,
}

/// The factorisation. Rows are numbered as the entries of a step, then the equations; other rows as they say.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    stages: Vec<Stage>,
    front: Front,
    /// Schur complement of the last stage: its rows, sizes of their columns, and the lower triangle by
    /// columns.
    carried: Carried,
    /// Rows of a stage that are beside its equations.
    kept: Vec<usize>,
    chooses_pivots: bool,
    /// Rows with zero pivots.
    zeros: Vec<usize>,
    local: Vec<f64>,
    sums: Sums,
}

#[derive(Clone, Debug, Default)]
struct Carried {
    rows: Vec<usize>,
    sizes: Vec<f64>,
    entries: Vec<f64>,
    /// How many of the rows could have been eliminated.
    delayed: usize,
    /// Rows whose places in the next front follow one another: the first one, its place, their number.
    runs: Vec<[usize; 3]>,
}

impl Chain {
    /// With room for so many rows of each element beside its equations. Where pivots are not chosen the
    /// matrix should be positive definite, and the inertia shows whether it is.
    pub fn new(layout: &Layout, most_kept: impl Fn(Element) -> usize, chooses_pivots: bool) -> Self {
        let (last, steps) = (layout.intervals(), layout.steps());
        let holds_first = last > 0 && layout.couples_ends();
        let mut border: Vec<usize> = Vec::new();
        if holds_first {
            border.extend(layout.node(0));
        }
        border.extend(layout.shared());
        let equalities = |element| layout.equalities_of(element).map(move |row| steps + row);
        let mut before: Vec<usize> = Vec::new();
        let (mut largest, mut most) = (0, 0);
        let stages = (0..=last).map(|k| {
            let is_last = k == last;
            let mut own: Vec<usize> = Vec::new();
            if k > 0 || !holds_first {
                own.extend(layout.node(k));
            }
            let mut elements = vec![Element::Node(k)];
            let mut shared = Vec::new();
            if is_last {
                own.extend(&border);
                if layout.couples_ends() {
                    elements.push(Element::Ends);
                }
            } else {
                own.extend(layout.private(k));
                elements.push(Element::Interval(k));
                shared.extend(layout.node(k + 1));
                shared.extend(&border);
            }
            elements.iter().for_each(|&element| own.extend(equalities(element)));
            let all: Vec<usize> = own.iter().chain(&shared).copied().collect();
            let place = |row: usize| all.iter().position(|&other| other == row).unwrap_or(usize::MAX);
            let (between, mut kept) = (own.len(), 0);
            let parts = elements.iter().map(|&element| {
                kept += most_kept(element);
                let columns: Vec<usize> = layout.unknowns(element).into_iter().flatten().map(place).collect();
                Assembled {
                    element: layout.position(element),
                    runs: (0..columns.len()).map(|i| runs([columns[i], between], &columns[i..])).collect(),
                    equality_runs: equalities(element)
                        .map(|row| runs([place(row), between], &columns))
                        .collect(),
                    kept_runs: runs([between; 2], &columns),
                    is_whole: columns.iter().copied().eq(0..all.len()),
                    columns,
                    equalities: equalities(element).map(place).collect(),
                }
            });
            let (parts, places) = (parts.collect(), before.iter().map(|&row| place(row)).collect());
            before.clone_from(&shared);
            (largest, most) = (largest.max(own.len() + shared.len()), most.max(kept));
            Stage { parts, factors: Factors::with_room(own.len() + kept, shared.len()), own, shared, places }
        });
        let stages: Vec<Stage> = stages.collect();
        let mut front = Front::default();
        // At most as many rows wait as there are unknowns of a node that can take them, and their partners.
        front.reserve(3 * largest + most);
        Self {
            stages,
            front,
            carried: Carried {
                rows: Vec::with_capacity(2 * largest),
                sizes: Vec::with_capacity(2 * largest),
                entries: Vec::with_capacity(2 * largest * largest),
                delayed: 0,
                runs: Vec::with_capacity(2 * largest),
            },
            kept: Vec::with_capacity(most),
            chooses_pivots,
            zeros: Vec::with_capacity(
                layout.steps() + layout.equalities() + layout.elements().map(&most_kept).sum::<usize>(),
            ),
            local: Vec::with_capacity(3 * largest + most + LANES),
            sums: Sums::default(),
        }
    }

    /// Factors the matrix of these blocks, where `diagonal` is added to that of unknowns and equations.
    pub fn factorise<'a>(
        &mut self,
        matrices: Matrices<'_, impl Fn(usize) -> &'a Dense>,
        diagonal: &[f64],
    ) -> Inertia {
        self.factorise_unless(matrices, diagonal, usize::MAX)
    }

    /// The same, but where more than so many eigenvalues are negative it ends as soon as that is known: the
    /// inertia is a part of the whole one then, and there are no factors.
    pub fn factorise_unless<'a>(
        &mut self,
        matrices: Matrices<'_, impl Fn(usize) -> &'a Dense>,
        diagonal: &[f64],
        negative: usize,
    ) -> Inertia {
        in_widest!(self.eliminate(&matrices, diagonal, negative))
    }

    #[inline(always)]
    fn eliminate<'a, const FUSED: bool>(
        &mut self,
        Matrices { hessians, jacobian, kept }: &Matrices<'_, impl Fn(usize) -> &'a Dense>,
        diagonal: &[f64],
        negative: usize,
    ) -> Inertia {
        let mut inertia = Inertia::default();
        self.zeros.clear();
        let definite = !self.chooses_pivots;
        let Self { stages, front, carried, zeros, kept: kept_rows, .. } = self;
        carried.clear();
        let count = stages.len();
        for (k, stage) in stages.iter_mut().enumerate() {
            let Stage { own, shared, parts, factors, places } = stage;
            let own_len = own.len();
            kept_rows.clear();
            let kept_of = |part: &Assembled| kept.get(part.element).filter(|kept| !kept.rows.is_empty());
            parts.iter().filter_map(kept_of).for_each(|kept| kept_rows.extend(&kept.rows));
            // Between own and shared ones stand rows that wait, and then those beside the equations.
            let delayed = carried.delayed;
            let between = own_len..own_len + delayed + kept_rows.len();
            let (candidates, size) = (between.end, between.end + shared.len());
            let is_whole = |part: &Assembled| {
                let has_size = hessians[part.element].columns() == size.next_multiple_of(LANES);
                part.is_whole && between.is_empty() && has_size
            };
            let whole = parts.iter().position(is_whole);
            front.reset(size, whole.map(|at| hessians[parts[at].element].entries()));
            for (_, part) in parts.iter().enumerate().filter(|(at, _)| Some(*at) != whole) {
                add_part(front, part, (&hessians[part.element], jacobian(part.element)), &between);
            }
            let mut place = own_len + delayed;
            for (part, kept) in parts.iter().filter_map(|part| Some((part, kept_of(part)?))) {
                place = add_kept(front, part, kept, (place, &between));
            }
            carried.add_to(front, places, &between);
            for (place, &row) in own.iter().enumerate() {
                front.add(place, place, diagonal[row]);
            }
            if !definite {
                front.take_sizes();
            }
            let is_last = k + 1 == count;
            front.eliminate::<FUSED>(candidates, definite, is_last);
            let waiting = carried.waiting();
            factors.take(front, |place| match place.checked_sub(own_len) {
                None => own[place],
                Some(place) if place < delayed => waiting[place],
                Some(_) if place < candidates => kept_rows[place - own_len - delayed],
                Some(_) => shared[place - candidates],
            });
            factors.zeros(zeros);
            for pivot in &factors.pivots {
                count_pivot(pivot, &mut inertia);
            }
            if inertia.negative > negative {
                return inertia;
            }
            carried.take(front, &factors.rows, candidates);
        }
        // Whatever the last stage could not eliminate is zero up to rounding.
        inertia.zero += carried.rows.len();
        zeros.extend(&carried.rows);
        inertia
    }

    /// Rows whose pivots were zero: equations that depend on others (numbers from the number of entries of a
    /// step on), and unknowns without effect.
    pub fn zeros(&self) -> &[usize] {
        &self.zeros
    }

    /// Solves with the factors, in place. Entries of rows with zero pivots become zero.
    pub fn solve(&mut self, x: &mut [f64]) {
        in_widest!(self.substitute(x));
    }

    #[inline(always)]
    fn substitute<const FUSED: bool>(&mut self, x: &mut [f64]) {
        let Self { stages, local, zeros, sums, .. } = self;
        for stage in stages.iter() {
            stage.factors.forward::<FUSED>(x, local);
        }
        for stage in stages.iter().rev() {
            stage.factors.backward::<FUSED>(x, local, sums);
        }
        zeros.iter().for_each(|&row| x[row] = 0.0);
    }
}

/// Runs of consecutive places, each on one side of the first of these, and of what begins at the second:
/// (first place, length).
fn runs([row, between]: [usize; 2], places: &[usize]) -> Vec<(usize, usize)> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for &place in places {
        match runs.last_mut() {
            Some((first, length))
                if *first + *length == place
                    && (place > row) == (*first >= row)
                    && (place >= between) == (*first >= between) =>
            {
                *length += 1;
            }
            _ => runs.push((place, 1)),
        }
    }
    runs
}

/// The place of a row where others stand between own and shared ones.
#[inline(always)]
fn moved(place: usize, between: &Range<usize>) -> usize {
    if place < between.start { place } else { place + between.len() }
}

/// Adds the block of an element.
#[inline(always)]
fn add_part(
    front: &mut Front,
    part: &Assembled,
    (hessian, jacobian): (&Dense, &Dense),
    between: &Range<usize>,
) {
    let Assembled { columns, equalities, runs, equality_runs, .. } = part;
    for (i, (&row, runs)) in columns.iter().zip(runs).enumerate() {
        add_row(front, moved(row, between), runs, &hessian.row(i)[i..], between);
    }
    for (i, (&row, runs)) in equalities.iter().zip(equality_runs).enumerate() {
        add_row(front, row, runs, jacobian.row(i), between);
    }
}

/// Adds the rows of an element beside its equations, from a place on; returns the one after them.
#[inline(always)]
fn add_kept(
    front: &mut Front,
    part: &Assembled,
    kept: &Kept,
    (mut place, between): (usize, &Range<usize>),
) -> usize {
    let width = part.columns.len();
    for (i, diagonal) in kept.diagonal.iter().enumerate() {
        add_row(front, place, &part.kept_runs, &kept.entries[i * width..][..width], between);
        front.add(place, place, *diagonal);
        place += 1;
    }
    place
}

/// Adds entries of a row: runs of unknowns that follow one another on one side of it at once.
#[inline(always)]
fn add_row(
    front: &mut Front,
    row: usize,
    runs: &[(usize, usize)],
    mut entries: &[f64],
    between: &Range<usize>,
) {
    for &(first, length) in runs {
        let (values, rest) = entries.split_at(length);
        front.add_run(row, moved(first, between), values);
        entries = rest;
    }
}

fn count_pivot(pivot: &Pivot, inertia: &mut Inertia) {
    let mut one = |value: f64| match value > 0.0 {
        true => inertia.positive += 1,
        false => inertia.negative += 1,
    };
    match *pivot {
        Pivot::Zero => inertia.zero += 1,
        Pivot::One(value) => one(value),
        Pivot::Two([a, b, c]) => {
            // The determinant is positive or negative beyond rounding.
            let same_sign = (a / b) * (c / b) > 1.0;
            one(if same_sign { a } else { 1.0 });
            one(if same_sign { a } else { -1.0 });
        }
    }
}

impl Carried {
    fn clear(&mut self) {
        self.rows.clear();
        self.sizes.clear();
        self.entries.clear();
        self.delayed = 0;
    }

    /// The rows that could have been eliminated.
    fn waiting(&self) -> &[usize] {
        &self.rows[..self.delayed]
    }

    /// Adds the Schur complement to the next front, where the rows that wait are the first ones between own
    /// and shared ones, and the others have these places.
    #[inline(always)]
    fn add_to(&mut self, front: &mut Front, places: &[usize], between: &Range<usize>) {
        let Self { rows, sizes, entries, delayed, runs } = self;
        runs.clear();
        let waiting = between.start..between.start + *delayed;
        let all = waiting.chain(places.iter().map(|&place| moved(place, between)));
        for (i, place) in all.enumerate().take(rows.len()) {
            match runs.last_mut() {
                Some([_, first, length]) if *first + *length == place => *length += 1,
                _ => runs.push([i, place, 1]),
            }
        }
        let mut entries = &entries[..];
        for (k, &[start, first, length]) in runs.iter().enumerate() {
            for j in 0..length {
                let column = first + j;
                front.sizes[column] = f64::max(front.sizes[column], sizes[start + j]);
                let (values, rest) = entries.split_at(length - j);
                front.add_run(column, column, values);
                entries = rest;
                for &[_, first, length] in &runs[k + 1..] {
                    let (values, rest) = entries.split_at(length);
                    front.add_run(column, first, values);
                    entries = rest;
                }
            }
        }
    }

    /// Takes the Schur complement: rows that wait, then the shared ones.
    #[inline(always)]
    fn take(&mut self, front: &Front, rows: &[usize], candidates: usize) {
        self.clear();
        let eliminated = front.eliminated;
        self.delayed = candidates - eliminated;
        for (j, &row) in rows.iter().enumerate().skip(eliminated) {
            self.rows.push(row);
            self.sizes.push(front.sizes[j]);
            self.entries.extend_from_slice(front.column(j));
        }
    }
}

#[cfg(test)]
mod tests;
