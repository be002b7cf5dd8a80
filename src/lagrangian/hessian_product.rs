//! Products of contracted Hessians of inverse and forward dynamics with a direction, without the matrix.

use super::dual_pass::Pass;
use super::products::Products;
use super::{Lagrangian, LagrangianSecondOrder};
use crate::error::EvalError;
use crate::kernels::{check_entries, friction_of};
use crate::matrix::{add_scaled, dot};
use crate::scalar::Scalar;

impl<S: Scalar> LagrangianSecondOrder<S> {
    /// `(w.tau)_zz d`, z = (q, v, a), for weights w of length n and a direction d of length 3n: as
    /// [`contract_inverse_dynamics`](Self::contract_inverse_dynamics), but neither the matrix nor the
    /// Jacobian is formed, unless a dual pass computes them. Beside M and the derivatives of wrenches from
    /// outside, O(n).
    ///
    /// # Errors
    /// See [`Lagrangian`]; a singular mass matrix is not an error here.
    #[inline(never)]
    pub fn inverse_dynamics_hessian_product(
        &mut self,
        [q, v, a, w]: [&[S]; 4],
        d: &[S],
    ) -> Result<&[S], EvalError> {
        let n = self.dof();
        self.first.check(q, &[("v", v), ("a", a), ("w", w)])?;
        check_entries(self.first.tree(), "d", d, 3 * n)?;
        if let Pass::Dual(_) = self.pass {
            self.contract_inverse_dynamics(q, v, a, w)?;
            let Self { w_tau_zz, products: Products { whole, .. }, .. } = self;
            whole.iter_mut().enumerate().for_each(|(i, entry)| *entry = dot(w_tau_zz.row(i), d));
            return Ok(&self.products.whole);
        }
        self.first.place(q)?;
        let Lagrangian { tree, world, .. } = &mut self.first;
        if let Some(world) = world {
            world.set_motion(tree, v, Some(a));
            world.carry_forces(tree);
            world.take_forces(&mut self.products.sums);
        }
        self.w.copy_from_slice(w);
        self.products.in_a.copy_from_slice(&d[2 * n..]);
        self.contract_direction([q, v], &d[..2 * n]);
        for (to, from) in self.products.whole.chunks_exact_mut(n).zip(&self.products.by) {
            to.copy_from_slice(from);
        }
        Ok(&self.products.whole)
    }

    /// `y'a_zz d`, z = (q, v, u), for the costate y of the velocities, length n, and a direction d of length
    /// 3n: as [`contract_forward_dynamics`](Self::contract_forward_dynamics), but neither the matrix nor the
    /// Jacobian is formed, unless a dual pass computes them.
    ///
    /// With `w = M^-1 y`, `d_a = M^-1 (d_u - tau_q d_q - tau_v d_v)`, `g = (w.tau)_zz (d_q, d_v, d_a)` and `r
    /// = M^-1 g_a` it is `-(g_q - tau_q' r, g_v - tau_v' r, r)`: beside the factors of M and the derivatives
    /// of wrenches from outside, O(n).
    ///
    /// # Errors
    /// See [`Lagrangian`].
    #[inline(never)]
    pub fn forward_dynamics_hessian_product(
        &mut self,
        [q, v, u, y]: [&[S]; 4],
        d: &[S],
    ) -> Result<&[S], EvalError> {
        let n = self.dof();
        self.first.check(q, &[("v", v), ("u", u), ("y", y)])?;
        check_entries(self.first.tree(), "d", d, 3 * n)?;
        let (d_x, d_u) = d.split_at(2 * n);
        if let Pass::Dual(_) = self.pass {
            self.contract_forward_dynamics(q, v, u, y)?;
            let Self { xx, uq, products, .. } = self;
            let (of_x, of_u) = products.whole.split_at_mut(2 * n);
            of_x.iter_mut().enumerate().for_each(|(i, entry)| *entry = dot(xx.row(i), d_x));
            for i in 0..n {
                of_u[i] = dot(uq.row(i), &d_x[..n]);
                add_scaled(&mut of_x[..n], d_u[i], uq.row(i));
            }
            return Ok(&self.products.whole);
        }
        self.first.accelerate(q, v, u)?;
        self.w.copy_from_slice(y);
        self.first.factor.solve(&mut self.w);
        let Lagrangian { tree, world, rate, .. } = &mut self.first;
        if let Some(world) = world {
            world.set_acceleration(tree, v, &rate[n..]);
            world.carry_forces(tree);
            world.take_forces(&mut self.products.sums);
        }
        let mut in_a = std::mem::take(&mut self.products.in_a);
        self.first.torque_product(&mut self.products.sums, [q, v], d_x.split_at(n), &mut in_a);
        in_a.iter_mut().zip(d_u).for_each(|(torque, &d_u)| *torque = d_u - *torque);
        self.first.factor.solve(&mut in_a);
        self.products.in_a = in_a;
        self.contract_direction([q, v], d_x);
        let Self { first, products: Products { sums, by: [by_q, by_v, by_a], whole, .. }, .. } = self;
        first.factor.solve(by_a);
        let (of_x, of_u) = whole.split_at_mut(2 * n);
        of_u.iter_mut().zip(&*by_a).for_each(|(entry, &r)| *entry = -r);
        let (of_q, of_v) = of_x.split_at_mut(n);
        first.torque_adjoint(sums, [q, v], by_a, [of_q, of_v]);
        of_q.iter_mut().zip(&*by_q).for_each(|(entry, &g)| *entry -= g);
        of_v.iter_mut().zip(&*by_v).for_each(|(entry, &g)| *entry -= g);
        Ok(&self.products.whole)
    }

    /// Fills `products.by` with the product of the Hessian of w.tau and (d_q, d_v, in_a), at the forces of
    /// the first order.
    fn contract_direction(&mut self, [q, v]: [&[S]; 2], d_x: &[S]) {
        let Self { first, pass, w, products: Products { sums, in_a, by, .. }, .. } = self;
        let (x, y) = d_x.split_at(in_a.len());
        by.iter_mut().for_each(|by| by.fill(S::zero()));
        let [by_q, by_v, by_a] = by;
        if let (Pass::World(work), Some(world)) = (pass, &first.world) {
            world.set_weighted_forces(work, w);
            world.take_weighted_forces(work, sums);
            world.add_contraction_product(sums, [x, y, in_a], [by_q, by_v, by_a]);
        }
        for &i in first.tree.with_friction() {
            if first.tree.has_coulomb_friction(i) {
                by_v[i] -= w[i] * friction_of(&first.tree, i, v[i]).second * y[i];
            }
        }
        if let Some(external) = &mut first.external {
            let curvature = external.curvature(q, w);
            by_q.iter_mut().enumerate().for_each(|(i, entry)| *entry -= dot(curvature.row(i), x));
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::configuration::ConfigurationSpace;
    use crate::configuration::samples::{robots, state};
    use crate::lagrangian::LagrangianSecondOrder;
    use crate::lagrangian::choice::Routes;
    use crate::matrix::dot;
    use crate::robot::test_robot::robot;
    use crate::robot::{Robot, Tree};
    use crate::scalar::{Count, Scalar};

    fn compare<S: Scalar>(robot: &Robot, lift: impl Fn(f64) -> S, value: impl Fn(S) -> f64) {
        if robot.free_joints().is_empty() {
            let tree = Tree::from(robot);
            let in_body_frames = LagrangianSecondOrder::with_routes(Routes::BODY_FRAMES, tree);
            compare_with(in_body_frames, robot, &lift, &value);
        }
        compare_with(LagrangianSecondOrder::new(robot), robot, lift, value);
    }

    fn compare_with<S: Scalar>(
        mut second: LagrangianSecondOrder<S>,
        robot: &Robot,
        lift: impl Fn(f64) -> S,
        value: impl Fn(S) -> f64,
    ) {
        let [q, v, u, y] = state(&ConfigurationSpace::new(robot));
        let n = v.len();
        let d: Vec<f64> = (0..3 * n).map(|i| (0.4 + 1.3 * i as f64).cos()).collect();
        let [q, v, u, y, d] =
            [&q, &v, &u, &y[..n].to_vec(), &d].map(|x| x.iter().map(|&x| lift(x)).collect::<Vec<S>>());
        let close = |what: &str, found: &[S], expected: &[S]| {
            let size = expected.iter().fold(0.0_f64, |size, &entry| size.max(value(entry).abs()));
            for (i, (&found, &expected)) in found.iter().zip(expected).enumerate() {
                let error = (value(found) - value(expected)).abs();
                assert!(error < 1e-10 * size, "{} of {n}: {what}, {i}: {error} of {size}", robot.name());
            }
        };
        let zz = second.contract_inverse_dynamics(&q, &v, &u, &y).unwrap().zz().clone();
        let expected: Vec<S> = (0..3 * n).map(|i| dot(zz.row(i), &d)).collect();
        close(
            "w'tau_zz d",
            second.inverse_dynamics_hessian_product([&q, &v, &u, &y], &d).unwrap(),
            &expected,
        );
        let zz = second.contract_forward_dynamics(&q, &v, &u, &y).unwrap().to_matrix();
        let expected: Vec<S> = (0..3 * n).map(|i| dot(zz.row(i), &d)).collect();
        close("y'a_zz d", second.forward_dynamics_hessian_product([&q, &v, &u, &y], &d).unwrap(), &expected);
        assert!(second.forward_dynamics_hessian_product([&q, &v, &u, &y], &d[1..]).is_err());
    }

    #[test]
    fn products_are_those_with_the_matrix() {
        let mut all = robots();
        for n in [1, 3, 7, 13, 17] {
            all.push(robot(n, |k| k.wrapping_sub(1), false));
            all.push(robot(n, |k| k.wrapping_sub(3), false));
            all.push(robot(n, |k| (k * k + 1) % (k + 2), true));
        }
        for robot in &all {
            compare(robot, |x| x, |x| x);
            compare(robot, Count::variable, Count::value);
        }
    }
}
