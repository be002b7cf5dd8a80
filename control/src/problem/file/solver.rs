//! The table `[solver]` of a problem file.

use crate::options::{Coordinates, JacobianRoute, MachineCode, Method, Polish, SolverOptions, Verify};
use crate::problem::error::ProblemError;
use crate::problem::file::error::ProblemFileCause;
use crate::problem::file::fault::Fault;
use crate::problem::file::table::Table;
use std::time::Duration;
use toml::de::DeValue;

pub(super) const KEYS: &[&str] = &[
    "starts",
    "threads",
    "seed",
    "tolerance",
    "nodes",
    "max_nodes",
    "jacobian",
    "method",
    "coordinates",
    "verify",
    "polish",
    "machine_code",
    "time_limit",
];

const JACOBIANS: [(&str, JacobianRoute); 3] = [
    ("exact", JacobianRoute::Exact),
    ("differences", JacobianRoute::Differences),
    ("without_hessian", JacobianRoute::WithoutHessian),
];
const METHODS: [(&str, Method); 3] =
    [("collocation", Method::Collocation), ("shooting", Method::Shooting), ("direct", Method::Direct)];
const MACHINE_CODE: [(&str, MachineCode); 3] =
    [("later", MachineCode::Later), ("at_once", MachineCode::AtOnce), ("never", MachineCode::Never)];
/// With the letters that the Python package has for them.
const COORDINATES: [(&str, Coordinates); 4] = [
    ("hamiltonian", Coordinates::Hamiltonian),
    ("lagrangian", Coordinates::Lagrangian),
    ("qp", Coordinates::Hamiltonian),
    ("qv", Coordinates::Lagrangian),
];
const VERIFICATIONS: [(&str, Verify); 3] =
    [("full", Verify::Full), ("factors", Verify::Factors), ("none", Verify::None)];

/// The options: those of the table, and else the given ones. Another method has its own tolerance and most
/// steps.
pub(super) fn read(table: &Table<'_>, given: SolverOptions) -> Result<SolverOptions, Fault> {
    let method = table.choice("method", &METHODS)?.unwrap_or(given.method);
    let steps = if method == given.method { &given } else { &SolverOptions::of(method) };
    let max_iterations = steps.max_iterations;
    let defaults = SolverOptions { max_iterations, ..given.clone().with_method(method) };
    let some = |name: &str, default: Option<usize>| -> Result<Option<usize>, Fault> {
        let found = table.whole(name)?;
        Ok(found.map(|count| usize::try_from(count).unwrap_or(usize::MAX)).or(default))
    };
    let count = |name: &str, default: usize| some(name, Some(default)).map(|count| count.unwrap_or(default));
    let options = SolverOptions {
        starts: some("starts", defaults.starts)?,
        threads: some("threads", defaults.threads)?,
        seed: table.whole("seed")?.unwrap_or(defaults.seed),
        tolerance: table.number("tolerance")?.unwrap_or(defaults.tolerance),
        nodes: count("nodes", defaults.nodes)?,
        max_nodes: count("max_nodes", defaults.max_nodes)?,
        jacobian: table.choice("jacobian", &JACOBIANS)?.unwrap_or(defaults.jacobian),
        coordinates: table.choice("coordinates", &COORDINATES)?.unwrap_or(defaults.coordinates),
        verify: table.choice("verify", &VERIFICATIONS)?.unwrap_or(defaults.verify),
        polish: polish(table)?.unwrap_or(defaults.polish),
        machine_code: table.choice("machine_code", &MACHINE_CODE)?.unwrap_or(defaults.machine_code),
        time_limit: time_limit(table)?.unwrap_or(defaults.time_limit),
        ..defaults
    };
    let is_direct = options.method == Method::Direct && options.polish == Polish::Never;
    if let Some(key) = ["jacobian", "coordinates"].into_iter().find(|key| is_direct && table.has(key)) {
        let message = "has no effect on the direct method without a polish; remove it, or give solver.method or \
                       solver.polish";
        return Err(table.fault(key, ProblemFileCause::Conflict(message)));
    }
    Ok(options)
}

/// true, false or "auto".
fn polish(table: &Table<'_>) -> Result<Option<Polish>, Fault> {
    table.value("polish", "true, false or \"auto\"", |value| match value {
        DeValue::Boolean(true) => Some(Polish::Always),
        DeValue::Boolean(false) => Some(Polish::Never),
        DeValue::String(text) if text == "auto" => Some(Polish::Auto),
        _ => None,
    })
}

/// A time limit, in seconds, none for inf. [`SolverOptions::check`] refuses zero.
fn time_limit(table: &Table<'_>) -> Result<Option<Option<Duration>>, Fault> {
    let Some(value) = table.number("time_limit")? else { return Ok(None) };
    if value == f64::INFINITY {
        return Ok(Some(None));
    }
    Duration::try_from_secs_f64(value).map(|time| Some(Some(time))).map_err(|_| {
        let remedy = "must be a positive number of seconds, or inf for no limit";
        let error = ProblemError::BadOption { key: "time_limit", value, remedy };
        table.fault("time_limit", ProblemFileCause::Problem(error))
    })
}
