//! Source text of a quantity.

use crate::dynamics::coordinates_of;
use crate::errors::{CodegenError, argument, whole};
use crate::robot::Robot;
use crate::words::in_python;
use costate::Coordinates;
use costate::codegen::{
    COptions, ProgramOptions, Quantity, RustOptions, StepSpec, acados_source, casadi_source, robot_program,
};
use pyo3::prelude::*;

/// Most steps of a function, unless given.
const LIMIT: usize = 25_000;

/// Source code of one quantity of a robot: a function without branches that needs no library; or of the
/// functions that another tool asks for.
///
/// Parameters
/// ----------
/// robot : Robot
///     The robot, whose constants become numbers of the source.
/// quantity : str, optional
///     ``"f"``, ``"f_x"``, ``"y_f_x"``, ``"y_f_xx"``, ``"y_f_xx_d"``, ``"mass_matrix"``, ``"energy"``,
///     ``"inverse_dynamics"``, ``"tau_z"`` or ``"y_tau_zz"``.
/// coordinates : {"qv", "qp"}
///     The state.
/// language : {"c", "rust"}
///     C99 on ``double``, or Rust generic over the number.
/// only : bool
///     Leave out the results that the quantity builds on.
/// parameters : bool
///     Masses, lengths and other constants are an argument of the function.
/// limit : int
///     Most steps of the function: longer ones take long to compile.
/// abi : {"casadi", "acados"}, optional
///     In the place of a quantity, all functions that ``casadi.external`` or acados load by name, as
///     ``costate codegen --abi`` writes them: C, in (q, v).
/// scheme : {"rk4", "semi_implicit_euler"}, optional
///     With ``abi`` alone: a time step too.
/// dt : float
///     Its duration (s).
///
/// Returns
/// -------
/// str
///     The source.
///
/// Raises
/// ------
/// ArgumentError
///     For an unknown quantity, coordinates, language, abi or scheme, options that do not go together, and a
///     limit that is negative or no whole number.
/// CodegenError
///     For a quantity that is not defined in these coordinates, or a function that is longer than the limit.
///
/// Examples
/// --------
/// >>> import costate
/// >>> robot = costate.Robot.builder("cart").prismatic("rail", axis=[1, 0, 0], mass=2).build()
/// >>> "void cart_lagrangian_inverse_dynamics(" in costate.codegen(robot, "inverse_dynamics")
/// True
/// >>> "int cart_expl_ode_hess(" in costate.codegen(robot, abi="acados")
/// True
#[pyfunction]
#[pyo3(
    signature = (robot, quantity = None, coordinates = "qv", language = "c", *, only = false,
        parameters = false, limit = None, abi = None, scheme = None, dt = 0.0),
    text_signature = "(robot, quantity=None, coordinates='qv', language='c', *, only=False, \
        parameters=False, limit=25000, abi=None, scheme=None, dt=0.0)"
)]
#[expect(clippy::too_many_arguments, reason = "most by name")]
pub fn codegen(
    py: Python<'_>,
    robot: &Robot,
    quantity: Option<&str>,
    coordinates: &str,
    language: &str,
    only: bool,
    parameters: bool,
    limit: Option<&Bound<'_, PyAny>>,
    abi: Option<&str>,
    scheme: Option<&str>,
    dt: f64,
) -> PyResult<String> {
    let limit = limit.map_or(Ok(LIMIT), |given| whole("limit", given, 0..=usize::MAX))?;
    let coordinates = coordinates_of(py, coordinates)?;
    if let Some(abi) = abi {
        let fixed = [
            ("quantity", quantity.is_some()),
            ("coordinates", coordinates != Coordinates::Lagrangian),
            ("language", language != "c"),
            ("only", only),
            ("parameters", parameters),
        ];
        if let Some((name, _)) = fixed.into_iter().find(|(_, given)| *given) {
            let message =
                format!("abi='{abi}' says which functions are written, in C and in (q, v); leave out {name}");
            return Err(argument(py, name, message));
        }
        return abi_source(py, robot, abi, scheme, dt, limit);
    }
    if scheme.is_some() || dt != 0.0 {
        let name = if scheme.is_some() { "scheme" } else { "dt" };
        return Err(argument(
            py,
            name,
            format!("{name} is of abi='casadi' and abi='acados' alone; leave it out"),
        ));
    }
    let quantity = quantity.unwrap_or_default();
    let found = Quantity::ALL.into_iter().find(|known| known.name() == quantity).ok_or_else(|| {
        let names = Quantity::ALL.map(Quantity::name).join(", ");
        argument(py, "quantity", format!("unknown quantity '{quantity}'; give one of {names}"))
    })?;
    robot.refuse_constraints(py, "be written as source code")?;
    let options = ProgramOptions::default().with_only(only).with_parameters(parameters).with_limit(limit);
    let text = py.detach(|| {
        let program = robot_program(robot.model(), found, coordinates, &options)?;
        match language {
            "c" => program.to_c(&COptions::default().with_limit(limit)).map(Some),
            "rust" => program.to_rust(&RustOptions::default().with_limit(limit)).map(Some),
            _ => Ok(None),
        }
    });
    let text = text.map_err(|error: costate::codegen::CodegenError| {
        CodegenError::new_err(in_python(&error.to_string()))
    })?;
    text.ok_or_else(|| argument(py, "language", format!("unknown language '{language}'; give 'c' or 'rust'")))
}

/// C source for `casadi.external` or for acados.
fn abi_source(
    py: Python<'_>,
    robot: &Robot,
    abi: &str,
    scheme: Option<&str>,
    dt: f64,
    limit: usize,
) -> PyResult<String> {
    robot.refuse_constraints(py, "be written as source code")?;
    if !["casadi", "acados"].contains(&abi) {
        return Err(argument(py, "abi", format!("unknown abi '{abi}'; give 'casadi' or 'acados'")));
    }
    let coordinates = Coordinates::Lagrangian;
    let step = match scheme {
        None => None,
        Some("rk4") => Some(StepSpec::RungeKutta4 { dt, coordinates }),
        Some("semi_implicit_euler") => Some(StepSpec::SemiImplicitEuler { dt }),
        Some(other) => {
            let message = format!("no source for the scheme '{other}'; give 'rk4' or 'semi_implicit_euler'");
            return Err(argument(py, "scheme", message));
        }
    };
    if !dt.is_finite() {
        return Err(argument(py, "dt", format!("dt is {dt}; it must be finite")));
    }
    let options = COptions::default().with_limit(limit);
    let text = py.detach(|| match abi {
        "casadi" => casadi_source(robot.model(), step, &options),
        _ => acados_source(robot.model(), step, &options),
    });
    text.map_err(|error| CodegenError::new_err(in_python(&error.to_string())))
}
