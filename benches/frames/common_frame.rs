//! Kernel one in one common frame: the alternative to the body frames of the library.
//!
//! The frame is that of the first joint before it moves, so that the first axis is z through the origin: of
//! all common frames the one in which most products vanish. Nothing is carried along the chain; M, P and L_qq
//! are the products of the arrays S, psi, gamma with F and G, one array entry a joint, `LANES` joints side by
//! side.

use crate::constants::{Link, Pose, roots};
use costate::matrix::Matrix;
use costate::robot::{JointFrame, JointKind, Tree};
use costate::scalar::Scalar;
use costate::spatial::{Force, Inertia, Motion, Vec3};
use std::array::from_fn;

/// S, psi and the linear part of gamma (its angular part is zero) of `LANES` joints.
#[derive(Clone, Copy)]
struct Columns<S, const LANES: usize> {
    s: [[S; LANES]; 6],
    psi: [[S; LANES]; 6],
    gamma: [[S; LANES]; 3],
}

#[inline(always)]
fn products<S: Scalar, const LANES: usize, const K: usize>(rows: &[[S; LANES]; K], f: &[S; K]) -> [S; LANES] {
    let mut sums: [S; LANES] = from_fn(|lane| rows[0][lane] * f[0]);
    for c in 1..K {
        for lane in 0..LANES {
            sums[lane] += rows[c][lane] * f[c];
        }
    }
    sums
}

#[inline(always)]
fn scaled<S: Scalar>(a: Vec3<S>, factor: S) -> Vec3<S> {
    Vec3::new(a.x * factor, a.y * factor, a.z * factor)
}

#[inline(always)]
fn entries<S>(a: Vec3<S>, b: Vec3<S>) -> [S; 6] {
    [a.x, a.y, a.z, b.x, b.y, b.z]
}

/// Turns two axes within their plane.
#[inline(always)]
fn turn<S: Scalar>(a: &mut Vec3<S>, b: &mut Vec3<S>, by: impl Fn(Vec3<S>, Vec3<S>) -> [Vec3<S>; 2]) {
    [*a, *b] = by(*a, *b);
}

/// Value, gradient and Hessian of the Lagrangian, as `costate::kernels::KernelOne`.
pub struct CommonFrame<S, const LANES: usize> {
    gravity: [f64; 3],
    /// Where joints on the world stand.
    roots: Vec<Option<Pose<f64>>>,
    links: Vec<Link>,
    /// For each joint its ancestors (without itself): groups of `LANES` joints, and which of the group they
    /// are.
    groups: Vec<Vec<(usize, [bool; LANES])>>,
    poses: Vec<Pose<S>>,
    axes: Vec<Motion<S>>,
    rates: Vec<Motion<S>>,
    velocities: Vec<Motion<S>>,
    columns: Vec<Columns<S, LANES>>,
    composites: Vec<Inertia<S>>,
    momenta: Vec<Force<S>>,
    pub mass_matrix: Matrix<S>,
    pub momentum: Vec<S>,
    pub gradient: Vec<S>,
    pub coupling: Matrix<S>,
    pub stiffness: Matrix<S>,
}

impl<S: Scalar, const LANES: usize> CommonFrame<S, LANES> {
    pub fn new(tree: &Tree) -> Self {
        let n = tree.dof();
        let (roots, gravity) = roots(tree);
        let groups = (0..n).map(|j| {
            let is_ancestor = |i: usize| i < j && tree.subtree(i).contains(&j);
            let member = |group: usize| (group, from_fn(|lane| is_ancestor(group * LANES + lane)));
            (0..n.div_ceil(LANES)).map(member).filter(|(_, is)| is.contains(&true)).collect()
        });
        let zero = S::zero();
        let none = Columns { s: [[zero; LANES]; 6], psi: [[zero; LANES]; 6], gamma: [[zero; LANES]; 3] };
        Self {
            gravity,
            roots,
            links: tree.joints().iter().map(Link::new).collect(),
            groups: groups.collect(),
            poses: vec![Pose { axes: [Vec3::zero(); 3], origin: Vec3::zero() }; n],
            axes: vec![Motion::zero(); n],
            rates: vec![Motion::zero(); n],
            velocities: vec![Motion::zero(); n],
            columns: vec![none; n.div_ceil(LANES)],
            composites: tree.joints().iter().map(|joint| joint.inertia.lift()).collect(),
            momenta: vec![Force::zero(); n],
            mass_matrix: Matrix::zeros(n, n),
            momentum: vec![zero; n],
            gradient: vec![zero; n],
            coupling: Matrix::zeros(n, n),
            stiffness: Matrix::zeros(n, n),
        }
    }

    /// M, p, L_q, P and L_qq at (q, v).
    pub fn evaluate(&mut self, tree: &Tree, q: &[S], v: &[S]) {
        for (i, joint) in tree.joints().iter().enumerate() {
            self.outward(i, joint, q[i], v[i]);
        }
        for (j, joint) in tree.joints().iter().enumerate().rev() {
            self.inward(j, joint);
            if joint.spring.stiffness != 0.0 {
                self.stiffness[(j, j)] = self.stiffness[(j, j)].plus(-joint.spring.stiffness);
                self.gradient[j] -= q[j].plus(-joint.spring.rest).times(joint.spring.stiffness);
            }
        }
        for &(i, j, value) in tree.armature() {
            let on_one_path = tree.subtree(j).contains(&i);
            let entry = if on_one_path { self.mass_matrix[(i, j)].plus(value) } else { S::from_f64(value) };
            self.mass_matrix[(i, j)] = entry;
            self.mass_matrix[(j, i)] = entry;
            self.momentum[i] += v[j].times(value);
            if i != j {
                self.momentum[j] += v[i].times(value);
            }
        }
    }

    /// Pose, S, velocity, psi, gamma, inertia and momentum of one joint and its link.
    #[inline(always)]
    fn outward(&mut self, i: usize, joint: &JointFrame, q: S, v: S) {
        let pose = self.pose(i, joint, q);
        let axis = pose.axes[2];
        let parent = joint.parent.map(|parent| self.velocities[parent]);
        let (s, velocity, psi, gamma);
        match joint.kind {
            JointKind::Revolute => {
                s = Motion { angular: axis, linear: pose.origin.cross(axis) };
                let (w, u) = (scaled(s.angular, v), scaled(s.linear, v));
                velocity = parent.map_or(Motion { angular: w, linear: u }, |parent| Motion {
                    angular: parent.angular + w,
                    linear: parent.linear + u,
                });
                psi = Motion {
                    angular: velocity.angular.cross(axis),
                    linear: velocity.angular.cross(s.linear) + velocity.linear.cross(axis),
                };
                gamma = -axis.cross_constant(self.gravity);
            }
            JointKind::Prismatic => {
                s = Motion { angular: Vec3::zero(), linear: axis };
                let u = scaled(axis, v);
                velocity = parent.map_or(Motion { angular: Vec3::zero(), linear: u }, |parent| Motion {
                    angular: parent.angular,
                    linear: parent.linear + u,
                });
                psi = Motion { angular: Vec3::zero(), linear: velocity.angular.cross(axis) };
                gamma = Vec3::zero();
            }
        }
        let (group, lane) = (&mut self.columns[i / LANES], i % LANES);
        let (all_s, all_psi) = (entries(s.angular, s.linear), entries(psi.angular, psi.linear));
        for c in 0..6 {
            group.s[c][lane] = all_s[c];
            group.psi[c][lane] = all_psi[c];
        }
        [group.gamma[0][lane], group.gamma[1][lane], group.gamma[2][lane]] = [gamma.x, gamma.y, gamma.z];
        let inertia = self.links[i].place(&pose);
        self.momenta[i] = inertia.apply(velocity);
        self.composites[i] = Inertia { mass: joint.subtree_mass, ..inertia };
        (self.poses[i], self.axes[i], self.rates[i], self.velocities[i]) = (pose, s, psi, velocity);
    }

    #[inline(always)]
    fn pose(&self, i: usize, joint: &JointFrame, q: S) -> Pose<S> {
        let q = if joint.offset == 0.0 { q } else { q.plus(joint.offset) };
        let ([mut x, mut y, mut z], mut origin);
        if let Some(root) = &self.roots[i] {
            [x, y, z] = root.axes.map(|a| Vec3::constant([a.x, a.y, a.z]));
            origin = Vec3::constant([root.origin.x, root.origin.y, root.origin.z]);
        } else {
            let parent = &self.poses[joint.parent.unwrap()];
            [x, y, z] = parent.axes;
            if let Some([sin, cos]) = joint.screw.gamma.map(|gamma| gamma.sin_cos()) {
                turn(&mut x, &mut y, |x, y| [x.times(cos) + y.times(sin), y.times(cos) - x.times(sin)]);
            }
            origin = parent.origin + Pose { axes: [x, y, z], ..*parent }.turn(joint.screw.translation);
            let [sin, cos] = joint.screw.alpha.sin_cos();
            turn(&mut y, &mut z, |y, z| [y.times(cos) + z.times(sin), z.times(cos) - y.times(sin)]);
            origin = origin + z.times(joint.screw.rise);
        }
        match joint.kind {
            JointKind::Revolute => {
                let (sin, cos) = q.sin_cos();
                turn(&mut x, &mut y, |x, y| {
                    [scaled(x, cos) + scaled(y, sin), scaled(y, cos) - scaled(x, sin)]
                });
            }
            JointKind::Prismatic => origin = origin + scaled(z, q),
        }
        Pose { axes: [x, y, z], origin }
    }

    /// F, G and the entries of one joint with its ancestors; its composite body joins that of its parent.
    #[inline(always)]
    fn inward(&mut self, j: usize, joint: &JointFrame) {
        let (s, psi, composite, momentum) =
            (self.axes[j], self.rates[j], self.composites[j], self.momenta[j]);
        let (f, mut g);
        match joint.kind {
            JointKind::Revolute => {
                f = composite.apply(s);
                g = composite.apply(psi);
                g.moment = g.moment + s.angular.cross(momentum.moment) + s.linear.cross(momentum.force);
                g.force = g.force + s.angular.cross(momentum.force);
            }
            JointKind::Prismatic => {
                let h = composite.first_moment;
                f = Force { moment: h.cross(s.linear), force: s.linear.times(composite.mass) };
                g = Force { moment: h.cross(psi.linear), force: psi.linear.times(composite.mass) };
                g.moment = g.moment + s.linear.cross(momentum.force);
            }
        }
        self.momentum[j] = momentum.dot(s);
        self.gradient[j] = momentum.dot(psi) + f.force.dot_constant(self.gravity);
        self.mass_matrix[(j, j)] = f.dot(s);
        self.coupling[(j, j)] = g.dot(s);
        let (f, g) = (entries(f.moment, f.force), entries(g.moment, g.force));
        let (group, lane) = (&self.columns[j / LANES], j % LANES);
        let weight = (0..3).fold(S::zero(), |sum, c| sum + group.gamma[c][lane] * f[3 + c]);
        self.stiffness[(j, j)] = (0..6).fold(weight, |sum, c| sum + group.psi[c][lane] * g[c]);
        for (group, members) in &self.groups[j] {
            let columns = &self.columns[*group];
            let mass = products(&columns.s, &f);
            let upper = products(&columns.s, &g);
            let lower = products(&columns.psi, &f);
            let (turned, weight) =
                (products(&columns.psi, &g), products(&columns.gamma, &[f[3], f[4], f[5]]));
            for lane in (0..LANES).filter(|&lane| members[lane]) {
                let i = group * LANES + lane;
                self.mass_matrix[(i, j)] = mass[lane];
                self.mass_matrix[(j, i)] = mass[lane];
                self.coupling[(i, j)] = upper[lane];
                self.coupling[(j, i)] = lower[lane];
                let entry = turned[lane] + weight[lane];
                self.stiffness[(i, j)] = entry;
                self.stiffness[(j, i)] = entry;
            }
        }
        if let Some(parent) = joint.parent {
            self.composites[parent] = self.composites[parent].with_moments(composite);
            self.momenta[parent] = self.momenta[parent] + momentum;
        }
    }
}
