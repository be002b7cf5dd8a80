//! The set of ranges that are held at a solution: second-order conditions, exact solutions, and their
//! derivatives.
//!
//! With the gradients A of all equations and of the ranges that are held, the solution is a strict local
//! minimum if W is positive definite where `A d = 0`: if
//!
//! $$ K = \begin{pmatrix} W & A^T \\\\ A & 0 \end{pmatrix} $$
//!
//! has as many positive eigenvalues as there are unknowns. W is that of the Lagrangian alone: neither barrier
//! terms nor a regularisation are in it. Derivatives of the solution by a parameter solve the same equations.

use crate::blocks::{Blocks, Units};
use crate::condense::{columns_of, scale_hessian};
use crate::dense::Dense;
use crate::elements::{
    Jacobian, Pattern, Room, add_symmetric, add_transposed, gather, scatter, squares, times,
};
use crate::iterate::{Bounds, Iterate};
use crate::kkt::{Chain, Inertia};
use crate::layout::{Layout, Rows};
use crate::tiles::{fused, scaled_product};
use costate_numerics::in_widest;

/// The curvature of the Lagrangian where equations and held ranges are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Curvature {
    /// Positive in all directions.
    Positive,
    /// Zero up to rounding in some, negative in none.
    Zero,
    Negative,
}

/// What the second-order conditions say about a solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Certificate {
    /// It is a strict local minimum.
    LocalMinimum,
    /// Second derivatives do not decide: the curvature is zero in some direction, or negative in one that a
    /// range with a multiplier close to zero forbids.
    Undecided,
    /// The cost falls along a direction that keeps all equations and held ranges to first order.
    NotMinimum,
    /// The conditions of optimality of first order do not hold: there is nothing to certify.
    NotStationary,
}

/// Whether a range is held at a bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Held {
    /// Inside its bounds.
    Free,
    /// At a bound, with a multiplier close to zero.
    Weakly,
    /// At its lower bound.
    Lower,
    /// At its upper bound.
    Upper,
}

/// A range is held if its multiplier is so many times its slack, and free if it is the other way round: both
/// are in units of the scaled program, and their product is mu.
const STRONG: f64 = 1e3;

/// Slacks and multipliers below this, both, decide nothing.
const WEAK: f64 = 1e-6;

/// The factorisation at a solution, with held ranges as equations.
#[derive(Clone, Debug)]
pub(crate) struct Active {
    chain: Chain,
    /// Which ranges are held.
    pub held: Vec<Held>,
    hessians: Vec<Dense>,
    /// Equations, then ranges; rows of free ranges are zero.
    jacobians: Vec<Dense>,
    patterns: Vec<Pattern>,
    /// All matrices are in units of the scaled program.
    ones: Units,
    diagonal: Vec<f64>,
    right: Vec<f64>,
    solution: Vec<f64>,
    residual: Vec<f64>,
    /// Entries and rows of one element.
    local: Room,
    products: Vec<f64>,
    /// Rates of a Newton step, and the step, once one was made.
    pub newton: Option<[Changes; 2]>,
    /// Whether the ranges are those that the last iterate holds, and the factors those there.
    pub has_held: bool,
    pub is_factored: bool,
}

/// Changes of a solution, or right-hand sides of their equations.
#[derive(Clone, Debug, PartialEq)]
pub struct Changes {
    /// Of the unknowns, or of the gradient of the Lagrangian.
    pub x: Vec<f64>,
    /// Of the multipliers of the equations, or of the equations.
    pub equalities: Vec<f64>,
    /// Of the multipliers of the ranges, or of the ranges beside the bounds that hold them.
    pub ranges: Vec<f64>,
}

impl Changes {
    /// Zeros.
    pub fn zeros(layout: &Layout) -> Self {
        Self {
            x: vec![0.0; layout.steps()],
            equalities: vec![0.0; layout.equalities()],
            ranges: vec![0.0; layout.ranges()],
        }
    }
}

/// Steps of iterative refinement of changes.
const REFINEMENTS: usize = 3;

impl Active {
    pub fn new(layout: &Layout) -> Self {
        let mut jacobians = Vec::new();
        let extended = layout.clone().with_rows_of(|element| {
            let Rows { equalities, ranges } = layout.rows(element);
            jacobians.push(Dense::zeros(equalities + ranges, layout.width(element)));
            Rows::new(equalities + ranges, 0)
        });
        let size = extended.steps() + extended.equalities();
        Self {
            chain: Chain::new(&extended),
            held: vec![Held::Free; layout.ranges()],
            hessians: squares(layout),
            patterns: jacobians.iter().map(|rows| Pattern::dense(rows.rows())).collect(),
            jacobians,
            ones: Units::ones(&extended),
            diagonal: vec![0.0; size],
            right: vec![0.0; size],
            solution: vec![0.0; size],
            residual: vec![0.0; size],
            local: Room::new(layout),
            products: vec![0.0; size - layout.steps()],
            newton: None,
            has_held: false,
            is_factored: false,
        }
    }

    /// What is known belongs to another iterate.
    pub fn forget(&mut self) {
        (self.has_held, self.is_factored) = (false, false);
    }

    /// Finds which ranges an iterate holds.
    pub fn hold(&mut self, iterate: &Iterate, bounds: &Bounds) {
        (self.has_held, self.is_factored) = (true, false);
        for (i, held) in self.held.iter_mut().enumerate() {
            // Of both bounds of a narrow range: what they do not cancel.
            let (v, [below, above]) = (iterate.v[i], bounds.gaps(&iterate.slacks, i));
            let (z, gap, side) = match v > 0.0 || (v == 0.0 && above < below) {
                true => (v, above, Held::Upper),
                false => (-v, below, Held::Lower),
            };
            *held = match () {
                () if gap.is_infinite() => Held::Free,
                () if z.max(gap) <= WEAK => Held::Weakly,
                () if z >= STRONG * gap => side,
                () if gap >= STRONG * z => Held::Free,
                () => Held::Weakly,
            };
        }
    }

    /// Factors K, with weakly held ranges as equations or without them.
    pub fn factorise(&mut self, layout: &Layout, blocks: &Blocks, with_weak: bool) -> Curvature {
        self.is_factored = true;
        let holds = |held: Held| match held {
            Held::Free => false,
            Held::Weakly => with_weak,
            Held::Lower | Held::Upper => true,
        };
        let (steps, mut row_of_all) = (layout.steps(), layout.steps());
        self.diagonal.fill(0.0);
        for ((element, block), (hessian, jacobian)) in
            layout.elements().zip(blocks.all()).zip(self.hessians.iter_mut().zip(&mut self.jacobians))
        {
            let (units, Rows { equalities, ranges }) = (&blocks.units, layout.rows(element));
            let columns = columns_of(layout, element, units, self.local.of(hessian.rows()).0);
            scale_hessian(&block.hessian, columns, hessian);
            let [of_equalities, of_ranges] = units.jacobians(layout, element, block);
            for (i, &factor) in of_equalities.factors.iter().enumerate() {
                scaled_product(factor, of_equalities.rows.row(i), columns, jacobian.row_mut(i));
            }
            for (i, row) in (0..ranges).zip(layout.ranges_of(element)) {
                let to = jacobian.row_mut(equalities + i);
                if holds(self.held[row]) {
                    scaled_product(of_ranges.factors[i], of_ranges.rows.row(i), columns, to);
                } else {
                    to.fill(0.0);
                    // An eigenvalue -1 for itself.
                    self.diagonal[row_of_all + equalities + i] = -1.0;
                }
            }
            row_of_all += equalities + ranges;
        }
        let jacobians = &self.jacobians;
        let Inertia { positive, negative, .. } =
            self.chain.factorise(&self.hessians, |element| &jacobians[element], &self.diagonal);
        let zeros = self.chain.zeros();
        let rows = self.diagonal.len() - steps - zeros.iter().filter(|&&row| row >= steps).count();
        match () {
            () if positive == steps => Curvature::Positive,
            () if negative > rows => Curvature::Negative,
            () => Curvature::Zero,
        }
    }

    /// What the second-order conditions say; the factors are those with strongly held ranges alone, or with
    /// weakly held ones too where these decide.
    pub fn certify(&mut self, layout: &Layout, blocks: &Blocks) -> Certificate {
        match self.factorise(layout, blocks, false) {
            Curvature::Positive => Certificate::LocalMinimum,
            Curvature::Zero => Certificate::Undecided,
            Curvature::Negative if !self.held.contains(&Held::Weakly) => Certificate::NotMinimum,
            Curvature::Negative => match self.factorise(layout, blocks, true) {
                Curvature::Positive | Curvature::Zero => Certificate::Undecided,
                Curvature::Negative => Certificate::NotMinimum,
            },
        }
    }

    /// The changes d of the solution with `K d = -rates`.
    pub fn respond(&mut self, layout: &Layout, rates: &Changes, to: &mut Changes) {
        self.right[..layout.steps()].iter_mut().zip(&rates.x).for_each(|(to, rate)| *to = -rate);
        let mut row = layout.steps();
        for element in layout.elements() {
            for i in layout.equalities_of(element) {
                self.right[row] = -rates.equalities[i];
                row += 1;
            }
            for i in layout.ranges_of(element) {
                // Free ranges have no multiplier.
                self.right[row] = if self.diagonal[row] == 0.0 { -rates.ranges[i] } else { 0.0 };
                row += 1;
            }
        }
        self.solution.copy_from_slice(&self.right);
        self.chain.solve(&mut self.solution);
        for _ in 0..REFINEMENTS {
            self.set_residual(layout);
            self.chain.solve(&mut self.residual);
            self.solution.iter_mut().zip(&self.residual).for_each(|(to, d)| *to += d);
        }
        to.x.copy_from_slice(&self.solution[..layout.steps()]);
        let mut row = layout.steps();
        for element in layout.elements() {
            for i in layout.equalities_of(element) {
                to.equalities[i] = self.solution[row];
                row += 1;
            }
            for i in layout.ranges_of(element) {
                to.ranges[i] = self.solution[row];
                row += 1;
            }
        }
    }

    /// `right - K solution`, zero for rows that depend on others.
    fn set_residual(&mut self, layout: &Layout) {
        in_widest!(self.subtract_products(layout));
        self.chain.zeros().iter().for_each(|&row| self.residual[row] = 0.0);
    }

    #[inline(always)]
    fn subtract_products<const FUSED: bool>(&mut self, layout: &Layout) {
        let Self { hessians, jacobians, patterns, ones, diagonal, right, solution, residual, local, .. } =
            self;
        let products = &mut self.products;
        for (i, entry) in residual.iter_mut().enumerate() {
            *entry = fused::<FUSED>(diagonal[i], solution[i], -right[i]);
        }
        let mut row = layout.steps();
        let matrices = hessians.iter().zip(jacobians.iter().zip(&*patterns));
        for (element, (hessian, (jacobian, pattern))) in layout.elements().zip(matrices) {
            let own = row..row + jacobian.rows();
            row = own.end;
            let factors = &ones.equalities[..own.len()];
            let rows = Jacobian { rows: jacobian, pattern, factors };
            let (d, sum, sums) = local.of(jacobian.columns());
            let products = &mut products[..own.len()];
            gather(layout, element, (solution, &ones.steps), d);
            sum.fill(0.0);
            add_symmetric::<FUSED>(hessian, d, sum, sums);
            add_transposed::<FUSED>(rows, &solution[own.clone()], sum);
            scatter(layout, element, sum, (residual, &ones.steps));
            times::<FUSED>(rows, d, products, sums);
            residual[own].iter_mut().zip(&*products).for_each(|(to, product)| *to += product);
        }
        residual.iter_mut().for_each(|entry| *entry = -*entry);
    }
}
