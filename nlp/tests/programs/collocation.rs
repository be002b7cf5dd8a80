//! Optimal control problems by collocation at Radau's points.

use super::by_duals::{Functions, Number, Parts};
use costate_nlp::{Element, Layout, Rows, Scales};

/// Radau IIA of order 5, on (0, 1]: points, matrix and weights (Hairer and Wanner, "Solving ordinary
/// differential equations II", table IV.5.6).
const POINTS: usize = 3;

fn radau() -> ([f64; POINTS], [[f64; POINTS]; POINTS]) {
    let r = 6.0_f64.sqrt();
    let c = [(4.0 - r) / 10.0, (4.0 + r) / 10.0, 1.0];
    let a = [
        [(88.0 - 7.0 * r) / 360.0, (296.0 - 169.0 * r) / 1800.0, (-2.0 + 3.0 * r) / 225.0],
        [(296.0 + 169.0 * r) / 1800.0, (88.0 + 7.0 * r) / 360.0, (-2.0 - 3.0 * r) / 225.0],
        [(16.0 - r) / 36.0, (16.0 + r) / 36.0, 1.0 / 9.0],
    ];
    (c, a)
}

/// `min phi(x_0, x_N, p) + int L dt` with `x' = f(x, u, p)` and bounds of path functions g(x, u, p).
pub trait Ocp {
    /// States, controls, parameters.
    const SIZES: [usize; 3];

    fn intervals(&self) -> usize;

    /// The duration: a number, or a parameter.
    fn duration<D: Number>(&self, p: &[D]) -> D;

    /// f, L and g.
    fn path<D: Number>(&self, x: &[D], u: &[D], p: &[D]) -> (Vec<D>, D, Vec<D>);

    /// Bounds of g.
    fn path_bounds(&self) -> Vec<[f64; 2]> {
        Vec::new()
    }

    /// phi and equations of both ends.
    fn ends<D: Number>(&self, x_0: &[D], x_n: &[D], p: &[D]) -> (D, Vec<D>);

    fn end_equations(&self) -> usize;

    fn scales(&self, _: &Layout) -> Option<Scales> {
        None
    }
}

/// Its staged program. Node: x; interval: states and controls at the points.
#[derive(Debug)]
pub struct Collocated<T>(pub T);

impl<T: Ocp> Functions for Collocated<T> {
    fn layout(&self) -> Layout {
        let ([n, m, shared], count) = (T::SIZES, self.0.intervals());
        let ranges = self.0.path_bounds().len();
        let layout = Layout::uniform(count, n, POINTS * (n + m), shared).with_cost_of_ends();
        let layout = (0..count).fold(layout, |layout, k| {
            layout.with_rows(Element::Interval(k), Rows::new((POINTS + 1) * n, POINTS * ranges))
        });
        layout.with_rows(Element::Ends, Rows::new(self.0.end_equations(), 0))
    }

    fn bounds(&self, element: Element) -> Vec<[f64; 2]> {
        match element {
            Element::Interval(_) => self.0.path_bounds().repeat(POINTS),
            Element::Node(_) | Element::Ends => Vec::new(),
        }
    }

    fn of<D: Number>(&self, element: Element, z: &[D]) -> Parts<D> {
        let [n, m, _] = T::SIZES;
        let mut parts = Parts::none();
        match element {
            Element::Node(_) => {}
            Element::Ends => {
                let (x_0, rest) = z.split_at(n);
                let (x_n, p) = rest.split_at(n);
                (parts.cost, parts.equalities) = self.0.ends(x_0, x_n, p);
            }
            Element::Interval(_) => {
                let (start, rest) = z.split_at(n);
                let (inner, rest) = rest.split_at(POINTS * (n + m));
                let (end, p) = rest.split_at(n);
                let (states, controls) = inner.split_at(POINTS * n);
                let h = self.0.duration(p) / self.0.intervals() as f64;
                let (_, a) = radau();
                let at = |i: usize| self.0.path(&states[i * n..][..n], &controls[i * m..][..m], p);
                let points: Vec<_> = (0..POINTS).map(at).collect();
                for i in 0..POINTS {
                    for s in 0..n {
                        let mut sum = D::from(0.0);
                        for (j, (rates, ..)) in points.iter().enumerate() {
                            sum += rates[s] * a[i][j];
                        }
                        parts.equalities.push(states[i * n + s] - start[s] - h * sum);
                    }
                    parts.cost += h * points[i].1 * a[POINTS - 1][i];
                    parts.ranges.extend_from_slice(&points[i].2);
                }
                for s in 0..n {
                    parts.equalities.push(end[s] - states[(POINTS - 1) * n + s]);
                }
            }
        }
        parts
    }

    fn scales(&self) -> Option<Scales> {
        self.0.scales(&self.layout())
    }
}

impl<T: Ocp> Collocated<T> {
    /// A start from states and controls as functions of the part of the time that has passed.
    pub fn start(&self, x: impl Fn(f64) -> Vec<f64>, u: impl Fn(f64) -> Vec<f64>, p: &[f64]) -> Vec<f64> {
        let count = self.0.intervals();
        let (points, _) = radau();
        let time = |k: usize, part: f64| (k as f64 + part) / count as f64;
        let mut z = Vec::new();
        for k in 0..count {
            z.extend(x(time(k, 0.0)));
            points.iter().for_each(|&part| z.extend(x(time(k, part))));
            points.iter().for_each(|&part| z.extend(u(time(k, part))));
        }
        z.extend(x(1.0));
        z.extend(p);
        z
    }
}
