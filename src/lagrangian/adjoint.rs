//! The adjoint product y'f_x of the Lagrangian state equation, without f_x.

use super::Lagrangian;
use crate::error::EvalError;
use crate::matrix::add_scaled;
use crate::scalar::Scalar;

impl<S: Scalar> Lagrangian<S> {
    /// Replaces y (n) by `w = M^-1 y`. For a costate y of the velocities, `y'a_u = w'`. M(q) stays factored.
    ///
    /// # Errors
    /// See [`Lagrangian`].
    pub(crate) fn pull(&mut self, q: &[S], y: &mut [S]) -> Result<(), EvalError> {
        self.check(&[("q", q), ("y", y)])?;
        self.factor(q)?;
        self.factor.solve(y);
        Ok(())
    }

    /// `dx/dt = (v, a)`, 2n, into `f` and `y'a_x = -w'(tau_q, tau_v)`, 2n, into `y_a_x`, for the costate
    /// `y = M w` of the velocities: the first derivatives of inverse dynamics are contracted before the
    /// solve. Call [`pull`](Self::pull) at the same q first: it factors M.
    ///
    /// # Errors
    /// See [`Lagrangian`].
    pub(crate) fn adjoint(
        &mut self,
        [q, v, u, w]: [&[S]; 4],
        f: &mut [S],
        y_a_x: &mut [S],
    ) -> Result<(), EvalError> {
        self.check(&[("v", v), ("u", u)])?;
        self.accelerate_factored(q, v, u);
        self.differentiate_flow()?;
        self.take_torque_jacobian(v);
        f.copy_from_slice(&self.rate);
        let (in_q, in_v) = y_a_x.split_at_mut(v.len());
        in_q.fill(S::zero());
        in_v.fill(S::zero());
        for (i, &w) in w.iter().enumerate() {
            add_scaled(in_q, -w, self.tau_q.row(i));
            add_scaled(in_v, -w, self.tau_v.row(i));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;

    #[test]
    fn the_product_is_that_with_the_whole_jacobian() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/robots/puma560.toml");
        let robot = Robot::from_file(file).unwrap();
        let mut lagrangian = Lagrangian::<f64>::new(&robot);
        let part = |k: usize| (0..6).map(|i| (1.3 * (i + 6 * k) as f64).sin()).collect::<Vec<_>>();
        let (q, v, u, y) = (part(0), part(1), part(2), part(3));
        let mut w = y.clone();
        lagrangian.pull(&q, &mut w).unwrap();
        let (mut f, mut product) = (vec![0.0; 12], vec![0.0; 12]);
        lagrangian.adjoint([&q, &v, &u, &w], &mut f, &mut product).unwrap();
        let whole = lagrangian.linearise_forward_dynamics(&q, &v, &u).unwrap();
        assert_eq!(&f[..6], &v[..]);
        assert_eq!(&f[6..], whole.acceleration());
        for (j, product) in product.iter().enumerate() {
            let expected: f64 = (0..6).map(|i| y[i] * whole.matrix().row(i)[j]).sum();
            assert!((product - expected).abs() < 1e-12 * expected.abs().max(1.0), "{j}");
        }
    }
}
