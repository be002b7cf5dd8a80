//! What counts as a success, and searches of the same problem side by side.

use crate::record::{MATRICES, Record, Search};
use costate_control::Coordinates;

/// Largest miss at the end (rad, rad/s).
pub const END_DEFECT: f64 = 1e-6;
/// Largest drift of H*, in parts of `max |y'f| + |l|`.
pub const DRIFT: f64 = 1e-8;
/// Costs that differ by more than this part belong to two extremals.
pub const SAME: f64 = 1e-6;

impl Record {
    /// Converged, and what was found is a motion that arrives, with H* constant.
    pub fn succeeded(&self) -> bool {
        let arrives = self.end_defect.is_some_and(|miss| miss < END_DEFECT);
        self.status == "converged" && arrives && self.drift < DRIFT
    }

    /// Work in evaluations of the right-hand side.
    pub fn work(&self) -> f64 {
        self.rates as f64 + self.jacobian_cost * self.jacobians as f64
    }
}

/// How another kind of search did beside the first, over problems for which both are known.
#[derive(Default)]
pub struct Paired {
    pub both: usize,
    /// The first alone, the other alone.
    pub alone: (usize, usize),
    pub neither: usize,
    /// Of the other in parts of the first, where both succeeded: work, time, steps.
    pub work: Vec<f64>,
    pub time: Vec<f64>,
    pub steps: Vec<f64>,
    /// Both succeeded and found two extremals; of these the first one the cheaper.
    pub differ: (usize, usize),
}

impl Paired {
    /// Of the searches that `keep` lets through, each beside the one that `other` makes of it.
    pub fn new(records: &[Record], keep: impl Fn(&Search) -> bool, other: impl Fn(Search) -> Search) -> Self {
        let mut found = Self::default();
        for first in records.iter().filter(|record| keep(&record.search)) {
            let search = other(first.search);
            let Some(other) = records.iter().find(|record| record.search == search) else { continue };
            match (first.succeeded(), other.succeeded()) {
                (true, true) => found.add(first, other),
                (true, false) => found.alone.0 += 1,
                (false, true) => found.alone.1 += 1,
                (false, false) => found.neither += 1,
            }
        }
        found
    }

    fn add(&mut self, first: &Record, other: &Record) {
        self.both += 1;
        if (first.cost - other.cost).abs() > SAME * first.cost.abs().max(other.cost.abs()) {
            self.differ.0 += 1;
            self.differ.1 += usize::from(first.cost < other.cost);
        }
        self.work.push(other.work() / first.work());
        self.time.push(other.milliseconds / first.milliseconds);
        self.steps.push(other.steps as f64 / first.steps as f64);
    }
}

/// Successes of each matrix, over problems for which all are known, and their number.
pub fn successes(
    records: &[Record],
    coordinates: Coordinates,
    keep: impl Fn(&Record) -> bool,
) -> ([usize; 3], usize) {
    let counts = MATRICES.map(|matrix| {
        let of_matrix = |record: &&Record| {
            record.search.matrix == matrix && record.search.coordinates == coordinates && keep(record)
        };
        let all = records.iter().filter(of_matrix);
        (all.clone().filter(|record| record.succeeded()).count(), all.count())
    });
    (counts.map(|(successes, _)| successes), counts.map(|(_, all)| all).into_iter().max().unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::{RobotName, Variant};
    use costate_control::JacobianRoute;

    fn record(pair: usize, matrix: JacobianRoute, change: impl Fn(&mut Record)) -> Record {
        let (robot, variant, coordinates) = (RobotName::Panda, Variant::Plain, Coordinates::Hamiltonian);
        let mut record = Record {
            search: Search { robot, variant, pair, coordinates, matrix },
            status: "converged".into(),
            end_defect: Some(1e-9),
            drift: 1e-10,
            cost: 2.0,
            steps: 5,
            nodes: 21,
            rates: 100,
            jacobians: 10,
            jacobian_cost: 3.0,
            milliseconds: 1.0,
        };
        change(&mut record);
        record
    }

    #[test]
    fn only_what_arrives_with_a_constant_hamiltonian_is_a_success() {
        let succeeded = |change: &dyn Fn(&mut Record)| record(0, JacobianRoute::Exact, change).succeeded();
        assert!(succeeded(&|_| {}));
        assert!(!succeeded(&|record| record.end_defect = Some(2e-6)));
        assert!(!succeeded(&|record| record.end_defect = None));
        assert!(!succeeded(&|record| record.drift = 2e-8));
        assert!(!succeeded(&|record| record.status = "mesh_limit".into()));
    }

    #[test]
    fn pairs_are_of_the_same_problem() {
        let fail = |record: &mut Record| record.status = "newton_failed".into();
        let (exact, other) = (JacobianRoute::Exact, JacobianRoute::Differences);
        let records = [
            record(0, exact, |_| {}),
            record(0, other, |record| (record.jacobian_cost, record.cost) = (42.0, 2.1)),
            record(1, exact, |_| {}),
            record(1, other, fail),
            record(2, exact, fail),
            record(2, other, fail),
            record(3, exact, |_| {}),
        ];
        let found = Paired::new(
            &records,
            |search| search.matrix == exact,
            |search| Search { matrix: other, ..search },
        );
        assert_eq!((found.both, found.alone, found.neither, found.differ), (1, (1, 0), 1, (1, 1)));
        assert_eq!(found.work, [4.0]);
    }
}
