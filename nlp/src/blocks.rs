//! Values and derivatives of a staged program, element by element.

use crate::dense::Dense;
use crate::elements::{Jacobian, Pattern};
use crate::layout::{Element, Layout};
use crate::scales::Scales;

/// Cost, equations and functions with ranges at one point.
#[derive(Clone, Debug)]
pub struct Values {
    /// f.
    pub cost: f64,
    /// c, in the order of the elements.
    pub equalities: Vec<f64>,
    /// g, likewise.
    pub ranges: Vec<f64>,
}

impl Values {
    /// Zeros.
    pub fn new(layout: &Layout) -> Self {
        Self { cost: 0.0, equalities: vec![0.0; layout.equalities()], ranges: vec![0.0; layout.ranges()] }
    }

    /// Whether all of them are finite.
    pub fn are_finite(&self) -> bool {
        self.cost.is_finite() && self.equalities.iter().chain(&self.ranges).all(|value| value.is_finite())
    }
}

/// What the functions are multiplied by in the Lagrangian `cost f + equalities . c + ranges . g`.
#[derive(Clone, Copy, Debug)]
pub struct Weights<'a> {
    /// The factor of the cost: its scale's reciprocal, or 0 where feasibility alone is sought.
    pub cost: f64,
    /// Multipliers y of the equations.
    pub equalities: &'a [f64],
    /// Multipliers of the functions with ranges.
    pub ranges: &'a [f64],
}

/// Derivatives of one element by its own unknowns, in the order of [`Layout::unknowns`].
#[derive(Clone, Debug)]
pub struct Block {
    /// Of its part of the cost, without the factor of [`Weights`].
    pub gradient: Vec<f64>,
    /// Of its part of the Lagrangian. Only the upper triangle is read: entries (i, j) with j >= i.
    pub hessian: Dense,
    /// Jacobian of its equations.
    pub equalities: Dense,
    /// Jacobian of its functions with ranges.
    pub ranges: Dense,
    /// Which rows of both have few entries.
    pub(crate) equality_pattern: Pattern,
    pub(crate) range_pattern: Pattern,
}

/// What derivatives are multiplied by where they are read: those of the program itself become those of the
/// scaled one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Units {
    /// Reciprocal of the scale of the cost; the Hessian has it already.
    pub cost: f64,
    /// Scales of displacements.
    pub steps: Vec<f64>,
    /// Reciprocals of the scales of the equations and of the functions with ranges.
    pub equalities: Vec<f64>,
    pub ranges: Vec<f64>,
}

impl Units {
    pub fn ones(layout: &Layout) -> Self {
        let Scales { cost, steps, equalities, ranges } = Scales::ones(layout);
        Self { cost, steps, equalities, ranges }
    }

    /// Takes those of a program with these scales.
    pub fn take(&mut self, scales: &Scales) {
        self.cost = scales.cost.recip();
        self.steps.copy_from_slice(&scales.steps);
        let pairs = [(&mut self.equalities, &scales.equalities), (&mut self.ranges, &scales.ranges)];
        for (to, scales) in pairs {
            to.iter_mut().zip(scales).for_each(|(to, scale)| *to = scale.recip());
        }
    }

    pub fn copy_from(&mut self, other: &Self) {
        self.cost = other.cost;
        self.steps.copy_from_slice(&other.steps);
        self.equalities.copy_from_slice(&other.equalities);
        self.ranges.copy_from_slice(&other.ranges);
    }

    /// The Jacobians of an element.
    #[inline(always)]
    pub fn jacobians<'a>(&'a self, layout: &Layout, element: Element, block: &'a Block) -> [Jacobian<'a>; 2] {
        let Block { equalities, equality_pattern, ranges, range_pattern, .. } = block;
        [
            Jacobian {
                rows: equalities,
                pattern: equality_pattern,
                factors: &self.equalities[layout.equalities_of(element)],
            },
            Jacobian {
                rows: ranges,
                pattern: range_pattern,
                factors: &self.ranges[layout.ranges_of(element)],
            },
        ]
    }
}

impl Block {
    /// Notes which rows of Jacobians have few entries other than zero.
    #[inline(always)]
    pub(crate) fn set_patterns(&mut self) {
        self.equality_pattern.set(&self.equalities);
        self.range_pattern.set(&self.ranges);
    }
}

/// The derivatives of all elements.
#[derive(Clone, Debug)]
pub struct Blocks {
    blocks: Vec<Block>,
    intervals: usize,
    pub(crate) units: Units,
}

impl Blocks {
    /// Zeros.
    pub fn new(layout: &Layout) -> Self {
        let block = |element| {
            let (width, rows) = (layout.width(element), layout.rows(element));
            Block {
                gradient: vec![0.0; width],
                hessian: Dense::zeros(width, width),
                equalities: Dense::zeros(rows.equalities, width),
                ranges: Dense::zeros(rows.ranges, width),
                equality_pattern: Pattern::with_room(rows.equalities, width),
                range_pattern: Pattern::with_room(rows.ranges, width),
            }
        };
        let units = Units::ones(layout);
        Self { blocks: layout.elements().map(block).collect(), intervals: layout.intervals(), units }
    }

    /// The block of an element, to be filled. It holds zeros when
    /// [`linearise`](crate::StagedProblem::linearise) begins.
    pub fn of(&mut self, element: Element) -> &mut Block {
        let at = match element {
            Element::Node(k) => 2 * k,
            Element::Interval(k) => 2 * k + 1,
            Element::Ends => 2 * self.intervals + 1,
        };
        &mut self.blocks[at]
    }

    /// All blocks, in the order of the elements.
    pub(crate) fn all(&self) -> &[Block] {
        &self.blocks
    }

    /// The same, to change, and their units.
    pub(crate) fn parts(&mut self) -> (&mut [Block], &Units) {
        (&mut self.blocks, &self.units)
    }

    /// Fills the Hessians with zeros.
    pub fn clear_hessians(&mut self) {
        self.blocks.iter_mut().for_each(|block| block.hessian.entries_mut().fill(0.0));
    }

    pub(crate) fn fill_zero(&mut self) {
        for Block { gradient, hessian, equalities, ranges, .. } in &mut self.blocks {
            gradient.fill(0.0);
            [hessian, equalities, ranges].into_iter().for_each(|matrix| matrix.entries_mut().fill(0.0));
        }
    }
}
