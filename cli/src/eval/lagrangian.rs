//! Answers in (q, v): qdd, qdd_z, yv_qdd_zz.

use super::line::{Answer, Motion, State};
#[cfg(feature = "jit")]
use super::machine::Machine;
use super::route::{Evaluator, Route};
use costate::EvalError;
use costate::derivative::{ByCalls, ForwardDynamics, Hessian, Jacobian, NestedHessian};
use costate::hamiltonian::Hamiltonian;
use costate::lagrangian::{self, LagrangianSecondOrder};
use costate::matrix::{Block, Matrix};
use costate::robot::Robot;
#[cfg(feature = "jit")]
use costate::{codegen, lagrangian::whole_hessian};

/// The workspaces of one method.
enum Workspace {
    Analytic(Box<LagrangianSecondOrder<f64>>),
    Dual(Box<Jacobian<ByCalls<ForwardDynamics>>>, Box<NestedHessian<ByCalls<ForwardDynamics>>>),
    Hyperdual(Box<Hessian<ByCalls<ForwardDynamics>>>),
    #[cfg(feature = "jit")]
    Jit(Box<Machine>),
}

pub struct Lagrangian {
    hamiltonian: Hamiltonian<f64>,
    lagrangian: lagrangian::Lagrangian<f64>,
    workspace: Workspace,
}

impl Lagrangian {
    pub fn new(robot: &Robot, route: Route) -> Result<Self, String> {
        let function = || ByCalls(ForwardDynamics::new(robot));
        let workspace = match route {
            Route::Analytic => Workspace::Analytic(Box::new(LagrangianSecondOrder::new(robot))),
            Route::Dual => {
                Workspace::Dual(Box::new(Jacobian::new(function())), Box::new(NestedHessian::new(function())))
            }
            Route::Hyperdual => Workspace::Hyperdual(Box::new(Hessian::new(function()))),
            #[cfg(feature = "jit")]
            Route::Jit => Workspace::Jit(Box::new(Machine::new(robot, codegen::Coordinates::Lagrangian))),
            Route::Tensors => {
                return Err("--route tensors offers Hamiltonian coordinates only; use analytic, dual or hyperdual with \
                            --coordinates lagrangian"
                    .into());
            }
        };
        Ok(Self {
            hamiltonian: Hamiltonian::new(robot),
            lagrangian: lagrangian::Lagrangian::new(robot),
            workspace,
        })
    }
}

impl Evaluator for Lagrangian {
    fn answer(&mut self, state: &State, motion: &Motion) -> Result<Answer, Box<dyn std::error::Error>> {
        let State { q, u, .. } = state;
        let v = match motion {
            Motion::Velocity(v) => v.clone(),
            Motion::Momentum(p) => self.hamiltonian.velocity(q, p)?.to_vec(),
        };
        let energy = self.lagrangian.energy(q, &v)?;
        let mut answer = Answer::default();
        answer.vector("energy", &[energy.kinetic, energy.potential]);
        answer.matrix("M", self.lagrangian.mass_matrix(q)?.view());
        answer.vector("q", q);
        answer.vector("v", &v);
        let z = [state.inputs(u.len()), v.clone(), u.clone()].concat();
        let mut derivatives = |a: &[f64], a_z: Block<'_, f64>, y_a_zz: Option<Block<'_, f64>>| {
            answer.vector("qdd", a);
            answer.matrix("qdd_z", a_z);
            y_a_zz.into_iter().for_each(|y_a_zz| answer.matrix("yv_qdd_zz", y_a_zz));
        };
        match (&mut self.workspace, state.y.as_ref().map(|y| &y[u.len()..])) {
            (Workspace::Analytic(_), None) => {
                let linear = self.lagrangian.linearise_forward_dynamics(q, &v, u)?;
                derivatives(linear.acceleration(), linear.matrix(), None);
            }
            (Workspace::Analytic(second), Some(y)) => {
                let second = second.contract_forward_dynamics(q, &v, u, y)?;
                let linear = second.forward_dynamics();
                derivatives(linear.acceleration(), linear.matrix(), Some(second.to_matrix().view()));
            }
            (Workspace::Dual(jacobian, nested), y) => {
                jacobian.function_mut().0.set_centre(q).map_err(EvalError::from)?;
                nested.function_mut().0.set_centre(q).map_err(EvalError::from)?;
                let first = jacobian.linearise(&z)?;
                let second = y.map(|y| nested.contract(&z, y)).transpose()?;
                derivatives(first.value, first.jacobian.view(), second.map(Matrix::view));
            }
            (Workspace::Hyperdual(hessian), y) => {
                hessian.function_mut().0.set_centre(q).map_err(EvalError::from)?;
                hessian.contract(&z, y.unwrap_or(&vec![0.0; u.len()]))?;
                let (last, second) = (hessian.last(), hessian.last_contraction().view());
                derivatives(last.value(), last.jacobian().view(), y.map(|_| second));
            }
            #[cfg(feature = "jit")]
            (Workspace::Jit(machine), y) => {
                let results = machine.evaluate([q, &v, u], y)?;
                let entries: Vec<_> = results.iter().map(|(_, entries)| entries).collect();
                if let [a, a_z, second @ ..] = entries.as_slice() {
                    let whole = second.first_chunk().map(|[xx, uq]| whole_hessian(xx.view(), uq.view()));
                    derivatives(a.as_slice(), a_z.view(), whole.as_ref().map(Matrix::view));
                }
            }
        }
        Ok(answer)
    }
}
