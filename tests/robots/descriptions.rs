//! One robot, described in two ways.

use costate::hamiltonian::Hamiltonian;
use costate::robot::urdf::parse;
use costate::robot::{JointSpec, LinkInertia, LoadOptions, Placement, Robot, dh};
use costate_test_support::properties;
use costate_test_support::random_position::Kind;
use costate_test_support::random_robot::{Case, all_cases, condition};
use costate_test_support::rounding::{Bounds, close};
use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;

fn numbers(x: &[f64]) -> String {
    x.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}

fn inertial(body: &LinkInertia) -> String {
    let i = &body.inertia;
    format!(
        "<inertial><origin xyz=\"{}\"/><mass value=\"{}\"/><inertia ixx=\"{}\" iyy=\"{}\" izz=\"{}\" \
         ixy=\"{}\" ixz=\"{}\" iyz=\"{}\"/></inertial>",
        numbers(body.com.as_slice()),
        body.mass,
        i[(0, 0)],
        i[(1, 1)],
        i[(2, 2)],
        i[(0, 1)],
        i[(0, 2)],
        i[(1, 2)],
    )
}

/// The same robot from URDF text, each link split into three by fixed joints: a remainder, a rotated piece of
/// it, and a massless flange that carries the joints beyond.
fn split(case: &Case, robot: &Robot) -> String {
    let flange = Vector3::new(0.3, -0.2, 0.1);
    let mut text = String::from("<robot name=\"split\"><link name=\"world\"/>");
    for (i, (part, joint)) in case.parts.iter().zip(robot.joints()).enumerate() {
        let body = &joint.inertia;
        let (share, away) = (0.3, Vector3::new(0.01, -0.02, 0.015));
        let seat = Placement::from_xyz_rpy([0.4, 0.1, -0.2], part.rpy);
        let (rotated, moved) = (seat.rotation.transpose(), body.com + away - seat.translation);
        let piece = LinkInertia {
            mass: share * body.mass,
            com: rotated * moved,
            inertia: rotated * body.inertia * 0.1 * seat.rotation,
        };
        let apart = (Matrix3::identity() * away.norm_squared() - away * away.transpose())
            * (body.mass * share / (1.0 - share));
        let rest = LinkInertia {
            mass: (1.0 - share) * body.mass,
            com: body.com - away * (share / (1.0 - share)),
            inertia: body.inertia * 0.9 - apart,
        };
        let [rest, piece] =
            [rest, piece].map(|body| if body.mass > 0.0 { inertial(&body) } else { String::new() });
        let xyz = Vector3::from(part.xyz) - if case.parent(i).is_some() { flange } else { Vector3::zeros() };
        let parent = case.parent(i).map_or("world".into(), |parent| format!("flange{parent}"));
        let kind = if part.kind == Kind::Prismatic { "prismatic" } else { "revolute" };
        let mimic = case.mimicked(i).zip(part.mimic).map_or(String::new(), |(joint, (_, ratio, offset))| {
            format!("<mimic joint=\"j{joint}\" multiplier=\"{ratio:?}\" offset=\"{offset:?}\"/>")
        });
        text += &format!(
            "<link name=\"rest{i}\">{rest}</link><link name=\"piece{i}\">{piece}</link><link name=\"flange{i}\"/>\
             <joint name=\"j{i}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"rest{i}\"/>\
             <origin xyz=\"{}\" rpy=\"{}\"/><axis xyz=\"{}\"/>{mimic}</joint>\
             <joint name=\"p{i}\" type=\"fixed\"><parent link=\"rest{i}\"/><child link=\"piece{i}\"/>\
             <origin xyz=\"{}\" rpy=\"{}\"/></joint>\
             <joint name=\"f{i}\" type=\"fixed\"><parent link=\"rest{i}\"/><child link=\"flange{i}\"/>\
             <origin xyz=\"{}\"/></joint>",
            numbers(xyz.as_slice()),
            numbers(&part.rpy),
            numbers(&part.axis),
            numbers(seat.translation.as_slice()),
            numbers(&part.rpy),
            numbers(flange.as_slice()),
        );
    }
    text + "</robot>"
}

/// `R = Rz(yaw) Ry(pitch) Rx(roll)`: roll, pitch, yaw; yaw = 0 where pitch is a right angle and only two of
/// them count.
fn roll_pitch_yaw(r: &Matrix3<f64>) -> [f64; 3] {
    let level = r[(0, 0)].hypot(r[(1, 0)]);
    let pitch = (-r[(2, 0)]).atan2(level);
    if level < 1e-9 {
        return [(-r[(1, 2)]).atan2(r[(1, 1)]), pitch, 0.0];
    }
    [r[(2, 1)].atan2(r[(2, 2)]), pitch, r[(1, 0)].atan2(r[(0, 0)])]
}

/// A chain from its modified Denavit-Hartenberg table, and the URDF of the same.
fn table_and_urdf(rows: &[[f64; 4]], prismatic: &[bool], body: &LinkInertia) -> [Robot; 2] {
    let mut joints = Vec::new();
    let mut text = String::from("<robot name=\"chain\"><link name=\"l0\"/>");
    for (i, (&[alpha, a, d, theta], &prismatic)) in rows.iter().zip(prismatic).enumerate() {
        let name = format!("j{i}");
        let joint = if prismatic { JointSpec::prismatic(&name) } else { JointSpec::revolute(&name) };
        joints.push((joint.carrying(*body), dh::DhRow { alpha, a, d, theta }));
        let about_x = Placement::from_xyz_rpy([a, 0.0, 0.0], [alpha, 0.0, 0.0]);
        let placed = about_x.then(&Placement::from_xyz_rpy([0.0, 0.0, d], [0.0, 0.0, theta]));
        text += &format!(
            "<link name=\"l{}\">{}</link><joint name=\"{name}\" type=\"{}\"><parent link=\"l{i}\"/>\
             <child link=\"l{}\"/><origin xyz=\"{}\" rpy=\"{}\"/><axis xyz=\"0 0 1\"/>\
             <limit lower=\"-3\" upper=\"3\" effort=\"1\" velocity=\"1\"/></joint>",
            i + 1,
            inertial(body),
            if prismatic { "prismatic" } else { "revolute" },
            i + 1,
            numbers(placed.translation.as_slice()),
            numbers(&roll_pitch_yaw(&placed.rotation)),
        );
    }
    let table = dh::chain("chain", dh::Convention::Modified, joints).build().unwrap();
    [table, parse(&(text + "</robot>"), LoadOptions::default()).unwrap()]
}

fn angle() -> impl Strategy<Value = f64> {
    prop_oneof![
        prop::sample::select(vec![0.0, 1.0, -1.0, 2.0]).prop_map(|k| k * std::f64::consts::FRAC_PI_2),
        -3.0..3.0
    ]
}

/// How much more constants of robots from text are rounded, while bounds start from one rounding each: by the
/// square root of the number of roundings, at most 64, which are independent.
///
/// A rotation from angles is rounded 9 times: sines and cosines (2 each, of three), two products, a sum.
/// Those of a table (5) become three angles, up to pi, with errors of 11 u each, and a rotation again:
/// 5 + 33 + 9. The inertia of a piece is turned from both sides and back, 2 (9 + 3) each, scaled, displaced
/// (5), and added to those of two other links (5 each): 64.
const CONSTANTS: f64 = 8.0;

properties! {
    160;

    #[test]
    fn a_denavit_hartenberg_table_and_a_urdf_give_the_same_numbers(
        rows in prop::collection::vec((angle(), -0.8..0.8, -0.8..0.8, angle()), 1..9),
        prismatic in prop::collection::vec(prop::bool::weighted(0.3), 9),
        q in prop::collection::vec(-3.0..3.0, 9),
    ) {
        let n = rows.len();
        let rows: Vec<[f64; 4]> = rows.into_iter().map(|(alpha, a, d, theta)| [alpha, a, d, theta]).collect();
        let inertia = Matrix3::new(0.3, 0.02, -0.01, 0.02, 0.4, 0.03, -0.01, 0.03, 0.5);
        let body = LinkInertia::about_com(1.3, [0.1, -0.2, 0.05], inertia);
        let [table, urdf] = table_and_urdf(&rows, &prismatic[..n], &body);
        prop_assume!((0.0..1e9).contains(&condition(&table, &q[..n])));
        let p: Vec<f64> = (0..n).map(|i| 0.3 + 0.2 * i as f64).collect();
        // The constants of both are rounded as those of one are: the bounds of both together.
        let v = Hamiltonian::<f64>::new(&table).velocity(&q[..n], &p).unwrap().to_vec();
        let (rest, y) = (vec![0.0; n], vec![1.0; 2 * n]);
        let at = |robot| Bounds::new(robot, [&q[..n], &v, &rest, &y]);
        let bounds = at(&table).largest(at(&urdf));
        let [first, second] = [table, urdf].map(|robot| {
            let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
            let linear = hamiltonian.linearise(&q[..n], &p, &rest).unwrap();
            [linear.mass_matrix().as_slice().to_vec(), linear.f().to_vec(), linear.matrix().iter_rows().flatten().copied().collect()]
        });
        for (k, bound) in [bounds.m, bounds.f, bounds.f_x].into_iter().enumerate() {
            close(["M", "F", "F_x"][k], &second[k], &first[k], CONSTANTS * bound)?;
        }
    }

    #[test]
    fn a_link_split_by_fixed_joints_changes_nothing(case in all_cases(7)) {
        let mut plain = Case { coupling: Vec::new(), ..case };
        for part in &mut plain.parts {
            (part.armature, part.spring, part.friction) = (0.0, [0.0; 2], [0.0, 0.0, 0.1]);
        }
        let robot = plain.robot();
        prop_assume!((0.0..1e9).contains(&condition(&robot, &plain.q)));
        let pieces = parse(&split(&plain, &robot), LoadOptions::default()).unwrap();
        let pieces = pieces.with_gravity(plain.gravity).unwrap();
        let p = plain.p(&robot);
        let numbers = |robot: &Robot| {
            let mut hamiltonian = Hamiltonian::<f64>::new(robot);
            let linear = hamiltonian.linearise(&plain.q, &p, &plain.u).unwrap();
            (linear.mass_matrix().as_slice().to_vec(), linear.f().to_vec(), linear.matrix().to_nalgebra())
        };
        let ((m, f, f_x), (m_whole, f_whole, f_x_whole)) = (numbers(&pieces), numbers(&robot));
        let at = |robot| Bounds::new(robot, [&plain.q, &plain.v, &plain.u, &plain.y]);
        let bounds = at(&robot).largest(at(&pieces));
        close("M", &m, &m_whole, CONSTANTS * bounds.m)?;
        close("F", &f, &f_whole, CONSTANTS * bounds.f)?;
        close("F_x", f_x.as_slice(), f_x_whole.as_slice(), CONSTANTS * bounds.f_x)?;
    }
}
