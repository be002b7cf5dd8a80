//! The tables and keys of a problem file.

use crate::options::SolverOptions;
use crate::problem::file::error::ProblemFileCause;
use crate::problem::file::fault::Fault;
use crate::problem::file::joints::{JointName, joints};
use crate::problem::file::per_joint::PerJoint;
use crate::problem::file::phases::{self, ViaTable};
use crate::problem::file::robot::{self, RobotTable, Source};
use crate::problem::file::table::Table;
use crate::problem::file::{gait, solver, task};
use crate::problem::{Bounds, FinalTime, Gait, MotionLimits, Penalty, Task};
use costate::robot::Robot;

const ROOT: &[&str] = &[
    "robot",
    "start",
    "end",
    "via",
    "periodic",
    "gait",
    "time",
    "cost",
    "actuation",
    "bounds",
    "limits",
    "penalty",
    "keep",
    "obstacle",
    "collision",
    "start_from",
    "solver",
];
const STATE: &[&str] = &["q", "v", "a", "q_free", "v_free", "tool"];
const TIME: &[&str] = &["final", "free", "guess"];
const COST: &[&str] =
    &["time", "effort", "energy", "energy_smoothing", "torque_rate", "jerk", "tool", "reference"];
const ACTUATION: &[&str] = &["gain"];
const BOUNDS: &[&str] = &["u_min", "u_max"];
/// Lists of joints come first, [`JOINT_LIMITS`] of them.
const LIMITS: &[&str] = &[
    "q_min",
    "q_max",
    "v_max",
    "a_max",
    "torque_max",
    "jerk_max",
    "torque_rate_max",
    "power_max",
    "corner_speed",
    "no_load_speed",
    "total_power_max",
    "from_robot",
];
const JOINT_LIMITS: usize = 10;
const PENALTY: &[&str] = &["weight", "q_min", "q_max", "v_max"];
const START_FROM: &[&str] = &["file"];
/// The values of a problem file, before its robot is known.
pub(super) struct Tables {
    pub robot: RobotTable,
    pub start: StateTable,
    pub end: StateTable,
    /// `None`: free, and the guess is not given.
    pub time: Option<FinalTime>,
    pub cost_time: f64,
    pub effort: Option<PerJoint>,
    pub energy: Option<PerJoint>,
    pub energy_smoothing: Option<f64>,
    pub torque_rate: Option<PerJoint>,
    pub jerk: Option<PerJoint>,
    pub gain: Option<PerJoint>,
    pub bounds: Option<BoundsTable>,
    pub penalty: Option<PenaltyTable>,
    pub limits: Option<LimitsTable>,
    pub task: Task,
    pub vias: Vec<ViaTable>,
    pub periodic: Option<Vec<f64>>,
    /// With whether its robot is replaced by the mean with its mirror image.
    pub gait: Option<(Gait, bool)>,
    pub start_from: Option<String>,
    pub options: SolverOptions,
}

/// `[bounds]`.
pub(super) struct BoundsTable {
    u_min: PerJoint,
    u_max: PerJoint,
}

/// `[penalty]`.
pub(super) struct PenaltyTable {
    weight: f64,
    q_min: Option<PerJoint>,
    q_max: Option<PerJoint>,
    v_max: Option<PerJoint>,
}

/// `[limits]`.
pub(super) struct LimitsTable {
    /// In the order of [`LIMITS`].
    lists: [Option<PerJoint>; JOINT_LIMITS],
    total_power_max: Option<f64>,
    from_robot: Option<bool>,
}

#[derive(Default)]
pub(super) struct StateTable {
    /// `None`: those of the start, as a first guess; of a periodic motion all are free.
    pub q: Option<Vec<f64>>,
    pub v: Option<Vec<f64>>,
    pub a: Option<Vec<f64>>,
    /// `None`: no joint, or all of them where tools are given.
    pub q_free: Option<Vec<JointName>>,
    pub v_free: Vec<JointName>,
    pub has_tools: bool,
}

/// Reads all tables.
pub(super) fn read(root: &Table<'_>, source: Source) -> Result<Tables, Fault> {
    root.only(ROOT)?;
    let optional = |name: &'static str, keys: &'static [&'static str]| -> Result<Option<Table<'_>>, Fault> {
        let table = root.table(name)?;
        if let Some(table) = &table {
            table.only(keys)?;
        }
        Ok(table)
    };
    let needed = |name, keys| root.need(name, optional(name, keys)?);
    let robot = robot::read(root, source)?;
    let (vias, periodic) = (phases::vias(root)?, phases::periodic(root)?);
    let gait = gait::gait(root)?;
    let (start, end) = match periodic {
        None if gait.is_some() => {
            gait::refuse_ends(root)?;
            (state(&needed("start", STATE)?)?, StateTable::default())
        }
        None => {
            let start = needed("start", STATE)?;
            if start.has("q_free") {
                // Positions of the other joints are given.
                start.need("q", start.numbers("q")?)?;
            }
            (state(&start)?, state(&needed("end", STATE)?)?)
        }
        // All is free that is not given, and the end follows.
        Some(_) => {
            if root.has("end") {
                let message = "the end of a periodic motion follows its start; remove [end] or [periodic]";
                return Err(root.fault("end", ProblemFileCause::Conflict(message)));
            }
            let start = optional("start", STATE)?;
            (start.as_ref().map_or(Ok(StateTable::default()), state_if_any)?, StateTable::default())
        }
    };
    let time = time(&needed("time", TIME)?)?;
    let cost = optional("cost", COST)?;
    let cost = cost.as_ref();
    let actuation = optional("actuation", ACTUATION)?;
    let start_from = optional("start_from", START_FROM)?;
    let limits = optional("limits", LIMITS)?.as_ref().map(limits).transpose()?;
    let task = task::read(root)?;
    if let Some(cost) = cost.filter(|cost| cost.has("energy_smoothing") && !cost.has("energy")) {
        let message = "has no effect without cost.energy; add that, or remove this";
        return Err(cost.fault("energy_smoothing", ProblemFileCause::Conflict(message)));
    }
    let per_joint = |name| cost.map_or(Ok(None), |cost| cost.per_joint(name));
    Ok(Tables {
        robot,
        start,
        end,
        time,
        cost_time: cost.map_or(Ok(None), |cost| cost.number("time"))?.unwrap_or(0.0),
        effort: per_joint("effort")?,
        energy: per_joint("energy")?,
        energy_smoothing: cost.map_or(Ok(None), |cost| cost.number("energy_smoothing"))?,
        torque_rate: per_joint("torque_rate")?,
        jerk: per_joint("jerk")?,
        gain: actuation.map_or(Ok(None), |actuation| actuation.per_joint("gain"))?,
        bounds: optional("bounds", BOUNDS)?.as_ref().map(bounds).transpose()?,
        penalty: optional("penalty", PENALTY)?.as_ref().map(penalty).transpose()?,
        limits,
        task,
        vias,
        periodic,
        gait,
        start_from: start_from.map(|table| table.need("file", table.string("file")?)).transpose()?,
        options: optional("solver", solver::KEYS)?
            .map_or(Ok(SolverOptions::default()), |table| solver::read(&table, SolverOptions::default()))?,
    })
}

fn state(table: &Table<'_>) -> Result<StateTable, Fault> {
    let state = state_if_any(table)?;
    if !state.has_tools {
        table.need("q", state.q.as_ref())?;
    }
    Ok(state)
}

/// A state that may have no positions.
fn state_if_any(table: &Table<'_>) -> Result<StateTable, Fault> {
    Ok(StateTable {
        q: table.numbers("q")?,
        v: table.numbers("v")?,
        a: table.numbers("a")?,
        q_free: joints(table, "q_free")?,
        v_free: joints(table, "v_free")?.unwrap_or_default(),
        has_tools: table.holds("tool"),
    })
}

/// The final time; `None` for a free one whose guess is not given.
fn time(table: &Table<'_>) -> Result<Option<FinalTime>, Fault> {
    let conflict = |key: &str, message| Err(table.fault(key, ProblemFileCause::Conflict(message)));
    let free = table.flag("free")?.unwrap_or(false);
    match (table.number("final")?, table.number("guess")?) {
        (Some(_), _) if free => conflict("final", "the time is also `free = true`; keep one of the two"),
        (Some(_), Some(_)) => conflict("guess", "only for `free = true`; remove it, or time.final"),
        (Some(time), None) => Ok(Some(FinalTime::Fixed(time))),
        (None, Some(guess)) if free => Ok(Some(FinalTime::Free { guess })),
        (None, None) if free => Ok(None),
        (None, _) => conflict("final", "missing; give it in s, or `free = true`"),
    }
}

fn bounds(table: &Table<'_>) -> Result<BoundsTable, Fault> {
    Ok(BoundsTable {
        u_min: table.need("u_min", table.per_joint("u_min")?)?,
        u_max: table.need("u_max", table.per_joint("u_max")?)?,
    })
}

impl BoundsTable {
    /// Those of a robot.
    pub fn of(&self, robot: &Robot) -> Bounds {
        Bounds { u_min: self.u_min.of_motors(robot), u_max: self.u_max.of_motors(robot) }
    }
}

fn penalty(table: &Table<'_>) -> Result<PenaltyTable, Fault> {
    if !["q_min", "q_max", "v_max"].iter().any(|limit| table.has(limit)) {
        let message = "nothing is penalised; give q_min, q_max or v_max, or remove [penalty]";
        return Err(table.fault("weight", ProblemFileCause::Conflict(message)));
    }
    Ok(PenaltyTable {
        weight: table.need("weight", table.number("weight")?)?,
        q_min: table.per_joint("q_min")?,
        q_max: table.per_joint("q_max")?,
        v_max: table.per_joint("v_max")?,
    })
}

impl PenaltyTable {
    /// That of n joints.
    pub fn of_joints(&self, n: usize) -> Penalty {
        let of = |list: &Option<PerJoint>| list.as_ref().map(|list| list.of_joints(n));
        Penalty {
            weight: self.weight,
            q_min: of(&self.q_min),
            q_max: of(&self.q_max),
            v_max: of(&self.v_max),
        }
    }
}

fn limits(table: &Table<'_>) -> Result<LimitsTable, Fault> {
    let mut lists: [Option<PerJoint>; JOINT_LIMITS] = Default::default();
    for (list, name) in lists.iter_mut().zip(LIMITS) {
        *list = table.per_joint(name)?;
    }
    Ok(LimitsTable {
        lists,
        total_power_max: table.number("total_power_max")?,
        from_robot: table.flag("from_robot")?,
    })
}

impl LimitsTable {
    /// Those of a robot.
    pub fn of(&self, robot: &Robot) -> MotionLimits {
        let none = MotionLimits::default();
        let of = |list: &Option<PerJoint>| list.as_ref().map(|list| list.of_joints(robot.dof()));
        let [q_min, q_max, v_max, a_max, torque, jerk, torque_rate, power, corner, no_load] = &self.lists;
        MotionLimits {
            q_min: of(q_min),
            q_max: of(q_max),
            v_max: of(v_max),
            a_max: of(a_max),
            torque_max: torque.as_ref().map(|list| list.of_motors(robot)),
            jerk_max: of(jerk),
            torque_rate_max: of(torque_rate),
            power_max: of(power),
            total_power_max: self.total_power_max,
            corner_speed: of(corner),
            no_load_speed: of(no_load),
            from_robot: self.from_robot.or(none.from_robot),
        }
    }
}
