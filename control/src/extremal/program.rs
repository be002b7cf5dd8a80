//! The equations of an extremal as a program.

use crate::extremal::actuation::Actuation;
use crate::extremal::hamiltonian::equations::{Equations, Outputs};
use crate::problem::source_error::SourceError;
use crate::problem::{Bounds, Penalty, Problem};
use costate::codegen::{CodegenError, Expr, Program, RecordedResult, name_from};
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::robot::Tree;
use costate::scalar::Scalar;

/// What a program of extremals computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgramOf {
    /// z' and l: `pontryagin_rate`.
    Rate,
    /// z', l and the Jacobian of z': `pontryagin`.
    Jacobian,
}

impl ProgramOf {
    /// All programs.
    pub const ALL: [Self; 2] = [Self::Rate, Self::Jacobian];

    /// The name of the quantity.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rate => "pontryagin_rate",
            Self::Jacobian => "pontryagin",
        }
    }
}

/// Records the canonical equations of the maximised Hamiltonian of a problem, `z = (q, p, y_q, y_p)`:
///
/// ```text
/// z_t   = (F + (0, B u), -F_x'y + l_x)      u = clip(R^-1 B y_p)      4n
/// l     = (cost, penalty), c_t within the cost; H* = y'f - l          2
/// z_t_z = [ F_x             B R^-1 B where not at a bound ]           4n x 4n
///         [ l_xx - y'F_xx   -F_x'                         ]
/// ```
///
/// from the arguments q (n), p (n) and y = (y_q, y_p) (2n). These are the equations of
/// [`RobotExtremal`](crate::RobotExtremal) with weights, gains, bounds, penalties and [user
/// terms](crate::UserTerm) as constants. Start, end and time of the problem have no effect. The program
/// checks nothing when it runs. A control that costs nothing is at the bound that has the sign of b y_p, with
/// slope zero.
///
/// ```
/// use costate_control::{Problem, ProgramOf, pontryagin_program};
/// use costate::robot::Robot;
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let problem = Problem::rest_to_rest(robot, &[0.0; 2], &[1.0; 2], 1.0);
/// let program = pontryagin_program(&problem, ProgramOf::Jacobian)?;
/// assert_eq!((program.inputs(), program.outputs()), (8, 8 + 2 + 64));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// An [invalid](Problem::check) problem, or equations that cannot be recorded.
pub fn pontryagin_program(problem: &Problem, of: ProgramOf) -> Result<Program, SourceError> {
    let problem = problem.check()?.problem();
    let robot = &problem.robot;
    let n = robot.dof();
    let name = name_from(&format!("{} {}", robot.name(), of.name()));
    let actuation = Actuation::new(problem);
    let program = Program::try_record(&name, &[("q", n), ("p", n), ("y", 2 * n)], |arguments| {
        let z = arguments.concat();
        let mut equations =
            Equations::<Expr>::new(problem, HamiltonianSecondOrder::from_tree(Tree::from(robot)));
        let control = |i, y_p| actuation.maximal(i, y_p);
        let mut rate = vec![Expr::zero(); 4 * n];
        let mut matrix = Vec::new();
        let l = match of {
            ProgramOf::Rate => equations.evaluate(&z, control, &mut rate),
            ProgramOf::Jacobian => {
                matrix.resize(16 * n * n, Expr::zero());
                let outputs = Outputs { g: &mut rate, jacobian: &mut matrix };
                equations.linearise(&z, control, true, outputs)
            }
        };
        let l = l.map_err(CodegenError::Eval)?;
        let mut results =
            vec![RecordedResult::vector("z_t", rate), RecordedResult::vector("l", vec![l.cost, l.penalty])];
        if of == ProgramOf::Jacobian {
            results.push(RecordedResult::matrix("z_t_z", 4 * n, 4 * n, matrix));
        }
        Ok(results)
    })?;
    Ok(program.with_notes(notes(problem, of)).with_meanings(&MEANINGS))
}

/// Meanings of the names, in SI units.
const MEANINGS: [(&str, &str); 6] = [
    ("q", "positions (rad, m)"),
    ("p", "conjugate momenta M v (kg m^2/s, kg m/s)"),
    ("y", "costate (y_q, y_p)"),
    ("z_t", "dz/dt, z = (q, p, y_q, y_p)"),
    ("l", "running cost (with c_t), running penalty; H* = y'f - their sum"),
    ("z_t_z", "Jacobian of z_t, rows and columns in the order (q, p, y_q, y_p)"),
];

/// The comment at the top of generated text: the cost.
fn notes(problem: &Problem, of: ProgramOf) -> Vec<String> {
    let Problem { robot, cost, gain, bounds, penalty, terms, .. } = problem;
    let mut notes = vec![
        format!("{}: {}, the extremals of Pontryagin's principle.", robot.name(), of.name()),
        "H*(x, y) = max_u [ y'f - l ], x' = H*_y, y' = -H*_x, u = clip(R^-1 B y_p).".into(),
        format!("l = {} + 1/2 sum r_i u_i^2, r = {:?}; B = diag {gain:?}.", cost.time, cost.effort),
    ];
    if let Some(Bounds { u_min, u_max }) = bounds {
        notes.push(format!("Bounds: {u_min:?} <= u <= {u_max:?}."));
    }
    if let Some(Penalty { weight, q_min, q_max, v_max }) = penalty {
        notes.push(format!("Penalty: {weight}/2 times the squared violation of"));
        for (name, limit) in [("q_min", q_min), ("q_max", q_max), ("v_max", v_max)] {
            notes.extend(limit.as_ref().map(|limit| format!("  {name} = {limit:?}")));
        }
    }
    notes.extend(terms.iter().map(|term| format!("Further running cost: {term:?}.")));
    notes.push(
        "The mass matrix must be regular: results are not finite otherwise, and nothing is checked.".into(),
    );
    notes
}
