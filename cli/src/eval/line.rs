//! One input line, one output line.

use super::keys::{Fields, parse};
use super::request::Request;
use crate::report::counted;
use costate::Coordinates;
use costate::configuration::Quaternions;
use costate::matrix::Block;
use costate::robot::{Robot, printable};
use serde_json::{Map, Value};

/// A state, each array of the right length.
pub struct State {
    pub q: Vec<f64>,
    /// `None` if only frames are asked for.
    pub motion: Option<Motion>,
    /// Actuation, n; zeros by default.
    pub u: Vec<f64>,
    /// Costate, 2n.
    pub y: Option<Vec<f64>>,
    /// Frames that are asked for.
    pub frames: Option<Vec<Request>>,
}

/// The motion of a state, as it was given.
pub enum Motion {
    Momentum(Vec<f64>),
    Velocity(Vec<f64>),
}

impl State {
    /// Reads a line for a robot. If both `p` and `v` are given, the coordinates decide which is
    /// used.
    pub fn parse(line: &[u8], robot: &Robot, coordinates: Coordinates) -> Result<Self, String> {
        let (state, n) = (parse(line)?, robot.dof());
        let q = numbers(&state, "q", robot.nq())?.ok_or("`q` is missing; give the n joint positions")?;
        unit(&q, robot)?;
        let u = numbers(&state, "u", n)?.unwrap_or_else(|| vec![0.0; n]);
        let y = numbers(&state, "y", 2 * n)?;
        let momentum = || Ok::<_, String>(numbers(&state, "p", n)?.map(Motion::Momentum));
        let velocity = || Ok::<_, String>(numbers(&state, "v", n)?.map(Motion::Velocity));
        let motion = match coordinates {
            Coordinates::Hamiltonian => momentum().transpose().or_else(|| velocity().transpose()),
            Coordinates::Lagrangian => velocity().transpose().or_else(|| momentum().transpose()),
        };
        let motion = motion.transpose()?;
        let frames = Request::parse_all(&state.frames, robot)?;
        if motion.is_none() && (frames.is_none() || y.is_some()) {
            return Err("`p` and `v` are missing; give the momenta or the velocities".into());
        }
        Ok(Self { q, motion, u, y, frames })
    }

    /// The first n inputs of a function that is differentiated: q, or no direction from q where it has
    /// quaternions.
    pub fn inputs(&self, n: usize) -> Vec<f64> {
        if self.q.len() == n { self.q.clone() } else { vec![0.0; n] }
    }
}

/// Refuses a quaternion whose length is not 1.
fn unit(q: &[f64], robot: &Robot) -> Result<(), String> {
    let quaternions = Quaternions::of(robot);
    let Some(k) = quaternions.first_not_unit(|entry| q[entry]) else { return Ok(()) };
    let (joint, length) = (printable(&robot.free_joints()[k].name), quaternions.length(k, |entry| q[entry]));
    let first = robot.free_joints()[k].quaternion();
    let remedy =
        if length > 0.0 { "divide it by its length" } else { "it has no direction: give another one" };
    Err(format!(
        "the quaternion of joint '{joint}', `q[{first}]` to `q[{}]`, has the length {length}, not 1; {remedy}",
        first + 3
    ))
}

/// The numbers under `key`, `None` if it is absent or null.
fn numbers(state: &Fields, key: &str, expected: usize) -> Result<Option<Vec<f64>>, String> {
    let Some(value) = state.get(key).filter(|value| !value.is_null()) else { return Ok(None) };
    let values = value.as_array().ok_or_else(|| format!("`{key}` is not an array of numbers"))?;
    if values.len() != expected {
        return Err(format!("`{key}` has {}, not {expected}", counted(values.len(), "number")));
    }
    let number =
        |(i, value): (usize, &Value)| value.as_f64().ok_or_else(|| format!("`{key}[{i}]` is not a number"));
    values.iter().enumerate().map(number).collect::<Result<_, _>>().map(Some)
}

/// The output line, built key by key.
#[derive(Default)]
pub struct Answer(Map<String, Value>);

impl Answer {
    /// The answer to a position alone.
    pub fn of_position(q: &[f64]) -> Self {
        let mut answer = Self::default();
        answer.vector("q", q);
        answer
    }

    /// Adds a vector.
    pub fn vector(&mut self, key: &str, values: &[f64]) {
        self.0.insert(key.into(), values.into());
    }

    /// Adds any value.
    pub fn value(&mut self, key: &str, value: Value) {
        self.0.insert(key.into(), value);
    }

    /// Adds a matrix, row by row.
    pub fn matrix(&mut self, key: &str, block: Block<'_, f64>) {
        self.0.insert(key.into(), block.iter_rows().map(Value::from).collect());
    }

    /// The JSON object; an error if it holds a null, which is what JSON makes of infinities and NaN.
    pub fn finite(self) -> Result<Value, String> {
        fn all_finite(value: &Value) -> bool {
            match value {
                Value::Array(values) => values.iter().all(all_finite),
                Value::Object(fields) => fields.values().all(all_finite),
                value => !value.is_null(),
            }
        }
        match self.0.iter().find(|(_, value)| !all_finite(value)) {
            Some((key, _)) => Err(format!("`{key}` overflows; scale the state or the robot down")),
            None => Ok(Value::Object(self.0)),
        }
    }
}
