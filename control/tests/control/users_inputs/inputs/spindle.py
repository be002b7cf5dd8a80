"""Least effort of one joint with dry friction that waits, to ten digits: `python spindle.py` (needs mpmath).

    minimise 1/2 int_0^T (I v' + F(v))^2 dt,  F = C tanh(v/w),  v(0) = v(T) = 0,  int v dt = D

The middle term I v' F of the square is a total derivative that vanishes between equal ends. What is left has
the first integral I^2 v'^2 = g(v) = 2 E + F(v)^2 - 2 m v with the multiplier m of the way. Where it pays to
wait, the joint creeps at the small v* where g touches zero, F F' = m. Away from there it is symmetric in time:

    D - v* T = 2 I int_0^p (v - v*)/sqrt(g) dv,  J - F(v*)^2 T/2 = I int_0^p (g + F^2 - F(v*)^2)/sqrt(g) dv

with g(p) = 0. g(v*) is not quite zero: about exp(-C t/(w I)) for the time t of waiting, left out here.
With sharp friction (w = 0) it moves for t = sqrt(6 I D/C) at the cost of 6 I^2 D^2/t^3 + C^2 t/2.
"""

from mpmath import atanh, findroot, mp, mpf, quad, sqrt, tanh

mp.dps = 30


def least_effort(I, C, w, D, T):
    I, C, w, D, T = (mpf(x) for x in (I, C, w, D, T))
    F = lambda v: C * tanh(v / w)

    def integrals(m):
        slope = lambda x: C**2 / w * x * (1 - x**2) - m
        star = w * atanh(findroot(slope, (mpf(0), 1 / sqrt(mpf(3))), solver="anderson"))
        squares = lambda v: F(v) ** 2 - F(star) ** 2
        g = lambda v: squares(v) - 2 * m * (v - star)
        p = findroot(g, C**2 / (2 * m))
        middle = p / 2
        marks = sorted([mpf(0), star] + [star + k * w for k in (0.5, 1, 2, 4, 8, 16) if k * w < middle / 2] + [middle])

        def whole(h):
            # Both h and g vanish at v*: h once, g twice.
            part = quad(lambda v: h(v) / sqrt(g(v)), marks, method="gauss-legendre")
            # v = p - s^2 takes the root at the end away.
            last = lambda s: 2 * s * h(p - s * s) / sqrt(g(p - s * s))
            return part + quad(last, [0, sqrt(p - middle)], method="gauss-legendre")

        way = 2 * I * whole(lambda v: v - star) + star * T
        return way, I * whole(lambda v: g(v) + squares(v)) + F(star) ** 2 * T / 2

    t = sqrt(6 * I * D / C)
    assert T - t > 20 * w * I / C, "it does not wait"
    guess = 12 * I**2 * D / t**3
    m = findroot(lambda m: integrals(m)[0] / D - 1, (guess, guess * mpf("0.999")), solver="secant", tol=1e-20)
    return integrals(m)[1], 6 * I**2 * D**2 / t**3 + C**2 * t / 2


if __name__ == "__main__":
    for row in [
        ("0.05", "1", "0.01", "62.83185307", "8"),
        ("0.05", "1", "0.1", "62.83185307", "8"),
        ("0.05", "1", "0.01", "10", "8"),
        ("0.05", "1", "0.003", "30", "12"),
        ("0.2", "3", "0.02", "20", "5"),
        ("0.5", "0.5", "0.05", "40", "30"),
        ("0.02", "5", "0.001", "60", "3"),
        ("1", "10", "0.2", "15", "10"),
    ]:
        best, sharp = least_effort(*row)
        print(row, mp.nstr(best, 10), "sharp", mp.nstr(sharp, 10))
