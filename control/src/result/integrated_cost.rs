//! The cost of an extremal by adaptive quadrature.

use crate::bvp::mesh::Span;
use crate::extremal::Extremal;
use crate::numerics::dormand_prince::Stopped;
use crate::numerics::gauss_kronrod::integrate;
use crate::solve::Solved;

/// Evaluations for each interval of the mesh, beside [`EVALUATIONS`] for all.
const OF_INTERVAL: usize = 300;
const EVALUATIONS: usize = 20_000;
/// Relative error of the size of the cost: it is a scale.
const ROUGH: f64 = 1e-2;

/// $\int l\\, dt$ along the collocation polynomials.
pub(crate) struct IntegratedCost {
    /// Without penalties, and these.
    pub cost: f64,
    pub penalty: f64,
    /// The integral of $|l|$, with a part of that of $|y^\top f|$ for motions that cost next to nothing.
    pub size: f64,
    /// Estimate of the error of the quadrature, relative to the size.
    pub error: f64,
}

impl Solved {
    /// Cost and penalties along the polynomials between the nodes, with the controls that belong to them,
    /// where the mesh takes them at its points alone. `tolerance` is that of the quadrature, relative to the
    /// size of the cost, and the part of $|y^\top f|$ in it.
    pub(crate) fn integrated_cost(
        &self,
        extremal: &mut dyn Extremal,
        tolerance: f64,
        stops: &mut dyn FnMut() -> bool,
    ) -> Result<IntegratedCost, Stopped> {
        let equations = &self.found.equations;
        let m = equations.m;
        let mut timed = self.found.timed(extremal);
        let (mut w, mut slope) = (vec![0.0; m], vec![0.0; m]);
        let mut at = |k: usize, x: f64| {
            if stops() {
                return Err(Stopped::Interrupted);
            }
            let Span::Interval { arc, length } = equations.mesh.spans[k] else { return Ok([0.0; 3]) };
            equations.polynomial(k, x, &mut w);
            let terms = timed.evaluate(&w, arc, &mut slope)?;
            let h = length * timed.duration(&w);
            let size = terms.cost.abs() + terms.penalty.abs() + tolerance * terms.magnitude();
            Ok([h * terms.cost, h * terms.penalty, h * size])
        };
        let intervals = || {
            let spans = equations.mesh.spans.iter().enumerate();
            spans.filter(|(_, span)| matches!(span, Span::Interval { .. })).map(|(k, _)| (k, [0.0, 1.0]))
        };
        let most = EVALUATIONS + OF_INTERVAL * equations.mesh.intervals();
        let size = integrate(intervals(), [0.0, ROUGH], most, |k, x| Ok::<_, Stopped>(at(k, x)?[2]))?;
        let size = size.value.max(f64::MIN_POSITIVE);
        let asked = [tolerance * size, 0.0];
        let mut penalties = false;
        let cost = integrate(intervals(), asked, most, |k, x| {
            let [cost, penalty, _] = at(k, x)?;
            penalties |= penalty != 0.0;
            Ok::<_, Stopped>(cost)
        })?;
        let (mut penalty, mut error) = (0.0, cost.error);
        if penalties {
            let found = integrate(intervals(), asked, most, |k, x| Ok::<_, Stopped>(at(k, x)?[1]))?;
            (penalty, error) = (found.value, error + found.error);
        }
        Ok(IntegratedCost { cost: cost.value, penalty, size, error: error / size })
    }
}
