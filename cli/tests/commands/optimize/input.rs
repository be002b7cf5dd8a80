//! Wrong and impossible input: every key of limits, costs, times, tools and obstacles, with exit status,
//! line, key and culprit.

use super::missing::{Missing, WRONG, and, arm, with};

#[test]
fn lists_of_joints_of_a_wrong_form_are_named() {
    let mut missing = Missing::new("input_lists");
    let lists = [
        ("limits", "q_min"),
        ("limits", "q_max"),
        ("limits", "v_max"),
        ("limits", "a_max"),
        ("limits", "torque_max"),
        ("limits", "jerk_max"),
        ("limits", "torque_rate_max"),
        ("limits", "power_max"),
        ("limits", "corner_speed"),
        ("limits", "no_load_speed"),
        ("bounds", "u_min"),
        ("actuation", "gain"),
        ("cost", "jerk"),
        ("cost", "torque_rate"),
    ];
    for (table, key) in lists {
        let other = if key == "u_min" { "\nu_max = [9.0, 9.0]" } else { "" };
        // The table is there already, its header in line 8.
        let (text, line): (&dyn Fn(&str) -> String, usize) = match table {
            "cost" => (&|lines| with("[cost]", &format!("[cost]\n{lines}")), 9),
            _ => (&|lines| and(table, lines), 11),
        };
        let whole = format!("{table}.{key}: ");
        for (value, parts) in [
            ("[]", &["has 0 entries, the robot has 2 joints"][..]),
            ("[2.0]", &["has 1 entry, the robot has 2 joints"]),
            ("[2.0, 2.0, 2.0]", &["has 3 entries, the robot has 2 joints"]),
            ("[2.0, nan]", &["'elbow'"]),
            ("true", &["give a number for all joints, or a list with one for each, not true"]),
            ("\"2.0\"", &["give a number for all joints, or a list with one for each, not the string"]),
            (
                "[2.0, \"a\"]",
                &["give a number for all joints, or a list with one for each, not the string \"a\""],
            ),
            ("[[2.0, 2.0]]", &["give a number for all joints, or a list with one for each, not a list"]),
            ("{ elbow = 2.0 }", &["give a number for all joints, or a list with one for each, not a table"]),
        ] {
            let parts = [parts, &[&whole]].concat();
            missing.check(&text(&format!("{key} = {value}{other}")), WRONG, Some(line), &parts);
        }
    }
    for key in ["v_max", "a_max", "jerk_max", "torque_rate_max", "power_max", "corner_speed", "no_load_speed"]
    {
        for value in ["-1.0", "0.0", "-inf"] {
            let text = and("limits", &format!("{key} = [2.0, {value}]"));
            missing.check(&text, WRONG, Some(11), &[key, "'elbow' must be positive"]);
        }
    }
    let text = and("limits", "torque_max = [2.0, -1.0]");
    missing.check(&text, WRONG, Some(11), &["limits.torque_max", "-1 of joint 'elbow'"]);
}

#[test]
fn numbers_and_flags_of_limits_times_and_costs_are_checked() {
    let mut missing = Missing::new("input_numbers");
    for (value, parts) in [
        ("0.0", &["must be positive"][..]),
        ("-4", &["must be positive", "-4"]),
        ("nan", &["must be positive", "NaN"]),
        ("\"much\"", &["give a number, not the string \"much\""]),
        ("[1.0, 1.0]", &["give a number, not a list"]),
    ] {
        for (text, line, key) in [
            (and("limits", &format!("total_power_max = {value}")), 11, "limits.total_power_max: "),
            (with("final = 1.0", &format!("final = {value}")), 7, "time.final: "),
            (with("final = 1.0", &format!("free = true\nguess = {value}")), 8, "time.guess: "),
            (
                with("effort", &format!("energy = 1.0\nenergy_smoothing = {value}\neffort")),
                10,
                "cost.energy_smoothing: ",
            ),
        ] {
            missing.check(&text, WRONG, Some(line), &[parts, &[key]].concat());
        }
    }
    for value in ["-1.0", "nan", "inf"] {
        let negative = "neither negative nor infinite";
        let time = with("effort", &format!("time = {value}\neffort"));
        missing.check(&time, WRONG, Some(9), &["cost.time: ", negative]);
        let energy = with("effort", &format!("energy = {value}\neffort"));
        let parts: &[&str] = if value == "-1.0" { &["'shoulder'", negative] } else { &["'shoulder'"] };
        missing.check(&energy, WRONG, Some(9), &[parts, &["cost.energy: "]].concat());
        for key in ["effort", "jerk", "torque_rate"] {
            let text = with("[cost]", &format!("[cost]\n{key} = [1.0, {value}]"));
            let text = if key == "effort" { text.replace("\neffort = [1.0, 1.0]", "") } else { text };
            missing.check(&text, WRONG, Some(9), &[&format!("cost.{key}: "), "'elbow'"]);
        }
    }
    for (text, line, parts) in [
        (with("final = 1.0", "final = inf"), 7, &["time.final: ", "finite"][..]),
        (with("final = 1.0", "final = 1.0\nfre = true"), 8, &["time.fre: unknown key", "`free`"]),
        (with("final = 1.0", "free = \"yes\""), 7, &["time.free: give true or false"]),
        (with("final = 1.0", "free = false"), 6, &["time.final: missing"]),
        (with("effort = [1.0, 1.0]", "energy = [1.0]"), 9, &["cost.energy: ", "1 entry"]),
        (
            with("effort = [1.0, 1.0]", "energy = \"a\""),
            9,
            &["cost.energy: give a number for all joints, or a list with one for each"],
        ),
        (and("limits", "from_robot = 1"), 11, &["limits.from_robot: give true or false, not 1"]),
        (
            with("effort", "energy_smoothing = 2.0\neffort"),
            9,
            &["cost.energy_smoothing: has no effect without cost.energy"],
        ),
        (and("penalty", "weight = 1e300"), 11, &["penalty.weight: nothing is penalised"]),
        (and("limits", "vmax = [1.0, 1.0]"), 11, &["limits.vmax: unknown key", "`v_max`"]),
        (and("limit", "v_max = [1.0, 1.0]"), 10, &["limit: unknown key", "`limits`"]),
        (with("", "limits = 3"), 10, &["unknown key", "limits"]),
    ] {
        missing.check(&text, WRONG, Some(line), parts);
    }
}

#[test]
fn limits_that_contradict_each_other_or_the_ends_are_named() {
    let mut missing = Missing::new("input_contradictions");
    for (lines, line, parts) in [
        (
            "q_min = [-1.0, 2.0]\nq_max = [2.0, 1.0]",
            11,
            &["limits.q_min: joint 'elbow' has no room between 2 and 1"][..],
        ),
        ("q_min = [inf, 0.0]", 11, &["limits.q_min: ", "'shoulder'", "no room"]),
        ("q_max = [-inf, 1.0]", 11, &["limits.q_max: ", "'shoulder'", "no room"]),
        ("q_max = [0.9, 1.0]", 5, &["end.q: 1 of joint 'shoulder' lies outside of its limits", "0.9"]),
        ("q_min = [0.1, -1.0]", 3, &["start.q: 0 of joint 'shoulder' lies outside of its limits", "0.1"]),
        ("corner_speed = [2.0, 1.0]", 11, &["limits.corner_speed: ", "no_load_speed"]),
        (
            "torque_max = [9.0, 9.0]\ncorner_speed = [2.0, 5.0]\nno_load_speed = [3.0, 5.0]",
            12,
            &["limits.corner_speed: ", "'elbow'", "5"],
        ),
    ] {
        missing.check(&and("limits", lines), WRONG, Some(line), parts);
    }
    let fast = with("q = [1.0, 0.5]", "q = [1.0, 0.5]\nv = [0.0, 4.0]") + "[limits]\nv_max = [3.0, 3.0]\n";
    missing.check(&fast, WRONG, Some(6), &["end.v: 4 of joint 'elbow' lies outside of its limits, -3 and 3"]);
    let apart = and(
        "bounds",
        "u_min = [10.0, -9.0]\nu_max = [20.0, 9.0]\n[limits]\ntorque_max = [5.0, 9.0]\nfrom_robot = false",
    );
    missing.check(&apart, WRONG, Some(14), &["limits.torque_max: ", "'shoulder'", "10", "5"]);
    let other = and("limits", "v_max = [3.0, 3.0]\n[solver]\nmethod = \"shooting\"");
    missing.check(&other, WRONG, Some(13), &["solver.method: ", "\"direct\" only"]);
}

/// The same with a tool at the end, whose header is line 6.
fn reaching(tool: &str) -> String {
    arm("").replace("[time]", &format!("[end.tool]\n{tool}\n[time]"))
}

#[test]
fn tools_are_checked() {
    let mut missing = Missing::new("input_tools");
    let three = "give a list of 3 numbers";
    for (lines, line, parts) in [
        ("xyz = [0.4, 0.1, 0.3]", 6, &["end.tool.frame: missing"][..]),
        ("frame = \"tol0\"\nxyz = [0.4, 0.1, 0.3]", 7, &["no frame 'tol0'", "'tool0'"]),
        ("frame = 3\nxyz = [0.4, 0.1, 0.3]", 7, &["end.tool.frame: give a string, not 3"]),
        ("frame = \"\"\nxyz = [0.4, 0.1, 0.3]", 7, &["end.tool.frame: there is no frame ''"]),
        ("frame = \"tool0\"", 7, &["nothing is asked of the tool 'tool0'"]),
        ("frame = \"tool0\"\nxyz = []", 8, &["end.tool.xyz: ", three]),
        ("frame = \"tool0\"\nxyz = [0.4, 0.1]", 8, &["end.tool.xyz: ", three, "not a list of 2"]),
        ("frame = \"tool0\"\nxyz = \"here\"", 8, &["end.tool.xyz: ", "the string \"here\""]),
        ("frame = \"tool0\"\nxyz = [0.4, nan, 0.3]", 8, &["end.tool.xyz: must be finite"]),
        ("frame = \"tool0\"\nxyz = [0.4, -inf, 0.3]", 8, &["end.tool.xyz: must be finite"]),
        ("frame = \"tool0\"\noffset = [nan, 0, 0]\nxyz = [0.4, 0.1, 0.3]", 8, &["end.tool.offset: "]),
        ("frame = \"tool0\"\nrpy = [0, 0]", 8, &["end.tool.rpy: ", three]),
        ("frame = \"tool0\"\nrpy = [0, 0, inf]", 8, &["end.tool.rpy: must be finite"]),
        ("frame = \"tool0\"\naxis = [0, 0, 0]\nalong = [0, 0, 1]", 8, &["end.tool.axis: gives no direction"]),
        ("frame = \"tool0\"\nxyz = [0.4, 0.1, 0.3]\nweight = 1", 9, &["end.tool.weight: unknown key"]),
        // The links are 0.95 m long, a little more with the offsets of the wrist.
        (
            "frame = \"tool0\"\nxyz = [1.5, inf, 0.3]",
            8,
            &["end.tool.xyz: lies 1.5", "'shoulder_pan_joint'", "'tool0'", "m too far"],
        ),
        // Within the sphere of all links, but no position is there.
        ("frame = \"tool0\"\nxyz = [0.0, 0.0, 0.09]", 7, &["end.tool.frame: no position", "off by"]),
    ] {
        missing.check(&reaching(lines), WRONG, Some(line), parts);
    }
    for (lines, line, parts) in [
        ("[[cost.tool]]\nframe = \"tool0\"\nxyz = [1, 0, 1]\nposition_weight = -1", 13, &["-1"][..]),
        ("[[cost.tool]]\nframe = \"tool0\"\nxyz = [1, 0, 1]\nposition_weight = inf", 13, &["inf"]),
        ("[[cost.tool]]\nframe = \"tool0\"\nxyz = [1, 0, 1]\norientation_weight = nan", 13, &["NaN"]),
        ("[[cost.tool]]\nframe = \"tool0\"\nxyz = [1, 0, 1]\nposition_weight = \"x\"", 13, &["a number"]),
        (
            "[[cost.tool]]\nframe = \"tool0\"\nxyz = [1, 0, 1]\norientation_weight = 2",
            13,
            &["cost.tool.orientation_weight: weighs nothing without an orientation"],
        ),
        (
            "[[cost.reference]]\nframe = \"tool0\"\ntimes = [0]\npositions = [[1, 0, 1]]\n\
             orientation_weight = 2",
            14,
            &["cost.reference.orientation_weight: weighs nothing without orientations"],
        ),
        ("[[keep]]\nframe = \"tool0\"", 10, &["keep.kind: missing"]),
        ("[[keep]]\nkind = \"plan\"\nframe = \"tool0\"", 11, &["`plan` is unknown", "`plane`"]),
        ("[[keep]]\nkind = \"speed\"\nframe = \"tool0\"\nspeed = -1", 13, &["keep.speed: ", "-1"]),
        ("[[keep]]\nkind = \"speed\"\nframe = \"tool0\"\nspeed = [1]", 13, &["keep.speed: give a number"]),
        (
            "[[keep]]\nkind = \"axis\"\nframe = \"tool0\"\nalong = [0, 0, 1]\nangle = nan",
            14,
            &["keep.angle: ", "NaN"],
        ),
        (
            "[[keep]]\nkind = \"box\"\nframe = \"tool0\"\nmin = [0, 0, 1]\nmax = [1, 1, 0]",
            14,
            &["keep.max: ", "0"],
        ),
        (
            "[[keep]]\nkind = \"box\"\nframe = \"tool0\"\nmin = [nan, 0, 1]\nmax = [1, 1, 2]",
            13,
            &["keep.min: "],
        ),
        (
            "[[keep]]\nkind = \"box\"\nframe = \"tool0\"\nmin = [-2, -2, 2]\nmax = [2, 2, 3]",
            3,
            &["start.q: ", "z of the tool 'tool0'", "off by"],
        ),
    ] {
        missing.check(&arm(lines), WRONG, Some(line), parts);
    }
}

#[test]
fn obstacles_and_bodies_are_checked() {
    let mut missing = Missing::new("input_obstacles");
    let bodies = "[collision]\ncapsules = \"auto\"\nradius = 0.05\n";
    let sphere = |xyz: &str, radius: &str| {
        format!("[[obstacle]]\nkind = \"sphere\"\nxyz = {xyz}\nradius = {radius}\n")
    };
    for (text, line, parts) in [
        (sphere("[0, 0, 3]", "0.1"), 11, &["obstacle.kind: ", "no bodies"][..]),
        (sphere("[0, 0, 3]", "0") + bodies, 13, &["obstacle.radius: must be positive"]),
        (sphere("[0, 0, 3]", "-1") + bodies, 13, &["obstacle.radius: must be positive", "-1"]),
        (sphere("[0, 0, 3]", "nan") + bodies, 13, &["obstacle.radius: must be positive"]),
        (sphere("[0, 0, 3]", "inf") + bodies, 13, &["obstacle.radius: must be positive"]),
        (sphere("[0, 0, 3]", "\"big\"") + bodies, 13, &["obstacle.radius: give a number"]),
        (sphere("[0, 0]", "0.1") + bodies, 12, &["obstacle.xyz: give a list of 3 numbers"]),
        (sphere("[0, inf, 0]", "0.1") + bodies, 12, &["obstacle.xyz: must be finite"]),
        (sphere("[0, 0, 3]", "0.1") + "size = [1, 1, 1]\n" + bodies, 14, &["obstacle.size: unknown key"]),
        (sphere("[0, 0, 3]", "0.1").replace("sphere", "ball") + bodies, 11, &["`ball` is unknown"]),
        // In the way at the start.
        (
            sphere("[0.0, 0.0, 0.1]", "0.3") + bodies,
            3,
            &["start.q: the clearance of 'upper_arm_link' from 'obstacle 1'", "off by"],
        ),
        (bodies.replace("0.05", "0"), 12, &["collision.radius: must be positive"]),
        (bodies.replace("0.05", "nan"), 12, &["collision.radius: must be positive"]),
        (format!("{bodies}margin = nan\n"), 13, &["collision.margin: "]),
        (format!("{bodies}pairs = [[\"hand\", \"floor\"]]\n"), 13, &["nothing is called 'hand'"]),
        (format!("{bodies}except = [[\"floor\"]]\n"), 13, &["collision.except: give a list of pairs"]),
        (
            format!("{bodies}[[collision.capsule]]\nframe = \"tool0\"\nradius = -0.1\n"),
            15,
            &["collision.capsule.radius: ", "-0.1"],
        ),
    ] {
        missing.check(&arm(&text), WRONG, Some(line), parts);
    }
}
