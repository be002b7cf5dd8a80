//! Functions of the configurations of a robot: q (+) d, differences and their Jacobians.

use crate::argument::Argument;
use crate::cores::{Writer, core_of, lanes_of};
use crate::engine::Engine;
use crate::errors::Failure;
use crate::function::Function;
use crate::plan::Plan;
use costate::configuration::{ConfigurationJacobians, ConfigurationSpace};
use costate::robot::Robot;
use costate::scalar::Scalar;
use std::sync::{Arc, OnceLock};

/// The methods of `Robot` that are functions of configurations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verb {
    Integrate,
    Difference,
    IntegrateJacobians,
    DifferenceJacobians,
    Normalize,
}

/// Number of these methods.
const VERBS: usize = 5;

/// The functions of a robot, made when they are called first.
#[derive(Default)]
pub struct Functions([OnceLock<Function>; VERBS]);

impl Functions {
    /// That of a method, of this robot.
    pub fn of(&self, robot: &Arc<Robot>, verb: Verb) -> &Function {
        self.0[verb as usize].get_or_init(|| of_space(robot.clone(), verb))
    }
}

/// A function of the configurations of a robot.
fn of_space(robot: Arc<Robot>, verb: Verb) -> Function {
    let sizes = [robot.nq(), robot.dof()];
    let ([nq, n], d) = (sizes, Argument::of_joints("d", robot.dof()));
    let position = |name| Argument::of_positions(name, sizes);
    let (ends, square): ([Argument; 2], &[usize]) = ([position("q_0"), position("q_1")], &[n, n]);
    let plan = match verb {
        Verb::Integrate => Plan::whole(&[position("q"), d], &[&[nq]]),
        Verb::Difference => Plan::whole(&ends, &[&[n]]),
        Verb::IntegrateJacobians => Plan::whole(&[d], &[square, square]),
        Verb::DifferenceJacobians => Plan::whole(&ends, &[square, square]),
        Verb::Normalize => Plan::whole(&[position("q")], &[&[nq]]),
    };
    let space = ConfigurationSpace::new(&robot);
    let lanes = {
        let space = space.clone();
        move || {
            let space = space.clone();
            Some(lanes_of(space, move |of, inputs, outputs| compute(of, verb, inputs, outputs)))
        }
    };
    let core = move || core_of(space.clone(), move |of, inputs, outputs| compute(of, verb, inputs, outputs));
    Function::new(plan, Arc::new(Engine::new(core).with_lanes(lanes).short(n < SHORT)), robot)
}

/// Robots with fewer joints take microseconds.
const SHORT: usize = 60;

fn compute<S: Scalar>(
    of: &mut ConfigurationSpace,
    verb: Verb,
    inputs: &[S],
    outputs: &mut [S],
) -> Result<(), Failure> {
    let put = |of: &ConfigurationJacobians<S>, outputs: &mut [S]| {
        Writer(outputs).put(of.first.as_slice()).put(of.second.as_slice());
    };
    match verb {
        Verb::Integrate => {
            let (q, d) = inputs.split_at(of.nq());
            of.integrate(q, d, outputs)?;
        }
        Verb::Difference => {
            let (from, to) = inputs.split_at(of.nq());
            of.difference(from, to, outputs)?;
        }
        Verb::IntegrateJacobians => put(&of.integrate_jacobians(inputs)?, outputs),
        Verb::DifferenceJacobians => {
            let (from, to) = inputs.split_at(of.nq());
            put(&of.difference_jacobians(from, to)?, outputs);
        }
        Verb::Normalize => {
            outputs.copy_from_slice(inputs);
            of.normalize(outputs).map_err(costate::EvalError::from)?;
        }
    }
    Ok(())
}
