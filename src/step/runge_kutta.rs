//! A Runge-Kutta scheme as a step, with derivatives by the adjoint equations of its stages.

use super::error::check;
use super::hessian::StageHessians;
use super::newton::Newton;
use super::outcome::Outcome;
use super::stage::{Stage, differentiate_sum, sum};
use super::{Pair, Step, StepContraction, StepError, StepLinearisation, Tableau};
use crate::dynamics::Dynamics;
use crate::scalar::Scalar;
use std::marker::PhantomData;

/// One step of a model by the scheme `T`, see [`Tableau`]; no call allocates.
///
/// With `Z_i = dX_i/d(x, u)` and the costates mu_i of the slopes f(X_i, u), computed from the last stage to
/// the first,
///
/// $$ \mu\_i = h \Big( B\_i y + \sum\_{j \ge i} A\_{ji} f\_x(X\_j)^T \mu\_j \Big), \qquad
/// y^T \Phi\_{zz} = \sum\_i \begin{pmatrix} Z\_i \\\\ 0 \enspace 1 \end{pmatrix}^T \mu\_i^T f\_{zz}(X\_i, u)
/// \begin{pmatrix} Z\_i \\\\ 0 \enspace 1 \end{pmatrix}, \qquad z = (x, u). $$
///
/// This takes one contracted Hessian of the model per stage (which includes f and its Jacobians), and no
/// tensor; no iteration or factorisation is differentiated. For an implicit stage, Z_i and mu_i solve linear
/// systems with `1 - h A_ii f_x` and its transpose.
///
/// Implicit stages are solved by Newton's method to rounding, from an explicit guess. If that fails, the
/// error is [`StepError::NotConverged`]; take a shorter step. Linear systems with `1 - h A_ii f_x` are solved
/// without pivoting: if the step is so long that a leading minor nearly vanishes, the derivatives lose
/// digits.
#[derive(Clone, Debug)]
pub struct RungeKutta<S, D, T> {
    model: D,
    stages: Vec<Stage<S>>,
    newton: Newton<S>,
    outcome: Outcome<S>,
    hessians: StageHessians<S>,
    tableau: PhantomData<T>,
}

impl<S: Scalar, D: Dynamics<S>, T: Tableau> RungeKutta<S, D, T> {
    /// Builds the workspace. Later calls do not allocate.
    ///
    /// # Panics
    /// If the scheme is partitioned and the state has odd length, or if the tableau violates [`Tableau`].
    pub fn new(model: D) -> Self {
        let (states, controls) = (model.states(), model.controls());
        let partitioned = T::A.iter().copied().flatten().chain(T::B).any(|[upper, lower]| upper != lower);
        assert!(
            !partitioned || states.is_multiple_of(2),
            "the scheme needs two halves of the state: {states} states are odd"
        );
        assert!(
            !T::B.is_empty() && T::A.len() == T::B.len(),
            "a scheme has stages, each with a row of A and a B"
        );
        for (i, row) in T::A.iter().enumerate() {
            assert!(row.len() == i + 1, "row {i} of A needs the entries j = 0 to {i}");
            let [upper, lower] = row[i];
            assert!(
                upper == lower || upper * lower == 0.0,
                "on the diagonal of A, what is not zero is the same"
            );
        }
        Self {
            stages: T::A.iter().map(|row| Stage::new(states, controls, row)).collect(),
            newton: Newton::new(states),
            outcome: Outcome::new(states, controls),
            hessians: StageHessians::new(states, controls),
            model,
            tableau: PhantomData,
        }
    }

    /// The model.
    pub fn model(&self) -> &D {
        &self.model
    }

    /// The model, to change its parameters (not its sizes).
    pub fn model_mut(&mut self) -> &mut D {
        &mut self.model
    }

    /// Number of Newton iterations of the last step, summed over all stages; 0 for explicit schemes.
    pub fn iterations(&self) -> usize {
        self.newton.iterations
    }

    fn sizes(&self) -> [usize; 2] {
        [self.model.states(), self.model.controls()]
    }

    /// X_i.
    fn place(&mut self, i: usize, x: &[S], u: &[S], h: S) -> Result<(), StepError<D::Error>> {
        let (before, rest) = self.stages.split_at_mut(i);
        let stage = &mut rest[0];
        sum(&mut stage.x, x, h, coefficients(T::A[i], before));
        if stage.implicit.is_none() {
            return Ok(());
        }
        let slope = match before.last() {
            Some(previous) => &previous.f,
            None => self.model.evaluate(x, u)?,
        };
        self.newton.slope.copy_from_slice(slope);
        self.newton.solve(&mut self.model, stage, u, h)
    }

    /// Phi, once all slopes are known.
    fn arrive(&mut self, x: &[S], h: S) {
        sum(&mut self.outcome.next, x, h, coefficients(T::B, &self.stages));
    }

    /// X_i, f(X_i, u) and their derivatives.
    fn linearise_stage(&mut self, i: usize, x: &[S], u: &[S], h: S) -> Result<(), StepError<D::Error>> {
        self.place(i, x, u, h)?;
        let (before, rest) = self.stages.split_at_mut(i);
        rest[0].take(&self.model.linearise(&rest[0].x, u)?);
        rest[0].differentiate(h, coefficients(T::A[i], before));
        Ok(())
    }

    /// Phi and its Jacobians, once all stages are linearised.
    fn arrive_with_derivatives(&mut self, x: &[S], h: S) {
        self.arrive(x, h);
        differentiate_sum(&mut self.outcome.phi_z, h, coefficients(T::B, &self.stages));
    }
}

/// Stages with their coefficients.
fn coefficients<'a, S>(
    pairs: &'a [Pair],
    stages: &'a [Stage<S>],
) -> impl Iterator<Item = (Pair, &'a Stage<S>)> + Clone {
    pairs.iter().copied().zip(stages)
}

impl<S: Scalar, D: Dynamics<S>, T: Tableau> Step<S> for RungeKutta<S, D, T> {
    type Error = StepError<D::Error>;

    fn states(&self) -> usize {
        self.model.states()
    }

    fn controls(&self) -> usize {
        self.model.controls()
    }

    fn evaluate(&mut self, x: &[S], u: &[S], h: S) -> Result<&[S], Self::Error> {
        check(self.sizes(), [x, u], h, None)?;
        self.newton.iterations = 0;
        for i in 0..T::A.len() {
            self.place(i, x, u, h)?;
            let stage = &mut self.stages[i];
            stage.f.copy_from_slice(self.model.evaluate(&stage.x, u)?);
        }
        self.arrive(x, h);
        Ok(&self.outcome.next)
    }

    fn linearise(&mut self, x: &[S], u: &[S], h: S) -> Result<StepLinearisation<'_, S>, Self::Error> {
        check(self.sizes(), [x, u], h, None)?;
        self.newton.iterations = 0;
        for i in 0..T::A.len() {
            self.linearise_stage(i, x, u, h)?;
        }
        self.arrive_with_derivatives(x, h);
        Ok(self.outcome.first())
    }

    fn contract(&mut self, x: &[S], u: &[S], h: S, y: &[S]) -> Result<StepContraction<'_, S>, Self::Error> {
        check(self.sizes(), [x, u], h, Some(y))?;
        self.newton.iterations = 0;
        self.hessians.clear();
        let last = T::A.len() - 1;
        let last_is_explicit = self.stages[last].implicit.is_none();
        for i in 0..last {
            self.linearise_stage(i, x, u, h)?;
        }
        if last_is_explicit {
            self.place(last, x, u, h)?;
        } else {
            self.linearise_stage(last, x, u, h)?;
        }
        for i in (0..=last).rev() {
            let (rest, after) = self.stages.split_at_mut(i + 1);
            let (before, stage) = rest.split_at_mut(i);
            let stage = &mut stage[0];
            let column = (i + 1..).zip(after).map(|(j, stage)| (T::A[j][i], &*stage));
            stage.set_costate(h, (T::B[i], y), column);
            let second = self.model.contract(&stage.x, u, &stage.mu)?;
            if i == last && last_is_explicit {
                stage.take(&second.first);
                stage.differentiate(h, coefficients(T::A[i], before));
            }
            stage.turn_back();
            self.hessians.add(&second, (!stage.is_start).then_some(&stage.x_z));
        }
        self.arrive_with_derivatives(x, h);
        let [xx, ux, uu] = self.hessians.blocks();
        Ok(StepContraction { first: self.outcome.first(), xx, ux: Some(ux), uu: Some(uu) })
    }
}
