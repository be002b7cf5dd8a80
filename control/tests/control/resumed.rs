//! Searches that go on from a motion: a saved one, or one that mesh after mesh did not resolve.

use costate::robot::{LoadOptions, Robot};
use costate_control::{
    MotionLimits, Objective, Polish, Problem, ProblemFile, Solution, Solver, SolverOptions, Status,
};

fn solve(problem: &Problem, options: SolverOptions) -> Solution {
    Solver::new(problem, options).unwrap().solve()
}

/// With active limits too a motion that was solved is one on its own mesh, which is not divided again.
#[test]
fn a_motion_is_solved_again_on_its_own_mesh_in_a_few_steps() {
    let mut steps = [0; 2];
    for name in ["two_link_motors", "delta_pick", "ur5_pick_and_place"] {
        let path = format!("../examples/problems/{name}.toml");
        let ProblemFile { problem, options, .. } = ProblemFile::read(path, LoadOptions::default()).unwrap();
        let cold = solve(&problem, options.clone());
        assert_eq!(cold.motion.status, Status::Converged, "{name}");
        let text = serde_json::to_string(&cold).unwrap();
        let saved: Solution = serde_json::from_str(&text).unwrap();
        let solver = Solver::new(&problem, options).unwrap().with_start(&saved.trajectory).unwrap();
        let warm = solver.solve();
        assert_eq!(warm.motion.status, Status::Converged, "{name}");
        assert_eq!(warm.nodes(), cold.nodes(), "{name}");
        steps = [steps[0] + cold.newton_iterations, steps[1] + warm.newton_iterations];
        assert!((warm.total() / cold.total() - 1.0).abs() < 1e-7, "{name}: {}", warm.total());
    }
    // Of all three motions: the delta robot alone takes 15 to 22 steps at first and 9 to 22 when resumed, as
    // rounding errors divide its mesh.
    assert!(2 * steps[1] < steps[0], "{steps:?}");
}

/// Light wrists without limits: six meshes did not resolve the motion, whose cost was 243. A search from it
/// goes on; with more nodes it comes to 97.9.
#[test]
fn a_search_goes_on_from_a_motion_that_no_mesh_resolved() {
    let from = [1.1828, -1.2499, -0.2764, -1.6011, 0.7041, -1.0339];
    let to = [2.2628, -2.044, -0.816, -1.8076, 0.6894, -0.22];
    let robot = Robot::from_file("../robots/ur5.urdf").unwrap();
    let problem = Problem::rest_to_rest(robot, &from, &to, 3.0)
        .with_cost(Objective::new(0.0, vec![1.0; 6]))
        .with_limits(MotionLimits::none());
    let options = SolverOptions::default().with_tolerance(1e-4).with_polish(Polish::Never);
    let solution = solve(&problem, options.with_max_nodes(900));
    assert!(solution.total() < 150.0, "{} {}", solution.motion.status, solution.total());
}
