"""Compilers, called once for the same sources and flags."""

import functools
import hashlib
import subprocess
from pathlib import Path

from machine import first_line, say, stop

# Generated code of a hundred thousand lines keeps a compiler busy; what takes longer than this is left out.
SECONDS = 900


@functools.cache
def compiler_version(compiler):
    return first_line(compiler, "--version")


def build_once(cache, name, command, inputs, required=True):
    """Runs a command with `-o` a file; None where it fails and may. The name of the file holds a digest of command,
    version of the compiler and inputs, so what has changed is made again."""
    command = [str(part) for part in command]
    digest = hashlib.sha256(" ".join([*command, compiler_version(command[0])]).encode())
    for path in inputs:
        digest.update(Path(path).read_bytes())
    folder = cache / "build"
    folder.mkdir(exist_ok=True)
    target = folder / f"{digest.hexdigest()[:12]}-{name}"
    failed = target.with_name(target.name + ".failed")
    if target.exists():
        return target
    if failed.exists():
        return None
    say(f"compiling {name}")
    try:
        done = subprocess.run([*command, "-o", str(target)], capture_output=True, text=True, check=False,
                              timeout=SECONDS)
        message = done.stderr if done.returncode else ""
    except subprocess.TimeoutExpired:
        message = f"not done after {SECONDS} s"
    if not message:
        return target
    target.unlink(missing_ok=True)
    if required:
        stop(f"cannot compile {name}:\n{message[-2000:]}")
    failed.write_text(message)
    say(f"left out: {name}: {message[-200:]}")
    return None


def compile_c(cache, name, compiler, flags, defines, wrapper, orders, header):
    """One competitor from generated C: a file for each order of derivative, as many as can be compiled, and the wrapper."""
    common = [compiler, "-std=gnu11", *flags.split(), "-w", "-fPIC"]
    objects = []
    for source in orders:
        made = build_once(cache, f"{Path(name).stem}-{source.stem}.o", [*common, "-c", source], [source], required=False)
        if made is None:
            break
        objects.append(made)
    if not objects:
        return None
    command = [*common, *defines, f"-DORDERS={len(objects)}", "-shared", "-I", header.parent, wrapper, *objects, "-lm"]
    return build_once(cache, name, command, [wrapper, header, *objects])
