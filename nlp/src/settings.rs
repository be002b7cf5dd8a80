//! What steers a solution.

use crate::barrier::{BarrierSettings, LEAST_ROOM};
use crate::centrality::CentralitySettings;
use crate::convex::ConvexSettings;
use crate::filter::FilterSettings;
use crate::newton::RegularisationSettings;
use std::time::Duration;

/// What steers a solution. Each group stands beside the algorithm that it steers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Largest error of the conditions of optimality, of the scaled program.
    pub tolerance: f64,
    /// Largest error of the equations, and of functions beyond their ranges, of the scaled program. It counts
    /// where it is below the tolerance.
    pub feasibility: f64,
    /// Most iterations.
    pub iterations: usize,
    /// A solution begins no iteration after this time since its start; `None` for no limit.
    pub time_limit: Option<Duration>,
    /// The barrier parameter.
    pub barrier: BarrierSettings,
    /// The line search.
    pub filter: FilterSettings,
    /// Centrality correctors.
    pub centrality: CentralitySettings,
    /// Convex Hessians in the place of indefinite ones.
    pub convex: ConvexSettings,
    /// The regularisation of Hessians.
    pub regularisation: RegularisationSettings,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            tolerance: 1e-8,
            feasibility: 1e-8,
            iterations: 1000,
            time_limit: None,
            barrier: BarrierSettings::default(),
            filter: FilterSettings::default(),
            centrality: CentralitySettings::default(),
            convex: ConvexSettings::default(),
            regularisation: RegularisationSettings::default(),
        }
    }
}

impl Settings {
    /// The first setting that is out of its range: name, value, least, most.
    pub(crate) fn first_wrong(&self) -> Option<(&'static str, f64, [f64; 2])> {
        let Self { tolerance, feasibility, barrier, filter, centrality, convex, regularisation, .. } = self;
        const BELOW_ONE: [f64; 2] = [f64::MIN_POSITIVE, 1.0 - f64::EPSILON];
        const POSITIVE: [f64; 2] = [f64::MIN_POSITIVE, f64::MAX];
        const ABOVE_ONE: [f64; 2] = [1.0 + f64::EPSILON, f64::MAX];
        let all = [
            ("tolerance", *tolerance, BELOW_ONE),
            ("feasibility", *feasibility, POSITIVE),
            ("barrier.start", barrier.start, POSITIVE),
            ("barrier.least", barrier.least, [0.0, f64::MAX]),
            ("barrier.largest", barrier.largest, [1.0, f64::MAX]),
            ("barrier.change[0]", barrier.change[0], BELOW_ONE),
            ("barrier.change[1]", barrier.change[1], [1.0, f64::MAX]),
            ("barrier.centring", barrier.centring, [0.0, f64::MAX]),
            ("barrier.regularised[0]", barrier.regularised[0], BELOW_ONE),
            ("barrier.regularised[1]", barrier.regularised[1], BELOW_ONE),
            ("barrier.part", barrier.part, BELOW_ONE),
            ("barrier.neighbourhood", barrier.neighbourhood, ABOVE_ONE),
            ("barrier.inside[0]", barrier.inside[0], POSITIVE),
            ("barrier.inside[1]", barrier.inside[1], [f64::MIN_POSITIVE, 0.5]),
            ("barrier.near[0]", barrier.near[0], [LEAST_ROOM, f64::MAX]),
            ("barrier.near[1]", barrier.near[1], ABOVE_ONE),
            ("filter.margins[0]", filter.margins[0], BELOW_ONE),
            ("filter.margins[1]", filter.margins[1], BELOW_ONE),
            ("filter.switching[0]", filter.switching[0], POSITIVE),
            ("filter.switching[1]", filter.switching[1], ABOVE_ONE),
            ("filter.switching[2]", filter.switching[2], [1.0, f64::MAX]),
            ("filter.armijo", filter.armijo, [f64::MIN_POSITIVE, 0.5]),
            ("filter.violations[0]", filter.violations[0], POSITIVE),
            ("filter.violations[1]", filter.violations[1], POSITIVE),
            ("filter.increase", filter.increase, POSITIVE),
            ("filter.correction.0", filter.correction.0, BELOW_ONE),
            ("centrality.longer", centrality.longer, BELOW_ONE),
            ("centrality.enough", centrality.enough, BELOW_ONE),
            ("centrality.products[0]", centrality.products[0], BELOW_ONE),
            ("centrality.products[1]", centrality.products[1], ABOVE_ONE),
            ("centrality.gain", centrality.gain, BELOW_ONE),
            ("centrality.descent", centrality.descent, BELOW_ONE),
            ("convex.accepted[0]", convex.accepted[0], BELOW_ONE),
            ("convex.accepted[1]", convex.accepted[1], [convex.accepted[0], 1.0 - f64::EPSILON]),
            ("convex.metric[0]", convex.metric[0], POSITIVE),
            ("convex.metric[1]", convex.metric[1], POSITIVE),
            ("convex.factors[0]", convex.factors[0], ABOVE_ONE),
            ("convex.factors[1]", convex.factors[1], BELOW_ONE),
            ("regularisation.first", regularisation.first, POSITIVE),
            ("regularisation.least", regularisation.least, POSITIVE),
            ("regularisation.largest", regularisation.largest, [regularisation.first, f64::MAX]),
            ("regularisation.decrease", regularisation.decrease, BELOW_ONE),
            ("regularisation.increase[0]", regularisation.increase[0], ABOVE_ONE),
            ("regularisation.increase[1]", regularisation.increase[1], ABOVE_ONE),
        ];
        // Not true for NaN.
        all.into_iter().find(|(_, value, [least, most])| !(value >= least && value <= most))
    }
}
