//! The JSON form of solutions, and what is refused.

use super::*;
use crate::result::solution::CostateStart;
use crate::result::trajectory::Trajectory;
use costate::robot::{JointSpec, LinkInertia, Robot};

fn sledge(joint: &str) -> Robot {
    let joint = JointSpec::prismatic(joint).carrying(LinkInertia::point(1.0, [0.0; 3]));
    Robot::builder("sledge").joint(joint).build().unwrap()
}

/// A saved motion of two nodes.
fn text(t: &str, q: &str, y: &str) -> String {
    let rest = "\"v\":[[0],[0.1]],\"p\":[[0],[0.1]],\"u\":[[1],[-1]]";
    format!(
        "{{\"format\":1,\"status\":\"mesh_limit\",\"trajectory\":{{\"t\":{t},\"q\":{q},\"y\":{y},{rest}}}}}"
    )
}

#[test]
fn what_is_written_is_what_is_read() {
    let robot = sledge("x");
    let text = text("[0,0.3]", "[[0.1],[0.30000000000000004]]", "[[1,2],[3,4]]");
    let trajectory = Trajectory::from_json(&text, &robot).unwrap();
    assert_eq!(trajectory.q[1][0], 0.30000000000000004);
    let mut solution = Solution::missing(&robot, Status::MeshLimit, 0.3);
    solution.trajectory = trajectory.clone();
    let again = serde_json::to_string(&solution).unwrap();
    assert_eq!(Trajectory::from_json(&again, &robot).unwrap(), trajectory);
    assert_eq!(solution.costate_start(), CostateStart { y_q: &[1.0], y_p: &[2.0] });
    let whole: Solution = serde_json::from_str(&again).unwrap();
    assert_eq!(serde_json::to_string(&whole).unwrap(), again);
    assert_eq!(whole.motion.status, Status::MeshLimit);
    let alone = trajectory.to_json(&solution.robot).unwrap();
    assert_eq!(Trajectory::from_json(&alone, &robot).unwrap(), trajectory);
    let error = Trajectory::from_json(&again, &sledge("y")).unwrap_err().to_string();
    assert!(error.contains("'x'") && error.contains("'y'"), "{error}");
}

/// Two descriptions of one body, whose coordinates have the same names.
#[test]
fn a_motion_of_a_satellite_is_none_of_its_chain() {
    let body = LinkInertia::about_com(1.0, [0.0; 3], nalgebra::Matrix3::identity());
    let ball = Robot::builder("body").joint(JointSpec::spherical("ball").carrying(body)).build().unwrap();
    let chain = Robot::builder("body")
        .joint(JointSpec::revolute("ball_rx"))
        .joint(JointSpec::revolute("ball_ry").on("ball_rx").axis([0.0, 1.0, 0.0]))
        .joint(JointSpec::revolute("ball").on("ball_ry").axis([1.0, 0.0, 0.0]).carrying(body))
        .build()
        .unwrap();
    let motion = |robot: &Robot, q: Vec<f64>| {
        let mut solution = Solution::missing(robot, Status::MeshLimit, 1.0);
        let three = vec![vec![0.0; 3]; 2];
        let rows = [vec![q; 2], three.clone(), three.clone(), three.clone(), three.clone(), three];
        let trajectory = Trajectory::from_rows(vec![0.0, 1.0], rows);
        solution.trajectory = trajectory.with_free_joints(FreeEntries::of(robot));
        Solution::from_json(&solution.to_json().unwrap()).unwrap()
    };
    let (of_ball, of_chain) = (motion(&ball, vec![0.0, 0.0, 0.0, 1.0]), motion(&chain, vec![0.0; 3]));
    of_ball.check_robot(&ball).unwrap();
    of_chain.check_robot(&chain).unwrap();
    let text = |solution: &Solution| solution.to_json().unwrap();
    Trajectory::from_json(&text(&of_ball), &ball).unwrap();
    let alone = of_ball.trajectory.to_json(&of_ball.robot).unwrap();
    for error in [
        of_ball.check_robot(&chain).unwrap_err(),
        of_chain.check_robot(&ball).unwrap_err(),
        Trajectory::from_json(&text(&of_ball), &chain).unwrap_err(),
        Trajectory::from_json(&alone, &chain).unwrap_err(),
    ] {
        assert!(matches!(error, TrajectoryError::OtherFreeJoints { .. }), "{error}");
        assert!(error.to_string().contains("'ball' are quaternions"), "{error}");
    }
    assert!(matches!(
        Trajectory::from_json(&text(&of_chain), &ball).unwrap_err(),
        TrajectoryError::WrongLength { key: "q", found: 3, expected: 4, .. }
    ));
    let other = of_chain.check_robot(&sledge("x")).unwrap_err();
    assert!(
        matches!(other, TrajectoryError::OtherRobot { .. }) && other.to_string().contains("'x'"),
        "{other}"
    );
}

#[test]
fn what_is_no_motion_of_the_robot_is_refused_with_the_reason() {
    let (t, q, y) = ("[0,1]", "[[0],[1]]", "[[1,2],[3,4]]");
    for (text, reason) in [
        ("cost: 1".into(), "`costate optimize --save` wrote: not JSON (line 1, column 1)"),
        ("{\"format\":1".into(), "the text ends too early (line 1"),
        ("{\"format\":1}".into(), "the key `trajectory` is missing"),
        (text(t, q, y).replace("\"format\":1,", ""), "the key `format` is missing"),
        (text(t, "[[0],[null]]", y), "`q` holds null, not a number (line 1, column"),
        (
            text("[]", "[]", "[]").replace("[[0],[0.1]]", "[]").replace("[[1],[-1]]", "[]"),
            "no motion (status mesh_limit)",
        ),
        (text(t, q, y).replace("\"format\":1,", "\"format\":99,"), "update costate"),
        (text("[0]", q, y), "two finite times"),
        (text("[1,0]", q, y), "two finite times"),
        (text(t, "[[0]]", y), "`q` has 1 rows, and `t` has 2"),
        (text(t, "[[0,1],[1,2]]", y), "`q` (counted from 0) has 2 numbers; this robot needs 1"),
        (text(t, q, "[[1],[3]]"), "`y` (counted from 0) has 1 numbers; this robot needs 2"),
        (text(t, "[[0],[null]]", y), "null"),
    ] {
        let error = Trajectory::from_json(&text, &sledge("x")).unwrap_err();
        let message = format!("{error} {:?}", std::error::Error::source(&error));
        assert!(message.contains(reason), "{message}");
    }
}

#[test]
fn a_solution_without_times_has_no_rows_either() {
    let saved = |t: &str, q: &str, y: &str| text(t, q, y).replacen('{', "{\"final_time\":1,", 1);
    let empty = saved("[]", "[]", "[]").replace("[[0],[0.1]]", "[]").replace("[[1],[-1]]", "[]");
    assert!(serde_json::from_str::<Solution>(&empty).is_ok());
    let rows = empty.replace("\"q\":[]", "\"q\":[[1,2]]").replace("\"y\":[]", "\"y\":[[1]]");
    assert!(serde_json::from_str::<Solution>(&rows).is_err());
}

#[test]
fn motions_that_would_fill_the_memory_are_refused() {
    let rows = format!("[{}[]]", "[],".repeat(100_000));
    let error = Trajectory::from_json(&text("[0,1]", &rows, "[]"), &sledge("x")).unwrap_err();
    assert!(error.to_string().contains("at most 100000 entries"), "{error}");
    let error = Trajectory::from_json(&" ".repeat(Trajectory::MOST_BYTES + 1), &sledge("x")).unwrap_err();
    assert!(error.to_string().contains("more than 16777216 bytes"), "{error}");
}

#[test]
fn names_of_files_are_printable_in_messages() {
    let saved = text("[0,1]", "[[0],[1]]", "[[1,2],[3,4]]");
    let joints = saved.replacen('{', "{\"robot\":\"\\u001b[31m\",\"joints\":[\"\\u202e\"],", 1);
    let error = Trajectory::from_json(&joints, &sledge("x")).unwrap_err().to_string();
    assert!(error.contains(r"'\u{1b}[31m' with joints '\u{202e}'"), "{error}");
    let status = Status::try_from("evaluation_failed: \u{1b}[31m\u{202e}singular".to_owned()).unwrap();
    assert_eq!(status.to_string(), r"the dynamics could not be evaluated: \u{1b}[31m\u{202e}singular");
}
