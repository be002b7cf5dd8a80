"""The guide in `docs/guide`: its Python blocks run in order, notebooks are executed, blocks in Rust are those compiled."""

import importlib.util
import os
import pkgutil
import re
from pathlib import Path

import costate
import pytest

GUIDE = Path(__file__).parents[2] / "docs" / "guide"
NOTEBOOKS = sorted((GUIDE / "notebooks").glob("*.ipynb"))


def _pages():
    spec = importlib.util.spec_from_file_location("pages", GUIDE / "pages.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


pages = _pages()


@pytest.mark.parametrize("page", pages.PAGES, ids=lambda page: page.stem)
def test_blocks_of_a_page(page, tmp_path):
    if not pages.blocks(page):
        pytest.skip("no Python on this page")
    for name in (*pages.needs(page), *(["matplotlib"] if pages.pictures(page) else [])):
        pytest.importorskip(name)
    pages.prepare(tmp_path)
    said = pages.run(page, tmp_path)
    for line, text in pages.printed_on(page).items():
        assert pages.words(text) == pages.words(said[line])
    made = {path.name for path in tmp_path.glob("*.svg")}
    assert made == set(pages.pictures(page))
    assert all((GUIDE / "pictures" / name).exists() for name in made)


def test_every_picture_is_shown():
    shown = {name for page in pages.PAGES for name in pages.pictures(page)}
    assert {path.name for path in (GUIDE / "pictures").iterdir()} == shown


def test_each_page_is_in_the_contents():
    listed = re.findall(r"^[a-z_]+$", (GUIDE / "index.md").read_text(), re.M)
    assert sorted(listed) == sorted(page.stem for page in GUIDE.glob("*.md") if page.stem not in ("index", "README"))


def test_the_reference_has_everything_public():
    """All names of `costate.__all__`, and every module that is not private, once; nothing else."""
    page = (GUIDE / "api_python.md").read_text()
    listed = re.findall(r"^\.\. auto(?:class|function|exception):: (\w+)$", page, re.M)
    assert sorted(listed) == sorted(set(costate.__all__) - {"__version__"})
    # Of classes that are made of parts, the methods of these too.
    classes = [name for name in listed if isinstance(getattr(costate, name), type)]
    made = [name for name in classes if any("costate._" in part.__module__ for part in getattr(costate, name).__mro__)]
    inherited = re.findall(r"^\.\. autoclass:: (\w+)\n   :members:\n   :inherited-members:$", page, re.M)
    assert {"Problem", "Resolve", "Solution"} <= set(made) and sorted(inherited) == sorted(made)
    modules = re.findall(r"^\.\. automodule:: costate\.(\w+)\n   :members:$", page, re.M)
    public = [name for _, name, _ in pkgutil.iter_modules(costate.__path__) if not name.startswith("_")]
    assert sorted(modules) == sorted(public)


def test_links_to_the_rust_reference_are_crates_of_the_library():
    """In the built guide they lead beside it, to what `cargo doc` wrote."""
    page = (GUIDE / "api_rust.md").read_text()
    linked = re.findall(r'href="\.\./\.\./doc/(\w+)/index\.html"', page)
    root = GUIDE.parents[1]
    folders = {"costate": "", "costate_control": "control", "costate_jit": "jit"}
    folders |= {"costate_report": "cli/report", "costate_comparison": "cli/comparison"}
    assert linked == list(folders)
    for name, folder in folders.items():
        assert f'name = "{name.replace("_", "-")}"' in (root / folder / "Cargo.toml").read_text()


def test_rust_on_the_page_is_the_program_that_is_compiled():
    program = re.sub(r"\s+", " ", (GUIDE.parents[1] / "examples" / "tour.rs").read_text())
    found = re.findall(r"^```rust\n(.*?)^```$", (GUIDE / "rust.md").read_text(), re.M | re.S)
    assert len(found) >= 5
    for block in found:
        assert re.sub(r"\s+", " ", block).strip() in program


def test_there_are_notebooks_without_outputs():
    nbformat = pytest.importorskip("nbformat")
    assert {path.name for path in NOTEBOOKS} >= {"tour.ipynb", "limits.ipynb"}
    for path in NOTEBOOKS:
        notebook = nbformat.read(path, 4)
        nbformat.validate(notebook)
        assert not any(cell.get("outputs") for cell in notebook.cells)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_executed(path, monkeypatch):
    for name in ("matplotlib", "nbformat", "ipykernel"):
        pytest.importorskip(name)
    nbclient = pytest.importorskip("nbclient")
    import nbformat

    monkeypatch.setitem(os.environ, "MPLBACKEND", "module://matplotlib_inline.backend_inline")
    notebook = nbformat.read(path, 4)
    resources = {"metadata": {"path": str(path.parent)}}
    nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3", resources=resources).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    assert any("image/png" in output.get("data", {}) for output in outputs)
    assert not any(output.get("name") == "stderr" for output in outputs)
