//! One joint: between its entries and the tangent space, to second order.
//!
//! Second derivatives of a function of a change of x are `w_i . U_j + w_j . U_i + s_i T_j + s_j T_i` for the
//! changes i and j, with U and T linear in the change: all that is not linear is so by a.

use super::local::{Local, Parts};
use super::turn::{Momenta, Turn};
use crate::matrix::Matrix;
use crate::scalar::Scalar;
use crate::spatial::Vec3;

impl<S: Scalar> Turn<S> {
    /// Adds the second derivatives by x of a costate times the tangent: of theta = 2 w - 2 s w and its like.
    pub fn bend_tangent(&self, l: &Parts<S>, matrix: &mut Matrix<S>) {
        self.add_bent(matrix, |change| self.tangent_bent(l, change));
    }

    /// U and T of the same.
    fn tangent_bent(&self, [of_d, of_turn, of_g, of_c]: &Parts<S>, change: &Local<S>) -> (Vec3<S>, S) {
        let Local { d, w, s, g, c, k } = *change;
        let mut along = *of_turn;
        let mut bent = of_d.cross(d);
        let mut scaled = S::zero();
        if let Some(Momenta { linear, .. }) = self.momenta {
            along = along + of_g.cross(linear);
            bent = bent + squared([linear, *of_g], w) + of_g.cross(g).times(2.0) + of_c.cross(c);
            bent = bent - of_c.scaled(k);
            scaled = of_c.dot(c);
        }
        (bent - along.scaled(s).times(2.0), scaled)
    }

    /// U and T of y times the entries of these rates.
    fn rate_bent(&self, y: &Local<S>, rate: &Parts<S>, change: &Local<S>) -> (Vec3<S>, S) {
        let Local { w, s, g, c, k, .. } = *change;
        let [v, omega, phi, psi] = *rate;
        let mut along = v.cross(y.d);
        let mut bent = squared([y.d, v], w);
        let mut scaled = S::zero();
        if self.momenta.is_some() {
            let moment = self.moment(y);
            along = along + phi.cross(y.g) + omega.cross(moment) + psi.cross(y.c) - psi.scaled(y.k);
            let moved = g.cross(y.g).times(2.0) + y.c.scaled(k) + c.cross(y.c) - c.scaled(y.k);
            let square = y.c.dot(psi);
            bent = bent + squared([y.g, phi], w) + squared([moment, omega], w) + omega.cross(moved);
            bent = bent - w.scaled(square);
            scaled = square * s;
        }
        (bent - along.scaled(s).times(2.0), scaled)
    }

    /// Adds what U and T of every change of an entry give.
    fn add_bent(&self, matrix: &mut Matrix<S>, bent: impl Fn(&Local<S>) -> (Vec3<S>, S)) {
        let at = self.quaternion();
        let of_a = [0, 1, 2, 3].map(|j| self.unit(at + j));
        for i in self.entries() {
            let (u, t) = bent(&self.unit(i));
            for (j, of_a) in of_a.iter().enumerate() {
                let entry = of_a.w.dot(u) + of_a.s * t;
                matrix[(i, at + j)] += entry;
                matrix[(at + j, i)] += entry;
            }
        }
    }

    /// A change of one entry of x by 1.
    pub(super) fn unit(&self, entry: usize) -> Local<S> {
        self.local(|i| if i == entry { S::one() } else { S::zero() })
    }
}

/// `K (b . w) + b (K . w) - 2 (K . b) w`, by `K . (w x (w x b))`.
fn squared<S: Scalar>([a, b]: [Vec3<S>; 2], w: Vec3<S>) -> Vec3<S> {
    a.scaled(b.dot(w)) + b.scaled(a.dot(w)) - w.scaled(a.dot(b)).times(2.0)
}

/// What bends x within the tangent space, and costates with it.
pub(super) struct Bend<'a, S> {
    /// y in the components of x, and in the tangent space times F_x.
    pub y: &'a [S],
    pub pull: &'a [S],
    /// F of the tangent space, and its derivatives by x.
    pub rate: &'a [S],
    pub slopes: &'a Matrix<S>,
}

impl<S: Scalar> Bend<'_, S> {
    /// Adds the second derivatives of y'f by x that are not those of F.
    pub fn add(&self, turn: &Turn<S>, y_f_xx: &mut Matrix<S>) {
        let n = self.rate.len() / 2;
        let y = turn.local_costate(|i| self.y[i]);
        let [pull, rate] = [self.pull, self.rate].map(|entries| turn.parts(|i| entries[i], n));
        turn.add_bent(y_f_xx, |change| {
            let [(u, t), (v, r)] = [turn.tangent_bent(&pull, change), turn.rate_bent(&y, &rate, change)];
            (u + v, t + r)
        });
        // l changes with x, and so does F with all of x.
        let (linear, angular) = (turn.coordinate, turn.angular());
        for i in turn.entries().filter(|&i| i >= turn.quaternion()) {
            let [of_v, of_omega, of_phi, of_psi] = turn.costate_slope(&y, &turn.unit(i));
            self.add_crossed(y_f_xx, angular, i, of_omega);
            if i >= turn.quaternion() + 4 {
                continue;
            }
            if turn.slides {
                self.add_crossed(y_f_xx, linear, i, of_v);
            }
            if turn.momenta.is_some() {
                self.add_crossed(y_f_xx, n + angular, i, of_psi);
                if turn.slides {
                    self.add_crossed(y_f_xx, n + linear, i, of_phi);
                }
            }
        }
    }

    /// Adds three rows of the derivatives of F, each times its factor, to row i and to column i.
    fn add_crossed(&self, matrix: &mut Matrix<S>, first: usize, i: usize, factors: Vec3<S>) {
        for (k, factor) in factors.to_array().into_iter().enumerate() {
            for (j, &entry) in self.slopes.row(first + k).iter().enumerate() {
                let term = factor * entry;
                matrix[(i, j)] += term;
                matrix[(j, i)] += term;
            }
        }
    }

    /// The second derivatives of y'f by the controls and q, where B acts on momenta that turn with the frame.
    pub fn drive(&self, turn: &Turn<S>, actuation: &Matrix<S>, y_f_uq: &mut Matrix<S>) {
        if turn.momenta.is_none() {
            return;
        }
        let y = turn.local_costate(|i| self.y[i]);
        for c in turn.quaternion()..turn.quaternion() + 4 {
            let [.., of_phi, of_psi] = turn.costate_slope(&y, &turn.unit(c));
            for j in 0..y_f_uq.rows() {
                let [phi, psi, ..] = turn.parts(|i| actuation[(i, j)], 0);
                y_f_uq[(j, c)] = of_phi.dot(phi) + of_psi.dot(psi);
            }
        }
    }
}
