"""Files, tables and pictures of a solution."""

from __future__ import annotations

import json
import warnings
from os import PathLike, fspath
from pathlib import Path as _Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _show, _stage, _viser
from ._errors import ArgumentError, MotionError
from ._motion import Motion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ._samples import Samples


def _folders(given: str | PathLike[str] | Sequence[str | PathLike[str]]) -> list[str | PathLike[str]]:
    """The folders, of which one alone needs no list."""
    return [given] if isinstance(given, (str, PathLike)) else list(given)


class Files(Motion):
    """The part of `Solution` that writes and draws it."""

    def to_json(self) -> str:
        """The JSON object that ``costate optimize --save`` writes."""
        return self._core.json()

    def to_dict(self) -> dict[str, Any]:
        """The same as dictionaries and lists."""
        return json.loads(self.to_json())  # type: ignore[no-any-return]

    def save(self, path: str | PathLike[str], *, rate: float | None = None) -> None:
        """Write the solution: JSON into ``.json``, a table of samples at a rate (Hz) into ``.csv``.

        ``start_from`` of `Problem.solve` and of a problem file, and `load`, read the JSON.

        Parameters
        ----------
        path : path
            The file, whose name ends in ``.json`` or ``.csv``.
        rate : float
            Samples in a second (Hz), for ``.csv`` alone.

        Raises
        ------
        ArgumentError
            For another ending, ``.csv`` without a rate, and ``.json`` with one.
        """
        end = _Path(path).suffix.lower()
        if end not in (".json", ".csv") or (end == ".csv") != (rate is not None):
            error = ArgumentError(f"{fspath(path)}: give a .json file, or a .csv file and rate=")
            error.argument = "path"
            raise error
        text = self.to_json() if rate is None else self.sample(rate).to_csv()
        _Path(path).write_text(text, encoding="utf-8")

    def to_html(
        self,
        path: str | PathLike[str] | None = None,
        *,
        urdf: str | PathLike[str] | None = None,
        package_path: str | PathLike[str] | Sequence[str | PathLike[str]] = (),
    ) -> str:
        """The report: one page with the moving robot in perspective, plots and figures; it needs no network.

        A robot that was read from a URDF looks as its visual models say: boxes, cylinders, spheres, meshes as STL, OBJ and
        COLLADA; links without one are capsules. What cannot be read is a `UserWarning`.

        Parameters
        ----------
        path : path, optional
            Where to write it too.
        urdf : path, optional
            A URDF whose visual models are shown instead.
        package_path : path or sequence of paths
            Folders in which ``package://`` is looked for, before those above the URDF.

        Returns
        -------
        str
            The page.

        Raises
        ------
        ArgumentError
            For a URDF that has no visual model of a link of the robot.
        OSError
            Where the URDF cannot be read.
        """
        page, missing = self._core.html(self._problem.robot, urdf, _folders(package_path))
        for text in missing:
            warnings.warn(text, stacklevel=2)
        if path is not None:
            _Path(path).write_text(page, encoding="utf-8")
        return page

    def to_dataframe(self, rate: float | None = None) -> Any:
        """Samples as a data frame of pandas, as `Samples.to_dataframe` has them.

        Parameters
        ----------
        rate : float, optional
            Samples in a second (Hz); about 200 samples unless given.

        Returns
        -------
        pandas.DataFrame
            A row for each time.

        Raises
        ------
        MotionError
            Where there is no motion.
        """
        return self._samples(rate).to_dataframe()

    def _samples(self, rate: float | None) -> Samples:
        if rate is not None:
            return self.sample(rate)
        if not len(self.t):
            raise MotionError(f"there is no motion: {self.message}")
        return self.sample(times=np.linspace(float(self.t[0]), float(self.t[-1]), 201))

    def plot(self, rate: float | None = None, axes: Any = None) -> Any:
        """Draw q, v, a and tau over time with matplotlib, with the limits of the robot dotted; the four axes.

        Parameters
        ----------
        rate : float, optional
            Samples in a second (Hz); about 200 samples unless given.
        axes : array of matplotlib axes (4), optional
            Where to draw; a new figure unless given.

        Returns
        -------
        array of matplotlib axes (4)
            Those of q, v, a and tau.

        Raises
        ------
        MotionError
            Where there is no motion.
        """
        return _show.plot(self._samples(rate), self._problem.robot, axes)

    def to_viser(
        self,
        rate: float | None = None,
        server: Any = None,
        *,
        name: str = "robot",
        loop: bool = True,
        urdf: str | PathLike[str] | None = None,
        package_path: str | PathLike[str] | Sequence[str | PathLike[str]] = (),
    ) -> Any:
        """Show the motion in a browser, with viser installed: the robot, where it starts and ends, tools with their paths,
        obstacles, and a time slider.

        Parameters
        ----------
        rate : float, optional
            Samples in a second (Hz); about 200 samples unless given.
        server : viser.ViserServer, optional
            Where it is shown; a new server on port 8080, or the next one that is free.
        name : str
            Of this robot in the scene, for several in one server.
        loop : bool
            Whether the motion begins again at its end.
        urdf, package_path
            What the robot looks like, as in `to_html`.

        Returns
        -------
        viser.ViserServer
            It serves until ``stop()``.
        """
        samples = self._samples(rate)
        text, missing = self._core.stage(self._problem.robot, urdf, _folders(package_path))
        for line in missing:
            warnings.warn(line, stacklevel=2)
        return _viser.show(samples, self._problem.robot, _stage.Stage(text), server, name, loop)
