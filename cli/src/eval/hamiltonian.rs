//! Answers in (q, p): f, f_x, y_f_xx.

use super::line::{Answer, Motion, State};
use super::{Evaluator, Route};
use costate::derivative::{Hessian, Jacobian, NestedHessian, PhaseVelocity};
use costate::hamiltonian::{self, SecondOrder};
use costate::matrix::{Block, Matrix};
use costate::robot::Robot;

/// The workspaces of one route.
enum Workspace {
    Analytic(Box<SecondOrder<f64>>),
    Dual(Box<Jacobian<PhaseVelocity>>, Box<NestedHessian<PhaseVelocity>>),
    Hyperdual(Box<Hessian<PhaseVelocity>>),
}

pub struct Hamiltonian {
    hamiltonian: hamiltonian::Hamiltonian<f64>,
    workspace: Workspace,
}

impl Hamiltonian {
    pub fn new(robot: &Robot, route: Route) -> Self {
        let function = || PhaseVelocity::new(robot);
        let workspace = match route {
            Route::Analytic => Workspace::Analytic(Box::new(SecondOrder::new(robot))),
            Route::Dual => {
                Workspace::Dual(Box::new(Jacobian::new(function())), Box::new(NestedHessian::new(function())))
            }
            Route::Hyperdual => Workspace::Hyperdual(Box::new(Hessian::new(function()))),
        };
        Self { hamiltonian: hamiltonian::Hamiltonian::new(robot), workspace }
    }
}

impl Evaluator for Hamiltonian {
    fn answer(&mut self, state: &State) -> Result<Answer, Box<dyn std::error::Error>> {
        let State { q, u, .. } = state;
        let p = match &state.motion {
            Motion::Momentum(p) | Motion::Both(p, _) => p.clone(),
            Motion::Velocity(v) => self.hamiltonian.momentum(q, v)?.to_vec(),
        };
        let energy = self.hamiltonian.energy(q, &p)?;
        let mut answer = Answer::default();
        answer.vector("energy", &[energy.kinetic, energy.potential]);
        answer.matrix("M", self.hamiltonian.mass_matrix(q)?.view());
        answer.vector("q", q);
        answer.vector("p", &p);
        let x = [q.as_slice(), &p].concat();
        let mut derivatives = |f: &[f64], f_x: Block<'_, f64>, y_f_xx: Option<Block<'_, f64>>| {
            answer.vector("v", &f[..q.len()]);
            answer.vector("f", f);
            answer.matrix("f_x", f_x);
            y_f_xx.into_iter().for_each(|y_f_xx| answer.matrix("y_f_xx", y_f_xx));
        };
        match (&mut self.workspace, state.y.as_deref()) {
            (Workspace::Analytic(_), None) => {
                let linear = self.hamiltonian.jacobian(q, &p, u)?;
                derivatives(linear.f(), linear.matrix(), None);
            }
            (Workspace::Analytic(second), Some(y)) => {
                let second = second.contracted_hessian(q, &p, u, y)?;
                let linear = second.linearisation();
                derivatives(linear.f(), linear.matrix(), Some(second.matrix()));
            }
            (Workspace::Dual(jacobian, nested), y) => {
                jacobian.function_mut().u.copy_from_slice(u);
                nested.function_mut().u.copy_from_slice(u);
                let first = jacobian.evaluate(&x)?;
                let second = y.map(|y| nested.contracted(&x, y)).transpose()?;
                derivatives(first.value, first.jacobian.view(), second.map(Matrix::view));
            }
            (Workspace::Hyperdual(hessian), y) => {
                hessian.function_mut().u.copy_from_slice(u);
                hessian.contracted(&x, y.unwrap_or(&vec![0.0; x.len()]))?;
                let (last, second) = (hessian.last(), hessian.last_contracted().view());
                derivatives(last.value(), last.jacobian().view(), y.map(|_| second));
            }
        }
        Ok(answer)
    }
}
