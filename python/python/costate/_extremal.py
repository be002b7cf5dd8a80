"""The conditions of the maximum principle as a boundary value problem."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._costate import Dynamics, Robot
from ._errors import argument_error, whole
from ._transcription import entries
from ._wanted import dynamics_of

_Array = NDArray[np.float64]


class Extremal:
    """The conditions of the maximum principle for a motion of least effort, for ``scipy.integrate.solve_bvp``.

    ::

        H = y'f(x, tau) - 1/2 tau' R tau,    tau = R^-1 f_tau' y
        x' = f,    y' = -f_x' y,             x(0) = start,  x(T) = goal

    f is affine in tau in either coordinates, so that tau is a function of (x, y). The unknowns are z = (x, y), 4n. The
    Jacobian of the right-hand side is exact: it needs y'f_xx.

    Parameters
    ----------
    dynamics : Dynamics or Robot
        The model, a robot for (q, v); in "qp" f_tau is constant.
    start, goal : array_like
        First and last state (2n), in the coordinates of the dynamics.
    effort : float or array_like
        Diagonal of R (n), positive, in 1/(N m)^2 or 1/N^2.

    Examples
    --------
    >>> import costate, costate.scipy, numpy as np
    >>> robot = costate.Robot.builder("cart").prismatic("rail", axis=[1, 0, 0], mass=2).build()
    >>> extremal = costate.scipy.Extremal(costate.Dynamics(robot, "qp"), [0.0, 0.0], [1.0, 0.0])
    >>> extremal.torques(np.array([0.0, 0.0, 24.0, 12.0])[:, None]).tolist()
    [[12.0]]

    References
    ----------
    A. E. Bryson, Y.-C. Ho, Applied Optimal Control, 1975, section 2.3.
    """

    def __init__(
        self, dynamics: Dynamics | Robot, start: ArrayLike, goal: ArrayLike, *, effort: ArrayLike = 1.0
    ) -> None:
        dynamics = dynamics_of(dynamics)
        self.dynamics = dynamics
        self._n = dynamics.n
        self.start, self.goal = entries("start", start, 2 * self._n), entries("goal", goal, 2 * self._n)
        self._r = entries("effort", effort, self._n)
        if not (self._r > 0).all():
            raise argument_error("effort", "effort must be positive")

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        pairs = ((self.start, other.start), (self.goal, other.goal), (self._r, other._r))
        return self.dynamics == other.dynamics and all(np.array_equal(a, b) for a, b in pairs)

    def __hash__(self) -> int:
        return hash(self.dynamics)

    def _parts(self, z: _Array) -> tuple[_Array, _Array, _Array]:
        z = np.ascontiguousarray(np.asarray(z, dtype=float).T)
        n = self._n
        return z[..., :n], z[..., n : 2 * n], z[..., 2 * n :]

    def torques(self, z: _Array) -> _Array:
        """The torques tau = R^-1 f_tau' y.

        Parameters
        ----------
        z : ndarray (4n, m)
            Columns are states and costates.

        Returns
        -------
        ndarray (n, m)
            In N m, N.
        """
        q, v, y = self._parts(z)
        result: _Array = (self.dynamics.adjoint(q, v, np.zeros(self._n), y)[..., 2 * self._n :] / self._r).T
        return result

    def fun(self, t: Any, z: _Array) -> _Array:
        """The right-hand side z'.

        Parameters
        ----------
        t : ndarray (m)
            Times (s), which are not used.
        z : ndarray (4n, m)
            Columns are states and costates.

        Returns
        -------
        ndarray (4n, m)
            Their derivatives in time.
        """
        q, v, y = self._parts(z)
        tau = np.ascontiguousarray(self.torques(z).T)
        rates = self.dynamics.f(q, v, tau), -self.dynamics.adjoint(q, v, tau, y)[..., : 2 * self._n]
        return np.concatenate(rates, axis=-1).T

    def fun_jac(self, t: Any, z: _Array) -> _Array:
        """The derivative of ``fun`` by z.

        Parameters
        ----------
        t : ndarray (m)
            Times (s), which are not used.
        z : ndarray (4n, m)
            Columns are states and costates.

        Returns
        -------
        ndarray (4n, 4n, m)
            A Jacobian for each column.
        """
        q, v, y = self._parts(z)
        tau = np.ascontiguousarray(self.torques(z).T)
        _, j, h = self.dynamics.contract(q, v, tau, y)
        x = 2 * self._n
        f_x, f_u, h_xx, h_ux = j[..., :x], j[..., x:], h[..., :x, :x], h[..., x:, :x]
        # tau_x = R^-1 (y'f)_ux, tau_y = R^-1 f_u'.
        by_x, by_y = h_ux / self._r[:, None], np.swapaxes(f_u, -1, -2) / self._r[:, None]
        h_xu = np.swapaxes(h_ux, -1, -2)
        rows = [
            np.concatenate([f_x + f_u @ by_x, f_u @ by_y], axis=-1),
            np.concatenate([-h_xx - h_xu @ by_x, -np.swapaxes(f_x, -1, -2) - h_xu @ by_y], axis=-1),
        ]
        return np.moveaxis(np.concatenate(rows, axis=-2), 0, -1)

    def bc(self, a: _Array, b: _Array) -> _Array:
        """What must vanish at the ends.

        Parameters
        ----------
        a, b : ndarray (4n)
            The first and the last z.

        Returns
        -------
        ndarray (4n)
            x(0) - start and x(T) - goal.
        """
        x = 2 * self._n
        return np.concatenate([a[:x] - self.start, b[:x] - self.goal])

    def bc_jac(self, a: _Array, b: _Array) -> tuple[_Array, _Array]:
        """The derivatives of ``bc``.

        Parameters
        ----------
        a, b : ndarray (4n)
            The first and the last z, which are not used.

        Returns
        -------
        by_a, by_b : ndarray (4n, 4n)
            Constant.
        """
        x = 2 * self._n
        by_a, by_b = np.zeros((2, 2 * x, 2 * x))
        by_a[:x, :x] = by_b[x:, :x] = np.eye(x)
        return by_a, by_b

    def solve(self, duration: float, guess: ArrayLike | None = None, *, nodes: int = 20, **options: Any) -> Any:
        """Solve by ``scipy.integrate.solve_bvp``.

        Parameters
        ----------
        duration : float
            T (s).
        guess : array_like (4n, m), optional
            z at equal times; a straight line from start to goal with costates of zero unless given.
        nodes : int
            Number of times of that line, 2 or more.
        **options
            Of ``solve_bvp``: ``tol``, ``max_nodes``, ...

        Returns
        -------
        scipy.integrate.BVPResult
            ``sol(t)`` is z.

        Raises
        ------
        ArgumentError
            For fewer nodes.
        """
        from scipy.integrate import solve_bvp

        if guess is None:
            straight = np.linspace(self.start, self.goal, whole("nodes", nodes, 2), axis=1)
            guess = np.concatenate([straight, np.zeros_like(straight)])
        guess = np.asarray(guess, dtype=float)
        times = np.linspace(0.0, duration, guess.shape[1])
        return solve_bvp(self.fun, self.bc, times, guess, fun_jac=self.fun_jac, bc_jac=self.bc_jac, **options)
