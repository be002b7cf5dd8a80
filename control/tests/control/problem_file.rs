//! Problem files: every key, defaults, and errors.

use costate::robot::{Friction, JointSpec, LinkInertia, LoadOptions, Robot};
use costate_control::{
    BoundaryState, Bounds, Coordinates, FinalTime, JacobianRoute, Key, MachineCode, Method, Objective,
    Penalty, Polish, ProblemFile, ProblemFileCause, SolverOptions, Verify,
};

const LEAST: &str = "robot = \"two_link.toml\"\n[start]\nq = [0, 0]\n[end]\nq = [1, 1]\n[time]\nfinal = 2\n[cost]\n\
                     effort = [1, 1]\n";

/// Reads this text beside the robots of the repository.
fn read(text: &str) -> Result<ProblemFile, String> {
    ProblemFile::from_text(text, "../robots", LoadOptions::default()).map_err(|error| error.to_string())
}

#[test]
fn every_key_reaches_the_problem() {
    let text = "robot = \"two_link.toml\"\n[start]\nq = [0, 0.1]\nv = [0.2, 0.3]\nq_free = [1]\n\
                v_free = [\"elbow\", 0]\n\
                [end]\nq = [1, 1.1]\nv = [1.2, 1.3]\nq_free = [\"elbow\", 0]\nv_free = [\"shoulder\"]\n\
                [time]\nfree = true\nguess = 2\n\
                [cost]\ntime = 3\neffort = [2, 0]\n\
                [actuation]\ngain = [5, -6]\n\
                [bounds]\nu_min = [-inf, -8]\nu_max = [7.5, 8.5]\n\
                [penalty]\nweight = 9\nq_min = [-10, -11]\nq_max = [10, 11]\nv_max = [12, 13]\n\
                [start_from]\nfile = \"saved.json\"\n\
                [solver]\nstarts = 14\nthreads = 3\nmachine_code = \"at_once\"\nseed = 15\ntolerance = 1e-6\nnodes = 17\njacobian = \"without_hessian\"\n\
                method = \"shooting\"\ncoordinates = \"lagrangian\"\n";
    let ProblemFile { problem, options, start_from, .. } = read(text).unwrap();
    let (q, v) = (vec![0.0, 0.1], vec![0.2, 0.3]);
    assert_eq!(problem.start, BoundaryState::fixed(&q, &v).with_q_free(&[1]).with_v_free(&[0, 1]));
    let (q, v) = (vec![1.0, 1.1], vec![1.2, 1.3]);
    assert_eq!(problem.end, BoundaryState::fixed(&q, &v).with_q_free(&[0, 1]).with_v_free(&[0]));
    assert_eq!(problem.time, FinalTime::Free { guess: 2.0 });
    assert_eq!(problem.cost, Objective::new(3.0, vec![2.0, 0.0]));
    assert_eq!(problem.gain, [5.0, -6.0]);
    let bounds = Bounds::new(vec![f64::NEG_INFINITY, -8.0], vec![7.5, 8.5]);
    assert_eq!(problem.bounds, Some(bounds));
    let limits = Penalty::new(9.0).with_q_min(vec![-10.0, -11.0]).with_q_max(vec![10.0, 11.0]);
    assert_eq!(problem.penalty, Some(limits.with_v_max(vec![12.0, 13.0])));
    assert_eq!((options.starts, options.seed, options.tolerance, options.nodes), (Some(14), 15, 1e-6, 17));
    assert_eq!((options.jacobian, options.method), (JacobianRoute::WithoutHessian, Method::Shooting));
    assert_eq!((options.coordinates, options.threads), (Coordinates::Lagrangian, Some(3)));
    assert_eq!(options.machine_code, MachineCode::AtOnce);
    assert_eq!(start_from.unwrap(), std::path::Path::new("../robots/saved.json"));
}

#[test]
fn a_table_of_the_robot_changes_it() {
    let table = "[robot]\nfile = \"two_link.toml\"\ngravity = [0, 0, -1.5]\narmature = { elbow = 0.5 }\n\
                 friction = { elbow = { viscous = 0.25 } }\nlimits = { elbow = { upper = 2 } }\n\
                 lock = { shoulder = 0.5 }\n[[robot.payload]]\nframe = \"elbow\"\nmass = 2\ncom = [0.5, 0, 0]\n\
                 inertia = { xx = 0.1, yy = 0.2, zz = 0.2 }\n";
    let rest =
        LEAST.replace("robot = \"two_link.toml\"\n", "").replace("[0, 0]", "[0]").replace("[1, 1]", "[1]");
    let problem = read(&format!("{table}{rest}")).unwrap().problem;
    let whole = read(LEAST).unwrap().problem.robot;
    let [joint] = problem.robot.joints() else { panic!("{:?}", problem.robot.joints()) };
    assert_eq!((joint.name.as_str(), joint.friction.viscous, joint.limits.upper), ("elbow", 0.25, 2.0));
    assert_eq!((problem.robot.gravity().z, problem.robot.armature_entry(0, 0)), (-1.5, 0.5));
    assert!((joint.inertia.mass - whole.joints()[1].inertia.mass - 2.0).abs() < 1e-15);
    let reduced = table.replace("lock = { shoulder = 0.5 }", "reduced_to = [\"elbow\"]");
    assert_eq!(read(&format!("{reduced}{rest}")).unwrap().problem.robot.dof(), 1);
    for (from, to, message) in [
        (
            "shoulder = 0.5",
            "shouldr = 0.5",
            "problem:7: robot.lock: there is no joint 'shouldr'; did you mean 'shoulder'?",
        ),
        ("shoulder = 0.5", "shoulder = nan", "problem:7: robot.lock: "),
        (
            "shoulder = 0.5",
            "shoulder = \"far\"",
            "problem:7: robot.lock.shoulder: give a number, not the string",
        ),
        ("{ shoulder = 0.5 }", "3", "problem:7: robot.lock: give a table, not 3"),
        (
            "viscous = 0.25",
            "viscos = 1",
            "problem:5: robot.friction.elbow.viscos: unknown key; the keys here are `viscous`",
        ),
        ("viscous = 0.25", "viscous = -1", "problem:5: robot.friction: "),
        ("{ upper = 2 }", "2", "problem:6: robot.limits.elbow: give a table, not 2"),
        ("[0, 0, -1.5]", "[0, 0]", "problem:3: robot.gravity: give a list of 3 numbers, not a list of 2"),
        ("frame = \"elbow\"", "frame = \"tool\"", "problem:8: robot.payload: there is no frame 'tool'"),
        ("mass = 2", "", "problem:8: robot.payload.mass: missing; add it"),
        ("mass = 2", "mass = -2", "problem:8: robot.payload: the mass of the payload of frame 'elbow'"),
        ("file = ", "path = ", "problem:2: robot.path: unknown key; the keys here are `file`, `gravity`"),
        ("two_link.toml", "none.toml", "problem:2: robot.file: "),
        (
            "gravity",
            "floating_base = true\ngravity",
            "problem:3: robot.floating_base: has no effect on a robot",
        ),
        ("gravity", "quaternions = true\ngravity", "problem:3: robot.quaternions: has no effect on a robot"),
    ] {
        let error = read(&format!("{}{rest}", table.replacen(from, to, 1))).unwrap_err();
        assert!(error.starts_with(message), "{error}\n{message}");
    }
}

/// A floating joint of a URDF is one joint with a quaternion by a key, and six joints without it.
#[test]
fn floating_joints_have_quaternions_by_a_key() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("quaternions");
    std::fs::create_dir_all(&folder).unwrap();
    let link = |name: &str| {
        format!(
            "<link name=\"{name}\"><inertial><mass value=\"2\"/><inertia ixx=\"1\" iyy=\"2\" izz=\"2\" ixy=\"0\" \
             ixz=\"0\" iyz=\"0\"/></inertial></link>"
        )
    };
    let urdf = format!(
        "<robot name=\"wheel\"><link name=\"world\"/>{}{}<joint name=\"base\" type=\"floating\"><parent \
         link=\"world\"/><child link=\"body\"/></joint><joint name=\"wheel\" type=\"continuous\"><parent \
         link=\"body\"/><child link=\"rim\"/><axis xyz=\"0 0 1\"/></joint></robot>",
        link("body"),
        link("rim")
    );
    std::fs::write(folder.join("wheel.urdf"), urdf).unwrap();
    for (key, option, positions) in
        [("", false, 7), ("", true, 8), ("quaternions = true", false, 8), ("quaternions = false", true, 7)]
    {
        // The last entry of a unit quaternion is 1.
        let q = if positions == 8 { "[0, 0, 0, 0, 0, 0, 1, 0]" } else { "[0, 0, 0, 0, 0, 0, 0]" };
        let text = format!(
            "[robot]\nfile = \"wheel.urdf\"\ngravity = [0, 0, 0]\n{key}\n[start]\nq = {q}\n[end]\nq = {q}\n[time]\nfinal = 2\n\
             [cost]\neffort = [1, 1, 1, 1, 1, 1, 1]\n"
        );
        let load = LoadOptions::default().quaternions(option);
        let robot = ProblemFile::from_text(&text, &folder, load).unwrap().problem.robot;
        assert_eq!((robot.nq(), robot.dof()), (positions, 7), "{key} {option}");
    }
}

/// What a URDF says about friction counts by one key, and friction of any file is left out by one key.
#[test]
fn friction_is_switched_on_and_off() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("friction");
    std::fs::create_dir_all(&folder).unwrap();
    let urdf = "<robot name=\"rod\"><link name=\"base\"/><link name=\"rod\"><inertial><mass value=\"1\"/>\
                <origin xyz=\"1 0 0\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>\
                </inertial></link><joint name=\"pivot\" type=\"continuous\"><parent link=\"base\"/>\
                <child link=\"rod\"/><axis xyz=\"0 1 0\"/><dynamics damping=\"0.3\" friction=\"0.2\"/></joint></robot>";
    std::fs::write(folder.join("rod.urdf"), urdf).unwrap();
    let rest = "[start]\nq = [0]\n[end]\nq = [1]\n[time]\nfinal = 2\n[cost]\neffort = [1]\n";
    let text = |key: &str| format!("[robot]\nfile = \"rod.urdf\"\n{key}\n{rest}");
    for (key, option, viscous, coulomb) in [
        ("", false, 0.0, 0.0),
        ("", true, 0.3, 0.2),
        ("friction = true", false, 0.3, 0.2),
        ("friction = true", true, 0.3, 0.2),
        ("friction = false", true, 0.0, 0.0),
        ("friction = false\narmature = { pivot = 0.1 }", true, 0.0, 0.0),
        ("friction = { pivot = { viscous = 0.7 } }", true, 0.7, 0.0),
    ] {
        let load = LoadOptions::default().friction(option);
        let robot = ProblemFile::from_text(&text(key), &folder, load).unwrap().problem.robot;
        let friction = robot.joints()[0].friction;
        assert_eq!((friction.viscous, friction.coulomb), (viscous, coulomb), "{key} {option}");
    }
    let error = ProblemFile::from_text(&text("friction = 3"), &folder, LoadOptions::default()).unwrap_err();
    assert!(error.to_string().contains("robot.friction: give true, false or a table, not 3"), "{error}");
    // An error of another change has its own key.
    let wrong = text("friction = false\narmature = { pivo = 0.1 }");
    let error = ProblemFile::from_text(&wrong, &folder, LoadOptions::default()).unwrap_err();
    assert_eq!(error.key.as_deref(), Some("robot.armature"), "{error}");
    // The same for a robot of the caller.
    let robot = Robot::from_file("../robots/pendulum.toml").unwrap();
    let robot = robot.with_friction("pivot", Friction { viscous: 0.4, ..Friction::default() }).unwrap();
    for (key, viscous) in [("true", 0.4), ("false", 0.0)] {
        let text = format!("[robot]\nfriction = {key}\n{rest}");
        let found = ProblemFile::for_robot(&text, &robot, "").unwrap().problem.robot;
        assert_eq!(found.joints()[0].friction.viscous, viscous, "{key}");
    }
}

/// Frames and wrenches of the table are those of a robot file in the same words.
#[test]
fn frames_and_wrenches_of_the_table_are_those_of_a_robot_file() {
    let rows = "[[frame]]\nname = \"tip\"\nparent = \"joint:elbow\"\nplacement = { xyz = [0.4, 0, 0.1], rpy = [0, 0.3, 0] }\n\
                [[frame]]\nname = \"post\"\nparent = \"world\"\n\
                [[wrench]]\nframe = \"tip\"\nforce = [1, 2, -3]\naxes = \"aligned\"\n\
                [[wrench]]\nframe = \"elbow\"\nmoment = [0.5, 0, 2]\n";
    let file = std::fs::read_to_string("../robots/two_link.toml").unwrap();
    let expected = Robot::from_toml_str(&format!("{file}\n{rows}"), LoadOptions::default()).unwrap();
    let rest = LEAST.replace("robot = \"two_link.toml\"\n", "");
    let table = format!("[robot]\nfile = \"two_link.toml\"\n{}", rows.replace("[[", "[[robot."));
    let problem = read(&format!("{table}{rest}")).unwrap().problem;
    assert_eq!(problem.robot, expected);
    assert_eq!((problem.robot.frames().len(), problem.robot.wrenches().len()), (5, 2));
    let payload = "[[robot.payload]]\nframe = \"tip\"\nmass = 2\n";
    let loaded = read(&format!("{table}{payload}{rest}")).unwrap().problem.robot;
    assert!((loaded.joints()[1].inertia.mass - expected.joints()[1].inertia.mass - 2.0).abs() < 1e-15);
    for (from, to, message) in [
        (
            "\"joint:elbow\"",
            "\"joint:elbwo\"",
            "problem:3: robot.frame: there is no frame 'joint:elbwo'; did you mean 'joint:elbow'?",
        ),
        ("name = \"post\"", "name = \"tip\"", "problem:7: robot.frame: two frames are called 'tip'"),
        ("name = \"post\"", "", "problem:7: robot.frame.name: missing; add it"),
        ("rpy", "rp", "problem:6: robot.frame.placement.rp: unknown key; the keys here are `xyz`, `rpy`"),
        ("0.3", "nan", "problem:3: robot.frame: the placement of frame 'tip' is not"),
        (
            "frame = \"elbow\"",
            "frame = \"tipp\"",
            "problem:14: robot.wrench: there is no frame 'tipp'; did you mean 'tip'?",
        ),
        ("frame = \"elbow\"", "", "problem:14: robot.wrench.frame: missing; add it"),
        ("[1, 2, -3]", "[1, 2]", "problem:12: robot.wrench.force: give a list of 3 numbers, not a list of 2"),
        ("[1, 2, -3]", "[1, 2, inf]", "problem:10: robot.wrench: the wrench at frame 'tip' has a number"),
        (
            "\"aligned\"",
            "\"world\"",
            "problem:13: robot.wrench.axes: `world` is unknown; give `local`, `aligned`",
        ),
    ] {
        let error = read(&format!("{}{rest}", table.replacen(from, to, 1))).unwrap_err();
        assert!(error.starts_with(message), "{error}\n{message}");
    }
}

#[test]
fn missing_keys_have_their_documented_defaults() {
    let ProblemFile { problem, options, start_from, .. } = read(LEAST).unwrap();
    assert_eq!((&problem.start.v, &problem.end.v), (&vec![0.0; 2], &vec![0.0; 2]));
    assert_eq!((problem.end.q_free.len(), problem.end.v_free.len()), (0, 0));
    assert_eq!((problem.start.q_free.len(), problem.start.v_free.len()), (0, 0));
    let time = (problem.time, problem.cost.time);
    assert_eq!((time, problem.gain), ((FinalTime::Fixed(2.0), 0.0), vec![1.0; 2]));
    assert!(problem.bounds.is_none() && problem.penalty.is_none() && start_from.is_none());
    assert_eq!(options, SolverOptions::default());
}

#[test]
fn levels_of_verification_and_polish_are_read() {
    let verified = |text: &str| read(&format!("{LEAST}[solver]\n{text}\n")).unwrap().options;
    for (name, level) in [("full", Verify::Full), ("factors", Verify::Factors), ("none", Verify::None)] {
        assert_eq!(verified(&format!("verify = \"{name}\"")), SolverOptions::default().with_verify(level));
    }
    for (value, polish) in [("true", Polish::Always), ("false", Polish::Never), ("\"auto\"", Polish::Auto)] {
        let options = verified(&format!("method = \"direct\"\npolish = {value}"));
        assert_eq!(options, SolverOptions::default().with_polish(polish));
    }
}

/// The direct method estimates the error of the cost, the others that of each component.
#[test]
fn each_method_has_its_own_tolerance() {
    let tolerance = |text: &str| read(&format!("{LEAST}[solver]\n{text}\n")).unwrap().options.tolerance;
    assert_eq!(
        [tolerance(""), tolerance("method = \"collocation\""), tolerance("method = \"shooting\"")],
        [1e-4, 1e-6, 1e-6]
    );
    assert_eq!(tolerance("method = \"shooting\"\ntolerance = 1e-3"), 1e-3);
    let sharp = SolverOptions::default().with_tolerance(1e-9);
    assert_eq!(sharp.with_method(Method::Collocation).tolerance, 1e-9, "what was asked for stays");
    assert_eq!(SolverOptions::of(Method::Collocation).with_method(Method::Direct).tolerance, 1e-4);
}

#[test]
fn errors_have_line_key_and_cause() {
    for (from, to, message) in [
        ("final = 2", "final = 2\nfinal = 3", "problem:8: time.final: duplicate key; remove one of the two"),
        ("final = 2", "final = \"soon\"", "problem:7: time.final: give a number, not the string \"soon\""),
        ("final = 2", "free = 1", "problem:7: time.free: give true or false, not 1"),
        ("q = [0, 0]", "q = [0, true]", "problem:3: start.q: give a list of numbers, not true"),
        (
            "q = [0, 0]",
            "q = [0]",
            "problem:3: start.q: has 1 entry, the robot has 2 joints: give one entry for each joint",
        ),
        ("[cost]", "[costs]", "problem:8: costs: unknown key; the keys here are `robot`, `start`"),
        (
            "q = [0, 0]",
            "q = [0, 0]\nq_free = [\"wrist\"]",
            "problem:4: start.q_free: there is no joint 'wrist'; the joints are shoulder, elbow, or by index 0 to 1",
        ),
        (
            "[cost]",
            "[solver]\nnodes = -4\n[cost]",
            "problem:9: solver.nodes: give a whole number that is not negative",
        ),
        ("[cost]", "[solver]\ntolerance = 1\n[cost]", "problem:9: solver.tolerance: must be between"),
        ("two_link.toml", "none.toml", "problem:1: robot: "),
        ("[end]\nq = [1, 1]\n", "", "problem: end: missing; add it"),
        ("[time]", "[time", "problem:6: not TOML: "),
    ] {
        let error = read(&LEAST.replace(from, to)).unwrap_err();
        assert!(error.starts_with(message), "{error}\n{message}");
    }
    let error = ProblemFile::from_text("robot = 1", ".", LoadOptions::default()).unwrap_err();
    assert!(matches!(error.cause(), ProblemFileCause::WrongType { .. }));
    assert_eq!((error.line, error.key.as_deref(), error.path), (Some(1), Some("robot"), None));
    let file = read(&format!("{LEAST}[start_from]\nfile = \"x\"\n")).unwrap();
    assert_eq!(file.refuse(Key::START_FROM, "empty").to_string(), "problem:11: start_from.file: empty");
}

/// A number stands for all joints in costs, limits, bounds, penalties and gains; not in positions and rates.
#[test]
fn one_number_stands_for_all_joints() {
    let more = "[limits]\nv_max = 3\na_max = [4, 5]\njerk_max = 200\ntorque_max = 50.0\nfrom_robot = false\n\
                [actuation]\ngain = 2\n[bounds]\nu_min = -7\nu_max = 8\n";
    let problem = read(&format!("{}{more}", LEAST.replace("effort = [1, 1]", "effort = 0.5\njerk = 1e-3")))
        .unwrap()
        .problem;
    assert_eq!(problem.cost.effort, [0.5, 0.5]);
    assert_eq!((problem.cost.jerk, problem.gain), (Some(vec![1e-3; 2]), vec![2.0; 2]));
    assert_eq!(problem.bounds, Some(Bounds::new(vec![-7.0; 2], vec![8.0; 2])));
    let limits = problem.limits;
    assert_eq!((limits.v_max, limits.a_max), (Some(vec![3.0; 2]), Some(vec![4.0, 5.0])));
    assert_eq!((limits.jerk_max, limits.torque_max), (Some(vec![200.0; 2]), Some(vec![50.0; 2])));
    let soft = read(&format!("{LEAST}[penalty]\nweight = 1\nq_max = 9\nv_max = inf\n")).unwrap().problem;
    let penalty = Penalty::new(1.0).with_q_max(vec![9.0; 2]).with_v_max(vec![f64::INFINITY; 2]);
    assert_eq!(soft.penalty, Some(penalty));
    let error = read(&LEAST.replace("q = [0, 0]", "q = 0")).unwrap_err();
    assert_eq!(error, "problem:3: start.q: give a list of numbers, not 0");
    let error = read(&LEAST.replace("effort = [1, 1]", "effort = true")).unwrap_err();
    let expected =
        "problem:9: cost.effort: give a number for all joints, or a list with one for each, not true";
    assert_eq!(error, expected);
}

/// What flies or turns freely has no motors by a number that is meant for joints.
#[test]
fn one_torque_leaves_out_free_joints() {
    let body = LinkInertia::from_entries(2.0, [0.1, 0.0, 0.0], [0.1, 0.1, 0.1, 0.0, 0.0, 0.0]);
    let robot = Robot::builder("flyer")
        .joint(JointSpec::floating("base").carrying(body))
        .joint(JointSpec::revolute("arm").on("base").carrying(body))
        .build()
        .and_then(|robot| robot.with_gravity([0.0; 3]))
        .unwrap();
    let text = "start.q = [0, 0, 0, 0, 0, 0, 1, 0]\nend.q = [0, 0, 0, 0, 0, 0, 1, 1]\n\
                end.q_free = [\"base_x\", \"base_y\", \"base_z\", \"base_rx\", \"base_ry\", \"base\"]\ntime.final = 1\n\
                cost.effort = [0, 0, 0, 0, 0, 0, 1]\nlimits.torque_max = 5\n";
    let problem = ProblemFile::for_robot(text, &robot, "").unwrap().problem;
    assert_eq!(problem.limits.torque_max, Some(vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 5.0]));
}

/// A free time needs no guess: that of smooth ways within the limits.
#[test]
fn a_free_time_needs_no_guess() {
    let text = LEAST.replace("final = 2", "free = true").replace("effort = [1, 1]", "effort = 0\ntime = 1");
    let guess = |more: &str| match read(&format!("{text}{more}")).unwrap().problem.time {
        FinalTime::Free { guess } => guess,
        time => panic!("{time:?}"),
    };
    let none = "[limits]\nfrom_robot = false\n";
    // Peaks of the polynomial of degree five: 15/8 D/T, 10/sqrt 3 D/T^2, 60 D/T^3.
    let by_rate = guess(&format!("{none}v_max = [0.5, 1]\ntorque_max = 1e6\n"));
    assert!((by_rate - 15.0 / 8.0 / 0.5).abs() < 1e-12, "{by_rate}");
    let by_acceleration = guess(&format!("{none}a_max = 0.1\ntorque_max = 1e6\n"));
    assert!((by_acceleration - (10.0 / 3.0_f64.sqrt() / 0.1).sqrt()).abs() < 1e-12, "{by_acceleration}");
    let by_jerk = guess(&format!("{none}jerk_max = 0.06\ntorque_max = 1e6\n"));
    assert!((by_jerk - 10.0).abs() < 1e-12, "{by_jerk}");
    // Twice the torque beyond that of gravity: about the acceleration that it gives.
    let by_torque = guess(&format!("{none}torque_max = 40\n"));
    assert!((0.1..10.0).contains(&by_torque), "{by_torque}");
    assert!(guess("[bounds]\nu_min = -40\nu_max = 40\n") == by_torque);
    // Dearer efforts take longer: with the fourth root.
    let by_effort = |weight: &str| read(&text.replace("effort = 0", weight)).unwrap().problem.time.value();
    let ratio = by_effort("effort = 16") / by_effort("effort = 1");
    assert!((ratio - 2.0).abs() < 1e-12, "{ratio}");
}
