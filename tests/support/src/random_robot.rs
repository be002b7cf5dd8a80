//! Random robots and states for property tests.

use costate::derivative::largest;
use costate::hamiltonian::Hamiltonian;
use costate::robot::{Friction, JointSpec, LinkInertia, Placement, Robot, Spring};
use nalgebra::{DMatrix, Matrix3, Vector3};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// Everything that one joint is made of.
#[derive(Clone, Debug)]
pub struct Part {
    pub prismatic: bool,
    pub parent: usize,
    pub rpy: [f64; 3],
    pub xyz: [f64; 3],
    pub axis: [f64; 3],
    pub mass: f64,
    pub com: [f64; 3],
    pub radii: [f64; 3],
    pub massless: bool,
    pub armature: f64,
    pub spring: [f64; 2],
    pub friction: [f64; 3],
    /// The joint that it mimics, with ratio and offset, unless none can be found; see [`Case::mimicked`].
    pub mimic: Option<(usize, f64, f64)>,
}

/// A robot and a state; printed whole where a property fails.
#[derive(Clone, Debug)]
pub struct Case {
    pub parts: Vec<Part>,
    /// Factor of a full armature matrix `B B'`; empty for none.
    pub coupling: Vec<f64>,
    pub gravity: [f64; 3],
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    pub u: Vec<f64>,
    pub y: Vec<f64>,
}

fn numbers(range: f64) -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-range..range)
}

/// General directions, and the special ones that real robots are made of.
fn axes() -> impl Strategy<Value = [f64; 3]> {
    let special = prop::sample::select(vec![
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
        [1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 1.0, 0.0],
    ]);
    let general = numbers(1.0).prop_filter("an axis has a direction", |a| Vector3::from(*a).norm() > 0.1);
    prop_oneof![special, general]
}

/// General rotations, and quarter turns: parallel and orthogonal axes.
fn angles() -> impl Strategy<Value = [f64; 3]> {
    let special = prop::array::uniform3(prop::sample::select(vec![0.0, 0.0, FRAC_PI_2, -FRAC_PI_2, PI]));
    prop_oneof![special, numbers(PI)]
}

/// General offsets, and none: intersecting axes.
fn offsets() -> impl Strategy<Value = [f64; 3]> {
    prop_oneof![Just([0.0; 3]), Just([0.4, 0.0, 0.0]), numbers(0.6)]
}

fn part() -> impl Strategy<Value = Part> {
    let joint = (any::<bool>(), 0..1000_usize, angles(), offsets(), axes());
    let link = (0.2..4.0, numbers(0.3), prop::array::uniform3(0.1..0.4), prop::bool::weighted(0.15));
    let extras = (
        prop_oneof![Just(0.0), 0.0..1.0],
        prop_oneof![Just([0.0, 0.0]), (1.0..20.0, -1.0..1.0).prop_map(|(k, r)| [k, r])],
        prop_oneof![Just([0.0, 0.0, 0.1]), (0.0..2.0, 0.0..2.0, 0.2..1.0).prop_map(|(b, c, s)| [b, c, s])],
    );
    (joint, link, extras).prop_map(|(joint, link, extras)| {
        let (prismatic, parent, rpy, xyz, axis) = joint;
        let (mass, com, radii, massless) = link;
        let (armature, spring, friction) = extras;
        let mimic = None;
        Part {
            prismatic,
            parent,
            rpy,
            xyz,
            axis,
            mass,
            com,
            radii,
            massless,
            armature,
            spring,
            friction,
            mimic,
        }
    })
}

/// Joints, of which in every fourth robot some mimic others: by any ratio, with and without an offset.
fn parts(count: usize) -> impl Strategy<Value = Vec<Part>> {
    let ratio = prop_oneof![Just(1.0), Just(-1.0), 0.3..2.0, -2.0..-0.3];
    let mimic = (0..1000_usize, ratio, prop_oneof![Just(0.0), -1.0..1.0]);
    let mimics = prop::collection::vec(prop::option::weighted(0.4, mimic), count);
    let mimics = prop_oneof![3 => Just(vec![None; count]), 1 => mimics];
    (prop::collection::vec(part(), count), mimics).prop_map(|(mut parts, mimics)| {
        parts.iter_mut().zip(mimics).for_each(|(part, mimic)| part.mimic = mimic);
        parts
    })
}

/// Robots of 1 to `most` joints, and states, with a mass matrix that can be inverted in double precision.
pub fn cases(most: usize) -> impl Strategy<Value = Case> {
    all_cases(most).prop_filter("M is regular", |case| {
        let condition = condition(&case.robot(), &case.q);
        0.0 < condition && condition < 1e9
    })
}

/// Robots of 1 to `most` joints, and states; q = 0 and v = 0 among them. Joints may be redundant.
pub fn all_cases(most: usize) -> impl Strategy<Value = Case> {
    (1..=most).prop_flat_map(parts).prop_flat_map(|parts| {
        let (n, all) = (independent(&parts), parts.len());
        let vector = move |range: f64| prop::collection::vec(-range..range, n);
        let zero = Just(vec![0.0; n]);
        (
            Just(parts),
            prop_oneof![3 => Just(Vec::new()), 1 => prop::collection::vec(-0.5..0.5, all * all)],
            prop_oneof![Just([0.0, 0.0, -9.81]), Just([0.0; 3]), numbers(9.81)],
            prop_oneof![4 => vector(PI).boxed(), 1 => zero.clone().boxed()],
            prop_oneof![4 => vector(2.0).boxed(), 1 => zero.boxed()],
            vector(3.0),
            prop::collection::vec(-1.0..1.0, 2 * n),
        )
            .prop_map(|(parts, coupling, gravity, q, v, u, y)| Case {
                parts,
                coupling,
                gravity,
                q,
                v,
                u,
                y,
            })
    })
}

/// Number of joints that mimic none.
fn independent(parts: &[Part]) -> usize {
    (0..parts.len()).filter(|&i| mimicked(parts, i).is_none()).count()
}

/// See [`Case::mimicked`].
fn mimicked(parts: &[Part], i: usize) -> Option<usize> {
    let (choice, ..) = parts[i].mimic?;
    let later: Vec<usize> = (i + 1..parts.len()).filter(|&k| parts[k].mimic.is_none()).collect();
    match (choice % 2, i) {
        (1, _) | (_, 0) if !later.is_empty() => Some(later[choice / 2 % later.len()]),
        (_, 0) => None,
        _ => Some(choice / 2 % i),
    }
}

impl Case {
    /// Number of degrees of freedom.
    pub fn n(&self) -> usize {
        independent(&self.parts)
    }

    /// The joint that joint `i` mimics: one before it, which may mimic another one itself, or an independent
    /// one after it.
    pub fn mimicked(&self, i: usize) -> Option<usize> {
        mimicked(&self.parts, i)
    }

    /// Parent of joint `i`: one of those before it, or the world; chains are as likely as branches.
    pub fn parent(&self, i: usize) -> Option<usize> {
        let choice = self.parts[i].parent;
        if choice.is_multiple_of(2) { i.checked_sub(1) } else { (choice % (i + 1)).checked_sub(1) }
    }

    /// The same with every joint independent, where it was; u and y are repeated.
    pub fn all_independent(&self) -> Self {
        let robot = self.robot();
        let rates = robot.joints().iter().map(|joint| joint.mimic);
        let indices = robot.independent_indices();
        let of = |joint: usize, x: &[f64]| indices.iter().position(|&i| i == joint).map_or(0.0, |k| x[k]);
        let v = rates.enumerate().map(|(i, mimic)| match mimic {
            Some(mimic) => mimic.ratio * of(mimic.joint, &self.v),
            None => of(i, &self.v),
        });
        let repeated = |x: &[f64], count: usize| x.iter().cycle().take(count).copied().collect();
        let all = self.parts.len();
        Self {
            q: robot.joint_positions(&self.q).unwrap(),
            v: v.collect(),
            u: repeated(&self.u, all),
            y: repeated(&self.y, 2 * all),
            parts: self.parts.iter().map(|part| Part { mimic: None, ..part.clone() }).collect(),
            ..self.clone()
        }
    }

    pub fn specs(&self) -> Vec<JointSpec> {
        let name = |i: usize| format!("j{i}");
        let spec = |(i, part): (usize, &Part)| {
            let [viscous, coulomb, coulomb_velocity] = part.friction;
            let massless = part.massless && i + 1 < self.parts.len() && self.parent(i + 1) == Some(i);
            let mut spec =
                if part.prismatic { JointSpec::prismatic(name(i)) } else { JointSpec::revolute(name(i)) }
                    .placed(Placement::from_xyz_rpy(part.xyz, part.rpy))
                    .axis(part.axis)
                    .armature(part.armature)
                    .spring(Spring { stiffness: part.spring[0], rest: part.spring[1] })
                    .friction(Friction { viscous, coulomb, coulomb_velocity });
            if !massless {
                spec = spec.carrying(self.link(part));
            }
            if let (Some(joint), Some((_, ratio, offset))) = (self.mimicked(i), part.mimic) {
                spec = spec.mimicking(name(joint), ratio, offset);
            }
            match self.parent(i) {
                Some(parent) => spec.on(name(parent)),
                None => spec,
            }
        };
        self.parts.iter().enumerate().map(spec).collect()
    }

    /// A homogeneous ellipsoid-like body: principal moments that obey the triangle inequality, turned.
    fn link(&self, part: &Part) -> LinkInertia {
        let [a, b, c] = part.radii.map(|r| r * r);
        let turn = Placement::from_xyz_rpy([0.0; 3], part.rpy.map(|angle| 0.7 * angle + 0.2)).rotation;
        let principal = Matrix3::from_diagonal(&Vector3::new(b + c, a + c, a + b)) * part.mass;
        LinkInertia::about_com(part.mass, part.com, turn * principal * turn.transpose())
    }

    pub fn robot(&self) -> Robot {
        let builder = Robot::builder("random").gravity(self.gravity);
        let builder = self.specs().into_iter().fold(builder, |builder, spec| builder.joint(spec));
        if self.coupling.is_empty() {
            return builder.build().unwrap();
        }
        let joints = self.parts.len();
        let factor = DMatrix::from_row_slice(joints, joints, &self.coupling);
        builder.armature_matrix(&factor * factor.transpose()).build().unwrap()
    }

    /// Conjugate momentum p = M v.
    pub fn p(&self, robot: &Robot) -> Vec<f64> {
        Hamiltonian::<f64>::new(robot).momentum(&self.q, &self.v).unwrap().to_vec()
    }

    pub fn x(&self, robot: &Robot) -> Vec<f64> {
        [self.q.clone(), self.p(robot)].concat()
    }
}

/// Condition number of the mass matrix.
pub fn condition(robot: &Robot, q: &[f64]) -> f64 {
    let mass_matrix = Hamiltonian::<f64>::new(robot).mass_matrix(q).unwrap().view().to_nalgebra();
    let values = nalgebra::SymmetricEigen::new(mass_matrix).eigenvalues;
    values.max() / values.min()
}

/// `1e-12 max(1, cond(M) / 1000)`: what two routes may differ by in double precision.
pub fn tolerance(robot: &Robot, q: &[f64]) -> f64 {
    1e-12 * (condition(robot, q) / 1000.0).max(1.0)
}

/// `max |a - b| / max |b|`; the entries of a quantity are judged together.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    let worst = largest(&differences);
    if worst == 0.0 { 0.0 } else { worst / largest(b) }
}

/// The same, relative to this size at least: where `b` vanishes up to rounding.
pub fn difference_at(size: f64, a: &[f64], b: &[f64]) -> f64 {
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    largest(&differences) / largest(b).max(size)
}
