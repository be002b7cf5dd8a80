//! Wrong values of the keys that `input` leaves: robot, solver, ends, vias, periodic motions.

use super::missing::{IMPOSSIBLE, Missing, WRONG, and, arm, with};
use super::{json, optimize, robot, two_link};
use crate::child::stderr;

/// The two-link arm with a table of changes, whose line is 3.
fn changed(line: &str) -> String {
    let file = robot("two_link.toml");
    let own = format!("robot = \"{file}\"\n");
    two_link().replace(&own, &format!("[robot]\nfile = \"{file}\"\n{line}\n"))
}

#[test]
fn changes_of_the_robot_are_checked() {
    let mut missing = Missing::new("keys_robot");
    let near = "did you mean 'elbow'?";
    for (line, parts) in [
        ("gravity = [0, 0]", &["robot.gravity: give a list of 3 numbers"][..]),
        ("gravity = [0, 0, nan]", &["robot.gravity: ", "not finite"]),
        ("gravity = [0, 0, 1e80]", &["robot.gravity: ", "1e75"]),
        ("armature = { elbow = 1e200 }", &["robot.armature: ", "'elbow' is 1e200", "1e75"]),
        ("limits = { elbow = { lower = nan } }", &["robot.limits: ", "'elbow' is NaN", "give a number"]),
        ("armature = 3", &["robot.armature: give a table, not 3"]),
        ("armature = { elbo = 1 }", &["robot.armature: ", "'elbo'", near]),
        ("armature = { elbow = \"a\" }", &["robot.armature.elbow: give a number"]),
        ("armature = { elbow = -1 }", &["'elbow' is -1"]),
        ("friction = { elbo = { viscous = 1 } }", &["robot.friction: ", near]),
        ("friction = 3", &["robot.friction: give true, false or a table, not 3"]),
        ("friction = \"on\"", &["robot.friction: give true, false or a table, not the string"]),
        ("friction = { elbow = 3 }", &["robot.friction.elbow: give a table"]),
        ("friction = { elbow = { viscous = -1 } }", &["viscous friction of joint 'elbow' is -1"]),
        ("friction = { elbow = { visc = 1 } }", &["robot.friction.elbow.visc: unknown key", "`viscous`"]),
        ("limits = { elbo = { lower = 0 } }", &["robot.limits: ", near]),
        ("limits = { elbow = { lower = 2, upper = 1 } }", &["lower limit of joint 'elbow' is 2"]),
        ("limits = { elbow = { lower = \"a\" } }", &["robot.limits.elbow.lower: give a number"]),
        ("limits = { elbow = { effort = -1 } }", &["effort limit of joint 'elbow' is -1"]),
        ("limits = { elbow = { effor = 1 } }", &["robot.limits.elbow.effor: unknown key", "`effort`"]),
        ("lock = { elbo = 1 }", &["robot.lock: ", near]),
        ("lock = { elbow = nan }", &["robot.lock: ", "'elbow'", "finite"]),
        ("lock = { elbow = 0, shoulder = 0 }", &["robot.lock: ", "leave at least one"]),
        ("lock = [\"elbow\"]", &["robot.lock: give a table, not a list"]),
        ("reduced_to = [\"elbo\"]", &["robot.reduced_to: ", near]),
        ("reduced_to = [1]", &["robot.reduced_to: give a list of names of joints, not 1"]),
        ("reduced_to = []", &["robot.reduced_to: ", "leave at least one"]),
        ("frame = { name = \"a\", parent = \"elbo\" }", &["robot.frame: ", "'elbo'", near]),
        ("frame = { parent = \"elbow\" }", &["robot.frame.name: missing"]),
        ("frame = { name = \" \" }", &["robot.frame: ", "a frame is called ' '", "not blank"]),
        ("frame = { name = \"elbow\" }", &["robot.frame: two frames are called 'elbow'"]),
        (
            "frame = { name = \"a\", placement = { xyz = [0] } }",
            &["robot.frame.placement.xyz: give a list of 3"],
        ),
        ("payload = { frame = \"elbo\", mass = 1 }", &["robot.payload: ", near]),
        ("payload = { frame = \"elbow\" }", &["robot.payload.mass: missing"]),
        ("payload = { frame = \"elbow\", mass = -1 }", &["the payload of frame 'elbow' is -1 kg"]),
        ("payload = { frame = \"world\", mass = 1 }", &["robot.payload: no joint moves frame 'world'"]),
        (
            "payload = { frame = \"elbow\", mass = 1, inertia = { xx = -1 } }",
            &["the payload of frame 'elbow'", "negative principal moment -1"],
        ),
        ("wrench = { frame = \"elbo\", force = [1, 0, 0] }", &["robot.wrench: ", near]),
        ("wrench = { frame = \"elbow\", force = [1, 0, nan] }", &["robot.wrench: ", "'elbow'", "finite"]),
        (
            "wrench = { frame = \"elbow\", axes = \"local\" }",
            &["robot.wrench.frame: has no effect without a force or a moment"],
        ),
        (
            "wrench = { frame = \"elbow\", axes = \"worl\" }",
            &["robot.wrench.axes: `worl` is unknown", "`aligned`"],
        ),
        ("colour = 3", &["robot.colour: unknown key", "`gravity`"]),
    ] {
        missing.check(&changed(line), WRONG, Some(3), parts);
    }
    let file = format!("file = \"{}\"", robot("two_link.toml"));
    let nowhere = changed("gravity = [0, 0, -1]").replace(&file, "file = \"nowhere.urdf\"");
    missing.check(&nowhere, WRONG, Some(2), &["robot.file: ", "nowhere.urdf: does not exist"]);
    for (line, parts) in [
        ("robot = 3", &["robot: give a string, not 3"][..]),
        ("robot = \"nowhere.urdf\"", &["robot: ", "nowhere.urdf: does not exist", "check the path"]),
        ("robot = \".\"", &["robot: ", "is a folder"]),
    ] {
        let own = format!("robot = \"{}\"", robot("two_link.toml"));
        missing.check(&with(&own, line), WRONG, Some(1), parts);
    }
}

#[test]
fn options_of_the_solver_are_checked() {
    let mut missing = Missing::new("keys_solver");
    let whole = "give a whole number that is not negative";
    for key in ["starts", "threads", "seed", "nodes", "max_nodes"] {
        for value in ["\"a\"", "-1", "nan", "1.5", "[1]", "true"] {
            let text = and("solver", &format!("{key} = {value}"));
            missing.check(&text, WRONG, Some(11), &[&format!("solver.{key}: "), whole]);
        }
    }
    for (line, parts) in [
        ("starts = 0", &["solver.starts: must be between 1 and 1000000, but is 0"][..]),
        ("threads = 0", &["solver.threads: must be between 1 and 1024, but is 0"]),
        ("nodes = 2", &["solver.nodes: must be 3 or more, but is 2"]),
        ("nodes = 7000", &["solver.nodes: ", "solver.max_nodes", "6001", "7000"]),
        ("max_nodes = 20", &["solver.max_nodes: must be at least solver.nodes", "but is 20"]),
        ("max_nodes = 2000000", &["solver.max_nodes: must be at most 1000000"]),
        ("tolerance = 0.2", &["solver.tolerance: must be between", "but is 0.2"]),
        ("tolerance = nan", &["solver.tolerance: must be between", "but is NaN"]),
        ("tolerance = \"a\"", &["solver.tolerance: give a number"]),
        ("time_limit = nan", &["solver.time_limit: must be a positive number of seconds"]),
        ("method = \"best\"", &["solver.method: `best` is unknown", "`direct`"]),
        ("method = [\"direct\"]", &["solver.method: give a string, not a list"]),
        ("machine_code = true", &["solver.machine_code: give a string, not true"]),
        ("machine_code = \"now\"", &["solver.machine_code: `now` is unknown", "`at_once`"]),
        ("coordinates = \"q\"", &["solver.coordinates: `q` is unknown", "`lagrangian`"]),
        ("polish = 1", &["solver.polish: give true, false or \"auto\", not 1"]),
        ("max_iterations = 5", &["solver.max_iterations: unknown key", "`starts`"]),
        ("jacobian = \"exact\"\npolish = false", &["solver.jacobian: has no effect on the direct method"]),
        ("coordinates = \"qv\"\npolish = false", &["solver.coordinates: has no effect", "solver.method"]),
    ] {
        missing.check(&and("solver", line), WRONG, Some(11), parts);
    }
}

#[test]
fn ends_vias_and_periodic_motions_are_checked() {
    let mut missing = Missing::new("keys_ends");
    let start = |line: &str| with("q = [0.0, 0.0]", &format!("q = [0.0, 0.0]\n{line}"));
    for (line, parts) in [
        ("q_free = [\"elbo\"]", &["start.q_free: there is no joint 'elbo'; did you mean 'elbow'?"][..]),
        ("q_free = [0, \"shoulder\"]", &["start.q_free: joint 'shoulder' is listed twice"]),
        ("q_free = [-1]", &["start.q_free: give a list of joints"]),
        ("v_free = \"elbow\"", &["start.v_free: give a list of joints", "not the string"]),
        ("v = 3", &["start.v: give a list of numbers, not 3"]),
        ("a = [0.0]", &["start.a: has 1 entry, the robot has 2 joints"]),
        ("a = [nan, 0.0]", &["start.a: the entry of joint 'shoulder' is not finite"]),
        ("a = [1e9, 0.0]", &["start.a: ", "'shoulder' need a torque of 6.667e9, beyond the limit 1"]),
        ("tool = 3", &["start.tool: give a table, not 3"]),
        ("tool = [3]", &["start.tool: give tables, not 3"]),
    ] {
        missing.check(&start(line), WRONG, Some(4), parts);
    }
    for (line, place, parts) in [
        ("q = [1.0]", 11, &["via 1, q: has 1 entry"][..]),
        ("q = [0.5, 0.2]\nq_free = [\"elbo\"]", 12, &["via 1, q_free: ", "did you mean 'elbow'?"]),
        ("time = 0.5", 10, &["via 1, q: nothing is asked of it", "stop = true"]),
        ("q = [0.5, 0.2]\ntime = 2.0", 12, &["via 1, time: the time 2 s is not before the final time"]),
        ("q = [0.5, 0.2]\ntime = -1.0", 12, &["via 1, time: ", "-1 s"]),
        ("q = [0.5, 0.2]\ntime = nan", 12, &["via 1, time: ", "NaN s"]),
        ("stop = 1", 11, &["via.stop: give true or false"]),
        ("stop = true\nv = [0.0, 0.0]", 11, &["via 1, stop: ", "remove v or stop"]),
        ("stop = true\npayload = { frame = \"elbo\", mass = 1 }", 12, &["via 1, payload: ", "'elbow'"]),
        ("stop = true\npayload = { frame = \"elbow\", mass = -1 }", 12, &["via 1, payload: ", "-1 kg"]),
        ("q = [1.0, 0.2]\nspeed = 1", 12, &["via.speed: unknown key", "`stop`"]),
    ] {
        missing.check(&with("", &format!("[[via]]\n{line}")), WRONG, Some(place), parts);
    }
    let late = "[[via]]\nq = [0.3, 0.1]\ntime = 0.6\n[[via]]\nq = [0.5, 0.2]\ntime = 0.4";
    missing.check(&with("", late), WRONG, Some(15), &["via 2, time: ", "0.4 s", "0.6 s"]);
    let periodic = |line: &str| with("[end]\nq = [1.0, 0.5]\n", "") + &format!("[periodic]\n{line}\n");
    for (line, parts) in [
        ("shift = [1.0]", &["periodic.shift: has 1 entry"][..]),
        ("shift = [nan, 0.0]", &["periodic.shift: ", "'shoulder'"]),
        ("shift = 3", &["periodic.shift: give a list of numbers, not 3"]),
        ("shft = [1.0, 0.0]", &["periodic.shft: unknown key", "`shift`"]),
    ] {
        missing.check(&periodic(line), WRONG, Some(9), parts);
    }
    let both = with("", "[periodic]");
    missing.check(&both, WRONG, Some(4), &["end: ", "remove [end] or [periodic]"]);
}

#[test]
fn messages_name_what_helps() {
    let mut missing = Missing::new("keys_remedies");
    for (text, line, parts) in [
        (
            and("limits", "torque_max = [2.0, -1.0]"),
            11,
            &["'elbow' must be positive, or 0 for a joint without a motor; inf is no limit"][..],
        ),
        (and("limits", "total_power_max = 0"), 11, &["total_power_max: the limit 0 must be positive; inf"]),
        (
            with("effort = [1.0, 1.0]", "energy = [1.0, \"a\"]"),
            9,
            &["cost.energy: give a number for all joints, or a list with one for each, not the string \"a\""],
        ),
        (
            with("effort = [1.0, 1.0]", "effort = [1.0, 0.0]"),
            9,
            &["'elbow'", "bounds.u_min and bounds.u_max", "limits.torque_max"],
        ),
        (
            changed("limits = { elbow = { effort = 0 } }") + "[limits]\nv_max = [9.0, 9.0]\n",
            12,
            &["limits.torque_max: ", "effort of joint 'elbow' to 0", "robot.limits"],
        ),
        (
            with("final = 1.0", "free = true\nguess = 1.0"),
            7,
            &["time.free: a free final time needs cost.time > 0 or [[cost.tool]]"],
        ),
        (
            with("q = [1.0, 0.5]", "q = [0.0, 0.0]")
                .replace("final = 1.0", "free = true\nguess = 1.0")
                .replace("effort", "time = 1.0\neffort"),
            7,
            &["time.free: the robot rests at its end from the start on", "[[via]]"],
        ),
        (
            arm("[[keep]]\nkind = \"box\"\nframe = \"tool0\"\n"),
            12,
            &["keep.frame: nothing is asked of the tool 'tool0': give min or max"],
        ),
        (
            arm("[[obstacle]]\nkind = \"half_space\"\nxyz = [0, 0, 0.5]\nnormal = [0, 0, 1]\n\
                 [collision]\ncapsules = \"auto\"\nradius = 0.05\n"),
            3,
            &["start.q: the clearance of", "from 'obstacle 1' is off by 0.4608 m; "],
        ),
    ] {
        missing.check(&text, WRONG, Some(line), parts);
    }
    let slow = and("limits", "torque_max = [1.0, 1.0]\nfrom_robot = false");
    missing.check(&slow, IMPOSSIBLE, None, &["another guess (solver.starts)"]);
    // More limits of the arm give than a sentence holds.
    let weak = arm("[limits]\nfrom_robot = false\ntorque_max = [3, 3, 3, 0.03, 0.03, 0.03]\n");
    missing.check(
        &weak.replace("final = 1.0", "final = 0.1"),
        IMPOSSIBLE,
        None,
        &["of joint 'shoulder_pan_joint' is", "more are exceeded too", "--json"],
    );
}

/// Of the limits of a joint those change that are given.
#[test]
fn limits_of_the_robot_that_are_not_given_stay() {
    // So fast that the joint exceeds its rate, which nobody asks to keep where u has bounds.
    let bounds = format!("[bounds]\nu_min = {:?}\nu_max = {:?}\n", [-f64::INFINITY; 6], [f64::INFINITY; 6]);
    let ur5 = arm(&bounds).replacen("robot = ", "[robot]\nfile = ", 1).replace("final = 1.0", "final = 0.2");
    let with_limits = |line: &str| ur5.replacen("[start]", &format!("{line}\n[start]"), 1);
    let limits = "limits = { shoulder_lift_joint = { lower = -1.0, upper = 1.0 } }";
    let output = optimize("keys_limits", &with_limits(limits), &["--json", "--time-limit", "20"]);
    // The rate of the file is compared with the motion, and its start is beyond the new range.
    let message = stderr(&output);
    let words = "position of joint 'shoulder_lift_joint' runs from";
    assert!(message.contains(words) && message.contains("its limits are -1 and 1"), "{message}");
    assert!(message.contains("velocity of joint 'shoulder_lift_joint'"), "{message}");
    let free = "limits = { shoulder_lift_joint = { velocity = inf } }";
    let output = optimize("keys_limits", &with_limits(free), &["--json", "--time-limit", "20"]);
    assert!(!stderr(&output).contains("velocity of joint 'shoulder_lift_joint'"), "{}", stderr(&output));
}

/// The number of starts of the file, or of the command line.
#[test]
fn several_starts_are_asked_for() {
    let found = |text: &str, more: &[&str]| {
        let found = json(&optimize("keys_starts", text, &[&["--json", "--verify", "none"], more].concat()));
        (found["starts"].as_array().unwrap().len(), found["options"]["starts"].as_u64().unwrap())
    };
    let text = and("solver", "starts = 2");
    assert_eq!(found(&text, &[]), (2, 2));
    assert_eq!(found(&text, &["--starts", "3"]), (3, 3));
    for (value, part) in [("0", "1 or more"), ("some", "1 or more"), ("2000000", "between 1 and 1000000")] {
        let output = optimize("keys_starts", &text, &["--starts", value]);
        assert_eq!(output.status.code(), Some(2), "{value}");
        assert!(stderr(&output).contains("starts") && stderr(&output).contains(part), "{}", stderr(&output));
    }
}

/// An empty list of tools is none: the end stays given.
#[test]
fn an_empty_list_of_tools_frees_no_joint() {
    let cost = |text: &str| json(&optimize("keys_tools", text, &["--json"]))["cost"].as_f64().unwrap();
    let given = cost(&two_link());
    let empty = cost(&with("q = [1.0, 0.5]", "q = [1.0, 0.5]\ntool = []"));
    assert!((given - empty).abs() <= 1e-9 * given, "{given} {empty}");
}
