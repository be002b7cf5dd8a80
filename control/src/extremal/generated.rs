//! Extremals whose equations are generated code.

use crate::extremal::hamiltonian::equations::Running;
use crate::extremal::hamiltonian::{RobotExtremal, with_hamiltonian};
use crate::extremal::wrapped::{Hooks, Wrapped};
use crate::extremal::{BoundaryValueProblem, ControlLaw, HamiltonianTerms, Homotopy, Relaxation};
use crate::options::JacobianRoute;
use crate::problem::Problem;
use crate::problem::source_error::SourceError;
use costate::EvalError;

/// The extremals of a [`Problem`] with z' and its Jacobian from functions: from the compiled source of
/// [`pontryagin_program`](crate::pontryagin_program), for example.
///
/// The functions replace the equations of the original problem. The equations of the library serve on arcs
/// along bounds, for relaxed problems (weaker penalties, wider bounds), and where a result of the functions
/// is not finite. Ends, controls and bounds are those of [`RobotExtremal`].
///
/// ```
/// use costate_control::{
///     FinalTime, GeneratedExtremal, Problem, ProgramOf, SolverOptions, pontryagin_program, solve_extremal,
/// };
/// use costate::robot::Robot;
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/pendulum.toml")?;
/// let problem = Problem::rest_to_rest(robot, &[0.0], &[1.0], 1.0);
/// let [rate, linear] = [ProgramOf::Rate, ProgramOf::Jacobian].map(|of| pontryagin_program(&problem, of));
/// let ((rate, linear), mut work) = ((rate?, linear?), Vec::new());
/// // Here the programs are interpreted. Use their compiled source instead.
/// # use costate::codegen::Program;
/// let run = |program: &Program, z: &[f64], results: &mut [&mut [f64]], work: &mut Vec<f64>| {
///     let mut all = vec![0.0; program.outputs()];
///     program.evaluate(z, &mut all, work).unwrap_or_default();
///     let mut rest = all.as_slice();
///     for result in results {
///         let (now, later) = rest.split_at(result.len());
///         result.copy_from_slice(now);
///         rest = later;
///     }
/// };
/// let mut other = Vec::new();
/// let mut extremal = GeneratedExtremal::new(
///     &problem,
///     |z, z_t, l| run(&rate, z, &mut [z_t, l], &mut work),
///     |z, z_t, l, z_t_z| run(&linear, z, &mut [z_t, l, z_t_z], &mut other),
/// )?;
/// let options = SolverOptions::default();
/// let motion = solve_extremal(&mut extremal, FinalTime::Fixed(1.0), &options, |s, z| z[0] = s).motion;
/// assert!(motion.status.is_converged());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub type GeneratedExtremal<R, L> = Wrapped<RobotExtremal, GeneratedEquations<R, L>>;

/// The functions of a [`GeneratedExtremal`].
#[derive(Clone, Debug)]
pub struct GeneratedEquations<R, L> {
    rate: R,
    linear: L,
}

impl<R, L> GeneratedExtremal<R, L>
where
    R: FnMut(&[f64], &mut [f64], &mut [f64]),
    L: FnMut(&[f64], &mut [f64], &mut [f64], &mut [f64]),
{
    /// `rate` writes z_t (4n) and l (2) for a z (4n), `linear` z_t, l and z_t_z (4n x 4n, row-major).
    ///
    /// # Errors
    /// An [invalid](Problem::check) problem, or a mass matrix that is singular at the start or the end.
    pub fn new(problem: &Problem, rate: R, linear: L) -> Result<Self, SourceError> {
        let inner = RobotExtremal::new(problem.check()?, JacobianRoute::Exact)?;
        Ok(Self { inner, hooks: GeneratedEquations { rate, linear } })
    }
}

/// Whether generated code computes these equations: those of the original problem, or of one with a nearer
/// end.
fn is_generated(library: &RobotExtremal, law: ControlLaw<'_>) -> bool {
    let equations = Relaxation { goal: 1.0, ..library.relaxation() };
    equations == Relaxation::NONE && law == ControlLaw::Maximal
}

impl<R, L> Hooks<RobotExtremal> for GeneratedEquations<R, L>
where
    R: FnMut(&[f64], &mut [f64], &mut [f64]),
    L: FnMut(&[f64], &mut [f64], &mut [f64], &mut [f64]),
{
    fn evaluate(
        &mut self,
        library: &mut RobotExtremal,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        if is_generated(library, law) {
            let mut l = [0.0; 2];
            (self.rate)(z, g, &mut l);
            if all_finite(g) && all_finite(&l) {
                return Ok(with_costs(z, g, l));
            }
        }
        library.evaluate(z, law, g)
    }

    fn linearise(
        &mut self,
        library: &mut RobotExtremal,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        if is_generated(library, law) {
            let mut l = [0.0; 2];
            (self.linear)(z, g, &mut l, jacobian);
            if all_finite(g) && all_finite(&l) && all_finite(jacobian) {
                return Ok(with_costs(z, g, l));
            }
        }
        library.linearise(z, law, g, jacobian)
    }

    fn linearise_exactly(
        &mut self,
        library: &mut RobotExtremal,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        self.linearise(library, z, law, g, jacobian)
    }
}

/// H* and l from what generated code writes: the cost, and the penalties.
fn with_costs(z: &[f64], g: &[f64], [cost, penalty]: [f64; 2]) -> HamiltonianTerms {
    with_hamiltonian(z, g, Running { cost, penalty, smoothing: 0.0 })
}

fn all_finite(values: &[f64]) -> bool {
    values.iter().all(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use costate::robot::Robot;

    #[test]
    fn a_relaxed_problem_reports_its_relaxation() {
        let robot = Robot::from_file("../robots/pendulum.toml").unwrap();
        let problem = Problem::rest_to_rest(robot, &[0.0], &[1.0], 1.0);
        let unused = |_: &[f64], _: &mut [f64], _: &mut [f64]| {};
        let also = |_: &[f64], _: &mut [f64], _: &mut [f64], _: &mut [f64]| {};
        let mut extremal = GeneratedExtremal::new(&problem, unused, also).unwrap();
        assert_eq!(extremal.relaxation(), Relaxation::NONE);
        let relaxed = Relaxation { goal: 0.5, ..Relaxation::NONE };
        extremal.set_relaxation(relaxed);
        assert_eq!(extremal.relaxation(), relaxed);
    }
}
