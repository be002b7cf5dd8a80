//! RABBIT on one foot by its own equations of motion, as a judge of gaits. Nothing of the library is in it.
//!
//! Coordinates are the angles a_i of the links from the vertical (rad), positive ahead: of the torso, of
//! femur and tibia of the leg that swings, and of those of the leg that stands. The centre of mass of link b
//! is `sum_j c_bj (sin a_j, cos a_j)` from the foot that stands, so that
//!
//! ```text
//! K_ij = sum_b m_b c_bi c_bj + I_i delta_ij        G_i = sum_b m_b c_bi
//! Q_i = sum_j K_ij (cos(a_i - a_j) a_j'' + sin(a_i - a_j) a_j'^2) - g G_i sin a_i
//! ```
//!
//! Q_i is the torque on link i (N m): of the motors of hip and knee of both legs, and of the ground, whose
//! point contact gives none.

use nalgebra::{SMatrix, SVector};

pub(crate) const LINKS: usize = 5;
/// Positions, rates, accelerations or torques of the links.
pub(crate) type Links = SVector<f64, LINKS>;
type Square = SMatrix<f64, LINKS, LINKS>;
/// Of hip and knee of the leg that swings, then of the one that stands (N m).
pub(crate) type Torques = [f64; 4];

/// robots/rabbit.toml: masses (kg) and moments of inertia (kg m^2) of the links, lengths of femur and tibia
/// and distances of centres of mass from the hips or the knee (m).
const MASSES: [f64; LINKS] = [20.0, 6.8, 3.2, 6.8, 3.2];
const INERTIAS: [f64; LINKS] = [2.22, 1.08, 0.93, 1.08, 0.93];
const LENGTH: f64 = 0.4;
const TORSO: f64 = 0.2;
const FEMUR: f64 = 0.163;
const TIBIA: f64 = 0.128;
const MASS: f64 = 40.0;
const GRAVITY: f64 = 9.81;
/// The links after the legs have changed their roles.
pub(crate) const EXCHANGED: [usize; LINKS] = [0, 3, 4, 1, 2];

/// The hips from the foot that stands and from the one that swings, as multiples of (sin a_j, cos a_j).
const FROM_STANCE: Links = Links::new(0.0, 0.0, 0.0, LENGTH, LENGTH);
const FROM_SWING: Links = Links::new(0.0, LENGTH, LENGTH, 0.0, 0.0);

/// The centres of mass from where the hips are counted from.
fn centres(hips: Links) -> [Links; LINKS] {
    let legs = [(1, 2), (3, 4)].map(|(femur, tibia)| {
        let along = |link: usize, part: f64| {
            let mut c = Links::zeros();
            c[link] = -part;
            c
        };
        [along(femur, FEMUR), along(femur, LENGTH) + along(tibia, TIBIA)]
    });
    let torso = Links::new(TORSO, 0.0, 0.0, 0.0, 0.0);
    [torso, legs[0][0], legs[0][1], legs[1][0], legs[1][1]].map(|c| hips + c)
}

/// K with one factor from each list.
fn products(left: [Links; LINKS], right: [Links; LINKS]) -> Square {
    let bodies = (0..LINKS).map(|b| MASSES[b] * left[b] * right[b].transpose());
    bodies.fold(Square::from_diagonal(&Links::from(INERTIAS)), |sum, one| sum + one)
}

/// G.
fn sums(centres: [Links; LINKS]) -> Links {
    (0..LINKS).map(|b| MASSES[b] * centres[b]).sum()
}

/// Angles of the links, or their rates, of the joints of RABBIT: x and z of the hips, torso, left hip and
/// knee, right hip and knee. The right foot stands.
pub(crate) fn links(joints: &[f64]) -> Links {
    let [torso, left, right] = [joints[2], joints[3], joints[5]];
    Links::new(torso, torso + left, torso + left + joints[4], torso + right, torso + right + joints[6])
}

/// A sum of multiples of (sin a_j, cos a_j): place (x, z), velocity or acceleration.
fn place(c: &Links, a: &Links) -> [f64; 2] {
    [c.dot(&a.map(f64::sin)), c.dot(&a.map(f64::cos))]
}

fn velocity(c: &Links, a: &Links, w: &Links) -> [f64; 2] {
    let c = c.component_mul(w);
    [c.dot(&a.map(f64::cos)), -c.dot(&a.map(f64::sin))]
}

fn acceleration(c: &Links, [a, w, acc]: [&Links; 3]) -> [f64; 2] {
    let ([x, z], [inward, down]) = (velocity(c, a, acc), place(&c.component_mul(w).component_mul(w), a));
    [x - inward, z - down]
}

/// The robot, with the constants of its equations.
pub(crate) struct OneFoot {
    k: Square,
    g: Links,
}

impl OneFoot {
    pub fn new() -> Self {
        let centres = centres(FROM_STANCE);
        Self { k: products(centres, centres), g: sums(centres) }
    }

    fn mass(&self, a: &Links) -> Square {
        Square::from_fn(|i, j| self.k[(i, j)] * (a[i] - a[j]).cos())
    }

    /// Q less what belongs to accelerations.
    fn bias(&self, a: &Links, w: &Links) -> Links {
        let rates = Square::from_fn(|i, j| self.k[(i, j)] * (a[i] - a[j]).sin()) * w.component_mul(w);
        rates - GRAVITY * self.g.component_mul(&a.map(f64::sin))
    }

    /// The torques of the motors for a motion, and what the ground would have to give (N m) for it.
    pub fn torques(&self, [a, w, acc]: [&Links; 3]) -> (Torques, f64) {
        let q = self.mass(a) * acc + self.bias(a, w);
        let [hip, knee] = [q[1] + q[2], q[2]];
        let other_hip = -q[0] - hip;
        let other_knee = other_hip - q[3];
        ([hip, knee, other_hip, other_knee], q[4] - other_knee)
    }

    /// Accelerations with these torques, and none of the ground.
    pub fn accelerations(&self, a: &Links, w: &Links, [hip, knee, other_hip, other_knee]: Torques) -> Links {
        let q = [-hip - other_hip, hip - knee, knee, other_hip - other_knee, other_knee];
        self.solved(a, Links::from(q) - self.bias(a, w))
    }

    /// Rates after an impulse of the ground of 1 N m s, of which there is none.
    pub fn turned(&self, a: &Links) -> Links {
        self.solved(a, Links::new(0.0, 0.0, 0.0, 0.0, 1.0))
    }

    fn solved(&self, a: &Links, right: Links) -> Links {
        self.mass(a).cholesky().unwrap().solve(&right)
    }

    /// x and z of the force of the ground (N).
    pub fn ground(&self, motion: [&Links; 3]) -> [f64; 2] {
        let [x, z] = acceleration(&self.g, motion);
        [x, z + MASS * GRAVITY]
    }

    /// Kinetic and potential energy (J).
    pub fn energy(&self, a: &Links, w: &Links) -> f64 {
        0.5 * w.dot(&(self.mass(a) * w)) + GRAVITY * self.g.dot(&a.map(f64::cos))
    }

    /// Rates after the foot that swings has landed and the other one has let go, and x and z of the impulse
    /// (N s): nothing but this impulse changes momenta.
    pub fn landed(&self, a: &Links, w: &Links) -> (Links, [f64; 2]) {
        let (before, after) = (centres(FROM_STANCE), centres(FROM_SWING));
        let with_cos = |k: Square| Square::from_fn(|i, j| k[(i, j)] * (a[i] - a[j]).cos());
        let momenta = with_cos(products(after, before)) * w;
        let rates = with_cos(products(after, after)).cholesky().unwrap().solve(&momenta);
        let [from, to] = [velocity(&self.g, a, w), velocity(&sums(after), a, &rates)];
        (rates, [to[0] - from[0], to[1] - from[1]])
    }
}

/// x and z of the foot that swings (m).
pub(crate) fn swing_foot(a: &Links) -> [f64; 2] {
    place(&(FROM_STANCE - FROM_SWING), a)
}

/// The joints of RABBIT from the angles of the links, the right foot at the origin: q, v, a.
pub(crate) fn joints([a, w, acc]: [&Links; 3]) -> [[f64; 7]; 3] {
    let with = |[x, z]: [f64; 2], a: &Links| [x, z, a[0], a[1] - a[0], a[2] - a[1], a[3] - a[0], a[4] - a[3]];
    let hips =
        [place(&FROM_STANCE, a), velocity(&FROM_STANCE, a, w), acceleration(&FROM_STANCE, [a, w, acc])];
    [with(hips[0], a), with(hips[1], w), with(hips[2], acc)]
}
