//! Motions that are verified in full, beside those of finer meshes.

use crate::direct::{INF, problem};
use costate_control::{MachineCode, MotionLimits, Polish, Problem, Solver, SolverOptions, Status, Verify};

fn options(tolerance: f64) -> SolverOptions {
    SolverOptions::default().with_polish(Polish::Never).with_tolerance(tolerance)
}

/// Smooth motions, one along a limit of positions, and one whose torques jump.
fn motions() -> [(&'static str, Problem); 4] {
    let limited = MotionLimits::none().with_q_min(vec![-0.7]);
    [
        ("two_link", problem("two_link")),
        ("pendulum", problem("pendulum_swing_up").with_limits(limited)),
        ("ur5_reach", problem("ur5_reach")),
        ("two_link_bounded", problem("two_link_bounded")),
    ]
}

/// What the cost changes by is about its error, measured with a much smaller tolerance. The gap of the
/// barrier is in both.
#[test]
fn the_finer_mesh_tells_the_error() {
    for (name, problem) in motions() {
        let tolerance = 1e-4;
        let found = Solver::new(&problem, options(tolerance)).unwrap().solve();
        let exact = Solver::new(&problem, options(1e-9)).unwrap().solve();
        assert!(found.motion.status.is_converged() && exact.motion.status.is_converged(), "{name}");
        let told = found.motion.finer_mesh;
        let (error, slack) = ((found.total() / exact.total() - 1.0).abs(), 0.05 * tolerance);
        assert!(told <= 2.0 * error + slack && error <= 2.0 * told + slack, "{name}: {error} not {told}");
    }
}

/// What is shown is the motion that was verified, not that of the finer mesh: without this check the same
/// nodes, positions and costates.
#[test]
fn the_motion_itself_stays() {
    for (name, problem) in motions() {
        // Machine code that is made on the way rounds differently.
        let of = |verify| {
            let options = options(1e-6).with_machine_code(MachineCode::Never).with_verify(verify);
            Solver::new(&problem, options).unwrap().solve()
        };
        let (full, factors) = (of(Verify::Full), of(Verify::Factors));
        assert!(full.motion.finer_mesh.is_finite() && factors.motion.finer_mesh.is_nan(), "{name}");
        assert_eq!(full.trajectory.t, factors.trajectory.t, "{name}");
        assert_eq!(full.trajectory.q, factors.trajectory.q, "{name}");
        assert_eq!(full.trajectory.y_q, factors.trajectory.y_q, "{name}");
        assert_eq!(full.motion.certificate, factors.motion.certificate, "{name}");
        assert_eq!(full.motion.stationarity.to_bits(), factors.motion.stationarity.to_bits(), "{name}");
    }
}

/// A mesh that may not be halved leaves it open; the motion is solved all the same.
#[test]
fn without_room_for_a_finer_mesh_nothing_is_told() {
    let problem = problem("pendulum_swing_up").with_limits(MotionLimits::none().with_q_max(vec![INF]));
    let found = Solver::new(&problem, options(1e-6)).unwrap().solve();
    let nodes = found.mesh_nodes();
    let tight = Solver::new(&problem, options(1e-6).with_max_nodes(nodes.max(21))).unwrap().solve();
    assert_eq!(tight.motion.status, Status::Converged);
    assert!(found.motion.finer_mesh.is_finite() && tight.motion.finer_mesh.is_nan());
}
