//! Frames, the centre of mass and momenta.

use crate::argument::Argument;
use crate::cores::{Writer, core_of, lanes_of};
use crate::engine::Engine;
use crate::errors::Failure;
use crate::function::Function;
use crate::plan::Plan;
use costate::configuration::FreeKinematics;
use costate::hamiltonian::Hamiltonian;
use costate::kinematics::ReferenceFrame;
use costate::robot::Robot;
use costate::scalar::{F64x4, Scalar};
use costate::spatial::Motion;
use std::sync::Arc;

/// The methods of `Frame`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameVerb {
    Pose,
    Jacobian,
    JacobianRate,
    Twist,
    Acceleration,
    PositionHessian,
}

/// Number of methods of `Frame`.
pub const FRAME_VERBS: usize = 6;

/// The methods of `Dynamics` for the robot as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyVerb {
    Momentum,
    Velocity,
    CentreOfMass,
    CentroidalMomentum,
}

/// Number of methods of `Dynamics` for the robot as a whole.
pub const BODY_VERBS: usize = 4;

/// A function of one frame.
pub fn of_frame(robot: Arc<Robot>, verb: FrameVerb, frame: usize, axes: ReferenceFrame) -> Function {
    let n = robot.dof();
    let q = Argument::of_positions("q", [robot.nq(), n]);
    let [v, a] = ["v", "a"].map(|name| Argument::of_joints(name, n));
    let w = Argument::in_space("w");
    let plan = match verb {
        FrameVerb::Pose => Plan::whole(&[q], &[&[3, 3], &[3]]),
        FrameVerb::Jacobian => Plan::whole(&[q], &[&[6, n]]),
        FrameVerb::JacobianRate => Plan::whole(&[q, v], &[&[6, n]]),
        FrameVerb::Twist => Plan::whole(&[q, v], &[&[6]]),
        FrameVerb::Acceleration => Plan::whole(&[q, v, a], &[&[6]]),
        FrameVerb::PositionHessian => Plan::whole(&[q, w], &[&[n, n]]),
    };
    let lanes = {
        let robot = robot.clone();
        move || {
            let workspace = FreeKinematics::<F64x4>::new(&robot);
            Some(lanes_of(workspace, move |of, inputs, outputs| {
                motion(of, verb, (frame, axes), inputs, outputs)
            }))
        }
    };
    let workspace = FreeKinematics::<f64>::new(&robot);
    let core = move || {
        core_of(workspace.clone(), move |of, inputs, outputs| {
            motion(of, verb, (frame, axes), inputs, outputs)
        })
    };
    Function::new(plan, Arc::new(Engine::new(core).with_lanes(lanes).short(n < SHORT)), robot)
}

/// What a method of `Frame` computes.
fn motion<S: Scalar>(
    of: &mut FreeKinematics<S>,
    verb: FrameVerb,
    (frame, axes): (usize, ReferenceFrame),
    inputs: &[S],
    outputs: &mut [S],
) -> Result<(), Failure> {
    let n = of.dof();
    let (q, rest) = inputs.split_at(of.nq());
    let mut writer = Writer(outputs);
    let mut put_motion = |Motion { angular, linear }: Motion<S>| {
        writer.put(&angular.to_array()).put(&linear.to_array());
    };
    match verb {
        FrameVerb::Pose => {
            of.set_position(q)?;
            let pose = of.pose(frame)?;
            writer.put(pose.rotation.as_flattened()).put(&pose.position);
        }
        FrameVerb::Jacobian => {
            of.set_position(q)?;
            writer.put(of.jacobian(frame, axes)?.as_slice());
        }
        FrameVerb::JacobianRate => {
            of.set_state(q, rest)?;
            writer.put(of.jacobian_rate(frame, axes)?.as_slice());
        }
        FrameVerb::Twist => {
            of.set_state(q, rest)?;
            put_motion(of.twist(frame, axes)?);
        }
        FrameVerb::Acceleration => {
            of.set_motion(q, &rest[..n], &rest[n..])?;
            put_motion(of.acceleration(frame, axes)?);
        }
        FrameVerb::PositionHessian => {
            of.set_position(q)?;
            writer.put(of.position_hessian(frame, &[rest[0], rest[1], rest[2]])?.as_slice());
        }
    }
    Ok(())
}

/// Robots with fewer joints have kinematics within microseconds.
const SHORT: usize = 20;

/// A function of the whole robot.
pub fn of_robot(robot: Arc<Robot>, verb: BodyVerb) -> Function {
    let n = robot.dof();
    let q = Argument::of_positions("q", [robot.nq(), n]);
    let [v, p] = ["v", "p"].map(|name| Argument::of_joints(name, n));
    let plan = match verb {
        BodyVerb::Momentum => Plan::whole(&[q, v], &[&[n]]),
        BodyVerb::Velocity => Plan::whole(&[q, p], &[&[n]]),
        BodyVerb::CentreOfMass => Plan::whole(&[q], &[&[3]]),
        BodyVerb::CentroidalMomentum => Plan::whole(&[q, v], &[&[6], &[6, n]]),
    };
    let shared = robot.clone();
    let engine = match verb {
        BodyVerb::Momentum | BodyVerb::Velocity => {
            let workspace = Hamiltonian::<f64>::new(&robot);
            let core = move || {
                core_of(workspace.clone(), move |of, inputs, outputs| conjugate(of, verb, inputs, outputs))
            };
            let lanes = move || {
                let workspace = Hamiltonian::<F64x4>::new(&shared);
                Some(lanes_of(workspace, move |of, inputs, outputs| conjugate(of, verb, inputs, outputs)))
            };
            Engine::new(core).with_lanes(lanes)
        }
        BodyVerb::CentreOfMass | BodyVerb::CentroidalMomentum => {
            let workspace = FreeKinematics::<f64>::new(&robot);
            let core = move || {
                core_of(workspace.clone(), move |of, inputs, outputs| centre(of, verb, inputs, outputs))
            };
            let lanes = move || {
                let workspace = FreeKinematics::<F64x4>::new(&shared);
                Some(lanes_of(workspace, move |of, inputs, outputs| centre(of, verb, inputs, outputs)))
            };
            Engine::new(core).with_lanes(lanes)
        }
    };
    Function::new(plan, Arc::new(engine.short(n < SHORT)), robot)
}

/// Momenta of velocities, or velocities of momenta.
fn conjugate<S: Scalar>(
    of: &mut Hamiltonian<S>,
    verb: BodyVerb,
    inputs: &[S],
    outputs: &mut [S],
) -> Result<(), Failure> {
    let (q, rate) = inputs.split_at(of.tree().nq());
    outputs.copy_from_slice(match verb {
        BodyVerb::Momentum => of.momentum(q, rate)?,
        _ => of.velocity(q, rate)?,
    });
    Ok(())
}

/// The centre of mass, or the momenta about it.
fn centre<S: Scalar>(
    of: &mut FreeKinematics<S>,
    verb: BodyVerb,
    inputs: &[S],
    outputs: &mut [S],
) -> Result<(), Failure> {
    let (q, v) = inputs.split_at(of.nq());
    if verb == BodyVerb::CentreOfMass {
        of.set_position(q)?;
        outputs.copy_from_slice(&of.centre_of_mass()?.position);
    } else {
        of.set_state(q, v)?;
        let momentum = of.momentum()?;
        let mut writer = Writer(outputs);
        writer.put(&momentum.angular).put(&momentum.linear).put(momentum.matrix.as_slice());
    }
    Ok(())
}
