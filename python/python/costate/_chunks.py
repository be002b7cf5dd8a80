"""Which tasks of a sweep are sent next, and how many of them at once."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from math import isfinite

# What a chunk that is not given should take (s), and the most tasks of it.
_SECONDS, _MOST = 0.5, 100
# Chunks that each worker gets at least, and the workers of an executor that does not say how many it has.
_SHARE, _ASSUMED = 4, 64


class Chunks:
    """Tasks that wait, by their indices.

    Unless their number is given, chunks begin with one task and grow with the measured times of tasks.
    """

    def __init__(self, indices: Iterable[int], chunk: int | None = None) -> None:
        self.waiting, self.chunk = deque(indices), chunk
        self.single: deque[int] = deque()  # Go one by one.
        self.seconds: float | None = None  # Of a task, of late.

    def __len__(self) -> int:
        return len(self.waiting) + len(self.single)

    def next(self, workers: int) -> list[int]:
        """The tasks to send; 0 is an unknown number of workers."""
        if self.single:
            return [self.single.popleft()]
        size = self.chunk
        if size is None:
            size = 1
            if self.seconds is not None:
                fair = len(self.waiting) // (_SHARE * (workers or _ASSUMED))
                size = max(1, min(_MOST, fair, int(_SECONDS / max(self.seconds, 1e-6))))
        return [self.waiting.popleft() for _ in range(min(size, len(self.waiting)))]

    def again(self, indices: list[int], single: bool = False) -> None:
        """Put tasks in front."""
        (self.single if single else self.waiting).extendleft(reversed(indices))

    def all(self) -> list[int]:
        """All that wait; they wait no more."""
        indices = [*self.single, *self.waiting]
        self.single.clear()
        self.waiting.clear()
        return indices

    def measured(self, seconds: Iterable[float]) -> None:
        """How long the tasks of a chunk took (s)."""
        known = [time for time in seconds if isfinite(time)]
        if known:
            mean = sum(known) / len(known)
            self.seconds = mean if self.seconds is None else (self.seconds + mean) / 2
