"""What there is to say about a solution."""

from __future__ import annotations

from typing import Any


class Remark(str):
    """One thing to know about a solution: a text, with what it is about as attributes.

    Parameters
    ----------
    text : str
        The text.

    Attributes
    ----------
    key : str
        "not_solved", "limit_exceeded", "unstable", "saddle", ...; a name that stays the same.
    severity : {"error", "warning", "note"}
        With an error the motion is no solution.
    joint, kind : str or None
        The joint, tool or body, and the kind of limit, or the check that failed.
    time : float or None
        When (s).
    value, limit, excess : float or None
        The number, what it is compared with, and by how much a limit is exceeded.
    unit : str or None
        Their unit.
    """

    key: str
    severity: str
    joint: str | None
    kind: str | None
    time: float | None
    value: float | None
    limit: float | None
    excess: float | None
    unit: str | None

    def __new__(cls, text: str) -> Remark:
        return super().__new__(cls, text)

    @classmethod
    def _of(cls, fields: dict[str, Any]) -> Remark:
        remark = cls(fields["text"])
        for name in ("key", "severity", "joint", "kind", "time", "value", "limit", "excess", "unit"):
            setattr(remark, name, fields.get(name))
        return remark
