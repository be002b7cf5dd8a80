//! Vias and periodic motions in problem files: every key, the same in Rust, and errors.

use costate::robot::{LinkInertia, LoadOptions, Robot};
use costate_control::{
    BoundaryState, FinalTime, Method, Payload, Problem, ProblemError, ProblemFile, Solution, Solver,
    SolverOptions, ToolPose, Trajectory, Via,
};

const TOP: &str = "robot = \"two_link.toml\"\n[start]\nq = [0.0, 0.0]\n[end]\nq = [1.5, 1.5]\n[time]\nfinal = 1\n\
                   [cost]\neffort = [1, 1]\n[limits]\nfrom_robot = false\nq_max = [2.0, 2.0]\n";

fn read(lines: &str) -> Result<ProblemFile, String> {
    let text = format!("{TOP}{lines}");
    ProblemFile::from_text(&text, "../robots", LoadOptions::default()).map_err(|error| error.to_string())
}

fn problem() -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    Problem::rest_to_rest(robot, &[0.0; 2], &[1.5; 2], 1.0)
}

#[test]
fn every_key_of_vias_reaches_the_problem() {
    let lines = "[[via]]\nq = [0.5, 0.2]\nq_free = [\"elbow\"]\nv = [0.1, 0.3]\nv_free = [1]\ntime = 0.25\n\
                 [[via]]\nstop = true\n[[via.tool]]\nframe = \"joint:elbow\"\nxyz = [0.4, inf, inf]\n\
                 [[via.payload]]\nframe = \"joint:elbow\"\nmass = 2\ncom = [1, 0, 0]\ninertia = { zz = 0.1 }\n\
                 [[via]]\nq = [1.0, 1.0]\npayload = []\n";
    let file = read(lines).unwrap();
    let inertia = LinkInertia::from_entries(2.0, [1.0, 0.0, 0.0], [0.0, 0.0, 0.1, 0.0, 0.0, 0.0]);
    let first = Via::at(&[0.5, 0.2]).with_q_free(&[1]).with_v(&[0.1, 0.3]).with_v_free(&[1]).with_time(0.25);
    let pose = ToolPose::of("joint:elbow").with_position([0.4, f64::INFINITY, f64::INFINITY]);
    let second = Via::of_tool(pose).stopping().with_payload(Payload::new("joint:elbow", inertia));
    assert_eq!(file.problem.vias, [first, second, Via::at(&[1.0, 1.0]).without_payload()]);
    assert_eq!(file.options.method, Method::Direct);
    // With tools q is a first guess.
    let tool = "[[via]]\nq = [0.3, 0.1]\n[[via.tool]]\nframe = \"joint:elbow\"\nxyz = [0.9, inf, inf]\n";
    assert_eq!(read(tool).unwrap().problem.vias[0].q_free, [0, 1]);
}

#[test]
fn what_a_periodic_motion_does_not_give_is_free() {
    let periodic = |start: &str, rest: &str| {
        let text = TOP.replace("[start]\nq = [0.0, 0.0]\n", start).replace("[end]\nq = [1.5, 1.5]\n", "");
        let text = format!("{text}{rest}");
        ProblemFile::from_text(&text, "../robots", LoadOptions::default()).map_err(|error| error.to_string())
    };
    let free = periodic("", "[periodic]\n").unwrap().problem;
    assert_eq!((free.start.q_free, free.start.v_free), (vec![0, 1], vec![0, 1]));
    assert_eq!(free.periodic, Some(vec![0.0; 2]));
    let given =
        periodic("[start]\nq = [0.1, 0.2]\nq_free = [1]\nv = [0, 0]\n", "[periodic]\nshift = [1, 0]\n");
    let given = given.unwrap().problem;
    assert_eq!((&given.start.q_free, &given.start.v_free), (&vec![1], &vec![]));
    assert_eq!(given.periodic, Some(vec![1.0, 0.0]));
    let beyond = periodic("[start]\nq = [1.5, 0.2]\n", "[periodic]\nshift = [1, 0]\n").unwrap_err();
    assert!(beyond.contains("periodic.shift") && beyond.contains("'shoulder'"), "{beyond}");
    let both = read("[periodic]\nshift = [1, 0]\n").unwrap_err();
    assert!(both.contains("remove [end] or [periodic]"), "{both}");
}

#[test]
fn errors_name_the_via_and_the_key() {
    let cases = [
        ("[[via]]\nq = [0.1, 3.0]\n", "via 1, q", "'elbow' lies outside of its limits"),
        ("[[via]]\nq = [0.1, 0.2]\n[[via]]\nq = [0.1]\n", "via 2, q", "has 1 entry"),
        ("[[via]]\nq = [0.1, 0.2]\nq_free = [\"wrist\"]\n", "via 1, q_free", "there is no joint 'wrist'"),
        ("[[via]]\nstop = true\nv = [0, 0]\n", "via 1, stop", "remove v or stop"),
        ("[[via]]\nstop = true\nv_free = [0]\n", "via 1, v_free", "give v"),
        ("[[via]]\ntime = 0.5\n", "via 1, q", "nothing is asked"),
        ("[[via]]\nstop = true\ntime = -1\n", "via 1, time", "not later than 0"),
        ("[[via]]\nstop = true\ntime = 2\n", "via 1, time", "not before the final time"),
        (
            "[[via]]\nstop = true\ntime = 0.6\n[[via]]\nstop = true\ntime = 0.5\n",
            "via 2, time",
            "not later than 0.6 s",
        ),
        (
            "[[via]]\nstop = true\n[[via.payload]]\nframe = \"joint:elbo\"\nmass = 1\n",
            "via 1, payload",
            "joint:elbow",
        ),
        (
            "[[via]]\nstop = true\n[[via.payload]]\nframe = \"joint:elbow\"\nmass = -1\n",
            "via 1, payload",
            "-1",
        ),
        ("[[via]]\n[[via.tool]]\nframe = \"joint:elbow\"\nxyz = [5, 0, inf]\n", "via 1, xyz", "5"),
        ("[[via]]\nquick = true\n", "via.quick", "the keys here are"),
    ];
    for (lines, key, reason) in cases {
        let error = read(lines).unwrap_err();
        assert!(error.contains(key) && error.contains(reason), "{lines}: {error}");
        let line: usize = error.split(':').nth(1).and_then(|line| line.parse().ok()).unwrap();
        assert!(line > TOP.lines().count(), "{error}");
    }
    let other = read("[solver]\nmethod = \"collocation\"\n[[via]]\nq = [0.1, 0.1]\n").unwrap_err();
    assert!(other.contains("by method = \"direct\" only"), "{other}");
}

#[test]
fn what_does_not_take_vias_says_so() {
    let via = problem().with_via(Via::at(&[0.5; 2]));
    let error = Solver::new(&via, SolverOptions::of(Method::Collocation)).unwrap_err();
    assert_eq!(error.to_string().split(':').next(), Some("vias[0].q"));
    let periodic = problem().with_period(vec![0.0; 2]);
    assert!(matches!(periodic.check_for(Method::Shooting), Err(ProblemError::PhasesNeedDirect { .. })));
}

#[test]
fn a_saved_motion_begins_with_its_phases() {
    let robot = problem().robot;
    let start = BoundaryState::fixed(&[0.0; 2], &[0.0; 2]);
    let problem = problem().with_start(start).with_time(FinalTime::Fixed(2.0));
    let problem = problem.with_limits(costate_control::MotionLimits::none()).with_via(Via::at(&[1.0, 0.2]));
    let options = SolverOptions::default().with_tolerance(1e-6);
    let first = Solver::new(&problem, options.clone()).unwrap().solve();
    let text = serde_json::to_string(&first).unwrap();
    let read: Solution = serde_json::from_str(&text).unwrap();
    assert_eq!(read.trajectory.via_times, first.trajectory.via_times);
    assert_eq!(read.motion.phase_hamiltonians, first.motion.phase_hamiltonians);
    let saved = Trajectory::from_json(&text, &robot).unwrap();
    let again = Solver::new(&problem, options).unwrap().with_start(&saved).unwrap().solve();
    assert!(again.newton_iterations <= first.newton_iterations);
    assert!((again.total() / first.total() - 1.0).abs() < 1e-6);
    let samples = again.sample(&problem, 100.0).unwrap();
    let via = again.trajectory.via_times[0];
    assert!(samples.t.iter().zip(&samples.phase).all(|(&t, &phase)| phase == 1 + usize::from(t >= via)));
    let wrong = text.replace("\"via_times\":[", "\"via_times\":[0.0123,");
    assert!(Trajectory::from_json(&wrong, &robot).is_err());
}
