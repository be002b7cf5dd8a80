"""Checks the source distribution without building it again: ``python python/check_sdist.py [SDIST]``.

Without an argument maturin makes one in target/sdist. What is checked, after ``pip install ./python`` has built the
extension in target/release:

- every file that the compiler read for the extension is in it, byte for byte (cargo lists them in ``lib_costate.d``);
- every module, stub and test of the package is in it;
- its manifests are complete: cargo resolves the workspace that it holds without a network, to versions of Cargo.lock;
- the licences that the recipe for conda names are at these places, and rattler-build accepts its fields.

It shows that the files are there. That they build is shown by ``pip install target/sdist/*.tar.gz``, once for a release.
"""

import json
import re
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LISTED = ROOT / "target" / "release" / "lib_costate.d"


def read_by_the_compiler() -> list[Path]:
    """The files of this repository that the extension was compiled from."""
    if not LISTED.exists():
        sys.exit(f"{LISTED} does not exist: pip install ./python")
    words = re.split(r"(?<!\\) ", LISTED.read_text(encoding="utf-8").splitlines()[0].split(": ", 1)[1])
    files = [Path(word.replace("\\ ", " ")) for word in words]
    return [path.relative_to(ROOT) for path in files if path.is_relative_to(ROOT) and "target" not in path.parts]


def in_the_sdist(path: Path) -> Path:
    """Where the sdist has a file of this repository: maturin puts the package beside its manifest."""
    parts = path.parts
    return Path("python", *parts[2:]) if parts[:2] == ("python", "python") else path


def package() -> list[Path]:
    folder = ROOT / "python"
    files = [*(folder / "python").rglob("*.py*"), *(folder / "python").rglob("py.typed"), *(folder / "tests").glob("*.py")]
    return [path.relative_to(ROOT) for path in files if "__pycache__" not in path.parts and path.suffix != ".pyc"]


def manifests(inside: Path) -> list[str]:
    """What is wrong with the manifests. The lock file has more packages than the members that are left need."""
    command = ["cargo", "metadata", "--format-version", "1", "--offline", "--manifest-path", inside / "python" / "Cargo.toml"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        return [done.stderr]
    locked = set(re.findall(r'^name = "(.*)"\nversion = "(.*)"$', (ROOT / "Cargo.lock").read_text(encoding="utf-8"), re.M))
    packages = json.loads(done.stdout)["packages"]
    found = {(package["name"], package["version"]) for package in packages if package["source"] is not None}
    return [f"{name} {version} is not the version of Cargo.lock" for name, version in sorted(found - locked)]


def recipe(inside: Path) -> list[str]:
    """What is wrong with the recipe for conda."""
    try:
        from rattler_build import RecipeParseError, Stage0Recipe
    except ImportError:
        print("py-rattler-build is not installed: the recipe for conda is not checked")
        return []
    try:
        content = Stage0Recipe.from_file(ROOT / "python" / "conda" / "recipe.yaml").to_dict()
    except RecipeParseError as error:
        return [f"recipe.yaml: {error}"]
    wrong = []
    version = re.search(r"^Version: (.*)$", (inside / "PKG-INFO").read_text(encoding="utf-8"), re.M)
    if version is None or content["context"]["version"] != version[1]:
        wrong.append(f"recipe.yaml has the version {content['context']['version']}, the sdist {version and version[1]}")
    wrong += [f"recipe.yaml: {name} is not in the sdist" for name in content["about"]["license_file"] if not (inside / name).is_file()]
    needed = {re.split(r"[ >=<]", line)[0] for line in content["requirements"]["run"]} - {"python"}
    asked = {re.split(r"[ >=<;]", line)[0] for line in re.findall(r"^Requires-Dist: ([^;\n]*)$", (inside / "PKG-INFO").read_text(), re.M)}
    return wrong if needed == asked else [*wrong, f"recipe.yaml runs with {sorted(needed)}, the sdist with {sorted(asked)}"]


def main() -> None:
    if len(sys.argv) > 1:
        sdist = Path(sys.argv[1])
    else:
        folder = ROOT / "target" / "sdist"
        command = ["maturin", "sdist", "--manifest-path", ROOT / "python" / "Cargo.toml", "--out", folder]
        subprocess.run(command, check=True, capture_output=True)
        sdist = max(folder.glob("*.tar.gz"), key=lambda path: path.stat().st_mtime)
    with tempfile.TemporaryDirectory() as name, tarfile.open(sdist) as archive:
        archive.extractall(name, filter="data")
        (inside,) = Path(name).iterdir()
        compiled = read_by_the_compiler()
        files = [*compiled, *package(), Path("Cargo.lock"), Path("python", "Cargo.toml")]
        # Manifests are rewritten: members that are not needed are left out of the workspace.
        same = lambda path: path.suffix in (".toml", ".lock") or (ROOT / path).read_bytes() == (inside / in_the_sdist(path)).read_bytes()
        lacking = [str(path) for path in files if not (inside / in_the_sdist(path)).is_file()]
        wrong = [f"{path} is not in the sdist" for path in lacking]
        wrong += [f"{path} is another file in the sdist" for path in files if str(path) not in lacking and not same(path)]
        if len(compiled) < 100:
            wrong.append(f"{LISTED} lists {len(compiled)} files")
        wrong += manifests(inside)
        wrong += recipe(inside)
    if wrong:
        sys.exit("\n".join(wrong))
    print(f"{sdist.name}: {len(files)} files, {len(compiled)} of them read by the compiler; manifests and recipe fit")


if __name__ == "__main__":
    main()
