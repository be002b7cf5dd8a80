"""Counting what is done, on standard error."""

from __future__ import annotations

import sys
import warnings
from typing import Any


def tqdm_or_none() -> Any:
    """The bar of tqdm that fits, where tqdm is installed. In a notebook without ipywidgets it is one of text."""
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="IProgress not found")
            from tqdm.auto import tqdm  # type: ignore[import-untyped,import-not-found,unused-ignore]
    except ImportError:
        return None
    return tqdm


class Counter:
    """A bar of tqdm where that is installed, else a line; nothing unless it is shown."""

    def __init__(self, show: bool, total: int, done: int) -> None:
        self.show, self.total, self.done, self.failed = show, total, done, 0
        self.bar: Any = None
        self.said = False
        if show:
            tqdm = tqdm_or_none()
            if tqdm is None:
                return
            self.bar = tqdm(total=total, initial=done, unit=" tasks", desc="costate")

    def add(self, failed: bool) -> None:
        self.done += 1
        self.failed += failed
        if self.bar is not None:
            if self.failed or self.said:
                self.bar.set_postfix_str(f"{self.failed} failed" if self.failed else "", refresh=False)
                self.said = False
            self.bar.update()
        elif self.show:
            print(f"\r\x1b[K{self.done} of {self.total}, {self.failed} failed", end="", file=sys.stderr, flush=True)

    def say(self, text: str) -> None:
        """Beside the bar, until the next task is done."""
        if self.bar is not None:
            self.bar.set_postfix_str(text)
        elif self.show:
            print(f"\r\x1b[K{self.done} of {self.total}, {text}", end="", file=sys.stderr, flush=True)
        self.said = True

    def close(self) -> None:
        if self.bar is not None:
            self.bar.close()
        elif self.show:
            print(file=sys.stderr)
