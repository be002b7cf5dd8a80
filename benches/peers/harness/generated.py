"""costate's own generated code as competitors: C by the compilers of the others, Rust by rustc."""

import subprocess

import machine
from compiling import build_once, compile_c
from machine import say

QUANTITIES = ("f", "f_x", "y_f_xx")


def codegen(root, robot, language, folder):
    """{coordinates: [file of f, f_x, y_f_xx]}, as far as `costate codegen` writes them."""
    folder.mkdir(exist_ok=True)
    files = {}
    for coordinates in ("hamiltonian", "lagrangian"):
        for quantity in QUANTITIES:
            file = folder / f"{coordinates}_{quantity}.{ {'c': 'c', 'rust': 'rs'}[language] }"
            command = ["cargo", "run", "--locked", "-q", "-p", "costate-cli", "--", "codegen", robot.urdf,
                       "--quantity", quantity, "--coordinates", coordinates, "--lang", language, "--output", file]
            done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
            if done.returncode:
                say(f"no generated {language} for {robot.name}, {coordinates} {quantity}: {done.stderr.strip()[-300:]}")
                break
            files.setdefault(coordinates, []).append(file)
    return files


def build(root, cache, sources, robot):
    """(label, flags, library) of every way to compile the generated code."""
    found = []
    folder = robot.folder / "codegen"
    for coordinates, files in codegen(root, robot, "c", folder).items():
        define = [f"-DPREFIX={robot.name}_{coordinates}", *(["-DLAGRANGIAN"] if coordinates == "lagrangian" else [])]
        for name, c, _ in machine.compilers():
            for fast in ("", " -ffast-math"):
                flags = f"-O3 -march=native{fast}"
                label = f"generated-c-{name}{'-fast' if fast else ''}"
                library = compile_c(cache, f"{robot.name}-{coordinates}-{label}.so", c, flags, define,
                                    sources / "generated.c", files, sources / "peer.h")
                if library:
                    found.append((label, flags, library))
    for coordinates, files in codegen(root, robot, "rust", folder).items():
        library = rust(cache, sources, robot, coordinates, files, folder)
        if library:
            found.append(("generated-rust", "rustc -C opt-level=3 -C target-cpu=native", library))
    return found


def rust(cache, sources, robot, coordinates, files, folder):
    """The Rust text behind functions that C can call, and peers/generated.c around them."""
    prefix = f"{robot.name}_{coordinates}"
    text = ["//! Written by benches/peers/harness/generated.py."]
    for quantity, file in zip(QUANTITIES, files):
        text.append(f'mod {quantity} {{ include!("{file.resolve()}"); }}')
        text.append(c_function(f"{prefix}_{quantity}", coordinates, quantity, robot.n))
    wrapper = folder / f"{coordinates}.rs"
    wrapper.write_text("\n".join(text) + "\n")
    command = ["rustc", "--edition", "2024", "--crate-type", "staticlib", "-C", "opt-level=3", "-C", "target-cpu=native",
               "-C", "panic=abort", "-C", "codegen-units=1", "-A", "warnings", wrapper]
    made = build_once(cache, f"{prefix}-rust.a", command, [wrapper, *files], required=False)
    if made is None:
        return None
    define = [f"-DPREFIX={prefix}", f"-DORDERS={len(files)}", *(["-DLAGRANGIAN"] if coordinates == "lagrangian" else [])]
    command = [machine.compilers()[0][1], "-O3", "-march=native", "-fPIC", "-shared", *define, sources / "generated.c", made,
               "-lm", "-lpthread", "-ldl"]
    return build_once(cache, f"{prefix}-rust.so", command, [sources / "generated.c", made])


def c_function(name, coordinates, quantity, n):
    """An `extern "C"` function with the arguments of the generated one."""
    hamiltonian = coordinates == "hamiltonian"
    arguments = [n, n, n]
    results = [2 * n, 4 * n * n, 4 * n * n] if hamiltonian else [n, 3 * n * n, 4 * n * n, n * n]
    results = results[: {"f": 1, "f_x": 2, "y_f_xx": len(results)}[quantity]]
    if quantity == "y_f_xx":
        arguments.append(2 * n if hamiltonian else n)
    names = [f"a{i}: *const [f64; {size}]" for i, size in enumerate(arguments)]
    names += [f"r{i}: *mut [f64; {size}]" for i, size in enumerate(results)]
    values = [f"&*a{i}" for i in range(len(arguments))] + [f"&mut *r{i}" for i in range(len(results))]
    return (f'#[unsafe(no_mangle)]\npub unsafe extern "C" fn {name}({", ".join(names)}) {{\n'
            f'    unsafe {{ {quantity}::{name}({", ".join(values)}) }}\n}}')
