//! Programs of the quantities of a robot.

use super::error::CodegenError;
use super::expr::Expr;
use super::parameters::{labelled, layout, parameter_values};
use super::program::{Program, RecordedResult};
use super::quantity::{Coordinates, Quantity};
use super::text::name_from;
use crate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
use crate::lagrangian::{Lagrangian, LagrangianSecondOrder};
use crate::matrix::Block;
use crate::robot::{Robot, Tree};

/// What a program of a robot is made like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Leave out all results but the quantity itself.
    pub only: bool,
    /// Masses, lengths and other constants are one more argument, `parameters`, instead of numbers in the program: see
    /// [`parameter_values`](super::parameter_values). Directions of joints stay numbers. About twice as many operations.
    pub parameters: bool,
}

/// Records a quantity of a robot by the route with the fewest operations: see [`Quantity`] for arguments and results.
///
/// The name is that of robot, coordinates and quantity. Nothing is checked when the program runs: a singular mass matrix
/// gives results that are not finite.
///
/// # Errors
/// [`CodegenError::Quantity`] where there is no such quantity in these coordinates.
pub fn robot_program(
    robot: &Robot,
    quantity: Quantity,
    coordinates: Coordinates,
    options: &Options,
) -> Result<Program, CodegenError> {
    program_with(robot, quantity, coordinates, options, |_, _| Ok(Vec::new()))
}

/// The same with further results, of the model and q, recorded first and put last.
pub(super) fn program_with(
    robot: &Robot,
    quantity: Quantity,
    coordinates: Coordinates,
    options: &Options,
    further: impl FnOnce(&Tree, &[Expr]) -> Result<Vec<RecordedResult>, CodegenError>,
) -> Result<Program, CodegenError> {
    let names = quantity.arguments(coordinates, options.only);
    let names = names.ok_or_else(|| quantity.undefined(coordinates))?;
    let n = robot.len();
    let size = |name: &str| match (name, coordinates) {
        ("y" | "d", Coordinates::Hamiltonian) => 2 * n,
        _ => n,
    };
    let mut sizes: Vec<(&str, usize)> = names.iter().map(|&name| (name, size(name))).collect();
    if options.parameters {
        sizes.push(("parameters", parameter_values(robot).len()));
    }
    let name = name_from(&format!("{} {} {}", robot.name(), coordinates.name(), quantity.name()));
    let program = Program::try_record(&name, &sizes, |arguments| {
        let none = vec![<Expr as crate::scalar::Scalar>::zero(); n];
        let of = |name: &str| names.iter().position(|other| *other == name).map_or(&none, |k| &arguments[k]);
        let tree = match arguments.get(names.len()) {
            Some(parameters) => labelled(robot, parameters)?,
            None => Tree::from(robot),
        };
        let mut further = further(&tree, of("q"))?;
        let mut results = match coordinates {
            Coordinates::Hamiltonian => hamiltonian(tree, quantity, &of)?,
            Coordinates::Lagrangian => lagrangian(tree, quantity, &of)?,
        };
        if options.only {
            results.retain(|(name, ..)| quantity.result(coordinates).contains(&name.as_str()));
        }
        results.append(&mut further);
        Ok(results)
    })?;
    let what = if options.only { "alone" } else { "with what comes on the way" };
    let mut notes = vec![
        format!("{}: {} in {} coordinates, {what}.", robot.name(), quantity.name(), coordinates.name()),
        "The mass matrix must be regular: results are not finite otherwise, and nothing is checked.".into(),
    ];
    if options.parameters {
        notes.push("Parameters: link about the origin and in the axes of the joint frame of the robot file; SI units.".into());
        notes.extend(layout(robot));
    }
    Ok(program.with_notes(notes).with_meanings(&MEANINGS))
}

/// What the names stand for, in SI units.
const MEANINGS: [(&str, &str); 21] = [
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
    ("y_qdd_xx", "sum over k of y_k d2qdd_k/dx dx, x = (q, v), symmetric"),
    ("y_qdd_uq", "sum over k of y_k d2qdd_k/du dq"),
    ("tau", "actuation for a (N m, N)"),
    ("parameters", "constants of the robot, as listed above"),
];

fn vector(name: &str, entries: &[Expr]) -> RecordedResult {
    (name.into(), entries.len(), 1, entries.to_vec())
}

fn matrix(name: &str, block: Block<'_, Expr>) -> RecordedResult {
    (name.into(), block.rows(), block.columns(), block.iter_rows().flatten().copied().collect())
}

fn hamiltonian<'a>(
    tree: Tree,
    quantity: Quantity,
    of: &impl Fn(&str) -> &'a Vec<Expr>,
) -> Result<Vec<RecordedResult>, CodegenError> {
    let (q, p, u) = (of("q"), of("p"), of("u"));
    let mut first = Hamiltonian::<Expr>::from_tree(tree.clone());
    Ok(match quantity {
        Quantity::F => vec![vector("f", first.evaluate(q, p, u)?)],
        Quantity::FX => {
            let linear = first.linearise(q, p, u)?;
            vec![vector("f", linear.f()), matrix("f_x", linear.matrix())]
        }
        Quantity::YFX => {
            let product = first.adjoint(q, p, u, of("y"))?;
            vec![vector("f", product.f), vector("y_f_x", product.y_f_x)]
        }
        Quantity::YFXX => {
            let mut second = HamiltonianSecondOrder::<Expr>::from_tree(tree);
            let all = second.contract(q, p, u, of("y"))?;
            let linear = all.linearisation();
            vec![vector("f", linear.f()), matrix("f_x", linear.matrix()), matrix("y_f_xx", all.matrix())]
        }
        Quantity::YFXXD => {
            let mut second = HamiltonianSecondOrder::<Expr>::from_tree(tree);
            vec![vector("y_f_xx_d", second.hessian_product(q, p, of("y"), of("d"))?)]
        }
        Quantity::MassMatrix => vec![matrix("m", first.mass_matrix(q)?.view())],
        Quantity::Energy => {
            let energy = first.energy(q, p)?;
            vec![vector("kinetic", &[energy.kinetic]), vector("potential", &[energy.potential])]
        }
        Quantity::InverseDynamics => Vec::new(),
    })
}

fn lagrangian<'a>(
    tree: Tree,
    quantity: Quantity,
    of: &impl Fn(&str) -> &'a Vec<Expr>,
) -> Result<Vec<RecordedResult>, CodegenError> {
    let (q, v, u) = (of("q"), of("v"), of("u"));
    let mut first = Lagrangian::<Expr>::from_tree(tree.clone());
    Ok(match quantity {
        Quantity::F => vec![vector("qdd", first.forward_dynamics(q, v, u)?)],
        Quantity::FX => {
            let linear = first.linearise_forward_dynamics(q, v, u)?;
            vec![vector("qdd", linear.acceleration()), matrix("qdd_z", linear.matrix())]
        }
        Quantity::YFXX => {
            let mut second = LagrangianSecondOrder::<Expr>::from_tree(tree);
            let all = second.contract_forward_dynamics(q, v, u, of("y"))?;
            let linear = all.forward_dynamics();
            vec![
                vector("qdd", linear.acceleration()),
                matrix("qdd_z", linear.matrix()),
                matrix("y_qdd_xx", all.xx()),
                matrix("y_qdd_uq", all.uq()),
            ]
        }
        Quantity::MassMatrix => vec![matrix("m", first.mass_matrix(q)?.view())],
        Quantity::Energy => {
            let energy = first.energy(q, v)?;
            vec![vector("kinetic", &[energy.kinetic]), vector("potential", &[energy.potential])]
        }
        Quantity::InverseDynamics => vec![vector("tau", first.inverse_dynamics(q, v, of("a"))?)],
        Quantity::YFX | Quantity::YFXXD => Vec::new(),
    })
}
