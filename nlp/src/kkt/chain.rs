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
    /// Unknowns and multipliers that it can eliminate, then those that it shares with later stages.
    own: Vec<usize>,
    shared: Vec<usize>,
    /// Places of what the stage before shares, among its own and shared ones.
    places: Vec<usize>,
    parts: Vec<Assembled>,
    factors: Factors,
}

/// An element, and the place of each of its columns, and of its equations, among the rows of a stage.
#[derive(Clone, Debug)]
struct Assembled {
    element: usize,
    columns: Vec<usize>,
    equalities: Vec<usize>,
    /// For each column, the places of the columns from it on, and for each equation the places of all
    /// columns: runs of consecutive ones on one side of it.
    runs: Vec<Vec<(usize, usize)>>,
    equality_runs: Vec<Vec<(usize, usize)>>,
    /// Whether the columns are all rows of the stage in their order.
    is_whole: bool,
}

/// The factorisation. Rows are numbered as the entries of a step, then the equations.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    stages: Vec<Stage>,
    front: Front,
    /// Schur complement of the last stage: its rows, sizes of their columns, and the lower triangle by
    /// columns.
    carried: Carried,
    has_equalities: bool,
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
    pub fn new(layout: &Layout) -> Self {
        let (last, steps) = (layout.intervals(), layout.steps());
        let holds_first = last > 0 && layout.couples_ends();
        let mut border: Vec<usize> = Vec::new();
        if holds_first {
            border.extend(layout.node(0));
        }
        border.extend(layout.shared());
        let equalities = |element| layout.equalities_of(element).map(move |row| steps + row);
        let mut before: Vec<usize> = Vec::new();
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
            let parts = elements.iter().map(|&element| {
                let columns: Vec<usize> = layout.unknowns(element).into_iter().flatten().map(place).collect();
                Assembled {
                    element: layout.position(element),
                    runs: (0..columns.len()).map(|i| runs(columns[i], &columns[i..])).collect(),
                    equality_runs: equalities(element).map(|row| runs(place(row), &columns)).collect(),
                    is_whole: columns.iter().copied().eq(0..all.len()),
                    columns,
                    equalities: equalities(element).map(place).collect(),
                }
            });
            let (parts, places) = (parts.collect(), before.iter().map(|&row| place(row)).collect());
            before.clone_from(&shared);
            Stage { parts, factors: Factors::with_room(own.len(), shared.len()), own, shared, places }
        });
        let stages: Vec<Stage> = stages.collect();
        let largest = stages.iter().map(|stage| stage.own.len() + stage.shared.len()).max().unwrap_or(0);
        let mut front = Front::default();
        // At most as many rows wait as there are unknowns of a node that can take them, and their partners.
        front.reserve(3 * largest);
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
            has_equalities: layout.equalities() > 0,
            zeros: Vec::with_capacity(layout.steps() + layout.equalities()),
            local: Vec::with_capacity(3 * largest + LANES),
            sums: Sums::default(),
        }
    }

    /// Factors the matrix. By element: the upper triangles of W, and the Jacobians of the equations;
    /// `diagonal` is added to that of all rows. Without equations pivots are not chosen: the matrix should be
    /// positive definite, and the inertia shows whether it is.
    pub fn factorise<'a>(
        &mut self,
        hessians: &[Dense],
        jacobian: impl Fn(usize) -> &'a Dense,
        diagonal: &[f64],
    ) -> Inertia {
        self.factorise_unless(hessians, jacobian, diagonal, usize::MAX)
    }

    /// The same, but where more than so many eigenvalues are negative it ends as soon as that is known: the
    /// inertia is a part of the whole one then, and there are no factors.
    pub fn factorise_unless<'a>(
        &mut self,
        hessians: &[Dense],
        jacobian: impl Fn(usize) -> &'a Dense,
        diagonal: &[f64],
        negative: usize,
    ) -> Inertia {
        in_widest!(self.eliminate(hessians, &jacobian, diagonal, negative))
    }

    #[inline(always)]
    fn eliminate<'a, const FUSED: bool>(
        &mut self,
        hessians: &[Dense],
        jacobian: &impl Fn(usize) -> &'a Dense,
        diagonal: &[f64],
        negative: usize,
    ) -> Inertia {
        let mut inertia = Inertia::default();
        self.zeros.clear();
        let definite = !self.has_equalities;
        let Self { stages, front, carried, zeros, .. } = self;
        carried.clear();
        let count = stages.len();
        for (k, stage) in stages.iter_mut().enumerate() {
            let Stage { own, shared, parts, factors, places } = stage;
            // Rows that wait stand first.
            let delayed = carried.delayed;
            let size = delayed + own.len() + shared.len();
            let candidates = delayed + own.len();
            let is_whole = |part: &Assembled| {
                let has_size = hessians[part.element].columns() == size.next_multiple_of(LANES);
                part.is_whole && delayed == 0 && has_size
            };
            let whole = parts.iter().position(is_whole);
            front.reset(size, whole.map(|at| hessians[parts[at].element].entries()));
            for (_, part) in parts.iter().enumerate().filter(|(at, _)| Some(*at) != whole) {
                add_part(front, part, (&hessians[part.element], jacobian(part.element)), delayed);
            }
            carried.add_to(front, places);
            for (place, &row) in own.iter().enumerate() {
                front.add(delayed + place, delayed + place, diagonal[row]);
            }
            if !definite {
                front.take_sizes();
            }
            let is_last = k + 1 == count;
            front.eliminate::<FUSED>(candidates, definite, is_last);
            let waiting = carried.waiting();
            factors.take(front, |place| match place.checked_sub(delayed) {
                None => waiting[place],
                Some(place) => own.get(place).copied().unwrap_or_else(|| shared[place - own.len()]),
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

/// Runs of consecutive places, each on one side of a row: (first place, length).
fn runs(row: usize, places: &[usize]) -> Vec<(usize, usize)> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for &place in places {
        match runs.last_mut() {
            Some((first, length)) if *first + *length == place && (place > row) == (*first >= row) => {
                *length += 1;
            }
            _ => runs.push((place, 1)),
        }
    }
    runs
}

/// Adds the block of an element.
#[inline(always)]
fn add_part(front: &mut Front, part: &Assembled, (hessian, jacobian): (&Dense, &Dense), delayed: usize) {
    let Assembled { columns, equalities, runs, equality_runs, .. } = part;
    // Runs of unknowns that follow one another on either side of the row are added at once.
    let mut add_all = |row: usize, runs: &[(usize, usize)], mut entries: &[f64]| {
        for &(first, length) in runs {
            let (values, rest) = entries.split_at(length);
            front.add_run(delayed + row, delayed + first, values);
            entries = rest;
        }
    };
    for (i, (&row, runs)) in columns.iter().zip(runs).enumerate() {
        add_all(row, runs, &hessian.row(i)[i..]);
    }
    for (i, (&row, runs)) in equalities.iter().zip(equality_runs).enumerate() {
        add_all(row, runs, jacobian.row(i));
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

    /// Adds the Schur complement to the next front, where the rows that do not wait have these places after
    /// those that do. Places are in ascending order.
    #[inline(always)]
    fn add_to(&mut self, front: &mut Front, places: &[usize]) {
        let Self { rows, sizes, entries, delayed, runs } = self;
        runs.clear();
        let all = (0..*delayed).chain(places.iter().map(|place| *delayed + place));
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
