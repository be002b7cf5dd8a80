//! Rows g(q, v) with their bounds and derivatives.

use super::clearance::{Bounds, Clearances, Held, Look, Obstacle};
use super::placed::{Hessian, Placed};
use super::row::Row;
use super::tool::{Quantity, ToolFunction};
use crate::constants::task::MEETING;
use costate::EvalError;
use costate::robot::Robot;
use nalgebra::Rotation3;

/// Rows g(q, v) of a robot with n coordinates; no call allocates.
pub(crate) trait PathFunction {
    /// Number of rows.
    fn rows(&self) -> usize;

    /// g; `g` has an entry for each row.
    ///
    /// # Errors
    /// A q or v that is not finite or has another length than n.
    fn values(&mut self, q: &[f64], v: &[f64], g: &mut [f64]) -> Result<(), EvalError>;

    /// g, its Jacobian by x = (q, v) (rows x 2n, row by row), and `w'g_xx` added to `hessian` (2n x 2n, row
    /// by row, symmetric).
    ///
    /// # Errors
    /// As [`values`](Self::values).
    fn contract(
        &mut self,
        q: &[f64],
        v: &[f64],
        w: &[f64],
        g: &mut [f64],
        jacobian: &mut [f64],
        hessian: &mut [f64],
    ) -> Result<(), EvalError>;
}

/// The largest violation of a clearance on a piece of a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Swept {
    /// In parts of its range; 0 where all are kept. Not the deepest one where bodies meet: the search ends
    /// there.
    pub part: f64,
    /// The part of the piece before it.
    pub place: f64,
    pub row: usize,
}

/// One or several rows that are computed together.
#[derive(Clone, Debug)]
pub(super) enum Part {
    Tool(ToolFunction),
    Clearances(Clearances),
}

/// All rows of one place of a motion.
#[derive(Clone, Debug)]
pub(crate) struct TaskFunctions {
    /// `None` without rows: most places of a motion have none.
    placed: Option<Placed>,
    parts: Vec<Part>,
    /// For each part the phases in which its rows count, `None` for all: bodies of payloads are there while
    /// they are carried.
    phases: Vec<Option<Vec<bool>>>,
    /// The phase that is seen, `None` for all.
    phase: Option<usize>,
    rows: Vec<Row>,
    moves: bool,
    /// Rates at rest.
    still: Vec<f64>,
}

impl Part {
    fn rows(&self) -> usize {
        match self {
            Self::Tool(function) => function.rows(),
            Self::Clearances(clearances) => clearances.rows(),
        }
    }
}

impl TaskFunctions {
    /// No rows yet.
    pub(super) fn new(robot: &Robot) -> Self {
        let still = vec![0.0; robot.dof()];
        let (parts, phases, rows) = (Vec::new(), Vec::new(), Vec::new());
        Self { placed: None, parts, phases, phase: None, rows, moves: false, still }
    }

    /// Adds a part with what holds for its rows.
    pub(super) fn push(&mut self, robot: &Robot, part: Part, rows: impl IntoIterator<Item = Row>) {
        self.push_in(robot, part, rows, None);
    }

    /// The same for rows that count in these phases, `None` for all. In the others they are constant, and
    /// kept by their range.
    pub(super) fn push_in(
        &mut self,
        robot: &Robot,
        part: Part,
        rows: impl IntoIterator<Item = Row>,
        phases: Option<Vec<bool>>,
    ) {
        self.placed(robot);
        self.phases.push(phases);
        self.moves |= matches!(&part, Part::Tool(tool) if tool.moves());
        self.rows.extend(rows);
        self.parts.push(part);
        debug_assert_eq!(self.rows.len(), self.parts.iter().map(Part::rows).sum::<usize>());
    }

    /// Sees the motion in this phase from now on; `None` for any phase, where all rows count.
    pub fn enter(&mut self, phase: Option<usize>) {
        self.phase = phase;
    }

    /// The robot's workspace, for those who build parts.
    pub(super) fn placed(&mut self, robot: &Robot) -> &Placed {
        self.placed.get_or_insert_with(|| Placed::new(robot))
    }

    /// What holds for each row.
    pub fn bounds(&self) -> &[Row] {
        &self.rows
    }

    /// Gives an equation another right-hand side.
    pub fn set_value(&mut self, row: usize, value: f64) {
        let row = &mut self.rows[row];
        (row.lower, row.upper) = (value, value);
    }

    /// Gives a part that is an orientation another one to compare with.
    pub(super) fn set_orientation(&mut self, part: usize, desired: Rotation3<f64>) {
        if let Part::Tool(ToolFunction { quantity: Quantity::Orientation(rotation), .. }) =
            &mut self.parts[part]
        {
            *rotation = desired;
        }
    }

    /// The tool whose rows begin here.
    pub(super) fn tool_at(&mut self, row: usize) -> Option<&mut ToolFunction> {
        let mut first = 0;
        self.parts.iter_mut().find_map(|part| {
            let begins = first;
            first += part.rows();
            match part {
                Part::Tool(tool) if begins == row => Some(tool),
                _ => None,
            }
        })
    }

    /// [`values`](PathFunction::values) at v = 0.
    pub(super) fn values_at_rest(&mut self, q: &[f64], g: &mut [f64]) -> Result<(), EvalError> {
        let still = std::mem::take(&mut self.still);
        let done = self.values(q, &still, g);
        self.still = still;
        done
    }

    /// [`contract`](PathFunction::contract) at v = 0.
    pub(super) fn contract_at_rest(
        &mut self,
        q: &[f64],
        w: &[f64],
        g: &mut [f64],
        jacobian: &mut [f64],
        hessian: &mut [f64],
    ) -> Result<(), EvalError> {
        let still = std::mem::take(&mut self.still);
        let done = self.contract(q, &still, w, g, jacobian, hessian);
        self.still = still;
        done
    }

    /// Whether any row depends on v.
    pub fn depends_on_rates(&self) -> bool {
        self.moves
    }

    /// Goes along a piece of a motion, over x in [0, 1], in steps so short that no two bodies pass
    /// through each other unseen. `positions` and `rates` are the largest |q| and |dq/dx| on it; `state`
    /// writes q at x, `q` has room for it. The largest violation of a clearance.
    ///
    /// # Errors
    /// Positions that are not finite.
    pub fn sweep(
        &mut self,
        [positions, rates]: [&[f64]; 2],
        q: &mut [f64],
        mut state: impl FnMut(f64, &mut [f64]),
    ) -> Result<Swept, EvalError> {
        let mut worst = Swept::default();
        let Self { placed: Some(placed), parts, phases, phase, still, .. } = self else { return Ok(worst) };
        let mut first = 0;
        for (part, phases) in parts.iter_mut().zip(&*phases) {
            let own = first;
            first += part.rows();
            let Part::Clearances(clearances) = part else { continue };
            if !counts(phases.as_ref(), *phase) {
                continue;
            }
            clearances.see_piece(placed, Bounds { positions, rates });
            let mut x = 0.0;
            while x < 1.0 && worst.part < MEETING {
                state(x, q);
                placed.place(q, still)?;
                let Look { violation, row, step } = clearances.look(placed)?;
                if violation > worst.part {
                    worst = Swept { part: violation, place: x, row: own + row };
                }
                x += step;
            }
        }
        Ok(worst)
    }

    /// The clearance that is violated most wherever the robot is, while a point of a link has a given place,
    /// and by how much at least (m).
    pub(super) fn violated_at(&self, robot: &Robot, held: &Held) -> Option<(&Row, f64)> {
        let mut first = 0;
        let mut worst: Option<(&Row, f64)> = None;
        for (part, phases) in self.parts.iter().zip(&self.phases) {
            if let Part::Clearances(clearances) = part
                && counts(phases.as_ref(), self.phase)
                && let Some((row, by)) = clearances.violated_at(robot, held)
                && worst.is_none_or(|(_, most)| by > most)
            {
                worst = Some((&self.rows[first + row], by));
            }
            first += part.rows();
        }
        worst
    }

    /// Moves an obstacle, unless it is another shape or has another size. Whether it did.
    pub(super) fn move_obstacle(&mut self, obstacle: usize, to: &Obstacle) -> bool {
        self.parts.iter_mut().all(|part| match part {
            Part::Clearances(clearances) => clearances.move_obstacle(obstacle, to),
            Part::Tool(_) => true,
        })
    }

    /// Whether there is nothing to evaluate.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }
}

/// Whether rows that hold in some phases count in one.
fn counts(phases: Option<&Vec<bool>>, phase: Option<usize>) -> bool {
    phases.zip(phase).is_none_or(|(phases, phase)| phases.get(phase).copied().unwrap_or(true))
}

/// Values of rows that do not count: inside of their bounds by their range.
fn keep(rows: &[Row], g: &mut [f64]) {
    g.iter_mut().zip(rows).for_each(|(g, row)| *g = row.lower + row.range);
}

impl PathFunction for TaskFunctions {
    fn rows(&self) -> usize {
        self.rows.len()
    }

    fn values(&mut self, q: &[f64], v: &[f64], g: &mut [f64]) -> Result<(), EvalError> {
        let Some(placed) = &mut self.placed else { return Ok(()) };
        placed.place(q, v)?;
        let mut first = 0;
        for (part, phases) in self.parts.iter_mut().zip(&self.phases) {
            let count = part.rows();
            let rows = first..first + count;
            let g = &mut g[rows.clone()];
            match part {
                _ if !counts(phases.as_ref(), self.phase) => keep(&self.rows[rows], g),
                Part::Tool(function) => function.values(placed, g)?,
                Part::Clearances(clearances) => clearances.values(placed, g)?,
            }
            first += count;
        }
        Ok(())
    }

    fn contract(
        &mut self,
        q: &[f64],
        v: &[f64],
        w: &[f64],
        g: &mut [f64],
        jacobian: &mut [f64],
        hessian: &mut [f64],
    ) -> Result<(), EvalError> {
        let Some(placed) = &mut self.placed else { return Ok(()) };
        placed.place(q, v)?;
        placed.fill_screws()?;
        let width = 2 * placed.dof();
        jacobian.fill(0.0);
        let mut hessian = Hessian { entries: hessian, width };
        let mut first = 0;
        for (part, phases) in self.parts.iter_mut().zip(&self.phases) {
            let rows = first..first + part.rows();
            let jacobian = &mut jacobian[width * rows.start..width * rows.end];
            let (w, g) = (&w[rows.clone()], &mut g[rows.clone()]);
            match part {
                _ if !counts(phases.as_ref(), self.phase) => keep(&self.rows[rows.clone()], g),
                Part::Tool(function) => function.contract(placed, w, g, jacobian, &mut hessian)?,
                Part::Clearances(clearances) => {
                    clearances.contract(placed, w, g, jacobian, &mut hessian)?;
                }
            }
            first = rows.end;
        }
        Ok(())
    }
}
