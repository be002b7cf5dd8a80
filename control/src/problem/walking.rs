//! A step of a gait as a motion of a robot with its foot in constraints.
//!
//! In the plane each foot that stands is held along two directions d_1, d_2, the edges of the friction cone
//! of the ground: its force is `a_1 d_1 + a_2 d_2` with the multipliers a of these rows, and it is in the
//! cone where both are positive; soles have one more, and feet in space other rows ([`super::soles`]). As in
//! [`super::loops`] the multipliers are accelerations of further coordinates nu, and nothing depends on their
//! rates. So the rates with which a
//! step begins are the impulses Lambda of the impact before it: what `p = M v - J'dnu/dt` says about them is
//! that p is continuous there, but for the exchange of the legs,
//!
//! ```text
//! M v(0) - J'dnu/dt(0) = S M v(T),    J v(0) = 0,    g(q(0)) = 0,    q(0) = S q(T) + shift
//! ```
//!
//! Impulses are in the cone where these rates are positive. In a step that begins on all feet
//! ([`super::standing`]) they are zero.

use super::error::ProblemError;
use super::gait::Gait;
use super::gait_checks::check_numbers;
use super::gait_error::GaitError;
use super::key::Key;
use super::loop_rows::{Foot, LoopPhase, LoopRow, Loops, Walk};
use super::standing::{Standing, no_foot};
use super::{BoundaryState, FinalTime, Problem, Via};
use costate::EvalError;
use costate::constraints::{ConstrainedHamiltonian, Constraints};
use costate::lagrangian::Lagrangian;
use costate::robot::ConstraintSpec;

impl Problem {
    /// With a step of this gait as the motion: its start and its end are free, and [`start`](Self::start) is
    /// a guess of the position with which it begins. The position of [`end`](Self::end) is not read; nothing
    /// else may be given of the two.
    #[must_use]
    pub fn with_gait(self, gait: Gait) -> Self {
        Self { gait: Some(gait), ..self }
    }

    /// Whether the solver makes another problem of this one, with multipliers as coordinates.
    pub(crate) fn is_closed(&self) -> bool {
        self.gait.is_some() || !self.robot.constraints().is_empty()
    }

    /// An end of a step: all is free.
    pub(super) fn end_of_step(&self) -> BoundaryState {
        let all: Vec<usize> = (0..self.robot.dof()).collect();
        BoundaryState { a: None, ..self.start.clone() }.with_q_free(&all).with_v_free(&all)
    }

    /// The step with the multipliers of the foot that stands as coordinates.
    ///
    /// # Errors
    /// [`ProblemError::Gait`], [`ProblemError::UnknownJoint`], [`ProblemError::GivenTwice`].
    pub(super) fn walking(&self, gait: &Gait) -> Result<Self, ProblemError> {
        check_numbers(gait)?;
        self.check_gravity()?;
        gait.check_widths()?;
        self.check_double_support(gait)?;
        self.check_names(gait)?;
        let exchange = self.exchange(gait)?;
        let along = self.joint(Key::GAIT_ALONG, &gait.along)?;
        self.check_feet(gait, along)?;
        let (q, places) = self.standing_guess(gait)?;
        let mut shift = vec![0.0; q.len()];
        shift[along] = -gait.length;
        self.check_mirror(gait, &exchange, &q, &shift)?;
        self.check_legs(&exchange)?;
        // What cannot be evaluated is told at the start.
        let failed = |error: EvalError| GaitError::CannotStand { cause: error.into() }.at(Key::START_Q);
        let angle = gait.friction.atan();
        let Standing { robot, phases, foot, landing, feet } = self.standing(gait, &places)?;
        let mut corners = [self.robot.clone(), self.robot.clone()];
        for (stands, swings) in gait.stance.iter().zip(&gait.swing) {
            for (of, foot) in corners.iter_mut().zip([swings, stands]) {
                for (number, at) in gait.corners().into_iter().enumerate() {
                    *of = of.with_constraint(gait.corner(foot, number, at)).map_err(no_foot)?;
                }
            }
        }
        let still = vec![0.0; q.len()];
        let held = Self { robot, gait: None, start: BoundaryState::fixed(&q, &still), ..self.clone() };
        let mut rows = Constraints::new(&held.robot);
        rows.set_position(&q).map_err(failed)?;
        let mut kept = held.independent_rows(&mut rows).map_err(failed)?;
        if kept.len() < rows.count() {
            // Those of feet that stand during the whole step come first.
            let lacking = (0..).zip(&kept).take_while(|(number, one)| one.row == *number).count();
            let of = feet.iter().find(|foot| foot.rows.contains(&lacking));
            let frame = of.map_or_else(String::new, |foot| foot.name.clone());
            return Err(match lacking < phases[phases.len() - 1].rows {
                true => GaitError::Redundant { frame }.at(Key::GAIT_STANCE),
                false => GaitError::RedundantTogether { frame }.at(Key::GAIT_DOUBLE_SUPPORT),
            });
        }
        let mut model = Lagrangian::<f64>::new(&self.robot);
        let mass = model.linearise_inverse_dynamics(&q, &still, &still).map_err(failed)?.tau_a;
        let scales: Vec<f64> = (0..q.len()).map(|i| mass[(i, i)]).collect();
        let (share, gravity) = (scales[along] / (2.0 * places.len() as f64), self.robot.gravity().norm());
        // The weight is on both edges alike, and a sole is pressed in its middle.
        let mass = |(foot, row): (&Foot, usize)| match gait.sole {
            _ if gait.is_on_edge(foot.contact) => 2.0 * share * gait.parts_of_edge()[row],
            Some([heel, toe]) if gait.is_angle(foot.contact, row) => share * (toe - heel),
            _ if gait.is_in_space() => 2.0 * share,
            _ => share / angle.cos(),
        };
        let all = feet.iter().flat_map(|foot| (0..foot.rows.len()).map(move |row| (foot, row)));
        let masses: Vec<f64> = all.map(mass).collect();
        let columns = feet.iter().flat_map(|foot| {
            let columns = gait.columns(foot.contact);
            columns.into_iter().take(foot.rows.len())
        });
        let columns = columns.collect();
        if gait.sole.is_some() || gait.is_in_space() {
            // A foot alone is light and easily turned: in its own masses the weight is an acceleration of
            // thousands of units, and limits would be kept to parts of one.
            kept.iter_mut().zip(&masses).for_each(|(row, mass)| row.mass = *mass);
        }
        let lift = match gait.is_in_space() {
            true => gait.lift_in_space(2.0 * share * gravity, &feet, &kept),
            false => kept.iter().zip(masses).map(|(row, mass)| mass * gravity / row.mass).collect(),
        };
        let gait = gait.clone();
        let walk =
            Walk { foot, landing, feet, corners, columns, gait, places, exchange, shift, scales, lift };
        Ok(held.with_walk(walk, kept, phases))
    }

    /// The step from a prepared gait.
    fn with_walk(&self, walk: Walk, rows: Vec<LoopRow>, phases: Vec<LoopPhase>) -> Self {
        let (q, time) = (&self.start.q, self.time.value());
        let end = walk.mirrored_back(q);
        let rates: Vec<f64> = q.iter().zip(&end).map(|(from, to)| (to - from) / time).collect();
        let (n, k) = (q.len(), rows.len());
        let state = |q: &[f64], [q_free, v_free]: [usize; 2]| {
            let more = |list: &[f64]| [list, &vec![0.0; k]].concat();
            let free = |count: usize| (0..count).collect::<Vec<usize>>();
            let state = BoundaryState::fixed(&more(q), &more(&rates));
            state.with_q_free(&free(q_free)).with_v_free(&free(v_free))
        };
        // Without an impulse the rates of the multipliers are zero at the start.
        let impulses = if walk.has_double_support() { 0 } else { k };
        let (first, last) = (state(q, [n, n + impulses]), state(&end, [n + k; 2]));
        let lift_off = |share: f64| match self.time {
            FinalTime::Fixed(time) => Via::default().with_time(share * time),
            FinalTime::Free { .. } => Via::default(),
        };
        let vias = walk.gait.double_support.map(lift_off).into_iter().collect();
        let loops = Loops { phases, walk: Some(walk), ..Loops::new(self.robot.clone(), rows) };
        Self { vias, ..self.with_coordinates_of(loops, first, last) }
    }

    /// The position near the guess with the first foot that stands at the origin, and all that swing one step
    /// behind those that stand; x and y of these. In space feet stay on their side.
    fn standing_guess(&self, gait: &Gait) -> Result<(Vec<f64>, Vec<[f64; 2]>), ProblemError> {
        let failed = |cause| GaitError::CannotStand { cause }.at(Key::START_Q);
        let mut q = self.start.q.clone();
        let mut places = Vec::with_capacity(gait.stance.len());
        let place = |foot: &str| -> Result<[f64; 2], ProblemError> {
            let pinned = ConstraintSpec::pinned(foot, foot, "world");
            let mut found = Constraints::<f64>::new(&self.robot.with_constraint(pinned).map_err(no_foot)?);
            found.set_position(&q).map_err(|error| failed(error.into()))?;
            Ok([found.values()[0], found.values()[1]])
        };
        for (stands, swings) in gait.stance.iter().zip(&gait.swing) {
            let ([x, y], [_, other]) = (place(stands)?, place(swings)?);
            places.push([x, if gait.is_in_space() { (0.5 * gait.width).copysign(y - other) } else { 0.0 }]);
        }
        let first = places[0][0];
        places.iter_mut().for_each(|[x, _]| *x -= first);
        let mut robot = self.robot.clone();
        for ((stands, swings), [x, y]) in gait.stance.iter().zip(&gait.swing).zip(&places) {
            robot = robot.with_constraint(gait.placed(stands, stands, [*x, *y, 0.0])).map_err(no_foot)?;
            let behind = [x - gait.length, -y, 0.0];
            robot = robot.with_constraint(gait.placed(swings, swings, behind)).map_err(no_foot)?;
        }
        let held = vec![false; q.len()];
        ConstrainedHamiltonian::<f64>::new(&robot).close(&mut q, &held).map_err(failed)?;
        Ok((q, places))
    }
}
