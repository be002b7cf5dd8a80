//! Tests against sums over point masses, and against the derivatives as printed in the paper.

use super::{IndexSets, MassMatrixDerivatives};
use crate::robot::{JointKind, JointSpec, LinkInertia, Placement, Robot, Tree};
use crate::spatial::Vec3;
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

type V3 = Vector3<f64>;

/// Joint i on joint `parents[i]`; bit i of `prismatic` for a prismatic joint.
fn tree(parents: &[Option<usize>], prismatic: usize) -> Tree {
    let mut builder = Robot::builder("points");
    for (i, parent) in parents.iter().enumerate() {
        let x = 0.7 + i as f64;
        let name = format!("j{i}");
        let spec =
            if (prismatic >> i) % 2 == 1 { JointSpec::prismatic(name) } else { JointSpec::revolute(name) };
        let inertia = Matrix3::new(0.5, 0.05, -0.02, 0.05, 0.6, 0.03, -0.02, 0.03, 0.4);
        let spec = spec
            .axis([x.sin(), (2.0 * x).cos(), 0.4])
            .placed(Placement::from_xyz_rpy([0.3, 0.2 * x.cos(), -0.25], [x, 0.4 * x, -x]))
            .carrying(LinkInertia::about_com(0.5 + x, [0.1 * x.sin(), -0.2, 0.05 * x], inertia));
        builder = builder.joint(match parent {
            Some(parent) => spec.on(format!("j{parent}")),
            None => spec,
        });
    }
    Tree::from(&builder.build().unwrap())
}

/// The robot in the world frame: axes, origins, and six point masses per link with its mass, first and second
/// moments.
struct Points {
    tree: Tree,
    rotations: Vec<Matrix3<f64>>,
    origins: Vec<V3>,
    points: Vec<(usize, f64, V3)>,
}

impl Points {
    fn new(tree: &Tree, q: &[f64]) -> Self {
        let about_z = |s: f64, c: f64| Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
        let (mut rotations, mut origins, mut points) = (Vec::new(), Vec::<V3>::new(), Vec::new());
        for (i, (joint, &q)) in tree.joints().iter().zip(q).enumerate() {
            let (outer, origin) =
                joint.parent.map_or((Matrix3::identity(), V3::zeros()), |p| (rotations[p], origins[p]));
            let [s, c] = joint.screw.alpha.sin_cos();
            let about_x = Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c);
            let [s, c] = joint.screw.gamma.map_or([0.0, 1.0], |gamma| gamma.sin_cos());
            let (turn, slide) = match joint.kind {
                JointKind::Revolute => {
                    (about_z((q + joint.offset).sin(), (q + joint.offset).cos()), joint.screw.rise)
                }
                JointKind::Prismatic => (Matrix3::identity(), q + joint.offset),
            };
            let fixed = outer * about_z(s, c);
            let r = V3::from(joint.screw.translation) + about_x * V3::new(0.0, 0.0, slide);
            rotations.push(fixed * about_x * turn);
            origins.push(origin + fixed * r);
            let (m, h) = (joint.inertia.mass, V3::from(joint.inertia.first_moment));
            let [xx, yy, zz, xy, xz, yz] = joint.inertia.matrix;
            let j = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
            let spread = Matrix3::identity() * (0.5 * j.trace()) - j - h * h.transpose() / m;
            let principal = SymmetricEigen::new(spread);
            for (axis, value) in principal.eigenvectors.column_iter().zip(&principal.eigenvalues) {
                let arm: V3 = axis * (3.0 * value / m).sqrt();
                for at in [h / m + arm, h / m - arm] {
                    points.push((i, m / 6.0, origins[i] + rotations[i] * at));
                }
            }
        }
        Self { tree: tree.clone(), rotations, origins, points }
    }

    fn le(&self, i: usize, j: usize) -> bool {
        self.tree.subtree(i).contains(&j)
    }

    fn z(&self, i: usize) -> V3 {
        self.rotations[i].column(2).into()
    }

    /// Whether joint i is prismatic, 0 or 1.
    fn sigma(&self, i: usize) -> f64 {
        f64::from(u8::from(self.tree.joints()[i].kind == JointKind::Prismatic))
    }

    /// The masses that joint j moves.
    fn beyond(&self, j: usize) -> impl Iterator<Item = (f64, V3)> {
        self.points.iter().filter(move |point| self.le(j, point.0)).map(|&(_, m, at)| (m, at))
    }

    fn pi(&self, i: usize, j: usize) -> V3 {
        self.beyond(j).map(|(m, p)| m * (p - self.origins[i])).sum()
    }

    fn l(&self, i: usize, j: usize) -> Matrix3<f64> {
        self.beyond(j).map(|(m, p)| m * (p - self.origins[i]) * (p - self.origins[j]).transpose()).sum()
    }

    /// `J_ij = -L_ij' + tr(L_ij) 1` (A3.11).
    fn j(&self, i: usize, j: usize) -> Matrix3<f64> {
        let l = self.l(i, j);
        Matrix3::identity() * l.trace() - l.transpose()
    }

    /// OP,i.
    fn by(&self, i: usize, p: V3) -> V3 {
        if self.sigma(i) == 0.0 { self.z(i).cross(&(p - self.origins[i])) } else { self.z(i) }
    }

    /// `Gamma_{i,jk} = int OP,i . OP,jk dm`.
    fn gamma(&self, i: usize, j: usize, k: usize) -> f64 {
        let (j, k) = if self.le(j, k) { (j, k) } else { (k, j) };
        if !(self.le(j, k) && (self.le(i, k) || self.le(k, i))) {
            return 0.0;
        }
        let turn = self.z(j) * (1.0 - self.sigma(j));
        let deepest = if self.le(i, k) { k } else { i };
        self.beyond(deepest).map(|(m, p)| m * self.by(i, p).dot(&turn.cross(&self.by(k, p)))).sum()
    }

    /// A1_ijkl in its four terms (56); B1_ijkl (57) is A1_jikl.
    fn a1(&self, i: usize, j: usize, k: usize, l: usize) -> f64 {
        let [sj, sl] = [j, l].map(|a| self.sigma(a));
        let [zi, zj, zk, zl] = [i, j, k, l].map(|a| self.z(a));
        let (pi_jl, pi_ll, mass) = (self.pi(j, l), self.pi(l, l), self.tree.joints()[l].subtree_mass);
        let triple = |a: &V3, b: &V3, c: &V3| a.dot(&b.cross(c));
        let rr =
            zi.dot(&zk) * zj.dot(&(self.j(j, l) * zl)) - zi.cross(&zj).dot(&(self.l(j, l) * zk.cross(&zl)));
        let rp = -zj.dot(&zk) * pi_jl.dot(&zi.cross(&zl)) - triple(&zi, &zj, &zl) * pi_jl.dot(&zk);
        let pr = -zi.dot(&zl) * pi_ll.dot(&zk.cross(&zj)) - triple(&zj, &zk, &zl) * pi_ll.dot(&zi);
        let pp = mass * (zj.dot(&zl) * zi.dot(&zk) - zi.dot(&zj) * zk.dot(&zl));
        let (rj, rl) = (1.0 - sj, 1.0 - sl);
        (1.0 - self.sigma(k))
            * (1.0 - self.sigma(i))
            * (rj * rl * rr + rj * sl * rp + sj * rl * pr + sj * sl * pp)
    }

    /// A2_ijkl in its four terms (58).
    fn a2(&self, i: usize, j: usize, k: usize, l: usize) -> f64 {
        let [sj, sl] = [j, l].map(|a| self.sigma(a));
        let [zi, zj, zk, zl] = [i, j, k, l].map(|a| self.z(a));
        let (pi_lj, pi_jj, mass) = (self.pi(l, j), self.pi(j, j), self.tree.joints()[j].subtree_mass);
        let triple = |a: &V3, b: &V3, c: &V3| a.dot(&b.cross(c));
        let rr =
            zk.dot(&zi) * zl.dot(&(self.j(l, j) * zj)) - zk.cross(&zl).dot(&(self.l(l, j) * zi.cross(&zj)));
        let pr = -zl.dot(&zi) * pi_lj.dot(&zk.cross(&zj)) - triple(&zk, &zl, &zj) * pi_lj.dot(&zi);
        let rp = -zk.dot(&zj) * pi_jj.dot(&zi.cross(&zl)) - triple(&zl, &zi, &zj) * pi_jj.dot(&zk);
        let pp = mass * (zl.dot(&zj) * zk.dot(&zi) - zk.dot(&zl) * zi.dot(&zj));
        let (rj, rl) = (1.0 - sj, 1.0 - sl);
        (1.0 - self.sigma(k))
            * (1.0 - self.sigma(i))
            * (rj * rl * rr + sj * rl * pr + rj * sl * rp + sj * sl * pp)
    }
}

const CHAIN: [Option<usize>; 4] = [None, Some(0), Some(1), Some(2)];
const BRANCHED: [Option<usize>; 5] = [None, Some(0), Some(0), Some(1), Some(2)];
const Q: [f64; 5] = [0.3, -0.8, 1.1, 0.0, 0.6];

/// All combinations of joint types on a chain and on a tree.
fn for_every_mixture(check: impl Fn(&MassMatrixDerivatives<f64>, &Points)) {
    for parents in [&CHAIN[..], &BRANCHED[..]] {
        for prismatic in 0..1 << parents.len() {
            let tree = tree(parents, prismatic);
            let q = &Q[..tree.dof()];
            let mut ours = MassMatrixDerivatives::new(&tree);
            ours.update(&tree, q).unwrap();
            check(&ours, &Points::new(&tree, q));
        }
    }
}

fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-13, "{found} is not {expected}");
}

#[test]
fn tensors_are_sums_over_point_masses() {
    for_every_mixture(|ours, points| {
        let n = points.tree.dof();
        let mut found = 0;
        for i in 0..n {
            let (ours, local) = (ours.tensors().tensor(i), points.rotations[i]);
            let l = local.transpose() * points.l(i, i) * local;
            let six = [
                (ours.xx, 0, 0),
                (ours.yy, 1, 1),
                (ours.zz, 2, 2),
                (ours.xy, 0, 1),
                (ours.xz, 0, 2),
                (ours.yz, 1, 2),
            ];
            six.iter().for_each(|&(entry, a, b)| close(entry, l[(a, b)]));
        }
        for i in 0..n {
            for j in (0..n).filter(|&j| points.le(i, j)) {
                let local = points.rotations[j].transpose();
                let same = |found: Vec3<f64>, expected: V3| {
                    let expected = local * expected;
                    [found.x, found.y, found.z].iter().zip(&expected).for_each(|(a, b)| close(*a, *b));
                };
                same(ours.tensors().axis(i, j).unwrap(), points.z(i));
                assert!(i == j || ours.tensors().axis(j, i).is_none());
                if let Some(moment) = ours.tensors().first_moment(i, j) {
                    same(moment, points.pi(i, j));
                }
                if let Some(columns) = ours.tensors().columns(i, j) {
                    let l = points.l(i, j) * points.rotations[j];
                    same(columns[0], l.column(0).into());
                    same(columns[1], l.column(1).into());
                    found += 1;
                }
                let mass = points.beyond(j).map(|(m, p)| m * points.by(i, p).dot(&points.by(j, p))).sum();
                close(ours.mass(i, j), mass);
                close(ours.mass(j, i), mass);
            }
        }
        let revolute = (0..n).filter(|&i| points.sigma(i) == 0.0).count();
        assert!(found >= revolute);
    });
}

#[test]
fn coefficients_are_sums_over_point_masses() {
    for_every_mixture(|ours, points| {
        let n = points.tree.dof();
        for i in 0..n {
            for j in 0..n {
                for k in 0..n {
                    close(ours.gamma(k, i, j), points.gamma(i, k, j));
                }
            }
        }
    });
}

/// (59), (60) with (56)-(58) as printed (with the errata), with tensors summed over point masses.
#[test]
fn derivatives_of_coefficients_have_the_printed_form() {
    for_every_mixture(|ours, points| {
        let sets = IndexSets::new(&points.tree).gamma_derivatives();
        for ([k, i, j, l], &stored) in sets.into_iter().zip(ours.stored_gamma_derivatives()) {
            let printed = if points.le(j, l) {
                points.a1(i, j, k, l) - points.a1(j, i, k, l)
            } else {
                points.a2(i, j, k, l) - points.a1(l, i, k, j)
            };
            close(stored, printed);
        }
    });
}

/// (61): with revolute joints alone, `Z_j . J_jl Z_l = M_jl`.
#[test]
fn brackets_reuse_the_mass_matrix() {
    let tree = tree(&CHAIN, 0);
    let points = Points::new(&tree, &Q[..4]);
    let mut ours = MassMatrixDerivatives::new(&tree);
    ours.update(&tree, &Q[..4]).unwrap();
    for l in 0..4 {
        for j in 0..=l {
            close(points.z(j).dot(&(points.j(j, l) * points.z(l))), ours.mass(j, l));
        }
    }
}
