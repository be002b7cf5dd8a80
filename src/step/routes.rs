//! Compares the derivatives of steps in time with hyper-dual numbers.

use super::error::check;
use super::{
    Classical, HamiltonianRobot, LagrangianRobot, Midpoint, ModelFamily, Scheme, SemiImplicit, Step,
    StepContraction, StepError, Verlet,
};
use crate::derivative::{EntryBounds, Figure, RoundingBounds};
use crate::error::EvalError;
use crate::hamiltonian::Hamiltonian;
use crate::matrix::Matrix;
use crate::robot::Robot;
use num_dual::HyperDual64;

/// Compares the derivatives of one step of a robot, by every scheme, with hyper-dual numbers through the step itself
/// (through the iterations of implicit schemes, too).
///
/// Phi_z, z = (x, u, h), and the product of `y'Phi_zz`, z = (x, u), with a direction.
pub struct StepRoutes {
    momenta: Hamiltonian<f64>,
    bounds: RoundingBounds,
    runge_kutta: Compared<HamiltonianRobot, Classical>,
    verlet: Compared<HamiltonianRobot, Verlet>,
    midpoint: Compared<HamiltonianRobot, Midpoint>,
    semi_implicit: Compared<LagrangianRobot, SemiImplicit>,
}

impl StepRoutes {
    /// Builds every workspace.
    pub fn new(robot: &Robot) -> Self {
        let (hamiltonian, lagrangian) = (HamiltonianRobot::from(robot), LagrangianRobot::from(robot));
        Self {
            momenta: Hamiltonian::new(robot),
            bounds: RoundingBounds::without_tensors(robot),
            runge_kutta: Compared::new("RK4 (q, p)", &hamiltonian),
            verlet: Compared::new("Verlet (q, p)", &hamiltonian),
            midpoint: Compared::new("midpoint (q, p)", &hamiltonian),
            semi_implicit: Compared::new("semi-implicit (q, v)", &lagrangian),
        }
    }

    /// Compares a step of duration h from x = (q, p) under u, with the costate y, which is also the direction in x; that in
    /// u is u itself. Figures are appended: all of them, or with an error none.
    ///
    /// # Errors
    /// A wrong length, a state that the model refuses, or an implicit equation that was not solved.
    pub fn compare(
        &mut self,
        x: &[f64],
        u: &[f64],
        h: f64,
        y: &[f64],
        figures: &mut Vec<Figure>,
    ) -> Result<(), StepError<EvalError>> {
        let n = self.momenta.len();
        check([2 * n, n], [x, u], h, Some(y))?;
        let end = self.runge_kutta.step.advance(x, u, h)?.to_vec();
        let here = self.bounds.around(x, u, y, 1.0)?;
        let bounds = here.larger(&self.bounds.around(&end, u, y, 1.0)?);
        let (q, p) = x.split_at(n);
        let v = self.momenta.velocity(q, p)?;
        let in_velocities = [q, v].concat();
        let hamiltonian = bounds.hamiltonian_step(h, [y, u]);
        let lagrangian = bounds.lagrangian_step(h, [y, u], v);
        let mut found = Vec::new();
        self.runge_kutta.compare(x, u, h, y, &hamiltonian, &mut found)?;
        self.verlet.compare(x, u, h, y, &hamiltonian, &mut found)?;
        self.midpoint.compare(x, u, h, y, &hamiltonian, &mut found)?;
        self.semi_implicit.compare(&in_velocities, u, h, y, &lagrangian, &mut found)?;
        found.sort_by_key(|figure| figure.quantity);
        figures.append(&mut found);
        Ok(())
    }
}

/// One scheme and its reference.
struct Compared<F: ModelFamily, M: Scheme<F>> {
    name: &'static str,
    step: M::Step<f64>,
    judge: M::Step<HyperDual64>,
    z: Vec<HyperDual64>,
}

impl<F: ModelFamily, M: Scheme<F>> Compared<F, M> {
    fn new(name: &'static str, family: &F) -> Self {
        let step = M::step(family.model::<f64>());
        let inputs = step.states() + step.controls() + 1;
        Self { name, judge: M::step(family.model()), z: vec![HyperDual64::from_re(0.0); inputs], step }
    }

    fn compare(
        &mut self,
        x: &[f64],
        u: &[f64],
        h: f64,
        y: &[f64],
        [first_bound, second_bound]: &[EntryBounds; 2],
        figures: &mut Vec<Figure>,
    ) -> Result<(), StepError<F::Error>> {
        let (states, inputs) = (x.len(), self.z.len());
        let direction = [y, u, &[0.0]].concat();
        let values = [x, u, &[h]].concat();
        let (mut phi_z, mut product) =
            (Matrix::<f64>::zeros(states, inputs), Matrix::<f64>::zeros(1, inputs - 1));
        for j in 0..inputs {
            for (l, z) in self.z.iter_mut().enumerate() {
                *z = HyperDual64::new(values[l], direction[l], f64::from(u8::from(l == j)), 0.0);
            }
            let (start, rest) = self.z.split_at(states);
            let (control, duration) = rest.split_at(u.len());
            let next = self.judge.advance(start, control, duration[0])?;
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
        let off = |i, j| first[(i, j)] - phi_z[(i, j)];
        figures.push(Figure::judge("Phi_z, z = (x, u, h)", self.name, off, first_bound));
        let off = |_, j| by_hand[(0, j)] - product[(0, j)];
        figures.push(Figure::judge("y'Phi_zz d, z = (x, u)", self.name, off, second_bound));
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
