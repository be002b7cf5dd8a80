//! The charts at both ends of a step, from the tangent space to plain numbers and back.
//!
//! At the start, with R and a of the quaternion of length 1 there and d = (d_r, d_w),
//!
//! $$ r \oplus d = r + R (d\_r + \tfrac12 d\_w \times d\_r), \qquad
//! a \oplus d = a \circ (\tfrac12 d\_w, 1 - \tfrac18 |d\_w|^2) $$
//!
//! to second order. At the end it is (theta, rho) of [`Turn`], whose a may have any length.

use crate::dynamics::{Places, Turn, four, plain_entries, vector};
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
    plain: Vec<(usize, usize)>,
    start: Vec<Turn<S>>,
    end: Vec<Turn<S>>,
    /// Entries of q, and a row of derivatives.
    q: Vec<S>,
    row: Vec<S>,
}

impl<S: Scalar> Charts<S> {
    pub fn new(robot: &Robot) -> Self {
        let turns: Vec<Turn<S>> = robot.free_joints().iter().map(Turn::new).collect();
        let (n, nq) = (robot.dof(), robot.nq());
        let (start, end) = (turns.clone(), turns);
        Self {
            plain: plain_entries(robot),
            start,
            end,
            q: vec![S::zero(); nq],
            row: vec![S::zero(); 3 * n + 1],
            n,
            nq,
        }
    }

    fn at(&self, turns: fn(&Self) -> &[Turn<S>]) -> Places<'_, S> {
        Places { nq: self.nq, plain: &self.plain, turns: turns(self) }
    }

    /// Takes the chart at x.
    pub fn leave(&mut self, x: &[S]) {
        let Self { start, q, nq, .. } = self;
        q.copy_from_slice(&x[..*nq]);
        start.iter_mut().for_each(|turn| turn.set(x, q));
    }

    /// Takes the chart at the next state, and divides its quaternions by their lengths.
    pub fn arrive(&mut self, next: &mut [S]) {
        let Self { end, q, nq, .. } = self;
        q.copy_from_slice(&next[..*nq]);
        end.iter_mut().for_each(|turn| turn.set(next, q));
        next[..*nq].copy_from_slice(q);
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
        self.plain.iter().for_each(|&(at, i)| phi_z.row_mut(i).copy_from_slice(wide.row(at)));
        for i in 0..self.n {
            phi_z.row_mut(self.n + i).copy_from_slice(wide.row(self.nq + i));
        }
        for turn in &self.end {
            let at = turn.quaternion();
            let entries = turn.w.map(Vec3::to_array);
            for k in 0..3 {
                let row = phi_z.row_mut(turn.angular() + k);
                row.fill(S::zero());
                for (j, w) in entries.iter().enumerate() {
                    add_scaled(row, w[k].times(2.0), wide.row(at + j));
                }
                if turn.slides {
                    let row = phi_z.row_mut(turn.coordinate + k);
                    row.fill(S::zero());
                    for (j, axis) in turn.rotation.rows.iter().enumerate() {
                        add_scaled(row, axis.to_array()[k], wide.row(turn.position + j));
                    }
                }
            }
        }
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

    /// Adds what q (+) d bends, of which y'Phi has the derivative `pull` by plain numbers.
    pub fn bend_start(&self, x: &[S], pull: &[S], y_phi_zz: &mut Matrix<S>) {
        for turn in &self.start {
            let (at, angular) = (turn.quaternion(), turn.angular());
            let [along, a] = [four(pull, at), four(x, at)];
            let scale = along.iter().zip(&a).fold(S::zero(), |sum, (&along, &a)| along.mul_add(a, sum));
            for k in 0..3 {
                y_phi_zz[(angular + k, angular + k)] -= scale.times(0.25);
            }
            if turn.slides {
                let force = turn.rotation.undo(vector(pull, turn.position));
                for (i, j, entry) in crossed(force) {
                    add_both(y_phi_zz, [angular + i, turn.coordinate + j], entry.times(0.5));
                }
            }
        }
    }

    /// Adds what (theta, rho) bends: -2 s w and -w x d, from their rows by (d, e) and u.
    pub fn bend_end(&mut self, y: &[S], [wide, phi_z]: [&Matrix<S>; 2], y_phi_zz: &mut Matrix<S>) {
        let inputs = 3 * self.n;
        let Self { end, row, .. } = self;
        for turn in end {
            // s, and twice w in the rows of theta.
            row.fill(S::zero());
            for (j, &s) in turn.s.iter().enumerate() {
                add_scaled(row, s, wide.row(turn.quaternion() + j));
            }
            let angular = turn.angular();
            let turned = vector(y, angular).to_array();
            for (k, &turned) in turned.iter().enumerate() {
                add_products(y_phi_zz, -turned, [&row[..inputs], &phi_z.row(angular + k)[..inputs]]);
            }
            if turn.slides {
                for (i, j, entry) in crossed(vector(y, turn.coordinate)) {
                    let [w, d] = [angular + i, turn.coordinate + j].map(|k| &phi_z.row(k)[..inputs]);
                    add_products(y_phi_zz, entry.times(-0.5), [w, d]);
                }
            }
        }
    }
}

/// (i, j, f . (e_i x e_j)).
fn crossed<S: Scalar>(f: Vec3<S>) -> [(usize, usize, S); 6] {
    let [x, y, z] = f.to_array();
    [(0, 1, z), (1, 0, -z), (1, 2, x), (2, 1, -x), (2, 0, y), (0, 2, -y)]
}

fn add_both<S: Scalar>(matrix: &mut Matrix<S>, [i, j]: [usize; 2], entry: S) {
    matrix[(i, j)] += entry;
    matrix[(j, i)] += entry;
}

/// Adds `factor (a b' + b a')`.
fn add_products<S: Scalar>(matrix: &mut Matrix<S>, factor: S, [a, b]: [&[S]; 2]) {
    for (i, (&of_a, &of_b)) in a.iter().zip(b).enumerate() {
        let row = matrix.row_mut(i);
        add_scaled(&mut row[..b.len()], factor * of_a, b);
        add_scaled(&mut row[..a.len()], factor * of_b, a);
    }
}
