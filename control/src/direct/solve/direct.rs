//! From a problem to a motion: starts, meshes, verification.

use super::restore::{Patience, Restored, restore};
use crate::constants::direct as constants;
use crate::cubics::Disturbance;
use crate::direct::interior::iterate::{End, Interior};
use crate::direct::limits::ends::Ends;
use crate::direct::limits::power::Powers;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::limits::tasks::Tasks;
use crate::direct::motion::guess::{guess, with_tools_reached};
use crate::direct::motion::mesh::Mesh;
use crate::direct::motion::shape::Shape;
use crate::direct::outcome::found::trajectory;
use crate::direct::outcome::infeasible::with_proof;
use crate::direct::outcome::report::report;
use crate::direct::outcome::verify::{Again, integrate_again};
use crate::direct::points::phases::PhaseDynamics;
#[cfg(feature = "jit")]
pub(super) use crate::direct::points::program_points::ProgramPoints as FastPoints;
use crate::direct::points::running::Running;
#[cfg(not(feature = "jit"))]
pub(super) use crate::direct::points::values::RobotPoints as FastPoints;
use crate::direct::refine::resolution::Resolution;
use crate::options::{SolverOptions, Verify};
use crate::parallel::best_of_starts;
use crate::problem::check::CheckedProblem;
use crate::problem::limits::JointLimits;
use crate::problem::{FinalTime, Problem};
use crate::progress::{Iteration, Phase};
use crate::result::infeasibility::Infeasibility;
use crate::result::motion::Motion;
use crate::result::solution::{RobotNames, Solution};
use crate::result::stage_times::{Clock, Stage};
use crate::result::trajectory::Trajectory;
use crate::solve::Recorder;
use crate::solve::recorder::Interruption;
use crate::status::Status;
use crate::task::build::TaskRows;
use costate::EvalError;
use costate::robot::Robot;

/// Inverse dynamics of the robots of all phases.
pub(crate) type Dynamics = PhaseDynamics<FastPoints>;

/// A problem that the direct method solves from one or several guesses.
pub(crate) struct Direct<'a> {
    pub problem: CheckedProblem<'a>,
    /// The functions of its task.
    pub rows: &'a TaskRows,
    pub options: &'a SolverOptions,
    /// Where the first start begins.
    pub saved: Option<&'a Trajectory>,
}

impl Direct<'_> {
    /// The best solution of all starts: the cheapest solved one if there is any.
    pub fn solve(&self, recorder: &mut Recorder<'_>) -> Solution {
        let missing = |status| Solution::missing(&self.problem.robot, status, self.problem.time.value());
        let solve = |number, recorder: &mut Recorder<'_>| {
            let failed = |error: EvalError| missing(Status::EvaluationFailed(error.into()));
            self.start(number, recorder).unwrap_or_else(failed)
        };
        best_of_starts(self.options, recorder, solve).unwrap_or_else(|| missing(Status::Cancelled))
    }

    /// One start.
    pub fn start(&self, number: usize, recorder: &mut Recorder<'_>) -> Result<Solution, EvalError> {
        let problem = self.problem.problem();
        let saved = self.saved.filter(|_| number == 0);
        let clock = Clock::new(recorder.takes_times);
        let mut interior = interior(problem, self.rows, self.options, number, saved);
        interior.clock = clock;
        let mut resolution = Resolution::default();
        let refined = self.refine(&mut interior, &mut resolution, recorder)?;
        self.finish(&mut interior, &resolution, refined, recorder)
    }

    /// Solves on finer and finer meshes.
    fn refine(
        &self,
        interior: &mut Interior<Dynamics>,
        resolution: &mut Resolution,
        recorder: &mut Recorder<'_>,
    ) -> Result<Refined, EvalError> {
        let tolerance = self.options.tolerance;
        let problem = self.problem.problem();
        let too_short = problem.too_short().is_some();
        let goes_on = recorder.interruption().is_none();
        interior.clock.lap(Stage::Preparation);
        if goes_on && !too_short && interior.needs_smoothing() && self.saved.is_none() {
            let effort = interior.smooth_effort();
            let mut watch = |iterate: &mut Interior<Dynamics>, step: f64| {
                recorder.record(iteration(iterate, 0, step));
                recorder.interruption()
            };
            interior.begin_smoothed(effort, self.options.max_iterations, &mut watch)?;
        } else {
            interior.start(None)?;
        }
        if goes_on && too_short {
            return self.explain(interior, resolution, recorder);
        }
        if let Some(interruption) = recorder.interruption() {
            interior.refresh()?;
            resolution.measure(interior)?;
            return Ok(Refined::without(interruption.into()));
        }
        let mut refined = Refined::without(Status::MeshLimit);
        let (mut guess, mut gap, mut restorations) = (interior.spline.clone(), constants::FIRST_GAP, 0);
        // A coarse mesh is not solved much better than it resolves the motion.
        let least = constants::PART_OF_TOLERANCE * tolerance;
        let mut precision = least.max(constants::FIRST_PRECISION);
        let (mut mesh, mut moved) = (0, 0);
        // Limits neither give nor move where accelerations are continuous.
        let smooth = interior.spline.mesh.shape.is_smooth();
        interior.clock.lap(Stage::Preparation);
        while mesh < constants::MESHES {
            let first = interior.figures.iterations;
            let mut resolved = interior.spline.clone();
            let (mut patience, mut stuck, mut unresolved) = (Patience::default(), false, false);
            let watch = |iterate: &mut Interior<Dynamics>, step: f64| {
                recorder.record(iteration(iterate, first, step));
                stuck = patience.is_over(iterate.figures.violation);
                let looks = (iterate.figures.iterations - first).is_multiple_of(constants::LOOK);
                unresolved = looks && resolution.is_far_off(iterate);
                if looks && !unresolved {
                    resolved.clone_from(&iterate.spline);
                }
                if stuck || unresolved { Some(Interruption::TimeLimit) } else { recorder.interruption() }
            };
            let mut end = interior.iterate(precision, self.options.max_iterations, watch)?;
            if end == End::Solved && precision <= least {
                interior.take_last_step();
            }
            if stuck || unresolved {
                end = recorder.interruption().map_or(End::NoProgress, End::Interrupted);
            }
            let mut figures = interior.figures;
            let is_over = matches!(end, End::NoProgress | End::IterationLimit);
            if is_over
                && figures.violation > constants::VIOLATION_ACCEPTED
                && restorations < constants::RESTORATIONS
                && !unresolved
                && !smooth
            {
                restorations += 1;
                match restore(problem, interior, &guess, gap, self.options, recorder)? {
                    Restored::Kept => continue,
                    Restored::Infeasible(infeasible) => {
                        resolution.measure(interior)?;
                        let infeasible = Some(infeasible);
                        return Ok(Refined { infeasible, ..Refined::without(Status::Infeasible) });
                    }
                    Restored::Interrupted(interruption) => end = End::Interrupted(interruption),
                    Restored::Unknown => {}
                }
                figures = interior.figures;
            }
            resolution.measure(interior)?;
            interior.clock.lap(Stage::Meshes);
            let error = (resolution.error() + figures.gap) / figures.size;
            let violated = figures.violation > constants::VIOLATION_ACCEPTED;
            let accurate = error <= tolerance && resolution.violation() <= constants::VIOLATION_BETWEEN;
            let mut again = None;
            let status = match end {
                End::Interrupted(interruption) => {
                    return Ok(Refined { error, ..Refined::without(interruption.into()) });
                }
                _ if unresolved => Status::MeshLimit,
                End::NoProgress | End::IterationLimit if violated => Status::LimitsNotKept,
                End::NoProgress => Status::NewtonFailed,
                End::IterationLimit => Status::IterationLimit,
                End::Solved if accurate && precision <= least => {
                    let found =
                        again.insert(integrate_again(problem, self.options.verify, interior, resolution));
                    interior.clock.lap(Stage::Verification);
                    let bound = constants::VERIFIED * tolerance.sqrt();
                    if found.relative <= bound { Status::Converged } else { Status::NotVerified }
                }
                End::Solved => Status::MeshLimit,
            };
            refined = Refined { status, error, again, infeasible: None };
            let unverified = accurate && precision <= least && self.options.verify == Verify::None;
            if refined.status.is_converged()
                || unverified
                || (violated && !unresolved && mesh >= constants::MESHES_WITHOUT_MOTION)
            {
                break;
            }
            if accurate && precision > least {
                precision = least;
                continue;
            }
            let between = constants::VIOLATION_BETWEEN..constants::MOST_MOVED;
            let only_between = error <= tolerance && between.contains(&resolution.violation()) && !smooth;
            if only_between && end == End::Solved && moved < constants::MOVES {
                moved += 1;
                precision = least;
                if resolution.move_limits_inside(interior) {
                    interior.begin_again();
                    continue;
                }
            }
            moved = 0;
            precision = (constants::PRECISION * error).clamp(least, constants::FIRST_PRECISION.max(least));
            let enough = tolerance * figures.size;
            let narrowest = resolution.narrowest;
            let nodes = match (violated, accurate) {
                (true, _) if !unresolved => interior.spline.mesh.halved(narrowest),
                // What the estimate does not see, the integration may.
                (false, true) => resolution.nodes_for_torques(&interior.spline, enough),
                _ => resolution.nodes(&interior.spline, enough),
            };
            let mesh_nodes = &interior.spline.mesh.nodes;
            let nodes = if nodes == *mesh_nodes { interior.spline.mesh.halved(narrowest) } else { nodes };
            let stride = interior.spline.mesh.shape.stride();
            if stride * (nodes.len() - 1) + 1 > self.options.max_nodes || mesh + 1 == constants::MESHES {
                if unresolved {
                    interior.spline = resolved;
                    interior.start(Some(interior.mu))?;
                    resolution.measure(interior)?;
                }
                break;
            }
            if unresolved {
                interior.spline = resolved;
            }
            interior.move_to(nodes)?;
            interior.clock.lap(Stage::Meshes);
            // What solves a mesh is near a solution on the next one.
            if end == End::Solved {
                (guess, gap) = (interior.spline.clone(), constants::WARM);
            }
            mesh += 1;
        }
        Ok(refined)
    }

    /// What limits would have to give where it is proven that no motion keeps them.
    fn explain(
        &self,
        interior: &mut Interior<Dynamics>,
        resolution: &mut Resolution,
        recorder: &mut Recorder<'_>,
    ) -> Result<Refined, EvalError> {
        let (problem, guess) = (self.problem.problem(), interior.spline.clone());
        let gap = constants::FIRST_GAP;
        let restored = restore(problem, interior, &guess, gap, self.options, recorder)?;
        interior.refresh()?;
        resolution.measure(interior)?;
        let found = match restored {
            Restored::Interrupted(interruption) => return Ok(Refined::without(interruption.into())),
            Restored::Infeasible(infeasible) => Some(infeasible),
            // Between its points the motion that keeps its limits there does not.
            Restored::Kept | Restored::Unknown => None,
        };
        let infeasible = with_proof(problem, found);
        Ok(Refined { infeasible, ..Refined::without(Status::Infeasible) })
    }

    /// The solution, verified by integration where it converged.
    fn finish(
        &self,
        interior: &mut Interior<Dynamics>,
        resolution: &Resolution,
        Refined { status, error, again, infeasible }: Refined,
        recorder: &mut Recorder<'_>,
    ) -> Result<Solution, EvalError> {
        let problem = self.problem.problem();
        interior.clock.lap(Stage::Meshes);
        let trajectory = trajectory(problem, interior)?;
        // What exceeds its limits leads nowhere.
        let exceeds = matches!(status, Status::LimitsNotKept | Status::Infeasible);
        let again = again.unwrap_or_else(|| match status.is_interruption() || exceeds {
            true => Again::unknown(f64::INFINITY),
            false => integrate_again(problem, self.options.verify, interior, resolution),
        });
        // Without what the clock adds to it H* is constant.
        let ahead = interior.clock_ahead(&trajectory.t);
        let values: Vec<f64> =
            trajectory.hamiltonian.iter().zip(&ahead).map(|(h, ahead)| h - ahead).collect();
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let of_phases: Vec<&[f64]> = trajectory.phases().map(|rows| &values[rows]).collect();
        let far_from = |mean: f64| move |value: &f64| (value - mean).abs();
        let far = of_phases.iter().flat_map(|values| values.iter().map(far_from(mean(values))));
        let far = far.fold(0.0, f64::max);
        let size = values.iter().map(|value| value.abs()).fold(interior.running.time, f64::max);
        let iterations = std::mem::take(&mut recorder.iterations);
        let penalty_cost = interior.running.penalty_cost(&interior.spline, &interior.points);
        let motion = Motion {
            cost: resolution.cost - penalty_cost,
            penalty_cost,
            hamiltonian: mean(&values),
            phase_hamiltonians: of_phases.iter().map(|values| mean(values)).collect(),
            hamiltonian_drift: if size > 0.0 { far / size } else { 0.0 },
            end_state: again.state,
            verification: match status {
                Status::Converged | Status::NotVerified => self.options.verify,
                _ => Verify::None,
            },
            errors: vec![error],
            iterations,
            ..Motion::missing(status, interior.spline.duration())
        };
        let limits = report(problem, interior, resolution, infeasible);
        interior.clock.lap(Stage::Verification);
        Ok(Solution {
            newton_iterations: interior.figures.iterations,
            end_defect: again.defect,
            limits,
            polish: None,
            stage_times: interior.clock.times(),
            trajectory,
            starts: Vec::new(),
            options: self.options.clone(),
            robot: RobotNames::of(&problem.robot),
            motion,
        })
    }
}

/// A problem with the guess of a start.
pub(crate) fn interior(
    problem: &Problem,
    rows: &TaskRows,
    options: &SolverOptions,
    number: usize,
    saved: Option<&Trajectory>,
) -> Interior<Dynamics> {
    let (all, phases) = ((options.nodes - 1) / Shape::of(problem).stride(), problem.phases());
    let intervals = (all / phases).max(if phases > 1 { constants::INTERVALS_OF_PHASE } else { 1 });
    interior_on(problem, rows, options, number, saved, &Mesh::even(phases, intervals))
}

/// The same on these nodes.
pub(crate) fn interior_on(
    problem: &Problem,
    rows: &TaskRows,
    options: &SolverOptions,
    number: usize,
    saved: Option<&Trajectory>,
    nodes: &[f64],
) -> Interior<Dynamics> {
    let reached = with_tools_reached(problem, rows, number);
    let disturbance = Disturbance::draw(&reached, options.seed, number);
    let spline = guess(&reached, saved, &disturbance, nodes.to_vec());
    let model = |robot: &Robot| {
        #[cfg(feature = "jit")]
        let model = FastPoints::new(robot, options.machine_code);
        #[cfg(not(feature = "jit"))]
        let model = FastPoints::new(robot);
        model
    };
    let dynamics = PhaseDynamics::new(&problem.robots(), model);
    let (running, ends) = (Running::new(problem, rows), Ends::new(problem));
    let powers = Powers::new(problem);
    let tasks = Tasks::new(rows, problem.robot.dof(), powers.rows());
    let mut interior = Interior::new(spline, sides(problem), tasks, powers, running, ends, dynamics);
    let can_choose =
        matches!(problem.time, FinalTime::Free { .. }) && problem.vias.iter().all(|via| via.time.is_none());
    if saved.is_none() && can_choose {
        interior.choose_time(|time| {
            let problem = reached.clone().into_owned().with_time(FinalTime::Free { guess: time });
            guess(&problem, None, &disturbance, nodes.to_vec())
        });
    }
    interior
}

/// A step for the log; `first` steps were made on other meshes.
fn iteration(iterate: &Interior<Dynamics>, first: usize, step: f64) -> Iteration {
    let figures = &iterate.figures;
    Iteration {
        phase: Phase::Direct,
        nodes: iterate.spline.mesh.points(),
        number: figures.iterations - first,
        residual: (figures.gap.max(figures.decrement.abs()) / figures.size).max(figures.violation),
        step,
        final_time: iterate.spline.duration(),
        cost: figures.cost,
    }
}

/// How the refinement ended.
struct Refined {
    status: Status,
    /// Estimated error of the cost, relative to it.
    error: f64,
    /// The motion integrated again, if that was done on its last mesh.
    again: Option<Again>,
    /// Why there is no motion that keeps all limits.
    infeasible: Option<Infeasibility>,
}

impl Refined {
    /// Without a motion that was solved.
    fn without(status: Status) -> Self {
        Self { status, error: f64::INFINITY, again: None, infeasible: None }
    }
}

/// All limits of the joints of a problem.
fn sides(problem: &Problem) -> Vec<Side> {
    let limits = problem.joint_limits();
    let of = |limited: Limited, range: fn(&JointLimits) -> [f64; 2]| {
        let each = limits.iter().enumerate();
        each.flat_map(move |(i, limits)| {
            let [lower, upper] = range(limits);
            Side::pair(limited, i, lower, upper)
        })
    };
    let torques = limits.iter().map(|limits| limits.torque[1] - limits.torque[0]);
    let largest = torques.filter(|range| range.is_finite()).fold(0.0, f64::max);
    // What the other motors give; without limits of them, 1 N m.
    let unit = if largest > 0.0 { largest } else { 1.0 };
    let has_motor = |limits: &JointLimits| limits.torque[0] < limits.torque[1];
    let torque = of(Limited::Torque, |limits| limits.torque).filter(|side| has_motor(&limits[side.joint]));
    let without = (0..limits.len()).filter(|&j| !has_motor(&limits[j])).map(|j| Side::no_torque(j, unit));
    of(Limited::Position, |limits| limits.q)
        .chain(of(Limited::Rate, |limits| [-limits.v, limits.v]))
        .chain(of(Limited::Acceleration, |limits| [-limits.a, limits.a]))
        .chain(of(Limited::Jerk, |limits| [-limits.jerk, limits.jerk]))
        .chain(of(Limited::TorqueRate, |limits| [-limits.torque_rate, limits.torque_rate]))
        .chain(torque)
        .chain(without)
        .collect()
}
