//! Staged programs whose derivatives are computed by hyper-dual numbers.

use costate_nlp::{Blocks, Element, Layout, Scales, StagedProblem, Values, Weights};
use num_dual::{DualNum, HyperDual64};
use std::convert::Infallible;

/// Numbers that functions are written in.
pub trait Number: DualNum<Primitive = f64> + Copy {}
impl<T: DualNum<Primitive = f64> + Copy> Number for T {}

/// Cost, equations and functions with ranges of one element.
#[derive(Debug)]
pub struct Parts<D> {
    pub cost: D,
    pub equalities: Vec<D>,
    pub ranges: Vec<D>,
}

impl<D: Number> Parts<D> {
    pub fn none() -> Self {
        Self { cost: D::from(0.0), equalities: Vec::new(), ranges: Vec::new() }
    }
}

/// A program as functions of the unknowns of each element.
pub trait Functions {
    fn layout(&self) -> Layout;

    /// Bounds of the ranges of an element.
    fn bounds(&self, element: Element) -> Vec<[f64; 2]>;

    fn of<D: Number>(&self, element: Element, z: &[D]) -> Parts<D>;

    fn scales(&self) -> Option<Scales> {
        None
    }
}

/// It as a staged program.
#[derive(Debug)]
pub struct ByDuals<F> {
    pub functions: F,
    layout: Layout,
    bounds: [Vec<f64>; 2],
    scales: Option<Scales>,
    pub evaluations: usize,
}

impl<F: Functions> ByDuals<F> {
    pub fn new(functions: F) -> Self {
        let layout = functions.layout();
        let all: Vec<[f64; 2]> = layout.elements().flat_map(|element| functions.bounds(element)).collect();
        assert_eq!(all.len(), layout.ranges());
        let bounds = [0, 1].map(|side| all.iter().map(|bounds| bounds[side]).collect());
        Self { scales: functions.scales(), functions, layout, bounds, evaluations: 0 }
    }
}

/// The unknowns of an element.
fn local(layout: &Layout, element: Element, z: &[f64]) -> Vec<f64> {
    layout.unknowns(element).into_iter().flat_map(|range| z[range].to_vec()).collect()
}

impl<F: Functions> StagedProblem for ByDuals<F> {
    type Error = Infallible;

    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn bounds(&self) -> [&[f64]; 2] {
        let [lower, upper] = &self.bounds;
        [lower, upper]
    }

    fn evaluate(&mut self, z: &[f64], values: &mut Values) -> Result<(), Infallible> {
        self.evaluations += 1;
        values.cost = 0.0;
        for element in self.layout.elements() {
            let parts = self.functions.of(element, &local(&self.layout, element, z));
            values.cost += parts.cost;
            values.equalities[self.layout.equalities_of(element)].copy_from_slice(&parts.equalities);
            values.ranges[self.layout.ranges_of(element)].copy_from_slice(&parts.ranges);
        }
        Ok(())
    }

    fn linearise(&mut self, z: &[f64], w: Weights<'_>, blocks: &mut Blocks) -> Result<(), Infallible> {
        for element in self.layout.elements() {
            let local = local(&self.layout, element, z);
            let (y, v) = (
                &w.equalities[self.layout.equalities_of(element)],
                &w.ranges[self.layout.ranges_of(element)],
            );
            let block = blocks.of(element);
            for i in 0..local.len() {
                for j in 0..=i {
                    let one = |on: bool| if on { 1.0 } else { 0.0 };
                    let seed = |(k, &x): (usize, &f64)| HyperDual64::new(x, one(k == i), one(k == j), 0.0);
                    let seeds: Vec<HyperDual64> = local.iter().enumerate().map(seed).collect();
                    let parts = self.functions.of(element, &seeds);
                    let weighted = |values: &[HyperDual64], weights: &[f64]| {
                        values.iter().zip(weights).map(|(value, weight)| weight * value.eps1eps2).sum::<f64>()
                    };
                    block.hessian[(j, i)] = w.cost * parts.cost.eps1eps2
                        + weighted(&parts.equalities, y)
                        + weighted(&parts.ranges, v);
                    if j == 0 {
                        block.gradient[i] = parts.cost.eps1;
                        parts
                            .equalities
                            .iter()
                            .enumerate()
                            .for_each(|(r, c)| block.equalities[(r, i)] = c.eps1);
                        parts.ranges.iter().enumerate().for_each(|(r, g)| block.ranges[(r, i)] = g.eps1);
                    }
                }
            }
        }
        Ok(())
    }

    fn scales(&self) -> Option<&Scales> {
        self.scales.as_ref()
    }
}
