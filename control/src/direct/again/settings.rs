//! What changes between two solves: ends, vias, goals, references, obstacles.

use super::resolve::Resolve;
use super::resolve_error::ResolveError;
use crate::problem::{Reference, Shape, TaskError};
use crate::task::check_references::check_reference;

impl Resolve {
    /// The next solve starts at these positions (rad, m) and rates (rad/s, m/s), n entries each. Those that
    /// the problem leaves free do not count. The end of a periodic motion follows.
    ///
    /// # Errors
    /// [`ResolveError`]: another length, a number that is not finite, or one beyond its limits.
    pub fn set_start(&mut self, q: &[f64], v: &[f64]) -> Result<(), ResolveError> {
        self.set(0, ["q at the start", "v at the start"], q, v)
    }

    /// The next solve ends at these positions and rates, as [`set_start`](Self::set_start).
    ///
    /// # Errors
    /// As [`set_start`](Self::set_start), and [`ResolveError::Periodic`].
    pub fn set_end(&mut self, q: &[f64], v: &[f64]) -> Result<(), ResolveError> {
        if self.shift.is_some() {
            return Err(ResolveError::Periodic);
        }
        self.set(self.states.len() - 1, ["q at the end", "v at the end"], q, v)
    }

    /// The next solve has these positions and rates in [`Problem::vias`](crate::Problem::vias)`[via]`, as
    /// [`set_start`](Self::set_start).
    ///
    /// # Errors
    /// As [`set_start`](Self::set_start), and [`ResolveError::NoEntry`].
    pub fn set_via(&mut self, via: usize, q: &[f64], v: &[f64]) -> Result<(), ResolveError> {
        if via + 2 >= self.states.len() {
            return Err(ResolveError::NoEntry { table: "via", entry: via });
        }
        self.set(via + 1, ["q at the via", "v at the via"], q, v)
    }

    /// The next solve starts with these accelerations (rad/s^2, m/s^2), where the problem gives them. The end
    /// of a periodic motion follows.
    ///
    /// # Errors
    /// As [`set_start`](Self::set_start), and [`ResolveError::FreeAcceleration`].
    pub fn set_start_acceleration(&mut self, a: &[f64]) -> Result<(), ResolveError> {
        self.set_acceleration(0, "a at the start", a)
    }

    /// The next solve ends with these accelerations, as
    /// [`set_start_acceleration`](Self::set_start_acceleration).
    ///
    /// # Errors
    /// As [`set_start_acceleration`](Self::set_start_acceleration), and [`ResolveError::Periodic`].
    pub fn set_end_acceleration(&mut self, a: &[f64]) -> Result<(), ResolveError> {
        if self.shift.is_some() {
            return Err(ResolveError::Periodic);
        }
        self.set_acceleration(self.states.len() - 1, "a at the end", a)
    }

    fn set(
        &mut self,
        end: usize,
        [what_q, what_v]: [&'static str; 2],
        q: &[f64],
        v: &[f64],
    ) -> Result<(), ResolveError> {
        self.fits(end, 0, what_q, q)?;
        self.fits(end, 1, what_v, v)?;
        self.put(end, 0, q);
        self.put(end, 1, v);
        Ok(())
    }

    fn set_acceleration(&mut self, end: usize, what: &'static str, a: &[f64]) -> Result<(), ResolveError> {
        let n = self.dof();
        if !self.interior.ends.given[end].get(2 * n).is_some_and(|given| *given) {
            return Err(ResolveError::FreeAcceleration { what });
        }
        self.fits(end, 2, what, a)?;
        self.put(end, 2, a);
        Ok(())
    }

    /// Checks positions (0), rates (1) or accelerations (2) for an end of a phase.
    fn fits(&self, end: usize, order: usize, what: &'static str, values: &[f64]) -> Result<(), ResolveError> {
        let n = self.dof();
        if values.len() != n {
            return Err(ResolveError::WrongLength { what, expected: n, found: values.len() });
        }
        for (joint, (&value, limits)) in values.iter().zip(&self.limits).enumerate() {
            if !self.interior.ends.given[end][n * order + joint] {
                continue;
            }
            if !value.is_finite() {
                return Err(ResolveError::NotFinite { what, entry: joint });
            }
            let [low, high] = match order {
                0 => limits.q,
                1 => [-limits.v, limits.v],
                _ => [-limits.a, limits.a],
            };
            if !(low..=high).contains(&value) {
                let joint = self.joint_name(joint);
                return Err(ResolveError::Outside { what, joint, value, low, high });
            }
        }
        Ok(())
    }

    /// Puts positions, rates or accelerations into the state of an end, and with those of the start of a
    /// periodic motion those of its end.
    fn put(&mut self, end: usize, order: usize, values: &[f64]) {
        let place = values.len() * order..values.len() * (order + 1);
        self.states[end][place.clone()].copy_from_slice(values);
        if let (Some(shift), 0, Some(last)) = (&self.shift, end, self.states.last_mut()) {
            let own = &mut last[place];
            own.copy_from_slice(values);
            if order == 0 {
                own.iter_mut().zip(shift).for_each(|(q, shift)| *q += shift);
            }
        }
    }

    /// The next solve has this position (m) in [`Task::start_tools`](crate::Task::start_tools)`[tool]`.
    /// Coordinates that the problem leaves free stay free.
    ///
    /// # Errors
    /// [`ResolveError::NoTool`], [`ResolveError::NotFinite`].
    pub fn set_start_tool(&mut self, tool: usize, position: [f64; 3]) -> Result<(), ResolveError> {
        let rows = self.goals.rows("start.tool", 0, tool, &position)?;
        self.set_end_rows(0, rows, position);
        Ok(())
    }

    /// The same of [`Task::end_tools`](crate::Task::end_tools).
    ///
    /// # Errors
    /// As [`set_start_tool`](Self::set_start_tool).
    pub fn set_end_tool(&mut self, tool: usize, position: [f64; 3]) -> Result<(), ResolveError> {
        let rows = self.goals.rows("end.tool", 1, tool, &position)?;
        let end = self.states.len() - 1;
        self.set_end_rows(end, rows, position);
        Ok(())
    }

    fn set_end_rows(&mut self, end: usize, rows: [Option<usize>; 3], position: [f64; 3]) {
        for (row, x) in rows.into_iter().zip(position).filter_map(|(row, x)| Some((row?, x))) {
            self.interior.model.tasks.set_end_value(end, row, x);
            self.interior.barrier.set_end_bound(end, row, x);
        }
    }

    /// The next solve has this position (m) in [`Task::tool_costs`](crate::Task::tool_costs)`[cost]`, as
    /// [`set_start_tool`](Self::set_start_tool).
    ///
    /// # Errors
    /// As [`set_start_tool`](Self::set_start_tool).
    pub fn set_tool_cost(&mut self, cost: usize, position: [f64; 3]) -> Result<(), ResolveError> {
        let rows = self.goals.rows("cost.tool", 2, cost, &position)?;
        for (row, x) in rows.into_iter().zip(position).filter_map(|(row, x)| Some((row?, x))) {
            self.interior.running.set_tool_value(row, x);
        }
        Ok(())
    }

    /// The next solve has this shape in [`Task::obstacles`](crate::Task::obstacles)`[obstacle]`: the same one
    /// in another place, a capsule of any length. It stands still during the motion; what moves is where it
    /// is in the next solve. Whether the start keeps away from it is not checked: limits that cannot be kept
    /// show in [`Resolved::violation`](crate::Resolved::violation).
    ///
    /// # Errors
    /// [`ResolveError::NoEntry`]; [`ResolveError::Task`]: another shape or size, numbers that are not finite.
    pub fn set_obstacle(&mut self, obstacle: usize, shape: &Shape) -> Result<(), ResolveError> {
        let (table, entry) = ("obstacle", obstacle);
        if obstacle >= self.problem.task.obstacles.len() {
            return Err(ResolveError::NoEntry { table, entry });
        }
        let moved = self.interior.model.tasks.move_obstacle(obstacle, shape);
        moved.map_err(|cause| ResolveError::Task { table, entry, cause })?;
        self.problem.task.obstacles[obstacle].shape = shape.clone();
        Ok(())
    }

    /// The next solve has this reference in [`Task::references`](crate::Task::references)`[reference]`, of
    /// the same joints, or of the same tool and coordinates; with its weights. Allocates only if it has more
    /// knots than any before it.
    ///
    /// # Errors
    /// [`ResolveError::NoEntry`]; [`ResolveError::Task`]: a reference of something else, or one that
    /// [`Problem::check`](crate::Problem::check) would refuse.
    pub fn set_reference(&mut self, reference: usize, to: &Reference) -> Result<(), ResolveError> {
        let (table, entry, n) = ("cost.reference", reference, self.dof());
        let references = &mut self.interior.running.references;
        if reference >= references.count() {
            return Err(ResolveError::NoEntry { table, entry });
        }
        let task = |cause| ResolveError::Task { table, entry, cause };
        check_reference(to, n).map_err(|(_, cause)| task(cause))?;
        references.set(reference, to).map_err(|_| task(TaskError::OtherReference))
    }

    /// The next solve starts at this time (s) of all references: what they are at `time` they are at the
    /// start of the motion. 0 at first.
    ///
    /// # Errors
    /// [`ResolveError::NotFinite`].
    pub fn set_start_time(&mut self, time: f64) -> Result<(), ResolveError> {
        if !time.is_finite() {
            return Err(ResolveError::NotFinite { what: "the start time", entry: 0 });
        }
        self.interior.running.references.start = time;
        Ok(())
    }
}
