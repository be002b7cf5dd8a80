//! Solves extremals from a guess of z, and problems of any model.

use crate::extremal::Extremal;
use crate::extremal::dynamics::DynamicsExtremal;
use crate::options::SolverOptions;
use crate::problem::FinalTime;
use crate::result::motion::ExtremalSolution;
use crate::search::Search;
use crate::search::guess::Plain;
use crate::solve::Recorder;
use crate::solve::recorder::Stop;
use costate::dynamics::{Cost, Dynamics};

/// Solves an extremal from a guess of z at t/T in [0, 1].
///
/// With a free final time, the problem is solved for the fixed time of the guess first: at zero costates H* =
/// 0 does not determine T.
///
/// ```
/// use costate_control::{SolverOptions, FinalTime, solve_extremal};
/// # use costate_control::{BoundaryValueProblem, BoundedControls, ControlLaw, HamiltonianTerms, Homotopy};
/// # use costate::EvalError;
/// # struct Line;
/// # impl BoundaryValueProblem for Line {
/// #     fn states(&self) -> usize { 1 }
/// #     fn evaluate(
/// #         &mut self, z: &[f64], _: ControlLaw<'_>, g: &mut [f64],
/// #     ) -> Result<HamiltonianTerms, EvalError> {
/// #         g.copy_from_slice(&[z[1], 0.0]);
/// #         let cost = 0.5 * z[1] * z[1];
/// #         Ok(HamiltonianTerms { hamiltonian: z[1] * z[1] - cost, cost, ..HamiltonianTerms::default() })
/// #     }
/// #     fn linearise(
/// #         &mut self, z: &[f64], law: ControlLaw<'_>, g: &mut [f64], j: &mut [f64],
/// #     ) -> Result<HamiltonianTerms, EvalError> {
/// #         j.copy_from_slice(&[0.0, 1.0, 0.0, 0.0]);
/// #         self.evaluate(z, law, g)
/// #     }
/// #     fn start(&mut self, z: &[f64], r: &mut [f64], j: &mut [f64]) -> Result<(), EvalError> {
/// #         r[0] = z[0];
/// #         j.copy_from_slice(&[1.0, 0.0]);
/// #         Ok(())
/// #     }
/// #     fn end(&mut self, z: &[f64], r: &mut [f64], j: &mut [f64]) -> Result<(), EvalError> {
/// #         r[0] = z[0] - 1.0;
/// #         j.copy_from_slice(&[1.0, 0.0]);
/// #         Ok(())
/// #     }
/// # }
/// # impl BoundedControls for Line {}
/// # impl Homotopy for Line {}
/// // `Line`: dx/dt = u from 0 to 1, l = u^2/2.
/// let options = SolverOptions::default();
/// let motion = solve_extremal(&mut Line, FinalTime::Fixed(2.0), &options, |s, z| z[0] = s).motion;
/// assert!(motion.status.is_converged() && (motion.cost - 0.25).abs() < 1e-12);
/// ```
pub fn solve_extremal<E: Extremal>(
    extremal: &mut E,
    time: FinalTime,
    options: &SolverOptions,
    guess: impl FnMut(f64, &mut [f64]),
) -> ExtremalSolution {
    let mut recorder = Recorder::new(None, Stop::new(None, options.time_limit));
    let search = Search { extremal, time, guess: &mut Plain(guess), recorder: &mut recorder };
    let found = search.run(options);
    found.into_solution(extremal, &mut recorder, options)
}

/// Solves the problem of `extremal` from a straight line between its ends. Another first guess can be given
/// to [`solve_extremal`].
pub fn solve_dynamics<D: Dynamics<f64>, C: Cost<f64>>(
    extremal: &mut DynamicsExtremal<D, C>,
    options: &SolverOptions,
) -> ExtremalSolution {
    let time = extremal.problem().time;
    let nodes = options.nodes.max(2);
    let mut line = vec![vec![0.0; 2 * extremal.problem().start.x.len()]; nodes];
    for (i, z) in line.iter_mut().enumerate() {
        extremal.straight_line(i as f64 / (nodes - 1) as f64, z);
    }
    solve_extremal(extremal, time, options, |s, z| {
        let place = s.clamp(0.0, 1.0) * (nodes - 1) as f64;
        let i = (place as usize).min(nodes - 2);
        for ((z, from), to) in z.iter_mut().zip(&line[i]).zip(&line[i + 1]) {
            *z = from + (place - i as f64) * (to - from);
        }
    })
}
