"""The nonlinear program of a motion on one mesh."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from ._tables import text_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from ._problem import Problem

    _Array = NDArray[np.float64]
    _Indices = NDArray[np.int64]


class ProgramRow(NamedTuple):
    """What a constraint of a `Program` is about.

    Attributes
    ----------
    kind : str
        What is limited: ``"torque"``, ``"rate"``, ``"task"``, ...
    name : str
        The joint, or the row of a task.
    unit : str
        Its unit in reports; the function itself may be another measure of it, as half a square for the speed of a tool.
    place : float
        The place in the motion: 0 at its start, increased by one in each phase.
    """

    kind: str
    name: str
    unit: str
    place: float


@dataclass(frozen=True, eq=False)
class ProgramSamples:
    """A motion at the points of the mesh of a `Program`, where limits hold: three inside of each interval.

    Robots with constraints have further coordinates after those of the joints, whose accelerations are multipliers.

    Attributes
    ----------
    t : array (points)
        Times (s).
    q : array (points, n)
        Positions (rad, m).
    v : array (points, n)
        Velocities (rad/s, m/s).
    a : array (points, n)
        Accelerations (rad/s^2, m/s^2).
    tau : array (points, n)
        Generalised forces of inverse dynamics (N m, N).
    """

    t: _Array
    q: _Array
    v: _Array
    a: _Array
    tau: _Array


@dataclass(frozen=True, eq=False)
class ProgramSolution:
    """What `Program.solve` found.

    Attributes
    ----------
    status : {"solved", "solved_to_rounding", "locally_infeasible", "iteration_limit", "time_limit", "stalled"}
        How it ended; ``"locally_infeasible"``: the sum of all violations has a local minimum that is not zero.
    x : array (n)
        The last point.
    cost : float
        Its cost.
    multipliers : array (m)
        The gradient of ``cost + multipliers . g`` is zero. Positive at upper bounds.
    error : float
        Largest error of the conditions of optimality, in typical sizes.
    iterations : int
        Number of iterations.
    certificate : {"local_minimum", "undecided", "not_minimum", "not_stationary", "not_checked"}
        What second derivatives on the active set say; ``"not_checked"`` unless it is solved.
    """

    status: Literal["solved", "solved_to_rounding", "locally_infeasible", "iteration_limit", "time_limit", "stalled"]
    x: _Array
    cost: float
    multipliers: _Array
    error: float
    iterations: int
    certificate: Literal["local_minimum", "undecided", "not_minimum", "not_stationary", "not_checked"]


class Program:
    """The nonlinear program of a motion on one mesh, with exact derivatives, for any solver.

    It is what the direct method poses on its first mesh: the cost f(x) is least subject to ``cl <= g(x) <= cu``. The
    variables are positions and their derivatives at the nodes and the heights of bubbles on the intervals, without what
    is given at the ends; then free times. It begins at the straight guess. All limits, tools, obstacles, vias, loops and gaits of the problem are there.

    The methods `objective`, `gradient`, `constraints`, `jacobian`, `jacobianstructure`, `hessian` and `hessianstructure`
    are those that ``cyipopt.Problem(n=.., m=.., problem_obj=program, cl=program.cl, cu=program.cu)`` calls. Entries of
    matrices at the same place are to be added up, as IPOPT and ``scipy.sparse`` do. `solve` uses the solver of this
    library.

    Solved, it is the motion on this mesh. `Problem.solve` refines the mesh, keeps limits between its points too, and
    verifies the motion.

    Several threads may use one object: calls wait for each other, without the interpreter's lock. A pickle has the
    problem and the options.

    Parameters
    ----------
    problem : Problem
        The problem.
    **options
        Of ``[solver]``: ``nodes``, the number of points with both ends, ``max_nodes``, ``seed``, ``machine_code``.

    Attributes
    ----------
    n, m : int
        Numbers of variables and of constraints.

    Raises
    ------
    ProblemError
        With ``key``: what is refused; floating and spherical joints.

    Examples
    --------
    >>> import costate
    >>> builder = costate.Robot.builder("cart", gravity=[0, 0, 0])
    >>> robot = builder.prismatic("rail", axis=[1, 0, 0], mass=2).build()
    >>> problem = costate.Problem(robot, start=[0.0], end=[1.0], time=1.0, cost=[1.0], limits={"v_max": 1.2})
    >>> program = problem.nlp(nodes=31)
    >>> found = program.solve()
    >>> found.status, found.certificate
    ('solved', 'local_minimum')
    >>> samples = program.sample(found.x)
    >>> bool(samples.v.max() < 1.2 + 1e-6)
    True
    """

    def __init__(self, problem: Problem, **options: Any) -> None:
        self._problem, self._options = problem, options
        self._core = problem._core.nlp(text_of(options))
        self.n, self._equalities, self.m = self._core.sizes()

    def __reduce__(self) -> tuple[Any, ...]:
        return (_again, (self._problem, self._options))

    @property
    def problem(self) -> Problem:
        """The problem."""
        return self._problem

    @cached_property
    def x0(self) -> _Array:
        """The guess, n entries; not to be changed."""
        return _fixed(self._core.start())

    @cached_property
    def _bounds(self) -> tuple[_Array, _Array]:
        lower, upper = self._core.bounds()
        return _fixed(lower), _fixed(upper)

    @property
    def cl(self) -> _Array:
        """Lower bounds of the constraints, m entries: zero for equations, -inf where there is none."""
        return self._bounds[0]

    @property
    def cu(self) -> _Array:
        """Upper bounds of the constraints, m entries: zero for equations, inf where there is none."""
        return self._bounds[1]

    @cached_property
    def rows(self) -> list[ProgramRow]:
        """What the constraints are about, equations first."""
        return [ProgramRow(*row) for row in self._core.rows()]

    def objective(self, x: ArrayLike) -> float:
        """The cost f(x).

        Parameters
        ----------
        x : array (n)
            The variables.

        Returns
        -------
        float
            NaN where it has no value, as for times that are not positive.
        """
        return self._core.cost(x)

    def gradient(self, x: ArrayLike) -> _Array:
        """The gradient of f.

        Parameters
        ----------
        x : array (n)
            The variables.

        Returns
        -------
        array (n)
            The gradient.
        """
        return self._core.gradient(x)

    def constraints(self, x: ArrayLike) -> _Array:
        """The constraints g(x).

        Parameters
        ----------
        x : array (n)
            The variables.

        Returns
        -------
        array (m)
            Equations, then functions with ranges.
        """
        return self._core.constraints(x)

    def jacobianstructure(self) -> tuple[_Indices, _Indices]:
        """Rows and columns of the entries of the Jacobian of g.

        Returns
        -------
        rows, columns : array of int
            Numbered from zero.
        """
        rows, columns = self._core.jacobian_structure()
        return rows, columns

    def jacobian(self, x: ArrayLike) -> _Array:
        """The entries of the Jacobian of g.

        Parameters
        ----------
        x : array (n)
            The variables.

        Returns
        -------
        array
            In the order of `jacobianstructure`.
        """
        return self._core.jacobian(x)

    def hessianstructure(self) -> tuple[_Indices, _Indices]:
        """Rows and columns of the entries of the Hessian, its lower triangle.

        Returns
        -------
        rows, columns : array of int
            Numbered from zero.
        """
        rows, columns = self._core.hessian_structure()
        return rows, columns

    def hessian(self, x: ArrayLike, lagrange: ArrayLike, obj_factor: float) -> _Array:
        """The entries of the Hessian of ``obj_factor f + lagrange . g``.

        Parameters
        ----------
        x : array (n)
            The variables.
        lagrange : array (m)
            Multipliers of the constraints.
        obj_factor : float
            The factor of the cost.

        Returns
        -------
        array
            In the order of `hessianstructure`.
        """
        return self._core.hessian(x, lagrange, obj_factor)

    def sample(self, x: ArrayLike) -> ProgramSamples:
        """The motion at the points of the mesh.

        Parameters
        ----------
        x : array (n)
            The variables.

        Returns
        -------
        ProgramSamples
            Times, positions, velocities, accelerations, forces.
        """
        t, parts = self._core.sample(x)
        return ProgramSamples(t, *(part.reshape(len(t), -1) for part in parts))

    def solve(
        self,
        x0: ArrayLike | None = None,
        *,
        tolerance: float = 1e-8,
        iterations: int = 1000,
        time_limit: float = math.inf,
    ) -> ProgramSolution:
        """Solve by the interior-point method of this library.

        Parameters
        ----------
        x0 : array (n), optional
            Where it begins; the guess.
        tolerance : float
            Largest error of the conditions of optimality, in typical sizes (1e-8).
        iterations : int
            Most iterations (1000).
        time_limit : float
            No iteration begins after this time in s (inf: no limit).

        Returns
        -------
        ProgramSolution
            With ``status``: look at it first. Ctrl-C ends it after an iteration.
        """
        start = self.x0 if x0 is None else x0
        return ProgramSolution(*self._core.solve(start, tolerance, iterations, time_limit))

    def __repr__(self) -> str:
        return f"Program(n={self.n}, m={self.m}, of {self._problem!r})"


def _fixed(array: _Array) -> _Array:
    array.flags.writeable = False
    return array


def _again(problem: Problem, options: dict[str, Any]) -> Program:
    return Program(problem, **options)
