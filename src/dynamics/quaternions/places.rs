//! States with quaternions and their tangent space: first derivatives.

use super::turn::{Momenta, SecondHalf, Turn};
use crate::matrix::Matrix;
use crate::robot::Robot;
use crate::scalar::Scalar;

/// Where a joint of one degree of freedom has its entries.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plain {
    /// Its index in q and in the second half of x (an index of x).
    pub position: usize,
    pub momentum: usize,
    /// Its index in v.
    pub coordinate: usize,
}

/// Joints of one degree of freedom.
pub(crate) fn plain_entries(robot: &Robot, second: SecondHalf) -> Vec<Plain> {
    let nq = robot.nq();
    let entry = |(position, coordinate)| Plain {
        position,
        coordinate,
        momentum: nq + if second.is_conjugate() { position } else { coordinate },
    };
    robot.plain_entries().map(entry).collect()
}

/// Where the entries of x are in the tangent space.
pub(crate) struct Places<'a, S> {
    pub plain: &'a [Plain],
    pub turns: &'a [Turn<S>],
}

impl<S: Scalar> Places<'_, S> {
    /// x' from F of the tangent space.
    pub fn rate(&self, of_tangent: &[S], f: &mut [S]) {
        let n = of_tangent.len() / 2;
        for plain in self.plain {
            f[plain.position] = of_tangent[plain.coordinate];
            f[plain.momentum] = of_tangent[n + plain.coordinate];
        }
        for turn in self.turns {
            turn.put(&turn.rate(turn.parts(|i| of_tangent[i], n)), |i, entry| f[i] = entry);
        }
    }

    /// A row of derivatives by the tangent as one by x.
    pub fn spread(&self, from: &[S], to: &mut [S]) {
        let n = from.len() / 2;
        for plain in self.plain {
            to[plain.position] = from[plain.coordinate];
            to[plain.momentum] = from[n + plain.coordinate];
        }
        self.turns.iter().for_each(|turn| turn.put_costate(&turn.pulled(turn.parts(|i| from[i], n)), to));
    }

    /// f_x from F of the tangent space and its derivatives by x.
    pub fn jacobian(&self, of_tangent: &[S], slopes: &Matrix<S>, f_x: &mut Matrix<S>) {
        let n = of_tangent.len() / 2;
        for plain in self.plain {
            f_x.row_mut(plain.position).copy_from_slice(slopes.row(plain.coordinate));
            f_x.row_mut(plain.momentum).copy_from_slice(slopes.row(n + plain.coordinate));
        }
        for turn in self.turns {
            for c in 0..slopes.columns() {
                let rate = turn.rate(turn.parts(|i| slopes[(i, c)], n));
                turn.put(&rate, |i, entry| f_x[(i, c)] = entry);
            }
            let rate = turn.parts(|i| of_tangent[i], n);
            for c in turn.entries() {
                let slope = turn.rate_slope(rate, &turn.unit(c));
                turn.put(&slope, |i, entry| f_x[(i, c)] += entry);
            }
        }
    }

    /// Columns of B as columns of f_u.
    pub fn drive(&self, actuation: &Matrix<S>, f_u: &mut Matrix<S>) {
        for (turn, j) in self.turns.iter().flat_map(|turn| (0..actuation.columns()).map(move |j| (turn, j))) {
            let [linear, angular, ..] = turn.parts(|i| actuation[(i, j)], 0);
            let force = Momenta { linear, angular, along: S::zero() };
            turn.put_momenta(force, |i, entry| f_u[(i, j)] = entry);
        }
        for plain in self.plain {
            f_u.row_mut(plain.momentum).copy_from_slice(actuation.row(plain.coordinate));
        }
    }

    /// The costate in the tangent space.
    pub fn costate(&self, y: &[S], l: &mut [S]) {
        let n = l.len() / 2;
        for plain in self.plain {
            l[plain.coordinate] = y[plain.position];
            l[n + plain.coordinate] = y[plain.momentum];
        }
        for turn in self.turns {
            turn.put_parts(turn.costate(&turn.local_costate(|i| y[i])), n, |i, entry| l[i] = entry);
        }
    }

    /// Rows of derivatives of the tangent, 2n, from those of x.
    pub fn project(&self, of_x: &Matrix<S>, of_tangent: &mut Matrix<S>) {
        let n = of_tangent.rows() / 2;
        for plain in self.plain {
            of_tangent.row_mut(plain.coordinate).copy_from_slice(of_x.row(plain.position));
            of_tangent.row_mut(n + plain.coordinate).copy_from_slice(of_x.row(plain.momentum));
        }
        for (turn, c) in self.turns.iter().flat_map(|turn| (0..of_x.columns()).map(move |c| (turn, c))) {
            let parts = turn.tangent(&turn.local(|i| of_x[(i, c)]));
            turn.put_parts(parts, n, |i, entry| of_tangent[(i, c)] = entry);
        }
    }
}
