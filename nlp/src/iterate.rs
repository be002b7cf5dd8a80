//! A point with its slacks and multipliers, and how far it is from the conditions of optimality.

use crate::blocks::{Blocks, Values};
use crate::elements::{Room, add_transposed, scatter};
use crate::layout::Layout;
use crate::scales::Scales;
use crate::vectors::{
    largest, largest_of, product, sum_of, sum_of_differences, sum_of_logarithms, sum_of_sizes, worse,
};
use costate_numerics::in_widest;

/// An iterate of
///
/// $$ \min f(z) - \mu \sum \ln (s - l) - \mu \sum \ln (u - s) \quad \text{subject to} \quad c(z) = 0, \quad
/// g(z) - s = 0 $$
///
/// with multipliers y of c, v of g - s, and z_l, z_u of the bounds of s. The gaps s - l and u - s are kept
/// beside s: close to a bound they are far smaller than the last digit of s.
#[derive(Clone, Debug)]
pub(crate) struct Iterate {
    pub point: Vec<f64>,
    pub slacks: Vec<f64>,
    /// Infinite where there is no bound.
    pub gaps: [Vec<f64>; 2],
    pub y: Vec<f64>,
    pub v: Vec<f64>,
    pub z: [Vec<f64>; 2],
    pub values: Values,
}

/// Bounds of the slacks, infinite where there is none.
#[derive(Clone, Debug)]
pub(crate) struct Bounds {
    pub lower: Vec<f64>,
    pub upper: Vec<f64>,
}

/// A displacement of an iterate.
#[derive(Clone, Debug, Default)]
pub(crate) struct Step {
    pub x: Vec<f64>,
    pub slacks: Vec<f64>,
    pub y: Vec<f64>,
    pub v: Vec<f64>,
    pub z: [Vec<f64>; 2],
}

/// Residuals of the conditions of optimality.
#[derive(Clone, Debug, Default)]
pub(crate) struct Residuals {
    /// `grad f + C'y + G'v`.
    pub x: Vec<f64>,
    /// `-v - z_l + z_u`, or with `mu / (s - l)` in place of z.
    pub slacks: Vec<f64>,
    /// c.
    pub equalities: Vec<f64>,
    /// `g - s`.
    pub ranges: Vec<f64>,
}

/// The largest parts of the conditions of optimality, scaled as in IPOPT (Waechter and Biegler 2006, eq.
/// (5)).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KktError {
    /// Of the gradient of the Lagrangian.
    pub stationarity: f64,
    /// Of the equations, and of functions beside their slacks.
    pub feasibility: f64,
    /// Of the products of slacks and multipliers, beside mu.
    pub complementarity: f64,
}

impl KktError {
    /// The largest of them.
    pub fn largest(&self) -> f64 {
        let Self { stationarity, feasibility, complementarity } = *self;
        [stationarity, feasibility, complementarity].into_iter().fold(0.0, worse)
    }
}

/// Above this mean of the multipliers, errors are relative to it: s_max of IPOPT (Waechter and Biegler 2006,
/// section 2.1).
const LARGE_MULTIPLIERS: f64 = 100.0;

impl Bounds {
    /// The bounds of rows whose range has no interior are moved apart by this, relative to their size.
    ///
    /// IPOPT's bound_relax_factor.
    const RELAXATION: f64 = 1e-8;

    /// Room for those of so many rows.
    pub fn new(rows: usize) -> Self {
        Self { lower: vec![0.0; rows], upper: vec![0.0; rows] }
    }

    /// Takes the bounds and sizes of another program with the same layout.
    pub fn take(&mut self, [lower, upper]: [&[f64]; 2], scales: &Scales) {
        let bounds = self.lower.iter_mut().zip(&mut self.upper).zip(lower.iter().zip(upper));
        for (((l, u), (lower, upper)), scale) in bounds.zip(&scales.ranges) {
            (*l, *u) = (lower / scale, upper / scale);
            let room = Self::RELAXATION * l.abs().max(u.abs()).max(1.0);
            if *u - *l < 2.0 * room {
                (*l, *u) = (*l - room, *u + room);
            }
        }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.lower.iter().chain(&self.upper).filter(|bound| bound.is_finite()).count()
    }

    /// How far the slack of row i is from its bounds, where that is known up to its rounding.
    #[inline(always)]
    pub fn gaps(&self, slack: f64, i: usize) -> [f64; 2] {
        let (lower, upper) = (self.lower[i], self.upper[i]);
        [(slack - lower, lower), (upper - slack, upper)].map(|(gap, bound)| match gap < f64::INFINITY {
            true => gap.max(f64::EPSILON * bound.abs().max(1.0)),
            false => f64::INFINITY,
        })
    }
}

/// Multipliers of bounds with these gaps on the central path.
#[inline(always)]
pub(crate) fn central(gaps: [f64; 2], mu: f64) -> [f64; 2] {
    gaps.map(|gap| if gap.is_finite() { mu / gap } else { 0.0 })
}

impl Step {
    pub fn zeros(layout: &Layout) -> Self {
        let ranges = vec![0.0; layout.ranges()];
        Self {
            x: vec![0.0; layout.steps()],
            slacks: ranges.clone(),
            y: vec![0.0; layout.equalities()],
            v: ranges.clone(),
            z: [ranges.clone(), ranges],
        }
    }

    /// Adds those of x, slacks, y and v.
    pub fn add(&mut self, other: &Self) {
        self.add_multiple(1.0, other);
    }

    /// Takes a step that was added out again.
    pub fn subtract(&mut self, other: &Self) {
        self.add_multiple(-1.0, other);
    }

    fn add_multiple(&mut self, factor: f64, other: &Self) {
        let Self { x, slacks, y, v, .. } = self;
        for (to, from) in [x, slacks, y, v].into_iter().zip([&other.x, &other.slacks, &other.y, &other.v]) {
            to.iter_mut().zip(from).for_each(|(to, from)| *to += factor * from);
        }
    }

    /// Whether all entries are finite.
    pub fn is_finite(&self) -> bool {
        let Self { x, slacks, y, v, z: [lower, upper] } = self;
        [x, slacks, y, v, lower, upper].into_iter().all(|entries| largest(entries).is_finite())
    }
}

impl Residuals {
    pub fn zeros(layout: &Layout) -> Self {
        let ranges = vec![0.0; layout.ranges()];
        Self {
            x: vec![0.0; layout.steps()],
            slacks: ranges.clone(),
            equalities: vec![0.0; layout.equalities()],
            ranges,
        }
    }

    pub fn copy_from(&mut self, other: &Self) {
        let Self { x, slacks, equalities, ranges } = self;
        let from = [&other.x, &other.slacks, &other.equalities, &other.ranges];
        for (to, from) in [x, slacks, equalities, ranges].into_iter().zip(from) {
            to.copy_from_slice(from);
        }
    }

    pub fn copy_negative(&mut self, other: &Self) {
        let Self { x, slacks, equalities, ranges } = self;
        let from = [&other.x, &other.slacks, &other.equalities, &other.ranges];
        for (to, from) in [x, slacks, equalities, ranges].into_iter().zip(from) {
            to.iter_mut().zip(from).for_each(|(to, from)| *to = -from);
        }
    }

    /// `d' (W + G' Sigma G) d` of the step d that solves with these residuals, whose slacks are those of the
    /// barrier.
    pub fn decrement(&self, step: &Step) -> f64 {
        product(&self.equalities, &step.y) + product(&self.ranges, &step.v)
            - product(&self.x, &step.x)
            - product(&self.slacks, &step.slacks)
    }

    /// The largest entry.
    pub fn largest(&self) -> f64 {
        let Self { x, slacks, equalities, ranges } = self;
        [x, slacks, equalities, ranges].into_iter().fold(0.0, |most, part| worse(most, largest(part)))
    }
}

impl Iterate {
    pub fn new(layout: &Layout, point_len: usize) -> Self {
        let ranges = vec![0.0; layout.ranges()];
        Self {
            point: vec![0.0; point_len],
            slacks: ranges.clone(),
            gaps: [ranges.clone(), ranges.clone()],
            y: vec![0.0; layout.equalities()],
            v: ranges.clone(),
            z: [ranges.clone(), ranges],
            values: Values::new(layout),
        }
    }

    /// `sum |c| + sum |g - s|`.
    pub fn violation(&self) -> f64 {
        sum_of_sizes(&self.values.equalities) + sum_of_differences(&self.values.ranges, &self.slacks)
    }

    /// The sum of the logarithms of distances to bounds.
    pub fn logarithms(&self) -> f64 {
        self.gaps.iter().map(|gaps| sum_of_logarithms(gaps)).sum()
    }

    /// Sets slacks, and their gaps to the bound that is farther, by those to the one that is nearer: after
    /// many steps they would not belong to each other any more.
    pub fn settle(&mut self, bounds: &Bounds) {
        in_widest!(self.settle_entries(bounds));
    }

    #[inline(always)]
    fn settle_entries<const FUSED: bool>(&mut self, Bounds { lower, upper }: &Bounds) {
        let [below, above] = &mut self.gaps;
        let gaps = self.slacks.iter_mut().zip(below.iter_mut().zip(above));
        for ((slack, (below, above)), (lower, upper)) in gaps.zip(lower.iter().zip(upper)) {
            if *below <= *above && *below < f64::INFINITY {
                *slack = lower + *below;
                *above = upper - *slack;
            } else if *above < *below {
                *slack = upper - *above;
                *below = *slack - lower;
            }
        }
    }

    /// Residuals at the derivatives of this iterate, whose patterns are noted; those of slacks are
    /// `-v - z_l + z_u`.
    pub fn residuals(&self, layout: &Layout, blocks: &mut Blocks, room: &mut Room, to: &mut Residuals) {
        in_widest!(self.set_residuals(layout, blocks, room, to));
    }

    #[inline(always)]
    fn set_residuals<const FUSED: bool>(
        &self,
        layout: &Layout,
        blocks: &mut Blocks,
        room: &mut Room,
        to: &mut Residuals,
    ) {
        to.x.fill(0.0);
        let (blocks, units) = blocks.parts();
        for (element, block) in layout.elements().zip(blocks) {
            // Read here for the first time.
            block.set_patterns();
            let (y, v) = (&self.y[layout.equalities_of(element)], &self.v[layout.ranges_of(element)]);
            let [equalities, ranges] = units.jacobians(layout, element, block);
            let (slope, ..) = room.of(block.gradient.len());
            slope.iter_mut().zip(&block.gradient).for_each(|(to, slope)| *to = units.cost * slope);
            add_transposed::<FUSED>(equalities, y, slope);
            add_transposed::<FUSED>(ranges, v, slope);
            scatter(layout, element, slope, (&mut to.x, &units.steps));
        }
        to.equalities.copy_from_slice(&self.values.equalities);
        let [lower, upper] = &self.z;
        let values = self.values.ranges.iter().zip(&self.slacks);
        to.ranges.iter_mut().zip(values).for_each(|(to, (value, slack))| *to = value - slack);
        let multipliers = lower.iter().zip(upper).zip(&self.v);
        to.slacks.iter_mut().zip(multipliers).for_each(|(to, ((lower, upper), v))| *to = upper - lower - v);
    }

    /// The sum of all products of distances to bounds and their multipliers.
    pub fn gap(&self) -> f64 {
        in_widest!(self.sum_of_products())
    }

    #[inline(always)]
    fn sum_of_products<const FUSED: bool>(&self) -> f64 {
        let product = |gap: f64, z: f64| if gap < f64::INFINITY { gap * z } else { 0.0 };
        let ([below, above], [lower, upper]) = (&self.gaps, &self.z);
        sum_of([below, above, lower, upper], |[below, above, lower, upper]| {
            product(below, lower) + product(above, upper)
        })
    }

    /// The same after these parts of a step, of slacks and of multipliers.
    pub fn gap_after(&self, step: &Step, parts: [f64; 2]) -> f64 {
        in_widest!(self.sum_of_products_after(step, parts))
    }

    #[inline(always)]
    fn sum_of_products_after<const FUSED: bool>(
        &self,
        step: &Step,
        [of_slacks, of_multipliers]: [f64; 2],
    ) -> f64 {
        let product = |gap: f64, z: f64| if gap < f64::INFINITY { gap * z } else { 0.0 };
        let ([below, above], [lower, upper], [to_lower, to_upper]) = (&self.gaps, &self.z, &step.z);
        sum_of(
            [below, above, &step.slacks, lower, to_lower, upper, to_upper],
            |[below, above, d, lower, to_lower, upper, to_upper]| {
                product(below + of_slacks * d, lower + of_multipliers * to_lower)
                    + product(above - of_slacks * d, upper + of_multipliers * to_upper)
            },
        )
    }

    /// The error of the conditions of optimality at the barrier parameter mu.
    pub fn error(&self, residuals: &Residuals, mu: f64) -> KktError {
        let sum = self.sum_of_bounds() + sum_of_sizes(&self.y) + sum_of_sizes(&self.v);
        let scale = scale_of(sum, self.y.len() + 3 * self.v.len());
        KktError {
            stationarity: worse(largest(&residuals.x), largest(&residuals.slacks)) / scale,
            feasibility: worse(largest(&residuals.equalities), largest(&residuals.ranges)),
            complementarity: self.complementarity(mu),
        }
    }

    /// The part of the error that depends on mu.
    pub fn complementarity(&self, mu: f64) -> f64 {
        let scale = scale_of(self.sum_of_bounds(), 2 * self.v.len());
        in_widest!(self.largest_product(mu)) / scale
    }

    /// The sum of the multipliers of bounds.
    fn sum_of_bounds(&self) -> f64 {
        let [lower, upper] = &self.z;
        sum_of_sizes(lower) + sum_of_sizes(upper)
    }

    /// The largest of `|gap z - mu|` where there is a bound.
    #[inline(always)]
    fn largest_product<const FUSED: bool>(&self, mu: f64) -> f64 {
        let product = |gap: f64, z: f64| if gap < f64::INFINITY { (gap * z - mu).abs() } else { 0.0 };
        let ([below, above], [lower, upper]) = (&self.gaps, &self.z);
        largest_of([below, above, lower, upper], |[below, above, lower, upper]| {
            worse(product(below, lower), product(above, upper))
        })
    }
}

/// What errors are relative to, by the sum of so many multipliers.
fn scale_of(sum: f64, count: usize) -> f64 {
    let mean = if count > 0 { sum / count as f64 } else { 0.0 };
    mean.max(LARGE_MULTIPLIERS) / LARGE_MULTIPLIERS
}
