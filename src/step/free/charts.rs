//! The charts at both ends of a step, from the tangent space to plain numbers and back.
//!
//! At the start, with R and a of the quaternion of length 1 there and (d, e) = (rho, theta, e_v, e_pi),
//!
//! $$ r \oplus d = r + R (\rho + \tfrac12 \theta \times \rho), \qquad
//! a \oplus d = a \circ b, \quad b = (\tfrac12 \theta, 1 - \tfrac18 |\theta|^2) $$
//!
//! to second order, and the momenta conjugate to them, where x has these,
//!
//! $$ p\_r = R \exp(\theta)\, (p\_v + e\_v), \qquad p\_a = 2\, a \circ b \circ (\pi + e\_\pi, 0) $$
//!
//! At the end it is the tangent of [`Turn`], whose a may have any length.

use crate::dynamics::{Local, Parts, Places, Plain, SecondHalf, Turn, plain_entries};
use crate::matrix::{Matrix, add_scaled};
use crate::robot::Robot;
use crate::scalar::Scalar;
use crate::spatial::Vec3;
use crate::step::{StepContraction, StepLinearisation};

/// Where the entries of x are in the tangent space, at the start and at the end.
#[derive(Clone, Debug)]
pub(super) struct Charts<S> {
    nq: usize,
    n: usize,
    plain: Vec<Plain>,
    start: Vec<Turn<S>>,
    end: Vec<Turn<S>>,
    /// Second derivatives of the chart at the end by plain numbers, and a row.
    bent: Matrix<S>,
    row: Vec<S>,
}

impl<S: Scalar> Charts<S> {
    pub fn new(robot: &Robot, second: SecondHalf) -> Self {
        let (n, nq) = (robot.dof(), robot.nq());
        let turns: Vec<Turn<S>> =
            robot.free_joints().iter().map(|joint| Turn::new(joint, nq, second)).collect();
        let (start, end, size) = (turns.clone(), turns, nq + second.length(robot));
        Self {
            plain: plain_entries(robot, second),
            start,
            end,
            bent: Matrix::zeros(size, size),
            row: vec![S::zero(); 3 * n + 1],
            n,
            nq,
        }
    }

    fn at(&self, turns: fn(&Self) -> &[Turn<S>]) -> Places<'_, S> {
        Places { plain: &self.plain, turns: turns(self) }
    }

    /// Takes the chart at (q, w), and writes its plain numbers.
    pub fn leave(&mut self, x: &[S], numbers: &mut [S]) {
        let (q, w) = x.split_at(self.nq);
        for plain in &self.plain {
            numbers[plain.position] = q[plain.position];
            numbers[plain.momentum] = w[plain.coordinate];
        }
        self.start.iter_mut().for_each(|turn| turn.lift([q, w], numbers));
    }

    /// Takes the chart at the plain numbers of the next state, and writes it, quaternions divided by their
    /// lengths.
    pub fn arrive(&mut self, numbers: &[S], next: &mut [S]) {
        let (q, w) = next.split_at_mut(self.nq);
        for plain in &self.plain {
            q[plain.position] = numbers[plain.position];
            w[plain.coordinate] = numbers[plain.momentum];
        }
        self.end.iter_mut().for_each(|turn| turn.set(numbers, q, w));
    }

    /// y for the plain numbers of the next state.
    pub fn costate(&self, y: &[S], plain: &mut [S]) {
        self.at(|charts| &charts.end).spread(y, plain);
    }

    /// Rows of Phi by (d, e), u and h.
    pub fn spread(&self, first: &StepLinearisation<'_, S>, wide: &mut Matrix<S>) {
        let (places, size) = (self.at(|charts| &charts.start), 2 * self.n);
        for (i, (phi_x, phi_u)) in first.phi_x.iter_rows().zip(first.phi_u.iter_rows()).enumerate() {
            let (by_state, rest) = wide.row_mut(i).split_at_mut(size);
            places.costate(phi_x, by_state);
            rest[..self.n].copy_from_slice(phi_u);
            rest[self.n] = first.phi_h[i];
        }
    }

    /// Rows of phi from those of Phi.
    pub fn project(&self, wide: &Matrix<S>, phi_z: &mut Matrix<S>) {
        self.at(|charts| &charts.end).project(wide, phi_z);
    }

    /// The second derivatives of y'Phi by plain numbers and u as those by (d, e) and u.
    pub fn hessian(
        &mut self,
        second: &StepContraction<'_, S>,
        half: &mut Matrix<S>,
        y_phi_zz: &mut Matrix<S>,
    ) {
        let size = 2 * self.n;
        let mut row = std::mem::take(&mut self.row);
        let places = self.at(|charts| &charts.start);
        for (c, of_x) in second.xx.iter_rows().enumerate() {
            places.costate(of_x, &mut row[..size]);
            (0..size).for_each(|i| half[(i, c)] = row[i]);
        }
        for i in 0..size {
            places.costate(half.row(i), &mut y_phi_zz.row_mut(i)[..size]);
        }
        if let Some(ux) = second.ux {
            // It has the leading columns of x alone.
            let from = half.row_mut(0);
            for (j, of_u) in ux.iter_rows().enumerate() {
                from.fill(S::zero());
                from[..of_u.len()].copy_from_slice(of_u);
                places.costate(from, &mut row[..size]);
                for (i, &entry) in row[..size].iter().enumerate() {
                    y_phi_zz[(size + j, i)] = entry;
                    y_phi_zz[(i, size + j)] = entry;
                }
            }
        }
        if let Some(uu) = second.uu {
            for (j, of_u) in uu.iter_rows().enumerate() {
                y_phi_zz.row_mut(size + j)[size..].copy_from_slice(of_u);
            }
        }
        self.row = row;
    }

    /// Adds what the chart at the start bends, where y'Phi has the derivative `pull` by plain numbers.
    pub fn bend_start(&self, pull: &[S], y_phi_zz: &mut Matrix<S>) {
        for turn in &self.start {
            bend_start(turn, self.n, &turn.local_costate(|i| pull[i]), y_phi_zz);
        }
    }

    /// Adds what the chart at the end bends, from the rows of Phi by (d, e) and u.
    pub fn bend_end(&mut self, y: &[S], wide: &Matrix<S>, y_phi_zz: &mut Matrix<S>) {
        let inputs = 3 * self.n;
        let Self { end, bent, row, n, .. } = self;
        let row = &mut row[..inputs];
        for turn in end {
            turn.entries().for_each(|i| bent.row_mut(i).fill(S::zero()));
            let l: Parts<S> = turn.parts(|i| y[i], *n);
            turn.bend_tangent(&l, bent);
            for i in turn.entries() {
                row.fill(S::zero());
                turn.entries().for_each(|j| add_scaled(row, bent[(i, j)], wide.row(j)));
                (0..inputs).for_each(|k| add_scaled(y_phi_zz.row_mut(k), wide[(i, k)], row));
            }
        }
    }
}

/// The second derivatives by (rho, theta, e_v, e_pi) at the start of one joint, times a costate.
fn bend_start<S: Scalar>(turn: &Turn<S>, n: usize, y: &Local<S>, matrix: &mut Matrix<S>) {
    let (linear, angular) = (turn.coordinate, turn.angular());
    let mut scale = y.s;
    if turn.slides {
        add_crossed(matrix, [angular, linear], y.d.times(0.5));
    }
    if let Some(momenta) = turn.momenta {
        scale += momenta.angular.dot(y.c) + momenta.linear.dot(y.g).times(4.0);
        let [force, p] = [y.g, momenta.linear].map(Vec3::to_array);
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            matrix[(angular + i, angular + j)] += (force[i] * p[j] + force[j] * p[i]).times(0.5);
        }
        if turn.slides {
            add_crossed(matrix, [angular, n + linear], y.g);
        }
        add_crossed(matrix, [angular, n + angular], y.c.times(0.5));
        for k in 0..3 {
            add_both(matrix, [angular + k, n + angular + k], y.k.times(-0.5));
        }
    }
    for k in 0..3 {
        matrix[(angular + k, angular + k)] -= scale.times(0.25);
    }
}

/// Adds the second derivatives of `f . (a x b)`, a and b from these coordinates on.
fn add_crossed<S: Scalar>(matrix: &mut Matrix<S>, [a, b]: [usize; 2], f: Vec3<S>) {
    let [x, y, z] = f.to_array();
    for (i, j, entry) in [(0, 1, z), (1, 0, -z), (1, 2, x), (2, 1, -x), (2, 0, y), (0, 2, -y)] {
        add_both(matrix, [a + i, b + j], entry);
    }
}

fn add_both<S: Scalar>(matrix: &mut Matrix<S>, [i, j]: [usize; 2], entry: S) {
    matrix[(i, j)] += entry;
    matrix[(j, i)] += entry;
}
