//! What extremals in action form would gain over collocation.

mod fronts;
mod interval;
mod newton;
mod points;

use crate::clock::cpu_time;
use crate::measure::{measure, median};
use crate::problems::{Failure, between, of_file, panda_with_rotors};
use crate::tables::{duration, markdown};
use costate_control::{
    Method, Polish, Problem, Solution, Solver, SolverOptions, Strategy, Trajectory, Verify,
};
use newton::{Action, Stopped, Unknowns};
use points::places;
use std::ops::ControlFlow;

/// Intervals of the meshes on which costs are compared, and of that of the steps that are timed.
const MESHES: [usize; 16] = [4, 6, 8, 10, 12, 15, 20, 25, 30, 40, 50, 60, 80, 100, 120, 160];
const TIMED: usize = 30;
/// Intervals of the mesh whose cost counts as exact.
const EXACT: usize = 400;
/// The relative error of the cost at which steps are compared.
const ERROR: f64 = 1e-8;
/// Newton's method ends at this relative step, or after so many.
const SMALL: f64 = 1e-9;
const MOST_STEPS: usize = 20;
/// By how much the first guess is off, so that Newton's method takes several steps.
const DISTURBED: f64 = 0.9;

/// Newton's method on one mesh: the cost, and the CPU times of its steps (s).
struct Run {
    cost: f64,
    steps: Vec<f64>,
}

/// Times of steps and of whole polishes of four motions.
pub fn table(short: bool) -> Result<String, Failure> {
    let problems: [(&str, Problem); 4] = [
        ("two-link arm", of_file("two_link.toml")?),
        ("PUMA 560", of_file("puma560_pick_and_place.toml")?),
        (
            "UR5 with rotors",
            between("ur5.urdf", [0.0, -1.6, 1.8, -1.8, -1.57, 0.0], [0.8, -1.2, 1.4, -1.6, -1.2, 0.4])?,
        ),
        ("Panda with rotors", panda_with_rotors()?),
    ];
    let mut columns = Vec::new();
    for (_, problem) in &problems {
        columns.push(of_problem(problem, if short { 3 } else { 30 })?);
    }
    let heads = [
        "joints",
        "collocation: Newton step, of it an interval",
        "intervals for this error",
        "step on them",
        "action form: Newton step, of it an interval",
        "intervals for this error",
        "step on them",
        "local minimum by its pivots",
        "collocation / action form",
        "a polish by collocation",
        "of it Newton's method",
        "of it verification, conjugate times",
        "a polish, were its Newton's method shorter by that ratio",
        "now / then",
    ];
    let row =
        |i: usize| std::iter::once(heads[i].to_owned()).chain(columns.iter().map(move |c| c[i].clone()));
    let rows: Vec<Vec<String>> = (0..heads.len()).map(|i| row(i).collect()).collect();
    let titles: Vec<&str> = std::iter::once("").chain(problems.iter().map(|(name, _)| *name)).collect();
    Ok(markdown(&titles, &rows))
}

fn of_problem(problem: &Problem, repeats: usize) -> Result<Vec<String>, Failure> {
    let direct =
        SolverOptions::default().with_tolerance(1e-4).with_verify(Verify::None).with_polish(Polish::Never);
    let start = Solver::new(problem, direct.clone())?.solve().trajectory;
    let mut minimal = true;
    let mut by_collocation = |n: usize| collocation(problem, &start, n);
    let mut by_action = |n: usize| match action(problem, &start, n) {
        Err(Stopped::NotMinimal) => {
            minimal = false;
            Ok(Run { cost: f64::NAN, steps: Vec::new() })
        }
        Err(Stopped::Dynamics(error)) => Err(Failure::from(error)),
        Ok(run) => Ok(run),
    };
    let exact = by_collocation(EXACT)?.cost;
    let mut figures = Vec::new();
    for of in [&mut by_collocation as &mut dyn FnMut(usize) -> Result<Run, Failure>, &mut by_action] {
        let mut times = Vec::new();
        for _ in 0..repeats {
            times.extend(of(TIMED)?.steps);
        }
        let interval = median(times) / TIMED as f64;
        // The first mesh from which on all are exact enough.
        let mut enough = None;
        for n in MESHES {
            let error = (of(n)?.cost - exact).abs() / exact;
            enough = if error <= ERROR { enough.or(Some(n)) } else { None };
        }
        let enough = enough.ok_or("no mesh is fine enough")?;
        figures.push((interval, enough, enough as f64 * interval));
    }
    let [(interval, enough, step), of_action] = [figures[0], figures[1]];
    let ratio = step / of_action.2;
    let always = SolverOptions::default().with_polish(Polish::Always);
    let without = measure(problem, &direct, repeats)?.solve;
    let whole = measure(problem, &always, repeats)?.solve - without;
    let newton = measure(problem, &always.clone().with_verify(Verify::None), repeats)?.solve - without;
    let then = whole - newton + newton / ratio;
    Ok(vec![
        problem.robot.dof().to_string(),
        duration(interval),
        enough.to_string(),
        duration(step),
        duration(of_action.0),
        of_action.1.to_string(),
        duration(of_action.2),
        if minimal { "yes" } else { "no" }.to_owned(),
        format!("{ratio:.1}"),
        duration(whole),
        duration(newton),
        duration(whole - newton),
        duration(then),
        format!("{:.2}", whole / then),
    ])
}

/// Collocation on n equal intervals.
fn collocation(problem: &Problem, start: &Trajectory, n: usize) -> Result<Run, Failure> {
    let options = SolverOptions::of(Method::Collocation)
        .with_strategy(Strategy::Direct)
        .with_nodes(n + 1)
        .with_max_nodes(n + 1)
        .with_tolerance(SMALL)
        .with_verify(Verify::None);
    let mut start = start.clone();
    let duration = problem.time.value();
    let at = |t: &f64| start.at(*t);
    let t: Vec<f64> = (0..=n).map(|k| duration * k as f64 / n as f64).collect();
    let rows = t.iter().map(at).collect::<Option<Vec<_>>>().ok_or("a time outside of the motion")?;
    let disturbed = |y: &Vec<f64>| y.iter().map(|y| DISTURBED * y).collect::<Vec<f64>>();
    start.q = rows.iter().map(|row| row.q.clone()).collect();
    start.v = rows.iter().map(|row| row.v.clone()).collect();
    // The equations are linear in costates: momenta that are off take more than one step.
    start.p = rows.iter().map(|row| disturbed(&row.p)).collect();
    start.u = rows.iter().map(|row| row.u.clone()).collect();
    start.y_q = rows.iter().map(|row| disturbed(&row.y_q)).collect();
    start.y_p = rows.iter().map(|row| disturbed(&row.y_p)).collect();
    start.y_tau.clear();
    start.hamiltonian.clear();
    start.t = t;
    let (mut steps, mut last) = (Vec::new(), cpu_time());
    let solver = Solver::new(problem, options)?.with_start(&start)?.on_iteration(|iteration| {
        if iteration.number > 1 {
            steps.push(cpu_time() - last);
        }
        last = cpu_time();
        ControlFlow::Continue(())
    });
    let Solution { motion, .. } = solver.solve();
    Ok(Run { cost: motion.cost, steps })
}

/// The action form on n equal intervals. A step computes what one of collocation does: factors, two
/// corrections and the equations at the new motion.
fn action(problem: &Problem, start: &Trajectory, n: usize) -> Result<Run, Stopped> {
    let mut action = at(problem, start, n, DISTURBED);
    let mut steps = Vec::new();
    for _ in 0..MOST_STEPS {
        let began = cpu_time();
        action.linearise()?;
        action.correct();
        let size = action.take();
        action.evaluate().map_err(Stopped::Dynamics)?;
        action.correct();
        steps.push(cpu_time() - began);
        if size < SMALL {
            break;
        }
    }
    Ok(Run { cost: action.cost(), steps })
}

/// The equations on n equal intervals at a motion, its costates times a factor.
fn at(problem: &Problem, motion: &Trajectory, n: usize, factor: f64) -> Action {
    let (dof, duration) = (problem.robot.dof(), problem.time.value());
    let count = (3 * n + 1) * dof;
    let mut at = Unknowns { q: vec![0.0; count], y: vec![0.0; count] };
    let (c, last) = (places(), 3 * n);
    for point in 0..=last {
        let s = (point / 3) as f64 + c[point % 3];
        if let Some(row) = motion.at((s / n as f64).min(1.0) * duration) {
            at.q[point * dof..][..dof].copy_from_slice(&row.q);
            let to = at.y[point * dof..][..dof].iter_mut().zip(&row.y_p);
            to.for_each(|(to, y)| *to = factor * y);
        }
    }
    at.q[..dof].copy_from_slice(&problem.start.q);
    at.q[last * dof..].copy_from_slice(&problem.end.q);
    Action::new(problem, vec![duration / n as f64; n], at)
}

#[cfg(test)]
mod tests {
    use super::newton::Stopped;
    use crate::problems::ROOT;
    use costate::robot::Robot;
    use costate_control::{Certificate, Method, Polish, Problem, Solver, SolverOptions, Strategy};
    use std::f64::consts::PI;

    /// A pendulum swings up in 3 s in many ways.
    #[test]
    fn pivots_and_conjugate_times_agree() {
        let robot = Robot::from_file(format!("{ROOT}/robots/pendulum.toml")).unwrap();
        let problem = Problem::rest_to_rest(robot, &[0.0], &[PI], 3.0);
        let direct = SolverOptions::default().with_polish(Polish::Never).with_tolerance(1e-4);
        let plain = Solver::new(&problem, direct).unwrap().solve().trajectory;
        let mut guess = plain.clone();
        let mut random = fastrand::Rng::with_seed(1);
        let mut found: Vec<(f64, bool)> = Vec::new();
        let options = SolverOptions::of(Method::Collocation).with_strategy(Strategy::Direct);
        for _ in 0..200 {
            let waves: [f64; 3] = std::array::from_fn(|_| 12.0 * (random.f64() - 0.5));
            let factor = 8.0 * (random.f64() - 0.5);
            for (k, &t) in guess.t.iter().enumerate() {
                let s = PI * t / 3.0;
                let bend = waves[0] + waves[1] * (2.0 * s).sin() + waves[2] * (3.0 * s).cos();
                guess.q[k][0] = 0.5 * (PI - PI * s.cos()) + s.sin().powi(2) * bend;
                guess.y_p[k][0] = factor * plain.y_p[k][0];
            }
            let solution =
                Solver::new(&problem, options.clone()).unwrap().with_start(&guess).unwrap().solve();
            let motion = &solution.motion;
            let minimal = match motion.certificate {
                Certificate::LocalMinimum => true,
                Certificate::NotMinimal => false,
                _ => continue,
            };
            if found.iter().any(|(cost, _)| (cost - motion.cost).abs() < 1e-3) {
                continue;
            }
            found.push((motion.cost, minimal));
            let by_pivots = match super::at(&problem, &solution.trajectory, 120, 1.0).linearise() {
                Ok(()) => true,
                Err(Stopped::NotMinimal) => false,
                Err(Stopped::Dynamics(error)) => panic!("{error}"),
            };
            println!("J = {:.3}: {minimal} by conjugate times, {by_pivots} by pivots", motion.cost);
            assert_eq!(by_pivots, minimal, "J = {}", motion.cost);
        }
        let minima = found.iter().filter(|(_, minimal)| *minimal).count();
        assert!(minima >= 2 && found.len() - minima >= 2, "{found:?}");
    }
}
