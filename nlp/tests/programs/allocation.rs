//! Solutions allocate nothing after their workspace is built.

use super::allocations::allocations;
use costate_nlp::{
    Blocks, Certificate, Element, Layout, Rows, Settings, Solver, StagedProblem, Start, Status, Values,
    Weights,
};
use std::convert::Infallible;
use std::ops::ControlFlow;

const INTERVALS: usize = 4;

/// At each node x_1 with `x_1^2 - x_2 = 1`, `x_1 - x_3 = 1/2`, `x_2, x_3 >= 0`, the example on which steps
/// that are only shortened fail (Waechter and Biegler 2000); neighbours are drawn together, and ranges of
/// intervals have few entries.
struct Failures {
    layout: Layout,
    bounds: [Vec<f64>; 2],
}

impl Failures {
    fn new() -> Self {
        let mut layout = Layout::uniform(INTERVALS, 3, 1, 0);
        for k in 0..=INTERVALS {
            layout = layout.with_rows(Element::Node(k), Rows::new(2, 2));
        }
        for k in 0..INTERVALS {
            layout = layout.with_rows(Element::Interval(k), Rows::new(0, 1));
        }
        let mut bounds = [Vec::new(), Vec::new()];
        for element in layout.elements() {
            let of_rows: &[[f64; 2]] = match element {
                Element::Node(_) => &[[0.0, f64::INFINITY]; 2],
                Element::Interval(_) => &[[-3.0, 3.0]],
                Element::Ends => &[],
            };
            for [lower, upper] in of_rows {
                bounds[0].push(*lower);
                bounds[1].push(*upper);
            }
        }
        Self { layout, bounds }
    }

    fn start(node: [f64; 3]) -> Vec<f64> {
        (0..4 * INTERVALS + 3).map(|at| if at % 4 < 3 { node[at % 4] } else { 0.0 }).collect()
    }
}

impl StagedProblem for Failures {
    type Error = Infallible;

    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn bounds(&self) -> [&[f64]; 2] {
        self.bounds.each_ref().map(Vec::as_slice)
    }

    fn evaluate(&mut self, z: &[f64], to: &mut Values) -> Result<(), Infallible> {
        to.cost = 0.0;
        for element in self.layout.elements() {
            let (c, g) = (self.layout.equalities_of(element), self.layout.ranges_of(element));
            match element {
                Element::Node(k) => {
                    let x = &z[4 * k..4 * k + 3];
                    to.cost += x[0];
                    to.equalities[c].copy_from_slice(&[x[0] * x[0] - x[1] - 1.0, x[0] - x[2] - 0.5]);
                    to.ranges[g].copy_from_slice(&x[1..]);
                }
                Element::Interval(k) => {
                    let [x, u, next] = [4 * k, 4 * k + 3, 4 * k + 4].map(|at| z[at]);
                    to.cost += (next - x - u) * (next - x - u) + u * u;
                    to.ranges[g].fill(next - x + u);
                }
                Element::Ends => {}
            }
        }
        Ok(())
    }

    fn linearise(&mut self, z: &[f64], w: Weights<'_>, blocks: &mut Blocks) -> Result<(), Infallible> {
        for k in 0..=INTERVALS {
            let first = self.layout.equalities_of(Element::Node(k)).start;
            let block = blocks.of(Element::Node(k));
            block.gradient[0] = 1.0;
            block.hessian[(0, 0)] = 2.0 * w.equalities[first];
            block.equalities.row_mut(0).copy_from_slice(&[2.0 * z[4 * k], -1.0, 0.0]);
            block.equalities.row_mut(1).copy_from_slice(&[1.0, 0.0, -1.0]);
            (block.ranges[(0, 1)], block.ranges[(1, 2)]) = (1.0, 1.0);
        }
        for k in 0..INTERVALS {
            let [x, u, next] = [4 * k, 4 * k + 3, 4 * k + 4].map(|at| z[at]);
            let block = blocks.of(Element::Interval(k));
            let slope = 2.0 * (next - x - u);
            (block.gradient[0], block.gradient[3], block.gradient[4]) = (-slope, 2.0 * u - slope, slope);
            for (i, j, entry) in
                [(0, 0, 2.0), (0, 3, 2.0), (0, 4, -2.0), (3, 3, 4.0), (3, 4, -2.0), (4, 4, 2.0)]
            {
                block.hessian[(i, j)] = w.cost * entry;
            }
            (block.ranges[(0, 0)], block.ranges[(0, 3)], block.ranges[(0, 4)]) = (-1.0, 1.0, 1.0);
        }
        Ok(())
    }
}

#[test]
fn solutions_allocate_nothing() {
    assert_eq!(allocations(|| drop(vec![0_u8; 100])), 1);
    let mut problem = Failures::new();
    let mut solver = Solver::new(&problem.layout, Settings::default());
    let [near, far] = [[1.5, 1.25, 1.0], [-2.0, 3.0, 1.0]].map(Failures::start);
    for (start, restores, is_new) in
        [(&near, false, true), (&near, false, false), (&far, true, true), (&far, true, false)]
    {
        let (mut was_restored, mut ended) = (false, Status::Stopped);
        let observer = |iteration: costate_nlp::Iteration| {
            was_restored |= iteration.is_restoration;
            ControlFlow::Continue(())
        };
        let count = allocations(|| {
            ended = solver.solve_observed(&mut problem, Start::at(start), observer).unwrap().status;
        });
        assert_eq!((ended, was_restored), (Status::Solved, restores));
        // Restoration is built where it is needed for the first time.
        assert!(count == 0 || (restores && is_new), "{count} allocations");
        let mut certificate = None;
        let count = allocations(|| {
            certificate = Some(solver.certify(&mut problem).unwrap());
            assert!(solver.refine(&mut problem, 1e-13).unwrap().largest() < 1e-12);
        });
        assert_eq!(certificate, Some(Certificate::LocalMinimum));
        assert!(count == 0 || (is_new && !restores), "{count} allocations");
        assert!(solver.point().iter().step_by(4).all(|x| (x - 1.0).abs() < 1e-12));
    }
}
