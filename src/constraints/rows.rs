//! All constraints of a robot: g, J and the contracted Hessian of g.

use super::held::Held;
use super::position::check_position;
use crate::configuration::Brackets;
use crate::error::{EvalError, check_length};
use crate::kinematics::Kinematics;
use crate::matrix::{Matrix, add_scaled, filled};
use crate::robot::{ConstraintRow, Robot, Tree};
use crate::scalar::Scalar;
use std::ops::Range;

/// Workspace for the constraints g(q) of a robot, k rows; no call allocates.
///
/// The rows are those of the [constraints](Robot::constraints), one after the other. Coordinates are as in
/// [`Hamiltonian`](crate::hamiltonian::Hamiltonian): q has n entries (rad, m), with floating and spherical
/// joints nq. Rows of positions and distances are in m, rows of orientations and couplings of revolute joints
/// in rad.
///
/// ```
/// use costate::constraints::Constraints;
/// use costate::robot::{ConstraintSpec, Placement, Robot};
///
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let tip = Placement::from_xyz_rpy([1.0, 0.0, 0.0], [0.0; 3]);
/// let rod = ConstraintSpec::distance("rod", "elbow", "world", 1.5).placed(tip);
/// let robot = Robot::from_file("robots/two_link.toml")?.with_constraint(rod)?;
/// let mut constraints = Constraints::<f64>::new(&robot);
/// constraints.set_position(&[0.3, -0.8])?;
/// println!("g = {:?}, J = {}", constraints.values(), constraints.jacobian().view().as_nalgebra());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Constraints<S: Scalar> {
    kinematics: Kinematics<S>,
    /// The links that carry frames, and those before them.
    links: Vec<usize>,
    held: Vec<Held<S>>,
    names: Vec<String>,
    rows: Vec<Range<usize>>,
    /// The coordinates that enter any row: all other rows and columns of Hessians stay zero.
    coordinates: Vec<usize>,
    values: Vec<S>,
    jacobian: Matrix<S>,
    sizes: Matrix<S>,
    hessian: Matrix<S>,
    /// Coordinates of the chains of joints.
    chart: Vec<S>,
    brackets: Brackets<S>,
    /// `J'mu`.
    force: Vec<S>,
}

impl<S: Scalar> Constraints<S> {
    /// Builds the workspace. Later calls do not allocate.
    pub fn new(robot: &Robot) -> Self {
        Self::from_tree(&Tree::from(robot))
    }

    pub(super) fn from_tree(tree: &Tree) -> Self {
        let (n, of) = (tree.dof(), tree.rows());
        let held: Vec<Held<S>> =
            tree.constraints().iter().map(|one| Held::new(tree, &of, &one.kind)).collect();
        let mut k = 0;
        let rows = held.iter().map(|one| {
            let first = k;
            k += one.rows();
            first..k
        });
        let rows: Vec<_> = rows.collect();
        let mut links: Vec<usize> =
            held.iter().flat_map(Held::frames).flat_map(|frame| tree.path(frame.joint)).collect();
        links = links.into_iter().flat_map(|joint| tree.path(Some(tree.axis_of(joint)[1]))).collect();
        links.sort_unstable();
        links.dedup();
        let mut coordinates: Vec<usize> = held.iter().flat_map(Held::coordinates).collect();
        coordinates.sort_unstable();
        coordinates.dedup();
        Self {
            kinematics: Kinematics::from_tree(tree.clone()),
            links,
            held,
            names: tree.constraints().iter().map(|one| one.name.clone()).collect(),
            rows,
            coordinates,
            values: filled(S::zero(), k),
            jacobian: Matrix::zeros(k, n),
            sizes: Matrix::zeros(k, n),
            hessian: Matrix::zeros(n, n),
            chart: filled(S::zero(), n),
            brackets: Brackets::new(tree),
            force: filled(S::zero(), n),
        }
    }

    /// Number of coordinates, n.
    pub fn dof(&self) -> usize {
        self.kinematics.dof()
    }

    /// Number of rows, k.
    pub fn count(&self) -> usize {
        self.values.len()
    }

    /// The name of the constraint that row `i` belongs to.
    pub fn name(&self, i: usize) -> &str {
        self.place_of(i).map_or("", |(k, _)| &self.names[k])
    }

    /// What row `i` holds; none for a distance or a coupling.
    pub fn component(&self, i: usize) -> Option<ConstraintRow> {
        let (k, row) = self.place_of(i)?;
        self.held[k].component(row)
    }

    /// The constraint that row `i` belongs to, and its number among the rows of that.
    fn place_of(&self, i: usize) -> Option<(usize, usize)> {
        let k = self.rows.iter().position(|rows| rows.contains(&i))?;
        Some((k, i - self.rows[k].start))
    }

    #[cfg(test)]
    /// The rows of constraint `k`.
    pub(super) fn rows(&self, k: usize) -> Range<usize> {
        self.rows[k].clone()
    }

    /// Computes g and J at q (nq: n without floating and spherical joints).
    ///
    /// # Errors
    /// [`EvalError::WrongLength`] or [`EvalError::NonFinite`]; [`EvalError::NotUnit`].
    pub fn set_position(&mut self, q: &[S]) -> Result<(), EvalError> {
        check_position(self.kinematics.tree(), "q", q)?;
        self.place(q);
        Ok(())
    }

    /// The same without a check.
    #[inline(never)]
    pub(super) fn place(&mut self, q: &[S]) {
        self.kinematics.tree().chart_coordinates(q, &mut self.chart);
        self.kinematics.pose_chart(q, &self.chart, &self.links);
        self.jacobian.fill_zero();
        for (held, rows) in self.held.iter_mut().zip(&self.rows) {
            held.place(&self.kinematics, &self.chart, &mut self.values[rows.clone()]);
            held.add_gradients(&mut self.jacobian, rows.start);
        }
    }

    /// The coordinates that enter each row.
    pub(super) fn pattern(&self) -> Vec<Vec<usize>> {
        let rows = self.held.iter().flat_map(|one| (0..one.rows()).map(|_| one.coordinates()));
        rows.collect()
    }

    /// The model.
    pub(super) fn tree(&self) -> &Tree {
        self.kinematics.tree()
    }

    /// Squares of what the rounding errors of J are in proportion to, at the position of the last call, k x
    /// n.
    pub(super) fn sizes(&mut self) -> &Matrix<S> {
        self.sizes.fill_zero();
        for (held, rows) in self.held.iter().zip(&self.rows) {
            held.add_sizes(&mut self.sizes, rows.start);
        }
        &self.sizes
    }

    /// g, k: zero where the loops are closed.
    pub fn values(&self) -> &[S] {
        &self.values
    }

    /// `J = g_q`, k x n; with floating and spherical joints in the tangent space, `g' = J v`.
    pub fn jacobian(&self) -> &Matrix<S> {
        &self.jacobian
    }

    /// `(mu . g)_qq = (J'mu)_q` for constant mu (k), n x n, symmetric. With floating and spherical joints
    /// it is that of `mu . g(q (+) xi)` by xi at zero.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`] unless mu has k entries.
    pub fn hessian(&mut self, mu: &[S]) -> Result<&Matrix<S>, EvalError> {
        check_length("mu", mu, self.count())?;
        self.contract(mu);
        self.brackets
            .of_momentum(&self.force)
            .iter()
            .for_each(|e| self.hessian[(e.row, e.column)] -= e.value.times(0.5));
        Ok(&self.hessian)
    }

    /// `(J'mu)_q`, without a check: entry (i, j) is the derivative of that of `J'mu` at i along j. The
    /// antisymmetric part is half of K of `J'mu`.
    #[inline(never)]
    pub(super) fn contract(&mut self, mu: &[S]) -> &Matrix<S> {
        for &i in &self.coordinates {
            self.hessian.row_mut(i).fill(S::zero());
        }
        for (held, rows) in self.held.iter().zip(&self.rows) {
            held.add_curvature(&mu[rows.clone()], &mut self.hessian);
        }
        if !self.kinematics.tree().free().is_empty() {
            self.force.fill(S::zero());
            mu.iter().zip(0..).for_each(|(&mu, i)| add_scaled(&mut self.force, mu, self.jacobian.row(i)));
            // Chains of joints give the derivative along the joint that is nearer to the base, of the other.
            let upper = self.brackets.of_momentum(&self.force).iter().filter(|e| e.row < e.column);
            upper.for_each(|e| self.hessian[(e.row, e.column)] += e.value);
        }
        &self.hessian
    }

    /// Force (N) and moment (N m) that constraint `k` of [`Robot::constraints`] exerts on the link of its
    /// first frame, at the origin of that frame, in axes of the second frame, for the multipliers lambda of
    /// all rows. The link of the second frame gets the opposite. `None` for a coupling, whose multiplier is
    /// the generalised force at a joint of factor 1 (N m, N), and for a k that does not exist.
    pub fn wrench(&self, k: usize, lambda: &[S]) -> Option<(/* force */ [S; 3], /* moment */ [S; 3])> {
        let rows = self.rows.get(k)?.clone();
        let [force, moment] = self.held[k].wrench(lambda.get(rows)?)?;
        Some((force.to_array(), moment.to_array()))
    }
}

impl Constraints<f64> {
    /// By how much row `i` is missed at the position of the last call: a length or an angle (m, rad), `|r| -
    /// l` of a distance and `2 asin eps` of a turn, without sign.
    pub fn miss(&self, i: usize) -> f64 {
        self.miss_of(i, 0.0)
    }

    /// The same for another value of the row than zero.
    pub(super) fn miss_of(&self, i: usize, target: f64) -> f64 {
        let Some((k, row)) = self.place_of(i) else { return 0.0 };
        let measure = |g| self.held[k].measure(row, g);
        (measure(self.values[i]) - measure(target)).abs()
    }
}

#[cfg(test)]
#[path = "rows_tests.rs"]
mod tests;
