//! The tables and keys of a problem file.

use crate::options::SolverOptions;
use crate::problem::file::error::ProblemFileCause;
use crate::problem::file::fault::Fault;
use crate::problem::file::joints::{JointName, joints};
use crate::problem::file::phases::{self, ViaTable};
use crate::problem::file::robot::{self, RobotTable, Source};
use crate::problem::file::table::{Table, number};
use crate::problem::file::{gait, solver, task};
use crate::problem::{Bounds, FinalTime, Gait, MotionLimits, Penalty, Task};

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
const LIMITS: &[&str] = &[
    "q_min",
    "q_max",
    "v_max",
    "a_max",
    "torque_max",
    "jerk_max",
    "torque_rate_max",
    "power_max",
    "total_power_max",
    "corner_speed",
    "no_load_speed",
    "from_robot",
];
const PENALTY: &[&str] = &["weight", "q_min", "q_max", "v_max"];
const START_FROM: &[&str] = &["file"];
/// The values of a problem file, before its robot is known.
pub(super) struct Tables {
    pub robot: RobotTable,
    pub start: StateTable,
    pub end: StateTable,
    pub time: FinalTime,
    pub cost_time: f64,
    pub effort: Option<Vec<f64>>,
    pub energy: Option<Energy>,
    pub energy_smoothing: Option<f64>,
    pub torque_rate: Option<Vec<f64>>,
    pub jerk: Option<Vec<f64>>,
    pub gain: Option<Vec<f64>>,
    pub bounds: Option<Bounds>,
    pub penalty: Option<Penalty>,
    pub limits: Option<MotionLimits>,
    pub task: Task,
    pub vias: Vec<ViaTable>,
    pub periodic: Option<Vec<f64>>,
    pub gait: Option<Gait>,
    pub start_from: Option<String>,
    pub options: SolverOptions,
}

/// The cost of a joule.
pub(super) enum Energy {
    /// The same for all joints.
    Each(f64),
    Of(Vec<f64>),
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
            start.need("q", start.numbers("q")?)?;
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
    let energy = cost.map_or(Ok(None), energy)?;
    if let Some(cost) = cost.filter(|cost| cost.has("energy_smoothing") && !cost.has("energy")) {
        let message = "has no effect without cost.energy; add that, or remove this";
        return Err(cost.fault("energy_smoothing", ProblemFileCause::Conflict(message)));
    }
    let numbers = |name| cost.map_or(Ok(None), |cost| cost.numbers(name));
    Ok(Tables {
        robot,
        start,
        end,
        time,
        cost_time: cost.map_or(Ok(None), |cost| cost.number("time"))?.unwrap_or(0.0),
        effort: cost.map_or(Ok(None), |cost| cost.numbers("effort"))?,
        energy,
        energy_smoothing: cost.map_or(Ok(None), |cost| cost.number("energy_smoothing"))?,
        torque_rate: numbers("torque_rate")?,
        jerk: numbers("jerk")?,
        gain: actuation.map_or(Ok(None), |actuation| actuation.numbers("gain"))?,
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

fn time(table: &Table<'_>) -> Result<FinalTime, Fault> {
    let conflict = |key: &str, message| Err(table.fault(key, ProblemFileCause::Conflict(message)));
    let free = table.flag("free")?.unwrap_or(false);
    match (table.number("final")?, table.number("guess")?) {
        (Some(_), _) if free => conflict("final", "the time is also `free = true`; keep one of the two"),
        (Some(_), Some(_)) => conflict("guess", "only for `free = true`; remove it, or time.final"),
        (Some(time), None) => Ok(FinalTime::Fixed(time)),
        (None, Some(guess)) if free => Ok(FinalTime::Free { guess }),
        (None, None) if free => {
            conflict("guess", "missing; with `free = true` give a first guess of T, in s")
        }
        (None, _) => conflict("final", "missing; give it in s, or `free = true` and `guess`"),
    }
}

fn bounds(table: &Table<'_>) -> Result<Bounds, Fault> {
    Ok(Bounds {
        u_min: table.need("u_min", table.numbers("u_min")?)?,
        u_max: table.need("u_max", table.numbers("u_max")?)?,
    })
}

fn penalty(table: &Table<'_>) -> Result<Penalty, Fault> {
    if !["q_min", "q_max", "v_max"].iter().any(|limit| table.has(limit)) {
        let message = "nothing is penalised; give q_min, q_max or v_max, or remove [penalty]";
        return Err(table.fault("weight", ProblemFileCause::Conflict(message)));
    }
    Ok(Penalty {
        weight: table.need("weight", table.number("weight")?)?,
        q_min: table.numbers("q_min")?,
        q_max: table.numbers("q_max")?,
        v_max: table.numbers("v_max")?,
    })
}

fn limits(table: &Table<'_>) -> Result<MotionLimits, Fault> {
    let none = MotionLimits::default();
    Ok(MotionLimits {
        q_min: table.numbers("q_min")?,
        q_max: table.numbers("q_max")?,
        v_max: table.numbers("v_max")?,
        a_max: table.numbers("a_max")?,
        torque_max: table.numbers("torque_max")?,
        jerk_max: table.numbers("jerk_max")?,
        torque_rate_max: table.numbers("torque_rate_max")?,
        power_max: table.numbers("power_max")?,
        total_power_max: table.number("total_power_max")?,
        corner_speed: table.numbers("corner_speed")?,
        no_load_speed: table.numbers("no_load_speed")?,
        from_robot: table.flag("from_robot")?.or(none.from_robot),
    })
}

/// One cost of energy for all joints, or one for each.
fn energy(table: &Table<'_>) -> Result<Option<Energy>, Fault> {
    let expected = "a number or a list of numbers";
    if table.has_list("energy") {
        return Ok(table.list("energy", expected, number)?.map(Energy::Of));
    }
    Ok(table.value("energy", expected, number)?.map(Energy::Each))
}
