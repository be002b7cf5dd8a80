//! The program of the guide's tour in Rust, `docs/guide/rust.md`.
//!
//! `cargo run --release -p costate-examples --example tour`

use costate::batch::{Batch, FirstOrderArrays, Model, Native};
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::lagrangian::LagrangianSecondOrder;
use costate::robot::Robot;
use costate::step::{RungeKutta4, Step};
use costate_control::{Budget, MotionLimits, Problem, Resolve, Solver, SolverOptions};
use costate_report::{ReportOptions, figures_as_svg, report};
use std::error::Error;
use std::fs;
use std::path::Path;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

fn main() -> Result<(), Box<dyn Error>> {
    std::env::set_current_dir(ROOT)?;
    dynamics()?;
    batch()?;
    step()?;
    motion()?;
    again()
}

fn dynamics() -> Result<(), Box<dyn Error>> {
    let robot = Robot::from_file("robots/ur5.urdf")?;
    let mut hamiltonian = HamiltonianSecondOrder::<f64>::new(&robot); // owns all buffers

    let (q, v, u) = ([0.3; 6], [0.1; 6], [0.0; 6]);
    let p = hamiltonian.first().momentum(&q, &v)?.to_vec(); // p = M v
    let y = [1.0; 12];
    let all = hamiltonian.contract(&q, &p, &u, &y)?; // F, F_x and y'F_xx from one sweep
    println!("F = {:?}", all.linearisation().f());
    println!("y'F_xx = {:.3}", all.matrix().as_nalgebra());
    Ok(())
}

fn batch() -> Result<(), Box<dyn Error>> {
    let robot = Robot::from_file("robots/ur5.urdf")?;
    let mut batch = Batch::<Native, _>::new(Model(LagrangianSecondOrder::new(&robot)));
    let nodes = 1000;
    let (x, u) = (vec![0.2; nodes * 12], vec![0.0; nodes * 6]);
    let (mut f, mut f_x) = (vec![0.0; nodes * 12], vec![0.0; nodes * 144]);
    let into = FirstOrderArrays { f: &mut f, f_x: &mut f_x, ..Default::default() };
    assert!(batch.linearise(&x, &u, into)?.is_empty()); // the states that failed
    Ok(())
}

fn step() -> Result<(), Box<dyn Error>> {
    let robot = Robot::from_file("robots/ur5.urdf")?;
    let mut step = RungeKutta4::new(LagrangianSecondOrder::<f64>::new(&robot));
    let next = step.linearise(&[0.2; 12], &[0.0; 6], 0.01)?; // x, u, h
    println!("x+ = {:?}, Phi_x = {:.3}", next.next, next.phi_x.as_nalgebra());
    Ok(())
}

fn motion() -> Result<(), Box<dyn Error>> {
    let robot = Robot::from_file("robots/ur5.urdf")?;
    let (from, to) = ([0.0, -1.6, 1.8, -1.8, -1.57, 0.0], [0.5, -1.4, 1.6, -1.6, -1.5, 0.2]);
    let problem = Problem::rest_to_rest(robot, &from, &to, 1.0)
        .with_limits(MotionLimits::default().with_from_robot(true));
    let solution = Solver::new(&problem, SolverOptions::default())?.solve();
    assert!(solution.motion.status.is_converged());
    println!("cost {}, end defect {:.1e}", solution.motion.cost, solution.end_defect);

    let halfway = solution.trajectory.at(0.5).ok_or("outside of the motion")?;
    println!("q = {:?}, torques = {:?}", halfway.q, halfway.u);

    let folder = Path::new("target/tour");
    fs::create_dir_all(folder)?;
    fs::write(folder.join("motion.html"), report(&problem, &solution, &ReportOptions::default()))?;
    for (name, figure) in figures_as_svg(&problem, &solution) {
        fs::write(folder.join(name), figure)?; // strobe_xz.svg, controls.svg and others
    }
    Ok(())
}

fn again() -> Result<(), Box<dyn Error>> {
    let robot = Robot::from_file("robots/two_link.toml")?;
    let problem = Problem::rest_to_rest(robot, &[0.0, 0.0], &[1.5, 1.5], 1.0)
        .with_limits(MotionLimits::default().with_from_robot(false));
    let mut motion = Resolve::new(&problem, SolverOptions::default().with_nodes(61))?;
    motion.solve()?;
    let mut torques = [0.0; 2];
    for period in 1..=10 {
        motion.set_end(&[1.5 - 0.02 * f64::from(period), 1.5], &[0.0, 0.0])?;
        let found = motion.solve_again(Budget::steps(3))?; // at most three Newton steps
        assert!(found.keeps_limits());
        motion.torques_at(0.0, &mut torques)?;
    }
    println!("torques = {torques:?}");
    Ok(())
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_tour_runs() {
        assert_eq!(super::main().map_err(|error| error.to_string()), Ok(()));
    }
}
