//! Programs of the quantities of a robot.

use super::evaluator::RobotQuantity;
use super::options::ProgramOptions;
use super::parameters::{labelled, layout, parameter_values};
use super::quantity::{Coordinates, Quantity, Variable};
use super::shape::Shape;
use super::size::check_size;
use super::symmetry::exchanged_joints;
use crate::codegen::error::CodegenError;
use crate::codegen::names::name_from;
use crate::codegen::program::Program;
use crate::codegen::program_ends::RecordedResult;
use crate::codegen::record::Expr;
use crate::robot::{Robot, Tree, printable};
use crate::scalar::Scalar;

/// Records a quantity of a robot by the route with the fewest operations: see [`Quantity`] for arguments and
/// results.
///
/// The name is that of robot, coordinates and quantity. Nothing is checked when the program runs: a singular
/// mass matrix gives results that are not finite.
///
/// # Errors
/// [`CodegenError::Quantity`] where the quantity is not defined in these coordinates;
/// [`CodegenError::LargeRobot`], [`CodegenError::LongRecording`] and [`CodegenError::TooLarge`] where the
/// program has more steps than [`ProgramOptions::limit`];
/// of a robot with floating or spherical joints
/// [`EvalError::FreeJointAndWrench`](crate::EvalError::FreeJointAndWrench) where a wrench acts on it, and
/// [`EvalError::FreeJoint`](crate::EvalError::FreeJoint) for [`ProgramOptions::parameters`].
pub fn robot_program(
    robot: &Robot,
    quantity: Quantity,
    coordinates: Coordinates,
    options: &ProgramOptions,
) -> Result<Program, CodegenError> {
    program_with(robot, quantity, coordinates, options, |_, _| Ok(Vec::new()))
}

/// The same with further results, of the model and q, recorded first and listed last.
pub(super) fn program_with(
    robot: &Robot,
    quantity: Quantity,
    coordinates: Coordinates,
    options: &ProgramOptions,
    further: impl FnOnce(&Tree, &[Expr]) -> Result<Vec<RecordedResult>, CodegenError>,
) -> Result<Program, CodegenError> {
    // A tree with labelled constants has no constraints.
    let tree = Tree::from(robot);
    tree.refuse_constraints()?;
    tree.refuse_free_and_wrench()?;
    if options.parameters {
        // The axes in which a quaternion turns are no parameters.
        robot.refuse_free_joints()?;
    }
    let (nq, n) = (robot.nq(), robot.dof());
    let variables = quantity.arguments(coordinates).ok_or_else(|| quantity.undefined(coordinates))?;
    let name = name_from(&format!("{} {} {}", robot.name(), coordinates.name(), quantity.name()));
    check_size(robot, quantity, coordinates, &name, options.limit)?;
    let is_argument = |variable: Variable| !options.only || quantity.depends_on(variable, coordinates);
    let shapes = variables.iter().filter(|variable| is_argument(**variable));
    let shapes = shapes.map(|variable| variable.shape(coordinates, [nq, n]));
    let mut sizes: Vec<(&str, usize)> = shapes.map(|shape| (shape.name, shape.entries())).collect();
    if options.parameters {
        sizes.push(("parameters", parameter_values(robot).len()));
    }
    let program = Program::try_record_within(&name, &sizes, options.limit, |arguments| {
        let mut arguments = arguments.iter();
        // A variable that the quantity does not depend on is zero.
        let inputs: Vec<Vec<Expr>> = variables
            .iter()
            .map(|&variable| {
                let given = is_argument(variable).then(|| arguments.next().cloned()).flatten();
                let entries = variable.shape(coordinates, [nq, n]).entries();
                given.unwrap_or_else(|| vec![Expr::zero(); entries])
            })
            .collect();
        let tree = match arguments.next() {
            Some(parameters) => labelled(robot, parameters)?,
            None => tree.clone(),
        };
        let mut further = further(&tree, inputs.first().map_or(&[], Vec::as_slice))?;
        let mut evaluator = RobotQuantity::<Expr>::from_tree(tree, quantity, coordinates)?;
        let mut outputs = vec![Expr::zero(); evaluator.outputs()];
        evaluator.evaluate(&inputs.concat(), &mut outputs)?;
        let mut results = split(evaluator.results(), &outputs);
        if options.only {
            let (all, own) = quantity.results(coordinates, n);
            results.drain(..all.len() - own);
        }
        results.append(&mut further);
        Ok(results)
    })?;
    let what = if options.only { "alone" } else { "with the results it builds on" };
    let mut notes = vec![
        format!("{}: {} in {} coordinates, {what}.", robot.name(), quantity.name(), coordinates.name()),
        if quantity.inverts(coordinates) {
            "The mass matrix must be regular: results are not finite otherwise, and nothing is checked."
                .into()
        } else {
            "Nothing is checked.".into()
        },
    ];
    if let Some(free) = robot.free_joints().first() {
        notes.push(format!(
            "The orientation of joint {} is a quaternion x, y, z, w of length 1, which is not checked; derivatives \
             by q are those in the tangent space.",
            printable(&free.name)
        ));
    }
    if options.parameters {
        notes.push("Parameters: link about the origin and in the axes of the joint frame of the robot file; SI units.".into());
        notes.extend(layout(robot));
    }
    let is_plain = !options.parameters && robot.free_joints().is_empty();
    let exchanged = exchanged_joints(robot).filter(|_| is_plain).unwrap_or_default();
    let program = program.with_notes(notes).with_meanings(&MEANINGS).with_symmetry(&exchanged);
    let program = match robot.free_joints().is_empty() {
        true => program,
        false => program.with_meanings(&[("q", "positions (rad, m) and unit quaternions x, y, z, w")]),
    };
    let weights = [("y", "weights of the entries of tau")];
    Ok(if quantity == Quantity::YTauZZ { program.with_meanings(&weights) } else { program })
}

/// Results of these shapes.
fn split(shapes: &[Shape], entries: &[Expr]) -> Vec<RecordedResult> {
    let mut rest = entries;
    let result = |shape: &Shape| {
        let (part, more) = rest.split_at(shape.entries());
        rest = more;
        RecordedResult::matrix(shape.name, shape.rows, shape.columns, part.to_vec())
    };
    shapes.iter().map(result).collect()
}

/// The meaning of each name, in SI units.
const MEANINGS: [(&str, &str); 25] = [
    ("q", "positions (rad, m)"),
    ("p", "conjugate momenta M v (kg m^2/s, kg m/s)"),
    ("v", "velocities (rad/s, m/s)"),
    ("u", "actuation (N m, N)"),
    ("a", "accelerations (rad/s^2, m/s^2)"),
    ("y", "costate"),
    ("d", "direction (d_q, d_p)"),
    ("f", "dx/dt, x = (q, p)"),
    ("f_x", "df/dx, rows and columns in the order (q, p)"),
    ("y_f_x", "sum over k of y_k df_k/dx"),
    ("y_f_xx", "sum over k of y_k d2f_k/dx dx, symmetric"),
    ("y_f_xx_d", "that matrix times d"),
    ("m", "mass matrix, armature included (kg m^2, kg m, kg)"),
    ("kinetic", "kinetic energy (J)"),
    ("potential", "potential energy (J)"),
    ("qdd", "accelerations (rad/s^2, m/s^2)"),
    ("qdd_z", "d qdd/dz, columns in the order z = (q, v, u)"),
    ("y_qdd_z", "sum over k of y_k d qdd_k/dz, z = (q, v, u)"),
    ("y_qdd_xx", "sum over k of y_k d2qdd_k/dx dx, x = (q, v), symmetric"),
    ("y_qdd_uq", "sum over k of y_k d2qdd_k/du dq"),
    ("tau", "actuation for a (N m, N)"),
    ("tau_z", "d tau/dz, columns in the order z = (q, v, a)"),
    ("y_tau_xx", "sum over k of y_k d2tau_k/dx dx, x = (q, v), symmetric"),
    ("y_tau_aq", "sum over k of y_k d2tau_k/da dq"),
    ("parameters", "constants of the robot, as listed above"),
];
