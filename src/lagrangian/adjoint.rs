//! The adjoint product y'f_x of the Lagrangian state equation, without f_x.

use super::Lagrangian;
use crate::error::{EvalError, LengthError};
use crate::matrix::{add_scaled, write_packs};
use crate::scalar::{Pack, Scalar};

impl<S: Scalar> Lagrangian<S> {
    /// Solves `M(q) w = y` in place (n entries). M stays factored for
    /// [`adjoint_factored`](Self::adjoint_factored).
    ///
    /// For a costate y of the velocities, w gives the derivative by the actuation: `y'a_u = w'`.
    ///
    /// # Errors
    /// A wrong length, an entry that is not finite, or a singular M; see [`Lagrangian`].
    pub fn solve_mass_matrix(&mut self, q: &[S], y: &mut [S]) -> Result<(), EvalError> {
        self.check(q, &[("y", y)])?;
        self.factor(q)?;
        self.factor.solve(y);
        Ok(())
    }

    /// Writes `dx/dt = (v, a)` (2n) to `f` and `y'a_x = -w'(tau_q, tau_v)` (2n) to `y_a_x`, for `w = M^-1 y`.
    ///
    /// Contracts the first derivatives of inverse dynamics before the solve. M must have been factored at the
    /// same q by [`solve_mass_matrix`](Self::solve_mass_matrix), which gives w.
    ///
    /// # Errors
    /// A wrong length or an entry that is not finite; see [`Lagrangian`].
    pub fn adjoint_factored(
        &mut self,
        [q, v, u, w]: [&[S]; 4],
        f: &mut [S],
        y_a_x: &mut [S],
    ) -> Result<(), EvalError> {
        self.check(q, &[("v", v), ("u", u), ("w", w)])?;
        LengthError::check("f", 2 * self.dof(), f.len())?;
        LengthError::check("y_a_x", 2 * self.dof(), y_a_x.len())?;
        self.accelerate_factored(q, v, u);
        self.differentiate_torque_after_bias(q, v)?;
        f.copy_from_slice(&self.rate);
        let (in_q, in_v) = y_a_x.split_at_mut(v.len());
        for ((torque, sums), product) in self.torque.iter().zip(&mut self.solved).zip([in_q, in_v]) {
            // A row that is free here takes the sums.
            let sums = sums.row_mut(0);
            sums.fill(S::Pack::zero());
            w.iter().enumerate().for_each(|(i, &w)| add_scaled(sums, S::Pack::splat(-w), torque.row(i)));
            write_packs(sums, product, |pack| pack);
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
        lagrangian.solve_mass_matrix(&q, &mut w).unwrap();
        let (mut f, mut product) = (vec![0.0; 12], vec![0.0; 12]);
        lagrangian.adjoint_factored([&q, &v, &u, &w], &mut f, &mut product).unwrap();
        let whole = lagrangian.linearise_forward_dynamics(&q, &v, &u).unwrap();
        assert_eq!(&f[..6], &v[..]);
        assert_eq!(&f[6..], whole.acceleration());
        for (j, product) in product.iter().enumerate() {
            let expected: f64 = (0..6).map(|i| y[i] * whole.matrix().row(i)[j]).sum();
            assert!((product - expected).abs() < 1e-12 * expected.abs().max(1.0), "{j}");
        }
    }
}
