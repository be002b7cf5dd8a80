//! Answers in (q, p): f, f_x, y_f_xx.

use super::line::{Answer, Motion, State};
#[cfg(feature = "jit")]
use super::machine::Machine;
use super::route::{Evaluator, Route};
#[cfg(feature = "jit")]
use costate::EvalError;
use costate::codegen;
use costate::derivative::{Hessian, Jacobian, NestedHessian, PhaseVelocity};
use costate::hamiltonian::{
    self, DualPass, HamiltonianContraction, HamiltonianLinearisation, HamiltonianSecondOrder,
};
use costate::matrix::Block;
use costate::robot::{Robot, Tree, printable};
use costate::tensors::Christoffel;

/// The workspaces of one method.
enum Workspace {
    Analytic(Box<HamiltonianSecondOrder<f64>>),
    Tensors(Box<DualPass<f64, Christoffel>>),
    Dual(Box<Jacobian<PhaseVelocity>>, Box<NestedHessian<PhaseVelocity>>),
    Hyperdual(Box<Hessian<PhaseVelocity>>),
    #[cfg(feature = "jit")]
    Jit(Box<Machine>),
}

impl Answer {
    fn linear(&mut self, linear: HamiltonianLinearisation<'_, f64>) {
        self.matrix("M", linear.mass_matrix().view());
        self.derivatives(linear.f(), linear.matrix());
    }

    fn contracted(&mut self, second: HamiltonianContraction<'_, f64>) {
        self.matrix("y_f_xx", second.matrix());
        self.linear(second.linearisation());
    }

    fn derivatives(&mut self, f: &[f64], f_x: Block<'_, f64>) {
        self.vector("v", &f[..f.len() / 2]);
        self.vector("f", f);
        self.matrix("f_x", f_x);
    }
}

pub struct Hamiltonian {
    hamiltonian: hamiltonian::Hamiltonian<f64>,
    workspace: Workspace,
}

impl Hamiltonian {
    pub fn new(robot: &Robot, route: Route) -> Result<Self, String> {
        if let (Route::Tensors, Some(free)) = (route, robot.free_joints().first()) {
            return Err(format!(
                "joint '{}' is {}, its orientation a quaternion, and --route tensors takes no such joint; use analytic, \
                 dual, hyperdual or jit",
                printable(&free.name),
                free.kind.name()
            ));
        }
        let function = || PhaseVelocity::new(robot);
        let workspace = match route {
            Route::Analytic => Workspace::Analytic(Box::new(HamiltonianSecondOrder::new(robot))),
            Route::Tensors => {
                Workspace::Tensors(Box::new(DualPass::with_route(Tree::from(robot), Christoffel)))
            }
            Route::Dual => {
                Workspace::Dual(Box::new(Jacobian::new(function())), Box::new(NestedHessian::new(function())))
            }
            Route::Hyperdual => Workspace::Hyperdual(Box::new(Hessian::new(function()))),
            #[cfg(feature = "jit")]
            Route::Jit => Workspace::Jit(Box::new(Machine::new(robot, codegen::Coordinates::Hamiltonian))),
        };
        Ok(Self { hamiltonian: hamiltonian::Hamiltonian::new(robot), workspace })
    }
}

impl Evaluator for Hamiltonian {
    fn answer(&mut self, state: &State, motion: &Motion) -> Result<Answer, Box<dyn std::error::Error>> {
        let State { q, u, .. } = state;
        let p = match motion {
            Motion::Momentum(p) => p.clone(),
            Motion::Velocity(v) => self.hamiltonian.momentum(q, v)?.to_vec(),
        };
        let energy = self.hamiltonian.energy(q, &p)?;
        let mut answer = Answer::default();
        answer.vector("energy", &[energy.kinetic, energy.potential]);
        answer.matrix("M", self.hamiltonian.mass_matrix(q)?.view());
        answer.vector("q", q);
        answer.vector("p", &p);
        let x = [state.inputs(u.len()), p.clone()].concat();
        let y = state.y.as_deref();
        match &mut self.workspace {
            Workspace::Analytic(second) => match y {
                None => answer.linear(second.first().linearise(q, &p, u)?),
                Some(y) => answer.contracted(second.contract(q, &p, u, y)?),
            },
            Workspace::Tensors(second) => match y {
                None => answer.linear(second.first().linearise(q, &p, u)?),
                Some(y) => answer.contracted(second.contract(q, &p, u, y)?),
            },
            Workspace::Dual(jacobian, nested) => {
                for function in [jacobian.function_mut(), nested.function_mut()] {
                    function.u.copy_from_slice(u);
                    function.set_centre(q).map_err(EvalError::from)?;
                }
                let first = jacobian.linearise(&x)?;
                answer.derivatives(first.value, first.jacobian.view());
                if let Some(y) = y {
                    answer.matrix("y_f_xx", nested.contract(&x, y)?.view());
                }
            }
            Workspace::Hyperdual(hessian) => {
                hessian.function_mut().u.copy_from_slice(u);
                hessian.function_mut().set_centre(q).map_err(EvalError::from)?;
                hessian.contract(&x, y.unwrap_or(&vec![0.0; x.len()]))?;
                answer.derivatives(hessian.last().value(), hessian.last().jacobian().view());
                if y.is_some() {
                    answer.matrix("y_f_xx", hessian.last_contraction().view());
                }
            }
            #[cfg(feature = "jit")]
            Workspace::Jit(machine) => {
                for (name, entries) in machine.evaluate([q, &p, u], y)? {
                    answer.result(name, &entries);
                    if name == "f" {
                        answer.vector("v", &entries.as_slice()[..u.len()]);
                    }
                }
            }
        }
        Ok(answer)
    }
}
