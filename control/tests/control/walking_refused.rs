//! Gaits that are refused, by name and with the remedy.

use super::gaits::example;
use super::walking::file;
use costate::robot::{LoadOptions, Robot};
use costate_control::{
    BoundaryState, Gait, GaitError, MotionLimits, Objective, Problem, ProblemError, ProblemFile, Solver,
    SolverOptions,
};

#[test]
fn what_is_no_step_is_refused_by_name() {
    let problem = file().problem;
    let gait = problem.gait.clone().unwrap();
    let refused = |problem: &Problem| Solver::new(problem, SolverOptions::default()).unwrap_err();
    let with = |change: &dyn Fn(&mut Gait)| {
        let mut gait = gait.clone();
        change(&mut gait);
        refused(&problem.clone().with_gait(gait))
    };
    let cause = |error: ProblemError| match error {
        ProblemError::Gait { key, cause } => (key.to_string(), *cause),
        other => panic!("{other}"),
    };
    let (key, found) = cause(with(&|gait| gait.stance = vec!["right_fot".into()]));
    let GaitError::UnknownFrame { frame, nearest } = found else { panic!("{found}") };
    assert_eq!((&*key, &*frame, &*nearest[0]), ("gait.stance", "right_fot", "right_foot"));
    let (key, found) = cause(with(&|gait| gait.swing = vec!["right_foot".into()]));
    assert_eq!((&*key, found), ("gait.swing", GaitError::OneFoot { frame: "right_foot".into() }));
    let (key, found) = cause(with(&|gait| gait.swing.clear()));
    assert_eq!((&*key, found), ("gait.swing", GaitError::Unpaired { stance: 1, swing: 0 }));
    for value in [0.0, -0.1, f64::NAN] {
        let (key, found) = cause(with(&|gait| gait.length = value));
        assert!(key == "gait.length" && matches!(found, GaitError::OutOfRange { .. }), "{found}");
        let (key, found) = cause(with(&|gait| gait.friction = value));
        assert!(key == "gait.friction" && matches!(found, GaitError::OutOfRange { .. }), "{found}");
    }
    assert_eq!(cause(with(&|gait| gait.clearance = -1.0)).0, "gait.clearance");
    assert_eq!(cause(with(&|gait| gait.friction = 1e6)).0, "gait.friction");
    let (key, found) = cause(with(&|gait| gait.along = "base_z".into()));
    assert_eq!((&*key, found), ("gait.along", GaitError::NotAlong { joint: "base_z".into() }));
    let (key, found) = cause(with(&|gait| gait.length = 3.0));
    assert!(key == "start.q" && matches!(found, GaitError::CannotStand { .. }), "{found}");
    let (key, found) = cause(with(&|gait| gait.mirror.truncate(1)));
    assert!(key == "gait.mirror" && matches!(found, GaitError::NotMirrored { .. }), "{found}");
    let twice = with(&|gait| gait.mirror[1] = gait.mirror[0].clone());
    assert!(matches!(twice, ProblemError::GivenTwice { .. }), "{twice}");
    let unknown = with(&|gait| gait.mirror[1][0] = "left_kne".into());
    assert!(unknown.to_string().contains("left_knee"), "{unknown}");
}

#[test]
fn problem_files_say_what_is_wrong_with_a_step() {
    let text = file().text;
    let folder = "../examples/problems";
    let refused = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        ProblemFile::from_text(&text.replace(from, to), folder, LoadOptions::default())
            .unwrap_err()
            .to_string()
    };
    assert!(refused("length = 0.5", "lenght = 0.5").contains("lenght"));
    assert!(refused("length = 0.5", "").contains("gait.length"));
    assert!(refused("[time]", "[end]\nq = [0.0]\n[time]").contains("remove [end] or [gait]"));
    let mirror =
        refused("[[\"left_hip\", \"right_hip\"], [\"left_knee\", \"right_knee\"]]", "[\"left_hip\"]");
    assert!(mirror.contains("a list of pairs of joint names"), "{mirror}");
}

/// All of the ends but the position of the start is found, so nothing else of them is taken.
#[test]
fn given_ends_are_refused_by_name() {
    type Change = fn(&mut BoundaryState);
    let problem = file().problem;
    let changes: [(&str, Change); 4] = [
        ("v", |end| end.v[3] = 9.0),
        ("a", |end| end.a = Some(vec![0.0; 7])),
        ("q_free", |end| end.q_free = vec![3]),
        ("v_free", |end| end.v_free = vec![3]),
    ];
    for (name, change) in changes {
        for at_start in [true, false] {
            let mut problem = problem.clone();
            change(if at_start { &mut problem.start } else { &mut problem.end });
            let error = Solver::new(&problem, SolverOptions::default()).unwrap_err();
            let ProblemError::Gait { cause, .. } = error else { panic!("{error}") };
            let GaitError::NotTaken { with } = *cause else { panic!("{cause}") };
            assert_eq!((with.table(), with.name()), (if at_start { "start" } else { "end" }, name));
        }
    }
    let text = file().text;
    for given in ["v = [9, 0, 0, 0, 0, 0, 0]", "a = [0, 0, 0, 0, 0, 0, 0]", "q_free = [\"left_hip\"]"] {
        let text = text.replace("[start]\n", &format!("[start]\n{given}\n"));
        let message = ProblemFile::from_text(&text, "../examples/problems", LoadOptions::default())
            .unwrap_err()
            .to_string();
        let name = given.split(' ').next().unwrap();
        assert!(message.contains(&format!("start.{name} and a gait do not go together")), "{message}");
    }
    // Rates of zero are those of rest_to_rest, which gives none.
    let text = text.replace("[start]\n", "[start]\nv = [0, 0, 0, 0, 0, 0, 0]\n");
    ProblemFile::from_text(&text, "../examples/problems", LoadOptions::default()).unwrap();
}

/// The ground is level, and feet stand on it by their weight.
#[test]
fn gravity_that_is_not_along_minus_z_is_refused() {
    for (name, gravity) in [
        ("rabbit_walk", [0.0, 0.0, 0.0]),
        ("rabbit_walk", [3.0, 0.0, -9.0]),
        ("rabbit_walk", [0.0, 0.0, 9.81]),
        ("seven_link_walk", [0.0, 0.0, 0.0]),
        ("biped_walk", [0.0, 0.1, -9.81]),
    ] {
        let mut problem = example(name).problem;
        problem.robot = problem.robot.with_gravity(gravity).unwrap();
        let error = Solver::new(&problem, SolverOptions::default()).unwrap_err();
        assert_eq!(error.key().unwrap().to_string(), "robot.gravity");
        let message = error.to_string();
        let ProblemError::Gait { cause, .. } = error else { panic!("{message}") };
        assert_eq!(*cause, GaitError::NotLevel { gravity });
        assert!(message.contains("robot.gravity: is [") && message.contains("along -z"), "{message}");
    }
}

/// With a weaker left hip a step can be found, but the next one, in which it does what the right one did,
/// would be beyond its limit.
#[test]
fn legs_with_unequal_limits_are_refused() {
    let text = file().text;
    for (key, from, to, told) in [
        (
            "limits.torque_max",
            "torque_max = [0.0, 0.0, 0.0, 150.0,",
            "torque_max = [0.0, 0.0, 0.0, 25.0,",
            ["'left_hip' has 25,", "'right_hip' 150 "],
        ),
        (
            "limits.q_min",
            "-inf, 0.0, -inf, 0.0]",
            "-inf, 0.0, -inf, 0.1]",
            ["'left_knee' has 0,", "'right_knee' 0.1 "],
        ),
        (
            "cost.effort",
            "effort = [0.0, 0.0, 0.0, 1.0, 1.0,",
            "effort = [0.0, 0.0, 0.0, 1.0, 1.5,",
            ["'left_knee' has 1.5,", "'right_knee' 1 "],
        ),
    ] {
        assert!(text.contains(from), "{from}");
        let text = text.replace(from, to);
        let message = ProblemFile::from_text(&text, "../examples/problems", LoadOptions::default())
            .unwrap_err()
            .to_string();
        let line = text.lines().position(|line| line.contains(to)).unwrap() + 1;
        assert!(message.contains(&format!(":{line}: {key}: ")), "{message}");
        assert!(told.iter().all(|told| message.contains(told)), "{message}");
    }
}

/// A body that moves along and up, with two skates on slides below it. Both have its height.
const SKATES: &str = r#"
name = "skates"
gravity = [0.0, 0.0, -9.81]
convention = "placements"
joint = [
    { name = "base", type = "prismatic", axis = [1.0, 0.0, 0.0] },
    { name = "body", parent = "base", type = "prismatic", axis = [0.0, 0.0, 1.0], mass = 10.0 },
    { name = "left", parent = "body", type = "prismatic", axis = [1.0, 0.0, 0.0], mass = 1.0 },
    { name = "right", parent = "body", type = "prismatic", axis = [1.0, 0.0, 0.0], mass = 1.0 },
]
frame = [
    { name = "left_heel", parent = "left", placement = { xyz = [-0.1, 0.0, -0.5] } },
    { name = "left_toe", parent = "left", placement = { xyz = [0.1, 0.0, -0.5] } },
    { name = "right_heel", parent = "right", placement = { xyz = [-0.1, 0.0, -0.5] } },
    { name = "right_toe", parent = "right", placement = { xyz = [0.1, 0.0, -0.5] } },
]
"#;

#[test]
fn feet_that_cannot_move_against_each_other_are_refused() {
    let gait = |stance: &[&str], swing: &[&str]| {
        Gait::new(stance, swing, "base", 0.3).with_mirror(&[["left", "right"]])
    };
    let robot = Robot::from_toml_str(SKATES, LoadOptions::default()).unwrap();
    let q = [-0.15, 0.5, -0.15, 0.15];
    let problem = Problem::rest_to_rest(robot, &q, &q, 0.7)
        .with_cost(Objective::new(0.0, vec![0.0, 0.0, 1.0, 1.0]))
        .with_limits(MotionLimits::none().with_torque_max(vec![0.0, 0.0, 100.0, 100.0]));
    let prepared = |gait: &Gait| {
        Solver::new(&problem.clone().with_gait(gait.clone()), SolverOptions::default()).map(drop)
    };
    let refused = |gait: &Gait| match prepared(gait).unwrap_err() {
        ProblemError::Gait { key, cause } => (key.to_string(), *cause),
        other => panic!("{other}"),
    };
    // One skate alone stands, on its toe; both cannot, as they have one height.
    let one = gait(&["right_toe"], &["left_toe"]);
    prepared(&one).unwrap();
    let both = one.with_double_support(0.2);
    let together = GaitError::RedundantTogether { frame: "left_toe".into() };
    assert_eq!(refused(&both), ("gait.double_support".into(), together));
    let message = prepared(&both).unwrap_err().to_string();
    assert!(
        message.contains("gait.double_support")
            && message.contains("'left_toe'")
            && message.contains("remove double_support"),
        "{message}"
    );
    // Heel and toe of one skate are two feet that never move against each other.
    let whole = gait(&["right_toe", "right_heel"], &["left_toe", "left_heel"]);
    let redundant = GaitError::Redundant { frame: "right_heel".into() };
    assert_eq!(refused(&whole), ("gait.stance".into(), redundant.clone()));
    assert_eq!(refused(&whole.clone().with_double_support(0.2)).1, redundant);
    let message = prepared(&whole).unwrap_err().to_string();
    assert!(
        message.contains("gait.stance")
            && message.contains("'right_heel'")
            && message.contains("name fewer feet"),
        "{message}"
    );
}
