//! Values that the tests of users' inputs expect: closed forms, and small problems that are solved to
//! rounding.

use nalgebra::{Complex, DMatrix, DVector};

/// A motion of one mass m along a reference r of cubics between knots:
/// `J = int R u^2/2 + w (q - r)^2/2 dt`, `u = m q''`, from rest at `ends[0]` to rest at `ends[1]`.
pub struct Following<'a> {
    pub mass: f64,
    pub effort: f64,
    pub weight: f64,
    /// The first knot is the start, the last one the end.
    pub times: &'a [f64],
    pub positions: &'a [f64],
    pub velocities: &'a [f64],
    pub ends: [f64; 2],
}

/// One cubic of the reference and the four exponentials of the motion around it.
struct Piece {
    length: f64,
    /// r = sum c_k x^k.
    c: [f64; 4],
    /// `Re, Im exp(lambda x)` and the same from the other end, lambda = rate (i - 1).
    rate: f64,
}

impl Piece {
    /// The k-th derivative of the reference.
    fn reference(&self, k: usize, x: f64) -> f64 {
        (k..4)
            .map(|j| {
                let factor: f64 = (0..k).map(|i| (j - i) as f64).product();
                factor * self.c[j] * x.powi((j - k) as i32)
            })
            .sum()
    }

    /// The k-th derivatives of the four exponentials, over rate^k.
    fn basis(&self, k: usize, x: f64) -> [f64; 4] {
        let unit = Complex::new(-1.0, 1.0);
        let left = unit.powu(k as u32) * (unit * self.rate * x).exp();
        let right = (-unit).powu(k as u32) * (unit * self.rate * (self.length - x)).exp();
        [left.re, left.im, right.re, right.im]
    }
}

impl Following<'_> {
    /// J. The condition of Euler and Lagrange, `R m^2 q'''' + w (q - r) = 0`, has the solution r plus four
    /// exponentials in each piece, since r is a cubic there; at the knots q and three derivatives are
    /// continuous. Four linear equations for each piece, solved to rounding.
    pub fn cost(&self) -> f64 {
        let inertia = self.effort * self.mass * self.mass;
        let rate = (self.weight / inertia).powf(0.25) / 2.0_f64.sqrt();
        let pieces: Vec<Piece> = (1..self.times.len()).map(|k| self.piece(k, rate)).collect();
        let n = 4 * pieces.len();
        let (mut matrix, mut right) = (DMatrix::zeros(n, n), DVector::zeros(n));
        let mut row = 0;
        // The sum over pieces of sign times the k-th derivative at x is zero, or the value at an end.
        let mut equation = |k: usize, terms: &[(usize, f64, f64)], value: f64| {
            let scale = rate.powi(k as i32);
            right[row] = value / scale;
            for &(p, x, sign) in terms {
                for (j, entry) in pieces[p].basis(k, x).into_iter().enumerate() {
                    matrix[(row, 4 * p + j)] = sign * entry;
                }
                right[row] -= sign * pieces[p].reference(k, x) / scale;
            }
            row += 1;
        };
        let last = pieces.len() - 1;
        equation(0, &[(0, 0.0, 1.0)], self.ends[0]);
        equation(1, &[(0, 0.0, 1.0)], 0.0);
        for (p, piece) in pieces[..last].iter().enumerate() {
            for k in 0..4 {
                equation(k, &[(p, piece.length, 1.0), (p + 1, 0.0, -1.0)], 0.0);
            }
        }
        equation(0, &[(last, pieces[last].length, 1.0)], self.ends[1]);
        equation(1, &[(last, pieces[last].length, 1.0)], 0.0);
        let found = matrix.lu().solve(&right).unwrap();
        let around = |p: usize, k: usize, x: f64| -> f64 {
            let basis = pieces[p].basis(k, x);
            rate.powi(k as i32) * (0..4).map(|j| found[4 * p + j] * basis[j]).sum::<f64>()
        };
        let running = |p: usize, x: f64| {
            let acceleration = around(p, 2, x) + pieces[p].reference(2, x);
            0.5 * (inertia * acceleration * acceleration + self.weight * around(p, 0, x).powi(2))
        };
        // Exponentials live within 40 of their lengths of an end; between them the integrand is a quadratic.
        let panel = 0.25 / rate;
        let cost = |p: usize| {
            let length = pieces[p].length;
            let reach = 160.0 * panel;
            let mut marks = vec![0.0];
            let parts = |from: f64, to: f64| {
                let count = ((to - from) / panel).ceil().max(1.0);
                (1..=count as usize).map(move |k| from + (to - from) * k as f64 / count)
            };
            if length > 2.0 * reach {
                marks.extend(parts(0.0, reach));
                marks.extend(parts(length - reach, length).map(|x| x.max(length - reach)));
                marks.push(length - reach);
                marks.sort_by(f64::total_cmp);
            } else {
                marks.extend(parts(0.0, length));
            }
            marks.windows(2).map(|pair| gauss(pair[0], pair[1], |x| running(p, x))).sum::<f64>()
        };
        (0..pieces.len()).map(cost).sum()
    }

    fn piece(&self, k: usize, rate: f64) -> Piece {
        let h = self.times[k] - self.times[k - 1];
        let (a, b) = (self.positions[k - 1], self.positions[k]);
        let (u, v) = (self.velocities[k - 1], self.velocities[k]);
        let d = (b - a) / h;
        let c = [a, u, (3.0 * d - 2.0 * u - v) / h, (u + v - 2.0 * d) / (h * h)];
        Piece { length: h, c, rate }
    }
}

/// Gauss's rule of five points, exact to degree nine.
fn gauss(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let rule = [
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (0.906_179_845_938_664, 0.236_926_885_056_189_08),
    ];
    let pair = |x: f64| if x == 0.0 { f(middle) } else { f(middle - half * x) + f(middle + half * x) };
    half * rule.into_iter().map(|(x, weight)| weight * pair(x)).sum::<f64>()
}

/// The least time from rest to rest over a long way d with limits of rate, acceleration and jerk, the
/// acceleration continuous: `d/v + 2 sqrt(v/j)` where the acceleration stays below its limit, else
/// `d/v + v/a + a/j`.
pub fn jerk_limited_time(d: f64, v: f64, a: f64, j: f64) -> f64 {
    let ramp = if v * j <= a * a { 2.0 * (v / j).sqrt() } else { v / a + a / j };
    assert!(d >= v * ramp, "the rate does not reach its limit");
    d / v + ramp
}

/// Least effort `int |m q''|^2/2 dt` of a point that goes from rest to rest in the time T, over a disc that
/// it touches once.
pub struct Over {
    pub centre: [f64; 2],
    /// That of the wall and that of the point together.
    pub radius: f64,
    pub from: [f64; 2],
    pub to: [f64; 2],
    pub time: f64,
    /// Of x and y.
    pub mass: [f64; 2],
    /// 1: over the top, -1: below.
    pub side: f64,
}

impl Over {
    /// The motion is a cubic spline through the place and time at which it touches, free in its rate there.
    /// Along the circle and in time its cost is stationary, as the force of the disc acts along the normal
    /// and does no work. Newton's method by differences for both.
    pub fn cost(&self) -> f64 {
        let mut z = [0.0, 0.5 * self.time];
        let steps = [1e-4, 1e-4 * self.time];
        for _ in 0..30 {
            let at = |i: f64, j: f64| self.through([z[0] + i * steps[0], z[1] + j * steps[1]]);
            let gradient = [0.5 * (at(1.0, 0.0) - at(-1.0, 0.0)), 0.5 * (at(0.0, 1.0) - at(0.0, -1.0))];
            let middle = at(0.0, 0.0);
            let (xx, yy) =
                (at(1.0, 0.0) + at(-1.0, 0.0) - 2.0 * middle, at(0.0, 1.0) + at(0.0, -1.0) - 2.0 * middle);
            let xy = 0.25 * (at(1.0, 1.0) + at(-1.0, -1.0) - at(1.0, -1.0) - at(-1.0, 1.0));
            let determinant = xx * yy - xy * xy;
            z[0] -= steps[0] * (yy * gradient[0] - xy * gradient[1]) / determinant;
            z[1] -= steps[1] * (xx * gradient[1] - xy * gradient[0]) / determinant;
        }
        assert!(z[0].abs() < 1.0 && (0.1..0.9).contains(&(z[1] / self.time)), "{z:?}");
        let least =
            (0..=4000).map(|k| self.distance(z, self.time * f64::from(k) / 4000.0)).fold(1.0, f64::min);
        assert!(least > -1e-6, "it cuts the disc by {least}");
        self.through(z)
    }

    fn place(&self, angle: f64) -> [f64; 2] {
        let (sin, cos) = angle.sin_cos();
        [self.centre[0] + self.radius * sin, self.centre[1] + self.side * self.radius * cos]
    }

    fn through(&self, [angle, s]: [f64; 2]) -> f64 {
        let p = self.place(angle);
        (0..2)
            .map(|k| {
                let (v, r) = (self.rate(k, p[k], s), self.time - s);
                let part = |d: f64, h: f64| 6.0 * d * d / h.powi(3) - 6.0 * d * v / (h * h) + 2.0 * v * v / h;
                self.mass[k].powi(2) * (part(p[k] - self.from[k], s) + part(self.to[k] - p[k], r))
            })
            .sum()
    }

    /// The best rate at the place.
    fn rate(&self, k: usize, p: f64, s: f64) -> f64 {
        let r = self.time - s;
        (6.0 * (p - self.from[k]) / (s * s) + 6.0 * (self.to[k] - p) / (r * r)) / (4.0 / s + 4.0 / r)
    }

    /// From the surface at a time.
    fn distance(&self, [angle, s]: [f64; 2], t: f64) -> f64 {
        let p = self.place(angle);
        let q = [0, 1].map(|k| {
            let v = self.rate(k, p[k], s);
            let (a, b, first, last, h, x) = match t < s {
                true => (self.from[k], p[k], 0.0, v, s, t / s),
                false => (p[k], self.to[k], v, 0.0, self.time - s, (t - s) / (self.time - s)),
            };
            let (d, u, w) = (b - a, first * h, last * h);
            a + u * x + (3.0 * d - 2.0 * u - w) * x * x + (u + w - 2.0 * d) * x * x * x
        });
        (q[0] - self.centre[0]).hypot(q[1] - self.centre[1]) - self.radius
    }
}

/// The cost of a spindle with sharp dry friction: it moves for `t = sqrt(6 I D/C)` and waits for the rest,
/// `J = 6 I^2 D^2/t^3 + C^2 t/2`; a bound from above of that with a transition.
pub fn sharp_spindle(inertia: f64, coulomb: f64, way: f64, time: f64) -> f64 {
    let moving = (6.0 * inertia * way / coulomb).sqrt().min(time);
    6.0 * (inertia * way).powi(2) / moving.powi(3) + 0.5 * coulomb * coulomb * moving
}

#[test]
fn a_mass_that_follows_a_line_slowly_costs_the_quintic_of_a_weak_reference() {
    // Without a weight worth mentioning: 6 d^2/T^3 for a unit mass.
    let rest = Following {
        mass: 1.0,
        effort: 1.0,
        weight: 1e-6,
        times: &[0.0, 2.0],
        positions: &[0.0, 0.0],
        velocities: &[0.0, 0.0],
        ends: [0.0, 1.0],
    };
    assert!((rest.cost() - 0.75).abs() < 1e-6, "{}", rest.cost());
}
