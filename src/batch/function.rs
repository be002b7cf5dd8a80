//! Functions of two slices as evaluators: closures, generated and compiled functions.

use super::{Evaluator, Layout, NodeArray, Packed};
use std::convert::Infallible;

/// A function that computes the outputs of a node from its inputs; each slice holds all arrays one after the
/// other.
///
/// For generated functions, which are generic over the scalar and take arrays
/// ([`on_slices!`](crate::on_slices) adapts them to slices), and for any function of `f64` slices. The
/// function cannot refuse a node; a node whose inputs or outputs are not finite counts as failed. Derivatives
/// that a scalar carries are not checked.
///
/// ```
/// use costate::batch::{Batch, NodeArray, NodeFunction, Packed};
/// use costate::on_slices;
/// use costate::scalar::Scalar;
///
/// /// A pendulum, as a generator may write it.
/// fn pendulum<S: Scalar>(q: &[S; 1], p: &[S; 1], u: &[S; 1], f: &mut [S; 2]) {
///     let (sin, _) = q[0].sin_cos();
///     *f = [p[0].times(0.5), u[0] - sin.times(9.81)];
/// }
/// fn of_nodes<S: Packed>() -> Batch<S, NodeFunction<impl Fn(&[S], &mut [S]) + Send>> {
///     let function = on_slices!(S, pendulum, (q: 1, p: 1, u: 1) -> (f: 2));
///     let inputs = [NodeArray::new("x", 2), NodeArray::new("u", 1)];
///     Batch::new(NodeFunction::new(&inputs, &[NodeArray::new("f", 2)], function))
/// }
/// let (x, u, mut f) = ([0.1, 1.0, 0.0, f64::NAN, 0.3, 0.0], [0.0; 3], [0.0; 6]);
/// let mut batch = of_nodes::<f64>();
/// let failures = batch.run((), 3, [&x, &u], [&mut f])?;
/// assert_eq!(failures[0].to_string(), "node 1: x[1] is not finite; check the computation that produced it");
/// assert!(f[2].is_nan() && (f[5] + 9.81 * 0.3_f64.sin()).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct NodeFunction<F> {
    layout: Layout,
    function: F,
}

impl<F> NodeFunction<F> {
    /// A function with these input and output arrays, each with its name and number of entries per node.
    pub fn new(inputs: &[NodeArray], outputs: &[NodeArray], function: F) -> Self {
        Self { layout: Layout::new(inputs, outputs), function }
    }
}

impl<S: Packed, F: FnMut(&[S], &mut [S]) + Send> Evaluator<S> for NodeFunction<F> {
    type Quantity = ();
    type Error = Infallible;

    fn layouts(&self) -> Vec<((), Layout)> {
        vec![((), self.layout.clone())]
    }

    fn evaluate(&mut self, (): (), input: &[S], output: &mut [S]) -> Result<(), Infallible> {
        (self.function)(input, output);
        Ok(())
    }
}

/// A function of arrays as a closure of two slices: for [`NodeFunction`](crate::batch::NodeFunction).
///
/// `on_slices!(S, function, (q: 6, p: 6) -> (f: 12))` reads q and p from the front of the first slice and
/// writes f to the front of the second, in this order. If a slice is too short, outputs are filled with NaN,
/// which a batch reports as a failure. The names are arbitrary.
#[macro_export]
macro_rules! on_slices {
    ($scalar:ty, $function:expr, ($($input:ident: $in:expr),*) -> ($($output:ident: $out:expr),*)) => {
        |inputs: &[$scalar], outputs: &mut [$scalar]| {
            let function = $function;
            // Outputs that are not written are NaN, so that a wrong length cannot pass for a result.
            outputs.fill(<$scalar as $crate::scalar::Scalar>::from_f64(f64::NAN));
            $(let Some(($input, inputs)) = inputs.split_first_chunk::<{ $in }>() else { return };)*
            $(let Some(($output, outputs)) = outputs.split_first_chunk_mut::<{ $out }>() else { return };)*
            let _ = (inputs, outputs);
            function($($input,)* $($output),*);
        }
    };
}
