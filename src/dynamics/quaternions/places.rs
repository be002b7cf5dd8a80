//! States with quaternions and their tangent space: first derivatives.

use super::turn::{Turn, by_quaternion, four, vector};
use crate::matrix::Matrix;
use crate::robot::Robot;
use crate::scalar::Scalar;
use crate::spatial::Vec3;

/// Entries of q of joints of one degree of freedom, with their coordinates.
pub(crate) fn plain_entries(robot: &Robot) -> Vec<(usize, usize)> {
    let mut plain = Vec::new();
    let (mut at, mut i) = (0, 0);
    for free in robot.free_joints() {
        plain.extend((i..free.coordinate).map(|k| (at + k - i, k)));
        (at, i) = (free.position + free.kind.positions(), free.coordinate + free.kind.dof());
    }
    plain.extend((i..robot.dof()).map(|k| (at + k - i, k)));
    plain
}

/// Where the entries of x are in the tangent space.
pub(crate) struct Places<'a, S> {
    pub nq: usize,
    pub plain: &'a [(usize, usize)],
    pub turns: &'a [Turn<S>],
}

impl<S: Scalar> Places<'_, S> {
    /// x' from F of the tangent space.
    pub fn rate(&self, of_tangent: &[S], f: &mut [S]) {
        let n = of_tangent.len() / 2;
        self.plain.iter().for_each(|&(at, i)| f[at] = of_tangent[i]);
        for turn in self.turns {
            if turn.slides {
                let linear = turn.rotation.apply(vector(of_tangent, turn.coordinate));
                f[turn.position..turn.position + 3].copy_from_slice(&linear.to_array());
            }
            let at = turn.quaternion();
            f[at..at + 4].copy_from_slice(&turn.quaternion_rate(vector(of_tangent, turn.angular())));
        }
        f[self.nq..].copy_from_slice(&of_tangent[n..]);
    }

    /// A row of derivatives by the tangent as one by x.
    pub fn spread(&self, from: &[S], to: &mut [S]) {
        let n = from.len() / 2;
        self.plain.iter().for_each(|&(at, i)| to[at] = from[i]);
        self.turns.iter().for_each(|turn| turn.spread(from, to));
        to[self.nq..].copy_from_slice(&from[n..]);
    }

    /// f_x from F of the tangent space and its derivatives by x.
    pub fn jacobian(&self, of_tangent: &[S], slopes: &Matrix<S>, f_x: &mut Matrix<S>) {
        let n = of_tangent.len() / 2;
        self.plain.iter().for_each(|&(at, i)| f_x.row_mut(at).copy_from_slice(slopes.row(i)));
        for i in 0..n {
            f_x.row_mut(self.nq + i).copy_from_slice(slopes.row(n + i));
        }
        for turn in self.turns {
            let (at, first) = (turn.quaternion(), turn.angular());
            for c in 0..slopes.columns() {
                let column = |first: usize| Vec3::from([0, 1, 2].map(|k| slopes[(first + k, c)]));
                if turn.slides {
                    let moved = turn.rotation.apply(column(turn.coordinate)).to_array();
                    (0..3).for_each(|k| f_x[(turn.position + k, c)] = moved[k]);
                }
                let turned = turn.quaternion_rate(column(first));
                (0..4).for_each(|k| f_x[(at + k, c)] = turned[k]);
            }
            let by_a = by_quaternion(vector(of_tangent, first));
            for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
                f_x[(at + i, at + j)] += by_a[i][j].times(0.5);
            }
            if turn.slides {
                let v = vector(of_tangent, turn.coordinate);
                for (j, w) in turn.w.iter().enumerate() {
                    let bent = turn.rotation.apply(w.cross(v).times(2.0)).to_array();
                    (0..3).for_each(|k| f_x[(turn.position + k, at + j)] += bent[k]);
                }
            }
        }
    }

    /// The costate in the tangent space.
    pub fn costate(&self, y: &[S], l: &mut [S]) {
        let n = l.len() / 2;
        self.plain.iter().for_each(|&(at, i)| l[i] = y[at]);
        for turn in self.turns {
            if turn.slides {
                let linear = turn.rotation.undo(vector(y, turn.position)).to_array();
                l[turn.coordinate..turn.coordinate + 3].copy_from_slice(&linear);
            }
            let angular = turn.costate(four(y, turn.quaternion())).to_array();
            l[turn.angular()..turn.angular() + 3].copy_from_slice(&angular);
        }
        l[n..].copy_from_slice(&y[self.nq..]);
    }
}
