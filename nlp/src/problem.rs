//! What the solver asks of a program.

use crate::blocks::{Blocks, Values, Weights};
use crate::layout::{Element, Layout};
use crate::scales::Scales;
use std::error::Error;
use std::ops::Range;

/// A staged nonlinear program with exact first and second derivatives:
///
/// $$ \min_z f(z) \quad \text{subject to} \quad c(z) = 0, \qquad l \le g(z) \le u $$
///
/// f, c and g are sums and lists of functions of the elements of a [`Layout`]. z is a point of whatever the
/// program moves in; a step is a displacement of it, one number for each unknown of the layout, and
/// derivatives are those by steps: of `f(z (+) d)` and the others by d at d = 0. For most programs z is the
/// list of unknowns itself and `z (+) d = z + d`; unknowns on manifolds, such as rotations, bring a
/// [`retract`](Self::retract) of their own.
pub trait StagedProblem {
    /// Why functions have no value.
    type Error: Error;

    /// Numbers of unknowns and rows. They never change.
    fn layout(&self) -> &Layout;

    /// l and u, one entry for each function with a range; infinite where there is no bound. `l <= u`; ranges
    /// without interior are relaxed by 1e-8 of their size, so that an equation is better posed as one.
    fn bounds(&self) -> [&[f64]; 2];

    /// f, c and g at a point.
    ///
    /// Where functions have no value (outside of their domain), write NaN or infinity, for the cost too: the
    /// solver takes a shorter step. An error ends the solution.
    ///
    /// # Errors
    /// Its own.
    fn evaluate(&mut self, point: &[f64], values: &mut Values) -> Result<(), Self::Error>;

    /// Gradient of f, Jacobians of c and g, and the Hessian of `weights.cost f + y . c + v . g` for constant
    /// weights, at the point of the last [`evaluate`](Self::evaluate). The blocks hold zeros before.
    ///
    /// # Errors
    /// Its own.
    fn linearise(
        &mut self,
        point: &[f64],
        weights: Weights<'_>,
        blocks: &mut Blocks,
    ) -> Result<(), Self::Error>;

    /// Replaces the Hessians of the last [`linearise`](Self::linearise) by ones that are positive
    /// semidefinite, or nearer to that, for the same point and weights ([`Blocks::clear_hessians`] makes room
    /// for them). Whether there are any: by default there are none, and the blocks stay as they are.
    ///
    /// The solver asks for them where the inertia is wrong. Where costs are sums of squares, Gauss-Newton
    /// Hessians, without second derivatives of what is squared, lead farther than multiples of a metric,
    /// which are added where the inertia is still wrong.
    ///
    /// # Errors
    /// Its own.
    fn convexify(
        &mut self,
        point: &[f64],
        weights: Weights<'_>,
        blocks: &mut Blocks,
    ) -> Result<bool, Self::Error> {
        let _ = (point, weights, blocks);
        Ok(false)
    }

    /// Adds `factor M` to the Hessians, at the point of the last [`linearise`](Self::linearise). M is
    /// positive definite; `d' M d` says how far a step goes, in units of the cost, where W has to be made
    /// positive definite. By default it is `s_f sum (d_k / s_k)^2`, with the [`scales`](Self::scales) of the
    /// cost and of the unknowns.
    ///
    /// In a good metric steps that keep the quality of a point are short: those of motions are measured by
    /// their accelerations.
    ///
    /// # Errors
    /// Its own.
    fn add_metric(&mut self, point: &[f64], factor: f64, blocks: &mut Blocks) -> Result<(), Self::Error> {
        let _ = point;
        add_scales(self.layout(), self.scales(), factor, blocks);
        Ok(())
    }

    /// Number of entries of a point.
    fn point_len(&self) -> usize {
        self.layout().steps()
    }

    /// `moved = point (+) step`; by default their sum.
    fn retract(&self, point: &[f64], step: &[f64], moved: &mut [f64]) {
        for ((moved, point), step) in moved.iter_mut().zip(point).zip(step) {
            *moved = point + step;
        }
    }

    /// Typical sizes of what the program consists of; by default all of them are 1.
    ///
    /// They carry the units: a program whose unknowns and scales are given in millimetres in place of metres
    /// takes the same iterations.
    fn scales(&self) -> Option<&Scales> {
        None
    }
}

/// Adds the metric of typical sizes: each unknown in the element of its node or interval, shared ones in that
/// of the first node.
fn add_scales(layout: &Layout, scales: Option<&Scales>, factor: f64, blocks: &mut Blocks) {
    let cost = scales.map_or(1.0, |scales| scales.cost);
    let mut add = |element: Element, first: usize, unknowns: Range<usize>| {
        let hessian = &mut blocks.of(element).hessian;
        for (column, unknown) in (first..).zip(unknowns) {
            let size = scales.map_or(1.0, |scales| scales.steps[unknown]);
            hessian[(column, column)] += factor * cost / (size * size);
        }
    };
    let last = layout.intervals();
    for k in 0..=last {
        add(Element::Node(k), 0, layout.node(k));
        if k < last {
            add(Element::Interval(k), layout.node(k).len(), layout.private(k));
        }
    }
    add(Element::Node(0), layout.node(0).len(), layout.shared());
}
