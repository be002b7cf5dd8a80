//! Coefficients of the schemes.

use super::RungeKutta;

/// A coefficient for the first and one for the second half of the state.
///
/// A scheme that does not tell them apart has the same twice.
pub type Pair = [f64; 2];

/// A Runge-Kutta scheme whose stages can be found one after the other.
///
/// ```text
/// X_i = x + h sum_(j <= i) A_ij f(X_j, u)      Phi = x + h sum_i B_i f(X_i, u)
/// ```
///
/// Every coefficient is a [`Pair`]: partitioned schemes take one for q and one for p. Where A_ii is not zero the stage
/// is implicit, in the half it is not zero in. Source: E. Hairer, C. Lubich, G. Wanner, "Geometric Numerical
/// Integration", Springer 2006, II.1 and II.2.
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
    /// Row i: A_ij for j = 0 to i. In one pair of the diagonal all that is not zero is the same.
    const A: &'static [&'static [Pair]];
    /// B_i.
    const B: &'static [Pair];
}

/// The same in both halves.
const fn both(coefficient: f64) -> Pair {
    [coefficient; 2]
}

/// Coefficients of [`RungeKutta4`].
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

/// Coefficients of [`ImplicitMidpoint`].
#[derive(Clone, Copy, Debug)]
pub struct Midpoint;

impl Tableau for Midpoint {
    const A: &'static [&'static [Pair]] = &[&[both(0.5)]];
    const B: &'static [Pair] = &[both(1.0)];
}

/// Coefficients of [`StoermerVerlet`]: stages (q, p½) and (q+, p½).
#[derive(Clone, Copy, Debug)]
pub struct Verlet;

impl Tableau for Verlet {
    const A: &'static [&'static [Pair]] = &[&[[0.0, 0.5]], &[both(0.5), [0.5, 0.0]]];
    const B: &'static [Pair] = &[both(0.5), both(0.5)];
}

/// The classical explicit scheme of fourth order: four evaluations of f.
///
/// ```
/// use costate::hamiltonian::HamiltonianSecondOrder;
/// use costate::robot::Robot;
/// use costate::step::{RungeKutta4, Step};
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let mut step = RungeKutta4::new(HamiltonianSecondOrder::<f64>::new(&robot));
/// let second = step.contract(&[0.3, -0.8, 1.0, 0.5], &[0.2, 0.0], 0.01, &[1.0, 0.0, 0.0, 0.0])?;
/// println!("x_next = {:?}, y'Phi_xx = {}", second.first.next, second.xx.as_nalgebra());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub type RungeKutta4<S, D> = RungeKutta<S, D, Classical>;

/// `x+ = x + h f((x + x+)/2, u)`: implicit, second order, symmetric, symplectic for Hamiltonian f.
///
/// Solved for the midpoint `X = x + h/2 f(X, u)`; then `x+ = x + h f(X, u)`.
pub type ImplicitMidpoint<S, D> = RungeKutta<S, D, Midpoint>;

/// The generalised leapfrog scheme in x = (q, p), for a Hamiltonian that need not be separable:
///
/// ```text
/// p½ = p  + h/2  F^p(q, p½, u)                        implicit in p½
/// q+ = q  + h/2 (F^q(q, p½, u) + F^q(q+, p½, u))      implicit in q+
/// p+ = p½ + h/2  F^p(q+, p½, u)
/// ```
///
/// Second order, symmetric, symplectic for Hamiltonian F; each implicit equation is one half of the state long. Source:
/// Hairer, Lubich, Wanner, VI.3, (3.4).
pub type StoermerVerlet<S, D> = RungeKutta<S, D, Verlet>;
