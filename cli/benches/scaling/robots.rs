//! The robots to measure, with a state each: robot files, and serial chains with axes and inertias in general directions.

use crate::routes::{Failure, State};
use costate::robot::{JointSpec, LinkInertia, Placement, Robot};
use fastrand::Rng;

/// Numbers of joints of the chains; those up to [`SMALL`] are enough where only agreement is looked at.
const CHAINS: [usize; 5] = [2, 6, 12, 24, 48];
const SMALL: usize = 12;

/// Rotor inertia of every joint of a chain (kg m^2): keeps the mass matrix well conditioned, whatever the length.
const ARMATURE: f64 = 0.5;

/// A robot, and where its quantities are evaluated.
pub struct Case {
    /// Column of the tables.
    pub title: String,
    pub robot: Robot,
    pub state: State,
    /// Whether it is one of the chains, whose times make the plots.
    pub chain: bool,
}

impl Case {
    fn new(title: &str, robot: Robot, chain: bool) -> Result<Self, Failure> {
        let state = State::random(&robot, 1)?;
        Ok(Self { title: format!("{title}, n = {}", robot.len()), robot, state, chain })
    }

    /// The files, then the chains by length; only the small ones where `all` is false.
    pub fn list(all: bool) -> Result<Vec<Self>, Failure> {
        let mut cases = Vec::new();
        for (title, file) in [("UR5", "ur5.urdf"), ("Panda", "panda.urdf"), ("biped", "biped.toml")] {
            let robot = Robot::from_file(format!("{}/robots/{file}", crate::ROOT))?;
            cases.push(Self::new(title, robot, false)?);
        }
        for n in CHAINS.into_iter().filter(|&n| all || n <= SMALL) {
            cases.push(Self::new("chain", chain(n)?, true)?);
        }
        Ok(cases)
    }
}

/// n revolute joints one on another, all directions, lengths and inertias random with a fixed seed.
///
/// A link: mass 0.5 to 1.5 kg, centre of mass and next joint up to 0.2 m away along each axis, a diagonal inertia about
/// the centre of mass of 0.04 to 0.06 kg m^2 (the random turn of each joint makes it general in every other frame).
fn chain(n: usize) -> Result<Robot, Failure> {
    let mut random = Rng::with_seed(24_2005);
    let mut builder = Robot::builder(format!("chain_{n}"));
    for i in 0..n {
        let mut numbers =
            |most: f64| -> [f64; 3] { std::array::from_fn(|_| most * (2.0 * random.f64() - 1.0)) };
        let [offset, turns, axis, com] = [numbers(0.2), numbers(3.0), numbers(1.0), numbers(0.2)];
        let inertia = numbers(0.01).map(|spread| 0.05 + spread);
        let link = LinkInertia::about_com(
            0.5 + random.f64(),
            com,
            [[inertia[0], 0.0, 0.0], [0.0, inertia[1], 0.0], [0.0, 0.0, inertia[2]]].into(),
        );
        let mut joint = JointSpec::revolute(format!("joint_{i}"))
            .axis(axis)
            .placed(Placement::from_xyz_rpy(offset, turns))
            .carrying(link)
            .armature(ARMATURE);
        if i > 0 {
            joint = joint.on(format!("joint_{}", i - 1));
        }
        builder = builder.joint(joint);
    }
    Ok(builder.build()?)
}
