//! Coefficients of a robot, and independent numbers to judge them by.

use costate::derivative::largest;
use costate::hamiltonian::Hamiltonian;
use costate::kernels::KernelOne;
use costate::num_dual::{Dual64, HyperDual64};
use costate::robot::{JointSpec, LinkInertia, Placement, Robot, Tree};
use costate::tensors::MassMatrixDerivatives;
use costate_test_support::random_robot::Case;
use costate_test_support::rounding::{OPERATIONS, close, terms};
use proptest::prelude::*;

/// Coefficients of one robot, and independent numbers to judge them by.
pub struct Bench {
    pub tree: Tree,
    pub ours: MassMatrixDerivatives<f64>,
    /// M_ij,k and M_ij,kl by hyper-dual numbers through the mass matrix of the other route.
    first: Vec<f64>,
    second: Vec<f64>,
    /// Gamma^k_ij,l by dual numbers through the coefficients.
    gamma_derivatives: Vec<f64>,
    /// Size of the terms that all of these are sums of.
    natural: f64,
}

impl Bench {
    pub fn new(case: &Case) -> Self {
        let case = &case.all_independent();
        let (robot, n, q) = (case.robot(), case.n(), &case.q);
        let tree = Tree::from(&robot);
        let mut ours = MassMatrixDerivatives::new(&tree);
        ours.update(&tree, q).unwrap();
        let (mut first, mut second) = (vec![0.0; n * n * n], vec![0.0; n * n * n * n]);
        let mut hyperdual = Hamiltonian::<HyperDual64>::new(&robot);
        for k in 0..n {
            for l in 0..n {
                let mut q: Vec<_> = q.iter().map(|&q| HyperDual64::from_re(q)).collect();
                (q[k].eps1, q[l].eps2) = (1.0, 1.0);
                for (ij, m) in hyperdual.mass_matrix(&q).unwrap().as_slice().iter().enumerate() {
                    first[ij * n + k] = m.eps1;
                    second[(ij * n + k) * n + l] = m.eps1eps2;
                }
            }
        }
        let mut gamma_derivatives = vec![0.0; n * n * n * n];
        let mut dual = MassMatrixDerivatives::<Dual64>::new(&tree);
        for l in 0..n {
            let mut q: Vec<_> = q.iter().map(|&q| Dual64::from_re(q)).collect();
            q[l].eps = 1.0;
            dual.set_position(&tree, &q).unwrap();
            dual.first_derivatives();
            for [k, i, j] in triples(n) {
                gamma_derivatives[((k * n + i) * n + j) * n + l] = dual.gamma(k, i, j).eps;
            }
        }
        let mut kernel = KernelOne::new(&tree);
        kernel.set_position(&tree, q).unwrap();
        let natural = (0..n).map(|k| kernel.size_of_entry(&tree, k)).fold(0.0, f64::max);
        Self { tree, ours, first, second, gamma_derivatives, natural }
    }

    pub fn n(&self) -> usize {
        self.tree.dof()
    }

    /// i is j or an ancestor of j.
    pub fn le(&self, i: usize, j: usize) -> bool {
        self.tree.subtree(i).contains(&j)
    }

    pub fn lt(&self, i: usize, j: usize) -> bool {
        i != j && self.le(i, j)
    }

    /// M_ij,k.
    pub fn m(&self, i: usize, j: usize, k: usize) -> f64 {
        self.first[(i * self.n() + j) * self.n() + k]
    }

    /// M_ij,kl.
    pub fn mm(&self, i: usize, j: usize, k: usize, l: usize) -> f64 {
        self.second[((i * self.n() + j) * self.n() + k) * self.n() + l]
    }

    /// Gamma^k_ij,l by dual numbers.
    pub fn gg(&self, k: usize, i: usize, j: usize, l: usize) -> f64 {
        self.gamma_derivatives[((k * self.n() + i) * self.n() + j) * self.n() + l]
    }

    /// Gamma_{i,jk} = [jk,i] from the judge's M,k.
    pub fn symbol(&self, i: usize, j: usize, k: usize) -> f64 {
        0.5 * (self.m(i, j, k) + self.m(i, k, j) - self.m(j, k, i))
    }

    /// Two sums of up to four numbers of this kind, which are themselves sums over joints, are the same.
    pub fn same(
        &self,
        kind: &[f64],
        found: f64,
        expected: f64,
        what: &str,
        at: &[usize],
    ) -> Result<(), TestCaseError> {
        let bound = 4.0 * terms(OPERATIONS * self.n(), &[largest(kind).max(self.natural)]);
        close(&format!("{what} at {at:?}"), &[found], &[expected], bound)
    }

    pub fn first_is(&self, found: f64, expected: f64, what: &str, at: &[usize]) -> Result<(), TestCaseError> {
        self.same(&self.first, found, expected, what, at)
    }

    pub fn second_is(
        &self,
        found: f64,
        expected: f64,
        what: &str,
        at: &[usize],
    ) -> Result<(), TestCaseError> {
        self.same(&self.second, found, expected, what, at)
    }
}

/// All indices 0 to n - 1, N at a time.
pub fn indices<const N: usize>(n: usize) -> impl Iterator<Item = [usize; N]> {
    (0..n.pow(N as u32)).map(move |mut code| {
        std::array::from_fn(|_| {
            let index = code % n;
            code /= n;
            index
        })
    })
}

pub fn triples(n: usize) -> impl Iterator<Item = [usize; 3]> {
    indices(n)
}

pub fn quadruples(n: usize) -> impl Iterator<Item = [usize; 4]> {
    indices(n)
}

/// A serial chain made of the parts of a case.
pub fn serial(mut case: Case) -> Case {
    case.parts.iter_mut().for_each(|part| part.parent = 0);
    case
}

/// A chain of n revolute joints, joint i on joint `parent(i)`, with general axes.
pub fn revolute(n: usize, parent: impl Fn(usize) -> Option<usize>) -> Tree {
    let mut builder = Robot::builder("counted");
    for i in 0..n {
        let x = 1.0 + i as f64;
        let spec = JointSpec::revolute(format!("j{i}"))
            .axis([x.sin(), (2.0 * x).cos(), 0.3])
            .placed(Placement::from_xyz_rpy([0.3, 0.1 * x.cos(), -0.2], [x, 0.4, -x]))
            .carrying(LinkInertia::about_com(1.0 + x, [0.1, -0.2, 0.05 * x], nalgebra::Matrix3::identity()));
        builder = builder.joint(match parent(i) {
            Some(parent) => spec.on(format!("j{parent}")),
            None => spec,
        });
    }
    Tree::from(&builder.build().unwrap())
}
