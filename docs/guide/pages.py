"""Runs the Python blocks of the guide's pages: `python docs/guide/pages.py [--write] [PAGE ...]`.

With `--write`, the pictures that they save become those of the guide.
"""

import contextlib
import importlib.util
import io
import os
import re
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

GUIDE = Path(__file__).parent
ROOT = GUIDE.parents[1]
PAGES = [*sorted(GUIDE.glob("*.md")), ROOT / "docs" / "casadi.md", ROOT / "docs" / "sweeps.md"]


def needs(page: Path) -> list[str]:
    """The packages without which a page cannot run."""
    found = re.match(r"<!-- needs: (.*) -->", page.read_text(encoding="utf-8"))
    return found[1].split(", ") if found else ["casadi"] if page.name == "casadi.md" else []


def missing(page: Path) -> list[str]:
    return [name for name in needs(page) if importlib.util.find_spec(name) is None]


def blocks(page: Path) -> list[tuple[int, str]]:
    """The Python blocks of a page with the lines before each, without those that say that they are not run."""
    text = page.read_text(encoding="utf-8")
    found = re.finditer(r"^(<!-- not run: .* -->\n)?```python\n(.*?)^```$", text, re.M | re.S)
    return [(text.count("\n", 0, block.start(2)), block[2]) for block in found if not block[1]]


# A block of Python with the block of text right after it, which is what it prints.
PRINTED = re.compile(r"(^```python\n(?:(?!```)[^\n]*\n)*```\n\n```text\n)(.*?)^```$", re.M | re.S)


def _line(block: re.Match[str]) -> int:
    """The lines before the code of a block."""
    return block.string.count("\n", 0, block.start()) + 1


def printed_on(page: Path) -> dict[int, str]:
    """What the page says that blocks print, by the lines before each."""
    return {_line(block): block[2] for block in PRINTED.finditer(page.read_text(encoding="utf-8"))}


def write_printed(page: Path, said: dict[int, str]) -> None:
    """Writes what blocks print into the page."""
    text = page.read_text(encoding="utf-8")
    page.write_text(PRINTED.sub(lambda block: f"{block[1]}{said[_line(block)]}```", text), encoding="utf-8")


def words(text: str) -> list[str]:
    """What is printed without numbers and blanks, which differ with the processor."""
    return re.sub(r"[-+]?[0-9][0-9.e+-]*", "0", text).split()


def pictures(page: Path) -> list[str]:
    """The pictures that a page shows."""
    return re.findall(r"\]\((?:guide/)?pictures/([a-z_]+\.svg)\)", page.read_text(encoding="utf-8"))


def prepare(folder: Path) -> None:
    """What blocks find in their folder."""
    for name in ("robots", "examples"):
        (folder / name).symlink_to(ROOT / name, target_is_directory=True)


def set_style() -> None:
    """The looks of all pictures."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    style = {"svg.hashsalt": "costate", "svg.fonttype": "none", "font.family": "sans-serif", "figure.figsize": (6.4, 3.6)}
    style |= {"figure.constrained_layout.use": True, "axes.spines.top": False, "axes.spines.right": False}
    plt.rcParams.update(style | {"axes.grid": True, "grid.alpha": 0.3, "figure.facecolor": "white"})


def run(page: Path, folder: Path) -> dict[int, str]:
    """Runs all blocks in one namespace; their pictures are then in the folder. What each printed, by the lines before."""
    said: dict[int, str] = {}
    if pictures(page):
        set_style()
    before = Path.cwd()
    os.chdir(folder)
    sys.path.insert(0, str(folder))
    names: dict[str, object] = {"__name__": "__page__"}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            for line, code in blocks(page):
                # A block that begins with the name of a file is a program, and a module for the blocks after it.
                if program := re.match(r"# (\w+\.py)\n", code):
                    (folder / program[1]).write_text(code, encoding="utf-8")
                    subprocess.run([sys.executable, program[1]], cwd=folder, check=True)
                else:
                    with contextlib.redirect_stdout(io.StringIO()) as out:
                        exec(compile("\n" * line + code, str(page), "exec"), names)
                    said[line] = out.getvalue()
    finally:
        sys.path.remove(str(folder))
        os.chdir(before)
        if pictures(page):
            import matplotlib.pyplot as plt

            plt.close("all")
    return said


def main(arguments: list[str]) -> None:
    write = "--write" in arguments
    chosen = [Path(name).resolve() for name in arguments if name != "--write"] or PAGES
    for page in chosen:
        if missing(page):
            print(f"{page.name}: not run, without {', '.join(missing(page))}")
            continue
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            prepare(folder)
            print(f"{page.name}: {len(blocks(page))} blocks")
            said = run(page, folder)
            for line, text in printed_on(page).items():
                if not write and words(text) != words(said[line]):
                    raise SystemExit(f"{page.name}: the block in line {line} prints\n{said[line]}")
            if write:
                write_printed(page, said)
            for picture in pictures(page):
                made = folder / picture
                if write:
                    text = re.sub(r"\n\s*<metadata>.*?</metadata>", "", made.read_text(encoding="utf-8"), flags=re.S)
                    (GUIDE / "pictures" / picture).write_text(text, encoding="utf-8")
                elif not made.exists():
                    raise SystemExit(f"{page.name}: no block saves {picture}")


if __name__ == "__main__":
    main(sys.argv[1:])
