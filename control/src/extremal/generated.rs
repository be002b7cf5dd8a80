//! Extremals whose equations are computed by generated code.

use crate::extremal::hamiltonian::equations::Running;
use crate::extremal::hamiltonian::{RobotExtremal, with_hamiltonian};
use crate::extremal::{Ease, Extremal, Law, Rate, Side};
use crate::options::Jacobian;
use crate::problem::Problem;
use crate::problem::error::SourceError;
use costate::EvalError;

/// The extremals of a [`Problem`] with z' and its Jacobian from functions, such as the source that
/// [`pontryagin_program`](crate::pontryagin_program) gives, compiled.
///
/// The functions stand in place of the library's own equations wherever these are asked for the maximum of the Hamiltonian
/// of the problem itself. On arcs along bounds, for easier problems on the way (weaker penalties, wider bounds), and where a result is
/// not finite, the library computes. Ends, controls and bounds are those of [`RobotExtremal`].
///
/// ```
/// use costate_control::{GeneratedExtremal, Options, Problem, ProgramOf, Time, pontryagin_program, solve_extremal};
/// use costate::robot::Robot;
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/pendulum.toml")?;
/// let problem = Problem::rest_to_rest(robot, &[0.0], &[1.0], 1.0);
/// let [rate, linear] = [ProgramOf::Rate, ProgramOf::Jacobian].map(|of| pontryagin_program(&problem, of));
/// let ((rate, linear), mut work) = ((rate?, linear?), Vec::new());
/// // Here the programs are interpreted; compiled source takes their place.
/// let run = |program: &costate::codegen::Program, z: &[f64], results: &mut [&mut [f64]], work: &mut Vec<f64>| {
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
/// let motion = solve_extremal(&mut extremal, Time::Fixed(1.0), &Options::default(), |s, z| z[0] = s).motion;
/// assert!(motion.status.is_converged());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct GeneratedExtremal<R, L> {
    library: RobotExtremal,
    rate: R,
    linear: L,
    /// Whether the problem is itself.
    itself: bool,
}

impl<R, L> GeneratedExtremal<R, L>
where
    R: FnMut(&[f64], &mut [f64], &mut [f64]),
    L: FnMut(&[f64], &mut [f64], &mut [f64], &mut [f64]),
{
    /// `rate` writes z_t (4n) and l (2) for a z (4n), `linear` z_t, l and z_t_z (4n x 4n, row by row).
    ///
    /// # Errors
    /// A problem that [cannot be posed](Problem::check), or a mass matrix that is singular at the start or the end.
    pub fn new(problem: &Problem, rate: R, linear: L) -> Result<Self, SourceError> {
        problem.check()?;
        let library = RobotExtremal::new(problem, Jacobian::Exact)?;
        Ok(Self { library, rate, linear, itself: true })
    }

    fn is_generated(&self, law: Law<'_>) -> bool {
        self.itself && law == Law::Maximal
    }
}

impl<R, L> Extremal for GeneratedExtremal<R, L>
where
    R: FnMut(&[f64], &mut [f64], &mut [f64]),
    L: FnMut(&[f64], &mut [f64], &mut [f64], &mut [f64]),
{
    fn rate(&mut self, z: &[f64], law: Law<'_>, g: &mut [f64]) -> Result<Rate, EvalError> {
        if self.is_generated(law) {
            let mut l = [0.0; 2];
            (self.rate)(z, g, &mut l);
            if all_finite(g) && all_finite(&l) {
                return Ok(with_hamiltonian(z, g, Running { cost: l[0], penalty: l[1], smoothing: 0.0 }));
            }
        }
        self.library.rate(z, law, g)
    }

    fn linear(
        &mut self,
        z: &[f64],
        law: Law<'_>,
        g: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<Rate, EvalError> {
        if self.is_generated(law) {
            let mut l = [0.0; 2];
            (self.linear)(z, g, &mut l, jacobian);
            if all_finite(g) && all_finite(&l) && all_finite(jacobian) {
                return Ok(with_hamiltonian(z, g, Running { cost: l[0], penalty: l[1], smoothing: 0.0 }));
            }
        }
        self.library.linear(z, law, g, jacobian)
    }

    fn ease(&self) -> Ease {
        self.library.ease()
    }

    fn set_ease(&mut self, ease: Ease) {
        self.itself = Ease { goal: 1.0, ..ease } == Ease::NONE;
        self.library.set_ease(ease);
    }

    fn states(&self) -> usize {
        self.library.states()
    }

    fn controls(&self) -> usize {
        self.library.controls()
    }

    fn start(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        self.library.start(z, residual, jacobian)
    }

    fn end(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        self.library.end(z, residual, jacobian)
    }

    fn time_cost(&self) -> f64 {
        self.library.time_cost()
    }

    fn ends_are_fixed(&self) -> bool {
        self.library.ends_are_fixed()
    }

    fn easiest(&self) -> Ease {
        self.library.easiest()
    }

    fn stretch(&self, z: &mut [f64], factor: f64) {
        self.library.stretch(z, factor);
    }

    fn group(&self, component: usize) -> usize {
        self.library.group(component)
    }

    fn unbounded_controls(&mut self, z: &[f64], u: &mut [f64]) {
        self.library.unbounded_controls(z, u);
    }

    fn bounds(&self, control: usize) -> (f64, f64) {
        self.library.bounds(control)
    }

    fn switching(&mut self, control: usize, sides: (Side, Side), z: &[f64], gradient: &mut [f64]) -> f64 {
        self.library.switching(control, sides, z, gradient)
    }

    fn controls_at(&mut self, z: &[f64], law: Law<'_>, u: &mut [f64]) {
        self.library.controls_at(z, law, u);
    }

    fn state_rate(&mut self, x: &[f64], u: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        self.library.state_rate(x, u, f)
    }
}

fn all_finite(values: &[f64]) -> bool {
    values.iter().all(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use costate::robot::Robot;

    #[test]
    fn an_eased_problem_says_that_it_is() {
        let robot = Robot::from_file("../robots/pendulum.toml").unwrap();
        let problem = Problem::rest_to_rest(robot, &[0.0], &[1.0], 1.0);
        let unused = |_: &[f64], _: &mut [f64], _: &mut [f64]| {};
        let also = |_: &[f64], _: &mut [f64], _: &mut [f64], _: &mut [f64]| {};
        let mut extremal = GeneratedExtremal::new(&problem, unused, also).unwrap();
        assert_eq!(extremal.ease(), Ease::NONE);
        let eased = Ease { goal: 0.5, ..Ease::NONE };
        extremal.set_ease(eased);
        assert_eq!(extremal.ease(), eased);
    }
}
