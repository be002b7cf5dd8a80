//! Names of the fields of a problem.

use std::fmt;

/// A field of a problem or of the solver's options, with its place in a problem file. Prints as
/// `bounds.u_min`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Key {
    table: &'static str,
    name: &'static str,
    field: &'static str,
    /// Number of the entry in a list of tables, from 0.
    entry: usize,
}

impl Key {
    pub(crate) const ROBOT: Self = Self::new("robot", "file", "robot");
    pub(crate) const ROBOT_GRAVITY: Self = Self::new("robot", "gravity", "robot.gravity");
    pub(crate) const START_Q: Self = Self::new("start", "q", "start.q");
    pub(crate) const START_V: Self = Self::new("start", "v", "start.v");
    pub(crate) const START_A: Self = Self::new("start", "a", "start.a");
    pub(crate) const START_Q_FREE: Self = Self::new("start", "q_free", "start.q_free");
    pub(crate) const START_V_FREE: Self = Self::new("start", "v_free", "start.v_free");
    pub(crate) const END_Q: Self = Self::new("end", "q", "end.q");
    pub(crate) const END_V: Self = Self::new("end", "v", "end.v");
    pub(crate) const END_A: Self = Self::new("end", "a", "end.a");
    pub(crate) const END_Q_FREE: Self = Self::new("end", "q_free", "end.q_free");
    pub(crate) const END_V_FREE: Self = Self::new("end", "v_free", "end.v_free");
    pub(crate) const FINAL_TIME: Self = Self::new("time", "final", "time");
    pub(crate) const FREE_TIME: Self = Self::new("time", "free", "time");
    pub(crate) const TIME_GUESS: Self = Self::new("time", "guess", "time");
    pub(crate) const COST_TIME: Self = Self::new("cost", "time", "cost.time");
    pub(crate) const EFFORT: Self = Self::new("cost", "effort", "cost.effort");
    pub(crate) const ENERGY: Self = Self::new("cost", "energy", "cost.energy");
    pub(crate) const ENERGY_SMOOTHING: Self = Self::new("cost", "energy_smoothing", "cost.energy_smoothing");
    pub(crate) const TORQUE_RATE: Self = Self::new("cost", "torque_rate", "cost.torque_rate");
    pub(crate) const JERK: Self = Self::new("cost", "jerk", "cost.jerk");
    /// User terms, which problem files do not have.
    pub(crate) const TERMS: Self = Self::new("cost", "terms", "terms");
    pub(crate) const GAIN: Self = Self::new("actuation", "gain", "gain");
    pub(crate) const U_MIN: Self = Self::new("bounds", "u_min", "bounds.u_min");
    pub(crate) const U_MAX: Self = Self::new("bounds", "u_max", "bounds.u_max");
    pub(crate) const PENALTY_WEIGHT: Self = Self::new("penalty", "weight", "penalty.weight");
    pub(crate) const Q_MIN: Self = Self::new("penalty", "q_min", "penalty.q_min");
    pub(crate) const Q_MAX: Self = Self::new("penalty", "q_max", "penalty.q_max");
    pub(crate) const V_MAX: Self = Self::new("penalty", "v_max", "penalty.v_max");
    pub(crate) const LIMIT_Q_MIN: Self = Self::new("limits", "q_min", "limits.q_min");
    pub(crate) const LIMIT_Q_MAX: Self = Self::new("limits", "q_max", "limits.q_max");
    pub(crate) const LIMIT_V_MAX: Self = Self::new("limits", "v_max", "limits.v_max");
    pub(crate) const LIMIT_A_MAX: Self = Self::new("limits", "a_max", "limits.a_max");
    pub(crate) const LIMIT_TORQUE_MAX: Self = Self::new("limits", "torque_max", "limits.torque_max");
    pub(crate) const LIMIT_JERK_MAX: Self = Self::new("limits", "jerk_max", "limits.jerk_max");
    pub(crate) const LIMIT_TORQUE_RATE_MAX: Self =
        Self::new("limits", "torque_rate_max", "limits.torque_rate_max");
    pub(crate) const LIMIT_POWER_MAX: Self = Self::new("limits", "power_max", "limits.power_max");
    pub(crate) const LIMIT_TOTAL_POWER_MAX: Self =
        Self::new("limits", "total_power_max", "limits.total_power_max");
    pub(crate) const LIMIT_CORNER_SPEED: Self = Self::new("limits", "corner_speed", "limits.corner_speed");
    pub(crate) const LIMIT_NO_LOAD_SPEED: Self = Self::new("limits", "no_load_speed", "limits.no_load_speed");
    pub(crate) const PERIODIC_SHIFT: Self = Self::new("periodic", "shift", "periodic");
    pub(crate) const GAIT_STANCE: Self = Self::new("gait", "stance", "gait.stance");
    pub(crate) const GAIT_SWING: Self = Self::new("gait", "swing", "gait.swing");
    pub(crate) const GAIT_ALONG: Self = Self::new("gait", "along", "gait.along");
    pub(crate) const GAIT_LENGTH: Self = Self::new("gait", "length", "gait.length");
    pub(crate) const GAIT_FRICTION: Self = Self::new("gait", "friction", "gait.friction");
    pub(crate) const GAIT_CLEARANCE: Self = Self::new("gait", "clearance", "gait.clearance");
    pub(crate) const GAIT_MIRROR: Self = Self::new("gait", "mirror", "gait.mirror");
    pub(crate) const GAIT_SOLE: Self = Self::new("gait", "sole", "gait.sole");
    pub(crate) const GAIT_DOUBLE_SUPPORT: Self = Self::new("gait", "double_support", "gait.double_support");
    pub(crate) const GAIT_TRAILING: Self = Self::new("gait", "trailing", "gait.trailing");
    pub(crate) const GAIT_SOLE_WIDTH: Self = Self::new("gait", "sole_width", "gait.sole_width");
    pub(crate) const GAIT_FLIPPED: Self = Self::new("gait", "flipped", "gait.flipped");
    pub(crate) const GAIT_WIDTH: Self = Self::new("gait", "width", "gait.width");
    /// The file of a saved motion.
    pub const START_FROM: Self = Self::new("start_from", "file", "start");

    const fn new(table: &'static str, name: &'static str, field: &'static str) -> Self {
        Self { table, name, field, entry: 0 }
    }

    /// A key of an entry of a list of tables, or of a table with one entry, of the task.
    pub(crate) const fn entry(table: &'static str, name: &'static str, entry: usize) -> Self {
        Self { table, name, field: "task", entry }
    }

    /// A key of a via, by its number from 0.
    pub(crate) const fn via(name: &'static str, entry: usize) -> Self {
        Self { table: "via", name, field: "vias", entry }
    }

    /// The number of the entry in the list of tables, from 0.
    pub(crate) fn number(self) -> usize {
        self.entry
    }

    /// A field of [`SolverOptions`](crate::SolverOptions).
    pub(crate) const fn solver(name: &'static str) -> Self {
        Self::new("solver", name, name)
    }

    /// The table of a problem file.
    pub fn table(self) -> &'static str {
        self.table
    }

    /// The key within the table.
    pub fn name(self) -> &'static str {
        self.name
    }

    /// What a user would say is given: the table of an entry of a list, as `obstacle`, else the key.
    pub fn part(self) -> String {
        match self.field {
            "task" => self.table.into(),
            "vias" => format!("via {}", self.entry + 1),
            _ => self.to_string(),
        }
    }

    /// The field of [`Problem`](crate::Problem) or [`SolverOptions`](crate::SolverOptions): `gain` for
    /// `actuation.gain`.
    pub fn field(self) -> &'static str {
        self.field
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.table {
            // The file alone stands for the robot.
            "robot" if self.name == "file" => f.write_str(self.table),
            // Errors count from 1.
            "via" => write!(f, "via {}, {}", self.entry + 1, self.name),
            _ => write!(f, "{}.{}", self.table, self.name),
        }
    }
}
