//! What a plot shows: curves, limits, names of axes.

use crate::units::Units;

/// A plot and the name of its file.
pub type Panel = (String, Plot);

/// The colour of what belongs to several joints.
pub const NEUTRAL: usize = usize::MAX;

/// A curve; its colour is that of the joint.
pub struct Curve {
    pub name: String,
    pub color: usize,
    pub points: Vec<(f64, f64)>,
    pub look: Look,
}

#[derive(Clone, Copy, PartialEq)]
pub enum Look {
    /// Straight from point to point.
    Line,
    /// A smooth curve through the points.
    Smooth,
    /// A line with its points.
    Dotted,
    /// A limit that the motion must keep; not in the legend.
    Kept,
    /// A limit of the robot that the motion is only compared with; not in the legend.
    Compared,
}

/// One side of a limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// That of the curve that is limited.
    pub color: usize,
    pub is_upper: bool,
    /// Whether the motion must keep it; otherwise it is one of the robot, only compared.
    pub is_kept: bool,
    /// Its values over time: two points of a constant one.
    pub points: Vec<(f64, f64)>,
}

impl Limit {
    /// The value of a constant limit.
    pub fn constant(&self) -> Option<f64> {
        match self.points[..] {
            [(_, from), (_, to)] if from == to => Some(from),
            _ => None,
        }
    }
}

/// Where a plot belongs on the page.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Group {
    /// Positions and their derivatives.
    Joints,
    /// Torques, powers, energy.
    Actuation,
    /// Speeds of tools.
    Tools,
    /// Momenta, costates, H*, mesh, iterations.
    Solver,
}

/// Curves in one pair of axes.
pub struct Plot {
    pub title: String,
    /// What is drawn upwards.
    pub symbol: String,
    /// Units of revolute and prismatic joints, or one unit for all.
    pub units: Units,
    /// Colours of curves without a unit, those of quaternions.
    pub unitless: Vec<usize>,
    /// The unit as it is written at the axis.
    pub unit: String,
    pub x_label: &'static str,
    pub curves: Vec<Curve>,
    pub limits: Vec<Limit>,
    /// Whether the y axis is logarithmic.
    pub logarithmic: bool,
    /// Whether x is time.
    pub over_time: bool,
    /// Marked values on the x axis.
    pub marks: Vec<f64>,
    pub group: Group,
    /// Whether it is drawn smaller, to be shown in a grid.
    pub is_small: bool,
}

impl Plot {
    /// A plot over the time of the motion, without curves.
    pub fn over_time(title: impl Into<String>, symbol: impl Into<String>, group: Group) -> Self {
        Self {
            title: title.into(),
            symbol: symbol.into(),
            units: ["", ""],
            unitless: Vec::new(),
            unit: String::new(),
            x_label: "t (s)",
            curves: Vec::new(),
            limits: Vec::new(),
            logarithmic: false,
            over_time: true,
            marks: Vec::new(),
            group,
            is_small: false,
        }
    }

    /// The name of the upward axis.
    pub fn y_label(&self) -> String {
        if self.unit.is_empty() { self.symbol.clone() } else { format!("{} ({})", self.symbol, self.unit) }
    }
}
