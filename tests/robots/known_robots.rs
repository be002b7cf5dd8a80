//! The project's own robots: published answers, and independent reference values
//! (`tests/fixtures/README.md`).

use costate::hamiltonian::Hamiltonian;
use costate::lagrangian::Lagrangian;
use costate::robot::Robot;
use costate_test_support::reference::{Reference, check_robot};
use std::f64::consts::{FRAC_PI_4, PI};
use std::path::{Path, PathBuf};

fn robots() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("robots")
}

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures")
}

fn check(name: &str, file: &str) {
    let fixture = fixtures().join(format!("{name}.jsonl"));
    check_robot(&Robot::from_file(robots().join(file)).unwrap(), &Reference::read(&fixture));
}

macro_rules! references {
    ($($test:ident: $file:literal;)*) => {$(
        #[test]
        fn $test() {
            check(stringify!($test), $file);
        }
    )*};
}

references! {
    puma560: "puma560.toml";
    puma560_corke: "puma560_corke.toml";
    manutec_r3: "manutec_r3.toml";
    two_link: "two_link.toml";
    pendulum: "pendulum.toml";
    cart_pole: "cart_pole.toml";
    ur5: "ur5.urdf";
    panda: "panda.urdf";
    biped: "biped.toml";
}

fn check_invented(file: &str) {
    let file = fixtures().join(file);
    check_robot(&Robot::from_file(&file).unwrap(), &Reference::read(&file.with_extension("jsonl")));
}

/// Branches, prismatic joints, general axes, a full armature matrix, springs and both kinds of friction.
#[test]
fn friction_tree() {
    check_invented("friction_tree.toml");
}

/// Revolute and prismatic joints by turns, general axes.
#[test]
fn mixed_chain() {
    check_invented("mixed_chain.urdf");
}

/// Three branches of revolute and prismatic joints, two of which branch again; general axes.
#[test]
fn mixed_tree() {
    check_invented("mixed_tree.urdf");
}

/// Mimics of mimics, of sisters and of later joints, with springs, friction and armature between branches.
#[test]
fn mimic_tree() {
    check_invented("mimic_tree.toml");
}

/// Mimic joints of a URDF.
#[test]
fn mimic_hand() {
    check_invented("mimic_hand.urdf");
}

/// M, tau and gravity of a robot in fixtures/ as Pinocchio computes them, then what else the references have.
fn check_pinocchio(name: &str, more: impl Fn(&Reference, &mut Lagrangian<f64>, [&[f64]; 3])) -> Robot {
    let robot = Robot::from_file(fixtures().join(format!("{name}.urdf"))).unwrap();
    let mut lagrangian = Lagrangian::<f64>::new(&robot);
    let references = Reference::read(&fixtures().join(format!("{name}_pinocchio.jsonl")));
    assert_eq!(references.len(), 4);
    for reference in &references {
        let [q, v, a] = ["q", "v", "a"].map(|key| reference.numbers(key));
        reference.agrees("M", lagrangian.mass_matrix(&q).unwrap().as_slice(), "Pinocchio");
        reference.agrees("tau", lagrangian.inverse_dynamics(&q, &v, &a).unwrap(), "Pinocchio");
        reference.agrees("gravity", lagrangian.gravity(&q).unwrap(), "Pinocchio");
        more(reference, &mut lagrangian, [&q, &v, &a]);
    }
    robot
}

/// The same as Pinocchio reads and computes it.
#[test]
fn mimic_hand_of_pinocchio() {
    check_pinocchio("mimic_hand", |_, _, _| {});
}

/// Mimics of mimics with negative ratios and offsets, one of them on another branch, by Pinocchio's model of
/// all joints.
#[test]
fn mimic_of_mimic_of_pinocchio() {
    let robot = check_pinocchio("mimic_of_mimic", |reference, lagrangian, [q, v, a]| {
        let jacobian = lagrangian.linearise_inverse_dynamics(q, v, a).unwrap();
        reference.agrees("tau_q", jacobian.tau_q.as_slice(), "Pinocchio");
        reference.agrees("tau_v", jacobian.tau_v.as_slice(), "Pinocchio");
    });
    assert_eq!((robot.joints().len(), robot.dof()), (6, 2));
}

/// Twelve revolute joints, general axes.
#[test]
fn long_chain() {
    check_invented("long_chain.urdf");
}

/// Corke and Armstrong-Helouvry's consensus parameters, answers printed to four digits.
#[test]
fn puma_560_gives_the_published_answers() {
    let robot = Robot::from_file(robots().join("puma560_corke.toml")).unwrap();
    let q = [0.0, FRAC_PI_4, PI, 0.0, FRAC_PI_4, 0.0];
    let near = |found: f64, published: f64, what: &str| {
        assert!((found - published).abs() <= 2e-4, "{what}: {found} is not {published}");
    };
    let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
    let m = hamiltonian.mass_matrix(&q).unwrap();
    for (i, j, published) in [
        (1, 1, 3.6593),
        (1, 2, -0.4044),
        (1, 3, 0.1006),
        (1, 4, -0.0025),
        (2, 2, 4.4137),
        (2, 3, 0.3509),
        (2, 5, 0.0024),
        (3, 3, 0.9379),
        (3, 5, 0.0015),
        (4, 4, 0.1925),
        (5, 5, 0.1713),
        (6, 6, 0.1941),
    ] {
        near(m[(i - 1, j - 1)], published, &format!("M{i}{j}"));
    }
    let at_rest = hamiltonian.evaluate(&q, &[0.0; 6], &[0.0; 6]).unwrap();
    for (i, published) in [0.0, 31.6399, 6.0351, 0.0, 0.0283, 0.0].into_iter().enumerate() {
        near(-at_rest[6 + i], published, &format!("gravity load {}", i + 1));
    }
    // C v = dp/dt - M a - g-load at a = 0: (dM/dt) v - L_q + dV/dq, with (dM/dt) v = P v.
    let v = [1.0, 2.0, 3.0, 1.0, 2.0, 3.0];
    let p = hamiltonian.momentum(&q, &v).unwrap().to_vec();
    let l_q = hamiltonian.evaluate(&q, &p, &[0.0; 6]).unwrap()[6..].to_vec();
    let at_rest = hamiltonian.evaluate(&q, &[0.0; 6], &[0.0; 6]).unwrap()[6..].to_vec();
    let coupling = hamiltonian.linearise_momentum(&q, &v).unwrap().dp_dq;
    for (i, published) in [-4.6344, 8.7257, -1.9268, 0.0023, 0.0191, 0.0004].into_iter().enumerate() {
        let pv: f64 = coupling.row(i).iter().zip(&v).map(|(p, v)| p * v).sum();
        near(pv - l_q[i] + at_rest[i], published, &format!("C v {}", i + 1));
    }
}

/// Swinging through small angles: w^2 = g / l, so H_qq = m g l and F_x has eigenvalues +- i sqrt(9.81).
#[test]
fn pendulum_and_two_link_arm_in_closed_form() {
    let pendulum = Robot::from_file(robots().join("pendulum.toml")).unwrap();
    let mut hamiltonian = Hamiltonian::<f64>::new(&pendulum);
    for q in [0.0, 0.7, PI] {
        let linear = hamiltonian.linearise(&[q], &[0.4], &[0.1]).unwrap();
        let expected = [0.4, -9.81 * q.sin() + 0.1];
        assert!(linear.f().iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-14));
        assert!(
            (linear.pq()[(0, 0)] + 9.81 * q.cos()).abs() < 1e-14 && (linear.qp()[(0, 0)] - 1.0).abs() < 1e-15
        );
    }
    let arm = Robot::from_file(robots().join("two_link.toml")).unwrap();
    let mut hamiltonian = Hamiltonian::<f64>::new(&arm);
    for q2 in [0.0, 0.9, -2.0_f64] {
        let m = hamiltonian.mass_matrix(&[5.0, q2]).unwrap();
        let (elbow, cross) = (4.0 / 3.0, 1.5 * q2.cos());
        let expected = [1.0 / 3.0 + 2.0 + elbow + 2.0 * cross, elbow + cross, elbow + cross, elbow];
        assert!(m.as_slice().iter().zip(expected).all(|(m, e)| (m - e).abs() < 1e-14), "{m:?} {expected:?}");
    }
}

/// Every model file loads, without an error from strict parsing of its keys, and says where its figures come
/// from.
#[test]
fn every_model_file_loads_and_names_its_sources() {
    let mut count = 0;
    for file in std::fs::read_dir(robots()).unwrap() {
        let path = file.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "md") {
            continue;
        }
        Robot::from_file(&path).unwrap();
        let text = std::fs::read_to_string(&path).unwrap().to_lowercase();
        assert!(text.contains("source") || text.contains("figures"), "{}", path.display());
        count += 1;
    }
    assert!(count >= 9);
}
