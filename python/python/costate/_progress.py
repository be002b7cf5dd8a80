"""Counting what is done, on standard error."""

from __future__ import annotations

import sys
from typing import Any


class Counter:
    """A bar of tqdm where that is installed, else a line; nothing unless it is shown."""

    def __init__(self, show: bool, total: int, done: int) -> None:
        self.show, self.total, self.done, self.failed = show, total, done, 0
        self.bar: Any = None
        if show:
            try:
                from tqdm.auto import tqdm  # type: ignore[import-untyped,import-not-found,unused-ignore]
            except ImportError:
                return
            self.bar = tqdm(total=total, initial=done, unit=" tasks", desc="costate")

    def add(self, failed: bool) -> None:
        self.done += 1
        self.failed += failed
        if self.bar is not None:
            if self.failed:
                self.bar.set_postfix_str(f"{self.failed} failed", refresh=False)
            self.bar.update()
        elif self.show:
            print(f"\r\x1b[K{self.done} of {self.total}, {self.failed} failed", end="", file=sys.stderr, flush=True)

    def close(self) -> None:
        if self.bar is not None:
            self.bar.close()
        elif self.show:
            print(file=sys.stderr)
