//! What a verification that does not use the points of the solver found.

use serde::{Deserialize, Serialize};

/// What became of one check.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum CheckOutcome {
    /// The value is within its tolerance.
    Passed,
    /// It is not.
    Failed,
    /// Not checked: motions of this kind are not covered, or cannot be evaluated.
    #[default]
    NotVerified,
}

/// One check of a verification.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Check {
    /// Whether the value is within its tolerance.
    pub outcome: CheckOutcome,
    /// The largest value, in the unit of the check; `None` where it is not known.
    #[serde(default)]
    pub value: Option<f64>,
    /// The tolerance.
    #[serde(default)]
    pub allowed: Option<f64>,
    /// The time of the largest value (s), where it belongs to one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    /// The joint or the limit that it belongs to, or why nothing was checked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub subject: Option<String>,
}

impl Check {
    /// Of a value with its tolerance. A value that is not a number fails.
    pub(crate) fn of(value: f64, allowed: f64) -> Self {
        let outcome = if value <= allowed { CheckOutcome::Passed } else { CheckOutcome::Failed };
        let value = value.is_finite().then_some(value);
        Self { outcome, value, allowed: Some(allowed), time: None, subject: None }
    }

    /// Not checked, for a reason.
    pub(crate) fn skipped(reason: impl Into<String>) -> Self {
        Self { subject: Some(reason.into()), ..Self::default() }
    }

    /// With the time of the largest value and what it belongs to.
    pub(crate) fn at(self, time: Option<f64>, subject: Option<String>) -> Self {
        Self { time, subject, ..self }
    }

    /// Whether the value exceeds its tolerance.
    pub fn fails(&self) -> bool {
        self.outcome == CheckOutcome::Failed
    }

    /// Whether the value is within its tolerance.
    pub fn passes(&self) -> bool {
        self.outcome == CheckOutcome::Passed
    }
}

/// A verification of a motion that uses its polynomials, its torques by inverse dynamics and the costates at
/// its nodes, and none of the points at which it was optimised.
///
/// Extremals are solved for a tolerance of each component; what is allowed is the [verification
/// bound](crate::Motion::verification_bound) of that, relative to the size of each component and to that of
/// the cost.
///
/// Times at which something narrow happens split the motion: a rate that crosses zero or three transition
/// velocities of dry friction to either side, or the corner or no-load speed of a motor; knots of references.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Verification {
    /// $J = \int_0^T l\\, dt$ without penalties by adaptive quadrature along q(t); `None` where it cannot be
    /// evaluated.
    #[serde(default)]
    pub integrated_cost: Option<f64>,
    /// Estimated error of this quadrature, relative to the size of the cost.
    #[serde(default)]
    pub quadrature_error: Option<f64>,
    /// `|J - J_solver| + error of the quadrature`, penalties included, relative to the size of the cost.
    #[serde(default)]
    pub cost: Check,
    /// The torques lead along the motion. Of robots whose joints are all driven: the largest miss of an
    /// integration from the start, or of the sum over parts of the motion; where that misses more, as of
    /// unstable motions, and of other robots the sum over the nodes of the misses by an implicit method that
    /// begins at the node before. Relative to the largest values of
    /// positions and rates. Of extremals the miss of the state at the end, integrated with the controls of
    /// the costates that were found.
    #[serde(default)]
    pub dynamics: Check,
    /// Hard limits at the extrema of the motion and at random times: the largest excess relative to the range
    /// of the limit, of what does not jump along the motion: positions, rates, tools, clearances; with
    /// continuous accelerations those and torques too. Of polished motions positions, rates and powers, at
    /// nodes and between them.
    #[serde(default)]
    pub limits: Check,
    /// The same of what may jump: accelerations and powers, or jerks and rates of torques. Polynomials
    /// overshoot beside a jump on any mesh, for a time of about the width of an interval. The status does not
    /// depend on this check: limits of torques are cut in [`dynamics`](Self::dynamics), and what exceeds
    /// others by more is named by the [remarks](crate::Solution::remarks).
    #[serde(default)]
    pub overshoot: Check,
    /// The gap $\int G\\, dt$ of the maximum principle, relative to the size of the cost: by how much the
    /// cost may be above that of the optimal motion nearby with the same states at its ends (of jerks with
    /// the same accelerations there too), to second order. Intervals on arcs of limits of the state do not
    /// count; it is skipped where all are. See [`direct_method`](crate::direct_method). Of extremals the
    /// [mismatch](crate::Motion::shooting_defect) of segments integrated again with their costates: along
    /// these the Hamiltonian is maximal by construction.
    #[serde(default)]
    pub optimality: Check,
    /// The largest $|H_u| = |y_\tau - l_\tau|$ of a torque inside its limits at the stages of the integration
    /// of the costates, some of which are random times, relative to the largest of both along the motion. Of
    /// jerks with the costates of the solver, of which the gap may take better ones.
    #[serde(default)]
    pub stationarity: Option<f64>,
    /// The largest difference of the integrated costates at a node from those of the solver, relative to the
    /// largest ones; of extremals that of the states too.
    #[serde(default)]
    pub costate_defect: Option<f64>,
}

impl Verification {
    /// The checks on which the status depends, with their names.
    pub fn checks(&self) -> [(&'static str, &Check); 4] {
        [
            ("cost", &self.cost),
            ("dynamics", &self.dynamics),
            ("limits", &self.limits),
            ("optimality", &self.optimality),
        ]
    }

    /// A motion beside a saddle costs less by about this part of the cost. What failed already stays.
    pub(crate) fn take_saddle(&mut self, part: f64, allowed: f64) {
        let check = Check::of(part, allowed);
        if check.fails() && !self.optimality.fails() {
            let subject = Some("the motion is a saddle, one beside it costs less".into());
            self.optimality = check.at(None, subject);
        }
    }

    /// Nothing was checked, for a reason.
    pub(crate) fn skipped(reason: &str) -> Self {
        let [cost, dynamics, limits, overshoot, optimality] = [(); 5].map(|()| Check::skipped(reason));
        Self { cost, dynamics, limits, overshoot, optimality, ..Self::default() }
    }

    /// Why the motion is not verified: which check failed, by how much, where. `None` where none failed.
    ///
    /// ```
    /// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
    /// use costate::robot::Robot;
    /// use costate_control::{Problem, Solver, SolverOptions};
    ///
    /// let robot = Robot::from_file("robots/two_link.toml")?;
    /// let problem = Problem::rest_to_rest(robot, &[0.0, 0.0], &[1.0, 0.5], 1.0);
    /// let solution = Solver::new(&problem, SolverOptions::default())?.solve();
    /// assert_eq!(solution.verified.and_then(|verified| verified.reason()), None);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn reason(&self) -> Option<String> {
        self.failure().map(in_words)
    }

    /// The [reasons](Self::reason) of all checks that failed.
    pub(crate) fn reasons(&self) -> Vec<String> {
        self.checks().into_iter().filter(|(_, check)| check.fails()).map(in_words).collect()
    }

    /// Whether the motion may cost too much, or its cost is wrong, and nothing else is known to fail.
    pub(crate) fn doubts_cost(&self) -> bool {
        let doubts = self.cost.fails() || self.optimality.fails();
        doubts && !self.dynamics.fails() && !self.limits.fails()
    }

    /// The first check that failed, with its name.
    pub fn failure(&self) -> Option<(&'static str, &Check)> {
        self.checks().into_iter().find(|(_, check)| check.fails())
    }

    /// The errors of the cost that were found, relative to its size: the difference of the costs, or the gap
    /// where that is larger and counts.
    pub(crate) fn cost_error(&self, with_gap: bool) -> f64 {
        let of = |check: &Check| check.value.unwrap_or(if check.fails() { f64::INFINITY } else { 0.0 });
        of(&self.cost).max(if with_gap { of(&self.optimality) } else { 0.0 })
    }
}

/// Which check failed, by how much, where.
fn in_words((name, check): (&str, &Check)) -> String {
    let number = |value: Option<f64>| value.map_or_else(|| "unknown".into(), |x| format!("{x:.1e}"));
    let (value, allowed) = (number(check.value), number(check.allowed));
    let subject = check.subject.as_deref().map_or_else(String::new, |subject| format!(", {subject}"));
    let time = check.time.map_or_else(String::new, |time| format!(" at {time:.6} s"));
    format!("{name}: {value} relative, {allowed} allowed{subject}{time}")
}
