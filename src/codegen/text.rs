//! What source text in every language has: names, numbers, the head.

use super::error::CodegenError;
use super::node::{Id, Node};
use super::program::Program;

/// Most steps of a program that is written down, where nothing else is said: see docs/codegen.md for what compilers take.
pub const DEFAULT_LIMIT: usize = 25_000;

/// Words that mean something in Rust or C, or that generated code uses itself.
const TAKEN: [&str; 96] = [
    "as", "async", "await", "box", "break", "const", "continue", "crate", "dyn", "else", "enum", "extern",
    "false", "fn", "for", "gen", "if", "impl", "in", "let", "loop", "match", "mod", "move", "mut", "pub",
    "ref", "return", "self", "static", "struct", "super", "trait", "true", "try", "type", "unsafe", "use",
    "where", "while", "yield", "abstract", "become", "do", "final", "macro", "override", "priv", "typeof",
    "unsized", "virtual", "union", "auto", "case", "char", "default", "double", "float", "goto", "inline",
    "int", "long", "register", "restrict", "short", "signed", "sizeof", "switch", "typedef", "unsigned",
    "void", "volatile", "sin", "cos", "sqrt", "exp", "expm1", "fma", "main", "f64", "core", "std", "sin_cos",
    "recip", "exp_m1", "less", "select", "mul_add", "plus", "times", "from_f64", "bool", "u32", "i64",
    "memcpy", "_",
];

/// What `math.h` declares or defines: no name for a function beside it.
const MATH: [&str; 88] = [
    "acos",
    "acosh",
    "asin",
    "asinh",
    "atan",
    "atan2",
    "atanh",
    "cbrt",
    "ceil",
    "copysign",
    "cosh",
    "erf",
    "erfc",
    "exp2",
    "fabs",
    "fdim",
    "floor",
    "fmax",
    "fmin",
    "fmod",
    "fpclassify",
    "frexp",
    "hypot",
    "ilogb",
    "isfinite",
    "isgreater",
    "isgreaterequal",
    "isinf",
    "isless",
    "islessequal",
    "islessgreater",
    "isnan",
    "isnormal",
    "isunordered",
    "ldexp",
    "lgamma",
    "llrint",
    "llround",
    "log",
    "log10",
    "log1p",
    "log2",
    "logb",
    "lrint",
    "lround",
    "modf",
    "nan",
    "nearbyint",
    "nextafter",
    "nexttoward",
    "pow",
    "remainder",
    "remquo",
    "rint",
    "round",
    "scalbln",
    "scalbn",
    "signbit",
    "sinh",
    "tan",
    "tanh",
    "tgamma",
    "trunc",
    "j0",
    "j1",
    "jn",
    "y0",
    "y1",
    "yn",
    "gamma",
    "drem",
    "scalb",
    "significand",
    "sincos",
    "exp10",
    "pow10",
    "finite",
    "signgam",
    "float_t",
    "double_t",
    "math_errhandling",
    "roundeven",
    "fmaximum",
    "fminimum",
    "llogb",
    "getpayload",
    "canonicalize",
    "totalorder",
];

/// Whether Rust and C both take it for a name.
fn is_name(name: &str) -> bool {
    let mut characters = name.chars();
    characters.next().is_some_and(|first| first.is_ascii_lowercase() || first == '_')
        && characters.all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
        && !name.starts_with("__")
        && !TAKEN.contains(&name)
}

/// The name of a program and those of its arguments and results can stand in source text, side by side.
pub(super) fn check_names<'a>(
    program: &str,
    others: impl Iterator<Item = &'a String> + Clone,
) -> Result<(), CodegenError> {
    let refuse = |what, name: &str| Err(CodegenError::Name { what, name: name.into() });
    if !is_name(program) || MATH.contains(&program) {
        return refuse("the function", program);
    }
    for (k, name) in others.clone().enumerate() {
        let macros = MATH.iter().any(|math| math == name) && (name.starts_with("is") || name == "signbit");
        if !is_name(name) || macros || name == program || others.clone().take(k).any(|other| other == name) {
            return refuse("an argument or result", name);
        }
    }
    Ok(())
}

/// A name made of any text: small letters, digits and `_`.
pub fn name_from(text: &str) -> String {
    let mut name = String::new();
    for c in text.chars() {
        match c.to_ascii_lowercase() {
            c if c.is_ascii_lowercase() || c.is_ascii_digit() => name.push(c),
            _ if name.ends_with('_') || name.is_empty() => {}
            _ => name.push('_'),
        }
    }
    let name = name.trim_end_matches('_');
    if name.starts_with(|c: char| c.is_ascii_lowercase()) { name.into() } else { format!("robot_{name}") }
}

/// Refuses a program of more steps than the limit.
pub(super) fn check_limit(program: &Program, limit: usize) -> Result<(), CodegenError> {
    let operations = program.steps();
    if operations <= limit {
        return Ok(());
    }
    Err(CodegenError::TooLarge { name: program.name().into(), operations, limit })
}

/// The shortest decimal that is this number, with a point or an exponent.
pub(super) fn number(value: f64) -> String {
    format!("{value:?}")
}

/// What the head of a file says, line by line.
pub(super) fn head(program: &Program) -> Vec<String> {
    let mut lines = program.notes().to_vec();
    lines.push(format!(
        "Generated by costate {}; change what it was made from instead.",
        env!("CARGO_PKG_VERSION")
    ));
    lines.push(String::new());
    let o = program.operations();
    let counts = [
        (o.mul, "mul"),
        (o.add, "add"),
        (o.div, "div"),
        (o.sqrt, "sqrt"),
        (o.sincos, "sincos"),
        (o.exp, "exp"),
        (o.less, "less"),
    ];
    let counts: Vec<String> = counts
        .iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, kind)| format!("{count} {kind}"))
        .collect();
    lines.push(format!(
        "Operations of one call: {}.",
        if counts.is_empty() { "none".into() } else { counts.join(", ") }
    ));
    let meaning = |text: &str| if text.is_empty() { String::new() } else { format!(": {text}") };
    lines.push("Arguments:".into());
    for argument in program.arguments() {
        lines.push(format!("  {}[{}]{}", argument.name, argument.entries, meaning(&argument.meaning)));
    }
    lines.push("Results, matrices row by row:".into());
    for result in program.results() {
        let shape = match (result.rows, result.columns) {
            (rows, 1) => format!("{rows}"),
            (rows, columns) => format!("{rows} x {columns}"),
        };
        lines.push(format!("  {}[{shape}]{}", result.name, meaning(&result.meaning)));
    }
    lines.iter().map(|line| one_line(line)).collect()
}

/// The text without what could end the line of a comment: names of robots and joints may hold anything.
fn one_line(text: &str) -> String {
    let ends = |c: char| c.is_control() || matches!(c, '\u{2028}' | '\u{2029}');
    text.chars().map(|c| if ends(c) { ' ' } else { c }).collect()
}

/// How the nodes of a program are called in its text, and which results each one is.
pub(super) struct Names {
    prefix: String,
    /// Name and index of each input.
    inputs: Vec<(String, usize)>,
    /// `name[index]` of all results that a node is, in rising order.
    targets: Vec<Vec<String>>,
    /// The steps that compute sine and cosine of a node: (sine, cosine).
    angles: Vec<[Option<usize>; 2]>,
}

impl Names {
    pub fn new(program: &Program) -> Self {
        let count = program.nodes().len();
        let mut names = Self {
            prefix: "t".into(),
            inputs: Vec::new(),
            targets: vec![Vec::new(); count],
            angles: vec![[None; 2]; count],
        };
        let taken = |prefix: &str| {
            let arguments = program.arguments().iter().map(|argument| &argument.name);
            arguments.chain(program.results().iter().map(|result| &result.name)).any(|name| {
                name.strip_prefix(prefix).is_some_and(|rest| rest.chars().all(|c| c.is_ascii_digit()))
            })
        };
        while taken(&names.prefix) {
            names.prefix.push('_');
        }
        for argument in program.arguments() {
            names.inputs.extend((0..argument.entries).map(|k| (argument.name.clone(), k)));
        }
        for result in program.results() {
            for (k, id) in result.entries.iter().enumerate() {
                names.targets[id.index()].push(format!("{}[{k}]", result.name));
            }
        }
        for (k, node) in program.nodes().iter().enumerate() {
            match *node {
                Node::Sin(a) => names.angles[a.index()][0] = Some(k),
                Node::Cos(a) => names.angles[a.index()][1] = Some(k),
                _ => {}
            }
        }
        names
    }

    /// `q[3]`.
    pub fn input(&self, k: u32) -> String {
        let (name, index) = &self.inputs[k as usize];
        format!("{name}[{index}]")
    }

    /// The variable that holds a step.
    pub fn step(&self, k: usize) -> String {
        format!("{}{k}", self.prefix)
    }

    /// The results that a node is.
    pub fn targets(&self, k: usize) -> &[String] {
        &self.targets[k]
    }

    /// The steps that compute sine and cosine of a node.
    pub fn angle(&self, id: Id) -> [Option<usize>; 2] {
        self.angles[id.index()]
    }

    /// Whether sine and cosine of some angle are both computed.
    pub fn has_pair(&self) -> bool {
        self.angles.iter().any(|angle| matches!(angle, [Some(_), Some(_)]))
    }

    /// Arguments of which nothing is used.
    pub fn unused(&self, program: &Program) -> Vec<String> {
        let used = |name: &str| {
            let inputs = program.nodes().iter().filter_map(|node| match node {
                Node::Input(k) => Some(&self.inputs[*k as usize].0),
                _ => None,
            });
            inputs.into_iter().any(|used| used == name)
        };
        let names = program.arguments().iter().map(|argument| argument.name.clone());
        names.filter(|name| !used(name)).collect()
    }
}
