//! Christoffel coefficients and first derivatives of M.

use super::global::GlobalTensors;
use super::paths::gamma;
use crate::robot::JointKind;
use crate::scalar::Scalar;
use crate::spatial::Vec3;

/// The independent `Gamma^k_ij` and `M_ij,k`, block by block.
#[derive(Clone, Debug)]
pub(super) struct First<S> {
    /// `c_ij = int OP,j x OP,i dm` in frame j.
    pub products: Vec<Vec3<S>>,
    pub gamma: Vec<S>,
    pub mass: Vec<S>,
}

impl<S: Scalar> First<S> {
    pub fn new(tensors: &GlobalTensors<S>) -> Self {
        let unknown = S::from_f64(f64::NAN);
        let numbers = vec![unknown; tensors.paths.first_len()];
        Self {
            products: vec![Vec3::zero(); tensors.paths.all_pairs()],
            gamma: numbers.clone(),
            mass: numbers,
        }
    }

    pub fn compute(&mut self, tensors: &mut GlobalTensors<S>) {
        for d in 0..tensors.paths.len() {
            match tensors.paths.kinds(d)[tensors.paths.depth(d)] {
                JointKind::Revolute => self.beyond_revolute(tensors, d),
                JointKind::Prismatic => self.beyond_prismatic(tensors, d),
            }
            self.coefficients(tensors, d);
            self.derivatives_of_mass(tensors, d);
        }
    }

    /// c_id for i < d: the coefficients of x_k, y_k, z_k in (A4.3); `(Z_d x Pi_dd) x Z_i` for a prismatic
    /// joint i.
    fn beyond_revolute(&mut self, tensors: &mut GlobalTensors<S>, d: usize) {
        tensors.complete_columns(d);
        let p = tensors.bodies[d].first_moment;
        let h = tensors.paths.depth(d);
        for (pair, kind) in tensors.paths.pairs(d).zip(tensors.paths.kinds(d)).take(h) {
            let axis = tensors.axes[pair];
            self.products[pair] = match kind {
                JointKind::Revolute => {
                    let [first, second] = &tensors.columns[pair];
                    Vec3::new(
                        axis.x * first.y - axis.y * first.x,
                        axis.x * second.y - axis.y * second.x,
                        axis.x * second.z - axis.y * first.z + axis.z * (first.y - second.x),
                    )
                }
                JointKind::Prismatic => Vec3::new(axis.z * p.x, axis.z * p.y, -(axis.x * p.x + axis.y * p.y)),
            };
        }
    }

    /// c_id for i < d: `Z_d x (Z_i x Pi_id)`, and `M_d Z_d x Z_i` for a prismatic joint i.
    fn beyond_prismatic(&mut self, tensors: &GlobalTensors<S>, d: usize) {
        let mass = tensors.subtree_mass(d);
        let h = tensors.paths.depth(d);
        for (pair, kind) in tensors.paths.pairs(d).zip(tensors.paths.kinds(d)).take(h) {
            let axis = tensors.axes[pair];
            let [x, y] = match kind {
                JointKind::Revolute => {
                    let p = tensors.columns[pair][0];
                    [axis.y * p.z - axis.z * p.y, axis.z * p.x - axis.x * p.z]
                }
                JointKind::Prismatic => [axis.x.times(mass), axis.y.times(mass)],
            };
            self.products[pair] = Vec3::new(-y, x, S::zero());
        }
    }

    /// `Gamma^k_id = sbar_k Z_k . c_id` for i < d, k <= d: (63) with Z_k factored out, (A4.3).
    fn coefficients(&mut self, tensors: &GlobalTensors<S>, d: usize) {
        let (pairs, kinds) = (tensors.paths.pairs(d), tensors.paths.kinds(d));
        let axes = &tensors.axes[pairs.clone()];
        let mut slots = self.gamma[tensors.paths.first_block(d)].iter_mut();
        for c in &self.products[pairs.start..pairs.end - 1] {
            for ((&axis, &kind), slot) in axes.iter().zip(kinds).zip(slots.by_ref()) {
                *slot = match kind {
                    JointKind::Revolute => axis.dot(*c),
                    JointKind::Prismatic => S::zero(),
                };
            }
        }
    }

    /// `M_ii,d = 2 Gamma^i_id`, `M_ij,d = Gamma^j_id + Gamma^i_jd`, `M_id,d = Gamma^d_id`,
    /// `M_id,k = Gamma^k_id - Gamma^i_kd` (39).
    fn derivatives_of_mass(&mut self, tensors: &GlobalTensors<S>, d: usize) {
        let h = tensors.paths.depth(d);
        let block = tensors.paths.first_block(d);
        let coefficients = &self.gamma[block.clone()];
        let of = |k: usize, i: usize| coefficients[gamma(h, k, i)];
        let mut slots = self.mass[block].iter_mut();
        let mut store = |value| slots.next().into_iter().for_each(|slot| *slot = value);
        for i in 0..h {
            for j in i..h {
                store(of(j, i) + of(i, j));
            }
            for k in i + 1..h {
                store(of(k, i) - of(i, k));
            }
            store(of(h, i));
        }
    }
}
