//! The files that are written.

use super::{empty_folder, folder, json, names, optimize, robot, two_link};
use crate::child::{costate, stderr, stdout};
use serde_json::Value;

/// The value of `--polish` may be left out; with a blank it is not the name of a file.
#[test]
fn the_value_of_polish_follows_an_equals_sign_or_a_blank() {
    let polish = |more: &[&str]| {
        let output = optimize("polish", &two_link(), &[&["--json"], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        json(&output)["options"]["polish"].clone()
    };
    for (more, expected) in [
        (&["--polish", "false"][..], "never"),
        (&["--polish=false"], "never"),
        (&["--polish", "auto"], "auto"),
        (&["--polish", "true"], "always"),
        (&["--polish"], "always"),
    ] {
        assert_eq!(polish(more), expected, "{more:?}");
    }
}

/// Options for URDFs are a warning where the robot is in TOML.
#[test]
fn options_for_urdfs_are_a_warning_for_robots_in_toml() {
    let flags = ["--friction", "--floating-base", "--quaternions"];
    let warned = |output: &std::process::Output| {
        let message = stderr(output);
        assert_eq!(output.status.code(), Some(0), "{message}");
        flags
            .map(|flag| message.matches(&format!("warning: {flag} has no effect on a robot in TOML")).count())
    };
    assert_eq!(warned(&optimize("for_urdfs", &two_link(), &flags)), [1; 3]);
    assert_eq!(warned(&optimize("for_urdfs", &two_link(), &[])), [0; 3]);
    let arm = robot("two_link.toml");
    assert_eq!(warned(&costate(&["info", &arm, "--friction"], b"")), [1, 0, 0]);
    let text = std::fs::read(&arm).unwrap();
    assert_eq!(warned(&costate(&["info", "-", "--quaternions"], &text)), [0, 0, 1]);
    assert_eq!(warned(&costate(&["info", &robot("ur5.urdf"), "--friction"], b"")), [0; 3]);
}

#[test]
fn outputs_are_checked_before_the_problem_is_solved() {
    let folder = empty_folder("outputs");
    let (file, arm) = (folder.join("problem.toml"), folder.join("arm.toml"));
    std::fs::copy(robot("two_link.toml"), &arm).unwrap();
    // It would take hours.
    let text = two_link().replace(&robot("two_link.toml"), "arm.toml") + "[solver]\nstarts = 1000000\n";
    std::fs::write(&file, &text).unwrap();
    let (page, nowhere) = (folder.join("report.html"), folder.join("nowhere/report.html"));
    let [problem, arm, page, nowhere] = [&file, &arm, &page, &nowhere].map(|path| path.to_str().unwrap());
    for (more, part) in [
        (&["-o", problem][..], "is the input file"),
        (&["--save", arm], "is the input file"),
        (&["-o", nowhere], "cannot be written"),
        (&["--save", folder.to_str().unwrap()], "is a folder; give a file"),
        (&["--svg", arm], "is a file; give a folder"),
        (&["-o", page, "--package-path", nowhere], "--package-path: there is no folder "),
        (&["-o", page, "--save", page], "both -o and --save"),
        (&["--save", page, "--sample", "1kHz", "--sample-to", page], "both --save and --sample-to"),
        (&["--sample", "1kHz", "--sample-to", problem], "is the input file"),
        (&["--sample", "1kHz"], "--sample-to FILE or --json"),
        (&["--sample-to", page], "--sample"),
        (&["--sample", "1MHz", "--sample-to", page], "1kHz"),
        (&["--json", "--sample", "1kHz", "--sample-to", "-"], "standard output"),
        (&["--json", "-o", "-"], "standard output"),
    ] {
        let output = costate(&[&["optimize", problem], more].concat(), b"");
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{more:?}");
        assert!(stderr(&output).contains(part), "{part}: {}", stderr(&output));
    }
    assert_eq!(std::fs::read_to_string(&file).unwrap(), text);
    assert_eq!(names(&folder), ["arm.toml", "problem.toml"]);
    let output = costate(&["optimize", "examples/problems/two_link.toml", "--save", "-"], b"");
    assert_eq!(json(&output)["status"], "converged");
}

#[test]
fn the_report_is_one_file_and_the_figures_are_well_formed() {
    let folder = folder("report");
    let (page, pictures) = (folder.join("report.html"), folder.join("pictures"));
    let arguments = ["optimize", "examples/problems/puma560_pick_and_place.toml"];
    let more = ["-o", page.to_str().unwrap(), "--svg", pictures.to_str().unwrap(), "--iterations"];
    let output = costate(&[&arguments[..], &more].concat(), b"");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(
        stdout(&output).contains("converged") && stdout(&output).contains("iteration  residual"),
        "{}",
        stdout(&output)
    );
    let text = std::fs::read_to_string(&page).unwrap();
    let shown = text.rsplit_once("<script>").unwrap().0;
    assert!(!shown.contains("NaN"));
    for banned in ["http://", "https://", "src=", "@import", "<link", "inf "] {
        let name_space = text.replace("http://www.w3.org/2000/svg", "");
        assert!(!name_space.contains(banned), "{banned}");
    }
    for part in [
        "Joint angles",
        "Joint rates",
        "Momenta",
        "Powers of the joints",
        "Tool speed",
        "Costates of the momenta",
        "H* minus its mean",
    ] {
        assert!(text.contains(part), "{part}");
    }
    let data = text.split("id=\"data\">").nth(1).unwrap().split("</script>").next().unwrap();
    let data: Value = serde_json::from_str(data).unwrap();
    assert_eq!(data["joints"].as_array().unwrap().len(), 6);
    let saved = text.split("id=\"solution\">").nth(1).unwrap().split("</script>").next().unwrap();
    let saved: Value = serde_json::from_str(saved).unwrap();
    assert_eq!(saved["status"], "converged");
    let mut names = Vec::new();
    for entry in std::fs::read_dir(&pictures).unwrap() {
        let file = entry.unwrap().path();
        let picture = std::fs::read_to_string(&file).unwrap();
        let document = roxmltree::Document::parse(&picture).unwrap();
        assert_eq!(document.root_element().tag_name().name(), "svg");
        names.push(file.file_name().unwrap().to_str().unwrap().to_owned());
    }
    names.sort();
    let expected = [
        "control_elbow.svg",
        "control_waist.svg",
        "costates_p.svg",
        "costates_q.svg",
        "energy.svg",
        "hamiltonian.svg",
        "mesh.svg",
        "powers.svg",
        "residuals.svg",
        "strobe_xy.svg",
        "strobe_xz.svg",
        "tool_speed.svg",
        "total_power.svg",
    ];
    expected.iter().for_each(|name| assert!(names.iter().any(|other| other == name), "{name}: {names:?}"));
}

/// A motion of either method at a fixed rate, as a table and in the JSON object.
#[test]
fn motions_are_sampled_at_a_fixed_rate() {
    let file = folder("samples").join("samples.csv");
    let path = file.to_str().unwrap();
    for method in ["collocation", "direct"] {
        let text = two_link() + "[limits]\nfrom_robot = false\n[solver]\n";
        let text = format!("{text}method = \"{method}\"\n");
        let output = optimize("samples", &text, &["--json", "--sample", "0.4kHz", "--sample-to", path]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let solution = json(&output);
        let samples = &solution["samples"];
        assert_eq!(samples["rate"], 400.0);
        let table = std::fs::read_to_string(&file).unwrap();
        let lines: Vec<&str> = table.lines().collect();
        let names = ["q", "v", "a", "tau", "u"].map(|name| format!(",{name}_shoulder,{name}_elbow"));
        assert_eq!(lines[0], format!("t{}", names.concat()));
        let rows: Vec<Vec<f64>> =
            lines[1..].iter().map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect();
        assert_eq!(rows.len(), 401);
        for (k, row) in rows.iter().enumerate() {
            let list = |key: &str| samples[key][k].as_array().unwrap().iter().map(|x| x.as_f64().unwrap());
            let lists = ["q", "v", "a", "tau", "u"].into_iter().flat_map(list);
            let expected: Vec<f64> = samples["t"][k].as_f64().into_iter().chain(lists).collect();
            assert_eq!(*row, expected);
            assert!((row[0] - k as f64 / 400.0).abs() < 1e-12);
        }
        let end = &rows[400];
        assert_eq!(end[0], solution["final_time"].as_f64().unwrap());
        for (found, expected) in end[1..5].iter().zip([1.0, 0.5, 0.0, 0.0]) {
            assert!((found - expected).abs() < 1e-8, "{found} {expected}");
        }
    }
}

/// Derivatives of the cost by the parameters of the robot, in the JSON object and as a table.
#[test]
fn sensitivities_are_printed_where_they_are_asked_for() {
    let text = two_link() + "[limits]\nfrom_robot = false\n";
    let output = optimize("sensitivities", &text, &["--json", "--sensitivities"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let solution = json(&output);
    let rows = solution["sensitivities"].as_array().unwrap();
    let mass = rows.iter().find(|row| row["name"] == "elbow.mass").unwrap();
    assert!(mass["value"] == 2.0 && mass["derivative"].as_f64().unwrap() > 0.0, "{mass}");
    let table = optimize("sensitivities", &text, &["--sensitivities"]);
    assert!(stdout(&table).contains("dJ/dvalue") && stdout(&table).contains("elbow.J_zz"));
    assert!(json(&optimize("sensitivities", &text, &["--json"])).get("sensitivities").is_none());
}
