//! Loops of URDF files: what each type holds, the dialects, and couplings.

use crate::texts::{load, notes, tree};
use costate::constraints::{ConstrainedHamiltonianSecondOrder, Constraints};
use costate::robot::urdf::parse;
use costate::robot::{ConstraintKind, ConstraintRow, LoadOptions, Placement, Robot};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

/// Link 'body' on a floating joint of the root 'base', and something more.
pub fn body_with(rest: &str) -> String {
    let floating = [("root", "floating", "base", "body", "")];
    tree(&["base", "body"], &floating).replace("</robot>", &format!("{rest}\n</robot>"))
}

fn loop_of(kind: &str, axis: &str) -> String {
    format!(
        "<loop name=\"l\" type=\"{kind}\"><predecessor link=\"base\"><origin xyz=\"0.3 -0.2 0.5\" rpy=\"0.4 -0.3 0.9\"/>\
         </predecessor><successor link=\"body\"><origin xyz=\"-0.1 0.6 0.2\" rpy=\"-0.7 0.2 0.3\"/></successor>{axis}</loop>"
    )
}

fn ends() -> [Placement; 2] {
    [
        Placement::from_xyz_rpy([0.3, -0.2, 0.5], [0.4, -0.3, 0.9]),
        Placement::from_xyz_rpy([-0.1, 0.6, 0.2], [-0.7, 0.2, 0.3]),
    ]
}

fn inverse(placement: &Placement) -> Placement {
    let rotation = placement.rotation.transpose();
    Placement { rotation, translation: -(rotation * placement.translation) }
}

/// q of the floating joint as a chain (x, y, z, rz, ry, rx).
fn chain(pose: &Placement) -> [f64; 6] {
    let (r, t) = (&pose.rotation, &pose.translation);
    let pitch = (-r[(2, 0)]).asin();
    [t.x, t.y, t.z, r[(1, 0)].atan2(r[(0, 0)]), pitch, r[(2, 1)].atan2(r[(2, 2)])]
}

fn moved(rotation: Matrix3<f64>, translation: Vector3<f64>) -> Placement {
    Placement { rotation, translation }
}

/// g where the loop is moved by this from where its frames coincide, and the rank of J there.
fn at(text: &str, motion: &Placement) -> (f64, usize) {
    let [first, second] = ends();
    let robot = load(text);
    let q = chain(&first.then(motion).then(&inverse(&second)));
    let mut rows = Constraints::<f64>::new(&robot);
    rows.set_position(&q).unwrap();
    let miss = rows.values().iter().fold(0.0_f64, |most, g| most.max(g.abs()));
    let rank = rows.jacobian().view().to_nalgebra().rank(1e-9);
    assert_eq!(rank, rows.count(), "all rows of one loop are independent");
    (miss, rank)
}

/// The motions of a joint of a type keep its loop closed, and all other motions open it.
#[test]
fn each_type_leaves_free_what_a_joint_of_it_does() {
    let axis = Vector3::new(0.2, -1.3, 0.5);
    let unit = Unit::new_normalize(axis);
    let turn = |angle: f64| *Rotation3::from_axis_angle(&unit, angle).matrix();
    let other = *Rotation3::from_euler_angles(0.3, -0.2, 0.5).matrix();
    let still = Matrix3::identity();
    let across = unit.cross(&Vector3::x()).normalize() * 0.4;
    let nothing = moved(still, Vector3::zeros());
    let turned = moved(turn(0.8), Vector3::zeros());
    let far_turned = moved(turn(-2.9), Vector3::zeros());
    let slid = moved(still, unit.into_inner() * 0.7);
    let shifted = moved(still, across);
    let in_plane = moved(turn(1.1), across);
    let tumbled = moved(other, Vector3::zeros());
    let all = [nothing, turned, far_turned, slid, shifted, in_plane, tumbled];
    for (kind, rank, free) in [
        ("fixed", 6, [true, false, false, false, false, false, false]),
        ("revolute", 5, [true, true, true, false, false, false, false]),
        ("continuous", 5, [true, true, true, false, false, false, false]),
        ("prismatic", 5, [true, false, false, true, false, false, false]),
        ("planar", 3, [true, true, true, false, true, true, false]),
        ("spherical", 3, [true, true, true, false, false, false, true]),
    ] {
        let text = body_with(&loop_of(kind, "<axis xyz=\"0.2 -1.3 0.5\"/>"));
        for (motion, is_free) in all.iter().zip(free) {
            let (miss, found) = at(&text, motion);
            assert_eq!(found, rank, "{kind}");
            assert!(if is_free { miss < 1e-13 } else { miss > 0.05 }, "{kind} {motion:?}: {miss:.1e}");
        }
    }
}

#[test]
fn an_omitted_axis_is_x() {
    let about_x =
        |angle| moved(*Rotation3::from_axis_angle(&Vector3::x_axis(), angle).matrix(), Vector3::zeros());
    let text = body_with(&loop_of("revolute", ""));
    assert!(at(&text, &about_x(0.6)).0 < 1e-13);
    let given = load(&body_with(&loop_of("revolute", "<axis xyz=\"3 0 0\"/>")));
    assert_eq!(load(&text).constraints(), given.constraints());
}

/// Two chains of two links beside each other: 'a' and 'b' on one, 'c' and 'd' on the other.
pub fn branches(rest: &str) -> String {
    let joints = [
        ("ja", "revolute", "base", "a", ""),
        ("jb", "prismatic", "a", "b", ""),
        ("jc", "revolute", "base", "c", ""),
        ("weld", "fixed", "c", "e", ""),
        ("jd", "continuous", "e", "d", "<mimic joint=\"ja\" multiplier=\"-2\" offset=\"0.3\"/>"),
    ];
    tree(&["base", "a", "b", "c", "d", "e"], &joints).replace("</robot>", &format!("{rest}\n</robot>"))
}

#[test]
fn the_dialects_say_the_same() {
    let [_, end] = ends();
    let [x, y, z] = [end.translation.x, end.translation.y, end.translation.z];
    let of = |rest: String| load(&branches(&rest)).constraints()[0].kind.clone();
    for kind in ["fixed", "continuous", "revolute", "prismatic", "planar", "spherical"] {
        let joint = of(format!(
            "<loop_joint name=\"l\" type=\"{kind}\"><link1 link=\"b\" xyz=\"0.3 -0.2 0.5\" rpy=\"0.4 -0.3 0.9\"/>\
             <link2 link=\"d\" xyz=\"-0.1 0.6 0.2\" rpy=\"-0.7 0.2 0.3\"/><axis xyz=\"0 1 1\"/></loop_joint>"
        ));
        let plus =
            loop_of(kind, "<axis xyz=\"0 1 1\"/>").replace("\"base\"", "\"b\"").replace("\"body\"", "\"d\"");
        assert_eq!(joint, of(plus), "{kind}");
    }
    let ball = format!(
        "<drake:ball_constraint><drake:ball_constraint_body_A name=\"b\"/><drake:ball_constraint_body_B name=\"d\"/>\
         <drake:ball_constraint_p_AP value=\"0.3 -0.2 0.5\"/><drake:ball_constraint_p_BQ value=\"{x} {y} {z}\"/>\
         </drake:ball_constraint>"
    );
    let pin = "<loop_joint name=\"l\" type=\"spherical\"><link1 link=\"b\" xyz=\"0.3 -0.2 0.5\"/>\
               <link2 link=\"d\" xyz=\"-0.1 0.6 0.2\"/></loop_joint>";
    assert_eq!(of(ball.clone()), of(pin.into()));
    // The namespace may be declared; balls are numbered.
    let declared = branches(&format!("{ball}\n{ball}"))
        .replace("<robot ", "<robot xmlns:drake=\"http://drake.mit.edu\" ");
    let names: Vec<String> = load(&declared).constraints().iter().map(|one| one.name.clone()).collect();
    assert_eq!(names, ["ball_constraint_1", "ball_constraint_2"]);
    // The prefix counts, whatever it stands for; under another one the element is not read, and told.
    let with = |uri: &str, ball: &str| load(&branches(ball).replace("<robot ", &format!("<robot {uri} ")));
    let short = with("xmlns:drake=\"d\"", &ball);
    assert_eq!((short.constraints().len(), notes(&short)), (1, String::new()));
    let renamed = with("xmlns:sim=\"http://drake.mit.edu\"", &ball.replace("drake:", "sim:"));
    assert_eq!(renamed.constraints().len(), 1);
    for other in ["other:", ""] {
        let unread = with("xmlns:other=\"o\"", &ball.replace("drake:", other));
        assert_eq!(unread.constraints().len(), 0);
        let told = notes(&unread);
        assert!(told.contains("<ball_constraint> (line 13) was not read"), "{told}");
    }
}

/// Frames are those of links, also where a joint has the name of another link; on merged links, too.
#[test]
fn loops_are_between_links_as_they_are_merged() {
    let text = tree(
        &["base", "a", "b", "c"],
        &[
            ("b", "revolute", "base", "a", ""),
            ("x", "revolute", "a", "b", ""),
            ("y", "fixed", "b", "c", "<origin xyz=\"0.5 0 0\"/>"),
        ],
    );
    let pin = "<loop name=\"l\" type=\"spherical\"><predecessor link=\"base\"/><successor link=\"c\"/></loop></robot>";
    let robot = load(&text.replace("</robot>", pin));
    let ConstraintKind::Frames { frame, to, rows } = &robot.constraints()[0].kind else { panic!() };
    assert_eq!(rows[..], [ConstraintRow::X, ConstraintRow::Y, ConstraintRow::Z]);
    let [held, holding] = [frame, to].map(|seat| &robot.frames()[seat.frame]);
    assert_eq!((&*held.name, held.joint, held.placement.translation.x), ("c", Some(1), 0.5));
    assert_eq!((&*holding.name, holding.joint), ("base", None));
    let of_link = load(&text.replace("</robot>", &pin.replace("\"c\"", "\"b\"")));
    let ConstraintKind::Frames { frame, .. } = &of_link.constraints()[0].kind else { panic!() };
    assert_eq!(of_link.frames()[frame.frame].joint, Some(1), "the link 'b', not the joint");
    // A loop stays where it is on a floating base, and when a joint is locked.
    let afloat = LoadOptions::default().floating_base(true);
    let free = parse(&text.replace("</robot>", pin), afloat).unwrap();
    assert_eq!(free.constraints().len(), 1);
    assert_eq!(robot.lock(&[("b", 0.3)]).unwrap().constraints().len(), 1);
}

fn terms(rest: &str) -> Vec<(String, f64)> {
    let robot = load(&branches(rest));
    let ConstraintKind::Coupling { terms, constant } = &robot.constraints()[0].kind else { panic!() };
    assert_eq!(*constant, 0.0);
    terms.iter().map(|&(joint, factor)| (robot.joints()[joint].name.clone(), factor)).collect()
}

pub fn coupling(first: &str, second: &str, ratio: &str) -> String {
    format!(
        "<coupling name=\"gear\"><predecessor link=\"{first}\"/><successor link=\"{second}\"/>{ratio}</coupling>"
    )
}

/// `ratio` times the joints up to the predecessor, minus those up to the successor, from where they part.
#[test]
fn couplings_are_between_the_joints_up_to_their_links() {
    let named =
        |all: &[(&str, f64)]| all.iter().map(|&(name, factor)| (name.to_owned(), factor)).collect::<Vec<_>>();
    let ratio = "<ratio value=\"6\"/>";
    assert_eq!(terms(&coupling("a", "c", ratio)), named(&[("ja", 6.0), ("jc", -1.0)]));
    assert_eq!(terms(&coupling("a", "e", ratio)), named(&[("ja", 6.0), ("jc", -1.0)]), "e is fixed to c");
    assert_eq!(terms(&coupling("a", "c", "")), named(&[("ja", 1.0), ("jc", -1.0)]));
    assert_eq!(
        terms(&coupling("b", "d", ratio)),
        named(&[("ja", 6.0), ("jb", 6.0), ("jc", -1.0), ("jd", -1.0)])
    );
    assert_eq!(terms(&coupling("b", "a", ratio)), named(&[("jb", 6.0)]), "their ways part at a");
    assert_eq!(terms(&coupling("base", "c", ratio)), named(&[("jc", -1.0)]));
    // With joints on one side only a coupling is a lock, which is told.
    let told = |rest: String| notes(&load(&branches(&rest)));
    let side = |joints: &str| {
        format!(
            "coupling 'gear' (line 13) has joints on one side only: it holds {joints} still, and its ratio has no effect"
        )
    };
    assert!(
        told(coupling("b", "a", ratio)).contains(&side("joint 'jb'")),
        "{}",
        told(coupling("b", "a", ratio))
    );
    assert!(told(coupling("a", "b", ratio)).contains(&side("joint 'jb'")));
    assert!(told(coupling("base", "d", "")).contains(&side("the sum of joints 'jc', 'jd'")));
    assert_eq!(told(coupling("a", "c", ratio)), "");
    // Of older files; `independent` chooses coordinates in other programs.
    let older = coupling("a", "c", ratio).replace("\"gear\"", "\"gear\" type=\"rolling\"");
    let text = branches(&older).replace("<joint name=\"ja\"", "<joint independent=\"true\" name=\"ja\"");
    let robot = load(&text);
    assert_eq!((notes(&robot), robot.constraints().len()), (String::new(), 1));
    // The joint that mimics another one stands for it: q_d = 0.3 - 2 q_a.
    let geared = load(&branches(&coupling("b", "d", ratio)));
    let mut rows = Constraints::<f64>::new(&geared);
    let (a, b, c) = (0.4, -0.2, 0.7);
    rows.set_position(&[a, b, c]).unwrap();
    let expected = 6.0 * (a + b) - (c + 0.3 - 2.0 * a);
    assert!((rows.values()[0] - expected).abs() < 1e-14, "{:?}", rows.values());
}

fn four_bar(format: &str) -> Robot {
    Robot::from_file(format!("{}/robots/four_bar.{format}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// Five rows of a revolute joint in space against two rows in the plane: the other three are redundant, and
/// told; states, derivatives and forces are the same.
#[test]
fn the_four_bar_linkage_as_a_urdf_is_that_of_the_toml_file() {
    let (urdf, toml) = (four_bar("urdf"), four_bar("toml"));
    assert_eq!((urdf.warnings(), urdf.constraints()[0].kind.rows()), (&[][..], 5));
    let mut plain = ConstrainedHamiltonianSecondOrder::<f64>::new(&toml);
    let mut spatial = ConstrainedHamiltonianSecondOrder::<f64>::new(&urdf);
    for (crank, rate, torque) in [(1.0, 0.0, 2.0), (2.2, -1.5, 0.3), (4.0, 3.0, -4.0)] {
        let mut q = [crank, -0.6, -2.0];
        plain.first().close(&mut q, &[true, false, false]).unwrap();
        let mut other = [crank, -0.6, -2.0];
        spatial.first().close(&mut other, &[true, false, false]).unwrap();
        assert!(q.iter().zip(other).all(|(a, b)| (a - b).abs() < 1e-12), "{q:?} {other:?}");
        // Momenta of any gauge.
        let p = [2.0 * rate, 0.3 + rate, -0.5];
        let (u, y) = ([torque, 0.1, -0.2], [0.3, -0.7, 0.2, 1.1, 0.4, -0.6]);
        let expected = plain.contract(&q, &p, &u, &y).unwrap();
        let (f, f_x, y_f_xx) = (
            expected.linearisation().f().to_vec(),
            expected.linearisation().matrix().to_nalgebra(),
            expected.matrix().to_nalgebra(),
        );
        let (mu, lambda) =
            (expected.linearisation().mu().to_vec(), expected.linearisation().lambda().to_vec());
        let found = spatial.contract(&q, &p, &u, &y).unwrap();
        let all = found.linearisation();
        let off = |a: &[f64], b: &[f64]| {
            let size = b.iter().fold(1.0_f64, |most, b| most.max(b.abs()));
            a.iter().zip(b).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())) / size
        };
        assert!(off(all.f(), &f) < 1e-12, "{:?} {f:?}", all.f());
        assert!(off(all.matrix().to_nalgebra().as_slice(), f_x.as_slice()) < 1e-11);
        assert!(off(found.matrix().to_nalgebra().as_slice(), y_f_xx.as_slice()) < 1e-11);
        // Rows x and y come first and carry all; the base turns them into the plane of the linkage.
        assert!(off(&all.mu()[..2], &mu) < 1e-11 && off(&all.lambda()[..2], &lambda) < 1e-11);
        assert!(all.lambda()[2..].iter().all(|&force| force == 0.0), "{:?}", all.lambda());
        let first = spatial.first();
        let told: Vec<&str> = first.redundant().collect();
        assert_eq!((first.rank(), told), (2, vec!["rocker_pivot"; 3]));
    }
}
