//! What the next solve begins with, ends at and goes to.

use super::resolve::Resolve;
use super::resolve_error::ResolveError;

impl Resolve {
    /// The next solve starts at these positions (rad, m) and rates (rad/s, m/s), n entries each. Those that
    /// the problem leaves free do not count.
    ///
    /// # Errors
    /// [`ResolveError`]: another length, a number that is not finite, or one beyond its limits.
    pub fn set_start(&mut self, q: &[f64], v: &[f64]) -> Result<(), ResolveError> {
        self.set(0, ["q at the start", "v at the start"], q, v)
    }

    /// The next solve ends at these positions and rates, as [`set_start`](Self::set_start).
    ///
    /// # Errors
    /// As [`set_start`](Self::set_start).
    pub fn set_end(&mut self, q: &[f64], v: &[f64]) -> Result<(), ResolveError> {
        self.set(1, ["q at the end", "v at the end"], q, v)
    }

    fn set(
        &mut self,
        end: usize,
        names: [&'static str; 2],
        q: &[f64],
        v: &[f64],
    ) -> Result<(), ResolveError> {
        let n = self.dof();
        let given = &self.interior.ends.given[end];
        for (group, (what, values)) in names.into_iter().zip([q, v]).enumerate() {
            if values.len() != n {
                return Err(ResolveError::WrongLength { what, expected: n, found: values.len() });
            }
            for (joint, (&value, limits)) in values.iter().zip(&self.limits).enumerate() {
                if !given[n * group + joint] {
                    continue;
                }
                if !value.is_finite() {
                    return Err(ResolveError::NotFinite { what, entry: joint });
                }
                let [low, high] = if group == 0 { limits.q } else { [-limits.v, limits.v] };
                if !(low..=high).contains(&value) {
                    return Err(ResolveError::Outside { what, joint, value, low, high });
                }
            }
        }
        self.states[end][..n].copy_from_slice(q);
        self.states[end][n..].copy_from_slice(v);
        Ok(())
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
        self.set_end_rows(1, rows, position);
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
}
