//! Derivatives by parameters of the model on random trees.

mod inputs;
mod judges;
mod relations;
mod wrenches;

use costate::matrix::Matrix;
use costate::parameters::{DisplacedIn, Displacement, ParameterSet};
use costate::robot::{FrameSpec, Placement, Robot, Wrench, WrenchAxes};
use costate_test_support::random_robot::{Case, difference};
use proptest::test_runner::TestCaseError;

/// Largest relative difference of quantities that need no inverse mass matrix.
const TOLERANCE: f64 = 1e-12;

/// Everything that a set can hold: all of the model, what the model has not, a payload and two displacements.
fn everything(case: &Case) -> ParameterSet {
    let frame = FrameSpec::new("tool").on(last(case)).placed(tool(case));
    all_of(&case.robot().with_frame(frame).unwrap(), case)
}

/// The same of a robot with a wrench that turns with its last link, and one that does not.
fn everything_with_wrenches(case: &Case) -> ParameterSet {
    let [a, b, c] = [case.y[0], case.u[0], case.y[1]];
    let follower = Wrench { moment: [2.0, b, -a], force: [c, -3.0, 1.5], axes: WrenchAxes::Local };
    let dead = Wrench { moment: [c, 1.0, a], force: [4.0, a, b], axes: WrenchAxes::Aligned };
    let robot = everything(case).robot().with_wrench("tool", follower).unwrap();
    all_of(&robot.with_wrench("tool", dead).unwrap().with_wrench("j0", dead).unwrap(), case)
}

fn all_of(robot: &Robot, case: &Case) -> ParameterSet {
    let tilted = Displacement::about(DisplacedIn::Parent, [0.3, -0.5, 0.4]);
    let slid = Displacement::along(DisplacedIn::Joint, [0.7, 0.2, -1.0]);
    ParameterSet::new(robot)
        .model()
        .rotations()
        .stiffness()
        .friction()
        .armature()
        .payload("tool", "tool")
        .and_then(|set| set.displacement("tilted", "j0", tilted))
        .and_then(|set| set.displacement("slid", &last(case), slid))
        .unwrap()
}

/// Name of the last joint.
fn last(case: &Case) -> String {
    format!("j{}", case.parts.len() - 1)
}

/// A placement on the last link.
fn tool(case: &Case) -> Placement {
    Placement::from_xyz_rpy(case.parts[0].com, case.parts[0].axis)
}

/// The relative difference of two arrays is at most `tolerance`.
fn close(what: &str, found: &[f64], expected: &[f64], tolerance: f64) -> Result<(), TestCaseError> {
    let difference = difference(found, expected);
    if difference <= tolerance {
        return Ok(());
    }
    Err(TestCaseError::fail(format!("{what}: {difference:.2e} > {tolerance:.2e}: {found:?}, {expected:?}")))
}

/// Column of a parameter.
fn column(set: &ParameterSet, name: &str) -> usize {
    set.names().iter().position(|other| other == name).unwrap()
}

/// `A x`.
fn times(a: &Matrix<f64>, x: &[f64]) -> Vec<f64> {
    (0..a.rows()).map(|i| a.row(i).iter().zip(x).map(|(a, x)| a * x).sum()).collect()
}
