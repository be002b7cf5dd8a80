//! Functions of robots whose loops are closed by constraints.

use crate::argument::Argument;
use crate::contacts::{self, OfImpact};
use crate::cores::{Writer, core_of};
use crate::engine::Engine;
use crate::errors::Failure;
use crate::function::Function;
use crate::plan::Plan;
use costate::Coordinates;
use costate::constraints::{ConstrainedHamiltonianSecondOrder, ConstrainedLinearisation};
use costate::contacts::ForceMap;
use costate::matrix::Block;
use costate::robot::Robot;
use std::sync::Arc;

/// The methods of `ConstrainedDynamics`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verb {
    F,
    Jacobian,
    Hessian,
    Linearise,
    Contract,
    Adjoint,
    Hvp,
    Acceleration,
    Multipliers,
    Forces,
    Momentum,
    Velocity,
    Energy,
    Constraint,
    ConstraintJacobian,
    ConstraintRate,
    Drift,
    Counted,
    Project,
    Impact,
    ImpactJacobian,
    ImpactHessian,
    MultiplierJacobian,
    MultiplierHessian,
    Close,
}

/// Number of methods.
pub const VERBS: usize = Verb::Close as usize + 1;

/// What computes all of them.
type Workspace = ConstrainedHamiltonianSecondOrder<f64>;

/// Robots with fewer joints take microseconds for all but projections.
const SHORT: usize = 12;

/// A function of a robot with k rows of constraints.
pub fn of_constrained(robot: Arc<Robot>, verb: Verb, k: usize) -> Function {
    use Verb::*;
    let (nq, n, c) = (robot.nq(), robot.dof(), robot.constraints().len());
    let [q, start] = ["q", "q_0"].map(|name| Argument::of_positions(name, [nq, n]));
    let [p, v, tau, held] = ["p", "v", "tau", "held"].map(|name| Argument::of_joints(name, n));
    let [y, d] = [("y", 2 * n), ("d", 3 * n)].map(|(name, length)| Argument::of_joints(name, length));
    let (j, h): (&[usize], &[usize]) = (&[2 * n, 3 * n], &[3 * n, 3 * n]);
    let plan = match verb {
        F => Plan::whole(&[q, p, tau], &[&[2 * n]]),
        Jacobian => Plan::whole(&[q, p, tau], &[j]),
        Hessian => Plan::whole(&[q, p, tau, y], &[h]),
        Linearise => Plan::whole(&[q, p, tau], &[&[2 * n], j]),
        Contract => Plan::whole(&[q, p, tau, y], &[&[2 * n], j, h]),
        Adjoint => Plan::whole(&[q, p, tau, y], &[&[3 * n]]),
        Hvp => Plan::whole(&[q, p, tau, y, d], &[&[3 * n]]),
        Acceleration => Plan::whole(&[q, p, tau], &[&[n]]),
        Multipliers => Plan::whole(&[q, p, tau], &[&[k]]),
        Forces => Plan::whole(&[q, p, tau], &[&[c, 3], &[c, 3]]),
        Momentum => Plan::whole(&[q, v], &[&[n]]),
        Velocity => Plan::whole(&[q, p], &[&[n], &[k]]),
        Energy => Plan::whole(&[q, p], &[&[], &[]]),
        Constraint | Counted => Plan::whole(&[q], &[&[k]]),
        ConstraintJacobian => Plan::whole(&[q], &[&[k, n]]),
        ConstraintRate => Plan::whole(&[q, v], &[&[k]]),
        Drift => Plan::whole(&[q, start], &[&[k]]),
        Project => Plan::whole(&[q, p, start], &[&[nq], &[n]]),
        Close => Plan::whole(&[q, held], &[&[nq]]),
        Impact => Plan::whole(&[q, p], &[&[n], &[n], &[k], &[]]),
        ImpactJacobian => Plan::whole(&[q, p], &[&[n, 2 * n], &[n, 2 * n], &[k, 2 * n]]),
        ImpactHessian => Plan::whole(&[q, p, Argument::of_joints("y", n)], &[&[2 * n, 2 * n]]),
        MultiplierJacobian => Plan::whole(&[q, p, tau], &[&[k, 3 * n]]),
        MultiplierHessian => Plan::whole(&[q, p, tau, Argument::of_rows("c", k)], &[h]),
    };
    match verb {
        Impact | ImpactJacobian | ImpactHessian => {
            let workspace = costate::constraints::Impact::new(&robot);
            let what = match verb {
                Impact => OfImpact::Value,
                ImpactJacobian => OfImpact::Jacobian,
                _ => OfImpact::Hessian,
            };
            let core = move || {
                core_of(workspace.clone(), move |of, inputs, outputs| {
                    contacts::impact(of, what, nq, inputs, &mut Writer(outputs))
                })
            };
            return Function::new(plan, Arc::new(Engine::new(core).short(n < SHORT)), robot);
        }
        MultiplierJacobian | MultiplierHessian => {
            let workspace = ForceMap::new(&robot, Coordinates::Hamiltonian);
            let core = move || {
                core_of(workspace.clone(), move |of, inputs, outputs| {
                    contacts::multipliers(of, verb == MultiplierHessian, nq, inputs, &mut Writer(outputs))
                })
            };
            return Function::new(plan, Arc::new(Engine::new(core).short(n < SHORT)), robot);
        }
        _ => {}
    }
    let workspace = Workspace::new(&robot);
    let core = move || {
        core_of(workspace.clone(), move |of, inputs, outputs| {
            let mut writer = Writer(outputs);
            match verb {
                F | Jacobian | Hessian | Linearise | Contract | Adjoint | Hvp => {
                    equation(of, (verb, nq), inputs, &mut writer)
                }
                Acceleration | Multipliers | Forces => forces(of, (verb, nq), c, inputs, &mut writer),
                _ => state(of, (verb, nq), inputs, &mut writer),
            }
        })
    };
    let short = n < SHORT && !matches!(verb, Project | Close);
    // Couplings of joints have no force.
    Function::new(plan, Arc::new(Engine::new(core).short(short)), robot).with_gaps(verb == Forces)
}

/// The state equation and its derivatives.
fn equation(
    of: &mut Workspace,
    (verb, nq): (Verb, usize),
    inputs: &[f64],
    writer: &mut Writer<'_, f64>,
) -> Result<(), Failure> {
    let n = of.dof();
    let (q, rest) = inputs.split_at(nq);
    let (p, rest) = rest.split_at(n);
    let (tau, rest) = rest.split_at(n);
    match verb {
        Verb::F => {
            writer.put(of.first().evaluate(q, p, tau)?.f);
        }
        Verb::Jacobian => put_jacobian(writer, &of.first().linearise(q, p, tau)?),
        Verb::Linearise => {
            let found = of.first().linearise(q, p, tau)?;
            writer.put(found.f());
            put_jacobian(writer, &found);
        }
        Verb::Adjoint => {
            writer.put(of.first().adjoint(q, p, tau, rest)?.y_f_x).put(&rest[n..]);
        }
        Verb::Hvp => {
            let (y, d) = rest.split_at(2 * n);
            writer.put(of.hessian_product(q, p, y, &d[..2 * n])?);
            writer.zeros(n);
        }
        _ => {
            let found = of.contract(q, p, tau, rest)?;
            if verb == Verb::Contract {
                writer.put(found.linearisation().f());
                put_jacobian(writer, &found.linearisation());
            }
            put_hessian(writer, found.matrix(), n);
        }
    }
    Ok(())
}

/// `(F_x F_u)`.
fn put_jacobian(writer: &mut Writer<'_, f64>, found: &ConstrainedLinearisation<'_, f64>) {
    let (by_x, by_u) = (found.matrix(), found.f_u());
    (0..found.f().len()).for_each(|i| {
        writer.put(by_x.row(i)).put(by_u.row(i));
    });
}

/// `y'F_xx`, with zeros for the n entries of tau.
fn put_hessian(writer: &mut Writer<'_, f64>, by_x: Block<'_, f64>, n: usize) {
    for i in 0..2 * n {
        writer.put(by_x.row(i));
        writer.zeros(n);
    }
    writer.zeros(3 * n * n);
}

/// Accelerations and what the constraints exert.
fn forces(
    of: &mut Workspace,
    (verb, nq): (Verb, usize),
    count: usize,
    inputs: &[f64],
    writer: &mut Writer<'_, f64>,
) -> Result<(), Failure> {
    let n = of.dof();
    let (q, rest) = inputs.split_at(nq);
    let found = of.first().linearise(q, &rest[..n], &rest[n..])?;
    match verb {
        Verb::Acceleration => {
            writer.put(found.acceleration());
        }
        Verb::Multipliers => {
            writer.put(found.lambda());
        }
        _ => {
            let lambda = found.lambda().to_vec();
            let constraints = of.first().constraints();
            let wrenches = (0..count).map(|i| constraints.wrench(i, &lambda));
            let wrenches: Vec<_> =
                wrenches.map(|found| found.unwrap_or(([f64::NAN; 3], [f64::NAN; 3]))).collect();
            for (force, _) in &wrenches {
                writer.put(force);
            }
            for (_, moment) in &wrenches {
                writer.put(moment);
            }
        }
    }
    Ok(())
}

/// Positions, velocities and what the constraints say about them.
fn state(
    of: &mut Workspace,
    (verb, nq): (Verb, usize),
    inputs: &[f64],
    writer: &mut Writer<'_, f64>,
) -> Result<(), Failure> {
    let n = of.dof();
    let (q, rest) = inputs.split_at(nq);
    let of = of.first();
    match verb {
        Verb::Momentum => {
            writer.put(of.momentum(q, rest)?);
        }
        Verb::Velocity => {
            let (v, mu) = of.velocity(q, rest)?;
            writer.put(v).put(mu);
        }
        Verb::Energy => {
            let energy = of.energy(q, rest)?;
            writer.put(&[energy.kinetic, energy.potential]);
        }
        Verb::Constraint | Verb::ConstraintJacobian => {
            // The rate of no velocity sets the position.
            of.constraint_rate(q, &vec![0.0; n])?;
            match verb {
                Verb::Constraint => writer.put(of.constraints().values()),
                _ => writer.put(of.constraints().jacobian().as_slice()),
            };
        }
        Verb::ConstraintRate => {
            writer.put(of.constraint_rate(q, rest)?);
        }
        Verb::Drift => {
            writer.put(of.drift(q, rest)?);
        }
        Verb::Counted => {
            of.velocity(q, &vec![0.0; n])?;
            writer.put(of.counted());
        }
        Verb::Project => {
            let (mut q, mut p) = (q.to_vec(), rest[..n].to_vec());
            of.project(&mut q, &mut p, &rest[n..])?;
            writer.put(&q).put(&p);
        }
        _ => {
            let (mut q, held) = (q.to_vec(), rest.iter().map(|held| *held != 0.0).collect::<Vec<_>>());
            of.close(&mut q, &held)?;
            writer.put(&q);
        }
    }
    Ok(())
}
