use costate::robot::LoadOptions;
use costate_control::*;
use std::time::Instant;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let verbose = args.iter().any(|a| a == "-v");
    for name in args[1..].iter().filter(|a| *a != "-v") {
        let file = match ProblemFile::read(name, LoadOptions::default()) {
            Ok(f) => f,
            Err(e) => {
                println!("{name}: {e}");
                continue;
            }
        };
        let mut problem = file.problem;
        if name.contains("examples/problems") && std::env::var("LIMITS").is_err() {
            problem = problem.with_limits(MotionLimits::none());
        }
        let mut options = SolverOptions::direct();
        if let Ok(v) = std::env::var("VMAX") {
            problem.limits.v_max = Some(v.split(',').map(|x| x.parse().unwrap()).collect());
        }
        options.time_limit = Some(std::time::Duration::from_secs(20));
        if std::env::var("LAST").is_ok() {
            options.max_nodes = 4000;
        }
        if let Ok(v) = std::env::var("TOL") {
            options.tolerance = v.parse().unwrap();
        }
        if let Ok(v) = std::env::var("NODES") {
            options.nodes = v.parse().unwrap();
        }
        let solver = Solver::new(&problem, options).unwrap();
        let t = Instant::now();
        let s = solver.solve();
        let dt = t.elapsed().as_secs_f64();
        let mut meshes = vec![];
        let mut last = 0;
        for it in &s.motion.iterations {
            if it.nodes != last {
                meshes.push((it.nodes, 0));
                last = it.nodes;
            }
            meshes.last_mut().unwrap().1 += 1;
            if verbose {
                println!(
                    "{:4} {:4} res {:9.2e} step {:6.3} T {:.6} cost {:.9}",
                    it.nodes, it.number, it.residual, it.step, it.final_time, it.cost
                );
            }
        }
        println!(
            "{:40} {:?} cost {:.10} {} it {:.2} ms defect {:.1e} err {:?} H {:.1e} meshes {:?}",
            name.rsplit('/').next().unwrap(),
            s.motion.status,
            s.total(),
            s.newton_iterations,
            1e3 * dt,
            s.end_defect,
            s.motion.errors,
            s.motion.hamiltonian_drift,
            meshes
        );
        if verbose {
            for (k, u) in s.limits.kinds() {
                if let Some(u) = u {
                    println!("   {k}: at {:.1e} between {:.1e} worst {:?}", u.at_points, u.between, u.worst);
                }
            }
        }
    }
}
