//! States with quaternions and their tangent space: what second derivatives have besides those of F.

use super::turn::{Turn, costate_slopes, four, vector};
use crate::matrix::Matrix;
use crate::scalar::Scalar;
use crate::spatial::Vec3;

/// What bends x within the tangent space of one joint, and costates with it.
pub(super) struct Bend<'a, S> {
    /// y in the components of x, and in the tangent space, and the latter times F_x.
    pub y: &'a [S],
    pub l: &'a [S],
    pub pull: &'a [S],
    /// F of the tangent space, and its derivatives by x.
    pub rate: &'a [S],
    pub slopes: &'a Matrix<S>,
}

impl<S: Scalar> Bend<'_, S> {
    /// Adds the second derivatives of y'f by x that are not those of F.
    pub fn add(&self, turn: &Turn<S>, y_f_xx: &mut Matrix<S>) {
        let (at, first) = (turn.quaternion(), turn.angular());
        let zero = Vec3::zero();
        let linear = |entries: &[S]| if turn.slides { vector(entries, turn.coordinate) } else { zero };
        let (l, v, pull) = (linear(self.l), linear(self.rate), linear(self.pull));
        // The rotation vector is 2 w - 2 s w, and it turns v by itself and by half of its square.
        let force = vector(self.pull, first) + v.cross(l);
        let lv = l.dot(v);
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
            let [a, b] = [turn.w[i], turn.w[j]];
            let by_scale = turn.s[i] * force.dot(b) + turn.s[j] * force.dot(a);
            let square = l.dot(a) * v.dot(b) + l.dot(b) * v.dot(a);
            y_f_xx[(at + i, at + j)] += (square - by_scale).times(2.0) - (lv * a.dot(b)).times(4.0);
        }
        // l changes with a, and so does F with all of x.
        for (i, slope) in costate_slopes(four(self.y, at)).into_iter().enumerate() {
            let angular = slope.times(0.5).to_array();
            let linear = l.cross(turn.w[i]).times(2.0).to_array();
            for k in 0..3 {
                add_both(y_f_xx, self.slopes.row(first + k), at + i, angular[k]);
                if turn.slides {
                    add_both(y_f_xx, self.slopes.row(turn.coordinate + k), at + i, linear[k]);
                }
            }
        }
        if !turn.slides {
            return;
        }
        // The displacement of the tangent is d - w x d.
        for (i, w) in turn.w.iter().enumerate() {
            let bent = turn.rotation.apply(w.cross(pull)).to_array();
            for (k, &bent) in bent.iter().enumerate() {
                y_f_xx[(at + i, turn.position + k)] += bent;
                y_f_xx[(turn.position + k, at + i)] += bent;
            }
        }
    }
}

/// Adds `factor row` to row i and to column i.
fn add_both<S: Scalar>(matrix: &mut Matrix<S>, row: &[S], i: usize, factor: S) {
    for (j, &entry) in row.iter().enumerate() {
        let term = factor * entry;
        matrix[(i, j)] += term;
        matrix[(j, i)] += term;
    }
}
