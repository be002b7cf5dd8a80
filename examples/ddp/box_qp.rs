//! A small quadratic program with bounds, solved at each stage of the backward sweep.
//!
//! `min 1/2 d'H d + g'd  subject to  lower <= d <= upper`, by projected Newton steps: components at an active
//! bound are held, the others take the Newton step of the free block of H, projected to the box. Only the
//! free block must be positive definite; a held component may have any curvature.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Maximum number of iterations; two or three are usual.
const MAX_STEPS: usize = 60;
/// Required fraction of the predicted decrease.
const ARMIJO: f64 = 0.1;
/// Smallest step length of the line search.
const SHORTEST: f64 = 1e-10;

/// The minimum of one program.
pub struct Minimum {
    /// The minimiser.
    pub d: DVector<f64>,
    /// The free components: those not at an active bound.
    pub free: Vec<usize>,
    /// Cholesky factor of the free block of H; `None` if nothing is free.
    factor: Option<Cholesky<f64, Dyn>>,
}

impl Minimum {
    /// `K = dd/dx` for a gradient `g + G x`: `-H_ff^-1 G_f` in the free rows, 0 in the held ones.
    pub fn gain(&self, g_x: &DMatrix<f64>) -> DMatrix<f64> {
        let mut gain = DMatrix::zeros(g_x.nrows(), g_x.ncols());
        if let Some(factor) = &self.factor {
            let free = factor.solve(&g_x.select_rows(&self.free));
            for (row, &i) in self.free.iter().enumerate() {
                gain.row_mut(i).copy_from(&-free.row(row));
            }
        }
        gain
    }
}

/// The free block of H is not positive definite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Indefinite;

/// Solves the program, starting from d = 0, which must be in the box.
///
/// # Errors
/// A free block of H that is not positive definite.
pub fn minimise(
    h: &DMatrix<f64>,
    g: &DVector<f64>,
    [lower, upper]: [&DVector<f64>; 2],
) -> Result<Minimum, Indefinite> {
    let mut d = DVector::zeros(g.len());
    let mut solved_for: Option<Vec<usize>> = None;
    for _ in 0..MAX_STEPS {
        let gradient = g + h * &d;
        let held = |i: usize| pushed_against(gradient[i], d[i], [lower[i], upper[i]]);
        let free: Vec<usize> = (0..g.len()).filter(|&i| !held(i)).collect();
        if free.is_empty() {
            return Ok(Minimum { d, free, factor: None });
        }
        let factor = h.select_rows(&free).select_columns(&free).cholesky().ok_or(Indefinite)?;
        if solved_for.as_ref() == Some(&free) {
            return Ok(Minimum { d, free, factor: Some(factor) });
        }
        let newton = factor.solve(&gradient.select_rows(&free));
        let whole;
        (d, whole) = projected_step(h, &gradient, d, &free, &newton, [lower, upper]);
        // A full step inside the box solves the program on its free set; done if the free set is unchanged.
        solved_for = whole.then_some(free);
    }
    Err(Indefinite)
}

/// Whether the bound of a component is active.
pub fn pushed_against(gradient: f64, value: f64, [lower, upper]: [f64; 2]) -> bool {
    (value <= lower && gradient > 0.0) || (value >= upper && gradient < 0.0)
}

/// The longest of the steps 1, 1/2, ... against `newton`, cut back to the box, that decreases the programme
/// enough.
///
/// Also returned: whether it is the whole step, not cut anywhere.
fn projected_step(
    h: &DMatrix<f64>,
    gradient: &DVector<f64>,
    d: DVector<f64>,
    free: &[usize],
    newton: &DVector<f64>,
    [lower, upper]: [&DVector<f64>; 2],
) -> (DVector<f64>, bool) {
    let mut length = 1.0;
    loop {
        let (mut trial, mut cut) = (d.clone(), false);
        for (&i, &newton) in free.iter().zip(newton) {
            let wanted = d[i] - length * newton;
            trial[i] = wanted.clamp(lower[i], upper[i]);
            cut |= trial[i] != wanted;
        }
        let step = &trial - &d;
        let (slope, curvature) = (gradient.dot(&step), step.dot(&(h * &step)));
        if slope + 0.5 * curvature <= ARMIJO * slope || length < SHORTEST {
            return (trial, length == 1.0 && !cut);
        }
        length *= 0.5;
    }
}
