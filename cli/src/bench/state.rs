//! The state at which methods are timed.

use costate::configuration::ConfigurationSpace;
use costate::hamiltonian::Hamiltonian;
use costate::robot::Robot;

/// Why a candidate failed.
pub type Failure = Box<dyn std::error::Error>;

/// The state at which everything is evaluated.
pub struct State {
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    pub u: Vec<f64>,
    /// (q, p).
    pub x: Vec<f64>,
    /// What automatic differentiation takes: x, or with quaternions (0, p), the direction from q being 0.
    pub z: Vec<f64>,
    pub y: Vec<f64>,
    pub d: Vec<f64>,
}

impl State {
    /// Uniformly random: q within +-pi, of floating and spherical joints that far from the neutral
    /// configuration; v, u, y and d within +-1.
    pub fn random(robot: &Robot, seed: u64) -> Result<Self, Failure> {
        let n = robot.dof();
        let mut random = fastrand::Rng::with_seed(seed);
        let mut numbers = |count: usize, most: f64| -> Vec<f64> {
            (0..count).map(|_| most * (2.0 * random.f64() - 1.0)).collect()
        };
        let from_neutral = numbers(n, std::f64::consts::PI);
        let [v, u, y, d] = [n, n, 2 * n, 2 * n].map(|count| numbers(count, 1.0));
        let space = ConfigurationSpace::new(robot);
        let mut q = vec![0.0; space.nq()];
        space.integrate(&space.neutral(), &from_neutral, &mut q)?;
        let p = Hamiltonian::<f64>::new(robot).momentum(&q, &v)?.to_vec();
        let direction = if robot.free_joints().is_empty() { q.clone() } else { vec![0.0; n] };
        let [x, z] = [q.clone(), direction].map(|first| [first, p.clone()].concat());
        Ok(Self { q, v, u, x, z, y, d })
    }
}
