//! What a robot keeps away from, and with what.

use costate::robot::Placement;

/// Something in the world that the robot does not touch.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Obstacle {
    /// Its name, for messages and [`Collision::except`].
    pub name: String,
    /// Its shape and place.
    pub shape: Shape,
}

/// A shape in the world.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// A ball.
    Sphere {
        /// Its centre (m).
        centre: [f64; 3],
        /// Its radius (m).
        radius: f64,
    },
    /// All points within a radius of a segment.
    Capsule {
        /// One end of the segment (m).
        from: [f64; 3],
        /// The other end (m).
        to: [f64; 3],
        /// The radius (m).
        radius: f64,
    },
    /// A box.
    Box {
        /// Its centre and its axes.
        placement: Placement,
        /// The lengths of its edges (m).
        size: [f64; 3],
    },
    /// All that lies behind a plane: a floor, a wall.
    HalfSpace {
        /// A point of the plane (m).
        through: [f64; 3],
        /// The normal of the plane, to the free side; it need not have length one.
        normal: [f64; 3],
    },
}

impl Obstacle {
    /// A shape with a name.
    pub fn new(name: impl Into<String>, shape: Shape) -> Self {
        Self { name: name.into(), shape }
    }
}

/// A sphere or capsule that a link carries.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LinkCapsule {
    /// Its name, for messages and pairs.
    pub name: String,
    /// Name of the frame that carries it, as [`Robot::frame`](costate::robot::Robot::frame) finds it.
    pub frame: String,
    /// One end of its segment, or the centre of the sphere, in that frame (m).
    pub from: [f64; 3],
    /// The other end (m); `None` for a sphere.
    pub to: Option<[f64; 3]>,
    /// Its radius (m); 0 for a point or a segment, which need obstacles with a radius, half-spaces, or a
    /// margin.
    pub radius: f64,
}

impl LinkCapsule {
    /// A sphere around the origin of a frame, with the name of the frame.
    pub fn sphere(frame: impl Into<String>, radius: f64) -> Self {
        let frame = frame.into();
        Self { name: frame.clone(), frame, from: [0.0; 3], to: None, radius }
    }

    /// A capsule from one point of a frame to another one, with the name of the frame.
    pub fn new(frame: impl Into<String>, from: [f64; 3], to: [f64; 3], radius: f64) -> Self {
        Self { from, to: Some(to), ..Self::sphere(frame, radius) }
    }

    /// With the centre of the sphere, or one end, here (m).
    #[must_use]
    pub fn with_from(self, from: [f64; 3]) -> Self {
        Self { from, ..self }
    }

    /// With this name.
    #[must_use]
    pub fn with_name(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }
}

/// The bodies of a robot that touch neither obstacles nor, where asked for, each other.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Collision {
    /// Spheres and capsules on links.
    pub capsules: Vec<LinkCapsule>,
    /// The radius (m) of capsules that are laid along the links by themselves, `None` for no such capsules:
    /// from each joint to each joint that its link carries, or to the farthest frame of a link that carries
    /// none. They have the names of the links; the second one of a link ends in ` 2`.
    pub along_links: Option<f64>,
    /// The distance that is kept beyond the surfaces (m).
    pub margin: f64,
    /// The pairs of bodies that do not touch each other, besides the obstacles.
    pub pairs: BodyPairs,
    /// Pairs that may touch: two bodies, or a body and an obstacle, by their names.
    pub except: Vec<[String; 2]>,
}

/// Pairs of bodies of one robot.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum BodyPairs {
    /// None: only obstacles count.
    #[default]
    None,
    /// All on links that are not neighbours.
    All,
    /// These, by their names.
    These(Vec<[String; 2]>),
}

impl Collision {
    /// These bodies, against obstacles alone.
    pub fn of(capsules: Vec<LinkCapsule>) -> Self {
        Self { capsules, ..Self::default() }
    }

    /// Capsules of this radius (m) along all links, against obstacles alone.
    pub fn along_links(radius: f64) -> Self {
        Self { along_links: Some(radius), ..Self::default() }
    }

    /// With this distance beyond the surfaces (m).
    #[must_use]
    pub fn with_margin(self, margin: f64) -> Self {
        Self { margin, ..self }
    }

    /// With these pairs of bodies.
    #[must_use]
    pub fn with_pairs(self, pairs: BodyPairs) -> Self {
        Self { pairs, ..self }
    }

    /// With one more pair that may touch.
    #[must_use]
    pub fn with_exception(mut self, a: impl Into<String>, b: impl Into<String>) -> Self {
        self.except.push([a.into(), b.into()]);
        self
    }
}
