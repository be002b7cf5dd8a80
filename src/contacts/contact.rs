//! Places of links that can stand on the ground.

use crate::robot::{ConstraintRow, ConstraintSpec, Placement, RobotError};
use nalgebra::{Matrix3, Vector3};

/// Force (N) by which a smooth friction cone is narrower, where none is given.
const SMOOTHING: f64 = 0.1;

/// A place of a link that can stand on the ground, and what the ground can bear there.
///
/// The frame of the contact is a frame of the robot, displaced by [`placed`](Self::placed). The ground is a
/// plane through the origin of the ground's axes, which are those of the world if [`on`](Self::on) and
/// [`up`](Self::up) are not called: z is its normal.
///
/// ```
/// use costate::contacts::{Contact, Sole};
/// use costate::robot::Placement;
///
/// let below = Placement::from_xyz_rpy([0.0, 0.0, -0.07], [0.0; 3]);
/// let foot = Contact::foot("left", "left_ankle").placed(below).friction(0.7);
/// let foot = foot.sole(Sole { x: [-0.05, 0.2], y: [-0.04, 0.04] });
/// assert_eq!(foot.name(), "left");
/// ```
#[derive(Clone, Debug, PartialEq)]
#[must_use = "a contact does nothing until it is part of a stance"]
pub struct Contact {
    name: String,
    frame: String,
    placement: Placement,
    ground: Placement,
    pub(super) turns: bool,
    pub(super) planar: bool,
    pub(super) friction: Option<f64>,
    pub(super) smoothing: f64,
    pub(super) torsion: Option<f64>,
    pub(super) sole: Option<Sole>,
}

/// The rectangle of a foot that can press on the ground, in the axes of the ground, from the origin of the
/// contact (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sole {
    /// Least and greatest x.
    pub x: [f64; 2],
    /// Least and greatest y.
    pub y: [f64; 2],
}

impl Contact {
    fn new(name: impl Into<String>, frame: &str, turns: bool) -> Self {
        Self {
            name: name.into(),
            frame: frame.to_owned(),
            placement: Placement::identity(),
            ground: Placement::identity(),
            turns,
            planar: false,
            friction: None,
            smoothing: SMOOTHING,
            torsion: None,
            sole: None,
        }
    }

    /// A point that the ground holds: three forces.
    pub fn point(name: impl Into<String>, frame: &str) -> Self {
        Self::new(name, frame, false)
    }

    /// A foot that the ground holds with its orientation: three forces and three moments.
    ///
    /// Where it stands, the axes of the contact are those of the ground: turn them by
    /// [`placed`](Self::placed) and [`on`](Self::on) so that this is true, the heading of the foot included.
    /// Its multipliers are moments about these axes there.
    pub fn foot(name: impl Into<String>, frame: &str) -> Self {
        Self::new(name, frame, true)
    }

    /// Only what moves in the plane of x and z of the ground: forces along x and z, for a foot the moment
    /// about y. For planar robots; without it what their joints hold already is redundant, and left out.
    pub fn planar(mut self) -> Self {
        self.planar = true;
        self
    }

    /// The contact in the frame that is named; the frame itself if this is not called.
    pub fn placed(mut self, placement: Placement) -> Self {
        self.placement = placement;
        self
    }

    /// The axes of the ground in the world, and where on it the contact is at g = 0. A stance holds contacts
    /// where they are, so that the origin matters for
    /// [`close`](crate::constraints::ConstrainedHamiltonian::close) alone.
    pub fn on(mut self, ground: Placement) -> Self {
        self.ground = ground;
        self
    }

    /// Ground through the world's origin with this normal (of any length, in the axes of the world). Its x
    /// axis is that of the world, projected onto it; if that is the normal, the y axis.
    pub fn up(self, normal: [f64; 3]) -> Self {
        let z = Vector3::from(normal).normalize();
        let forward = if z.x.abs() < 0.999 { Vector3::x() } else { Vector3::y() };
        let x = (forward - z * z.dot(&forward)).normalize();
        let rotation = Matrix3::from_columns(&[x, z.cross(&x), z]);
        self.on(Placement { rotation, translation: Vector3::zeros() })
    }

    /// The coefficient of friction: tangential forces of at most this part of the normal force.
    pub fn friction(mut self, coefficient: f64) -> Self {
        self.friction = Some(coefficient);
        self
    }

    /// By how much the smooth cone is narrower than the exact one (N): 0.1 if this is not called. See
    /// [`MarginKind::Friction`](super::MarginKind::Friction).
    pub fn smoothing(mut self, force: f64) -> Self {
        self.smoothing = force;
        self
    }

    /// Most moment about the normal, in parts of the normal force (m). For feet.
    pub fn torsion(mut self, length: f64) -> Self {
        self.torsion = Some(length);
        self
    }

    /// Where the centre of pressure has to stay. For feet.
    pub fn sole(mut self, sole: Sole) -> Self {
        self.sole = Some(sole);
        self
    }

    /// Its name, which is that of its constraint.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What the ground holds, in the order of [`ConstraintRow::ALL`].
    pub fn rows(&self) -> &'static [ConstraintRow] {
        use ConstraintRow::{TurnY, X, Y, Z};
        match (self.turns, self.planar) {
            (false, false) => &[X, Y, Z],
            (false, true) => &[X, Z],
            (true, false) => &ConstraintRow::ALL,
            (true, true) => &[X, Z, TurnY],
        }
    }

    /// The constraint that holds it.
    pub fn constraint(&self) -> ConstraintSpec {
        let spec = ConstraintSpec::rows(&*self.name, &self.frame, "world", self.rows());
        spec.placed(self.placement).to_placed(self.ground)
    }

    /// Numbers that can be used.
    pub(super) fn check(&self) -> Result<(), RobotError> {
        let bad = |problem| Err(RobotError::BadConstraint { constraint: self.name.clone(), problem });
        let positive = |value: Option<f64>| value.is_none_or(|value| value.is_finite() && value > 0.0);
        if !positive(self.friction) {
            return bad("its coefficient of friction must be positive and finite; leave it out for no limit");
        }
        if !positive(Some(self.smoothing)) {
            return bad("its smoothing must be positive and finite (N)");
        }
        if !positive(self.torsion) {
            return bad("its torsion must be positive and finite (m); leave it out for no limit");
        }
        if !self.turns && (self.sole.is_some() || self.torsion.is_some()) {
            return bad("it is a point, which bears no moment: a sole and torsion are for `Contact::foot`");
        }
        if let Some(Sole { x, y }) = self.sole {
            let is_range = |[least, most]: [f64; 2]| least.is_finite() && most.is_finite() && least < most;
            if !is_range(x) || (!self.planar && !is_range(y)) {
                return bad("its sole must reach from a smaller to a larger x and y (m)");
            }
        }
        Ok(())
    }
}
