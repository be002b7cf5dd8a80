//! The named Runge-Kutta schemes.

use super::{Classical, Midpoint, RungeKutta, Verlet};

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
/// Second order, symmetric, symplectic for Hamiltonian F; each implicit equation has the length of one half
/// of the state. Source: Hairer, Lubich, Wanner, VI.3, (3.4).
pub type StoermerVerlet<S, D> = RungeKutta<S, D, Verlet>;
