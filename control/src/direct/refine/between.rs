//! Places between the points of an interval.

use crate::direct::interior::iterate::Interior;
use crate::direct::points::values::{PointDynamics, Points};
use costate::EvalError;

/// Places of an interval at which limits are checked between points: those of Gauss's rule with eight.
pub(super) const BETWEEN: [f64; 8] = [
    0.019_855_071_751_231_856,
    0.101_666_761_293_186_64,
    0.237_233_795_041_835_5,
    0.408_282_678_752_175_1,
    0.591_717_321_247_825,
    0.762_766_204_958_164_5,
    0.898_333_238_706_813_4,
    0.980_144_928_248_768_1,
];

/// The weights of these places; the other half is the same in the opposite order.
const WEIGHTS: [f64; 4] =
    [0.050_614_268_145_188_13, 0.111_190_517_226_687_24, 0.156_853_322_938_943_65, 0.181_341_891_689_181];

/// The weight of a place between the points.
pub(super) fn weight(at: usize) -> f64 {
    WEIGHTS[at.min(BETWEEN.len() - 1 - at)]
}

/// The rule of these places, places and weights.
pub(super) fn rule() -> [[f64; 2]; BETWEEN.len()] {
    std::array::from_fn(|at| [BETWEEN[at], weight(at)])
}

/// Evaluates a motion at these places of each interval.
pub(super) fn evaluate_places<D: PointDynamics>(
    interior: &mut Interior<D>,
    places: &[f64],
    points: &mut Points,
) -> Result<(), EvalError> {
    let (spline, n) = (&interior.spline, interior.spline.dof);
    let phases = spline.mesh.ends().iter().skip(1).map(|node| places.len() * node);
    points.resize_values(n, interior.rows(), phases);
    for (at, z) in points.z.chunks_exact_mut(3 * n).enumerate() {
        spline.in_interval(at / places.len(), places[at % places.len()], z);
    }
    interior.model.evaluate_at(points)
}
