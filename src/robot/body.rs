//! Whose mass and inertia are meant.

use super::printable::printable;
use std::fmt;

/// The body that an error or a warning is about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Body {
    /// A link, by its name.
    Link(String),
    /// What is attached to a frame, by the name of the frame.
    Payload(String),
}

impl Body {
    pub(super) fn link(name: &str) -> Self {
        Self::Link(name.to_owned())
    }

    /// The name of the link, or of the frame that carries the payload.
    pub fn name(&self) -> &str {
        match self {
            Self::Link(name) | Self::Payload(name) => name,
        }
    }
}

/// `link 'forearm'`, or `the payload of frame 'tool'`.
impl fmt::Display for Body {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Link(name) => write!(f, "link '{}'", printable(name)),
            Self::Payload(name) => write!(f, "the payload of frame '{}'", printable(name)),
        }
    }
}
