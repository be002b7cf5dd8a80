"""A problem that is solved again and again."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from . import _run
from ._derivatives import Derivatives
from ._errors import Interrupted, LimitWarning, whole
from ._feedback import Feedback, Resolved
from ._problem import Problem
from ._solution import Solution
from ._tables import text_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    _Array = NDArray[np.float64]


class Resolve(Derivatives):
    """A problem that is solved again and again on one mesh, as a controller needs it.

    The mesh has (nodes - 1)/3 equal intervals. Each solve begins at the motion that is optimal for the new ends to
    first order. The limits of the robot are kept where `Problem.solve` keeps them, and where they are left out
    although the problem does not say so, a `LimitWarning` tells.

    A solve that failed (the status "no_progress", an error) is no start: the next one begins at the last motion that was
    solved, and if that fails too at the first guess. So it does where a solve ended before it was solved and the solved
    motion is better for what is set now, as after one wrong measurement. After a wrong one for which a motion was solved,
    `reset` begins anew.

    Several threads may use one object: calls wait for each other, without the interpreter's lock, and the motion is
    that of the last solve. A thread with motions of its own needs its own object.

    A copy and a pickle have the problem, the options and all that was set, and begin anew: the first solve of a copy
    begins where the first one of the original did. Objects are equal to themselves alone.

    Parameters
    ----------
    problem : Problem
        The problem.
    near : Solution, optional
        Begins at this motion, on its mesh.
    **options
        ``nodes``, ``tolerance``, ``machine_code`` and other options of ``[solver]``. ``machine_code="at_once"`` is best
        for many solves.

    Raises
    ------
    ProblemError
        With ``key``: a problem that cannot be solved again, or an option that is refused.

    Examples
    --------
    >>> import costate
    >>> builder = costate.Robot.builder("cart", gravity=[0, 0, 0])
    >>> robot = builder.prismatic("rail", axis=[1, 0, 0], mass=2).build()
    >>> motion = costate.Resolve(costate.Problem(robot, start=[0.0], end=[1.0], time=1.0, cost=[1.0]))
    >>> motion.solve().status
    'solved'
    >>> motion.set_start([0.5], [0.0])
    >>> round(motion.solve(steps=5).cost, 6)
    6.0
    >>> q, v, a = motion.state(0.5)
    >>> q.round(6).tolist()
    [0.75]
    """

    def __init__(self, problem: Problem, *, near: Solution | None = None, **options: Any) -> None:
        self._problem, self._near, self._options = problem, near, options
        self._core = problem._core.resolve(text_of(options), None if near is None else near._core)
        self._joints = problem.robot.joint_names
        self._n = len(self._joints)
        self._calls = {}
        if problem._core.leaves_out_limits():
            text = "the limits of the robot are not kept: limits=True keeps them, limits=False leaves them out without this warning"
            warnings.warn(text, LimitWarning, stacklevel=2)

    @classmethod
    def _again(cls, problem: Problem, near: Solution | None, options: dict[str, Any], calls: dict[Any, Any]) -> Resolve:
        motion = cls(problem, near=near, **options)
        for (name, key), arguments in calls.items():
            motion._set(name, key, *arguments)
        return motion

    def __reduce__(self) -> tuple[Any, ...]:
        return (Resolve._again, (self._problem, self._near, self._options, dict(self._calls)))

    @property
    def problem(self) -> Problem:
        """The problem as it was at first."""
        return self._problem

    def advance(self, dt: float) -> None:
        """Begin the next solve at the motion of the last one from a later time on; vias stay on the clock.

        Parameters
        ----------
        dt : float
            The time since the last solve (s). Before the first solve it has no effect.

        Raises
        ------
        ArgumentError
            For a time that is negative, not finite, or longer than the motion.
        """
        self._core.advance(dt)

    def reset(self) -> None:
        """Begin anew: the next solve starts at the first guess, moved to the ends that are set now.

        What was set stays. A motion is a local minimum, and the next one is near it: after a jump of the start, a motion
        that is solved may cost more than the one that a new search finds.
        """
        self._core.reset()

    def solve(
        self,
        *,
        steps: int | None = None,
        seconds: float | None = None,
        on_interrupt: Literal["raise", "return"] = "raise",
    ) -> Resolved:
        """Solve with what was set since the last time.

        Ctrl-C is looked for after each Newton step, at most every 50 ms: shorter solves are never disturbed. The motion is
        then the best one so far, and the next solve goes on.

        Parameters
        ----------
        steps : int, optional
            Most Newton steps; without it and ``seconds`` the limits of the options hold.
        seconds : float, optional
            Longest time; no step begins that would probably exceed it.
        on_interrupt : {"raise", "return"}
            After Ctrl-C raise `Interrupted`, a KeyboardInterrupt with the figures in ``reached``; or return these.

        Returns
        -------
        Resolved
            Its ``status`` says how it ended.

        Raises
        ------
        ArgumentError
            For steps or seconds that are not positive.
        StateError
            Where the motion cannot be evaluated.
        Interrupted
            After Ctrl-C.
        """
        _run.check_on_interrupt(on_interrupt)
        steps = None if steps is None else whole("steps", steps, 1)
        *figures, raised = self._core.solve(steps, seconds)
        found = Resolved._make(figures)
        if raised is not None and not isinstance(raised, KeyboardInterrupt):
            raise raised
        if raised is not None and on_interrupt == "raise":
            raise Interrupted(found, f"interrupted after {found.iterations} steps; the motion is the best one so far")
        return found

    @property
    def final_time(self) -> float:
        """T (s); not-a-number before the first solve."""
        return self._core.final_time()

    def state(self, t: ArrayLike) -> tuple[_Array, _Array, _Array]:
        """Positions, rates and accelerations of the motion.

        Parameters
        ----------
        t : float or array_like (N)
            Times (s); beyond the ends those of the ends, which `Solution.sample` refuses.

        Returns
        -------
        q, v, a : ndarray (n) or (N, n)
            In rad, m and by s and s^2.

        Raises
        ------
        MotionError
            Before the first solve.
        """
        rows = self._core.states(np.atleast_1d(np.asarray(t, float)))
        rows = rows[0] if np.ndim(t) == 0 else rows
        return rows[..., : self._n], rows[..., self._n : 2 * self._n], rows[..., 2 * self._n :]

    def torques(self, t: ArrayLike) -> _Array:
        """Torques of the motion, cut to their limits.

        Parameters
        ----------
        t : float or array_like (N)
            Times (s); beyond the ends those of the ends, which `Solution.sample` refuses.

        Returns
        -------
        ndarray (n) or (N, n)
            In N m, N.

        Raises
        ------
        MotionError
            Before the first solve.
        """
        rows = self._core.torques(np.atleast_1d(np.asarray(t, float)))
        return rows[0] if np.ndim(t) == 0 else rows

    def feedback(self) -> Feedback | None:
        """Derivatives of the motion by its ends.

        Returns
        -------
        Feedback or None
            None where the motion is no strict minimum.

        Raises
        ------
        MotionError
            Before the first solve.
        StateError
            Where the motion cannot be evaluated.
        """
        found = self._core.feedback()
        return None if found is None else Feedback(found)

    def __repr__(self) -> str:
        return f"Resolve({self._problem!r}, T={self.final_time:.6g} s)"
