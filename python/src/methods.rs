//! The methods of a class that are functions of arrays, with their descriptions.

/// The lines about an argument, by its kind.
macro_rules! described {
    (q) => {
        "q : array_like (..., nq)\n    Positions (rad, m) and unit quaternions (x, y, z, w): see `Robot`."
    };
    (raw) => {
        "q : array_like (..., nq)\n    Positions (rad, m) and quaternions (x, y, z, w) of any length but 0."
    };
    (from) => {
        "q_0 : array_like (..., nq)\n    The first configuration (rad, m)."
    };
    (to) => {
        "q_1 : array_like (..., nq)\n    The second configuration (rad, m)."
    };
    (step) => {
        "d : array_like (..., n)\n    A direction (rad, m), in the order of v."
    };
    (v) => {
        "v : array_like (..., n)\n    Velocities (rad/s, m/s), in either coordinates."
    };
    (state) => {
        "v : array_like (..., n)\n    Velocities (rad/s, m/s); with the coordinates ``\"qp\"`` the momenta p \
         (kg m^2/s, kg m/s)."
    };
    (p) => {
        "p : array_like (..., n)\n    Momenta (kg m^2/s, kg m/s)."
    };
    (a) => {
        "a : array_like (..., n)\n    Accelerations (rad/s^2, m/s^2)."
    };
    (tau) => {
        "tau : array_like (..., n)\n    Torques and forces of the actuators (N m, N)."
    };
    (y) => {
        "y : array_like (..., 2n)\n    The costate: a weight for each entry of f."
    };
    (next) => {
        "y : array_like (..., 2n)\n    The costate of the next state: a weight for each entry of Phi."
    };
    (d) => {
        "d : array_like (..., 3n)\n    A direction of z = (q, v, tau)."
    };
    (rate) => {
        "v : array_like (..., n)\n    Velocities (rad/s, m/s)."
    };
    (along) => {
        "d : array_like (..., 3n)\n    A direction of z = (q, p, tau)."
    };
    (start) => {
        "q_0 : array_like (..., nq)\n    Positions (rad, m) whose g is kept, such as those at the start."
    };
    (rows) => {
        "c : array_like (..., k)\n    A weight for each multiplier."
    };
    (momenta) => {
        "y : array_like (..., n)\n    A weight for each momentum after the impact."
    };
    (w) => {
        "w : array_like (..., n)\n    A weight for each torque."
    };
    (weights) => {
        "w : array_like (..., 3)\n    Weights of the coordinates x, y, z."
    };
    (one) => {
        "out : ndarray, optional\n    Where the result is written, and returned: C-contiguous float64 of its \
         shape, without\n    memory of an argument. A new array unless given."
    };
    (several) => {
        "out : tuple of ndarray, optional\n    An array for each result, or None for a new one: C-contiguous \
         float64 of its shape,\n    without memory of an argument or of another result."
    };
    (plain) => {
        "\nRaises\n------\nArgumentError\n    For another type, shape or layout of an argument; ``argument`` \
         names it.\nStateError\n    For a state that cannot be evaluated, with its ``index``: `NonFiniteState`, \
         `NonUnitQuaternion`.\nInterrupted\n    As the methods of `Dynamics`."
    };
    (raises) => {
        "\nRaises\n------\nArgumentError\n    For another type, shape or layout of an argument; ``argument`` \
         names it.\nStateError\n    For a state that cannot be evaluated, with its ``index``, unless \
         ``on_error=\"nan\"``.\n    All others are computed.\nInterrupted\n    After Ctrl-C in a batch: \
         ``reached`` holds the results, not-a-number for all states\n    that were not computed."
    };
}
pub(crate) use described;

/// Methods of a class that are functions of arrays: each with its arguments and their kinds, whether it has
/// one result or several, the lines about these, the Rust method that calls it, and which function it is;
/// after `with` which lines tell about errors.
macro_rules! verbs {
    (impl $class:ident; $($methods:tt)*) => {
        $crate::methods::verbs! { impl $class with raises; $($methods)* }
    };
    (
        impl $class:ident with $raises:ident;
        $(
            $(#[$doc:meta])*
            $name:ident($($argument:ident: $kind:ident),*) -> $count:ident $results:literal
                = $call:ident $verb:path;
        )*
    ) => {
        #[pyo3::pymethods]
        impl $class {
            $(
            $(#[$doc])*
            ///
            /// Parameters
            /// ----------
            $(#[doc = $crate::methods::described!($kind)])*
            #[doc = $crate::methods::described!($count)]
            ///
            /// Returns
            /// -------
            #[doc = $results]
            #[doc = $crate::methods::described!($raises)]
            #[pyo3(signature = ($($argument),*, *, out = None))]
            fn $name<'py>(
                &self,
                py: pyo3::Python<'py>,
                $($argument: &pyo3::Bound<'py, pyo3::PyAny>,)*
                out: Option<&pyo3::Bound<'py, pyo3::PyAny>>,
            ) -> pyo3::PyResult<pyo3::Bound<'py, pyo3::PyAny>> {
                self.$call(py, $verb, [$($argument),*], out)
            }
            )*
        }
    };
}
pub(crate) use verbs;
