//! Projections: normal to the plane of a planar motion; otherwise from the side and from above.

use super::skeleton::Point;
use crate::numbers::fixed;

/// A projection: two unit vectors of the world.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// For names of files.
    pub name: &'static str,
    pub title: &'static str,
    pub right: Point,
    pub up: Point,
    pub labels: [String; 2],
}

const SIDE: [usize; 2] = [0, 2];
const ABOVE: [usize; 2] = [0, 1];
const FRONT: [usize; 2] = [1, 2];

/// A motion is planar if its depth is at most this fraction of its size.
const FLAT: f64 = 1e-7;

pub fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: Point) -> Option<Point> {
    let norm = dot(a, a).sqrt();
    (norm > 0.0).then(|| a.map(|x| x / norm))
}

/// The views of a motion through these points.
pub fn views(points: &[Point]) -> Vec<View> {
    let extent = |axis: Point| {
        let along = points.iter().map(|&point| dot(axis, point));
        let (low, high) = along.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
        (high - low).max(0.0)
    };
    let size = extent(basis(0)).max(extent(basis(1))).max(extent(basis(2)));
    let flat = |axis: Point| extent(axis) <= FLAT * size;
    let coordinate = [(1, SIDE), (2, ABOVE), (0, FRONT)].into_iter().find(|(normal, _)| flat(basis(*normal)));
    if let Some((_, axes)) = coordinate {
        return vec![along(axes)];
    }
    match normal(points).filter(|&normal| flat(normal)) {
        Some(normal) => vec![oblique(normal)],
        None => vec![along(SIDE), along(ABOVE)],
    }
}

fn basis(axis: usize) -> Point {
    let mut unit = [0.0; 3];
    unit[axis] = 1.0;
    unit
}

fn along(axes: [usize; 2]) -> View {
    let (name, title) = match axes {
        SIDE => ("xz", "from the side, x-z"),
        ABOVE => ("xy", "from above, x-y"),
        _ => ("yz", "from the front, y-z"),
    };
    let label = |axis: usize| format!("{} (m)", ["x", "y", "z"][axis]);
    View { name, title, right: basis(axes[0]), up: basis(axes[1]), labels: axes.map(label) }
}

/// The projection along `normal`, with z as far up as possible.
fn oblique(normal: Point) -> View {
    let steep = normal[2].abs() > 0.99;
    let towards = if steep { basis(1) } else { basis(2) };
    let component = dot(towards, normal);
    let up = unit(minus(towards, normal.map(|x| x * component))).unwrap_or(towards);
    let right = cross(up, normal);
    // The side is chosen so that x, or else y, increases to the right.
    let leading = if right[0].abs() > 1e-9 { right[0] } else { right[1] };
    let right = if leading < 0.0 { right.map(|x| -x) } else { right };
    let label = |a: Point| format!("along ({}) (m)", a.map(|x| fixed(x, 2)).join(", "));
    View { name: "plane", title: "in the plane of the motion", right, up, labels: [label(right), label(up)] }
}

/// The normal of the triangle of the points that are farthest apart.
fn normal(points: &[Point]) -> Option<Point> {
    let first = *points.first()?;
    let far = |distance: &dyn Fn(Point) -> f64| {
        points.iter().copied().max_by(|&a, &b| distance(a).total_cmp(&distance(b)))
    };
    let second = far(&|point| dot(minus(point, first), minus(point, first)))?;
    let line = unit(minus(second, first))?;
    let beside = |point: Point| cross(line, minus(point, first));
    unit(beside(far(&|point| dot(beside(point), beside(point)))?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planar_motions_are_projected_along_their_normal() {
        let names = |points: &[Point]| views(points).iter().map(|view| view.name).collect::<Vec<_>>();
        assert_eq!(names(&[[0.0; 3], [1.0, 0.0, 0.5], [0.2, 0.0, -1.0]]), ["xz"]);
        assert_eq!(names(&[[0.0; 3], [1.0, 0.5, 0.0], [0.2, -1.0, 0.0]]), ["xy"]);
        assert_eq!(names(&[[0.0; 3], [0.0, 0.5, 0.1], [0.0, -1.0, 1.0]]), ["yz"]);
        assert_eq!(names(&[[0.0; 3], [1.0, 0.0, 0.0]]), ["xz"]);
        assert_eq!(names(&[[0.0; 3], [1.0, 1.0, 0.5], [0.2, -1.0, 0.3], [0.5, 0.5, 0.9]]), ["xz", "xy"]);
        assert_eq!(names(&[]), ["xz"]);
        let oblique = &views(&[[0.0; 3], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [-0.5, -0.5, 0.7]])[0];
        assert_eq!((oblique.name, oblique.up), ("plane", [0.0, 0.0, 1.0]));
        assert!((oblique.right[0] - 0.5_f64.sqrt()).abs() < 1e-15 && oblique.right[1] > 0.0);
        assert_eq!(oblique.labels[0], "along (0.71, 0.71, 0.00) (m)");
    }
}
