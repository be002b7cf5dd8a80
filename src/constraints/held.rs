//! What one constraint holds: values, gradients and contracted Hessians of its rows.

use super::chain::Chain;
use super::quaternion::HalfTurn;
use crate::kinematics::Kinematics;
use crate::matrix::Matrix;
use crate::robot::{ConstraintRow, Row, Tree, TreeConstraintKind, TreeFrame};
use crate::scalar::Scalar;
use crate::spatial::{Force, Motion, Vec3};

/// One constraint, its rows of g and J and its part of `(mu . g)_qq`.
#[derive(Clone, Debug)]
pub(super) enum Held<S> {
    /// Rows of r and psi: `mu . g = f . r + nu . psi`.
    Pose { chain: Chain<S>, rows: Vec<ConstraintRow>, turn: HalfTurn<S> },
    /// `g = (r . r - l^2) / (2 l)`.
    Distance { chain: Chain<S>, length: f64 },
    /// `g = sum of factor q - constant`.
    Coupling { terms: Vec<(usize, f64)>, constant: f64 },
}

impl<S: Scalar> Held<S> {
    pub fn new(tree: &Tree, of: &[Row], kind: &TreeConstraintKind) -> Self {
        match kind {
            TreeConstraintKind::Frames { frames, rows } => {
                let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vec3::constant);
                let turn = HalfTurn::of(&unit);
                Self::Pose { chain: Chain::new(tree, of, *frames), rows: rows.clone(), turn }
            }
            TreeConstraintKind::Distance { frames, length } => {
                Self::Distance { chain: Chain::new(tree, of, *frames), length: *length }
            }
            TreeConstraintKind::Coupling { terms, constant } => {
                Self::Coupling { terms: terms.clone(), constant: *constant }
            }
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        match self {
            Self::Pose { rows, .. } => rows.len(),
            Self::Distance { .. } | Self::Coupling { .. } => 1,
        }
    }

    /// Takes the pose of the links, and writes its rows of g.
    pub fn place(&mut self, kinematics: &Kinematics<S>, q: &[S], g: &mut [S]) {
        match self {
            Self::Pose { chain, rows, turn } => {
                chain.place(kinematics);
                if rows.iter().any(|row| row.component().1) {
                    *turn = HalfTurn::of(&chain.rotation);
                }
                let (r, psi) = (chain.position.to_array(), turn.value().to_array());
                for (g, row) in g.iter_mut().zip(rows) {
                    let (axis, turns) = row.component();
                    *g = if turns { psi[axis] } else { r[axis] };
                }
            }
            Self::Distance { chain, length } => {
                chain.place(kinematics);
                let square = chain.position.dot(chain.position);
                g[0] = square.plus(-*length * *length).times(0.5 / *length);
            }
            Self::Coupling { terms, constant } => {
                let zero = S::from_f64(-*constant);
                g[0] = terms.iter().fold(zero, |sum, &(k, factor)| sum.plus_times(q[k], factor));
            }
        }
    }

    /// Adds to its rows of J, from `first` on.
    pub fn add_gradients(&self, jacobian: &mut Matrix<S>, first: usize) {
        match self {
            Self::Pose { chain, rows, turn } => {
                for (coordinate, Motion { angular, linear }) in chain.columns() {
                    let (c, psi) = (linear.to_array(), turn.slope(angular).to_array());
                    for (k, row) in rows.iter().enumerate() {
                        let (axis, turns) = row.component();
                        jacobian[(first + k, coordinate)] += if turns { psi[axis] } else { c[axis] };
                    }
                }
            }
            Self::Distance { chain, length } => {
                for (coordinate, Motion { linear, .. }) in chain.columns() {
                    jacobian[(first, coordinate)] += chain.position.dot(linear).times(1.0 / length);
                }
            }
            Self::Coupling { terms, .. } => {
                for &(coordinate, factor) in terms {
                    jacobian[(first, coordinate)] += S::from_f64(factor);
                }
            }
        }
    }

    /// Adds to the squares of what the rounding errors of its rows of J are in proportion to.
    pub fn add_sizes(&self, sizes: &mut Matrix<S>, first: usize) {
        match self {
            Self::Pose { chain, rows, .. } => {
                for (coordinate, [turning, moving]) in chain.sizes() {
                    for (k, row) in rows.iter().enumerate() {
                        sizes[(first + k, coordinate)] += if row.component().1 { turning } else { moving };
                    }
                }
            }
            Self::Distance { chain, length } => {
                let square = chain.position.dot(chain.position).times(1.0 / (length * length));
                for (coordinate, [_, moving]) in chain.sizes() {
                    sizes[(first, coordinate)] += square * moving;
                }
            }
            Self::Coupling { terms, .. } => {
                for &(coordinate, factor) in terms {
                    sizes[(first, coordinate)] += S::from_f64(factor * factor);
                }
            }
        }
    }

    /// Its row `k` with value g as a length or an angle (m, rad), zero where g is: `2 asin eps` of a turn; of
    /// a distance
    ///
    /// ```text
    /// |r| - l = 2 l g / (|r| + l),   |r|^2 = l^2 + 2 l g
    /// ```
    pub fn measure(&self, k: usize, g: f64) -> f64 {
        match self {
            Self::Pose { rows, .. } if rows[k].component().1 => 2.0 * (0.5 * g).clamp(-1.0, 1.0).asin(),
            Self::Distance { length, .. } => {
                let twice = 2.0 * length * g;
                twice / ((length * length + twice).max(0.0).sqrt() + length)
            }
            _ => g,
        }
    }

    /// What its row `k` holds; none for distances and couplings.
    pub fn component(&self, k: usize) -> Option<ConstraintRow> {
        match self {
            Self::Pose { rows, .. } => rows.get(k).copied(),
            Self::Distance { .. } | Self::Coupling { .. } => None,
        }
    }

    /// The frames that it holds.
    pub fn frames(&self) -> Vec<TreeFrame> {
        match self {
            Self::Pose { chain, .. } | Self::Distance { chain, .. } => chain.frames().into(),
            Self::Coupling { .. } => Vec::new(),
        }
    }

    /// The coordinates that enter its rows.
    pub fn coordinates(&self) -> Vec<usize> {
        match self {
            Self::Pose { chain, .. } | Self::Distance { chain, .. } => chain.coordinates().collect(),
            Self::Coupling { terms, .. } => terms.iter().map(|&(coordinate, _)| coordinate).collect(),
        }
    }

    /// Adds its part of `(mu . g)_qq` for the weights of its rows: for a pair s, t, s not beyond t,
    ///
    /// ```text
    /// rows      f . (w_s x c_t) + (nu . psi)_,st = (f x w_s) . c_t + h_s . w_t
    /// distance  mu (c_s . c_t + r . (w_s x c_t)) / l = mu (c_s + r x w_s) . c_t / l
    /// coupling  0
    /// ```
    pub fn add_curvature(&self, mu: &[S], hessian: &mut Matrix<S>) {
        match self {
            Self::Pose { chain, rows, turn } => {
                let (f, nu) = split(rows, mu);
                let turns = rows.iter().any(|row| row.component().1);
                let force = |inner: Motion<S>| Force {
                    moment: if turns { turn.curvature(nu, inner.angular) } else { Vec3::zero() },
                    force: f.cross(inner.angular),
                };
                chain.for_pairs(force, |at, entry, same| add_pair(hessian, at, entry, same));
            }
            Self::Distance { chain, length } => {
                let (r, factor) = (chain.position, mu[0].times(1.0 / length));
                let force = |inner: Motion<S>| Force {
                    moment: Vec3::zero(),
                    force: (inner.linear + r.cross(inner.angular)).scaled(factor),
                };
                chain.for_pairs(force, |at, entry, same| add_pair(hessian, at, entry, same));
            }
            Self::Coupling { .. } => {}
        }
    }

    /// Force (N) and moment (N m) of the multipliers' rates lambda on the link of the first frame, at its
    /// origin, in axes of the second frame; `None` for a coupling.
    pub fn wrench(&self, lambda: &[S]) -> Option<[Vec3<S>; 2]> {
        match self {
            Self::Pose { rows, turn, .. } => {
                let (f, nu) = split(rows, lambda);
                Some([f, turn.moment(nu)])
            }
            Self::Distance { chain, length } => {
                Some([chain.position.scaled(lambda[0].times(1.0 / length)), Vec3::zero()])
            }
            Self::Coupling { .. } => None,
        }
    }
}

/// Weights of the rows as vectors (f, nu); what is not held has none.
fn split<S: Scalar>(rows: &[ConstraintRow], weights: &[S]) -> (Vec3<S>, Vec3<S>) {
    let mut both = [[S::zero(); 3]; 2];
    for (row, &weight) in rows.iter().zip(weights) {
        let (axis, turns) = row.component();
        both[usize::from(turns)][axis] = weight;
    }
    let [f, nu] = both;
    (Vec3::from(f), Vec3::from(nu))
}

/// Adds an entry and its mirror image; two joints of one coordinate count twice, one joint once.
fn add_pair<S: Scalar>(hessian: &mut Matrix<S>, [i, j]: [usize; 2], entry: S, same: bool) {
    hessian[(i, j)] += entry;
    if !same {
        hessian[(j, i)] += entry;
    }
}

#[cfg(test)]
impl Held<num_dual::Dual64> {
    /// Velocity and angular velocity of the first frame, seen from the second: derivatives of its pose.
    pub fn relative_rate(&self) -> [[f64; 3]; 2] {
        let (Self::Pose { chain, .. } | Self::Distance { chain, .. }) = self else { return [[0.0; 3]; 2] };
        let [x, y, z] = chain.rotation;
        let spin = |a: Vec3<num_dual::Dual64>, b: Vec3<num_dual::Dual64>| {
            a.to_array().iter().zip(b.to_array()).map(|(a, b)| a.eps * b.re).sum::<f64>()
        };
        [chain.position.to_array().map(|entry| entry.eps), [spin(z, y), spin(x, z), spin(y, x)]]
    }
}
