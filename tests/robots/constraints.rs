//! Constraints in files, and the robots with loops.

use costate::constraints::{ConstrainedHamiltonian, ConstraintError};
use costate::robot::{ConstraintKind, ConstraintRow, LoadOptions, Robot, RobotError as E, file::parse};

const PAIR: &str = "name = 'pair'\n[[joint]]\nname = 'a'\nmass = 1.0\ncom = [0.3, 0, 0]\n[[joint]]\nname = 'b'\n\
                    mass = 1.0\ncom = [0.3, 0, 0]\n[[constraint]]\n";

fn robot(name: &str) -> Robot {
    Robot::from_file(format!("{}/robots/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// The name of the constraint is in line 11.
fn with(table: &str) -> Result<Robot, (Option<usize>, E)> {
    match parse(&format!("{PAIR}{table}"), LoadOptions::default()) {
        Ok(robot) => Ok(robot),
        Err(E::InFile { line, error, .. }) => Err((line, *error)),
        Err(other) => panic!("{other:?}"),
    }
}

#[test]
fn what_is_wrong_is_told_with_its_line() {
    let refused = |table: &str, expected: Option<usize>, words: &[&str]| {
        let (line, error) = with(table).unwrap_err();
        let message = error.to_string();
        assert_eq!(line, expected, "{message}");
        words.iter().for_each(|word| assert!(message.contains(word), "'{word}' is not in: {message}"));
    };
    refused("name = 'loop'\nframe = 'b'", Some(11), &["'loop'", "needs", "`rows`"]);
    refused("name = 'loop'\nframe = 'b'\nrows = []", Some(11), &["'loop'", "no rows"]);
    refused("name = 'loop'\nframe = 'b'\nrows = ['w']", Some(13), &["`w`", "turn_x"]);
    refused("name = 'loop'\nframe = 'c'\nrows = ['x']", Some(11), &["'c'"]);
    refused("name = 'loop'\ntype = 'pinned'\nframe = 'b'\nlength = 1.0", Some(11), &["pinned", "`length`"]);
    refused("name = 'rod'\ntype = 'distance'\nframe = 'b'\nlength = 0", Some(11), &["'rod'", "positive"]);
    refused("name = 'gear'\ntype = 'coupling'\njoints = { c = 1.0 }", Some(11), &["'c'"]);
    refused("name = 'gear'\ntype = 'coupling'\nframe = 'a'\njoints = { a = 1.0 }", Some(11), &["`frame`"]);
    refused("frame = 'b'", Some(10), &["`name`"]);
    refused("name = 'loop'\ntype = 'glued'\nframe = 'b'", Some(12), &["glued", "rigid"]);
    let twice = "name = 'loop'\ntype = 'rigid'\nframe = 'b'\n[[constraint]]\nname = 'loop'\ntype = 'rigid'\nframe = 'a'";
    refused(twice, Some(15), &["two constraints are called 'loop'"]);
}

#[test]
fn every_key_arrives() {
    let table = "name = 'loop'\ntype = 'rigid'\nframe = 'b'\nto = 'a'\nplacement = { xyz = [1, 2, 3] }\n\
                 to_placement = { xyz = [0, 0, 4] }\n[[constraint]]\nname = 'gear'\ntype = 'coupling'\n\
                 joints = { a = 1.0, b = -2.0 }\nconstant = 0.5";
    let robot = with(table).unwrap();
    let [weld, gear] = robot.constraints() else { panic!() };
    let ConstraintKind::Frames { frame, to, rows } = &weld.kind else { panic!() };
    let names = [frame, to].map(|seat| robot.frames()[seat.frame].name.clone());
    assert_eq!((names, &rows[..]), (["b".to_owned(), "a".to_owned()], &ConstraintRow::ALL[..]));
    assert_eq!((frame.placement.translation.y, to.placement.translation.z), (2.0, 4.0));
    let ConstraintKind::Coupling { terms, constant } = &gear.kind else { panic!() };
    assert_eq!((&terms[..], *constant), (&[(0, 1.0), (1, -2.0)][..], 0.5));
}

/// Three equal arms: one sphere around the tip of an arm in the plane of symmetry, and virtual work.
#[test]
fn the_delta_robot_closes_where_its_geometry_says() {
    let delta = robot("delta.toml");
    assert_eq!(delta.warnings(), []);
    let mut h = ConstrainedHamiltonian::<f64>::new(&delta);
    let reach = (0.4573 - 0.115) / (2.0 * 3.0_f64.sqrt());
    for angle in [0.0, 0.3, 0.9] {
        let mut q = [angle, angle, angle, 0.0, 0.0, -0.2];
        let held = [true, true, true, false, false, false];
        h.close(&mut q, &held).unwrap();
        let across = reach + 0.112 * f64::cos(angle);
        let height = -0.112 * f64::sin(angle) - (0.232_f64.powi(2) - across * across).sqrt();
        assert!(q[3].abs() < 1e-12 && q[4].abs() < 1e-12 && (q[5] - height).abs() < 1e-11, "{q:?} {height}");
        // dz / d(angle) of the closed form; at rest the torques that hold are those of virtual work.
        let slope = -0.112 * f64::cos(angle)
            - across * 0.112 * f64::sin(angle) / (0.232_f64.powi(2) - across * across).sqrt();
        let weight = -9.81 * (3.0 * 0.125 * 0.0672 * f64::cos(angle) - 0.275 * slope);
        let torque = weight / 3.0;
        let all = h.linearise(&q, &[0.0; 6], &[torque, torque, torque, 0.0, 0.0, 0.0]).unwrap();
        assert!(all.acceleration().iter().all(|a| a.abs() < 1e-9), "{:?}", all.acceleration());
        let lambda = all.lambda().to_vec();
        // The rods carry the platform: their vertical parts add up to its weight.
        let lift: f64 = (0..3).map(|k| h.constraints().wrench(k, &lambda).unwrap().0[2]).sum();
        assert!((lift + 0.275 * 9.81).abs() < 1e-9, "{lift}");
        assert_eq!(h.rank(), 3);
    }
    let mut far = [0.0, 0.0, 0.0, 0.0, 0.0, -0.6];
    let held = [true, true, true, false, false, true];
    assert!(matches!(h.close(&mut far, &held), Err(ConstraintError::CannotClose { .. })));
}

/// A loop may be described by any of its joints: the four-bar opened at the crank's tip.
#[test]
fn one_linkage_opened_at_two_places_moves_alike() {
    let four_bar = robot("four_bar.toml");
    let text =
        std::fs::read_to_string(format!("{}/robots/four_bar.toml", env!("CARGO_MANIFEST_DIR"))).unwrap();
    // The rocker stands on its pivot, x from the pivot to the coupler: its centre of mass is in the middle.
    let text = text.replacen(
        "name = \"rocker\"\ndh = { a = 1.2 }",
        "name = \"rocker\"\nparent = \"world\"\ndh = { a = 1.3 }",
        1,
    );
    let text = text.replacen(
        "name = \"pivot\"\nplacement = { xyz = [1.3, 0.0, 0.0] }",
        "name = \"pivot\"\nparent = \"coupler\"\nplacement = { xyz = [1.2, 0.0, 0.0] }",
        1,
    );
    let other = parse(&text, LoadOptions::default()).unwrap();
    let [mut first, mut second] = [&four_bar, &other].map(ConstrainedHamiltonian::<f64>::new);
    let mut q = [1.0, -0.6, -2.0];
    first.close(&mut q, &[true, false, false]).unwrap();
    // The rocker's own angle, seen from its other end.
    let mut at = [q[0], q[1], q[0] + q[1] + q[2] - std::f64::consts::PI];
    second.close(&mut at, &[true, true, false]).unwrap();
    let u = [2.0, 0.0, 0.0];
    let found = second.linearise(&at, &[0.0; 3], &u).unwrap().acceleration().to_vec();
    let expected = first.linearise(&q, &[0.0; 3], &u).unwrap().acceleration().to_vec();
    let turned = [expected[0], expected[1], expected.iter().sum()];
    assert!(found.iter().zip(turned).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {turned:?}");
}
