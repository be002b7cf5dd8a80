//! The Hessian of the Lagrangian from the derivatives of M, contracted with v.

use super::derivatives::MassMatrixDerivatives;
use crate::error::{EvalError, check_length};
use crate::kernels::{Coupled, LagrangianHessian, positions, rates, size_of_sum};
use crate::matrix::Matrix;
use crate::robot::{JointKind, Tree};
use crate::scalar::Scalar;
use crate::spatial::Vec3;

/// `P_ik = sum_j M_ij,k v_j`, `L_qq,kl = 1/2 v' M,kl v - V,kl` from Christoffel coefficients: (20)-(22).
///
/// Armature is added to M and p, springs to L_q and L_qq; mimic joints are coupled last. Gravity: with `D_jj
/// = int OP,j dm = Z_j x Pi_jj` (revolute) or `M_j Z_j` (prismatic), `-V,j = g . D_jj` and `-V,ij = w_i .
/// (D_jj x g)` for i <= j, `w_i = sbar_i Z_i`.
#[derive(Clone, Debug)]
pub struct ChristoffelKernel<S> {
    derivatives: MassMatrixDerivatives<S>,
    gravity: Vec<Vec3<S>>,
    q: Vec<S>,
    v: Vec<S>,
    half_v: Vec<S>,
    /// `sum_j M_ij,k v_j` over i < j, including `1/2 M_ii,k v_i`, and that term alone; i < k.
    upper: Vec<[S; 2]>,
    /// `v_i v_j`, i < j, and `1/2 v_i^2`.
    squares: Vec<S>,
    mass_matrix: Coupled<Matrix<S>>,
    momentum: Coupled<Vec<S>>,
    l_q: Coupled<Vec<S>>,
    l_vq: Coupled<Matrix<S>>,
    l_qq: Coupled<Matrix<S>>,
}

impl<S: Scalar> ChristoffelKernel<S> {
    /// The derivatives of M at the position set last.
    pub fn derivatives(&self) -> &MassMatrixDerivatives<S> {
        &self.derivatives
    }

    /// `M v`, armature included.
    fn set_momentum(&mut self, tree: &Tree) {
        self.momentum.all.fill(S::zero());
        let mut add = |i: usize, j: usize, entry: S| {
            self.momentum.all[i] += entry * self.v[j];
            if i != j {
                self.momentum.all[j] += entry * self.v[i];
            }
        };
        let paths = &self.derivatives.tensors.paths;
        for d in 0..tree.joints().len() {
            paths.of(d).iter().for_each(|&i| add(d, i, self.mass_matrix.all[(d, i)]));
        }
        for &(i, j, value) in tree.armature() {
            if paths.on_one_branch([i, j]).is_none() {
                add(i, j, S::from_f64(value));
            }
        }
    }

    /// `L_q,k = sum_i v_i (sum_{j>i} M_ij,k v_j + 1/2 M_ii,k v_i) - V,k`.
    fn set_gradient(&mut self, tree: &Tree) {
        let tensors = &self.derivatives.tensors;
        self.upper.fill([S::zero(); 2]);
        for d in 0..tree.joints().len() {
            let (path, start) = (tensors.paths.of(d), tensors.paths.pairs(d).start);
            let h = path.len() - 1;
            let mut rates = self.derivatives.first.mass[tensors.paths.first_block(d)].iter();
            for i in 0..h {
                for (&j, &rate) in path[i..h].iter().zip(rates.by_ref()) {
                    if j == path[i] {
                        let own = rate * self.half_v[j];
                        self.upper[start + i][1] = own;
                        self.upper[start + i][0] += own;
                    } else {
                        self.upper[start + i][0] += rate * self.v[j];
                    }
                }
                for (&k, &rate) in path[i + 1..].iter().zip(rates.by_ref()) {
                    self.upper[tensors.paths.pairs(k).start + i][0] += rate * self.v[d];
                }
            }
        }
        for (k, joint) in tree.joints().iter().enumerate() {
            let (p, g) = (tensors.bodies[k].first_moment, self.gravity[k]);
            let mut gradient = match joint.kind {
                JointKind::Revolute => p.x * g.y - p.y * g.x,
                JointKind::Prismatic => g.z.times(joint.subtree_mass),
            };
            if joint.spring.stiffness != 0.0 {
                gradient -= self.q[k].plus(-joint.spring.rest).times(joint.spring.stiffness);
            }
            let path = tensors.paths.of(k);
            for (&i, upper) in path[..path.len() - 1].iter().zip(&self.upper[tensors.paths.pairs(k)]) {
                gradient += self.v[i] * upper[0];
            }
            self.l_q.all[k] = gradient;
        }
    }

    /// `P_ik = sum_j M_ij,k v_j` (21a).
    fn set_mixed(&mut self, tree: &Tree) {
        let paths = &self.derivatives.tensors.paths;
        self.l_vq.all.fill_zero();
        for k in 0..tree.joints().len() {
            for (&i, upper) in paths.of(k).iter().zip(&self.upper[paths.pairs(k)]) {
                self.l_vq.all[(i, k)] = upper[0] + upper[1];
            }
        }
        for d in 0..tree.joints().len() {
            let path = paths.of(d);
            let h = path.len() - 1;
            let mut rates = self.derivatives.first.mass[paths.first_block(d)].iter();
            for i in 0..h {
                let v = self.v[path[i]];
                for (&j, &rate) in path[i..h].iter().zip(rates.by_ref()) {
                    if j != path[i] {
                        self.l_vq.all[(j, d)] += rate * v;
                    }
                }
                for (&k, &rate) in path[i + 1..].iter().zip(rates.by_ref()) {
                    self.l_vq.all[(d, k)] += rate * v;
                }
            }
        }
    }

    /// `L_qq,kl = sum_{i<=j} M_ij,kl v_i v_j - V,kl`, k <= l, with `1/2 v_i^2` for i = j (22).
    fn set_curvature(&mut self, tree: &Tree) {
        self.set_weight(tree);
        let paths = &self.derivatives.tensors.paths;
        for d in 0..tree.joints().len() {
            let (path, pairs) = (paths.of(d), paths.pairs(d));
            let h = path.len() - 1;
            let mut rates = self.derivatives.second.mass[paths.second_block(d)].iter();
            for i in 0..h {
                for &j in &path[i..] {
                    let square = self.squares[paths.pairs(j).start + i];
                    for (&k, &rate) in path[i + 1..].iter().zip(rates.by_ref()) {
                        self.l_qq.all[(k, d)] += rate * square;
                    }
                }
                let square = self.squares[pairs.start + i];
                for k in i + 1..h {
                    for (&l, &rate) in path[k..h].iter().zip(rates.by_ref()) {
                        self.l_qq.all[(path[k], l)] += rate * square;
                    }
                }
            }
        }
        for d in 0..tree.joints().len() {
            for &i in paths.of(d) {
                self.l_qq.all[(d, i)] = self.l_qq.all[(i, d)];
            }
        }
    }

    /// `-V,ij = w_i . (D_jj x g)`, minus the stiffness of springs.
    fn set_weight(&mut self, tree: &Tree) {
        let tensors = &self.derivatives.tensors;
        for (j, joint) in tree.joints().iter().enumerate() {
            let (p, g) = (tensors.bodies[j].first_moment, self.gravity[j]);
            let turned = match joint.kind {
                JointKind::Revolute => Vec3::new(p.x * g.z, p.y * g.z, -(p.x * g.x + p.y * g.y)),
                JointKind::Prismatic => Vec3::new(-g.y, g.x, S::zero()).times(joint.subtree_mass),
            };
            let on_path = tensors.paths.of(j).iter().zip(tensors.paths.kinds(j));
            for ((&i, kind), axis) in on_path.zip(&tensors.axes[tensors.paths.pairs(j)]) {
                self.l_qq.all[(i, j)] = match kind {
                    JointKind::Revolute => axis.dot(turned),
                    JointKind::Prismatic => S::zero(),
                };
            }
            if joint.spring.stiffness != 0.0 {
                self.l_qq.all[(j, j)] = self.l_qq.all[(j, j)].plus(-joint.spring.stiffness);
            }
        }
    }
}

impl<S: Scalar> LagrangianHessian<S> for ChristoffelKernel<S> {
    #[inline(never)]
    fn new(tree: &Tree) -> Self {
        let (n, pairs) = (tree.joints().len(), tree.pairs());
        let vector = vec![S::zero(); n];
        Self {
            derivatives: MassMatrixDerivatives::new(tree),
            gravity: vec![Vec3::zero(); n],
            q: vector.clone(),
            v: vector.clone(),
            half_v: vector,
            upper: vec![[S::zero(); 2]; pairs],
            squares: vec![S::zero(); pairs],
            mass_matrix: Coupled::square(tree),
            momentum: Coupled::row(tree),
            l_q: Coupled::row(tree),
            l_vq: Coupled::square(tree),
            l_qq: Coupled::square(tree),
        }
    }

    #[inline(never)]
    fn set_position(&mut self, tree: &Tree, q: &[S]) -> Result<(), EvalError> {
        self.derivatives.set_position(tree, q)?;
        positions(tree, q, &mut self.q);
        let tensors = &self.derivatives.tensors;
        for (d, joint) in tree.joints().iter().enumerate() {
            let outer = joint.parent.map_or(Vec3::constant(tree.gravity()), |p| self.gravity[p]);
            self.gravity[d] = tensors.gravity_in(tree, d, outer);
            for (&i, &entry) in tensors.paths.of(d).iter().zip(&tensors.mass[tensors.paths.pairs(d)]) {
                self.mass_matrix.all[(i, d)] = entry;
                self.mass_matrix.all[(d, i)] = entry;
            }
        }
        for &(i, j, value) in tree.armature() {
            let on_one_branch = tensors.paths.on_one_branch([i, j]).is_some();
            let entry =
                if on_one_branch { self.mass_matrix.all[(i, j)].plus(value) } else { S::from_f64(value) };
            self.mass_matrix.all[(i, j)] = entry;
            self.mass_matrix.all[(j, i)] = entry;
        }
        self.mass_matrix.sum_symmetric(tree);
        Ok(())
    }

    #[inline(never)]
    fn set_velocity(&mut self, tree: &Tree, v: &[S]) -> Result<(), EvalError> {
        check_length("v", v, tree.dof())?;
        rates(tree, v, &mut self.v);
        self.half_v.iter_mut().zip(&self.v).for_each(|(half, v)| *half = v.times(0.5));
        self.derivatives.first_derivatives();
        self.set_momentum(tree);
        self.set_gradient(tree);
        self.momentum.sum(tree);
        self.l_q.sum(tree);
        Ok(())
    }

    #[inline(never)]
    fn second_order(&mut self, tree: &Tree) {
        self.derivatives.second_derivatives(tree);
        let paths = &self.derivatives.tensors.paths;
        for d in 0..tree.joints().len() {
            for (&i, square) in paths.of(d).iter().zip(&mut self.squares[paths.pairs(d)]) {
                *square = if i == d { self.half_v[d] * self.v[d] } else { self.v[i] * self.v[d] };
            }
        }
        self.set_mixed(tree);
        self.set_curvature(tree);
        self.l_vq.sum(tree);
        self.l_qq.sum_symmetric(tree);
    }

    fn mass_matrix(&self) -> &Matrix<S> {
        self.mass_matrix.get()
    }

    fn size_of_entry(&self, tree: &Tree, k: usize) -> S {
        size_of_sum(tree, k, |joint| {
            let mass = self.mass_matrix.all[(joint, joint)];
            match tree.joints()[joint].kind {
                JointKind::Revolute => self.derivatives.tensors.size_of_mass(joint, mass),
                JointKind::Prismatic => mass,
            }
        })
    }

    #[inline(never)]
    fn potential(&self, tree: &Tree) -> S {
        let mut potential = S::zero();
        for (k, joint) in tree.joints().iter().enumerate() {
            if joint.parent.is_none() {
                potential -= self.derivatives.tensors.weight_moment(k, self.gravity[k], tree.gravity());
            }
            if joint.spring.stiffness != 0.0 {
                let stretch = self.q[k].plus(-joint.spring.rest);
                potential += (stretch * stretch).times(0.5 * joint.spring.stiffness);
            }
        }
        potential
    }

    fn momentum(&self) -> &[S] {
        self.momentum.get()
    }

    fn l_q(&self) -> &[S] {
        self.l_q.get()
    }

    fn l_vq(&self) -> &Matrix<S> {
        self.l_vq.get()
    }

    fn l_qq(&self) -> &Matrix<S> {
        self.l_qq.get()
    }
}
