//! Derivatives of the Christoffel coefficients and second derivatives of M.

use super::first::First;
use super::global::GlobalTensors;
use super::paths::{gamma_by_last, gamma_of_last, triangle};
use crate::robot::{JointKind, Tree};
use crate::scalar::Scalar;
use crate::spatial::Vec3;

/// The independent `Gamma^k_ij,l` and `M_ij,kl`, block by block.
///
/// With `w_i = sbar_i Z_i` and `Q_jl = int OP,j (x) OP,l dm`, the trace of which is M_jl, the four terms of
/// (56), and those of (57), (58), are one formula for all joint types:
///
/// ```text
/// A1_ijkl = (w_i . w_k) M_jl - w_i . Q_jl w_k     B1_ijkl = A1_jikl     A2_ijkl = A1_klij
/// ```
///
/// This is (61): the mass matrix is reused. Products that two coefficients share are computed once.
#[derive(Clone, Debug)]
pub(super) struct Second<S> {
    pub gamma: Vec<S>,
    pub mass: Vec<S>,
    /// `w_i x w_k` in frame l, i < k <= l, block by block.
    crosses: Vec<Vec3<S>>,
    /// Offset of the block of each joint.
    cross_starts: Vec<usize>,
    /// `(w_i . w_k) M_jl`: a row for each j, with all pairs i <= k.
    products: Vec<S>,
    /// `w_k . OP,l = (y_k, -x_k) . O_lP`, or `z_k` where joint l is prismatic; 0 if joint k is.
    levers: Vec<[S; 2]>,
}

impl<S: Scalar> Second<S> {
    pub fn new(tensors: &GlobalTensors<S>) -> Self {
        let unknown = S::from_f64(f64::NAN);
        let numbers = vec![unknown; tensors.paths.second_len()];
        let paths = &tensors.paths;
        let most = (0..paths.len()).map(|d| paths.depth(d) + 1).max().unwrap_or(0);
        let mut cross_starts = vec![0];
        for d in 0..paths.len() {
            cross_starts.push(cross_starts[d] + triangle(0, paths.depth(d)));
        }
        Self {
            gamma: numbers.clone(),
            mass: numbers,
            crosses: vec![Vec3::zero(); cross_starts[paths.len()]],
            cross_starts,
            products: vec![S::zero(); most * triangle(0, most)],
            levers: vec![[S::zero(); 2]; most],
        }
    }

    pub fn compute(&mut self, tree: &Tree, tensors: &GlobalTensors<S>, first: &First<S>) {
        for d in 0..tensors.paths.len() {
            self.cross_products(tree, tensors, d);
            self.scalar_products(tensors, d);
            self.by_last(tensors, d);
            self.of_last(tensors, first, d);
            self.derivatives_of_mass(tensors, d);
        }
    }

    /// `w_i x w_k` in frame d.
    ///
    /// If joint d is perpendicular or parallel to its parent, rotating a vector is cheaper than recomputing
    /// it, and the vector of parallel axes stays a constant zero.
    fn cross_products(&mut self, tree: &Tree, tensors: &GlobalTensors<S>, d: usize) {
        let (paths, h) = (&tensors.paths, tensors.paths.depth(d));
        let (path, kinds, axes) = (paths.of(d), paths.kinds(d), &tensors.axes[paths.pairs(d)]);
        let transform = tensors.transform(tree, d);
        let square = transform.fixed.gamma.is_none() && transform.fixed.alpha.is_right();
        let (before, here) = self.crosses.split_at_mut(self.cross_starts[d]);
        for k in 1..=h {
            for i in 0..k {
                let at = triangle(i, k - 1);
                here[at] = if kinds[i] == JointKind::Prismatic || kinds[k] == JointKind::Prismatic {
                    Vec3::zero()
                } else if k == h {
                    Vec3::new(axes[i].y, -axes[i].x, S::zero())
                } else if square {
                    transform.vector_down(before[self.cross_starts[path[h - 1]] + at])
                } else {
                    axes[i].cross(axes[k])
                };
            }
        }
    }

    /// `(w_i . w_k) M_jd` and levers. `Z_i . Z_k` is the third component of Z_i in frame k.
    fn scalar_products(&mut self, tensors: &GlobalTensors<S>, d: usize) {
        let (paths, h) = (&tensors.paths, tensors.paths.depth(d));
        let (path, kinds, pairs) = (paths.of(d), paths.kinds(d), paths.pairs(d));
        let (axes, mass) = (&tensors.axes[pairs.clone()], &tensors.mass[pairs]);
        let row = triangle(0, h + 1);
        for k in 0..=h {
            let z = axes[k];
            self.levers[k] = match (kinds[k], kinds[h]) {
                (JointKind::Revolute, JointKind::Revolute) => [z.y, -z.x],
                (JointKind::Revolute, JointKind::Prismatic) => [z.z, S::zero()],
                (JointKind::Prismatic, _) => [S::zero(); 2],
            };
            let in_k = &tensors.axes[paths.pairs(path[k])];
            for i in 0..=k {
                let turning = kinds[i] == JointKind::Revolute && kinds[k] == JointKind::Revolute;
                let cosine = if turning { in_k[i].z } else { S::zero() };
                for (j, &m) in mass.iter().enumerate() {
                    self.products[j * row + triangle(i, k)] = cosine * m;
                }
            }
        }
    }

    /// `Gamma^k_ij,d = A1_ijkd - B1_ijkd` (59) for i < j <= d, k <= j: cases (a) and (b).
    fn by_last(&mut self, tensors: &GlobalTensors<S>, d: usize) {
        let h = tensors.paths.depth(d);
        let kinds = tensors.paths.kinds(d);
        let row = triangle(0, h + 1);
        let crosses = &self.crosses[self.cross_starts[d]..];
        let mut slots = self.gamma[tensors.paths.second_block(d)].iter_mut();
        for j in 0..=h {
            for i in 0..j {
                let s = antisymmetric_moment(tensors, crosses, d, i, j);
                for ((k, kind), slot) in kinds[..=j].iter().enumerate().zip(slots.by_ref()) {
                    *slot = match kind {
                        JointKind::Revolute => {
                            let by_mass = self.products[j * row + triangle(i.min(k), i.max(k))]
                                - self.products[i * row + triangle(k, j)];
                            by_mass - (s[0] * self.levers[k][0] + s[1] * self.levers[k][1])
                        }
                        JointKind::Prismatic => S::zero(),
                    };
                }
            }
        }
    }

    /// `Gamma^k_id,l = A2_idkl - B1_ilkd` (60) for i < k <= l < d: case (c).
    ///
    /// `Gamma^k_il,d` of case (a) has all terms except
    /// `A2_idkl - A1_ilkd = -(w_i x w_k) . int OP,d x OP,l dm`.
    fn of_last(&mut self, tensors: &GlobalTensors<S>, first: &First<S>, d: usize) {
        let h = tensors.paths.depth(d);
        let products = &first.products[tensors.paths.pairs(d)];
        let crosses = &self.crosses[self.cross_starts[d]..];
        let block = &mut self.gamma[tensors.paths.second_block(d)];
        for l in 0..h {
            for k in 1..=l {
                for i in 0..k {
                    let less = crosses[triangle(i, k - 1)].dot(products[l]);
                    block[gamma_of_last(h, k, i, l)] = block[gamma_by_last(k, i, l)] - less;
                }
            }
        }
    }

    /// `M_ii,kd = 2 Gamma^i_ik,d`, `M_ij,kd = Gamma^j_ik,d + Gamma^i_jk,d` (i < j < k),
    /// `M_ik,kd = Gamma^k_ik,d`, `M_ij,kd = Gamma^k_ij,d - Gamma^i_kj,d` (k < j),
    /// `M_id,kl = Gamma^k_id,l - Gamma^i_kd,l` (41).
    ///
    /// The last coefficient is not independent: `Gamma^i_kd,l = Gamma^i_kl,d + Gamma^k_il,d - Gamma^k_id,l`,
    /// (43) for k < l, (44) for k = l.
    fn derivatives_of_mass(&mut self, tensors: &GlobalTensors<S>, d: usize) {
        let h = tensors.paths.depth(d);
        let block = tensors.paths.second_block(d);
        let coefficients = &self.gamma[block.clone()];
        let by_last = |k: usize, i: usize, j: usize| coefficients[gamma_by_last(k, i, j)];
        let mut slots = self.mass[block].iter_mut();
        let mut store = |value| slots.next().into_iter().for_each(|slot| *slot = value);
        for i in 0..h {
            for j in i..=h {
                for k in i + 1..j {
                    store(by_last(k, i, j) - by_last(i, k, j));
                }
                if i < j {
                    store(by_last(j, i, j));
                }
                for k in j + 1..=h {
                    store(by_last(j, i, k) + by_last(i, j, k));
                }
            }
            for k in i + 1..h {
                for l in k..h {
                    let of_last = coefficients[gamma_of_last(h, k, i, l)];
                    let dependent =
                        if k < l { by_last(i, k, l) + by_last(k, i, l) } else { by_last(k, i, k) };
                    store(of_last + of_last - dependent);
                }
            }
        }
    }
}

/// `int (OP,j . w_i - OP,i . w_j) O_dP dm`, first two components, or without O_dP where joint d is prismatic.
///
/// Two revolute joints: `(Z_i x Z_j) . (L_jd + L_id)`.
#[inline]
fn antisymmetric_moment<S: Scalar>(
    tensors: &GlobalTensors<S>,
    crosses: &[Vec3<S>],
    d: usize,
    i: usize,
    j: usize,
) -> [S; 2] {
    let (paths, h, start) = (&tensors.paths, tensors.paths.depth(d), tensors.paths.pairs(d).start);
    let kinds = paths.kinds(d);
    let of_mass = || {
        let p = tensors.bodies[d].first_moment;
        let moments = match kinds[h] {
            JointKind::Revolute => [p.x, p.y],
            JointKind::Prismatic => [S::from_f64(tensors.subtree_mass(d)), S::zero()],
        };
        let cosine = tensors.axes[paths.pairs(paths.of(d)[j]).start + i].z;
        moments.map(|moment| cosine * moment)
    };
    match (kinds[i], kinds[j]) {
        (JointKind::Revolute, JointKind::Revolute) => {
            let cross = crosses[triangle(i, j - 1)];
            let (a, b) = (&tensors.columns[start + i], &tensors.columns[start + j]);
            [cross.dot(a[0] + b[0]), cross.dot(a[1] + b[1])]
        }
        (JointKind::Revolute, JointKind::Prismatic) => of_mass(),
        (JointKind::Prismatic, JointKind::Revolute) => of_mass().map(|moment| -moment),
        (JointKind::Prismatic, JointKind::Prismatic) => [S::zero(); 2],
    }
}
