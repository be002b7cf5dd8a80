//! C source of functions in the form that CasADi and acados load.

use super::interface::Port;
use crate::codegen::emit::COptions;
use crate::codegen::emit::c::parts;
use crate::codegen::error::CodegenError;
use crate::codegen::program::Program;
use std::collections::BTreeSet;
use std::fmt::Write;

/// A function: its name, its code, and what it is called with. Arguments and results of the code are those
/// ports that have entries.
pub struct External {
    pub name: String,
    pub program: Program,
    pub inputs: Vec<Port>,
    pub outputs: Vec<Port>,
}

/// The source of all of them; `integer` is the type of numbers of entries.
pub fn source(
    functions: &[External],
    integer: &str,
    notes: &[&str],
    options: &COptions,
) -> Result<String, CodegenError> {
    let programs: Vec<Program> = functions.iter().map(|function| function.program.clone()).collect();
    let (runtime, codes) = parts(&programs, options, "static ")?;
    let mut out = String::new();
    let lines: String = notes.iter().map(|line| format!(" * {line}\n")).collect();
    let _ = write!(out, "/*\n{lines} */\n\n{runtime}{}", head(integer));
    let ports = || functions.iter().flat_map(|of| of.inputs.iter().chain(&of.outputs));
    for sparsity in ports().map(Port::sparsity).collect::<BTreeSet<_>>() {
        let numbers: Vec<String> = sparsity.iter().map(ToString::to_string).collect();
        let _ = writeln!(out, "static const casadi_int {}[] = {{{}}};", table(&sparsity), numbers.join(", "));
    }
    let most = ports().filter(|port| port.full).map(|port| port.rows * port.columns).max();
    let _ = writeln!(out, "static const double zeros[{}] = {{0}};", most.unwrap_or(1).max(1));
    for (function, (comment, code)) in functions.iter().zip(codes) {
        let _ = write!(out, "\n{comment}\n{code}\n{}", function.wrapper());
    }
    Ok(out + "\n#ifdef __cplusplus\n}\n#endif\n")
}

fn head(integer: &str) -> String {
    format!(
        "\n#ifdef __cplusplus\nextern \"C\" {{\n#endif\n\n#ifndef casadi_int\n#define casadi_int {integer}\n#endif\n\
         #ifndef CASADI_SYMBOL_EXPORT\n#if defined(_WIN32) || defined(__CYGWIN__)\n\
         #define CASADI_SYMBOL_EXPORT __declspec(dllexport)\n#else\n#define CASADI_SYMBOL_EXPORT\n#endif\n#endif\n\n"
    )
}

/// The name of a table.
fn table(sparsity: &[usize]) -> String {
    let kind = if sparsity.len() == 3 && sparsity[2] == 1 { "dense" } else { "empty" };
    format!("{kind}_{}_{}", sparsity[0], sparsity[1])
}

/// The prefix of everything that is exported.
const EXPORT: &str = "CASADI_SYMBOL_EXPORT ";

impl External {
    /// The functions that are loaded by name.
    fn wrapper(&self) -> String {
        let Self { name, program, inputs, outputs } = self;
        let mut out = String::new();
        let scratch: usize =
            outputs.iter().filter(|port| port.full).map(|port| port.rows * port.columns).sum();
        for (what, ports) in [("in", inputs), ("out", outputs)] {
            let count = ports.len();
            let texts: Vec<String> = ports.iter().map(|port| format!("\"{}\"", port.name)).collect();
            let tables: Vec<String> = ports.iter().map(|port| table(&port.sparsity())).collect();
            let _ = writeln!(out, "{EXPORT}casadi_int {name}_n_{what}(void) {{ return {count}; }}");
            for (kind, result, all) in [
                ("name", "const char *", texts.join(", ")),
                ("sparsity", "const casadi_int *", tables.join(", ")),
            ] {
                let _ = writeln!(
                    out,
                    "{EXPORT}{result}{name}_{kind}_{what}(casadi_int i)\n{{\n    static {result}const all[] = {{{all}}};\n    \
                     return i >= 0 && i < {count} ? all[i] : 0;\n}}"
                );
            }
        }
        let _ = writeln!(
            out,
            "{EXPORT}int {name}_work(casadi_int *sz_arg, casadi_int *sz_res, casadi_int *sz_iw, casadi_int *sz_w)\n{{\n    \
             if (sz_arg) *sz_arg = {};\n    if (sz_res) *sz_res = {};\n    if (sz_iw) *sz_iw = 0;\n    \
             if (sz_w) *sz_w = {scratch};\n    return 0;\n}}",
            inputs.len(),
            outputs.len()
        );
        let full = |ports: &[Port]| -> Vec<(usize, usize)> {
            let ports = ports.iter().enumerate().filter(|(_, port)| port.full);
            ports.map(|(k, port)| (k, port.rows * port.columns)).collect()
        };
        let mut values: Vec<String> =
            full(inputs).iter().map(|(k, _)| format!("arg[{k}] ? arg[{k}] : zeros")).collect();
        let mut start = 0;
        for (k, entries) in full(outputs) {
            values.push(format!("res[{k}] ? res[{k}] : w + {start}"));
            start += entries;
        }
        let _ = writeln!(
            out,
            "{EXPORT}int {name}(const double **arg, double **res, casadi_int *iw, double *w, int mem)\n{{\n    \
             (void)iw;\n    (void)mem;\n    {}(\n        {});\n    return 0;\n}}",
            program.name(),
            values.join(",\n        ")
        );
        out
    }
}
