//! What is odd about the description of a robot.

/// Something odd that does not stop the computation.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// A link that has neither mass nor inertia, though it moves.
    MasslessLink {
        /// The link.
        link: String,
    },
    /// Principal moments that no rigid body has.
    TriangleInequality {
        /// The link.
        link: String,
        /// Principal moments (kg m^2), rising.
        moments: [f64; 3],
    },
    /// Mass on the axis of the last joint only: M is singular in every pose.
    OnAxis {
        /// The joint.
        joint: String,
    },
    /// Damping and friction in `<dynamics>` of a URDF that were left out.
    FrictionIgnored {
        /// The joints.
        joints: Vec<String>,
    },
    /// A joint of several degrees of freedom, expanded.
    Expanded {
        /// The joint.
        joint: String,
        /// `"floating"` or `"planar"`.
        kind: &'static str,
    },
    /// Anything else worth saying about the file.
    Note {
        /// The whole sentence.
        text: String,
    },
}

impl Warning {
    /// Whether it says that the robot is not a physical one; strict checking refuses these.
    pub fn is_physical(&self) -> bool {
        matches!(self, Self::MasslessLink { .. } | Self::TriangleInequality { .. } | Self::OnAxis { .. })
    }
}

impl std::fmt::Display for Warning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::MasslessLink { link } => write!(f, "link '{link}' moves but has neither mass nor inertia"),
            Self::TriangleInequality { link, moments: [a, b, c] } => write!(
                f,
                "no rigid body has the principal moments of link '{link}', ({a:.4e}, {b:.4e}, {c:.4e}) kg m^2: \
                 the largest exceeds the sum of the others"
            ),
            Self::OnAxis { joint } => write!(
                f,
                "joint '{joint}' only turns mass that lies on its axis, so the mass matrix is singular in every pose: \
                 give its link an inertia or give it armature"
            ),
            Self::FrictionIgnored { joints } => {
                write!(f, "<dynamics> is left out, ask for it with --friction: joints {}", joints.join(", "))
            }
            Self::Expanded { joint, kind: "floating" } => write!(
                f,
                "floating joint '{joint}' became three prismatic (x, y, z) and three revolute joints (z, y, x), \
                 singular where the second angle is +-pi/2"
            ),
            Self::Expanded { joint, kind } => {
                write!(f, "{kind} joint '{joint}' became two prismatic and one revolute joint")
            }
            Self::Note { text } => f.write_str(text),
        }
    }
}
