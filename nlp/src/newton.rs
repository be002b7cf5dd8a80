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
//! and the rest is factored from stage to stage. Of ranges whose Sigma is large beside W the steps of
//! multipliers stay,
//!
//! $$ G d_x - \Sigma^{-1} d_v = b_g + \Sigma^{-1} b_s. $$
//!
//! Residuals are those of the whole system: it is refined until they are small.

use crate::blocks::Blocks;
use crate::centrality::Targets;
use crate::condense::{Condensed, number};
use crate::convex::{Convex, ConvexSettings};
use crate::elements::{Room, add_symmetric, add_transposed, gather, scatter, times};
use crate::iterate::{Iterate, Residuals, Step};
use crate::kkt::{Chain, Inertia, Kept};
use crate::layout::Layout;
use crate::problem::StagedProblem;
use crate::scaled::Scaled;
use crate::tiles::fused;
use costate_numerics::in_widest;
use std::ops::Range;

/// How W is made positive definite where the equations leave it free: by multiples of a metric
/// ([`StagedProblem::add_metric`](crate::StagedProblem::add_metric)).
///
/// Source: Waechter and Biegler 2006, algorithm IC, whose first factor is 100: with it first steps of motions
/// are far shorter than they need to be.
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
        Self { first: 1e-4, least: 1e-20, largest: 1e40, decrease: 1.0 / 3.0, increase: [8.0, 10.0] }
    }
}

/// Most steps of iterative refinement, as in IPOPT.
const REFINEMENTS: usize = 10;

/// The relative residual of a step that ends it. Steps of Newton's method need no more: what is left of the
/// conditions falls by this factor too.
const REFINED: f64 = 1e-6;

/// Why there is no step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NoStep {
    /// No regularisation gives the right inertia.
    Inertia,
    /// The step or a block is not finite.
    NotFinite,
}

/// How exactly a step solves its equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Accuracy {
    /// As the factors do.
    Rough,
    /// Refined by the residual of the whole system.
    Refined,
}

/// Workspace.
#[derive(Clone, Debug)]
pub(crate) struct Newton {
    chain: Chain,
    condensed: Condensed,
    /// Sigma, and the reciprocals of the gaps of slacks.
    weights: Vec<f64>,
    reciprocals: [Vec<f64>; 2],
    /// Zeros, but for the estimate of multipliers.
    diagonal: Vec<f64>,
    settings: RegularisationSettings,
    /// The regularisation that worked last, and the one in use.
    remembered: f64,
    regularisation: f64,
    /// Whether a convex Hessian is in the place of W.
    is_convexified: bool,
    convex: Convex,
    right: Residuals,
    residual: Residuals,
    correction: Step,
    rows: Vec<f64>,
    /// Right-hand side and solution of the condensed equations.
    solution: Vec<f64>,
    local: Room,
}

impl Newton {
    pub fn new(layout: &Layout, settings: RegularisationSettings) -> Self {
        Self {
            chain: Chain::new(
                layout,
                |element| Condensed::most_kept(layout, element),
                layout.equalities() > 0,
            ),
            condensed: Condensed::new(layout, |element| Condensed::most_kept(layout, element)),
            weights: vec![0.0; layout.ranges()],
            reciprocals: [vec![0.0; layout.ranges()], vec![0.0; layout.ranges()]],
            diagonal: vec![0.0; layout.steps() + layout.equalities()],
            settings,
            remembered: 0.0,
            regularisation: 0.0,
            is_convexified: false,
            convex: Convex::default(),
            right: Residuals::zeros(layout),
            residual: Residuals::zeros(layout),
            correction: Step::zeros(layout),
            rows: vec![0.0; layout.ranges()],
            solution: vec![0.0; layout.steps() + layout.equalities() + layout.ranges()],
            local: Room::new(layout),
        }
    }

    /// Begins another solution with these settings.
    pub fn restart(&mut self, settings: RegularisationSettings, convex: ConvexSettings) {
        (self.settings, self.remembered) = (settings, 0.0);
        self.convex.restart(convex);
    }

    /// The multiple of the metric that was added to W last.
    pub fn regularisation(&self) -> f64 {
        self.regularisation
    }

    /// Whether W was the exact Hessian, and nothing added to it.
    pub fn is_exact(&self) -> bool {
        !self.is_convexified && self.regularisation == 0.0
    }

    /// Equations that depend on others, by the last factorisation.
    pub fn dependent(&self, layout: &Layout) -> impl Iterator<Item = usize> {
        let steps = layout.steps();
        let rows = self.chain.zeros().iter().filter_map(move |row| row.checked_sub(steps));
        rows.filter(|row| *row < layout.equalities())
    }

    /// Factors the matrix at an iterate. Where its inertia is wrong, a convex Hessian of the program takes
    /// the place of W, or multiples of its metric are added.
    pub fn factorise<P: StagedProblem>(
        &mut self,
        layout: &Layout,
        iterate: &Iterate,
        blocks: &mut Blocks,
        problem: &mut Scaled<'_, P>,
    ) -> Result<Result<(), NoStep>, P::Error> {
        self.begin(iterate);
        let (point, mut may_be_convex) = (&iterate.point, true);
        while !self.factorise_once(layout, blocks) {
            let tries_convex = std::mem::take(&mut may_be_convex) && self.convex.may_begin();
            let more = if tries_convex && problem.convexify(point, 1.0, blocks)? {
                self.is_convexified = true;
                self.regularisation = self.convex.begin().min(self.settings.largest);
                self.regularisation
            } else {
                match self.regularise() {
                    Ok(more) => more,
                    Err(no_step) => return Ok(Err(no_step)),
                }
            };
            if more > 0.0 {
                problem.add_metric(point, more, blocks)?;
            }
        }
        Ok(Ok(()))
    }

    /// Takes note of the part of the longest step that was accepted.
    pub fn adapt(&mut self, part: f64) {
        if self.is_convexified {
            self.convex.adapt(self.regularisation, part);
        }
    }

    /// Begins without regularisation.
    fn begin(&mut self, iterate: &Iterate) {
        in_widest!(self.set_weights(iterate));
        (self.regularisation, self.is_convexified) = (0.0, false);
    }

    /// Factors; whether the inertia is right.
    fn factorise_once(&mut self, layout: &Layout, blocks: &Blocks) -> bool {
        self.condensed.set(layout, blocks, &self.weights);
        let rows = layout.equalities() + self.condensed.kept();
        let inertia = self.chain.factorise_unless(self.condensed.matrices(), &self.diagonal, rows);
        let is_right = self.is_right(layout, inertia, rows);
        if is_right && self.regularisation > 0.0 && !self.is_convexified {
            self.remembered = self.regularisation;
        }
        is_right
    }

    /// The next regularisation: how much is added.
    fn regularise(&mut self) -> Result<f64, NoStep> {
        let RegularisationSettings { first, least, largest, decrease, increase: [factor, first_factor] } =
            self.settings;
        let delta = self.regularisation;
        self.regularisation = match (delta == 0.0, self.remembered == 0.0) {
            (true, true) => first,
            (true, false) => (decrease * self.remembered).max(least),
            (false, true) => first_factor * delta,
            (false, false) => factor * delta,
        };
        if self.regularisation > largest { Err(NoStep::Inertia) } else { Ok(self.regularisation - delta) }
    }

    /// Sigma, where an infinite gap has no multiplier.
    #[inline(always)]
    fn set_weights<const FUSED: bool>(&mut self, iterate: &Iterate) {
        let Self { weights, reciprocals: [below, above], .. } = self;
        for (to, gaps) in [&mut *below, above].into_iter().zip(&iterate.gaps) {
            to.iter_mut().zip(gaps).for_each(|(to, gap)| *to = gap.recip());
        }
        let [lower, upper] = &iterate.z;
        let parts = lower.iter().zip(below).zip(upper.iter().zip(above));
        for (weight, ((lower, below), (upper, above))) in weights.iter_mut().zip(parts) {
            *weight = lower * *below + upper * *above;
        }
    }

    /// The reciprocals of the gaps of slacks below and above, at the iterate of the last factorisation.
    pub fn reciprocals(&self) -> &[Vec<f64>; 2] {
        &self.reciprocals
    }

    /// Least-squares multipliers y for these slopes of the Lagrangian without y, in `step.y`: those of
    /// `(1, C'; C, 0) (d; y) = (-slopes; 0)`.
    pub fn estimate(&mut self, layout: &Layout, blocks: &Blocks, slopes: &[f64], step: &mut Step) {
        self.condensed.set_for_ones(layout, blocks);
        self.diagonal[..layout.steps()].fill(1.0);
        self.chain.factorise(self.condensed.matrices(), &self.diagonal);
        self.diagonal.fill(0.0);
        let n = layout.steps();
        self.solution[..n].iter_mut().zip(slopes).for_each(|(to, slope)| *to = -slope);
        self.solution[n..].fill(0.0);
        self.substitute();
        step.y.copy_from_slice(&self.solution[n..n + layout.equalities()]);
    }

    /// As many positive eigenvalues as unknowns; the others belong to rows, zeros to those that depend on
    /// others.
    fn is_right(&self, layout: &Layout, inertia: Inertia, rows: usize) -> bool {
        let Inertia { positive, negative, zero } = inertia;
        positive == layout.steps()
            && negative + zero == rows
            && self.chain.zeros().iter().all(|&row| row >= layout.steps())
    }

    /// The Newton step for these right-hand sides `b_x = -residuals.x`, .., and for products t of both sides
    /// that of z: `d_z = t / (s - l) - z - z / (s - l) d_s`.
    pub fn step(
        &mut self,
        layout: &Layout,
        iterate: &Iterate,
        blocks: &Blocks,
        (residuals, targets): (&Residuals, &Targets),
        (accuracy, step): (Accuracy, &mut Step),
    ) -> Result<(), NoStep> {
        self.solve(layout, blocks, residuals, (accuracy, step));
        self.set_steps_of_multipliers(iterate, targets, step)
    }

    /// The step for other products than those that a step was made for. Only the right-hand sides of slacks
    /// differ, so what is added to that step is as exact as the factors are.
    pub fn corrected_step(
        &mut self,
        layout: &Layout,
        iterate: &Iterate,
        blocks: &Blocks,
        (targets, before): (&Targets, &Targets),
        (step, to): (&Step, &mut Step),
    ) -> Result<(), NoStep> {
        let mut right = std::mem::take(&mut self.right);
        [&mut right.x, &mut right.equalities, &mut right.ranges].into_iter().for_each(|part| part.fill(0.0));
        let [below, above] = &self.reciprocals;
        let sides = below.iter().zip(targets[0].iter().zip(&before[0]));
        let sides = sides.zip(above.iter().zip(targets[1].iter().zip(&before[1])));
        for (to, ((below, (lower, lower_before)), (above, (upper, upper_before)))) in
            right.slacks.iter_mut().zip(sides)
        {
            *to = (lower - lower_before) * below - (upper - upper_before) * above;
        }
        self.solve_condensed(layout, blocks, &right, to);
        in_widest!(self.complete(layout, blocks, (&right, to)));
        self.right = right;
        to.add(step);
        self.set_steps_of_multipliers(iterate, targets, to)
    }

    /// The step of the multipliers of bounds from that of slacks; whether all is finite.
    fn set_steps_of_multipliers(
        &self,
        iterate: &Iterate,
        targets: &Targets,
        step: &mut Step,
    ) -> Result<(), NoStep> {
        let Step { slacks, z, .. } = step;
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            in_widest!(set_multipliers(
                &mut z[side],
                &iterate.z[side],
                &self.reciprocals[side],
                (&targets[side], sign),
                slacks
            ));
        }
        if step.is_finite() { Ok(()) } else { Err(NoStep::NotFinite) }
    }

    /// The step of x, slacks, y and v.
    fn solve(
        &mut self,
        layout: &Layout,
        blocks: &Blocks,
        residuals: &Residuals,
        (accuracy, step): (Accuracy, &mut Step),
    ) {
        let mut right = std::mem::take(&mut self.right);
        right.copy_negative(residuals);
        self.solve_condensed(layout, blocks, &right, step);
        match accuracy {
            Accuracy::Rough => in_widest!(self.complete(layout, blocks, (&right, step))),
            Accuracy::Refined => self.refine(layout, blocks, &right, step),
        }
        self.right = right;
    }

    /// Completes the step that [`solve_condensed`](Self::solve_condensed) has made, and refines it.
    fn refine(&mut self, layout: &Layout, blocks: &Blocks, right: &Residuals, step: &mut Step) {
        let size = right.largest();
        let (mut residual, mut correction) =
            (std::mem::take(&mut self.residual), std::mem::take(&mut self.correction));
        in_widest!(self.set_residual(layout, blocks, (right, step), &mut residual, true));
        let mut before = f64::INFINITY;
        for round in 0..=REFINEMENTS {
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
            self.solve_condensed(layout, blocks, &residual, &mut correction);
            in_widest!(self.complete(layout, blocks, (&residual, &mut correction)));
            step.add(&correction);
            in_widest!(self.set_residual(layout, blocks, (right, step), &mut residual, false));
        }
        (self.residual, self.correction) = (residual, correction);
    }

    /// The step of x and y, and of v of the ranges that are rows.
    fn solve_condensed(&mut self, layout: &Layout, blocks: &Blocks, right: &Residuals, step: &mut Step) {
        in_widest!(self.condense(layout, blocks, right));
        self.substitute();
        let (x, rows) = self.solution.split_at(layout.steps());
        let (y, v) = rows.split_at(layout.equalities());
        step.x.copy_from_slice(x);
        step.y.copy_from_slice(y);
        step.v.copy_from_slice(v);
    }

    /// Solves with the factors of the scaled matrix, in the place of the right-hand side.
    fn substitute(&mut self) {
        let Self { condensed, chain, solution, .. } = self;
        condensed.scale_vector(solution);
        chain.solve(solution);
        condensed.scale_vector(solution);
    }

    /// The right-hand side `b_x + G' (Sigma b_g + b_s)`, b_c, `b_g + Sigma^-1 b_s`.
    #[inline(always)]
    fn condense<const FUSED: bool>(&mut self, layout: &Layout, blocks: &Blocks, right: &Residuals) {
        let Self { weights, condensed, solution, rows, local, .. } = self;
        let (x, y) = solution.split_at_mut(layout.steps());
        let (y, v) = y.split_at_mut(layout.equalities());
        x.copy_from_slice(&right.x);
        y.copy_from_slice(&right.equalities);
        v.fill(0.0);
        for (((row, weight), g), s) in rows.iter_mut().zip(&*weights).zip(&right.ranges).zip(&right.slacks) {
            *row = fused::<FUSED>(*weight, *g, *s);
        }
        for row in condensed.kept.iter().flat_map(|kept| &kept.rows) {
            let range = row - number(layout, 0);
            v[range] = rows[range] / weights[range];
            rows[range] = 0.0;
        }
        for (element, block) in layout.elements().zip(blocks.all()) {
            let own = layout.ranges_of(element);
            if !own.is_empty() {
                let (_, sum, _) = local.of(block.gradient.len());
                sum.fill(0.0);
                let [_, ranges] = blocks.units.jacobians(layout, element, block);
                add_transposed::<FUSED>(ranges, &rows[own], sum);
                scatter(layout, element, sum, (x, &blocks.units.steps));
            }
        }
    }

    /// The step of slacks and v from that of x.
    #[inline(always)]
    fn complete<const FUSED: bool>(
        &mut self,
        layout: &Layout,
        blocks: &Blocks,
        (right, step): (&Residuals, &mut Step),
    ) {
        let Self { weights, condensed, solution, local, .. } = self;
        let multipliers = &solution[number(layout, 0)..];
        for ((element, block), kept) in layout.elements().zip(blocks.all()).zip(&condensed.kept) {
            let own = layout.ranges_of(element);
            if !own.is_empty() {
                let (d, _, sums) = local.of(block.gradient.len());
                gather(layout, element, (&step.x, &blocks.units.steps), d);
                let [_, ranges] = blocks.units.jacobians(layout, element, block);
                times::<FUSED>(ranges, d, &mut step.slacks[own.clone()], sums);
                set_slacks(own, weights, right, step);
                set_kept(layout, kept, (weights, multipliers), right, step);
            }
        }
    }

    /// `b - K d`; `completes`: after the step of slacks and v was set from that of x.
    #[inline(always)]
    fn set_residual<const FUSED: bool>(
        &mut self,
        layout: &Layout,
        blocks: &Blocks,
        (right, step): (&Residuals, &mut Step),
        to: &mut Residuals,
        completes: bool,
    ) {
        let Self { weights, local, chain, condensed, solution, .. } = self;
        let multipliers = &solution[number(layout, 0)..];
        to.x.copy_from_slice(&right.x);
        for ((element, block), kept) in layout.elements().zip(blocks.all()).zip(&condensed.kept) {
            let [equalities, ranges] = blocks.units.jacobians(layout, element, block);
            let (d, sum, sums) = local.of(block.gradient.len());
            gather(layout, element, (&step.x, &blocks.units.steps), d);
            sum.fill(0.0);
            add_symmetric::<FUSED>(&block.hessian, d, sum, sums);
            let own = layout.equalities_of(element);
            if !own.is_empty() {
                add_transposed::<FUSED>(equalities, &step.y[own.clone()], sum);
                let to = &mut to.equalities[own.clone()];
                times::<FUSED>(equalities, d, to, sums);
                to.iter_mut().zip(&right.equalities[own]).for_each(|(to, right)| *to = right - *to);
            }
            let own = layout.ranges_of(element);
            if !own.is_empty() {
                let to = &mut to.ranges[own.clone()];
                times::<FUSED>(ranges, d, to, sums);
                if completes {
                    step.slacks[own.clone()].copy_from_slice(to);
                    set_slacks(own.clone(), weights, right, step);
                    set_kept(layout, kept, (weights, multipliers), right, step);
                }
                for ((to, right), slack) in
                    to.iter_mut().zip(&right.ranges[own.clone()]).zip(&step.slacks[own.clone()])
                {
                    *to = right - (*to - slack);
                }
                add_transposed::<FUSED>(ranges, &step.v[own], sum);
            }
            sum.iter_mut().for_each(|entry| *entry = -*entry);
            scatter(layout, element, sum, (&mut to.x, &blocks.units.steps));
        }
        for ((((to, right), weight), slack), v) in
            to.slacks.iter_mut().zip(&right.slacks).zip(weights).zip(&step.slacks).zip(&step.v)
        {
            *to = right - (*weight * slack - v);
        }
        // What depends on others and contradicts them cannot be met.
        for row in chain.zeros() {
            let Some(row) = row.checked_sub(layout.steps()) else { continue };
            match row.checked_sub(layout.equalities()) {
                None => to.equalities[row] = 0.0,
                Some(range) => to.ranges[range] = 0.0,
            }
        }
    }
}

/// `d_s = G d_x - b_g` and `d_v = Sigma d_s - b_s`, where the first product is in the place of the slacks.
#[inline(always)]
fn set_slacks(own: Range<usize>, weights: &[f64], right: &Residuals, step: &mut Step) {
    let slacks = step.slacks[own.clone()].iter_mut().zip(&mut step.v[own.clone()]);
    let right = right.ranges[own.clone()].iter().zip(&right.slacks[own.clone()]);
    for (((slack, v), (g, s)), weight) in slacks.zip(right).zip(&weights[own]) {
        *slack -= g;
        *v = weight * *slack - s;
    }
}

/// The same for ranges that are rows, whose steps of multipliers are known: `d_s = Sigma^-1 (d_v + b_s)`.
#[inline(always)]
fn set_kept(
    layout: &Layout,
    kept: &Kept,
    (weights, multipliers): (&[f64], &[f64]),
    right: &Residuals,
    step: &mut Step,
) {
    for range in kept.rows.iter().map(|row| row - number(layout, 0)) {
        step.v[range] = multipliers[range];
        step.slacks[range] = (multipliers[range] + right.slacks[range]) / weights[range];
    }
}

/// `d_z = t / gap - z + sign z / gap d_s` of one side.
#[inline(always)]
fn set_multipliers<const FUSED: bool>(
    to: &mut [f64],
    z: &[f64],
    reciprocals: &[f64],
    (targets, sign): (&[f64], f64),
    slacks: &[f64],
) {
    for ((((to, z), reciprocal), ds), target) in
        to.iter_mut().zip(z).zip(reciprocals).zip(slacks).zip(targets)
    {
        *to = (target + sign * z * ds) * reciprocal - z;
    }
}

#[cfg(test)]
mod tests {
    use super::{Accuracy, Newton, RegularisationSettings};
    use crate::barrier::barrier_residuals;
    use crate::blocks::Blocks;
    use crate::iterate::{Bounds, Iterate, Residuals, Step};
    use crate::layout::{Element, Layout, Rows};

    /// The blocks of a program of one node: random rows, a diagonal Hessian that is positive definite.
    fn random_blocks(layout: &Layout, number: &mut impl FnMut() -> f64) -> Blocks {
        let mut blocks = Blocks::new(layout);
        let units = &mut blocks.units;
        let units = [&mut units.steps, &mut units.equalities, &mut units.ranges];
        units.into_iter().for_each(|units| units.fill(1.0));
        let block = blocks.of(Element::Node(0));
        let rows = [&mut block.equalities, &mut block.ranges];
        rows.into_iter().flat_map(|rows| rows.entries_mut()).for_each(|entry| *entry = number());
        (0..layout.steps()).for_each(|i| block.hessian[(i, i)] = 2.0 + number());
        block.set_patterns();
        blocks
    }

    /// Of two ranges that are held one has a weight of 1e14: its square would leave two digits of W. The step
    /// is compared with that of the whole system, whose entries are all of one size.
    #[test]
    fn steps_are_exact_where_ranges_are_held() {
        let layout = Layout::new(vec![6], vec![], 0).with_rows(Element::Node(0), Rows::new(2, 2));
        let (n, m, p) = (6, 2, 2);
        let mut random = fastrand::Rng::with_seed(9);
        let mut number = || random.f64() - 0.5;
        let blocks = random_blocks(&layout, &mut number);
        let mut iterate = Iterate::new(&layout, n);
        iterate.gaps = [vec![1e-7, 1.0], vec![f64::INFINITY; 2]];
        iterate.z = [vec![1e7, 1e-3], vec![0.0; 2]];
        let mut newton = Newton::new(&layout, RegularisationSettings::default());
        newton.begin(&iterate);
        assert!(newton.factorise_once(&layout, &blocks));
        assert_eq!(newton.condensed.kept(), 1);
        let mut residuals = Residuals::zeros(&layout);
        let parts =
            [&mut residuals.x, &mut residuals.equalities, &mut residuals.slacks, &mut residuals.ranges];
        parts.into_iter().flatten().for_each(|entry| *entry = number());
        let mut step = Step::zeros(&layout);
        newton.solve(&layout, &blocks, &residuals, (Accuracy::Rough, &mut step));
        // Unknowns x, y, v; slacks are `(v + b_s) / Sigma`.
        let (block, size) = (&blocks.all()[0], n + m + p);
        let mut matrix = nalgebra::DMatrix::zeros(size, size);
        for i in 0..n {
            matrix[(i, i)] = block.hessian[(i, i)];
            for (first, rows) in [(n, &block.equalities), (n + m, &block.ranges)] {
                for r in 0..rows.rows() {
                    (matrix[(first + r, i)], matrix[(i, first + r)]) = (rows[(r, i)], rows[(r, i)]);
                }
            }
        }
        let right: Vec<f64> = residuals.x.iter().chain(&residuals.equalities).map(|b| -b).collect();
        let mut right = nalgebra::DVector::from_vec(right).resize_vertically(size, 0.0);
        for r in 0..p {
            let weight = newton.weights[r];
            matrix[(n + m + r, n + m + r)] = -weight.recip();
            right[n + m + r] = -residuals.ranges[r] - residuals.slacks[r] / weight;
        }
        let expected = matrix.lu().solve(&right).unwrap();
        let found = [&step.x[..], &step.y, &step.v].concat();
        let most = expected.amax();
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-11 * most, "{found} {expected}");
        }
        let slack = (step.v[0] - residuals.slacks[0]) / newton.weights[0];
        assert!((step.slacks[0] - slack).abs() <= 1e-15 * slack.abs());
    }

    /// With a regularised matrix too, and a range without an upper bound.
    #[test]
    fn corrected_steps_are_those_for_their_products() {
        let layout = Layout::new(vec![4], vec![], 0).with_rows(Element::Node(0), Rows::new(2, 3));
        let mut random = fastrand::Rng::with_seed(5);
        let mut number = || random.f64() - 0.5;
        let blocks = random_blocks(&layout, &mut number);
        let (mut iterate, mut bounds) = (Iterate::new(&layout, 4), Bounds::new(3));
        (bounds.lower, bounds.upper) = (vec![-1.0; 3], vec![1.0, 2.0, f64::INFINITY]);
        iterate.slacks = vec![0.5, -0.9, 0.2];
        for i in 0..3 {
            [iterate.gaps[0][i], iterate.gaps[1][i]] = bounds.gaps(iterate.slacks[i], i);
        }
        iterate.z = [vec![0.1, 0.7, 0.3], vec![0.4, 0.2, 0.0]];
        iterate.v = vec![0.3, -0.5, -0.3];
        let mut residuals = Residuals::zeros(&layout);
        let parts = [&mut residuals.x, &mut residuals.equalities, &mut residuals.ranges];
        parts.into_iter().flatten().for_each(|entry| *entry = number());
        let before = [vec![0.1; 3], vec![0.1, 0.1, 0.0]];
        let targets = [vec![0.3, 0.1, 0.02], vec![0.05, 0.4, 0.0]];
        for regularisation in [0.0, 1e3] {
            let mut newton = Newton::new(&layout, RegularisationSettings::default());
            newton.begin(&iterate);
            newton.regularisation = regularisation;
            assert!(newton.factorise_once(&layout, &blocks));
            let mut step_for = |targets| {
                let mut step = Step::zeros(&layout);
                barrier_residuals(&iterate, newton.reciprocals(), targets, &mut residuals);
                let to = (Accuracy::Refined, &mut step);
                newton.step(&layout, &iterate, &blocks, (&residuals, targets), to).unwrap();
                step
            };
            let (step, expected) = (step_for(&before), step_for(&targets));
            let mut found = Step::zeros(&layout);
            let pair = (&step, &mut found);
            newton.corrected_step(&layout, &iterate, &blocks, (&targets, &before), pair).unwrap();
            let all = |step: &Step| {
                let Step { x, slacks, y, v, z: [lower, upper] } = step;
                [x, slacks, y, v, lower, upper].into_iter().flatten().copied().collect::<Vec<f64>>()
            };
            let [step, found, expected] = [&step, &found, &expected].map(all);
            let largest = expected.iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
            let off = |other: &[f64]| {
                let pairs = other.iter().zip(&expected);
                pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())) / largest
            };
            assert!(off(&found) < 1e-12 && off(&step) > 1e-2, "{} {}", off(&found), off(&step));
        }
    }
}
