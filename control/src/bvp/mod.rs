//! Discretised boundary-value problems: what Newton's method needs of them.

pub(crate) mod boundary;
pub(crate) mod collocation;
pub(crate) mod mesh;
pub(crate) mod newton;
pub(crate) mod scales;
pub(crate) mod shooting;
pub(crate) mod timed;
pub(crate) mod values;

use crate::bvp::mesh::{Mesh, Span};
use crate::bvp::scales::Scales;
use crate::bvp::timed::{Clock, Timed};
use crate::bvp::values::Values;
use crate::extremal::Extremal;
use crate::numerics::almost_block_diagonal::SingularMatrix;
use crate::numerics::dormand_prince::Stopped;
use crate::status::{EvaluationFailure, Status};
use costate::EvalError;

/// Values on a mesh, and the Newton corrections of the linearised equations.
///
/// Corrections are in scaled variables: component c is relative to `scale[c]`.
pub(crate) trait Discretised {
    /// Values of the same shape, zero.
    fn zeros(&self) -> Values;

    /// The current values.
    fn current(&self) -> &Values;

    /// The current values, to be replaced by others of the same shape.
    fn current_mut(&mut self) -> &mut Values;

    /// The size of each component.
    fn scale(&self) -> &[f64];

    /// The mesh.
    fn mesh(&self) -> &Mesh;

    /// `-A^-1 r` for the residuals of the last evaluation and the matrix of the last linearisation.
    fn correction(&mut self, target: &mut Values);
}

/// Equations `r(values) = 0` of an extremal and their linearisation A.
pub(crate) trait Solvable<E: Extremal + ?Sized>: Discretised {
    /// Cost and penalties at the last evaluation.
    fn costs(&self, timed: &Timed<'_, E>) -> (f64, f64);

    /// Sets the scales from the current values and, if given, a correction.
    fn set_scales(&mut self, timed: &Timed<'_, E>, with: Option<&Values>) -> Scales;

    /// Evaluates the coupling of the components, where [`set_scales`](Self::set_scales) needs it.
    fn set_coupling(&mut self, timed: &mut Timed<'_, E>);

    /// Residuals at `values`.
    fn evaluate(&mut self, timed: &mut Timed<'_, E>, values: &Values) -> Result<(), Failure>;

    /// Residuals and the factored matrix at the current values.
    fn linearise(&mut self, timed: &mut Timed<'_, E>) -> Result<(), Failure>;

    /// T (s).
    fn final_time(&self, timed: &Timed<'_, E>) -> f64 {
        if let Clock::Fixed(time) | Clock::Split(time) = timed.clock {
            return time;
        }
        let (m, nodes) = (self.scale().len(), &self.current().nodes);
        let spans = self.mesh().spans.iter().enumerate();
        spans
            .map(|(k, span)| match *span {
                Span::Interval { length, .. } => length * timed.duration(&nodes[k * m..(k + 1) * m]),
                Span::Switch { .. } => 0.0,
            })
            .sum()
    }
}

/// Why equations could not be evaluated or linearised.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum Failure {
    #[error(transparent)]
    Evaluation(#[from] EvaluationFailure),
    #[error(transparent)]
    Singular(#[from] SingularMatrix),
}

impl From<EvalError> for Failure {
    fn from(error: EvalError) -> Self {
        Self::Evaluation(error.into())
    }
}

impl From<Stopped> for Failure {
    fn from(stopped: Stopped) -> Self {
        match stopped {
            Stopped::Evaluation(error) => error.into(),
            // None of these integrations is interrupted.
            Stopped::TooManySteps | Stopped::Interrupted => Self::Evaluation(EvaluationFailure::Integration),
        }
    }
}

impl From<Failure> for Status {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Singular(_) => Self::Singular,
            Failure::Evaluation(failure) => Self::EvaluationFailed(failure),
        }
    }
}
