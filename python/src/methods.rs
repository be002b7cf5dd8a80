//! The methods of a class that are functions of arrays.

/// The Python methods of a class: those that are written out, then one for each function of arrays, with its
/// arguments, the Rust method that calls it, and which function it is.
macro_rules! methods {
    (
        impl $class:ident { $($written:tt)* }
        $($(#[$doc:meta])* $name:ident($($argument:ident),*) = $call:ident $verb:path;)*
    ) => {
        #[pyo3::pymethods]
        impl $class {
            $($written)*

            $(
            $(#[$doc])*
            fn $name<'py>(
                &self,
                py: pyo3::Python<'py>,
                $($argument: &pyo3::Bound<'py, pyo3::PyAny>),*
            ) -> pyo3::PyResult<pyo3::Bound<'py, pyo3::PyAny>> {
                self.$call(py, $verb, [$($argument),*])
            }
            )*
        }
    };
}
pub(crate) use methods;
