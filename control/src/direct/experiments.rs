use super::ends::Ends;
use super::interior::{End, Interior};
use super::limits::{Limited, Side};
use super::points::RobotPoints;
use super::running::Running;
use super::spline::Spline;
use crate::{Bounds, FinalTime, Objective, Problem};
use costate::robot::Robot;

fn guess(problem: &Problem, intervals: usize, time: f64) -> Spline {
    let n = problem.robot.dof();
    let nodes: Vec<f64> = (0..=intervals).map(|k| k as f64 / intervals as f64).collect();
    let mut unknowns = Vec::new();
    for &s in &nodes {
        let d = |i: usize| problem.end.q[i] - problem.start.q[i];
        let (a, b) = (|i: usize| problem.start.v[i] * time, |i: usize| problem.end.v[i] * time);
        let rest = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
        let rest1 = 30.0 * s * s * (1.0 - s) * (1.0 - s);
        let rest2 = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s);
        let _ = (&a, &b);
        (0..n).for_each(|i| unknowns.push(problem.start.q[i] + d(i) * rest));
        (0..n).for_each(|i| unknowns.push(d(i) * rest1));
        (0..n).for_each(|i| unknowns.push(d(i) * rest2));
    }
    Spline { dof: n, nodes, unknowns, time }
}

fn run(name: &str, problem: &Problem, sides: Vec<Side>, intervals: &[usize]) {
    let started = std::time::Instant::now();
    let spline = guess(problem, intervals[0], problem.time.value());
    let mut interior =
        Interior::new(spline, sides, Running::new(problem), Ends::new(problem), RobotPoints::new(&problem.robot));
    let tolerance: f64 = std::env::var("TOL").map_or(1e-7, |t| t.parse().unwrap());
    interior.start(None).unwrap();
    let mut resolution = super::refine::Resolution::default();
    for level in 0..12 {
        let before = interior.figures;
        let end: End = interior.iterate(0.1 * tolerance, 200, |_, _| None).unwrap();
        resolution.measure(&mut interior).unwrap();
        let f = interior.figures;
        println!(
            "{name} {level} N {} {end:?} J {:.10} T {:.8} gap {:.1e} viol {:.1e} it {} err {:.1e} between {:.1e} {:?}",
            interior.spline.intervals(), f.cost, interior.spline.time, f.gap, f.violation,
            f.iterations - before.iterations,
            resolution.error() / f.cost, resolution.violation(), started.elapsed()
        );
        if resolution.error() < tolerance * f.cost && resolution.violation() < 1e-4 {
            break;
        }
        let nodes = resolution.nodes(&interior.spline, tolerance * f.cost);
        interior.move_to(nodes).unwrap();
    }
}

fn robot(name: &str) -> Robot {
    Robot::from_file(format!("../robots/{name}")).unwrap()
}

fn symmetric(limited: Limited, bounds: &[f64]) -> Vec<Side> {
    bounds.iter().enumerate().flat_map(|(i, &b)| Side::pair(limited, i, -b, b)).collect()
}

#[test]
#[ignore]
fn values() {
    let two = Problem::rest_to_rest(robot("two_link.toml"), &[0.0, 0.0], &[1.0, 0.5], 1.0);
    let _ = two;
    let text = std::fs::read_to_string("../examples/problems/two_link.toml").unwrap();
    println!("{text}");
    let file = |name: &str| {
        crate::ProblemFile::read(format!("../examples/problems/{name}"), Default::default()).unwrap().problem
    };
    let meshes = &[5, 10, 20, 40];
    let two = file("two_link.toml");
    run("two_link 145.13113754", &two, vec![], meshes);
    run("two_link v 155.74483972", &two, symmetric(Limited::Rate, &[f64::INFINITY, 7.0]), meshes);
    run("pendulum 74.0616592207?", &file("pendulum_swing_up.toml"), vec![], meshes);
    run("puma", &file("puma560_pick_and_place.toml"), vec![], meshes);
    run("ur5", &file("ur5_reach.toml"), vec![], meshes);
    let bounded = |name: &str| {
        let problem = file(name);
        let bounds = problem.bounds.clone().unwrap();
        let sides: Vec<Side> = (0..problem.robot.dof())
            .flat_map(|i| {
                let g = problem.gain[i];
                Side::pair(Limited::Torque, i, (bounds.u_min[i] * g).min(bounds.u_max[i] * g), (bounds.u_max[i] * g).max(bounds.u_min[i] * g))
            })
            .collect();
        (problem, sides)
    };
    for name in ["two_link_bounded.toml", "two_link_least_time.toml", "manutec_r3_least_energy.toml", "manutec_r3_least_time.toml", "puma560_least_time.toml"] {
        let (problem, sides) = bounded(name);
        run(name, &problem, sides.clone(), meshes);
        if name == "two_link_least_time.toml" {
            let mut sides = sides;
            sides.extend(symmetric(Limited::Rate, &[0.35, 1.0]));
            run("D 3.2300988", &problem, sides, meshes);
        } else if name == "manutec_r3_least_time.toml" {
            let mut sides = sides;
            sides.extend(symmetric(Limited::Rate, &[3.0, 1.5, 5.2]));
            run("E .49518904", &problem, sides, meshes);
        }
    }
    let (_, _, _, _) = (Bounds::symmetric(vec![1.0]), FinalTime::Fixed(1.0), Objective::new(0.0, vec![1.0]), 0);
}
