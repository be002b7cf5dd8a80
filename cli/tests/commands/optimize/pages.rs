//! What the table, the report and the help of `costate optimize` say.

use super::{folder, optimize, two_link};
use crate::child::{costate, stderr, stdout};
use serde_json::{Value, json};

/// The report of a problem with this text.
fn page(test: &str, text: &str) -> String {
    let file = folder(test).join("report.html");
    let output = optimize(test, text, &["-o", file.to_str().unwrap(), "--time-limit", "20"]);
    assert!(matches!(output.status.code(), Some(0 | 3)), "{}", stderr(&output));
    std::fs::read_to_string(&file).unwrap()
}

/// The part of a page between two texts.
fn between<'a>(page: &'a str, from: &str, to: &str) -> &'a str {
    page.split_once(from).and_then(|(_, rest)| rest.split_once(to)).map_or("", |(part, _)| part)
}

/// The plot of this name in the data of a page.
fn plot(page: &str, name: &str) -> Value {
    let data: Value = serde_json::from_str(between(page, "id=\"data\">", "</script>")).unwrap();
    data["plots"].as_array().unwrap().iter().find(|plot| plot["id"] == name).unwrap().clone()
}

#[test]
fn limits_are_drawn_where_they_belong_and_listed() {
    let limits = "[limits]\nfrom_robot = false\nq_max = [1.0, inf]\nv_max = [inf, 0.8]\na_max = [6.0, inf]\n\
                  torque_max = [40.0, 40.0]\n";
    let page = page("page_kept", &(two_link() + limits));
    for (name, joint, value) in [("positions", 0, 1.0), ("rates", 1, 0.8), ("accelerations", 0, 6.0)] {
        let plot = plot(&page, name);
        let limits = plot["limits"].as_array().unwrap();
        let upper = |limit: &&Value| limit["upper"] == true && limit["color"] == joint;
        let found: Vec<_> =
            limits.iter().filter(upper).map(|limit| limit["value"].as_f64().unwrap()).collect();
        assert_eq!(found, [value], "{name}: {limits:?}");
        assert!(limits.iter().all(|limit| limit["kept"] == true), "{name}");
    }
    let table = between(&page, "<h2>Limits</h2>", "</table>");
    for row in ["position", "rate", "acceleration", "torque"] {
        assert!(table.contains(&format!("<tr><td>{row}</td><td>hard</td>")), "{row}: {table}");
    }
    // The rate limit is active along a part of the motion; it takes more than half a radian in 0.8 rad/s.
    let active = between(&page, "<th>active limit</th>", "</table>");
    assert!(active.contains("<tr><td>rate</td><td>elbow</td><td>max</td><td>0."), "{active}");
}

/// Without `[limits]` those of the robot are compared, and the page says so.
#[test]
fn limits_that_are_not_kept_are_told_from_those_that_are() {
    let page = page("page_compared", &two_link());
    let torques = plot(&page, "controls");
    assert_eq!(torques["title"], "Torques u");
    let limits = torques["limits"].as_array().unwrap();
    assert!(!limits.is_empty() && limits.iter().all(|limit| limit["kept"] == false), "{limits:?}");
    let table = between(&page, "<h2>Limits</h2>", "</table>");
    assert!(table.contains("<td>control</td><td>only compared</td>"), "{table}");
    assert!(page.contains("<tr><td>control, only compared</td><td>shoulder</td><td>max</td>"), "{page}");
    // Those of the robot are 1 N m; the motion needs 28.1 N m at the elbow.
    assert!(table.contains("27.1 N m") && table.contains("elbow, t = 0 s"), "{table}");
    let none = two_link() + "[limits]\nfrom_robot = false\n";
    assert!(!self::page("page_free", &none).contains("<h2>Limits</h2>"));
}

/// Bounds of an indirect method are what it keeps.
#[test]
fn bounds_of_an_indirect_method_are_limits_that_are_kept() {
    let more = "[bounds]\nu_min = [-inf, -10.0]\nu_max = [inf, 10.0]\n[solver]\nmethod = \"collocation\"\n";
    let page = page("page_bounds", &(two_link() + more));
    let table = between(&page, "<h2>Limits</h2>", "</table>");
    assert!(table.contains("<td>control</td><td>hard</td><td>0 N m</td>"), "{table}");
    let active = between(&page, "<th>active limit</th>", "</table>");
    for side in ["min", "max"] {
        assert!(active.contains(&format!("<td>control</td><td>elbow</td><td>{side}</td>")), "{active}");
    }
    let limits = plot(&page, "controls")["limits"].clone();
    let upper = json!({ "color": 1, "upper": true, "kept": true, "value": 10 });
    assert!(limits.as_array().unwrap().contains(&upper), "{limits}");
}

/// Powers, jerks and rates of torques are drawn with their limits, a torque that depends on the rate too.
#[test]
fn all_kinds_of_limits_are_drawn() {
    let limits = "[limits]\nfrom_robot = false\njerk_max = [900.0, 900.0]\ntorque_rate_max = [9e3, 9e3]\n\
                  power_max = [70.0, 60.0]\ntotal_power_max = 100.0\ntorque_max = [40.0, 40.0]\n\
                  corner_speed = [1.0, 1.0]\nno_load_speed = [9.0, 9.0]\n";
    let page = page("page_rates", &(two_link() + limits));
    for (name, value) in [("jerks", 900.0), ("torque_rates", 9e3), ("powers", 70.0), ("total_power", 100.0)] {
        let plot = plot(&page, name);
        let upper = plot["limits"].as_array().unwrap().iter().find(|limit| limit["upper"] == true).unwrap();
        assert_eq!((&upper["kept"], upper["value"].as_f64()), (&json!(true), Some(value)), "{name}");
        let largest = |curve: &Value| {
            let values = curve["y"].as_array().unwrap().iter().map(|y| y.as_f64().unwrap().abs());
            values.fold(0.0, f64::max)
        };
        let largest = plot["curves"].as_array().unwrap().iter().map(largest).fold(0.0, f64::max);
        assert!((0.02 * value..=1.05 * value).contains(&largest), "{name}: {largest} of {value}");
    }
    // Where the motor drives fast it has less than 40 N m.
    let torques = plot(&page, "controls");
    let curve = torques["limits"].as_array().unwrap().iter().find(|limit| limit["value"].is_array()).unwrap();
    let values: Vec<f64> =
        curve["value"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap().abs()).collect();
    assert!(values.iter().all(|x| *x <= 40.0) && values.iter().any(|x| *x < 39.0), "{values:?}");
    let work = plot(&page, "energy");
    let end = |k: usize| work["curves"][k]["y"].as_array().unwrap().last().unwrap().as_f64().unwrap();
    assert!(end(0) <= end(1) && end(1) > 0.0, "{} {}", end(0), end(1));
}

/// Nothing of the table is cut, also not the reason why a motion is not polished.
#[test]
fn the_table_says_which_motion_is_shown_and_why() {
    let table = stdout(&optimize("shown", &two_link(), &[]));
    let row = table.lines().find(|line| line.contains("shown")).unwrap();
    let cost = row.rsplit(' ').next().unwrap();
    assert!(row.contains("polished; the direct method's cost ") && cost.parse::<f64>().is_ok(), "{row}");
    for (more, reason) in [
        (
            "[limits]\nfrom_robot = false\nv_max = [inf, 0.8]\n",
            "direct: a rate limit is active, that of elbow",
        ),
        ("[limits]\nfrom_robot = false\na_max = [99.0, 99.0]\n", "direct: accelerations are limited"),
        ("[limits]\nfrom_robot = false\njerk_max = [9e9, 9e9]\n", "direct: limits.jerk_max is given"),
        ("[[via]]\nq = [0.5, 0.2]\n[limits]\nfrom_robot = false\n", "direct: vias or a periodic motion"),
    ] {
        let table = stdout(&optimize("shown", &(two_link() + more), &[]));
        assert!(table.contains(reason) && !table.contains('\u{2026}'), "{reason}: {table}");
    }
}

/// The problem that the help shows is solved as it stands, beside its robot.
#[test]
fn the_problem_in_the_help_is_solved() {
    let help = stdout(&costate(&["optimize", "--help"], b""));
    let lines = help.lines().filter_map(|line| line.strip_prefix("    ")).filter(|line| line.contains(" = "));
    let text: String =
        lines.take_while(|line| !line.starts_with(' ')).map(|line| format!("{line}\n")).collect();
    assert!(text.starts_with("robot = \"two_link.toml\"") && text.contains("cost.effort"), "{help}");
    std::fs::copy(super::robot("two_link.toml"), folder("help").join("two_link.toml")).unwrap();
    let output = optimize("help", &text, &[]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(help.contains("cheapest motion") && help.contains("The direct method is the default"), "{help}");
}

/// Links look as the URDF says; a mesh that is not there is a warning, and its link a capsule.
#[test]
fn visual_models_are_shown_and_missing_ones_named() {
    let folder = folder("page_models");
    let link = |name: &str, visual: &str| {
        format!(
            "<link name=\"{name}\"><inertial><origin xyz=\"0.1 0 0\"/><mass value=\"1\"/>\
             <inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.01\"/></inertial>{visual}</link>\n"
        )
    };
    let mesh = |file: &str| format!("<visual><geometry><mesh filename=\"{file}\"/></geometry></visual>");
    let joint = |name: &str, parent: &str, child: &str| {
        format!(
            "<joint name=\"{name}\" type=\"continuous\"><origin xyz=\"0.3 0 0\"/><axis xyz=\"0 1 0\"/>\
             <parent link=\"{parent}\"/><child link=\"{child}\"/></joint>\n"
        )
    };
    let urdf = [
        "<robot name=\"arm\"><link name=\"base\"/>\n".to_owned(),
        link("upper", &mesh("package://arm/upper.obj")),
        link("lower", &mesh("package://arm/lower.stl")),
        joint("a", "base", "upper"),
        joint("b", "upper", "lower"),
        "</robot>".to_owned(),
    ];
    let package = folder.join("packages/arm");
    std::fs::create_dir_all(&package).unwrap();
    std::fs::write(folder.join("arm.urdf"), urdf.concat()).unwrap();
    std::fs::write(package.join("upper.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n")
        .unwrap();
    let problem = "robot = \"arm.urdf\"\n[start]\nq = [0.0, 0.0]\n[end]\nq = [0.2, 0.2]\n[time]\nfinal = 1.0\n\
                   [cost]\neffort = [1.0, 1.0]\n";
    let (page, packages) = (folder.join("report.html"), folder.join("packages"));
    let more = ["-o", page.to_str().unwrap(), "--package-path", packages.to_str().unwrap()];
    let output = optimize("page_models", problem, &more);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let warning = stderr(&output);
    assert!(warning.contains("link 'lower' (line 3): mesh package://arm/lower.stl"), "{warning}");
    assert!(!warning.contains("upper.obj"), "{warning}");
    let page = std::fs::read_to_string(page).unwrap();
    let data: Value = serde_json::from_str(between(&page, "id=\"data\">", "</script>")).unwrap();
    let bodies = data["stage"]["bodies"].as_array().unwrap();
    let kinds = |link: &str| -> Vec<&Value> {
        bodies.iter().filter(|body| body["link"] == link).map(|body| &body["shape"]["kind"]).collect()
    };
    assert_eq!((kinds("upper"), kinds("lower")), (vec![&json!("mesh")], vec![&json!("capsule")]));
    assert_eq!(data["stage"]["meshes"].as_array().unwrap().len(), 1);
}
