//! Loops of URDF files: what is refused, and what is told.

use crate::texts::{INERTIAL, load, notes, refused};
use crate::urdf_loops::{body_with, branches, coupling};
use costate::constraints::ConstrainedHamiltonian;
use costate::robot::LoopProblem;
use costate::robot::RobotError as E;

/// A loop of two anchors apart by more than the arms reach.
#[test]
fn a_loop_that_cannot_close_is_named() {
    let pin = "<loop name=\"too_far\" type=\"spherical\"><predecessor link=\"base\"><origin xyz=\"9 0 0\"/></predecessor>\
               <successor link=\"c\"/></loop>";
    let robot = load(&branches(pin));
    let mut h = ConstrainedHamiltonian::<f64>::new(&robot);
    let error = h.close(&mut [0.0; 3], &[false; 3]).unwrap_err();
    assert!(error.to_string().contains("'too_far'"), "{error}");
}

/// Joints of SDF in `<gazebo>` are told; extensions of links and joints are not.
#[test]
fn joints_inside_gazebo_are_told() {
    let joint = "<joint name=\"j\" type=\"revolute\"><parent>b</parent><child>d</child></joint>";
    let told = load(&branches(&format!("<gazebo>\n{joint}</gazebo>")));
    assert!(notes(&told).contains("'j' inside <gazebo> (line 14)"), "{}", notes(&told));
    for silent in
        [format!("<gazebo reference=\"a\">{joint}</gazebo>"), "<gazebo><plugin name=\"p\"/></gazebo>".into()]
    {
        assert_eq!(notes(&load(&branches(&silent))), "");
    }
}

/// What is refused: an element, the line to blame (of the text below 12 lines of links and joints), words of
/// the message.
#[test]
fn what_is_wrong_with_a_loop_is_told_with_its_line() {
    let problem = |rest: &str, line: usize, words: &[&str]| {
        let (found, error) = refused(&branches(rest));
        let message = error.to_string();
        assert_eq!(found, Some(line), "{message}");
        words.iter().for_each(|word| assert!(message.contains(word), "'{word}' is not in: {message}"));
        error
    };
    let is_bad_loop = |error: E, of: fn(&LoopProblem) -> bool| {
        assert!(matches!(&error, E::BadLoop { problem, .. } if of(problem)), "{error:?}");
        assert!(error.culprit().is_some());
    };
    let plus = |kind: &str, first: &str, second: &str, inside: &str| {
        format!(
            "<loop name=\"l\" type=\"{kind}\"><predecessor link=\"{first}\"/>\n<successor link=\"{second}\"/>\n{inside}</loop>"
        )
    };
    is_bad_loop(
        problem(
            &plus("revolute", "bse", "d", ""),
            13,
            &["loop 'l'", "'bse'", "does not exist", "did you mean 'base'?"],
        ),
        |problem| matches!(problem, LoopProblem::UnknownLink { .. }),
    );
    is_bad_loop(
        problem(&plus("revolute", "b", "zebra", ""), 13, &["'zebra'", "name one of the links"]),
        |problem| matches!(problem, LoopProblem::UnknownLink { .. }),
    );
    // The name of a joint is none of a link.
    problem(&plus("revolute", "jb", "d", ""), 13, &["'jb'", "does not exist"]);
    for kind in ["floating", "ball", "screw"] {
        is_bad_loop(problem(&plus(kind, "b", "d", ""), 13, &["loop 'l'", kind, "spherical"]), |problem| {
            matches!(problem, LoopProblem::UnsupportedType { .. })
        });
    }
    is_bad_loop(
        problem(&plus("revolute", "b", "d", "<axis xyz=\"0 0 0\"/>"), 15, &["loop 'l'", "0 0 1"]),
        |problem| matches!(problem, LoopProblem::BadAxis),
    );
    problem(&plus("revolute", "b", "d", "<axis/>"), 15, &["<axis>", "loop 'l'", "xyz"]);
    problem(&plus("revolute", "b", "d", "<axis xyz=\"1 0\"/>"), 15, &["<axis>", "loop 'l'", "give 3"]);
    problem(&plus("", "b", "d", ""), 13, &["loop 'l'", "type"]);
    problem("<loop type=\"fixed\"/>", 13, &["<loop>", "no name"]);
    problem("<loop name=\"l\" type=\"fixed\"/>", 13, &["loop 'l'", "<successor>"]);
    problem(
        "<loop name=\"l\" type=\"fixed\"><successor link=\"b\"/></loop>",
        13,
        &["loop 'l'", "<predecessor>"],
    );
    problem(&plus("fixed", "c", "e", ""), 13, &["'l'", "fixed to one link"]);
    let bad = plus("fixed", "b", "d", "").replace("\"b\"/>", "\"b\"><origin xyz=\"0 nan 0\"/></predecessor>");
    problem(&bad, 13, &["<origin>", "loop 'l'", "NaN"]);
    let twice = plus("fixed", "b", "d", "") + "\n" + &plus("fixed", "a", "d", "");
    problem(&twice, 16, &["two constraints are called 'l'"]);
    // As two manuals have it, with two first links.
    let two_first =
        "<loop_joint name=\"l\" type=\"spherical\">\n<link1 link=\"b\"/><link1 link=\"d\"/></loop_joint>";
    problem(two_first, 13, &["loop 'l'", "<link2>"]);
    let without = "<loop_joint name=\"l\" type=\"spherical\"><link1 link=\"b\"/><link2/></loop_joint>";
    problem(without, 13, &["<link2>", "loop 'l'", "link"]);
    // Couplings.
    is_bad_loop(
        problem(&coupling("c", "e", ""), 13, &["loop 'gear'", "do not move against each other"]),
        |problem| matches!(problem, LoopProblem::Still),
    );
    for second in ["a", "c"] {
        let none = coupling("base", second, "<ratio value=\"0\"/>");
        is_bad_loop(problem(&none, 13, &["'gear'", "ratio zero", "another ratio"]), |problem| {
            matches!(problem, LoopProblem::NoRatio)
        });
    }
    problem(&coupling("a", "c", "<ratio/>"), 13, &["<ratio>", "coupling 'gear'", "value"]);
    problem(&coupling("a", "c", "<ratio value=\"six\"/>"), 13, &["<ratio>", "'six'"]);
    let (line, error) = refused(&body_with(&coupling("base", "body", "")));
    assert_eq!(line, Some(5));
    is_bad_loop(error, |problem| matches!(problem, LoopProblem::SeveralFreedoms { kind: "floating", .. }));
    // Balls.
    let ball =
        "<drake:ball_constraint>\n<drake:ball_constraint_body_A name=\"b\"/><drake:ball_constraint_p_AP/>";
    problem(
        &format!("{ball}</drake:ball_constraint>"),
        14,
        &["<ball_constraint_p_AP>", "ball_constraint_1", "value"],
    );
    problem("<drake:ball_constraint/>", 13, &["ball_constraint_p_AP"]);
}

/// Misspelt names in loops are told, as everywhere.
#[test]
fn unknown_names_inside_loops_are_told() {
    let odd = "<loop name=\"l\" type=\"spherical\" limit=\"1\"><predecessor link=\"b\"/><successor link=\"d\"><orign/></successor></loop>";
    let told = notes(&load(&branches(odd)));
    assert!(told.contains("limit") && told.contains("did you mean <origin>?"), "{told}");
    assert_eq!(notes(&load(&branches("<transmission/><frame/>"))), "");
}

/// A file of many couplings along many joints is refused before it takes gigabytes.
#[test]
fn couplings_along_very_many_joints_are_refused() {
    let mut text = String::from("<robot name=\"long\">\n<link name=\"l0\"/>\n");
    for k in 1..=1500 {
        text += &format!(
            "<link name=\"l{k}\">{INERTIAL}</link><joint name=\"j{k}\" type=\"continuous\"><parent link=\"l{}\"/><child link=\"l{k}\"/></joint>\n",
            k - 1
        );
    }
    for k in 0..700 {
        text += &format!(
            "<coupling name=\"c{k}\"><predecessor link=\"l0\"/><successor link=\"l1500\"/></coupling>\n"
        );
    }
    let (_, error) = refused(&(text + "</robot>"));
    assert!(error.to_string().contains("1000000 joints"), "{error}");
}
