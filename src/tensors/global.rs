//! First- and second-order global inertia tensors and the mass matrix.

use super::bodies::{AugmentedBody, Body};
use super::paths::Paths;
use crate::error::{EvalError, check_length};
use crate::kernels::positions;
use crate::robot::{JointFrame, JointKind, Tree};
use crate::scalar::Scalar;
use crate::spatial::{JointPosition, Symmetric3, Transform, Vec3};

/// `Pi_ij = int O_iP dm` (66) and `L_ij = int O_iP (x) O_jP dm` (67) over all that joint j moves, i <= j, in
/// frame j; and M.
///
/// With `L_ij = [[A, F, (E)], [I, B, (D)], [H, G, (C)]]` (A4.1): L_jj is kept whole, since the change of
/// frame mixes all six of its numbers, L_ij with i < j without its third column, which is never used. If
/// joint j is prismatic, only Pi_ij is needed.
#[derive(Clone, Debug)]
pub struct GlobalTensors<S> {
    pub(super) paths: Paths,
    augmented: Vec<AugmentedBody>,
    /// Origin of each frame in the frame of its parent, with prismatic joints at zero.
    origins: Vec<[f64; 3]>,
    masses: Vec<f64>,
    /// Coordinates of all joints.
    q: Vec<S>,
    positions: Vec<JointPosition<S>>,
    pub(super) bodies: Vec<Body<S>>,
    /// Z_i in frame j.
    pub(super) axes: Vec<Vec3<S>>,
    /// `Lambda_ij = O_iO_j` in frame j, i revolute.
    arms: Vec<Vec3<S>>,
    /// First and second column of L_ij; Pi_ij and zero where j is prismatic.
    pub(super) columns: Vec<[Vec3<S>; 2]>,
    /// M_ij without armature.
    pub(super) mass: Vec<S>,
}

impl<S: Scalar> GlobalTensors<S> {
    /// Buffers and constants for this tree.
    pub fn new(tree: &Tree) -> Self {
        let paths = Paths::new(tree);
        let origins: Vec<_> = tree.joints().iter().map(|joint| joint.screw.origin()).collect();
        let augmented = AugmentedBody::of_links(tree, &origins);
        let pairs = paths.all_pairs();
        let mut axes = vec![Vec3::zero(); pairs];
        for d in 0..tree.joints().len() {
            axes[paths.pairs(d).end - 1] = Vec3::constant([0.0, 0.0, 1.0]);
        }
        Self {
            masses: tree.joints().iter().map(|joint| joint.subtree_mass).collect(),
            positions: tree.joints().iter().map(|joint| joint.position(S::zero())).collect(),
            bodies: augmented.iter().map(AugmentedBody::lift).collect(),
            axes,
            arms: vec![Vec3::zero(); pairs],
            columns: vec![[Vec3::zero(); 2]; pairs],
            mass: vec![S::zero(); pairs],
            q: vec![S::zero(); tree.joints().len()],
            paths,
            augmented,
            origins,
        }
    }

    /// Computes M and the tensors that it needs at q (rad, m; length n).
    ///
    /// # Errors
    /// [`EvalError::WrongLength`]. Values are not checked here.
    pub fn set_position(&mut self, tree: &Tree, q: &[S]) -> Result<(), EvalError> {
        tree.refuse_free()?;
        check_length("q", q, tree.dof())?;
        positions(tree, q, &mut self.q);
        for (d, joint) in tree.joints().iter().enumerate() {
            self.positions[d] = joint.position(self.q[d]);
            self.bodies[d] = self.augmented[d].lift();
            if let Some(parent) = joint.parent {
                self.carry_down(joint, d, parent);
            }
        }
        for (d, joint) in tree.joints().iter().enumerate().rev() {
            if let Some(parent) = joint.parent {
                let moved = self.bodies[d].moved_up(&joint.transform_at(self.positions[d]), self.masses[d]);
                self.bodies[parent].add(&moved);
            }
        }
        for (d, joint) in tree.joints().iter().enumerate() {
            match joint.kind {
                JointKind::Revolute => self.beyond_revolute(d),
                JointKind::Prismatic => self.beyond_prismatic(d),
            }
        }
        Ok(())
    }

    /// Z_i and `Lambda_id = Lambda_ip + Lambda_pd`, i < d, from the frame of the parent p to that of d.
    fn carry_down(&mut self, joint: &JointFrame, d: usize, parent: usize) {
        let transform = joint.transform_at(self.positions[d]);
        let kinds = self.paths.kinds(d);
        for ((from, to), kind) in self.paths.pairs(parent).zip(self.paths.pairs(d)).zip(kinds) {
            self.axes[to] = transform.vector_down(self.axes[from]);
            if *kind == JointKind::Revolute {
                self.arms[to] = transform.vector_down(self.arms[from].plus(self.origins[d]));
                if let JointPosition::Translated(distance) = transform.joint {
                    self.arms[to].z += distance;
                }
            }
        }
    }

    /// `M_id = -x_i H - y_i G + z_i (A + B)` (A4.2), and `[Z_i, Z_d, Pi_dd]` for a prismatic joint i.
    fn beyond_revolute(&mut self, d: usize) {
        let (p, l) = (self.bodies[d].first_moment, self.bodies[d].tensor);
        for (pair, kind) in self.paths.pairs(d).zip(self.paths.kinds(d)) {
            let axis = self.axes[pair];
            self.mass[pair] = match kind {
                JointKind::Revolute => {
                    let arm = self.arms[pair];
                    let [first, second] = &mut self.columns[pair];
                    (first.x, first.z) = (l.xx + arm.x * p.x, l.xz + arm.z * p.x);
                    (second.y, second.z) = (l.yy + arm.y * p.y, l.yz + arm.z * p.y);
                    axis.z * (first.x + second.y) - axis.x * first.z - axis.y * second.z
                }
                JointKind::Prismatic => axis.y * p.x - axis.x * p.y,
            };
        }
    }

    /// `M_id = [Z_i, Pi_id, Z_d]`, and `M_d Z_i . Z_d` for a prismatic joint i (62).
    fn beyond_prismatic(&mut self, d: usize) {
        let (p, mass) = (self.bodies[d].first_moment, self.masses[d]);
        for (pair, kind) in self.paths.pairs(d).zip(self.paths.kinds(d)) {
            let axis = self.axes[pair];
            self.mass[pair] = match kind {
                JointKind::Revolute => {
                    let moment = p + self.arms[pair].times(mass);
                    self.columns[pair][0] = moment;
                    axis.x * moment.y - axis.y * moment.x
                }
                JointKind::Prismatic => axis.z.times(mass),
            };
        }
    }

    /// I and F of L_id, i <= d, which M does not need.
    pub(super) fn complete_columns(&mut self, d: usize) {
        for (at, pair) in self.paths.pairs(d).enumerate() {
            if self.paths.kinds(d)[at] == JointKind::Revolute {
                (self.columns[pair][0].y, self.columns[pair][1].x) = self.off_diagonal(d, pair);
            }
        }
    }

    /// Gravity g (m/s^2), in frame d; `outer` is g in the frame of its parent.
    pub(super) fn gravity_in(&self, tree: &Tree, d: usize, outer: Vec3<S>) -> Vec3<S> {
        self.transform(tree, d).vector_down(outer)
    }

    /// From frame d to that of the parent and back.
    pub(super) fn transform<'a>(&self, tree: &'a Tree, d: usize) -> Transform<'a, S> {
        tree.joints()[d].transform_at(self.positions[d])
    }

    /// `int OP . g dm` over all that a joint d on the fixed base moves, O the origin of the world; `gravity`
    /// in frame d.
    pub(super) fn weight_moment(&self, d: usize, gravity: Vec3<S>, world_gravity: [f64; 3]) -> S {
        let base: f64 = self.origins[d].iter().zip(world_gravity).map(|(r, g)| r * g).sum();
        let here = gravity.dot(self.bodies[d].first_moment).plus(self.masses[d] * base);
        match self.positions[d] {
            JointPosition::Rotated(_) | JointPosition::Oriented(_) => here,
            JointPosition::Translated(distance) => here + (distance * gravity.z).times(self.masses[d]),
        }
    }

    /// Mass M_j of all that joint j moves (kg).
    pub fn subtree_mass(&self, j: usize) -> f64 {
        self.masses[j]
    }

    /// Position of the pair (i, j), i <= j, in storage.
    fn pair(&self, i: usize, j: usize) -> Option<usize> {
        let (deepest, [at, _]) = self.paths.on_one_branch([i, j])?;
        (deepest == j).then_some(self.paths.pairs(j).start + at)
    }

    /// Z_i in frame j; `None` unless i <= j.
    pub fn axis(&self, i: usize, j: usize) -> Option<Vec3<S>> {
        self.pair(i, j).map(|pair| self.axes[pair])
    }

    /// `Pi_ij = Pi_jj + M_j Lambda_ij` (A3.9) in frame j (kg m); `None` unless i <= j and i is j or revolute.
    pub fn first_moment(&self, i: usize, j: usize) -> Option<Vec3<S>> {
        let pair = self.pair(i, j)?;
        let known = i == j || self.paths.kinds(j)[self.paths.depth(i)] == JointKind::Revolute;
        known.then(|| self.bodies[j].first_moment + self.arms[pair].times(self.masses[j]))
    }

    /// `L_jj = int O_jP (x) O_jP dm` in frame j (kg m^2).
    pub fn tensor(&self, j: usize) -> Symmetric3<S> {
        self.bodies[j].tensor
    }

    /// First and second column of `L_ij = L_jj + Lambda_ij (x) Pi_jj` (A3.9) in frame j (kg m^2), (A, I, H)
    /// and (F, B, G); `None` unless i <= j and both joints are revolute.
    pub fn columns(&self, i: usize, j: usize) -> Option<[Vec3<S>; 2]> {
        let pair = self.pair(i, j)?;
        let kinds = self.paths.kinds(j);
        if [i, j].iter().any(|&k| kinds[self.paths.depth(k)] == JointKind::Prismatic) {
            return None;
        }
        let [mut first, mut second] = self.columns[pair];
        (first.y, second.x) = self.off_diagonal(j, pair);
        Some([first, second])
    }

    /// I and F of L_id (A4.1), `pair` the position of (i, d).
    fn off_diagonal(&self, d: usize, pair: usize) -> (S, S) {
        let (p, l, arm) = (self.bodies[d].first_moment, self.bodies[d].tensor, self.arms[pair]);
        (l.xy + arm.y * p.x, l.xy + arm.x * p.y)
    }

    /// M_ij without armature (62); 0 for joints on different branches.
    pub fn mass(&self, i: usize, j: usize) -> S {
        match self.paths.on_one_branch([i, j]) {
            Some((d, positions)) => self.mass[self.paths.pairs(d).start + positions[0].min(positions[1])],
            None => S::zero(),
        }
    }

    /// `M_dd + L_yy + L_xx + 2 L_zz`: the scale of the rounding error of M_dd, d revolute.
    pub(super) fn size_of_mass(&self, d: usize, mass: S) -> S {
        let l = &self.bodies[d].tensor;
        mass + l.xx + l.yy + l.zz + l.zz
    }
}
