//! Coefficients of Runge-Kutta schemes.

/// The coefficients for the first and for the second half of the state.
///
/// In a scheme that is not partitioned they are equal.
pub type Pair = [f64; 2];

/// A Runge-Kutta scheme whose stages can be solved one after the other.
///
/// ```text
/// X_i = x + h sum_(j <= i) A_ij f(X_j, u)      Phi = x + h sum_i B_i f(X_i, u)
/// ```
///
/// Every coefficient is a [`Pair`]: partitioned schemes have one for q and one for p. If A_ii is not zero,
/// the stage is implicit in the half where it is not zero. Source: E. Hairer, C. Lubich, G. Wanner,
/// "Geometric Numerical Integration", Springer 2006, II.1 and II.2.
///
/// ```
/// use costate::lagrangian::LagrangianSecondOrder;
/// use costate::robot::Robot;
/// use costate::step::{Pair, RungeKutta, Step, Tableau};
///
/// /// Heun's scheme of second order.
/// struct Heun;
/// impl Tableau for Heun {
///     const A: &'static [&'static [Pair]] = &[&[[0.0; 2]], &[[1.0; 2], [0.0; 2]]];
///     const B: &'static [Pair] = &[[0.5; 2], [0.5; 2]];
/// }
///
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let mut heun = RungeKutta::<f64, _, Heun>::new(LagrangianSecondOrder::new(&robot));
/// let step = heun.linearise(&[0.3, -0.8, 1.0, 0.5], &[0.2, 0.0], 0.01)?;
/// println!("Phi_x = {}", step.phi_x.as_nalgebra());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Tableau: 'static {
    /// Row i: A_ij for j = 0 to i. The nonzero entries of a diagonal pair are equal.
    const A: &'static [&'static [Pair]];
    /// B_i.
    const B: &'static [Pair];
}

/// The same coefficient in both halves.
const fn both(coefficient: f64) -> Pair {
    [coefficient; 2]
}

/// Coefficients of [`RungeKutta4`](super::RungeKutta4).
#[derive(Clone, Copy, Debug)]
pub struct Classical;

impl Tableau for Classical {
    const A: &'static [&'static [Pair]] = &[
        &[both(0.0)],
        &[both(0.5), both(0.0)],
        &[both(0.0), both(0.5), both(0.0)],
        &[both(0.0), both(0.0), both(1.0), both(0.0)],
    ];
    const B: &'static [Pair] = &[both(1.0 / 6.0), both(1.0 / 3.0), both(1.0 / 3.0), both(1.0 / 6.0)];
}

/// Coefficients of [`ImplicitMidpoint`](super::ImplicitMidpoint).
#[derive(Clone, Copy, Debug)]
pub struct Midpoint;

impl Tableau for Midpoint {
    const A: &'static [&'static [Pair]] = &[&[both(0.5)]];
    const B: &'static [Pair] = &[both(1.0)];
}

/// Coefficients of [`StoermerVerlet`](super::StoermerVerlet): stages (q, p½) and (q+, p½).
#[derive(Clone, Copy, Debug)]
pub struct Verlet;

impl Tableau for Verlet {
    const A: &'static [&'static [Pair]] = &[&[[0.0, 0.5]], &[both(0.5), [0.5, 0.0]]];
    const B: &'static [Pair] = &[both(0.5), both(0.5)];
}
