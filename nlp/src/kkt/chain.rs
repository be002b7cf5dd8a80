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

use super::front::{Front, Pivot, add, inverse_of_two};
use crate::blocks::Dense;
use crate::elements::dot;
use crate::layout::{Element, Layout};
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
    parts: Vec<Assembled>,
    factors: Factors,
}

/// An element, and the place of each of its columns, and of its equations, among the rows of a stage.
#[derive(Clone, Debug)]
struct Assembled {
    element: usize,
    columns: Vec<usize>,
    equalities: Vec<usize>,
    /// For each column, the places of the columns from it on: runs of consecutive ones on one side of it.
    runs: Vec<Vec<(usize, usize)>>,
}

/// L, M and D of a stage.
#[derive(Clone, Debug, Default)]
struct Factors {
    /// Global numbers of all rows, in the order of elimination.
    rows: Vec<usize>,
    pivots: Vec<Pivot>,
    eliminated: usize,
    /// The columns of the eliminated rows, each from its diagonal on.
    columns: Vec<f64>,
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
}

#[derive(Clone, Debug, Default)]
struct Carried {
    rows: Vec<usize>,
    sizes: Vec<f64>,
    entries: Vec<f64>,
    /// How many of the rows could have been eliminated.
    delayed: usize,
    /// Their places in the next front.
    places: Vec<usize>,
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
                    runs: (0..columns.len()).map(|i| runs(&columns[i..])).collect(),
                    columns,
                    equalities: equalities(element).map(place).collect(),
                }
            });
            Stage { parts: parts.collect(), own, shared, factors: Factors::default() }
        });
        let stages: Vec<Stage> = stages.collect();
        let largest = stages.iter().map(|stage| stage.own.len() + stage.shared.len()).max().unwrap_or(0);
        let mut front = Front::default();
        // At most as many rows wait as there are unknowns of a node that can take them, and their partners.
        front.reserve(3 * largest);
        Self {
            stages,
            front,
            carried: Carried::default(),
            has_equalities: layout.equalities() > 0,
            zeros: Vec::new(),
            local: Vec::with_capacity(3 * largest),
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
        let mut inertia = Inertia::default();
        self.zeros.clear();
        let definite = !self.has_equalities;
        let Self { stages, front, carried, zeros, .. } = self;
        carried.clear();
        let count = stages.len();
        for (k, stage) in stages.iter_mut().enumerate() {
            let Stage { own, shared, parts, factors } = stage;
            // Rows that wait stand first.
            let delayed = carried.delayed;
            let size = delayed + own.len() + shared.len();
            front.reset(size);
            factors.rows.clear();
            factors.rows.extend(&carried.rows[..delayed]);
            factors.rows.extend(own.iter().chain(&*shared));
            carried.add_to(front, &factors.rows[delayed..], delayed);
            for part in parts {
                add_part(front, part, (&hessians[part.element], jacobian(part.element)), delayed);
            }
            for (place, &row) in own.iter().enumerate() {
                front.add(delayed + place, delayed + place, diagonal[row]);
            }
            if !definite {
                front.take_sizes();
            }
            let is_last = k + 1 == count;
            front.factorise(delayed + own.len(), definite, is_last);
            factors.take(front, zeros);
            for pivot in &factors.pivots {
                count_pivot(pivot, &mut inertia);
            }
            carried.take(front, &factors.rows, delayed + own.len());
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
        let Self { stages, local, zeros, .. } = self;
        for stage in stages.iter() {
            stage.factors.forward::<FUSED>(x, local);
        }
        for stage in stages.iter().rev() {
            stage.factors.backward::<FUSED>(x, local);
        }
        zeros.iter().for_each(|&row| x[row] = 0.0);
    }
}

/// Runs of consecutive places, each on one side of the first one: (first place, length).
fn runs(places: &[usize]) -> Vec<(usize, usize)> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for &place in places {
        match runs.last_mut() {
            Some((first, length))
                if *first + *length == place && (place > places[0]) == (*first >= places[0]) =>
            {
                *length += 1;
            }
            _ => runs.push((place, 1)),
        }
    }
    runs
}

/// Adds the block of an element.
fn add_part(front: &mut Front, part: &Assembled, (hessian, jacobian): (&Dense, &Dense), delayed: usize) {
    let Assembled { columns, equalities, runs, .. } = part;
    for (i, &row) in columns.iter().enumerate() {
        let (row, entries) = (delayed + row, &hessian.row(i)[i..]);
        // Runs of unknowns that follow one another on either side are added at once.
        let mut at = 0;
        for &(first, length) in &runs[i] {
            front.add_run(row, delayed + first, &entries[at..at + length]);
            at += length;
        }
    }
    for (i, &row) in equalities.iter().enumerate() {
        for (&column, &entry) in columns.iter().zip(jacobian.row(i)) {
            front.add(delayed + row, delayed + column, entry);
        }
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

    /// Adds the Schur complement to the next front, whose rows after the waiting ones are these.
    fn add_to(&mut self, front: &mut Front, rows: &[usize], delayed: usize) {
        self.places.clear();
        for (i, row) in self.rows.iter().enumerate() {
            let found = || rows.iter().position(|other| other == row);
            self.places.push(if i < delayed { i } else { delayed + found().unwrap_or(usize::MAX - delayed) });
        }
        let mut at = 0;
        for (j, &column) in self.places.iter().enumerate() {
            front.sizes[column] = f64::max(front.sizes[column], self.sizes[j]);
            for &row in &self.places[j..] {
                front.add(row, column, self.entries[at]);
                at += 1;
            }
        }
    }

    /// Takes the Schur complement: rows that wait, then the shared ones.
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

impl Factors {
    /// Takes the eliminated columns and the order of rows.
    fn take(&mut self, front: &Front, zeros: &mut Vec<usize>) {
        let assembled = std::mem::take(&mut self.rows);
        self.rows = front.order.iter().map(|&place| assembled[place]).collect();
        self.pivots.clear();
        self.pivots.extend_from_slice(&front.pivots);
        self.eliminated = front.eliminated;
        self.columns.clear();
        for j in 0..front.eliminated {
            self.columns.extend_from_slice(front.column(j));
        }
        let mut k = 0;
        for pivot in &self.pivots {
            if *pivot == Pivot::Zero {
                zeros.push(self.rows[k]);
            }
            k += pivot.order();
        }
    }

    /// `y = L^-1 x` of the eliminated rows, and x less M y of the others.
    #[inline(always)]
    fn forward<const FUSED: bool>(&self, x: &mut [f64], local: &mut Vec<f64>) {
        local.clear();
        local.extend(self.rows.iter().map(|&row| x[row]));
        let mut start = 0;
        for k in 0..self.eliminated {
            let column = &self.columns[start + 1..start + self.rows.len() - k];
            start += self.rows.len() - k;
            let value = local[k];
            add::<FUSED>(&mut local[k + 1..], -value, column);
        }
        self.rows.iter().zip(&*local).for_each(|(&row, &value)| x[row] = value);
    }

    /// `L^-T (D^-1 y - M' x)` of the eliminated rows, where x of the others is known.
    #[inline(always)]
    fn backward<const FUSED: bool>(&self, x: &mut [f64], local: &mut Vec<f64>) {
        local.clear();
        local.extend(self.rows.iter().map(|&row| x[row]));
        let mut k = 0;
        for pivot in &self.pivots {
            match *pivot {
                Pivot::Zero => local[k] = 0.0,
                Pivot::One(d) => local[k] /= d,
                Pivot::Two(block) => [local[k], local[k + 1]] = inverse_of_two(block)(local[k], local[k + 1]),
            }
            k += pivot.order();
        }
        let mut end = self.columns.len();
        for k in (0..self.eliminated).rev() {
            let start = end - (self.rows.len() - k);
            let column = &self.columns[start + 1..end];
            end = start;
            local[k] -= dot(column, &local[k + 1..]);
        }
        self.rows[..self.eliminated].iter().zip(&*local).for_each(|(&row, &value)| x[row] = value);
    }
}

#[cfg(test)]
mod tests;
