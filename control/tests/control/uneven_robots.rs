//! Walking robots that are not exactly their own mirror images, as robots of files are.

use super::gaits::example;
use costate::robot::{LinkInertia, LoadOptions};
use costate_control::{GaitError, Method, Problem, ProblemError, ProblemFile, ProblemWarning};

/// The biped of the example with so much more mass (kg) on its left shank.
fn uneven(more: f64) -> Problem {
    let mut problem = example("biped_walk").problem;
    let load = LinkInertia::point(more, [0.02, 0.01, -0.1]);
    problem.robot = problem.robot.with_payload("joint:left_knee", &load).unwrap();
    problem
}

/// What the note says: the difference of torques in mirrored motions, and its share.
fn noted(problem: &Problem) -> Option<(f64, f64)> {
    problem.warnings().iter().find_map(|warning| match warning {
        ProblemWarning::Uneven { by, share, .. } => Some((*by, *share)),
        _ => None,
    })
}

/// Published robots differ from their mirror images by 1e-5 (Solo12), 2e-4 (G1), 2e-3 (TALOS), 6e-3 (Go1) and
/// 1.3e-2 (A1) of their weight times the length of a leg.
#[test]
fn published_asymmetries_are_taken_and_noted() {
    assert_eq!(noted(&example("biped_walk").problem), None);
    let unit = noted(&uneven(0.01)).unwrap().1 / 0.01;
    for share in [1e-5, 2e-4, 2e-3, 6e-3, 1.3e-2] {
        let problem = uneven(share / unit);
        let (by, found) = noted(&problem).unwrap();
        assert!((found / share - 1.0).abs() < 0.1 && by > 0.0, "{found} {share}");
        problem.check_for(Method::Direct).unwrap();
        let warning = &problem.warnings()[0];
        assert!(warning.is_note() && warning.to_string().contains("gait.symmetrise"), "{warning}");
    }
}

#[test]
fn larger_differences_of_masses_do_not_blame_the_pairs() {
    let unit = noted(&uneven(0.01)).unwrap().1 / 0.01;
    let problem = uneven(0.05 / unit);
    let Err(ProblemError::Gait { key, cause }) = problem.check_for(Method::Direct) else { panic!() };
    assert_eq!(key.to_string(), "gait.mirror");
    assert!(matches!(*cause, GaitError::NotSymmetric { changes: Some(_), .. }), "{cause}");
    let message = cause.to_string();
    for words in ["the pairs are right", "gait.symmetrise = true", "masses by up to"] {
        assert!(message.contains(words), "{words}: {message}");
    }
    let mut wrong = problem;
    wrong.gait.as_mut().unwrap().flipped.retain(|joint| joint != "left_hip_roll");
    let Err(ProblemError::Gait { cause, .. }) = wrong.check_for(Method::Direct) else { panic!() };
    assert!(matches!(*cause, GaitError::NotMirrored { .. }), "{cause}");
    let message = cause.to_string();
    assert!(message.contains("'left_hip_roll'") && message.contains("'right_hip_roll'"), "{message}");
    assert!(message.contains("gait.flipped"), "{message}");
}

/// The mean with the mirror image is its own mirror image: nothing is noted but the change.
#[test]
fn symmetrised_robots_are_their_own_mirror_images() {
    let unit = noted(&uneven(0.01)).unwrap().1 / 0.01;
    let more = 0.2 / unit;
    let problem = uneven(more).with_symmetric_robot().unwrap();
    problem.check_for(Method::Direct).unwrap();
    assert_eq!(noted(&problem), None);
    let change = problem.gait.as_ref().unwrap().symmetrised.clone().unwrap();
    assert!((change.mass.amount - 0.5 * more).abs() < 1e-12, "{change:?}");
    let before = uneven(more);
    let mass = |problem: &Problem| problem.robot.joints().iter().map(|joint| joint.inertia.mass).sum::<f64>();
    assert!((mass(&before) - mass(&problem)).abs() < 1e-12);
    let [warning] = &problem.warnings()[..] else { panic!("{:?}", problem.warnings()) };
    assert!(matches!(warning, ProblemWarning::Symmetrised { .. }) && warning.is_note(), "{warning}");
    assert!(warning.to_string().contains("masses by up to"), "{warning}");
    // Where nothing differs it says so.
    let even = example("biped_walk").problem.with_symmetric_robot().unwrap();
    let change = even.gait.as_ref().unwrap().symmetrised.clone().unwrap();
    assert!(change.mass.amount < 1e-14 && change.place.amount < 1e-14, "{change:?}");
}

#[test]
fn files_ask_for_the_mean_by_a_key() {
    let text = example("biped_walk").text;
    let uneven =
        text.replace("[start]", "[[robot.payload]]\nframe = \"joint:left_knee\"\nmass = 9.0\n\n[start]");
    let read = |text: &str| ProblemFile::from_text(text, "../examples/problems", LoadOptions::default());
    let error = read(&uneven).unwrap_err().to_string();
    assert!(error.contains("gait.mirror: the pairs are right"), "{error}");
    let even = read(&uneven.replace("[gait]", "[gait]\nsymmetrise = true")).unwrap().problem;
    let mass = |name: &str| even.robot.joints()[even.robot.joint_index(name).unwrap()].inertia.mass;
    let masses = ["left_knee", "right_knee"].map(mass);
    assert!((masses[0] - masses[1]).abs() < 1e-12, "{masses:?}");
}
