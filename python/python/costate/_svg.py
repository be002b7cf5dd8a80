"""The picture of a motion in notebooks: positions and torques over time as SVG, without matplotlib."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._costate import Robot
    from ._samples import Samples

    _Array = NDArray[np.float64]

# Colours that can be told apart on white and on black; further joints have them again, with dashes.
_COLOURS = ("#3d7fd6", "#e0762b", "#2fa36b", "#d64550", "#9566cf", "#a8763e", "#d467ad", "#7f8791", "#a9a527", "#22a7bd")
_DASHES = ("", "5 3", "1.5 2.5")
_WIDTH, _HEIGHT = 340.0, 210.0  # Of one plot, with its words.
_LEFT, _TOP, _BOTTOM, _RIGHT = 46.0, 22.0, 20.0, 8.0
_ROW = 15.0  # Height of a row of the legend.
_LETTER = 6.3  # Width of a letter, about.


def motion(samples: Samples, position_limits: _Array, robot: Robot) -> str:
    """Two plots with the limits of the robot as dotted lines, as far as the motion comes near them, and a legend."""
    # Joints whose positions have other names, as those of a quaternion have, come after these.
    names = list(dict.fromkeys([*samples.position_names, *samples.joint_names]))
    efforts = robot.effort_limits * np.array([[-1.0], [1.0]])
    plots = [
        ("q (rad, m)", samples.q, position_limits, samples.position_names),
        ("tau (N m, N)", samples.tau, efforts, samples.joint_names),
    ]
    parts = [
        _plot(k * _WIDTH, title, samples.t, rows, limits, [names.index(name) for name in of])
        for k, (title, rows, limits, of) in enumerate(plots)
    ]
    legend, height = _legend(names)
    width, height = 2 * _WIDTH, _HEIGHT + height
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" width="{width:g}" height="{height:g}"'
    style = 'style="max-width:100%;height:auto" font-family="sans-serif" font-size="11" fill="currentColor"'
    return f'{head} {style} role="img" aria-label="positions and torques over time">{"".join(parts)}{legend}</svg>'


def _stroke(k: int) -> str:
    dash = _DASHES[k // len(_COLOURS) % len(_DASHES)]
    return f'stroke="{_COLOURS[k % len(_COLOURS)]}"' + (f' stroke-dasharray="{dash}"' if dash else "")


def _near(rows: _Array, limits: _Array) -> list[tuple[int, float]]:
    """Joints with those of their limits that they come near: these are drawn."""
    size = float(np.ptp(rows)) if rows.size else 0.0
    pairs = [(k, float(limit)) for k in range(rows.shape[1]) for limit in limits[:, k]]
    return [(k, limit) for k, limit in pairs if math.isfinite(limit) and np.abs(rows[:, k] - limit).min() < 0.2 * size]


def ticks(low: float, high: float, count: int) -> list[float]:
    """Round numbers between two numbers: multiples of 1, 2 or 5 times a power of ten."""
    least = (high - low) / count
    power = 10.0 ** math.floor(math.log10(least))
    step = next(power * part for part in (1, 2, 5, 10) if power * part >= least * (1 - 1e-9))
    return [k * step for k in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def _plot(left: float, title: str, t: _Array, rows: _Array, limits: _Array, strokes: list[int]) -> str:
    drawn = _near(rows, limits)
    values = np.concatenate([rows.ravel(), [limit for _, limit in drawn]])
    low, high = float(values.min()), float(values.max())
    margin = 0.05 * (high - low) or 0.05 * abs(high) or 1.0
    low, high = low - margin, high + margin
    start, end = float(t[0]), float(t[-1])
    x0, x1, y0, y1 = left + _LEFT, left + _WIDTH - _RIGHT, _HEIGHT - _BOTTOM, _TOP

    def x(time: float) -> float:
        return x0 + (time - start) / ((end - start) or 1.0) * (x1 - x0)

    def y(value: float) -> float:
        return y0 + (value - low) / (high - low) * (y1 - y0)

    parts = [f'<text x="{x0:g}" y="{_TOP - 8:g}" font-weight="bold">{escape(title)}</text>']
    for value in ticks(low, high, 5):
        at = y(value)
        parts.append(f'<path d="M{x0:g} {at:.1f}H{x1:g}" stroke="currentColor" stroke-opacity=".15"/>')
        parts.append(f'<text x="{x0 - 5:g}" y="{at + 4:.1f}" text-anchor="end">{value:.4g}</text>')
    for time in ticks(start, end, 5) if end > start else []:
        parts.append(f'<text x="{x(time):.1f}" y="{y0 + 14:g}" text-anchor="middle">{time:.4g}</text>')
    parts.append(f'<text x="{x1:g}" y="{_TOP - 8:g}" text-anchor="end" opacity=".7">t (s)</text>')
    parts.append(f'<path d="M{x0:g} {y0:g}H{x1:g}" stroke="currentColor" stroke-opacity=".5"/>')
    for k, limit in drawn:
        colour = _COLOURS[strokes[k] % len(_COLOURS)]
        path = f'<path class="limit" d="M{x0:g} {y(limit):.1f}H{x1:g}" stroke="{colour}" stroke-dasharray="2 3"/>'
        parts.append(path)
    for k in range(rows.shape[1]):
        points = " ".join(f"{x(float(time)):.1f},{y(float(value)):.1f}" for time, value in zip(t, rows[:, k], strict=True))
        parts.append(f'<polyline class="curve" points="{points}" fill="none" stroke-width="1.6" {_stroke(strokes[k])}/>')
    return "".join(parts)


def _legend(names: list[str]) -> tuple[str, float]:
    """The names of joints under the plots, and the height that they take."""
    parts = []
    x, row = _LEFT, 0
    for k, name in enumerate(names):
        shown = name if len(name) <= 40 else name[:39] + "…"
        width = 28 + _LETTER * len(shown)
        if x > _LEFT and x + width > 2 * _WIDTH:
            x, row = _LEFT, row + 1
        y = _HEIGHT + 12 + _ROW * row
        parts.append(f'<path d="M{x:g} {y - 4:g}h16" stroke-width="2" {_stroke(k)}/>')
        parts.append(f'<text x="{x + 20:g}" y="{y:g}">{escape(shown)}</text>')
        x += width
    return "".join(parts), 18 + _ROW * row
