//! Comparison of the derivatives of every scheme with hyper-dual numbers.

// `#[inline]` in this file: compiled where it is used, with all instances of the pipeline that it needs, not by
// everyone who builds the library.

use super::error::check;
use super::{
    Classical, HamiltonianRobot, LagrangianRobot, Midpoint, ModelFamily, Scheme, SemiImplicit, Step,
    StepContraction, StepError, Verlet,
};
use crate::derivative::{Figure, largest, relative_difference, worse};
use crate::error::EvalError;
use crate::hamiltonian::Hamiltonian;
use crate::matrix::Matrix;
use crate::robot::Robot;
use num_dual::HyperDual64;
use std::fmt;

/// Compares the derivatives of one step of a robot, for every scheme, with hyper-dual numbers through the
/// step itself, including the iterations of implicit schemes.
///
/// Phi_z, z = (x, u, h), and the product of `y'Phi_zz`, z = (x, u), with a direction.
pub struct StepRoutes {
    momenta: Hamiltonian<f64>,
    runge_kutta: Compared<HamiltonianRobot, Classical>,
    verlet: Compared<HamiltonianRobot, Verlet>,
    midpoint: Compared<HamiltonianRobot, Midpoint>,
    semi_implicit: Compared<LagrangianRobot, SemiImplicit>,
}

impl fmt::Debug for StepRoutes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StepRoutes").field("dof", &self.momenta.dof()).finish_non_exhaustive()
    }
}

impl StepRoutes {
    /// Builds every workspace.
    #[inline]
    pub fn new(robot: &Robot) -> Self {
        let (hamiltonian, lagrangian) = (HamiltonianRobot::from(robot), LagrangianRobot::from(robot));
        Self {
            momenta: Hamiltonian::new(robot),
            runge_kutta: Compared::new("RK4 (q, p)", &hamiltonian),
            verlet: Compared::new("Verlet (q, p)", &hamiltonian),
            midpoint: Compared::new("midpoint (q, p)", &hamiltonian),
            semi_implicit: Compared::new("semi-implicit (q, v)", &lagrangian),
        }
    }

    /// Compares a step of duration h from x = (q, p) under u with the costate y. The direction of the Hessian
    /// product is (y, u). Appends all figures, or none on an error.
    ///
    /// # Errors
    /// A wrong length, a state that the model refuses, or an implicit equation that was not solved.
    #[inline]
    pub fn compare(
        &mut self,
        x: &[f64],
        u: &[f64],
        h: f64,
        y: &[f64],
        figures: &mut Vec<Figure>,
    ) -> Result<(), StepError<EvalError>> {
        let n = self.momenta.dof();
        check([2 * n, n], [x, u], h, Some(y))?;
        let (q, p) = x.split_at(n);
        let in_velocities = [q, self.momenta.velocity(q, p)?].concat();
        let mut found = Vec::new();
        self.runge_kutta.compare(x, u, h, y, &mut found)?;
        self.verlet.compare(x, u, h, y, &mut found)?;
        self.midpoint.compare(x, u, h, y, &mut found)?;
        self.semi_implicit.compare(&in_velocities, u, h, y, &mut found)?;
        found.sort_by_key(|figure| figure.quantity);
        figures.append(&mut found);
        Ok(())
    }
}

/// One scheme and its reference.
struct Compared<F: ModelFamily, M: Scheme<F>> {
    name: &'static str,
    step: M::Step<f64>,
    reference: M::Step<HyperDual64>,
    z: Vec<HyperDual64>,
}

impl<F: ModelFamily, M: Scheme<F>> Compared<F, M> {
    fn new(name: &'static str, family: &F) -> Self {
        let step = M::step(family.model::<f64>());
        let inputs = step.states() + step.controls() + 1;
        Self { name, reference: M::step(family.model()), z: vec![HyperDual64::from_re(0.0); inputs], step }
    }

    fn compare(
        &mut self,
        x: &[f64],
        u: &[f64],
        h: f64,
        y: &[f64],
        figures: &mut Vec<Figure>,
    ) -> Result<(), StepError<F::Error>> {
        let (states, inputs) = (x.len(), self.z.len());
        let direction = [y, u, &[0.0]].concat();
        let values = [x, u, &[h]].concat();
        let (mut phi_z, mut product) = (Matrix::zeros(states, inputs), Matrix::zeros(1, inputs - 1));
        for j in 0..inputs {
            for (l, z) in self.z.iter_mut().enumerate() {
                *z = HyperDual64::new(values[l], direction[l], f64::from(u8::from(l == j)), 0.0);
            }
            let (start, rest) = self.z.split_at(states);
            let (control, duration) = rest.split_at(u.len());
            let next = self.reference.evaluate(start, control, duration[0])?;
            next.iter().enumerate().for_each(|(k, next)| phi_z[(k, j)] = next.eps2);
            if j + 1 < inputs {
                product[(0, j)] = next.iter().zip(y).map(|(next, y)| next.eps1eps2 * y).sum();
            }
        }
        let found = self.step.contract(x, u, h, y)?;
        let first = jacobian(&found);
        let mut by_hand = Matrix::zeros(1, inputs - 1);
        let (in_x, in_u) = by_hand.row_mut(0).split_at_mut(states);
        found.times([y, u], [in_x, in_u]);
        let largest_first = largest(phi_z.as_slice());
        let largest_second = found.xx.iter_rows().map(largest).fold(1e-3 * largest(y) * largest_first, worse);
        let natural = largest_second * worse(largest(y), largest(u));
        for (quantity, value) in [
            ("Phi_z, z = (x, u, h)", relative_difference(first.view(), phi_z.view(), 0.0)),
            ("y'Phi_zz d, z = (x, u)", relative_difference(by_hand.view(), product.view(), natural)),
        ] {
            figures.push(Figure { quantity, route: self.name, value, sensitivity: 1.0 });
        }
        Ok(())
    }
}

/// `[Phi_x, Phi_u, Phi_h]`.
fn jacobian(found: &StepContraction<'_, f64>) -> Matrix<f64> {
    let first = &found.first;
    let rows = first.phi_x.iter_rows().zip(first.phi_u.iter_rows()).zip(first.phi_h);
    let entries: Vec<f64> = rows.flat_map(|((x, u), h)| [x, u, std::slice::from_ref(h)].concat()).collect();
    Matrix::from_rows(entries.len() / first.next.len().max(1), &entries)
}
