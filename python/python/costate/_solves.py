"""Solving a problem."""

from __future__ import annotations

import warnings
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any, Literal, cast

from . import _run
from ._branch import Branch
from ._costate import _Problem
from ._errors import Interrupted, LimitWarning
from ._solution import Solution
from ._tables import text_of

if TYPE_CHECKING:
    from ._problem import Problem
    from ._program import Program
    from ._resolve import Resolve

    _Path = str | PathLike[str]


class Solves:
    """The part of `Problem` that solves it."""

    __slots__ = ()
    _core: _Problem

    def solve(
        self,
        *,
        tolerance: float | None = None,
        starts: int | None = None,
        seed: int | None = None,
        threads: int | None = None,
        nodes: int | None = None,
        max_nodes: int | None = None,
        time_limit: float | None = None,
        method: Literal["direct", "collocation", "shooting"] | None = None,
        verify: Literal["full", "factors", "none"] | None = None,
        polish: Literal["auto"] | bool | None = None,
        machine_code: Literal["later", "at_once", "never"] | None = None,
        jacobian: Literal["exact", "differences", "without_hessian"] | None = None,
        coordinates: Literal["qp", "qv", "hamiltonian", "lagrangian"] | None = None,
        start_from: Solution | _Path | None = None,
        progress: _run._Progress = None,
        on_interrupt: Literal["raise", "return"] = "raise",
        stage_times: bool = False,
    ) -> Solution:
        """Solve the problem.

        Without the interpreter's lock, on a thread of its own. Debug records of the logger ``"costate"`` tell each
        Newton step, an info record how the solve ended. Ctrl-C ends it before its next Newton step, and the best
        motion so far is kept; a second Ctrl-C does not wait for that.

        Parameters
        ----------
        tolerance, starts, seed, threads, nodes, max_nodes, time_limit, method, verify, polish
        machine_code, jacobian, coordinates
            Options in the place of those of ``[solver]``: ``tolerance`` of the cost (direct method: relative to it, 1e-4;
            indirect methods 1e-6), number of guesses ``starts`` that are solved to the end (not given: the best one of
            several that are looked at roughly), ``seed`` of their disturbances and ``threads`` (0: all), ``nodes`` of the
            first mesh (21) and ``max_nodes`` (6001), ``time_limit`` in s (inf: none), ``method`` ("direct"), ``verify``
            ("full"), ``polish`` ("auto"), ``machine_code`` of the dynamics ("later"). For comparison, of the indirect
            methods: ``jacobian`` ("exact"), ``coordinates`` "qp" ("hamiltonian") or "qv" ("lagrangian").
        start_from : Solution or path, optional
            Begins at this motion, of a robot with these joints, or at one that was saved.
        progress : None, True or function
            True shows a bar (of tqdm, if installed). A function is called with each `Iteration`, on this thread, at most
            0.05 s later. If it returns something true it is not called any more, and the solve ends before its next
            Newton step with the status ``"cancelled"``, unless it has ended meanwhile, as those of small problems have.
        on_interrupt : {"raise", "return"}
            After Ctrl-C raise `Interrupted`, a KeyboardInterrupt with the best motion in ``solution``; or return it.
        stage_times : bool
            Measure where the time goes.

        Returns
        -------
        Solution
            Its ``status`` says how it ended. An unsolved problem is no error: ``solution.check()`` makes it one. With a
            `LimitWarning` where the problem says nothing about limits and the motion exceeds those of the robot.

        Raises
        ------
        ProblemError
            With ``key``: an option out of range, or a problem that the method does not take.
        Interrupted
            After Ctrl-C.
        """
        _run.check_on_interrupt(on_interrupt)
        options: dict[str, Any] = {"tolerance": tolerance, "starts": starts, "seed": seed, "threads": threads}
        options |= {"nodes": nodes, "max_nodes": max_nodes, "time_limit": time_limit, "method": method}
        options |= {"verify": verify, "polish": polish}
        options |= {"machine_code": machine_code, "jacobian": jacobian, "coordinates": coordinates}
        show = _run.logger.isEnabledFor(10)
        collect = show or progress not in (None, False)
        run = self._core.begin(text_of(options), _start(start_from), collect=collect, times=stage_times)
        found, interrupted = _run.finish(run, progress, show)
        solution = Solution._of(found, cast("Problem", self))
        figures = (solution.status, solution.cost, solution.final_time, solution.seconds)
        _run.logger.info("%s, cost %.9g, T %.6g s, solved in %.3g s", *figures)
        for remark in solution.warnings:
            _run.logger.log(20 if remark.severity == "note" else 30, "%s", remark)
        exceeded = [remark for remark in solution.warnings if remark.key == "robot_limit"]
        if exceeded:
            # Without numbers, so that Python tells it once of many problems.
            names = ", ".join(warning.split(" runs from")[0] for warning in exceeded)
            text = f"the motion exceeds limits of the robot that it was not asked to keep ({names}; see .warnings): "
            text += "limits=True keeps them, limits=False leaves them out without this warning"
            warnings.warn(text, LimitWarning, stacklevel=2)
        if interrupted and on_interrupt == "raise":
            raise Interrupted(solution)
        return solution

    def follow(
        self,
        parameter: str,
        first: float,
        last: float,
        *,
        start_from: Solution | _Path | None = None,
        progress: _run._Progress = None,
        on_interrupt: Literal["raise", "return"] = "raise",
        **options: Any,
    ) -> Branch:
        """Follow the solution by collocation while a parameter changes, around turning points: `--continue`.

        Parameters
        ----------
        parameter : str
            One of `with_parameter`, or "smoothing".
        first, last : float
            Its values.
        start_from, progress, on_interrupt, **options
            As in `solve`.

        Returns
        -------
        Branch
            Its ``end`` says whether the last value was reached.

        Raises
        ------
        ProblemError
            With ``key``: for a parameter or an option that the problem does not have.
        Interrupted
            After Ctrl-C, with the last solution in ``solution``.

        References
        ----------
        E. L. Allgower, K. Georg, Introduction to Numerical Continuation Methods, 2003.
        """
        _run.check_on_interrupt(on_interrupt)
        show = _run.logger.isEnabledFor(10)
        collect = show or progress not in (None, False)
        run = self._core.follow(parameter, first, last, text_of(options), _start(start_from), collect=collect)
        found, interrupted = _run.finish(run, progress, show)
        branch = Branch._of(run.branch(), found, cast("Problem", self), parameter, first)
        if interrupted and on_interrupt == "raise":
            raise Interrupted(branch.solution)
        return branch

    def resolve(self, **options: Any) -> Resolve:
        """Prepare the problem for being solved again and again.

        Parameters
        ----------
        **options
            As in `Resolve`.

        Returns
        -------
        Resolve
            ``Resolve(self, **options)``.

        Raises
        ------
        ProblemError
            With ``key``: a problem that cannot be solved again, or an option that is refused.
        """
        from ._resolve import Resolve

        return Resolve(cast("Problem", self), **options)

    def nlp(self, **options: Any) -> Program:
        """The nonlinear program of the motion on one mesh, with exact derivatives, for IPOPT and other solvers.

        Parameters
        ----------
        **options
            As in `Program`: ``nodes``, the number of points of the mesh with both ends.

        Returns
        -------
        Program
            ``Program(self, **options)``.

        Raises
        ------
        ProblemError
            With ``key``: what is refused; floating and spherical joints.
        """
        from ._program import Program

        return Program(cast("Problem", self), **options)


def _start(given: Solution | _Path | None) -> Any:
    return given._core if isinstance(given, Solution) else given and fspath(given)
