//! Functions of two slices as evaluators: closures, generated and compiled functions.

use super::{Evaluator, Layout, Packed};
use std::convert::Infallible;

/// A function that fills the outputs of a node from its inputs, both one behind the other in one slice.
///
/// For generated functions, which are generic over the scalar and take arrays ([`on_slices!`](crate::on_slices) makes slices
/// of them), and for anything that can be called with `f64` slices. The function cannot refuse a node: one whose inputs or
/// outputs are not finite counts as failed; derivatives that a scalar carries are not looked at.
///
/// ```
/// use costate::batch::{Batch, NodeFunction, Packed};
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
///     Batch::new(NodeFunction::new(&[("x", 2), ("u", 1)], &[("f", 2)], function))
/// }
/// let (x, u, mut f) = ([0.1, 1.0, 0.0, f64::NAN, 0.3, 0.0], [0.0; 3], [0.0; 6]);
/// let mut batch = of_nodes::<f64>();
/// let failures = batch.run((), 3, [&x, &u], [&mut f])?;
/// assert_eq!(failures[0].to_string(), "node 1: x[1] is not finite; check what produced it");
/// assert!(f[2].is_nan() && (f[5] + 9.81 * 0.3_f64.sin()).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct NodeFunction<F> {
    layout: Layout,
    function: F,
}

impl<F> NodeFunction<F> {
    /// From the names of the arrays, how many entries a node has in each, and the function.
    pub fn new(inputs: &[(&'static str, usize)], outputs: &[(&'static str, usize)], function: F) -> Self {
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
/// `on_slices!(S, function, (q: 6, p: 6) -> (f: 12))` takes q and p from the front of the first slice and f from the front
/// of the second, in this order. Where one of them is too short, outputs are filled with NaN, which a batch takes for a failure.
/// Names are free.
#[macro_export]
macro_rules! on_slices {
    ($scalar:ty, $function:expr, ($($input:ident: $in:expr),*) -> ($($output:ident: $out:expr),*)) => {
        |inputs: &[$scalar], outputs: &mut [$scalar]| {
            let function = $function;
            // What is not written is no number, so that slices of another length cannot pass for results.
            outputs.fill(<$scalar as $crate::scalar::Scalar>::from_f64(f64::NAN));
            $(let Some(($input, inputs)) = inputs.split_first_chunk::<{ $in }>() else { return };)*
            $(let Some(($output, outputs)) = outputs.split_first_chunk_mut::<{ $out }>() else { return };)*
            let _ = (inputs, outputs);
            function($($input,)* $($output),*);
        }
    };
}
