//! Distances between bodies and obstacles, by formulas of their own.

use crate::cost::point;
use costate::kinematics::Kinematics;
use costate_control::{BodyPairs, Problem, Shape};

/// A segment with a radius; a sphere is one of length zero.
struct Capsule {
    ends: [[f64; 3]; 2],
    radius: f64,
}

/// The bodies and obstacles of a problem that this study measures.
pub struct Scene {
    frames: Vec<usize>,
}

impl Scene {
    /// `None` without obstacles; `Err` for shapes and pairs that are not measured.
    pub fn new(problem: &Problem) -> Result<Option<Self>, String> {
        let Some(collision) = &problem.task.collision else { return Ok(None) };
        if collision.along_links.is_some()
            || collision.pairs != BodyPairs::None
            || !collision.except.is_empty()
        {
            return Err("bodies along links, pairs".into());
        }
        if problem.task.obstacles.iter().any(|obstacle| matches!(obstacle.shape, Shape::Box { .. })) {
            return Err("boxes".into());
        }
        let frames = collision.capsules.iter().map(|body| problem.robot.frame_index(&body.frame));
        let frames = frames.collect::<Result<_, _>>().map_err(|error| error.to_string())?;
        Ok(Some(Self { frames }))
    }

    /// The least clearance less the margin (m), and the names of body and obstacle.
    pub fn least(&self, problem: &Problem, kinematics: &Kinematics<f64>) -> Option<(f64, String)> {
        let collision = problem.task.collision.as_ref()?;
        let mut least: Option<(f64, String)> = None;
        for (body, &frame) in collision.capsules.iter().zip(&self.frames) {
            let from = point(kinematics, frame, body.from)?;
            let to = match body.to {
                Some(to) => point(kinematics, frame, to)?,
                None => from,
            };
            let own = Capsule { ends: [from, to], radius: body.radius };
            for obstacle in &problem.task.obstacles {
                let distance = own.distance(&obstacle.shape)? - collision.margin;
                if least.as_ref().is_none_or(|(found, _)| distance < *found) {
                    least = Some((distance, format!("{} and {}", body.name, obstacle.name)));
                }
            }
        }
        least
    }
}

impl Capsule {
    fn distance(&self, shape: &Shape) -> Option<f64> {
        let [a, b] = self.ends;
        match *shape {
            Shape::Sphere { centre, radius } => Some(segments(a, b, centre, centre) - self.radius - radius),
            Shape::Capsule { from, to, radius } => Some(segments(a, b, from, to) - self.radius - radius),
            Shape::HalfSpace { through, normal } => {
                let length = dot(normal, normal).sqrt();
                let above = |x: [f64; 3]| dot(minus(x, through), normal) / length;
                Some(above(a).min(above(b)) - self.radius)
            }
            _ => None,
        }
    }
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

/// Distance of two segments a b and c d: the least over s and t in [0, 1] of |a + s (b - a) - c - t (d -
/// c)|. The function is convex and quadratic: t is best for given s, and s is found at the unconstrained
/// minimum or on the edges of the square.
fn segments(a: [f64; 3], b: [f64; 3], c: [f64; 3], d: [f64; 3]) -> f64 {
    let (u, w, r) = (minus(b, a), minus(d, c), minus(a, c));
    let at = |s: f64, t: f64| {
        let x: [f64; 3] = std::array::from_fn(|k| r[k] + s * u[k] - t * w[k]);
        dot(x, x)
    };
    let part = |above: f64, below: f64| if below > 0.0 { (above / below).clamp(0.0, 1.0) } else { 0.0 };
    let best_t = |s: f64| part(dot(r, w) + s * dot(u, w), dot(w, w));
    let best_s = |t: f64| part(t * dot(u, w) - dot(r, u), dot(u, u));
    let (uu, ww, uw) = (dot(u, u), dot(w, w), dot(u, w));
    let determinant = uu * ww - uw * uw;
    let mut least = f64::INFINITY;
    let mut take = |s: f64, t: f64| least = least.min(at(s, t));
    if determinant > 0.0 {
        let s = (uw * dot(r, w) - ww * dot(r, u)) / determinant;
        let t = (uu * dot(r, w) - uw * dot(r, u)) / determinant;
        if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
            take(s, t);
        }
    }
    for end in [0.0, 1.0] {
        take(end, best_t(end));
        take(best_s(end), end);
    }
    least.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_are_as_far_apart_as_their_closest_samples() {
        let mut draw = crate::draw::Draw::new(1, 1);
        let point = |draw: &mut crate::draw::Draw| std::array::from_fn(|_| draw.even(-1.0..1.0));
        for _ in 0..50 {
            let [a, b, c, d]: [[f64; 3]; 4] = std::array::from_fn(|_| point(&mut draw));
            let mut least = f64::INFINITY;
            for i in 0..=200 {
                for j in 0..=200 {
                    let (s, t) = (i as f64 / 200.0, j as f64 / 200.0);
                    let x: [f64; 3] =
                        std::array::from_fn(|k| a[k] + s * (b[k] - a[k]) - c[k] - t * (d[k] - c[k]));
                    least = least.min(dot(x, x).sqrt());
                }
            }
            let found = segments(a, b, c, d);
            assert!(found <= least + 1e-12 && least - found < 0.01, "{found} {least}");
        }
    }
}
