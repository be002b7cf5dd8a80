"""Motions as either side's own polynomials on pieces of the time, for the judge and for starts on other meshes."""

import numpy

import radau
from shell import stop

# Coefficients, lowest first, of the Lagrange polynomials: a row for each node.
STATE = numpy.array([numpy.append(polynomial.coeffs[::-1], numpy.zeros(radau.DEGREE + 1))[: radau.DEGREE + 1]
                     for polynomial in radau.STATE])
CONTROL = numpy.array([numpy.append(polynomial.coeffs[::-1], numpy.zeros(radau.DEGREE))[: radau.DEGREE]
                       for polynomial in radau.CONTROL])
# Quintic on [0, 1] with these values of p, p', p'' at 0 and at 1: coefficients, lowest first.
HERMITE = numpy.linalg.inv(numpy.array([
    [1, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0], [0, 0, 2, 0, 0, 0],
    [1, 1, 1, 1, 1, 1], [0, 1, 2, 3, 4, 5], [0, 0, 2, 6, 12, 20]]))


def powers(x, count):
    return x ** numpy.arange(count)


class Motion:
    """`knots` are the times (s) where pieces meet; `given` are q, v and u, a row for each point at which the solver itself
    keeps limits, as it gave them."""

    def __init__(self, knots, given):
        self.knots, self.given = numpy.asarray(knots), given
        self.duration = self.knots[-1]

    def piece(self, t):
        return int(min(max(numpy.searchsorted(self.knots, t, side="right") - 1, 0), len(self.knots) - 2))

    def share(self, t, piece):
        return (t - self.knots[piece]) / (self.knots[piece + 1] - self.knots[piece])

    def at(self, t, piece=None):
        """q and v, and torques, at a time (s)."""
        piece = self.piece(t) if piece is None else piece
        return self.state(t, piece), self.torque(t, piece)


class Collocated(Motion):
    """State: polynomials through the start of an element and its Radau points; torques: through the points."""

    def __init__(self, mesh, duration, start, q, v, u):
        d = radau.DEGREE
        super().__init__(mesh * duration, (q, v, u))
        self.q, self.v, self.u = q, v, u
        values = numpy.hstack([q, v]).reshape(len(mesh) - 1, d, -1)
        first = numpy.vstack([start, values[:-1, -1]])
        self._state = numpy.einsum("rk,eri->eki", STATE, numpy.concatenate([first[:, None], values], axis=1))
        self._torque = numpy.einsum("rk,eri->eki", CONTROL, u.reshape(len(mesh) - 1, d, -1))

    def state(self, t, piece):
        return powers(self.share(t, piece), radau.DEGREE + 1) @ self._state[piece]

    def torque(self, t, piece):
        return powers(self.share(t, piece), radau.DEGREE) @ self._torque[piece]


class Polynomials(Motion):
    """On each interval q is a polynomial of degree four; torques are inverse dynamics along it, nowhere cut to their limits."""

    def __init__(self, knots, q, v, a, inverse_dynamics, given):
        """Coefficients of positions, rates and accelerations of every interval, by powers of the share of it, lowest first;
        `inverse_dynamics` takes rows of q, v and a; `given` are these three where the solver keeps limits."""
        self._q, self._v, self._a, self._inverse_dynamics = q, v, a, inverse_dynamics
        super().__init__(knots, (*given[:2], inverse_dynamics(*given)))

    def _values(self, t, piece):
        x = self.share(t, piece)
        return [powers(x, len(part[piece])) @ part[piece] for part in (self._q, self._v, self._a)]

    def state(self, t, piece):
        return numpy.concatenate(self._values(t, piece)[:2])

    def torque(self, t, piece):
        return self._inverse_dynamics(*(part[None] for part in self._values(t, piece)))[0]


class Quartic(Polynomials):
    """costate's own motion by the direct method, from positions and rates alone. Each interval has five rows, its ends and
    Gauss's three points, at which limits are kept."""

    PLACES = numpy.array([0.0, 0.5 - 0.15**0.5, 0.5, 0.5 + 0.15**0.5, 1.0])
    # What rounding may do to places, and to positions and rates in parts of their sizes.
    ROUNDING, EXACT = 1e-6, 1e-9

    @classmethod
    def suits(cls, t):
        """Whether rows at these times come in fives."""
        if len(t) < 5 or len(t) % 5:
            return False
        rows = t.reshape(-1, 5)
        places = (rows - rows[:, :1]) / numpy.maximum(rows[:, -1:] - rows[:, :1], 1e-300)
        return bool((abs(places - cls.PLACES) < cls.ROUNDING).all())

    def __init__(self, t, q, v, inverse_dynamics):
        rows, q, v = t.reshape(-1, 5), q.reshape(-1, 5, q.shape[1]), v.reshape(-1, 5, v.shape[1])
        h = (rows[:, -1] - rows[:, 0])[:, None, None]
        # The rate is a cubic. Its integral is the position, its derivative the acceleration, in units of h.
        at = lambda exponents: self.PLACES[:, None] ** exponents
        rates = numpy.linalg.pinv(at(numpy.arange(4))) @ v
        positions = numpy.concatenate([q[:, :1], h * rates / numpy.arange(1, 5)[:, None]], axis=1)
        for name, given, found in (("positions", q, positions), ("rates", v, rates)):
            missed = abs(at(numpy.arange(found.shape[1])) @ found - given).max()
            if missed > self.EXACT * (1 + abs(given).max()):
                stop(f"{name} of costate are off its polynomials by {missed:.1e}: are the rows of its JSON object others?")
        accelerations = rates[:, 1:] * numpy.arange(1, 4)[:, None] / h
        inner = [part[:, 1:4].reshape(-1, q.shape[2]) for part in (q, v, at(numpy.arange(3)) @ accelerations)]
        super().__init__(numpy.append(rows[:, 0], rows[-1, -1]), positions, rates, accelerations, inverse_dynamics, inner)


class Accelerated(Polynomials):
    """A motion with the polynomials through accelerations at Radau's points, at which limits are kept."""

    def __init__(self, knots, q, v, a, inverse_dynamics):
        """Positions and rates at the start of every interval, accelerations by interval and point."""
        h = numpy.diff(knots)[:, None, None]
        given = a.reshape(-1, a.shape[2])
        a = numpy.einsum("rk,eri->eki", CONTROL, a)
        rates = numpy.concatenate([v[:, None], h * a / numpy.arange(1, 4)[:, None]], axis=1)
        positions = numpy.concatenate([q[:, None], h * rates / numpy.arange(1, 5)[:, None]], axis=1)
        at = lambda part: (radau.POINTS[:, None] ** numpy.arange(part.shape[1]) @ part).reshape(given.shape)
        super().__init__(knots, positions, rates, a, inverse_dynamics, (at(positions), at(rates), given))


class Sampled(Motion):
    """costate's motion by its other methods. q: quintics through position, rate and acceleration of both nodes of a piece;
    torques: inverse dynamics along them, and straight lines on pieces so short that rounding would show in accelerations.

    A time that occurs twice is a jump of the torques: pieces of no length are left out."""

    SHORT = 1e-4

    def __init__(self, t, q, v, a, u, inverse_dynamics):
        keep = numpy.flatnonzero(numpy.diff(t) > 1e-12 * t[-1])
        knots = numpy.append(t[keep], t[-1])
        super().__init__(knots, (q, v, u))
        self._inverse_dynamics, self._n = inverse_dynamics, q.shape[1]
        h = numpy.diff(t)[keep, None]
        ends = [[q[i], h * v[i], h**2 * a[i]] for i in (keep, keep + 1)]
        self._q = numpy.einsum("kr,rei->eki", HERMITE, numpy.array(ends[0] + ends[1]))
        self._h = h[:, 0]
        self._u = numpy.stack([u[keep], u[keep + 1]], axis=1)

    def _derivative(self, x, piece, order):
        exponents = numpy.arange(6)
        factor = numpy.ones(6)
        for k in range(order):
            factor = factor * numpy.maximum(exponents - k, 0)
        return (factor * x ** numpy.maximum(exponents - order, 0)) @ self._q[piece] / self._h[piece]**order

    def state(self, t, piece):
        x = self.share(t, piece)
        return numpy.concatenate([self._derivative(x, piece, 0), self._derivative(x, piece, 1)])

    def torque(self, t, piece):
        x = self.share(t, piece)
        if self._h[piece] < self.SHORT * self.duration:
            return (1 - x) * self._u[piece, 0] + x * self._u[piece, 1]
        return self._inverse_dynamics(*(self._derivative(x, piece, order) for order in range(3)))
