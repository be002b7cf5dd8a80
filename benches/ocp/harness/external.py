"""What CasADi asks of a function in C that is not its own: sizes of inputs, of the output and of work vectors."""


def interface(name, inputs, output, work):
    """Lines of C; `inputs` are names and shapes, `work` the sizes of vectors of arguments, results, integers and numbers."""
    dense = lambda rows, columns: f"{{{rows}, {columns}, {'1' if rows * columns else ', '.join('0' * (columns + 1))}}}"
    strings = ", ".join(f'"{label}"' for label in inputs)
    sparsities = ", ".join(f"{name}_{label}" for label in inputs)
    return [
        *(f"static const INT {name}_{label}[] = {dense(*shape)};" for label, shape in inputs.items()),
        f"static const INT {name}_result[] = {dense(*output)};",
        f"INT {name}_n_in(void) {{ return {len(inputs)}; }}",
        f"INT {name}_n_out(void) {{ return 1; }}",
        f"const char *{name}_name_in(INT i) {{ static const char *t[] = {{{strings}}}; return i < {len(inputs)} ? t[i] : 0; }}",
        f'const char *{name}_name_out(INT i) {{ return i ? 0 : "entries"; }}',
        f"const INT *{name}_sparsity_in(INT i) {{ static const INT *t[] = {{{sparsities}}}; "
        f"return i < {len(inputs)} ? t[i] : 0; }}",
        f"const INT *{name}_sparsity_out(INT i) {{ return i ? 0 : {name}_result; }}",
        f"int {name}_work(INT *arg, INT *res, INT *iw, INT *w) {{",
        *(f"  if ({label}) *{label} = {size};" for label, size in zip(("arg", "res", "iw", "w"), work)),
        "  return 0;", "}",
    ]
