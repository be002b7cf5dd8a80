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

use crate::blocks::Blocks;
use crate::condense::{Condensed, number};
use crate::elements::{Room, add_symmetric, gather, scatter};
use crate::iterate::Iterate;
use crate::kkt::{Chain, Inertia};
use crate::layout::Layout;
use crate::tiles::add_all_rows;
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
    /// W, the Jacobian of the equations, and ranges that are held.
    condensed: Condensed,
    /// Which ranges are held.
    pub held: Vec<Held>,
    /// Zeros.
    diagonal: Vec<f64>,
    /// Of unknowns, equations and ranges; zero for those that are not held.
    right: Vec<f64>,
    solution: Vec<f64>,
    residual: Vec<f64>,
    /// Entries of one element, and ones.
    local: Room,
    ones: Vec<f64>,
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
        let ranges = |element| layout.ranges_of(element).len();
        let rows = layout.steps() + layout.equalities();
        let all = rows + layout.ranges();
        Self {
            chain: Chain::new(layout, ranges, true),
            condensed: Condensed::new(layout, ranges),
            held: vec![Held::Free; layout.ranges()],
            diagonal: vec![0.0; rows],
            right: vec![0.0; all],
            solution: vec![0.0; all],
            residual: vec![0.0; all],
            local: Room::new(layout),
            ones: vec![1.0; layout.steps()],
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
    pub fn hold(&mut self, iterate: &Iterate) {
        (self.has_held, self.is_factored) = (true, false);
        for (i, held) in self.held.iter_mut().enumerate() {
            // Of both bounds of a narrow range: what they do not cancel.
            let (v, [below, above]) = (iterate.v[i], [iterate.gaps[0][i], iterate.gaps[1][i]]);
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
        let Self { chain, condensed, held, diagonal, .. } = self;
        condensed.hold(layout, blocks, |range| holds(held[range]));
        let steps = layout.steps();
        let Inertia { positive, negative, .. } = chain.factorise(condensed.matrices(), diagonal);
        let dependent = chain.zeros().iter().filter(|&&row| row >= steps).count();
        let rows = layout.equalities() + condensed.kept() - dependent;
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
        let Self { chain, condensed, right, solution, .. } = self;
        let (n, m) = (layout.steps(), number(layout, 0));
        right[..n].copy_from_slice(&rates.x);
        right[n..m].copy_from_slice(&rates.equalities);
        // Free ranges have no multiplier.
        right[m..].fill(0.0);
        for &row in condensed.kept.iter().flat_map(|kept| &kept.rows) {
            right[row] = rates.ranges[row - m];
        }
        right.iter_mut().for_each(|rate| *rate = -*rate);
        condensed.scale_vector(right);
        solution.copy_from_slice(right);
        chain.solve(solution);
        for _ in 0..REFINEMENTS {
            self.set_residual(layout);
            self.chain.solve(&mut self.residual);
            self.solution.iter_mut().zip(&self.residual).for_each(|(to, d)| *to += d);
        }
        self.condensed.scale_vector(&mut self.solution);
        to.x.copy_from_slice(&self.solution[..n]);
        to.equalities.copy_from_slice(&self.solution[n..m]);
        to.ranges.copy_from_slice(&self.solution[m..]);
    }

    /// `right - K solution`, zero for rows that depend on others; all of them scaled.
    fn set_residual(&mut self, layout: &Layout) {
        in_widest!(self.subtract_products(layout));
        self.chain.zeros().iter().for_each(|&row| self.residual[row] = 0.0);
    }

    #[inline(always)]
    fn subtract_products<const FUSED: bool>(&mut self, layout: &Layout) {
        let Self { condensed, right, solution, residual, local, ones, .. } = self;
        residual.iter_mut().zip(right).for_each(|(to, right)| *to = -*right);
        let matrices = condensed.hessians.iter().zip(condensed.jacobians.iter().zip(&condensed.kept));
        for (element, (hessian, (jacobian, kept))) in layout.elements().zip(matrices) {
            let width = jacobian.columns();
            let (d, sum, sums) = local.of(width);
            gather(layout, element, (solution, ones), d);
            sum.fill(0.0);
            add_symmetric::<FUSED>(hessian, d, sum, sums);
            let equalities = layout.equalities_of(element).map(|row| layout.steps() + row);
            let equalities = equalities.zip(jacobian.entries().chunks_exact(width.max(1)));
            let rows =
                equalities.chain(kept.rows.iter().copied().zip(kept.entries.chunks_exact(width.max(1))));
            add_all_rows::<FUSED>(rows.clone().map(|(row, entries)| (entries, solution[row])), sum);
            scatter(layout, element, sum, (residual, ones));
            for (row, entries) in rows {
                residual[row] += entries.iter().zip(&*d).map(|(entry, d)| entry * d).sum::<f64>();
            }
        }
        residual.iter_mut().for_each(|entry| *entry = -*entry);
    }
}
