//! A staged program with one vector of constraints and sparse matrices, for other solvers.

use crate::blocks::{Blocks, Values, Weights};
use crate::layout::{Element, Layout};
use crate::problem::StagedProblem;

/// A staged program in the conventions of IPOPT and most other solvers:
///
/// $$ \min_x f(x) \quad \text{subject to} \quad g_L \le g(x) \le g_U $$
///
/// x are the displacements of the unknowns from a point, in the order of the [`Layout`], and
/// with unknowns that are plain numbers the unknowns themselves less those of that point. g are the
/// equations, then the functions with ranges. Matrices are lists of entries (row, column, value), numbered
/// from zero; entries at the same place are to be added up. The Hessian is that of `factor f + lambda . g`,
/// its lower triangle.
///
/// Each call takes x; what was computed for the last x is kept.
///
/// Where points are no vectors ([`StagedProblem::retract`]), derivatives hold at x = 0 alone: take the
/// program at another point after each step ([`SparseProgram::at`]).
#[derive(Clone, Debug)]
pub struct SparseProgram<P> {
    problem: P,
    centre: Vec<f64>,
    x: Vec<f64>,
    point: Vec<f64>,
    is_evaluated: bool,
    values: Values,
    /// The weights of the derivatives that are there: factor, lambda.
    weights: Option<(f64, Vec<f64>)>,
    blocks: Blocks,
    jacobian: [Vec<usize>; 2],
    hessian: [Vec<usize>; 2],
}

impl<P: StagedProblem> SparseProgram<P> {
    /// The program with x = 0 at this point.
    ///
    /// # Panics
    /// If the point has another length than [`StagedProblem::point_len`].
    pub fn at(problem: P, point: &[f64]) -> Self {
        assert_eq!(point.len(), problem.point_len(), "entries of a point");
        let layout = problem.layout();
        let (mut jacobian, mut hessian) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
        let add = |to: &mut [Vec<usize>; 2], row: usize, column: usize| {
            to[0].push(row);
            to[1].push(column);
        };
        for element in layout.elements().filter(|&element| is_listed(layout, element)) {
            let columns: Vec<usize> = layout.unknowns(element).into_iter().flatten().collect();
            let ranges = layout.ranges_of(element).map(|row| layout.equalities() + row);
            for row in layout.equalities_of(element).chain(ranges) {
                columns.iter().for_each(|&column| add(&mut jacobian, row, column));
            }
            for (i, &column) in columns.iter().enumerate() {
                columns[i..].iter().for_each(|&row| add(&mut hessian, row.max(column), row.min(column)));
            }
        }
        Self {
            x: vec![0.0; layout.steps()],
            values: Values::new(layout),
            blocks: Blocks::new(layout),
            weights: None,
            is_evaluated: false,
            centre: point.to_vec(),
            point: point.to_vec(),
            jacobian,
            hessian,
            problem,
        }
    }

    /// The program itself.
    pub fn problem(&self) -> &P {
        &self.problem
    }

    /// The program itself, to change; what was computed is forgotten.
    pub fn problem_mut(&mut self) -> &mut P {
        (self.is_evaluated, self.weights) = (false, None);
        &mut self.problem
    }

    /// The program itself, no longer as a sparse one.
    pub fn into_problem(self) -> P {
        self.problem
    }

    /// Number of entries of x.
    pub fn variables(&self) -> usize {
        self.x.len()
    }

    /// Number of entries of g.
    pub fn constraints(&self) -> usize {
        self.values.equalities.len() + self.values.ranges.len()
    }

    /// g_L and g_U: zero for equations, infinite where there is no bound.
    pub fn bounds(&self) -> [Vec<f64>; 2] {
        let zeros = vec![0.0; self.values.equalities.len()];
        self.problem.bounds().map(|bounds| [&zeros, bounds].concat())
    }

    /// Rows and columns of the entries of the Jacobian of g.
    pub fn jacobian_structure(&self) -> [&[usize]; 2] {
        self.jacobian.each_ref().map(Vec::as_slice)
    }

    /// Rows and columns of the entries of the Hessian; no column is larger than its row.
    pub fn hessian_structure(&self) -> [&[usize]; 2] {
        self.hessian.each_ref().map(Vec::as_slice)
    }

    /// The point x (+) centre.
    pub fn point(&mut self, x: &[f64]) -> &[f64] {
        self.set(x);
        &self.point
    }

    /// f(x); NaN where it has no value.
    ///
    /// # Errors
    /// Those of the program.
    ///
    /// # Panics
    /// If x or another argument has the wrong length, as all methods below.
    pub fn cost(&mut self, x: &[f64]) -> Result<f64, P::Error> {
        self.evaluate(x)?;
        Ok(self.values.cost)
    }

    /// g(x).
    ///
    /// # Errors
    /// Those of the program.
    pub fn constraints_at(&mut self, x: &[f64], g: &mut [f64]) -> Result<(), P::Error> {
        self.evaluate(x)?;
        assert_eq!(g.len(), self.constraints(), "entries of g");
        let (equalities, ranges) = g.split_at_mut(self.values.equalities.len());
        equalities.copy_from_slice(&self.values.equalities);
        ranges.copy_from_slice(&self.values.ranges);
        Ok(())
    }

    /// The gradient of f.
    ///
    /// # Errors
    /// Those of the program.
    pub fn gradient(&mut self, x: &[f64], gradient: &mut [f64]) -> Result<(), P::Error> {
        self.linearise(x, None)?;
        assert_eq!(gradient.len(), self.variables(), "entries of the gradient");
        gradient.fill(0.0);
        let Self { problem, blocks, .. } = self;
        let layout = problem.layout();
        for (element, block) in layout.elements().zip(blocks.all()) {
            let columns = layout.unknowns(element).into_iter().flatten();
            columns.zip(&block.gradient).for_each(|(column, slope)| gradient[column] += slope);
        }
        Ok(())
    }

    /// The values of the entries of the Jacobian of g.
    ///
    /// # Errors
    /// Those of the program.
    pub fn jacobian(&mut self, x: &[f64], values: &mut [f64]) -> Result<(), P::Error> {
        self.linearise(x, None)?;
        assert_eq!(values.len(), self.jacobian[0].len(), "entries of the Jacobian");
        let (mut to, layout) = (values.iter_mut(), self.problem.layout());
        let blocks = layout.elements().zip(self.blocks.all());
        for (_, block) in blocks.filter(|&(element, _)| is_listed(layout, element)) {
            let entries = block.equalities.entries().iter().chain(block.ranges.entries());
            to.by_ref().zip(entries).for_each(|(to, entry)| *to = *entry);
        }
        Ok(())
    }

    /// The values of the entries of the Hessian of `factor f + lambda . g`.
    ///
    /// # Errors
    /// Those of the program.
    pub fn hessian(
        &mut self,
        x: &[f64],
        factor: f64,
        lambda: &[f64],
        values: &mut [f64],
    ) -> Result<(), P::Error> {
        assert_eq!(lambda.len(), self.constraints(), "entries of lambda");
        self.linearise(x, Some((factor, lambda)))?;
        assert_eq!(values.len(), self.hessian[0].len(), "entries of the Hessian");
        let (mut to, layout) = (values.iter_mut(), self.problem.layout());
        let blocks = layout.elements().zip(self.blocks.all());
        for (_, block) in blocks.filter(|&(element, _)| is_listed(layout, element)) {
            let width = block.gradient.len();
            for i in 0..width {
                let row = &block.hessian.row(i)[i..];
                to.by_ref().zip(row).for_each(|(to, entry)| *to = *entry);
            }
        }
        Ok(())
    }

    /// Goes to another x, if it is one.
    fn set(&mut self, x: &[f64]) {
        if self.x != x {
            self.x.copy_from_slice(x);
            (self.is_evaluated, self.weights) = (false, None);
        }
        if !self.is_evaluated {
            self.problem.retract(&self.centre, x, &mut self.point);
        }
    }

    fn evaluate(&mut self, x: &[f64]) -> Result<(), P::Error> {
        self.set(x);
        if !self.is_evaluated {
            self.problem.evaluate(&self.point, &mut self.values)?;
            self.is_evaluated = true;
        }
        Ok(())
    }

    /// Derivatives at x, for these weights or for any.
    fn linearise(&mut self, x: &[f64], weights: Option<(f64, &[f64])>) -> Result<(), P::Error> {
        self.evaluate(x)?;
        let is_there = match (&self.weights, weights) {
            (None, _) => false,
            // Some programs divide by the factor.
            (Some((factor, _)), None) => factor.abs() >= LEAST_FACTOR,
            (Some((factor, own)), Some((other, lambda))) => *factor == other && own == lambda,
        };
        if is_there {
            return Ok(());
        }
        let (factor, lambda) = match weights {
            Some((factor, lambda)) => (factor, lambda.to_vec()),
            None => (1.0, vec![0.0; self.constraints()]),
        };
        let (equalities, ranges) = lambda.split_at(self.values.equalities.len());
        self.weights = None;
        self.blocks.fill_zero();
        let weights = Weights { cost: factor, equalities, ranges };
        self.problem.linearise(&self.point, weights, &mut self.blocks)?;
        self.weights = Some((factor, lambda));
        Ok(())
    }
}

/// Least factor of the cost with which gradients are taken from what was computed for a Hessian.
const LEAST_FACTOR: f64 = 1e-3;

/// Whether an element has entries: both ends have none where nothing depends on both.
fn is_listed(layout: &Layout, element: Element) -> bool {
    element != Element::Ends || layout.couples_ends()
}

#[cfg(test)]
mod tests {
    use super::{SparseProgram, StagedProblem};
    use crate::blocks::{Blocks, Values, Weights};
    use crate::layout::{Element, Layout, Rows};
    use std::convert::Infallible;

    /// Two intervals; all kinds of elements, products of their unknowns.
    struct Products {
        layout: Layout,
    }

    impl Products {
        fn new() -> Self {
            let layout = Layout::uniform(2, 1, 1, 1)
                .with_rows(Element::Interval(0), Rows::new(1, 1))
                .with_rows(Element::Interval(1), Rows::new(1, 0))
                .with_rows(Element::Node(2), Rows::new(0, 1))
                .with_rows(Element::Ends, Rows::new(1, 0));
            Self { layout }
        }
    }

    impl StagedProblem for Products {
        type Error = Infallible;

        fn layout(&self) -> &Layout {
            &self.layout
        }

        fn bounds(&self) -> [&[f64]; 2] {
            [&[-1.0, f64::NEG_INFINITY], &[2.0, 5.0]]
        }

        // x_0, w_0, x_1, w_1, x_2, p.
        fn evaluate(&mut self, z: &[f64], values: &mut Values) -> Result<(), Infallible> {
            values.cost = z[0] * z[1] * z[2] * z[5] + z[3] * z[4];
            values.equalities = vec![z[0] * z[2] - z[1], z[2] * z[3] * z[4], z[0] * z[4] * z[5]];
            values.ranges = vec![z[1] * z[1] * z[5], z[4] * z[5]];
            Ok(())
        }

        fn linearise(&mut self, z: &[f64], w: Weights<'_>, blocks: &mut Blocks) -> Result<(), Infallible> {
            let [y, v] = [w.equalities, w.ranges];
            // (x_0, w_0, x_1, p).
            let [a, b, c, p] = [z[0], z[1], z[2], z[5]];
            let block = blocks.of(Element::Interval(0));
            block.gradient.copy_from_slice(&[b * c * p, a * c * p, a * b * p, a * b * c]);
            block.equalities.row_mut(0).copy_from_slice(&[c, -1.0, a, 0.0]);
            block.ranges.row_mut(0).copy_from_slice(&[0.0, 2.0 * b * p, 0.0, b * b]);
            let h = [
                [0.0, c * p, b * p, b * c],
                [0.0, 2.0 * p * v[0] / w.cost, a * p, a * c + 2.0 * b * v[0] / w.cost],
                [0.0, 0.0, 0.0, a * b],
            ];
            for (i, row) in h.iter().enumerate() {
                for (j, entry) in row.iter().enumerate() {
                    block.hessian[(i, j)] = w.cost * entry;
                }
            }
            block.hessian[(0, 2)] += y[0];
            // (x_1, w_1, x_2, p).
            let [c, d, e] = [z[2], z[3], z[4]];
            let block = blocks.of(Element::Interval(1));
            block.gradient.copy_from_slice(&[0.0, e, d, 0.0]);
            block.equalities.row_mut(0).copy_from_slice(&[d * e, c * e, c * d, 0.0]);
            (block.hessian[(0, 1)], block.hessian[(0, 2)]) = (y[1] * e, y[1] * d);
            block.hessian[(1, 2)] = w.cost + y[1] * c;
            let block = blocks.of(Element::Node(2));
            block.ranges.row_mut(0).copy_from_slice(&[p, e]);
            block.hessian[(0, 1)] = v[1];
            // (x_0, x_2, p).
            let block = blocks.of(Element::Ends);
            block.equalities.row_mut(0).copy_from_slice(&[e * p, a * p, a * e]);
            (block.hessian[(0, 1)], block.hessian[(0, 2)]) = (y[2] * p, y[2] * e);
            block.hessian[(1, 2)] = y[2] * a;
            Ok(())
        }
    }

    /// Entries of a list that are added up.
    fn dense(rows: usize, columns: usize, [i, j]: [&[usize]; 2], values: &[f64]) -> Vec<Vec<f64>> {
        let mut found = vec![vec![0.0; columns]; rows];
        for ((&i, &j), value) in i.iter().zip(j).zip(values) {
            found[i][j] += value;
        }
        found
    }

    #[test]
    fn lists_of_entries_are_the_derivatives() {
        let centre = [0.3, -0.7, 1.1, 0.4, 0.9, -1.3];
        let mut program = SparseProgram::at(Products::new(), &centre);
        assert_eq!((program.variables(), program.constraints()), (6, 5));
        // Nothing depends on both ends: they have no entries.
        let apart = Products { layout: Layout::uniform(2, 1, 1, 1) };
        assert_eq!(SparseProgram::at(apart, &centre).hessian_structure()[0].len(), 3 * 3 + 2 * 10);
        let [lower, upper] = program.bounds();
        assert_eq!(lower, [0.0, 0.0, 0.0, -1.0, f64::NEG_INFINITY]);
        assert_eq!(upper, [0.0, 0.0, 0.0, 2.0, 5.0]);
        let x = [0.1, 0.2, -0.3, 0.5, 0.25, 0.7];
        let moved: Vec<f64> = centre.iter().zip(x).map(|(centre, x)| centre + x).collect();
        assert_eq!(program.point(&x), moved);
        let (factor, lambda) = (0.6, [0.4, -0.9, 1.2, 0.8, -0.5]);
        let sizes = [program.jacobian_structure()[0].len(), program.hessian_structure()[0].len()];
        let [mut jacobian, mut hessian] = sizes.map(|size| vec![f64::NAN; size]);
        let mut gradient = [f64::NAN; 6];
        program.hessian(&x, factor, &lambda, &mut hessian).unwrap();
        program.jacobian(&x, &mut jacobian).unwrap();
        program.gradient(&x, &mut gradient).unwrap();
        let jacobian = dense(5, 6, program.jacobian_structure(), &jacobian);
        let structure = program.hessian_structure();
        assert!(structure[0].iter().zip(structure[1]).all(|(row, column)| column <= row));
        let hessian = dense(6, 6, structure, &hessian);
        // Differences of products of at most four numbers.
        let h = 1e-4;
        let mut at = |x: &[f64]| {
            let (mut g, mut slopes) = ([0.0; 5], [0.0; 6]);
            program.constraints_at(x, &mut g).unwrap();
            program.gradient(x, &mut slopes).unwrap();
            let size = program.jacobian_structure()[0].len();
            let mut entries = vec![0.0; size];
            program.jacobian(x, &mut entries).unwrap();
            let rows = dense(5, 6, program.jacobian_structure(), &entries);
            for (i, slope) in slopes.iter_mut().enumerate() {
                *slope = factor * *slope + rows.iter().zip(lambda).map(|(row, l)| l * row[i]).sum::<f64>();
            }
            (program.cost(x).unwrap(), g, slopes)
        };
        for j in 0..6 {
            let [before, after] = [-h, h].map(|h| {
                let mut x = x;
                x[j] += h;
                at(&x)
            });
            let difference = |a: f64, b: f64| (b - a) / (2.0 * h);
            assert!((gradient[j] - difference(before.0, after.0)).abs() < 1e-7);
            for (i, row) in jacobian.iter().enumerate() {
                assert!((row[j] - difference(before.1[i], after.1[i])).abs() < 1e-7, "{i} {j}");
            }
            for i in 0..6 {
                let entry = hessian[i.max(j)][i.min(j)];
                assert!((entry - difference(before.2[i], after.2[i])).abs() < 1e-7, "{i} {j}");
            }
        }
    }
}
