//! The gait of a walking robot, as the user gives it.

use costate::robot::SymmetryChange;

/// A gait of a robot that repeats itself mirrored after each step: a walk on two legs,
/// a trot on four. The motion is one step of it, from one landing to the next.
///
/// During the step some feet stand on the ground, pinned by forces within their friction cones, and as many
/// others swing. At the end these land: an inelastic impact changes the velocities, the first ones leave the
/// ground, and the legs change their roles. With the permutation S that exchanges the legs and the length
/// L of the step, the state after it is the one with which the step began:
///
/// $$ q(0) = S q(T) - L e_x, \qquad M v(0) - J^\top \Lambda = S M v(T), \qquad J v(0) = 0 $$
///
/// J is that of the feet that stand during the step, and $\Lambda$ the impulses with which they landed. The
/// ground is the plane z = 0 of the world, gravity along -z, and the robot moves in the plane of x and z: its
/// first joints are those of a body in that plane, without motors. The first foot that stands is at the
/// origin.
///
/// A robot [in space](Self::in_space) has six such joints, and S is its reflection in the plane of x and z:
/// it exchanges the legs and changes the signs of the joints that are [flipped](Self::flipped).
///
/// ```
/// use costate_control::{MotionLimits, Objective, Problem, Gait};
/// use costate::robot::Robot;
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/rabbit.toml")?;
/// let q = [-0.25, 0.72, 0.1, 0.1, 0.3, -0.6, 0.3];
/// let gait = Gait::new(&["right_foot"], &["left_foot"], "base_x", 0.5)
///     .with_mirror(&[["left_hip", "right_hip"], ["left_knee", "right_knee"]]);
/// let most = [[0.0; 3].as_slice(), &[150.0; 4]].concat();
/// let effort = [[0.0; 3].as_slice(), &[1.0; 4]].concat();
/// let problem = Problem::rest_to_rest(robot, &q, &q, 0.7)
///     .with_cost(Objective::new(0.0, effort))
///     .with_limits(MotionLimits::none().with_torque_max(most))
///     .with_gait(gait);
/// problem.check_for(costate_control::Method::Direct)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Gait {
    /// The frames that stand on the ground during the step: points, or origins of soles.
    pub stance: Vec<String>,
    /// For each of them the one that lands in its place, one step ahead, at the end.
    pub swing: Vec<String>,
    /// The joint that moves the whole robot along x of the world: prismatic, without a motor.
    pub along: String,
    /// Length of the step (m).
    pub length: f64,
    /// Coefficient of friction of the ground, for forces and impulses.
    pub friction: f64,
    /// How high feet that swing are above the ground at least, halfway (m): each stays above the parabola of
    /// this height whose ends are its places before and after the step.
    pub clearance: f64,
    /// Pairs of joints that change places when the legs change their roles.
    pub mirror: Vec<[String; 2]>,
    /// x of heel and toe in the frames of the feet (m), where these have soles; points if there are none. A
    /// foot that stands is flat on the ground: x of its frame is ahead and z up. The ground pushes heel and
    /// toe with forces in their friction cones, so that the centre of pressure is between them.
    pub sole: Option<[f64; 2]>,
    /// The part of the step, more than 0 and less than 1, that all feet stand on the ground, from its start
    /// on; `None`: the feet behind leave it when those in front land.
    ///
    /// With such a phase of double support the feet that land come to rest on the ground before they bear,
    /// without an impulse:
    ///
    /// $$ q(0) = S q(T) - L e_x, \qquad v(0) = S v(T), \qquad J v(0) = 0 $$
    ///
    /// With one the ground would have to pull the feet behind, or these would leave it at once. At the end of
    /// the phase they leave the ground without an impulse either: positions and rates do not jump. Soles in
    /// front stand flat, those behind as [`trailing`](Self::trailing) says. In a free time both phases
    /// stretch in proportion.
    pub double_support: Option<f64>,
    /// How soles behind stand in the phase of double support, their toes alone unless said otherwise.
    pub trailing: SoleContact,
    /// Joints that change their signs in the mirror, those of pairs too: of a robot in space those whose
    /// motion is along y or turns about x and z. A robot in the plane has none.
    pub flipped: Vec<String>,
    /// In space, the distance of the lines along x on which left and right feet stand (m), both at half of it
    /// from the plane y = 0 of the mirror: the first foot that stands is not at the origin but beside it.
    pub width: f64,
    /// In space, how wide soles are (m), half of it to either side of x of the frames of the feet.
    pub sole_width: f64,
    /// What was changed of the robot, if it is its mean with its mirror image
    /// ([`Problem::with_symmetric_robot`](crate::Problem::with_symmetric_robot)).
    pub symmetrised: Option<SymmetryChange>,
}

/// How a sole stands on the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SoleContact {
    /// On its toe alone, which is pinned, in space with all of its edge: the foot rolls about it, and its
    /// heel may rise but not sink.
    Toe,
    /// As a whole.
    Flat,
}

impl Gait {
    /// Coefficient of friction where none is given.
    pub const FRICTION: f64 = 0.6;

    /// Steps of this length (m) with the friction 0.6 and no clearance, of a robot whose joints stay in
    /// their places. Frames and the joint are named.
    pub fn new(stance: &[&str], swing: &[&str], along: &str, length: f64) -> Self {
        let [stance, swing] = [stance, swing].map(|feet| feet.iter().map(|&foot| foot.to_owned()).collect());
        let along = along.to_owned();
        Self {
            stance,
            swing,
            along,
            length,
            friction: Self::FRICTION,
            clearance: 0.0,
            mirror: Vec::new(),
            sole: None,
            double_support: None,
            trailing: SoleContact::Toe,
            flipped: Vec::new(),
            width: 0.0,
            sole_width: 0.0,
            symmetrised: None,
        }
    }

    /// In space, with these joints that change their signs in the mirror, and with left and right feet on
    /// lines at this distance (m).
    #[must_use]
    pub fn in_space(self, flipped: &[&str], width: f64) -> Self {
        Self { flipped: flipped.iter().map(|&joint| joint.to_owned()).collect(), width, ..self }
    }

    /// With soles as wide as this (m), in space.
    #[must_use]
    pub fn with_sole_width(self, sole_width: f64) -> Self {
        Self { sole_width, ..self }
    }

    /// With this coefficient of friction.
    #[must_use]
    pub fn with_friction(self, friction: f64) -> Self {
        Self { friction, ..self }
    }

    /// With this height of feet that swing, halfway (m).
    #[must_use]
    pub fn with_clearance(self, clearance: f64) -> Self {
        Self { clearance, ..self }
    }

    /// With soles from heel to toe, x in the frames of the feet (m).
    #[must_use]
    pub fn with_sole(self, heel: f64, toe: f64) -> Self {
        Self { sole: Some([heel, toe]), ..self }
    }

    /// With all feet on the ground for this part of the step, from its start on.
    #[must_use]
    pub fn with_double_support(self, share: f64) -> Self {
        Self { double_support: Some(share), ..self }
    }

    /// With soles behind that stand so in the phase of double support.
    #[must_use]
    pub fn with_trailing(self, trailing: SoleContact) -> Self {
        Self { trailing, ..self }
    }

    /// With these pairs of joints that change places.
    #[must_use]
    pub fn with_mirror(self, pairs: &[[&str; 2]]) -> Self {
        Self { mirror: pairs.iter().map(|pair| pair.map(str::to_owned)).collect(), ..self }
    }
}
