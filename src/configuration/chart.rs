//! The chart of a floating or spherical joint: derivatives of its maps at the centre.
//!
//! Its coordinates are those of the chain, q = (t, a, b, c): displacement in the axes of the centre and
//! angles about x, y and z, so that the moved frame is at t with rotation `R = Rx(a) Ry(b) Rz(c)`. With the
//! left-trivialised tangent xi, `exp(xi)` the same place, and the twist nu of the moved frame in its axes,
//!
//! $$ q = \xi + \tfrac12 \Phi(\xi, \xi) + \dots, \qquad \nu = A(q)\, \dot q, \qquad
//! A = \begin{pmatrix} R^T & 0 \\\\ 0 & A\_w \end{pmatrix}, \qquad
//! A\_w = \begin{pmatrix} \cos b \cos c & \sin c & 0 \\\\ -\cos b \sin c & \cos c & 0 \\\\
//! \sin b & 0 & 1 \end{pmatrix} $$
//!
//! A = 1 at the centre. What is needed are constants: the first three derivatives of A and of A^-1, and Phi.

use crate::robot::FreeKind;

/// Entry (r, c) of the derivative of A by `by`, an ordered list of coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry<const K: usize> {
    pub row: usize,
    pub column: usize,
    pub by: [usize; K],
    pub value: f64,
}

/// The first three derivatives of a matrix by the coordinates, at the centre.
#[derive(Clone, Debug, Default)]
pub(crate) struct Jet {
    pub first: Vec<Entry<1>>,
    pub second: Vec<Entry<2>>,
    pub third: Vec<Entry<3>>,
}

/// The constants of one kind of joint.
#[derive(Clone, Debug)]
pub(crate) struct Chart {
    /// A.
    pub twist: Jet,
    /// A^-1.
    pub rates: Jet,
    /// Phi: row the coordinate; column and `by` the two components of xi.
    pub retraction: Vec<Entry<1>>,
}

/// A polynomial of degree 3 in the angles: terms by their exponents.
#[derive(Clone, Debug)]
struct Polynomial(Vec<([usize; 3], f64)>);

impl Polynomial {
    fn one() -> Self {
        Self(vec![([0; 3], 1.0)])
    }

    fn cos(angle: usize) -> Self {
        let mut square = [0; 3];
        square[angle] = 2;
        Self(vec![([0; 3], 1.0), (square, -0.5)])
    }

    fn sin(angle: usize) -> Self {
        let (mut first, mut cube) = ([0; 3], [0; 3]);
        (first[angle], cube[angle]) = (1, 3);
        Self(vec![(first, 1.0), (cube, -1.0 / 6.0)])
    }

    fn plus(mut self, factor: f64, other: &Self) -> Self {
        self.0.extend(other.0.iter().map(|&(exponents, value)| (exponents, factor * value)));
        self
    }

    /// The product without terms of degree 4 or more.
    fn times(&self, other: &Self) -> Self {
        let mut terms = Vec::new();
        for (a, x) in &self.0 {
            for (b, y) in &other.0 {
                let sum = [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
                if sum.iter().sum::<usize>() <= 3 {
                    terms.push((sum, x * y));
                }
            }
        }
        Self(terms)
    }

    /// The derivative by an ordered list of angles, at zero.
    fn derivative(&self, by: &[usize]) -> f64 {
        let exponents = [0, 1, 2].map(|angle| by.iter().filter(|&&other| other == angle).count());
        let factorials: usize = exponents.iter().map(|&e| (1..=e).product::<usize>()).product();
        let terms = self.0.iter().filter(|(of, _)| *of == exponents);
        factorials as f64 * terms.map(|(_, value)| value).sum::<f64>()
    }
}

/// `Rx(a) Ry(b) Rz(c)`, entry by entry.
fn rotation() -> [[Polynomial; 3]; 3] {
    let [[ca, sa], [cb, sb], [cc, sc]] = [0, 1, 2].map(|i| [Polynomial::cos(i), Polynomial::sin(i)]);
    let none = || Polynomial(Vec::new());
    [
        [cb.times(&cc), none().plus(-1.0, &cb.times(&sc)), sb.clone()],
        [
            ca.times(&sc).plus(1.0, &sa.times(&sb).times(&cc)),
            ca.times(&cc).plus(-1.0, &sa.times(&sb).times(&sc)),
            none().plus(-1.0, &sa.times(&cb)),
        ],
        [
            sa.times(&sc).plus(-1.0, &ca.times(&sb).times(&cc)),
            sa.times(&cc).plus(1.0, &ca.times(&sb).times(&sc)),
            ca.times(&cb),
        ],
    ]
}

/// `A_w`, entry by entry.
fn angular() -> [[Polynomial; 3]; 3] {
    let [[cb, sb], [cc, sc]] = [1, 2].map(|i| [Polynomial::cos(i), Polynomial::sin(i)]);
    let none = || Polynomial(Vec::new());
    [
        [cb.times(&cc), sc.clone(), none()],
        [none().plus(-1.0, &cb.times(&sc)), cc, none()],
        [sb, none(), Polynomial::one()],
    ]
}

/// `A^-1 = 1 - N + N^2 - N^3` with `N = A - 1`, to degree 3.
fn inverse(of: &[[Polynomial; 3]; 3]) -> [[Polynomial; 3]; 3] {
    let identity = |i: usize, j: usize| if i == j { Polynomial::one() } else { Polynomial(Vec::new()) };
    let square =
        |entry: &dyn Fn(usize, usize) -> Polynomial| [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)));
    let n = square(&|i, j| of[i][j].clone().plus(-1.0, &identity(i, j)));
    // Horner's rule.
    let mut found = square(&identity);
    for _ in 0..3 {
        found = square(&|i, j| {
            (0..3).fold(identity(i, j), |sum, k| sum.plus(-1.0, &n[i][k].times(&found[k][j])))
        });
    }
    found
}

impl Chart {
    pub fn new(kind: FreeKind) -> Self {
        let slides = kind.slides();
        let mut chart = Self { twist: Jet::default(), rates: Jet::default(), retraction: Vec::new() };
        let map = angular();
        let places = (0..3).flat_map(|r| (0..3).map(move |c| (r, c)));
        let back = inverse(&map);
        for (r, c) in places.clone() {
            chart.twist.add(slides, (slides + r, slides + c), &map[r][c]);
            chart.rates.add(slides, (slides + r, slides + c), &back[r][c]);
        }
        if kind == FreeKind::Floating {
            let turn = rotation();
            for (r, c) in places {
                chart.twist.add(slides, (c, r), &turn[r][c]);
                chart.rates.add(slides, (r, c), &turn[r][c]);
            }
            // t = rho + 1/2 theta x rho.
            for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
                chart.retract(i, [3 + j, k], 0.5);
                chart.retract(i, [3 + k, j], -0.5);
            }
        }
        // a = x - 1/2 y z, b = y + 1/2 x z, c = z - 1/2 x y.
        for (i, j, k, value) in [(0, 1, 2, -0.5), (1, 0, 2, 0.5), (2, 0, 1, -0.5)] {
            chart.retract(slides + i, [slides + j, slides + k], value);
        }
        chart
    }

    fn retract(&mut self, row: usize, [i, j]: [usize; 2], value: f64) {
        self.retraction.push(Entry { row, column: i, by: [j], value });
        self.retraction.push(Entry { row, column: j, by: [i], value });
    }
}

impl Jet {
    /// All derivatives of an entry.
    fn add(&mut self, slides: usize, (row, column): (usize, usize), entry: &Polynomial) {
        for i in 0..3 {
            push(&mut self.first, (row, column), slides, [i], entry);
            for j in 0..3 {
                push(&mut self.second, (row, column), slides, [i, j], entry);
                for k in 0..3 {
                    push(&mut self.third, (row, column), slides, [i, j, k], entry);
                }
            }
        }
    }
}

fn push<const K: usize>(
    entries: &mut Vec<Entry<K>>,
    (row, column): (usize, usize),
    slides: usize,
    by: [usize; K],
    entry: &Polynomial,
) {
    let value = entry.derivative(&by);
    if value != 0.0 {
        entries.push(Entry { row, column, by: by.map(|angle| slides + angle), value });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Rotation3, Vector3};

    /// A and its inverse to third order, and the twist of the moved frame by its rotation matrices.
    #[test]
    fn the_constants_are_those_of_the_rotation() {
        let chart = Chart::new(FreeKind::Floating);
        let h = 1e-3;
        let q = [0.7 * h, -1.1 * h, 0.9 * h];
        let turn = |axis: Vector3<f64>, angle: f64| *Rotation3::new(axis * angle).matrix();
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        let [rx, ry, rz] = [turn(x, q[0]), turn(y, q[1]), turn(z, q[2])];
        let r = rx * ry * rz;
        let mut expected = nalgebra::Matrix6::<f64>::zeros();
        expected.fixed_view_mut::<3, 3>(0, 0).copy_from(&r.transpose());
        let columns = [(ry * rz).transpose() * x, rz.transpose() * y, z];
        expected.fixed_view_mut::<3, 3>(3, 3).copy_from(&Matrix3::from_columns(&columns));
        let at = |i: usize| q[i - 3];
        let value = |jet: &Jet| {
            let mut found = nalgebra::Matrix6::<f64>::identity();
            for e in &jet.first {
                found[(e.row, e.column)] += e.value * at(e.by[0]);
            }
            for e in &jet.second {
                found[(e.row, e.column)] += e.value * at(e.by[0]) * at(e.by[1]) / 2.0;
            }
            for e in &jet.third {
                found[(e.row, e.column)] += e.value * at(e.by[0]) * at(e.by[1]) * at(e.by[2]) / 6.0;
            }
            found
        };
        let (found, back) = (value(&chart.twist), value(&chart.rates));
        assert!((found - expected).amax() < h.powi(4), "{}", found - expected);
        let expected = expected.try_inverse().unwrap();
        assert!((back - expected).amax() < h.powi(4), "{}", back - expected);
    }
}
