//! The Newton step of the barrier problem.
//!
//! $$ \begin{pmatrix} W & & C^T & G^T \\\\ & \Sigma & & -1 \\\\ C & & & \\\\ G & -1 & & \end{pmatrix}
//! \begin{pmatrix} d_x \\\\ d_s \\\\ d_y \\\\ d_v \end{pmatrix} = b, \qquad
//! \Sigma = \frac{z_l}{s - l} + \frac{z_u}{u - s} $$
//!
//! The steps of slacks and of their multipliers are eliminated,
//!
//! $$ d_s = G d_x - b_g, \qquad d_v = \Sigma d_s - b_s, \qquad (W + G^T \Sigma G) d_x + C^T d_y = b_x + G^T
//! (\Sigma b_g + b_s), \qquad C d_x = b_c, $$
//!
//! and the rest is factored from stage to stage. Residuals are those of the whole system: it is refined until
//! they are small.

use crate::blocks::{Block, Blocks, Dense};
use crate::elements::{add_symmetric, add_transposed, gather, room, scatter, squares, times};
use crate::iterate::{Bounds, Iterate, Residuals, Step};
use crate::kkt::{Chain, Inertia};
use crate::layout::Layout;
use costate_numerics::in_widest;

/// How W is made positive definite where the equations leave it free.
///
/// Source: Waechter and Biegler 2006, algorithm IC.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegularisationSettings {
    /// First value.
    pub first: f64,
    /// Least value.
    pub least: f64,
    /// Beyond it the step is given up.
    pub largest: f64,
    /// Factor of the last value that worked, for the next trial.
    pub decrease: f64,
    /// Factor while the inertia is wrong; the second one before any value has worked.
    pub increase: [f64; 2],
}

impl Default for RegularisationSettings {
    fn default() -> Self {
        Self { first: 1e-4, least: 1e-20, largest: 1e40, decrease: 1.0 / 3.0, increase: [8.0, 100.0] }
    }
}

/// Most steps of iterative refinement, and the relative residual that ends it: as IPOPT.
const REFINEMENTS: usize = 10;
const REFINED: f64 = 1e-10;

/// Why there is no step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NoStep {
    /// No regularisation gives the right inertia.
    Inertia,
    /// The step or a block is not finite.
    NotFinite,
}

/// Workspace.
#[derive(Clone, Debug)]
pub(crate) struct Newton {
    chain: Chain,
    /// `W + G' Sigma G` by element.
    hessians: Vec<Dense>,
    /// Sigma.
    weights: Vec<f64>,
    /// Added to the diagonal of W, and zeros.
    diagonal: Vec<f64>,
    settings: RegularisationSettings,
    /// The regularisation that worked last, and the one in use.
    remembered: f64,
    regularisation: f64,
    right: Residuals,
    residual: Residuals,
    correction: Step,
    rows: Vec<f64>,
    condensed: Vec<f64>,
    /// Entries of one element.
    local: [Vec<f64>; 2],
}

impl Newton {
    pub fn new(layout: &Layout, settings: RegularisationSettings) -> Self {
        Self {
            chain: Chain::new(layout),
            hessians: squares(layout),
            weights: vec![0.0; layout.ranges()],
            diagonal: vec![0.0; layout.steps() + layout.equalities()],
            settings,
            remembered: 0.0,
            regularisation: 0.0,
            right: Residuals::zeros(layout),
            residual: Residuals::zeros(layout),
            correction: Step::zeros(layout),
            rows: vec![0.0; layout.ranges()],
            condensed: vec![0.0; layout.steps() + layout.equalities()],
            local: room(layout),
        }
    }

    /// Forgets the regularisation of another solution.
    pub fn forget(&mut self) {
        self.remembered = 0.0;
    }

    /// What was added to the diagonal of W last.
    pub fn regularisation(&self) -> f64 {
        self.regularisation
    }

    /// Equations that depend on others, by the last factorisation.
    pub fn dependent(&self, layout: &Layout) -> impl Iterator<Item = usize> {
        let steps = layout.steps();
        self.chain.zeros().iter().filter_map(move |row| row.checked_sub(steps))
    }

    /// Factors the matrix at an iterate, with the regularisation that its inertia asks for.
    pub fn factorise(
        &mut self,
        layout: &Layout,
        (iterate, bounds): (&Iterate, &Bounds),
        blocks: &Blocks,
    ) -> Result<(), NoStep> {
        let [lower, upper] = &iterate.z;
        for (i, weight) in self.weights.iter_mut().enumerate() {
            let [below, above] = bounds.gaps(&iterate.slacks, i);
            // An infinite gap has no multiplier.
            *weight = lower[i] / below + upper[i] / above;
        }
        self.condense(layout, blocks);
        let RegularisationSettings { first, least, largest, decrease, increase: [factor, first_factor] } =
            self.settings;
        let mut delta = 0.0;
        loop {
            self.diagonal[..layout.steps()].fill(delta);
            let jacobian = |element: usize| &blocks.all()[element].equalities;
            let inertia = self.chain.factorise(&self.hessians, jacobian, &self.diagonal);
            if self.is_right(layout, inertia) {
                break;
            }
            delta = match (delta == 0.0, self.remembered == 0.0) {
                (true, true) => first,
                (true, false) => (decrease * self.remembered).max(least),
                (false, true) => first_factor * delta,
                (false, false) => factor * delta,
            };
            if delta > largest {
                return Err(NoStep::Inertia);
            }
        }
        self.regularisation = delta;
        if delta > 0.0 {
            self.remembered = delta;
        }
        Ok(())
    }

    /// Least-squares multipliers y for these slopes of the Lagrangian without y, in `step.y`: those of
    /// `(1, C'; C, 0) (d; y) = (-slopes; 0)`.
    pub fn estimate(&mut self, layout: &Layout, blocks: &Blocks, slopes: &[f64], step: &mut Step) {
        self.hessians.iter_mut().for_each(|hessian| hessian.entries_mut().fill(0.0));
        self.diagonal[..layout.steps()].fill(1.0);
        let jacobian = |element: usize| &blocks.all()[element].equalities;
        self.chain.factorise(&self.hessians, jacobian, &self.diagonal);
        let n = layout.steps();
        self.condensed[..n].iter_mut().zip(slopes).for_each(|(to, slope)| *to = -slope);
        self.condensed[n..].fill(0.0);
        self.chain.solve(&mut self.condensed);
        step.y.copy_from_slice(&self.condensed[n..]);
    }

    /// As many positive eigenvalues as unknowns; the others belong to equations, zeros to those that depend
    /// on others.
    fn is_right(&self, layout: &Layout, Inertia { positive, negative, zero }: Inertia) -> bool {
        positive == layout.steps()
            && negative + zero == layout.equalities()
            && self.chain.zeros().iter().all(|&row| row >= layout.steps())
    }

    /// `W + G' Sigma G`, upper triangles.
    fn condense(&mut self, layout: &Layout, blocks: &Blocks) {
        for ((element, block), hessian) in layout.elements().zip(blocks.all()).zip(&mut self.hessians) {
            hessian.entries_mut().copy_from_slice(block.hessian.entries());
            let weights = &self.weights[layout.ranges_of(element)];
            in_widest!(add_squares(hessian, weights, &block.ranges));
        }
    }

    /// The Newton step for these right-hand sides `b_x = -residuals.x`, .., and for mu that of z:
    /// `d_z = mu / (s - l) - z - z / (s - l) d_s`.
    pub fn step(
        &mut self,
        layout: &Layout,
        (iterate, bounds): (&Iterate, &Bounds),
        blocks: &Blocks,
        (residuals, mu): (&Residuals, f64),
        step: &mut Step,
    ) -> Result<(), NoStep> {
        self.solve(layout, blocks, residuals, step);
        let [lower, upper] = &iterate.z;
        let [to_lower, to_upper] = &mut step.z;
        for i in 0..lower.len() {
            let [below, above] = bounds.gaps(&iterate.slacks, i);
            let ds = step.slacks[i];
            to_lower[i] = (mu - lower[i] * ds) / below - lower[i];
            to_upper[i] = (mu + upper[i] * ds) / above - upper[i];
        }
        if step.is_finite() { Ok(()) } else { Err(NoStep::NotFinite) }
    }

    /// The step of x, slacks, y and v, refined.
    fn solve(&mut self, layout: &Layout, blocks: &Blocks, residuals: &Residuals, step: &mut Step) {
        let mut right = std::mem::take(&mut self.right);
        right.copy_negative(residuals);
        self.solve_once(layout, blocks, &right, step);
        let size = right.largest();
        let (mut residual, mut correction) =
            (std::mem::take(&mut self.residual), std::mem::take(&mut self.correction));
        let mut before = f64::INFINITY;
        for round in 0..=REFINEMENTS {
            self.residual_of(layout, blocks, (&right, step), &mut residual);
            let error = residual.largest();
            if round > 0 && error >= before {
                step.subtract(&correction);
                break;
            }
            // Residuals that do not fall any more are rounding.
            let goes_on = error > REFINED * size && error < 0.5 * before && round < REFINEMENTS;
            if !goes_on {
                break;
            }
            before = error;
            self.solve_once(layout, blocks, &residual, &mut correction);
            step.add(&correction);
        }
        (self.residual, self.correction) = (residual, correction);
        self.right = right;
    }

    /// Without refinement.
    fn solve_once(&mut self, layout: &Layout, blocks: &Blocks, right: &Residuals, step: &mut Step) {
        let Self { chain, weights, condensed, rows, local, .. } = self;
        let n = layout.steps();
        condensed[..n].copy_from_slice(&right.x);
        condensed[n..].copy_from_slice(&right.equalities);
        for (i, row) in rows.iter_mut().enumerate() {
            *row = weights[i].mul_add(right.ranges[i], right.slacks[i]);
        }
        for (element, block) in layout.elements().zip(blocks.all()) {
            let own = layout.ranges_of(element);
            if !own.is_empty() {
                let [_, sum] = local_of(local, block);
                sum.fill(0.0);
                add_transposed(&block.ranges, &rows[own], sum);
                scatter(layout, element, sum, condensed);
            }
        }
        chain.solve(condensed);
        step.x.copy_from_slice(&condensed[..n]);
        step.y.copy_from_slice(&condensed[n..]);
        for (element, block) in layout.elements().zip(blocks.all()) {
            let own = layout.ranges_of(element);
            if !own.is_empty() {
                let [d, _] = local_of(local, block);
                gather(layout, element, &step.x, d);
                times(&block.ranges, d, &mut step.slacks[own]);
            }
        }
        for (i, weight) in weights.iter().enumerate() {
            step.slacks[i] -= right.ranges[i];
            step.v[i] = weight * step.slacks[i] - right.slacks[i];
        }
    }

    /// `b - K d`.
    fn residual_of(
        &mut self,
        layout: &Layout,
        blocks: &Blocks,
        (right, step): (&Residuals, &Step),
        to: &mut Residuals,
    ) {
        let is_dependent = |row: usize| self.chain.zeros().contains(&(layout.steps() + row));
        for (i, entry) in to.x.iter_mut().enumerate() {
            *entry = right.x[i] - self.diagonal[i] * step.x[i];
        }
        let mut local = std::mem::take(&mut self.local);
        for (element, block) in layout.elements().zip(blocks.all()) {
            let [d, sum] = local_of(&mut local, block);
            gather(layout, element, &step.x, d);
            sum.fill(0.0);
            add_symmetric(&block.hessian, d, sum);
            let (equalities, ranges) = (layout.equalities_of(element), layout.ranges_of(element));
            add_transposed(&block.equalities, &step.y[equalities.clone()], sum);
            add_transposed(&block.ranges, &step.v[ranges.clone()], sum);
            sum.iter_mut().for_each(|entry| *entry = -*entry);
            scatter(layout, element, sum, &mut to.x);
            times(&block.equalities, d, &mut to.equalities[equalities.clone()]);
            for row in equalities {
                // What depends on others and contradicts them cannot be met.
                let residual = right.equalities[row] - to.equalities[row];
                to.equalities[row] = if is_dependent(row) { 0.0 } else { residual };
            }
            times(&block.ranges, d, &mut to.ranges[ranges.clone()]);
            for row in ranges {
                to.ranges[row] = right.ranges[row] - (to.ranges[row] - step.slacks[row]);
            }
        }
        self.local = local;
        for i in 0..step.slacks.len() {
            to.slacks[i] = right.slacks[i] - (self.weights[i] * step.slacks[i] - step.v[i]);
        }
    }
}

/// Room for the entries of an element, twice.
fn local_of<'a>([first, second]: &'a mut [Vec<f64>; 2], block: &Block) -> [&'a mut [f64]; 2] {
    let width = block.gradient.len();
    [&mut first[..width], &mut second[..width]]
}

/// Rows of ranges that are added to a Hessian at once.
const ROWS: usize = 4;

/// Adds `G' Sigma G` to the upper triangle, some rows at a time.
#[inline(always)]
fn add_squares<const FUSED: bool>(hessian: &mut Dense, weights: &[f64], rows: &Dense) {
    for (block, weights) in weights.chunks(ROWS).enumerate() {
        // The last block repeats its first row, with weights of zero.
        let row = |r: usize| rows.row(ROWS * block + if r < weights.len() { r } else { 0 });
        let all: [&[f64]; ROWS] = std::array::from_fn(row);
        for i in 0..rows.columns() {
            let factors: [f64; ROWS] =
                std::array::from_fn(|r| weights.get(r).map_or(0.0, |weight| weight * all[r][i]));
            // Limits of one unknown have few entries.
            if factors == [0.0; ROWS] {
                continue;
            }
            let to = &mut hessian.row_mut(i)[i..];
            let from = all.map(|row| &row[i..][..to.len()]);
            for (j, to) in to.iter_mut().enumerate() {
                for r in 0..ROWS {
                    *to = if FUSED {
                        factors[r].mul_add(from[r][j], *to)
                    } else {
                        factors[r] * from[r][j] + *to
                    };
                }
            }
        }
    }
}
