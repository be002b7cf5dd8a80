//! M, L_q, P, L_qq and their changes in the axes of the world.

use crate::error::EvalError;
use crate::kernels::{Factor, HessianChange, WorldKernel};
use crate::matrix::{Matrix, Panel, filled};
use crate::robot::{Row, Tree, scaled};
use crate::scalar::Scalar;

/// M, L_q, P and L_qq in the axes of the world: for robots with floating and spherical joints, and for packs
/// of several lanes and more than 12 independent joints, where that takes less time than in body frames.
///
/// Derivatives are those in the left-trivialised tangent space, of L_qq the symmetric part.
#[derive(Clone, Debug)]
pub(crate) struct World<S: Scalar> {
    kernel: WorldKernel<S>,
    l_q: Vec<S>,
    /// What no pair of joints on one branch sets stays zero.
    l_vq: Panel<S>,
    l_qq: Panel<S>,
}

/// Changes of M, P and L_qq.
#[derive(Clone, Debug)]
pub(crate) struct Change<S: Scalar> {
    work: HessianChange<S>,
    /// What no pair of joints on one branch sets stays zero.
    along: [Panel<S>; 3],
}

impl<S: Scalar> Change<S> {
    /// Buffers for this tree.
    pub fn new(world: &World<S>) -> Self {
        let n = world.l_q.len();
        let along = [0; 3].map(|_| Panel::zeros(n, n));
        Self { work: HessianChange::new(&world.kernel), along }
    }

    /// The changes of M, P and L_qq, n x n.
    pub fn panels(&self) -> &[Panel<S>; 3] {
        &self.along
    }
}

impl<S: Scalar> World<S> {
    /// `None` where body frames are used.
    pub fn where_used(tree: &Tree) -> Option<Box<Self>> {
        let n = tree.dof();
        let fast = Panel::<S>::in_blocks(n) && tree.joint_map().is_none();
        (fast || !tree.free().is_empty()).then(|| {
            Box::new(Self {
                kernel: WorldKernel::new(tree),
                l_q: filled(S::zero(), n),
                l_vq: Panel::zeros(n, n),
                l_qq: Panel::zeros(n, n),
            })
        })
    }

    /// M at q (nq).
    pub fn set_mass_matrix(&mut self, tree: &Tree, q: &[S]) {
        self.kernel.set_position(tree, q);
        self.kernel.compose(tree);
    }

    /// M at q (nq) and its factors; these alone, if `alone`: [`mass_matrix`](Self::mass_matrix) is not set.
    pub fn factor(
        &mut self,
        tree: &Tree,
        q: &[S],
        factor: &mut Factor<S>,
        alone: bool,
    ) -> Result<(), EvalError> {
        self.kernel.set_position(tree, q);
        self.kernel.compose_for_factor(tree, alone);
        self.kernel.set_reach(tree, q);
        let singular = |k: usize| EvalError::SingularMassMatrix { joint: tree.name(k).into() };
        self.kernel.factor(tree, factor).map_err(singular)
    }

    /// L_q at v, after [`factor`](Self::factor) at the same q.
    pub fn first_order(&mut self, tree: &Tree, q: &[S], v: &[S]) {
        self.kernel.set_velocity(v);
        self.kernel.gradient(tree, &mut self.l_q);
        for &joint in tree.with_spring() {
            let (spring, row) = (tree.joints()[joint].spring, tree.row_of(joint));
            let position = row.position_from(q[tree.entry_of(row.coordinate)]);
            let force = position.plus(-spring.rest).times(spring.stiffness);
            self.l_q[row.coordinate] -= scaled(row.ratio, force);
        }
    }

    /// P and L_qq there.
    pub fn second_order(&mut self, tree: &Tree) {
        self.kernel.hessian(tree, [&mut self.l_vq, &mut self.l_qq]);
        for &joint in tree.with_spring() {
            let Row { coordinate: i, ratio, .. } = tree.row_of(joint);
            let stiffness = ratio * ratio * tree.joints()[joint].spring.stiffness;
            self.l_qq.set(i, i, self.l_qq.get(i, i).plus(-stiffness));
        }
    }

    /// The changes of M, P and L_qq along (dq, dv), after [`second_order`](Self::second_order) at v.
    pub fn differentiate(&mut self, tree: &Tree, change: &mut Change<S>, v: &[S], direction: [&[S]; 2]) {
        let Change { work, along } = change;
        self.kernel.differentiate(tree, work, (v, direction), along);
    }

    /// M.
    pub fn mass_matrix(&self) -> &Matrix<S> {
        self.kernel.mass_matrix()
    }

    /// L_q.
    pub fn l_q(&self) -> &[S] {
        &self.l_q
    }

    /// P.
    pub fn l_vq(&self) -> &Panel<S> {
        &self.l_vq
    }

    /// L_qq.
    pub fn l_qq(&self) -> &Panel<S> {
        &self.l_qq
    }
}

#[cfg(test)]
mod tests {
    use crate::configuration::ConfigurationSpace;
    use crate::configuration::samples::{link, placed, state};
    use crate::hamiltonian::HamiltonianSecondOrder;
    use crate::matrix::Panel;
    use crate::robot::test_robot::robot;
    use crate::robot::{JointSpec, Robot, Spring};

    /// F, F_x, M and y'F_xx of the kernel in the axes of the world, and of that in body frames; at two states
    /// one after the other.
    fn compare(robot: &Robot) {
        let mut both = HamiltonianSecondOrder::<f64>::new(robot);
        let mut in_body_frames = HamiltonianSecondOrder::<f64>::new(robot);
        in_body_frames.first.flow.kernel.world = None;
        let n = both.dof();
        for turn in [1.0, -0.6] {
            let [q, p, u, y] = state(&ConfigurationSpace::new(robot));
            let p: Vec<f64> = p.iter().map(|p| turn * p).collect();
            let in_world = both.contract(&q, &p, &u, &y).unwrap().matrix().to_nalgebra();
            let all = in_body_frames.contract(&q, &p, &u, &y).unwrap();
            let (body, y_f_xx) = (all.linearisation(), all.matrix().to_nalgebra());
            let error = (in_world - &y_f_xx).amax();
            assert!(error < 1e-11 * y_f_xx.amax(), "{}, n = {n}: y'F_xx: {error}", robot.name());
            let (f, f_x) = (body.f().to_vec(), body.matrix().to_nalgebra());
            let mass_matrix = body.mass_matrix().clone();
            let of_f = f.iter().fold(1.0, |most: f64, f| most.max(f.abs()));
            let close = |found: &[f64]| found.iter().zip(&f).all(|(a, b)| (a - b).abs() < 1e-12 * of_f);
            assert!(close(both.first().evaluate(&q, &p, &u).unwrap()), "{}, n = {n}", robot.name());
            assert_eq!(
                both.first.flow.kernel.world().is_some(),
                Panel::<f64>::in_blocks(n) && is_independent(robot)
            );
            let world = both.first().linearise(&q, &p, &u).unwrap();
            assert!(close(world.f()));
            let error = (world.matrix().to_nalgebra() - &f_x).amax();
            assert!(error < 1e-11 * f_x.amax(), "{}, n = {n}: {error}", robot.name());
            let masses = world.mass_matrix().as_slice().iter().zip(mass_matrix.as_slice());
            assert!(masses.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs())) < 1e-12 * 50.0);
            // Of the kernel in body frames again.
            assert_eq!(both.first().mass_matrix(&q).unwrap().rows(), n);
        }
    }

    fn is_independent(robot: &Robot) -> bool {
        robot.joints().iter().all(|joint| joint.mimic.is_none())
    }

    #[test]
    fn both_kernels_give_the_same_state_equation() {
        for n in [13, 18, 23] {
            compare(&robot(n, |k| k.wrapping_sub(1), false));
            // Not in the order of the branches.
            compare(&robot(n, |k| k.wrapping_sub(3), true));
            compare(&robot(n, |k| (k * k + 1) % (k + 2), false));
        }
        let mut builder = Robot::builder("springs").gravity([0.7, -1.0, -9.81]);
        for k in 0..14 {
            let (name, x) = (format!("j{k}"), 0.1 * f64::from(k));
            let spec = if k % 4 == 1 { JointSpec::prismatic(&name) } else { JointSpec::revolute(&name) };
            let spec = spec.axis([0.3, 1.0 - x, x]).placed(placed(x)).carrying(link(x));
            let spec = spec.spring(Spring { stiffness: 20.0 * x, rest: 0.3 });
            builder = builder.joint(if k > 0 { spec.on(format!("j{}", (k - 1) / 2)) } else { spec });
        }
        compare(&builder.build().unwrap());
    }
}
