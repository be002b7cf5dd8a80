//! A program as C source.

use super::text::{DEFAULT_LIMIT, Names, head, number};
use crate::codegen::error::CodegenError;
use crate::codegen::program::Program;
use crate::codegen::record::{Id, Node};

/// How C source is written.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct COptions {
    /// Most steps, [`Program::steps`].
    pub limit: usize,
}

impl Default for COptions {
    fn default() -> Self {
        Self { limit: DEFAULT_LIMIT }
    }
}

impl COptions {
    /// The same with this [`limit`](Self::limit).
    #[must_use]
    pub fn with_limit(self, limit: usize) -> Self {
        Self { limit }
    }
}

/// Several programs as one C99 source: a function on `double` for each, in this order.
///
/// # Errors
/// [`CodegenError::TooLarge`] for a program above the limit; [`CodegenError::Name`] for two of one name.
pub fn c_source(programs: &[Program], options: &COptions) -> Result<String, CodegenError> {
    let (runtime, functions) = parts(programs, options, "")?;
    let one_head = |(head, function): &(String, String)| format!("\n{head}\n{function}");
    Ok(match functions.as_slice() {
        [(head, function)] => format!("{head}\n{runtime}{function}"),
        functions => {
            runtime.trim_end().to_owned() + "\n" + &functions.iter().map(one_head).collect::<String>()
        }
    })
}

/// The declarations of the same functions, with a guard, for C and C++.
///
/// # Errors
/// [`CodegenError::Name`] for two programs of one name.
pub fn c_header(programs: &[Program]) -> Result<String, CodegenError> {
    check_distinct(programs)?;
    let guard = programs.first().map_or("", Program::name).to_uppercase() + "_H";
    let declared = |program: &Program| {
        let declaration = program.declaration().replace("restrict ", "");
        format!("{}{};\n\n", comment(program), declaration.trim_end_matches("\n{\n"))
    };
    let declarations: String = programs.iter().map(declared).collect();
    Ok(format!(
        "#ifndef {guard}\n#define {guard}\n\n#ifdef __cplusplus\nextern \"C\" {{\n#endif\n\n{declarations}\
         #ifdef __cplusplus\n}}\n#endif\n\n#endif\n"
    ))
}

fn check_distinct(programs: &[Program]) -> Result<(), CodegenError> {
    for (k, program) in programs.iter().enumerate() {
        if programs[..k].iter().any(|other| other.name() == program.name()) {
            return Err(CodegenError::Name {
                what: "the second function of this name",
                name: program.name().into(),
            });
        }
    }
    Ok(())
}

/// What all programs need, then the comment and the text of each function, whose declaration begins with
/// `linkage`.
pub(in crate::codegen) fn parts(
    programs: &[Program],
    options: &COptions,
    linkage: &str,
) -> Result<(String, Vec<(String, String)>), CodegenError> {
    check_distinct(programs)?;
    let mut runtime = MUL_ADD.to_owned();
    let mut functions = Vec::new();
    let mut pairs = false;
    for program in programs {
        program.check_limit(options.limit)?;
        let names = Names::new(program);
        pairs |= names.has_pair();
        functions.push((comment(program), linkage.to_owned() + &program.function(&names)));
    }
    if pairs {
        runtime += SIN_COS;
    }
    Ok((runtime, functions))
}

/// The head of a program.
fn comment(program: &Program) -> String {
    let lines: Vec<String> =
        head(program).iter().map(|line| format!(" * {}", safe(line)).trim_end().into()).collect();
    format!("/*\n{}\n */\n", lines.join("\n"))
}

impl Program {
    /// The program as C99 source: one function on `double`, which needs the headers of the standard library
    /// only.
    ///
    /// Arguments and results must not overlap. The same program gives the same text.
    ///
    /// # Errors
    /// [`CodegenError::TooLarge`] for a program above the limit.
    pub fn to_c(&self, options: &COptions) -> Result<String, CodegenError> {
        c_source(std::slice::from_ref(self), options)
    }

    /// The text of the function.
    fn function(&self, names: &Names) -> String {
        let mut out = self.declaration();
        for name in names.unused(self) {
            out += &format!("    (void){name};\n");
        }
        for (k, node) in self.nodes().iter().enumerate() {
            if let Some(line) = self.statement(names, k, *node) {
                out += &format!("    {line}\n");
            }
            if !node.is_leaf() {
                for target in names.targets(k) {
                    out += &format!("    {target} = {};\n", names.step(k));
                }
            }
        }
        for (k, node) in self.nodes().iter().enumerate().filter(|(_, node)| node.is_leaf()) {
            let value = self.operand(names, Id(k as u32));
            let value = if matches!(node, Node::Constant(c) if c.is_sign_negative() && !c.is_nan()) {
                value[1..value.len() - 1].into()
            } else {
                value
            };
            names.targets(k).iter().for_each(|target| out += &format!("    {target} = {value};\n"));
        }
        out + "}\n"
    }

    /// The statement that computes a step; `None` for constants, inputs, and cosines computed with their
    /// sine.
    fn statement(&self, names: &Names, k: usize, node: Node) -> Option<String> {
        if let Node::Sin(a) | Node::Cos(a) = node
            && let [Some(sin), Some(cos)] = names.angle(a)
        {
            let (s, c) = (names.step(sin), names.step(cos));
            return (k == sin.min(cos))
                .then(|| format!("double {s}, {c}; sin_cos({}, &{s}, &{c});", self.operand(names, a)));
        }
        let kind = if matches!(node, Node::Less(..)) { "int" } else { "double" };
        let text = self.expression(names, node)?;
        Some(format!("const {kind} {} = {text};", names.step(k)))
    }

    fn declaration(&self) -> String {
        let arguments = self.arguments().iter().map(|a| format!("    const double *{}", a.name));
        let results = self.results().iter().map(|r| format!("    double *restrict {}", r.name));
        let parameters: Vec<String> = arguments.chain(results).collect();
        format!("void {}(\n{})\n{{\n", self.name(), parameters.join(",\n"))
    }

    /// A value as an operand of an expression.
    fn operand(&self, names: &Names, id: Id) -> String {
        match self.nodes()[id.index()] {
            Node::Constant(value) => constant(value),
            Node::Input(k) => names.input(k),
            _ => names.step(id.index()),
        }
    }

    /// The right side of the statement that computes a step; `None` for constants and inputs.
    fn expression(&self, names: &Names, node: Node) -> Option<String> {
        let of = |id: Id| self.operand(names, id);
        let is_two = |id: Id| self.nodes()[id.index()] == Node::Constant(2.0);
        Some(match node {
            Node::Constant(_) | Node::Input(_) => return None,
            Node::Neg(a) => format!("-{}", of(a)),
            Node::Add(a, b) => format!("{} + {}", of(a), of(b)),
            Node::Sub(a, b) => format!("{} - {}", of(a), of(b)),
            Node::Mul(two, a) | Node::Mul(a, two) if is_two(two) => format!("{} + {}", of(a), of(a)),
            Node::Mul(a, b) => format!("{} * {}", of(a), of(b)),
            Node::Div(a, b) => format!("{} / {}", of(a), of(b)),
            Node::MulAdd(a, b, c) => format!("MUL_ADD({}, {}, {})", of(a), of(b), of(c)),
            Node::MulSub(a, b, c) => format!("MUL_ADD({}, {}, -{})", of(a), of(b), of(c)),
            Node::NegMulAdd(a, b, c) => format!("MUL_ADD(-{}, {}, {})", of(a), of(b), of(c)),
            Node::Sqrt(a) => format!("sqrt({})", of(a)),
            Node::Sin(a) => format!("sin({})", of(a)),
            Node::Cos(a) => format!("cos({})", of(a)),
            Node::Exp(a) => format!("exp({})", of(a)),
            Node::ExpM1(a) => format!("expm1({})", of(a)),
            Node::Less(a, b) => format!("{} < {}", of(a), of(b)),
            Node::Select(mask, a, b) => format!("{} ? {} : {}", of(mask), of(a), of(b)),
        })
    }
}

/// The line without sequences that begin or end a comment.
fn safe(line: &str) -> String {
    line.replace("*/", "* /").replace("/*", "/ *")
}

fn constant(value: f64) -> String {
    match value {
        value if value.is_nan() => "NAN".into(),
        f64::INFINITY => "INFINITY".into(),
        f64::NEG_INFINITY => "(-INFINITY)".into(),
        value if value.is_sign_negative() => format!("({})", number(value)),
        value => number(value),
    }
}

/// A product and a sum, rounded once where that is one instruction.
const MUL_ADD: &str = include_str!("runtime/mul_add.c");

/// Sine and cosine at once, without a call that the compiler cannot inline.
const SIN_COS: &str = include_str!("runtime/sin_cos.c");
