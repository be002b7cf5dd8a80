//! Tools: every key of a problem file, the same in Rust, and errors.

use costate::robot::{JointSpec, LinkInertia, LoadOptions, Placement, Robot};
use costate_control::{
    BoundaryState, Keep, Kept, Method, Parameter, Problem, ProblemError, ProblemFile, Solver, SolverOptions,
    Task, TaskError, Tool, ToolCost, ToolOrientation, ToolPose,
};
use nalgebra::{Rotation3, Vector3};

const INF: f64 = f64::INFINITY;
const START: [f64; 6] = [0.0, -1.6, 1.8, -1.8, -1.57, 0.0];

pub(super) const TOP: &str = "robot = \"ur5.urdf\"\n[start]\nq = [0.0, -1.6, 1.8, -1.8, -1.57, 0.0]\n[end]\n\
                   q = [1.5, -1.0, 1.2, -1.5, -1.57, 0.5]\n[time]\nfinal = 1\n[cost]\neffort = [1, 1, 1, 1, 1, 1]\n";

/// The end of [`TOP`] is a pose instead.
fn with_tool(lines: &str) -> String {
    TOP.replace("[time]", &format!("[end.tool]\n{lines}[time]"))
}

pub(super) fn read(text: &str) -> Result<ProblemFile, String> {
    ProblemFile::from_text(text, "../robots", LoadOptions::default()).map_err(|error| error.to_string())
}

fn arm() -> Robot {
    Robot::from_file("../robots/ur5.urdf").unwrap()
}

/// The problem of [`TOP`] with this task.
fn problem(task: Task) -> Problem {
    Problem::rest_to_rest(arm(), &START, &[1.5, -1.0, 1.2, -1.5, -1.57, 0.5], 1.0).with_task(task)
}

#[test]
fn every_key_of_tools_reaches_the_problem() {
    let lines = "frame = \"tool0\"\noffset = [0, 0, 0.1]\nxyz = [0.4, inf, 0.3]\naxis = [0, 0, 2]\nalong = [0, 0, -1]\n";
    let file = read(&with_tool(lines)).unwrap();
    let tool = Tool::new("tool0").with_offset([0.0, 0.0, 0.1]);
    let pose = ToolPose::of(tool.clone())
        .with_position([0.4, INF, 0.3])
        .with_axis([0.0, 0.0, 2.0], [0.0, 0.0, -1.0]);
    assert_eq!(file.problem.task, Task::default().with_end_tool(pose));
    // All joints are free; q is a first guess, by default that of the start.
    assert_eq!(file.problem.end.q_free, [0, 1, 2, 3, 4, 5]);
    assert_eq!(file.problem.end.q[0], 1.5);
    assert_eq!(file.options.method, Method::Direct);
    let without = read(&with_tool(lines).replace("q = [1.5, -1.0, 1.2, -1.5, -1.57, 0.5]\n", "")).unwrap();
    assert_eq!(without.problem.end.q, START);
    let some = with_tool(lines).replace("[end]\n", "[end]\nq_free = [0, 1, 2, \"wrist_1_joint\", 4]\n");
    assert_eq!(read(&some).unwrap().problem.end.q_free, [0, 1, 2, 3, 4]);

    let keep = "[[keep]]\nkind = \"plane\"\nframe = \"tool0\"\nthrough = [0, 0, 0.1]\nnormal = [0, 0, 1]\ndistance = 9\n\
                [[keep]]\nkind = \"line\"\nframe = \"tool0\"\nthrough = [0, 0, 0.1]\nalong = [1, 0, 0]\ndistance = 8\n\
                [[keep]]\nkind = \"box\"\nframe = \"tool0\"\noffset = [0, 0, 0.1]\nmin = [-3, -inf, -3]\nmax = [inf, 4, 4]\n\
                [[keep]]\nkind = \"axis\"\nframe = \"tool0\"\nalong = [0, 1, 1]\nangle = 3\n\
                [[keep]]\nkind = \"orientation\"\nframe = \"tool0\"\nrpy = [0.1, 0.2, 0.3]\nangle = 3.1\n\
                [[keep]]\nkind = \"speed\"\nframe = \"tool0\"\nspeed = 0.5\n\
                [[cost.tool]]\nframe = \"tool0\"\nrotation = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]\nxyz = [1, 2, 3]\n\
                position_weight = 7\n";
    let file = read(&format!("{TOP}{keep}")).unwrap();
    let through = [0.0, 0.0, 0.1];
    let turn = Rotation3::from_matrix_unchecked(Placement::from_xyz_rpy([0.0; 3], [0.1, 0.2, 0.3]).rotation);
    let quarter = file.problem.task.tool_costs[0].pose.orientation.clone();
    let mut cost = ToolPose::of("tool0").with_position([1.0, 2.0, 3.0]);
    cost.orientation = quarter;
    let expected = Task::default()
        .with_keep(Keep::new("tool0", Kept::Plane { through, normal: [0.0, 0.0, 1.0], distance: 9.0 }))
        .with_keep(Keep::new("tool0", Kept::Line { through, along: [1.0, 0.0, 0.0], distance: 8.0 }))
        .with_keep(Keep::new(tool, Kept::Box { min: [-3.0, -INF, -3.0], max: [INF, 4.0, 4.0] }))
        .with_keep(Keep::new(
            "tool0",
            Kept::Axis { axis: [0.0, 0.0, 1.0], along: [0.0, 1.0, 1.0], angle: 3.0 },
        ))
        .with_keep(Keep::new("tool0", Kept::Orientation { rotation: turn, angle: 3.1 }))
        .with_keep(Keep::new("tool0", Kept::Speed { max: 0.5 }))
        .with_tool_cost(ToolCost::new(cost, 7.0, 1.0));
    assert_eq!(file.problem.task, expected);
}

#[test]
fn wrong_keys_of_tools_are_named() {
    let tool = "frame = \"tool0\"\nxyz = [0.4, 0.1, 0.3]\n";
    for (lines, message) in [
        (
            "frame = \"tol0\"\nxyz = [0, 0, 1]\n",
            "problem:7: end.tool.frame: there is no frame 'tol0'; did you mean 'tool0'",
        ),
        (
            "frame = \"base_link\"\nxyz = [0, 0, 1]\n",
            "problem:7: end.tool.frame: no joint moves the frame 'base_link'",
        ),
        ("xyz = [0, 0, 1]\n", "problem:6: end.tool.frame: missing; add it"),
        ("frame = \"tool0\"\n", "problem:7: end.tool.frame: nothing is asked of the tool 'tool0'"),
        ("frame = \"tool0\"\nxyz = [inf, inf, inf]\n", "problem:7: end.tool.frame: nothing is asked"),
        (
            "frame = \"tool0\"\nxyz = [0, 1]\n",
            "problem:8: end.tool.xyz: give a list of 3 numbers, not a list of 2",
        ),
        ("frame = \"tool0\"\nxyz = [0, nan, 1]\n", "problem:8: end.tool.xyz: must be finite"),
        (
            "frame = \"tool0\"\noffset = [0, inf, 1]\nalong = [1, 0, 0]\n",
            "problem:8: end.tool.offset: must be finite",
        ),
        ("frame = \"tool0\"\nalong = [0, 0, 0]\n", "problem:8: end.tool.along: gives no direction"),
        ("frame = \"tool0\"\naxis = [0, 0, 1]\n", "problem:8: end.tool.axis: needs `along`"),
        (
            "frame = \"tool0\"\nrpy = [0, 0, 1]\nalong = [0, 0, 1]\n",
            "problem:9: end.tool.along: the orientation is given",
        ),
        (
            "frame = \"tool0\"\nrotation = [[1, 0], [0, 1]]\n",
            "problem:8: end.tool.rotation: give three lists",
        ),
        (
            "frame = \"tool0\"\nrotation = [[1, 0, 0], [0, 1, 0], [0, 0, -1]]\n",
            "problem:8: end.tool.rotation: give three rows that are orthonormal",
        ),
        (
            "frame = \"tool0\"\nposition = [0, 0, 0]\n",
            "problem:8: end.tool.position: unknown key; the keys here are `frame`",
        ),
        (
            "frame = \"tool0\"\nxyz = [0, 0, 5]\n",
            "problem:8: end.tool.xyz: lies 4.9108 m from joint 'shoulder_pan_joint'",
        ),
    ] {
        let error = read(&with_tool(lines)).unwrap_err();
        assert!(error.starts_with(message), "{error}\n{message}");
    }
    let few = with_tool(tool).replace("[end]\n", "[end]\nq_free = [0, 1]\n");
    let error = read(&few).unwrap_err();
    assert!(error.contains("fix 3 quantities, but the number of joints with free positions is 2"), "{error}");
    let collocation = with_tool(tool) + "[solver]\nmethod = \"collocation\"\n";
    let error = read(&collocation).unwrap_err();
    assert!(
        error.starts_with(
            "problem:7: end.tool.frame: tools and obstacles are taken by method = \"direct\" only"
        ),
        "{error}"
    );
    // The second of two tools has its own line.
    let second = with_tool(tool).replace("[end.tool]", "[[end.tool]]")
        + "[[end.tool]]\nframe = \"tol1\"\nxyz = [0, 0, 1]\n";
    let error = read(&second).unwrap_err();
    assert!(error.starts_with("problem:14: end.tool.frame: there is no frame 'tol1'"), "{error}");
}

#[test]
fn wrong_keys_of_what_is_kept_are_named() {
    for (lines, message) in [
        ("frame = \"tool0\"\n", "problem:10: keep.kind: missing"),
        ("kind = \"cup\"\n", "problem:11: keep.kind: `cup` is unknown; give `plane`, `line`, `box`"),
        (
            "kind = \"plane\"\nspeed = 1\n",
            "problem:12: keep.speed: unknown key; the keys here are `kind`, `frame`",
        ),
        ("kind = \"plane\"\nframe = \"tool0\"\nthrough = [0, 0, 1]\n", "problem:10: keep.normal: missing"),
        (
            "kind = \"axis\"\nframe = \"tool0\"\nalong = [0, 0, 1]\nangle = 4\n",
            "problem:14: keep.angle: must be at least 0 and less than a half turn",
        ),
        (
            "kind = \"line\"\nframe = \"tool0\"\nthrough = [0, 0, 1]\nalong = [0, 0, 1]\ndistance = -1\n",
            "problem:15: keep.distance: must be neither negative nor infinite, but is -1",
        ),
        (
            "kind = \"speed\"\nframe = \"tool0\"\nspeed = 0\n",
            "problem:13: keep.speed: must be positive and finite, but is 0",
        ),
        (
            "kind = \"box\"\nframe = \"tool0\"\nmin = [0, 0, 2]\nmax = [1, 1, 1]\n",
            "problem:14: keep.max: must not be less than the entry of min, but is 1",
        ),
        // The arm starts elsewhere.
        (
            "kind = \"plane\"\nframe = \"tool0\"\nthrough = [0, 0, -1]\nnormal = [0, 0, 1]\n",
            "problem:3: start.q: the distance from the plane of the tool 'tool0' is off by 1.",
        ),
    ] {
        let error = read(&format!("{TOP}[[keep]]\n{lines}")).unwrap_err();
        assert!(error.starts_with(message), "{error}\n{message}");
    }
}

#[test]
fn errors_of_tasks_in_rust_name_the_entry() {
    let keep = |frame: &str| Keep::new(frame, Kept::Speed { max: 1.0 });
    let unknown = problem(Task::default().with_keep(keep("tool0")).with_keep(keep("tool1")));
    let error = unknown.check_for(Method::Direct).unwrap_err();
    let ProblemError::Task { cause: TaskError::UnknownFrame { frame, nearest }, .. } = &error else {
        panic!("{error}")
    };
    assert!(frame == "tool1" && nearest.contains(&"tool0".into()));
    assert!(error.to_string().starts_with("task: keep[1].frame: there is no frame 'tool1'"), "{error}");
    let valid = problem(Task::default().with_keep(keep("tool0")));
    assert!(valid.check_for(Method::Direct).is_ok());
    let error = valid.check_for(Method::Shooting).unwrap_err();
    assert!(matches!(error, ProblemError::TaskNeedsDirect { .. }), "{error}");
    assert!(Solver::new(&valid, SolverOptions::of(Method::Collocation)).is_err());
    let refused = Parameter::FinalTime.apply(&valid, 2.0).unwrap_err();
    assert!(refused.to_string().ends_with("takes neither tools nor obstacles; remove them"), "{refused}");
    let mut over =
        problem(Task::default().with_end_tool(ToolPose::of("tool0").with_position([0.4, 0.1, 0.3])));
    over.end = BoundaryState::fixed(&START, &[0.0; 6]).with_q_free(&[0, 1]);
    let error = over.check_for(Method::Direct).unwrap_err();
    let ProblemError::Task { cause: TaskError::TooManyConditions { asked: 3, free: 2, .. }, .. } = error
    else {
        panic!("{error}")
    };
}

#[test]
fn quaternions_and_yaws_are_orientations() {
    let pose = |lines: &str| {
        let file = read(&with_tool(&format!("frame = \"tool0\"\nxyz = [0.4, 0.3, 0.3]\n{lines}\n")));
        file.map(|file| file.problem.task.end_tools[0].orientation.clone().unwrap())
    };
    let half = std::f64::consts::FRAC_1_SQRT_2;
    // A quarter turn about x: (x, y, z, w), three digits are enough.
    let Ok(ToolOrientation::Full(found)) = pose("quaternion = [0.707, 0, 0, 0.707]") else { panic!() };
    let expected = Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
    assert!((found.matrix() - expected.matrix()).amax() < 1e-15);
    let Ok(ToolOrientation::Full(found)) = pose(&format!("quaternion = [0, 0, {half}, -{half}]")) else {
        panic!()
    };
    assert!(
        (found.matrix()
            - Rotation3::from_axis_angle(&Vector3::z_axis(), -std::f64::consts::FRAC_PI_2).matrix())
        .amax()
            < 1e-15
    );
    assert_eq!(pose("yaw = 0.3"), Ok(ToolOrientation::Yaw(0.3)));
    for (lines, expected) in [
        ("quaternion = [1, 0, 0, 1]", "quaternion: give [x, y, z, w] of length 1 to 1e-3"),
        ("quaternion = [1, 0, 0]", "quaternion: give [x, y, z, w]"),
        ("quaternion = [1, 0, 0, 0]\nrpy = [0, 0, 0]", "given by rpy or rotation already"),
        ("yaw = 0.1\nalong = [0, 0, 1]", "yaw: the orientation is given by another key already"),
        ("yaw = nan", "must be finite"),
    ] {
        let error = pose(lines).unwrap_err();
        assert!(error.contains(expected), "{lines}: {error}");
    }
}

/// A palletiser with four joints is posed by xyz and yaw: as many equations as joints.
#[test]
fn four_axes_are_posed_by_position_and_yaw() {
    let link = |mass: f64| LinkInertia::from_entries(mass, [0.3, 0.0, 0.0], [0.01, 0.1, 0.1, 0.0, 0.0, 0.0]);
    let at = |xyz: [f64; 3]| Placement::from_xyz_rpy(xyz, [0.0; 3]);
    let robot = Robot::builder("scara")
        .joint(JointSpec::revolute("one").carrying(link(4.0)))
        .joint(JointSpec::revolute("two").on("one").placed(at([0.5, 0.0, 0.0])).carrying(link(2.0)))
        .joint(JointSpec::prismatic("lift").on("two").placed(at([0.4, 0.0, 0.0])).carrying(link(1.0)))
        .joint(JointSpec::revolute("turn").on("lift").carrying(link(0.3)))
        .build()
        .unwrap();
    let pose = ToolPose::of("joint:turn").with_position([0.3, 0.6, 0.2]).with_yaw(2.5);
    let problem = Problem::rest_to_rest(robot, &[0.0, 0.5, 0.0, 0.0], &[0.5, 0.5, 0.0, 0.0], 1.0)
        .with_task(Task::default().with_end_tool(pose))
        .with_end(BoundaryState::fixed(&[0.5, 0.5, 0.0, 0.0], &[0.0; 4]).with_q_free(&[0, 1, 2, 3]));
    let solution = Solver::new(&problem, SolverOptions::default()).unwrap().solve();
    assert!(solution.motion.status.is_converged(), "{}", solution.motion.status);
    let q = solution.trajectory.q.last().unwrap();
    let turned = (q[0] + q[1] + q[3] - 2.5).rem_euclid(std::f64::consts::TAU);
    assert!(turned.min(std::f64::consts::TAU - turned) < 1e-6 && (q[2] - 0.2).abs() < 1e-6, "{q:?}");
    let x = [0.5 * q[0].cos() + 0.4 * (q[0] + q[1]).cos(), 0.5 * q[0].sin() + 0.4 * (q[0] + q[1]).sin()];
    assert!((x[0] - 0.3).hypot(x[1] - 0.6) < 1e-6, "{x:?}");
}

/// A start with a tool needs no positions: those within the limits at which the tool is there.
#[test]
fn a_start_with_a_tool_needs_no_positions() {
    let start = "[start.tool]\nframe = \"tool0\"\nxyz = [0.4, 0.3, 0.3]\nalong = [0, 0, -1]\n";
    let text = with_tool("frame = \"tool0\"\nxyz = [0.4, -0.3, 0.3]\nalong = [0, 0, -1]\n")
        .replace("[start]\nq = [0.0, -1.6, 1.8, -1.8, -1.57, 0.0]\n", start)
        .replace("[end]\nq = [1.5, -1.0, 1.2, -1.5, -1.57, 0.5]\n", "");
    let problem = read(&text).unwrap().problem;
    assert_eq!(problem.start.q_free, [0, 1, 2, 3, 4, 5]);
    assert_eq!(problem.end.q, problem.start.q);
    let mut kinematics = costate::kinematics::Kinematics::<f64>::new(&problem.robot);
    kinematics.set_position(&problem.start.q).unwrap();
    let x = kinematics.pose(problem.robot.frame_index("tool0").unwrap()).unwrap();
    let miss = [0.4, 0.3, 0.3].iter().zip(x.position).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(miss < 1e-6 && (x.rotation[2][2] + 1.0).abs() < 1e-9, "{miss} {:?}", x.rotation);
    for (joint, q) in problem.robot.joints().iter().zip(&problem.start.q) {
        assert!((joint.limits.lower..=joint.limits.upper).contains(q), "{}: {q}", joint.name);
    }
    let error = read(&text.replace(start, "[start]\nv = [0, 0, 0, 0, 0, 0]\n")).unwrap_err();
    assert!(error.contains("start.q: missing"), "{error}");
    let given = text.replace(start, &format!("[start]\nq_free = [0]\n{start}"));
    assert!(read(&given).unwrap_err().contains("start.q: missing"), "{given}");
}
