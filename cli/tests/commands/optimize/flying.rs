//! Robots with floating joints: what is written and drawn of their motions, and what is refused.

use super::missing::{IMPOSSIBLE, WRONG};
use super::{empty_folder, json, names, optimize};
use crate::child::{stderr, stdout};

/// A body with a wheel about its axis z; the wheel alone has a motor.
const ROBOT: &str = "name = \"wheel\"\ngravity = [0, 0, 0]\nconvention = \"placements\"\n\
    [[joint]]\nname = \"base\"\ntype = \"floating\"\nmass = 10\ninertia = { xx = 2, yy = 3, zz = 4 }\n\
    [[joint]]\nname = \"wheel\"\nparent = \"base\"\nmass = 1\ninertia = { xx = 0.1, yy = 0.1, zz = 0.2 }\n";
const PROBLEM: &str = "robot = \"wheel.toml\"\n[start]\nq = [0, 0, 0, 0, 0, 0, 1, 0]\n[end]\n\
    q = [0, 0, 0, 0, 0, 0.6, 0.8, 0]\nq_free = [\"base_x\", \"base_y\", \"base_z\", \"wheel\"]\n\
    [time]\nfinal = 2.0\n[cost]\neffort = [1, 1, 1, 1, 1, 1, 1]\n";

#[test]
fn motions_of_a_satellite_are_written_and_drawn() {
    let folder = empty_folder("flying");
    std::fs::write(folder.join("wheel.toml"), ROBOT).unwrap();
    let [csv, page, saved, figures] = ["samples.csv", "page.html", "saved.json", "figures"]
        .map(|name| folder.join(name).to_str().unwrap().to_owned());
    let sharp = format!("{PROBLEM}[solver]\ntolerance = 1e-6\n");
    let output =
        optimize("flying", &sharp, &["--json", "--sample", "10", "--sample-to", &csv, "--save", &saved]);
    assert!(output.status.success(), "{}", stderr(&output));
    let solution = json(&output);
    // 6 I^2 angle^2/T^3 with I = 4 and the angle 2 asin 0.6.
    let cost = 6.0 * 16.0 * (2.0 * 0.6_f64.asin()).powi(2) / 8.0;
    assert!((solution["cost"].as_f64().unwrap() / cost - 1.0).abs() < 1e-6, "{}", solution["cost"]);
    assert_eq!(solution["free_joints"][0]["name"], "base");
    let row = |key: &str| solution["trajectory"][key][0].as_array().unwrap().len();
    assert_eq!(["q", "v", "p", "u", "y"].map(row), [8, 7, 7, 7, 14]);
    assert_eq!(solution["samples"]["positions"][6], "base_qw");
    let csv = std::fs::read_to_string(&csv).unwrap();
    assert!(csv.starts_with("t,q_base_x,q_base_y,q_base_z,q_base_qx,"), "{csv}");
    assert!(csv.lines().count() == 22 && csv.lines().all(|line| line.split(',').count() == 37));
    let drawn = optimize("flying", PROBLEM, &["-o", &page, "--svg", &figures]);
    assert!(drawn.status.success(), "{}", stderr(&drawn));
    let page_text = std::fs::read_to_string(&page).unwrap();
    for part in
        ["\"kind\":\"quaternion\"", "\"name\":\"base_qw\"", "\"name\":\"base_rx\"", "\"kind\":\"box\""]
    {
        assert!(page_text.contains(part), "{part}");
    }
    let figure = |name: &str| std::fs::read_to_string(folder.join("figures").join(name)).unwrap();
    // Eight entries of q; rates are of the seven coordinates.
    assert!(figure("positions.svg").contains("base_qw") && !figure("rates.svg").contains("base_qw"));
    let strobes = names(&folder.join("figures")).into_iter().filter(|name| name.starts_with("strobe_"));
    let strobes: Vec<String> = strobes.map(|name| figure(&name)).collect();
    assert!(!strobes.is_empty());
    // A body and its wheel, at least at the start and at the end.
    assert!(strobes.iter().all(|svg| svg.matches("<circle").count() >= 4 && !svg.contains("NaN")));
    let again = format!("{PROBLEM}[start_from]\nfile = \"saved.json\"\n");
    let again = optimize("flying", &again, &[]);
    let table = stdout(&again);
    assert!(again.status.success() && table.contains("converged") && table.contains("end defect"), "{table}");
    for (more, reason) in [
        (&["--continue", "final_time=2:3"][..], "joint 'base' is floating, its orientation a quaternion"),
        (&["--sample", "10", "--feedback", &page], "joint 'base' is floating"),
        (&["--sensitivities"], "joint 'base' is floating"),
    ] {
        let output = optimize("flying", PROBLEM, more);
        assert!(stderr(&output).contains(reason), "{more:?}: {}", stderr(&output));
    }
    let long = PROBLEM.replace("0.6, 0.8", "0.6, 0.9");
    let output = optimize("flying", &long, &[]);
    assert_eq!(output.status.code(), Some(WRONG));
    let message = stderr(&output);
    assert!(message.contains("end.q") && message.contains("has length 1.08"), "{message}");
}

/// A motor that is too weak is named with what it lacks; rotors would not help.
#[test]
fn what_a_satellite_cannot_do_is_told() {
    let folder = empty_folder("flying_weak");
    std::fs::write(folder.join("wheel.toml"), ROBOT).unwrap();
    let weak = format!("{PROBLEM}[limits]\ntorque_max = [0, 0, 0, 0, 0, 0, 0.5]\n");
    let output = optimize("flying_weak", &weak, &[]);
    assert_eq!(output.status.code(), Some(IMPOSSIBLE), "{}", stderr(&output));
    let table = stdout(&output).replace("\n", " ");
    for part in
        ["limits not kept", "the torque of joint 'wheel' would have to be", "instead of", "raise time.final"]
    {
        assert!(table.contains(part), "{part}: {table}");
    }
    assert!(!table.contains("armature"), "{table}");
}

/// The keys of the file do what the options do.
#[test]
fn the_base_flies_by_a_key_as_by_an_option() {
    let folder = empty_folder("flying_key");
    let inertia = |mass: f64, [x, y, z]: [f64; 3]| {
        format!(
            "<inertial><mass value=\"{mass}\"/><inertia ixx=\"{x}\" iyy=\"{y}\" izz=\"{z}\" ixy=\"0\" \
             ixz=\"0\" iyz=\"0\"/></inertial>"
        )
    };
    let urdf = format!(
        "<robot name=\"wheel\"><link name=\"base\">{}</link><link name=\"rim\">{}</link>\
         <joint name=\"wheel\" type=\"continuous\"><parent link=\"base\"/><child link=\"rim\"/>\
         <axis xyz=\"0 0 1\"/></joint></robot>",
        inertia(10.0, [2.0, 3.0, 4.0]),
        inertia(1.0, [0.1, 0.1, 0.2])
    );
    std::fs::write(folder.join("wheel.urdf"), urdf).unwrap();
    let of = |keys: &str| {
        let free = ["x", "y", "z"].map(|axis| format!("\"root_joint_{axis}\"")).join(", ");
        let robot = format!("[robot]\nfile = \"wheel.urdf\"\ngravity = [0, 0, 0]\n{keys}");
        let problem = PROBLEM.replace("robot = \"wheel.toml\"\n", &robot);
        problem.replace("\"base_x\", \"base_y\", \"base_z\"", &free)
    };
    let by_key = optimize("flying_key", &of("floating_base = true\n"), &["--json"]);
    let by_option = optimize("flying_key", &of(""), &["--json", "--floating-base"]);
    assert!(by_key.status.success() && by_option.status.success(), "{}", stderr(&by_key));
    let [by_key, by_option] = [&by_key, &by_option].map(json);
    let [one, other] = [&by_key, &by_option].map(|solution| solution["cost"].as_f64().unwrap());
    assert!((one / other - 1.0).abs() < 1e-9, "{one} {other}");
    assert_eq!(by_key["free_joints"][0]["name"], "root_joint");
    let fixed = optimize("flying_key", &of("floating_base = false\n"), &["--json", "--floating-base"]);
    assert_eq!(fixed.status.code(), Some(WRONG), "the file has the last word");
    assert!(stderr(&fixed).contains("there is no joint 'root_joint_x'"), "{}", stderr(&fixed));
}

/// Neither is taken, and both have a name.
#[test]
fn gaits_and_constraints_of_what_flies_are_refused() {
    let folder = empty_folder("flying_refused");
    let gear = "[[constraint]]\nname = \"gear\"\ntype = \"coupling\"\njoints = { wheel = 1.0 }\n";
    for (robot, problem, parts) in [
        (
            ROBOT.to_owned(),
            format!(
                "{PROBLEM}[gait]\nstance = \"nonsense\"\nswing = \"base\"\nalong = \"base_x\"\nlength = 0.3\n"
            )
            .replace("[end]\nq = [0, 0, 0, 0, 0, 0.6, 0.8, 0]\n", "")
            .replace("q_free = [\"base_x\", \"base_y\", \"base_z\", \"wheel\"]\n", ""),
            &["gait.stance: joint 'base' turns freely", "prismatic and revolute joints"][..],
        ),
        (format!("{ROBOT}{gear}"), PROBLEM.to_owned(), &["robot: joint 'base' turns freely", "'gear'"]),
    ] {
        std::fs::write(folder.join("wheel.toml"), robot).unwrap();
        let output = optimize("flying_refused", &problem, &[]);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(WRONG), "{message}");
        assert!(parts.iter().all(|part| message.contains(part)), "{message}");
    }
}
