//! What feet need beside the limits of single multipliers: linear rows of the cone of their forces, and
//! corners of soles that do not sink into the ground at the ends of a step.

use super::gait_lifts::GaitLifts;
use crate::problem::loop_rows::{Foot, Loops, Walk};
use crate::problem::wrench_cone::ConeSide;
use crate::task::row::{Measure, Row, Subject};
use costate::EvalError;

/// Derivatives of the rows: by the state at the start and at the end, and second ones of the weighted sum.
pub(crate) struct Derivatives<'a> {
    pub near: &'a mut [f64],
    pub far: &'a mut [f64],
    pub at_start: &'a mut [f64],
    pub at_end: &'a mut [f64],
}

/// Rows of feet in the states x = (q, nu, v, dnu/dt) of both ends, of n joints and k multipliers, after
/// those of all feet:
///
/// ```text
/// impulse in its cone                       of each foot that lands, in dnu/dt at the start
/// dH/dt >= 0 at the start, <= 0 at the end  of each corner that swings
/// ```
///
/// and along the motion the same rows of forces in the accelerations of nu, of all feet that stand: see
/// [`Gait::cone`]. The rates are those of soles. In a step with double support impulses and rates are zero at
/// both ends whatever the motion is, and none of their rows are there.
///
/// [`Gait::cone`]: crate::Gait::cone
#[derive(Clone, Debug)]
pub(crate) struct GaitSoles {
    lifts: GaitLifts,
    /// n and k.
    sizes: [usize; 2],
    /// For each row the first multiplier of its foot, and the row by those of the foot.
    loads: Vec<(usize, Vec<f64>)>,
    bounds: Vec<Row>,
    forces: Vec<Row>,
}

impl GaitSoles {
    /// `None` for points in the plane, whose cones are limits of single multipliers.
    pub fn new(loops: &Loops, walk: &Walk) -> Option<Self> {
        let cones: Vec<(&Foot, Vec<ConeSide>)> =
            walk.feet.iter().map(|foot| (foot, walk.gait.cone(foot.contact))).collect();
        if cones.iter().all(|(_, cone)| cone.is_empty()) {
            return None;
        }
        let (n, rows) = (walk.shift.len(), &loops.rows);
        let loads = cones.iter().flat_map(|(foot, cone)| {
            let (first, rows) = (foot.rows.start, &rows[foot.rows.clone()]);
            cone.iter().map(move |side| {
                let load = side.by.iter().zip(rows).map(|(by, row)| by * row.mass).collect();
                (first, load)
            })
        });
        let weight = walk.weight();
        let of_feet = |subject: Subject, units: [&'static str; 2], weight: f64| {
            cones.iter().flat_map(move |(foot, cone)| {
                cone.iter().map(move |side| Row {
                    lower: 0.0,
                    upper: f64::INFINITY,
                    range: weight * side.length.unwrap_or(1.0),
                    name: side.name_on(&foot.name),
                    unit: units[usize::from(side.length.is_some())],
                    measure: Measure::Plain,
                    subject,
                })
            })
        };
        let forces = of_feet(Subject::GroundForce, ["N", "N m"], weight).collect();
        let gravity = walk.foot.gravity().norm();
        let impulses = of_feet(Subject::LandingImpulse, ["N s", "N m s"], weight / gravity);
        let corners = walk.gait.swing.iter().flat_map(|foot| {
            let corners = if walk.gait.sole.is_some() { walk.gait.corners().len() } else { 0 };
            (0..corners).map(|corner| walk.gait.name_of_corner(foot, corner))
        });
        let arch = [walk.gait.clearance, walk.gait.length];
        let lifts = GaitLifts::new(&walk.corners, arch, &corners.collect::<Vec<_>>());
        let bounds = match walk.has_double_support() {
            true => Vec::new(),
            false => impulses.chain(lifts.bounds().iter().cloned()).collect(),
        };
        Some(Self { sizes: [n, rows.len()], loads: loads.collect(), lifts, bounds, forces })
    }

    /// What holds at the ends, together.
    pub fn bounds(&self) -> &[Row] {
        &self.bounds
    }

    /// What holds along the motion.
    pub fn forces(&self) -> &[Row] {
        &self.forces
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.sizes[0]
    }

    /// Joints' positions and rates of a state.
    fn of_joints<'a>(&self, state: &'a [f64]) -> (&'a [f64], &'a [f64]) {
        let [n, k] = self.sizes;
        (&state[..n], &state[n + k..2 * n + k])
    }

    /// The rows at the ends.
    ///
    /// # Errors
    /// States that cannot be evaluated.
    pub fn values(&mut self, [start, end]: [&[f64]; 2], g: &mut [f64]) -> Result<(), EvalError> {
        if self.bounds.is_empty() {
            return Ok(());
        }
        let (impulses, rates) = g.split_at_mut(self.loads.len());
        self.load(&start[start.len() / 2 + self.sizes[0]..], impulses);
        self.lifts.values([self.of_joints(start), self.of_joints(end)], rates)
    }

    /// Their derivatives; all are added.
    ///
    /// # Errors
    /// As [`values`](Self::values).
    pub fn contract(
        &mut self,
        [start, end]: [&[f64]; 2],
        weights: &[f64],
        Derivatives { near, far, at_start, at_end }: Derivatives<'_>,
    ) -> Result<(), EvalError> {
        if self.bounds.is_empty() {
            return Ok(());
        }
        let ([n, k], width, loads) = (self.sizes, start.len(), self.loads.len());
        for ((first, load), row) in self.loads.iter().zip(near.chunks_exact_mut(width)) {
            let to = &mut row[2 * n + k + first..];
            to.iter_mut().zip(load).for_each(|(to, load)| *to += load);
        }
        let corners = (weights.len() - loads) / 2;
        let (at, middle) = (width * loads, width * (loads + corners));
        let [(q, v), (last_q, last_v)] = [self.of_joints(start), self.of_joints(end)];
        let (lifts, lands) = weights[loads..].split_at(corners);
        self.lifts.contract((q, v, n + k), lifts, &mut near[at..middle], at_start)?;
        self.lifts.contract((last_q, last_v, n + k), lands, &mut far[middle..], at_end)
    }

    /// All rows of cones, of these rates or accelerations of multipliers.
    pub fn load(&self, multipliers: &[f64], loads: &mut [f64]) {
        for (to, (first, load)) in loads.iter_mut().zip(&self.loads) {
            *to = multipliers[*first..].iter().zip(load).map(|(a, load)| a * load).sum();
        }
    }

    /// The same at a point z = (q, v, a) with the Jacobian, rows of the width of z.
    pub fn contract_loads(&self, z: &[f64], loads: &mut [f64], jacobian: &mut [f64]) {
        let ([n, _], width) = (self.sizes, z.len());
        let first_of_all = 2 * width / 3 + n;
        self.load(&z[first_of_all..], loads);
        jacobian.fill(0.0);
        for (row, (first, load)) in jacobian.chunks_exact_mut(width).zip(&self.loads) {
            row[first_of_all + first..].iter_mut().zip(load).for_each(|(to, load)| *to = *load);
        }
    }
}
