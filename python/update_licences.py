"""Writes python/THIRD_PARTY.txt: the licences of the crates that are compiled into the extension.

``python python/update_licences.py [--check]``; needs cargo and the sources of the crates, which every build has fetched.
"""

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "python" / "THIRD_PARTY.txt"
NAMES = ("license", "licence", "copying", "notice", "unlicense")


def crates() -> list[dict]:
    """The crates of other people that the extension links on any system, without those of tests and build scripts."""
    command = ["cargo", "metadata", "--format-version", "1", "--locked"]
    found = json.loads(subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout)
    packages = {package["id"]: package for package in found["packages"]}
    uses = {node["id"]: node["deps"] for node in found["resolve"]["nodes"]}
    (root,) = (package["id"] for package in packages.values() if package["name"] == "costate-python")
    seen, waiting = set(), [root]
    while waiting:
        package = waiting.pop()
        if package in seen:
            continue
        seen.add(package)
        normal = [dep["pkg"] for dep in uses[package] if any(kind["kind"] is None for kind in dep["dep_kinds"])]
        waiting.extend(normal)
    others = [packages[package] for package in seen if packages[package]["source"] is not None]
    return sorted(others, key=lambda package: (package["name"], package["version"]))


def texts(package: dict) -> dict[str, str]:
    """Its licence files, by name."""
    folder = Path(package["manifest_path"]).parent
    files = sorted(path for path in folder.iterdir() if path.is_file() and path.name.lower().startswith(NAMES))
    return {path.name: path.read_text(encoding="utf-8", errors="replace").strip() for path in files}


def page() -> str:
    """The text of the file."""
    known: dict[str, list[str]] = {}
    table = []
    for package in crates():
        label = f"{package['name']} {package['version']}"
        authors = ", ".join(author.split(" <")[0] for author in package["authors"])
        table.append(f"| {label} | {package['license']} | {authors} | {package['repository'] or ''} |")
        for text in texts(package).values():
            known.setdefault("\n".join(line.rstrip() for line in text.splitlines()), []).append(label)
    head = "Software in the extension module\n\nWritten by `python python/update_licences.py`.\n\n"
    rows = "| crate | licence | authors | source |\n|---|---|---|---|\n" + "\n".join(table) + "\n"
    parts = [f"\n## {', '.join(dict.fromkeys(labels))}\n\n````text\n{text}\n````\n" for text, labels in known.items()]
    return head + rows + "".join(parts)


def main() -> None:
    text = page()
    if "--check" in sys.argv:
        if not PAGE.exists() or PAGE.read_text(encoding="utf-8") != text:
            sys.exit("python/THIRD_PARTY.txt is not up to date: python python/update_licences.py")
    else:
        PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
