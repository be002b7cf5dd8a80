"""Messages, and C that is compiled once for the same text and flags."""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[2] / "peers/harness"))

from compiling import build_once  # noqa: E402, F401
from machine import compilers, first_line, say, stop  # noqa: E402, F401
