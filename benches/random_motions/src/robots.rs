//! Random trees, and the real robots of the folder `robots` with random rotors and dry friction.

use crate::draw::Draw;
use crate::text::{Case, RobotFile, list};
use costate::robot::{Friction, LoadOptions, Robot};
use nalgebra::{Matrix3, Rotation3};
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt::Write;

/// What a random tree may have.
#[derive(Clone, Copy)]
pub struct Tree {
    pub joints: (usize, usize),
    /// Probability that a joint has dry friction.
    pub dry: f64,
    /// Probability that a joint has a spring.
    pub spring: f64,
    /// Probability that a joint mimics the one before.
    pub mimic: f64,
    /// Probability of a joint that slides.
    pub slides: f64,
    /// Probability of a rotor.
    pub rotor: f64,
}

pub const TREE: Tree = Tree { joints: (2, 7), dry: 0.0, spring: 0.0, mimic: 0.0, slides: 0.2, rotor: 0.85 };

/// Dry friction: coulomb 0.1 to 10, transition 1e-3 to 0.3 rad/s; half of the joints have viscous friction
/// too, 0.01 to 5.
fn dry(draw: &mut Draw) -> [f64; 3] {
    let viscous = if draw.chance(0.5) { draw.log(0.01..5.0) } else { 0.0 };
    [viscous, draw.log(0.1..10.0), draw.log(1e-3..0.3)]
}

/// A random tree at random positions, with a time for a quintic from start to end.
pub fn tree(draw: &mut Draw, of: Tree) -> Result<Case, String> {
    let n = draw.whole(of.joints.0..of.joints.1 + 1);
    let gravity = *draw.one(&[9.81, 9.81, 9.81, 0.0]);
    let mut text = format!(
        "name = \"random tree\"\ngravity = [0.0, 0.0, {:?}]\nconvention = \"placements\"\n",
        -gravity
    );
    let mut slides = Vec::new();
    let mut mimics = Vec::new();
    for i in 0..n {
        let slide = draw.chance(of.slides);
        let parent = if i == 0 || draw.chance(0.85) { i } else { draw.whole(0..i) };
        let parent = if parent == 0 { "world".into() } else { format!("j{parent}") };
        let xyz = match draw.chance(0.15) || i == 0 {
            true => vec![0.0; 3],
            false => draw.list(3, -0.5..0.5),
        };
        let rpy = match draw.chance(0.5) {
            true => draw.list(3, -PI..PI),
            false => (0..3).map(|_| *draw.one(&[0.0, 0.0, FRAC_PI_2, -FRAC_PI_2])).collect(),
        };
        let axis = *draw.one(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        let mass = draw.log(0.5..10.0) * 0.8_f64.powi(i as i32);
        let com = draw.list(3, -0.2..0.2);
        let inertia = inertia(draw, mass);
        let _ = write!(text, "\n[[joint]]\nname = \"j{}\"\nparent = \"{parent}\"\n", i + 1);
        if slide {
            text.push_str("type = \"prismatic\"\n");
        }
        let _ = write!(
            text,
            "axis = {}\nplacement = {{ xyz = {}, rpy = {} }}\nmass = {mass:?}\ncom = {}\n\
             inertia = {{ xx = {:?}, yy = {:?}, zz = {:?}, xy = {:?}, xz = {:?}, yz = {:?} }}\n",
            list(&axis),
            list(&xyz),
            list(&rpy),
            list(&com),
            inertia[(0, 0)],
            inertia[(1, 1)],
            inertia[(2, 2)],
            inertia[(0, 1)],
            inertia[(0, 2)],
            inertia[(1, 2)],
        );
        if draw.chance(of.rotor) {
            let _ = writeln!(text, "armature = {:?}", draw.log(0.01..2.0));
        }
        if i > 0 && !mimics.contains(&(i - 1)) && draw.chance(of.mimic) {
            let ratio = *draw.one(&[-1.0, 1.0, 0.5, 2.0]);
            let _ = writeln!(
                text,
                "mimic = {{ joint = \"j{i}\", ratio = {ratio:?}, offset = {:?} }}",
                draw.even(-0.5..0.5)
            );
            mimics.push(i);
        } else {
            slides.push(slide);
        }
        if draw.chance(of.spring) {
            let _ = writeln!(
                text,
                "spring = {{ stiffness = {:?}, rest = {:?} }}",
                draw.log(1.0..1e4),
                draw.even(-0.5..0.5)
            );
        }
        if draw.chance(of.dry) {
            let [viscous, coulomb, width] = dry(draw);
            let _ = writeln!(
                text,
                "friction = {{ viscous = {viscous:?}, coulomb = {coulomb:?}, coulomb_velocity = {width:?} }}"
            );
        } else if draw.chance(0.3) {
            let _ = writeln!(text, "friction = {{ viscous = {:?} }}", draw.log(0.01..5.0));
        }
    }
    let robot = Robot::from_toml_str(&text, LoadOptions::default()).map_err(|error| error.to_string())?;
    let mut from = Vec::new();
    let mut to = Vec::new();
    for &slide in &slides {
        let (range, way) = if slide { (0.4, 0.5) } else { (1.5, 1.5) };
        let start = draw.even(-range..range);
        from.push(start);
        to.push(if draw.chance(0.15) { start } else { start + draw.even(-way..way) });
    }
    if from == to {
        to[0] += 0.5;
    }
    let time = draw.log(0.5..4.0);
    let mut case = Case::new(robot, RobotFile::Text(text), from, to, time);
    effort(&mut case, draw)?;
    Ok(case)
}

/// The inertia of a box with random edges (0.05 to 0.5 m), turned at random.
fn inertia(draw: &mut Draw, mass: f64) -> Matrix3<f64> {
    let squares: [f64; 3] = std::array::from_fn(|_| mass / 12.0 * draw.even(0.05..0.5).powi(2));
    let moments = Matrix3::from_diagonal(&nalgebra::Vector3::new(
        squares[1] + squares[2],
        squares[0] + squares[2],
        squares[0] + squares[1],
    ));
    let turn = Rotation3::from_euler_angles(draw.even(-PI..PI), draw.even(-1.5..1.5), draw.even(-PI..PI));
    let turned = turn.matrix() * moments * turn.matrix().transpose();
    0.5 * (turned + turned.transpose())
}

/// Weights of effort: 1, or 1 over the squares of the largest torques of the quintic.
pub fn effort(case: &mut Case, draw: &mut Draw) -> Result<(), String> {
    let weights = match draw.chance(0.5) {
        true => vec![1.0; case.dof()],
        false => case.peaks()?.torque.iter().map(|tau| tau.max(0.1).powi(-2)).collect(),
    };
    case.set("cost", "effort", list(&weights));
    Ok(())
}

/// A real robot: its file, home position, the range around it, ranges of rotors (none: as in the file).
struct Real {
    file: &'static str,
    home: &'static [f64],
    range: f64,
    way: f64,
    rotors: &'static [f64],
    time: (f64, f64),
}

const REAL: [Real; 6] = [
    Real {
        file: "robots/ur5.urdf",
        home: &[0.0, -1.4, 1.6, -1.6, -1.5, 0.0],
        range: 0.6,
        way: 1.2,
        rotors: &[1.0, 1.0, 1.0, 0.2, 0.2, 0.2],
        time: (0.7, 4.0),
    },
    Real {
        file: "robots/panda.urdf",
        home: &[0.0, -0.3, 0.0, -1.8, 0.0, 1.6, 0.5],
        range: 0.4,
        way: 0.9,
        rotors: &[0.5, 0.5, 0.5, 0.5, 0.15, 0.15, 0.15],
        time: (0.7, 4.0),
    },
    Real {
        file: "robots/puma560.toml",
        home: &[0.0, -0.5, 1.0, 0.0, 0.5, 0.0],
        range: 0.5,
        way: 1.2,
        rotors: &[],
        time: (0.5, 3.0),
    },
    Real {
        file: "robots/manutec_r3.toml",
        home: &[0.0, 0.5, 0.5],
        range: 0.8,
        way: 1.5,
        rotors: &[],
        time: (0.5, 3.0),
    },
    Real {
        file: "robots/two_link.toml",
        home: &[0.0, 0.3],
        range: 1.0,
        way: 2.0,
        rotors: &[],
        time: (0.5, 4.0),
    },
    Real { file: "robots/pendulum.toml", home: &[0.5], range: 1.5, way: 3.0, rotors: &[], time: (0.5, 6.0) },
];

/// A real robot; `dry` is the probability that a joint has dry friction, `arms` leaves out those of fewer
/// than six joints.
pub fn real(draw: &mut Draw, dry_share: f64, arms: bool) -> Result<Case, String> {
    let real = draw.one(if arms { &REAL[..3] } else { &REAL[..] });
    let path = std::path::Path::new(crate::folder::FOLDER).join("../..").join(real.file);
    let mut robot = Robot::from_file(path).map_err(|error| error.to_string())?;
    let names: Vec<String> = robot.independent_joints().map(|joint| joint.name.clone()).collect();
    let (mut rotors, mut frictions) = (String::new(), String::new());
    for (i, name) in names.iter().enumerate() {
        if let Some(typical) = real.rotors.get(i) {
            let rotor = typical * draw.log(0.5..2.0);
            robot = robot.with_joint_armature(name, rotor).map_err(|error| error.to_string())?;
            let _ = writeln!(rotors, "{name} = {rotor:?}");
        }
        if draw.chance(dry_share) {
            let [viscous, coulomb, coulomb_velocity] = dry(draw);
            let friction = Friction { viscous, coulomb, coulomb_velocity };
            robot = robot.with_friction(name, friction).map_err(|error| error.to_string())?;
            let _ = writeln!(
                frictions,
                "{name} = {{ viscous = {viscous:?}, coulomb = {coulomb:?}, coulomb_velocity = {coulomb_velocity:?} }}"
            );
        }
    }
    let from: Vec<f64> = real.home.iter().map(|home| home + draw.even(-real.range..real.range)).collect();
    let to = from.iter().map(|from| from + draw.even(-real.way..real.way)).collect();
    let time = draw.log(real.time.0..real.time.1);
    let mut case = Case::new(robot, RobotFile::Real(real.file), from, to, time);
    if !rotors.is_empty() {
        let _ = write!(case.edits, "[robot.armature]\n{rotors}");
    }
    if !frictions.is_empty() {
        let _ = write!(case.edits, "[robot.friction]\n{frictions}");
    }
    case.set("limits", "from_robot", "false");
    case.part(real.file.rsplit('/').next().unwrap_or(real.file));
    effort(&mut case, draw)?;
    Ok(case)
}

/// A tree or a real robot.
pub fn any(draw: &mut Draw, dry: f64) -> Result<Case, String> {
    match draw.chance(0.6) {
        true => tree(draw, Tree { dry, ..TREE }),
        false => real(draw, dry, false),
    }
}

/// A limit of each joint: its peak times a factor, at least `least`.
pub fn scaled(
    case: &mut Case,
    draw: &mut Draw,
    key: &str,
    peaks: &[f64],
    factor: std::ops::Range<f64>,
    least: f64,
) {
    let factor = draw.even(factor);
    let limits: Vec<f64> = peaks.iter().map(|peak| (factor * peak).max(least)).collect();
    case.set("limits", key, list(&limits));
    if !case.has("limits", "from_robot") {
        case.set("limits", "from_robot", "false");
    }
}

/// Limits of rates: 0.8 to 2 times the peaks.
pub fn limit_rates(case: &mut Case, draw: &mut Draw) -> Result<(), String> {
    let peaks = case.peaks()?;
    scaled(case, draw, "v_max", &peaks.v, 0.8..2.0, 0.3);
    case.part("v_max");
    Ok(())
}
