//! A program as Rust source.

use super::text::{DEFAULT_LIMIT, Names, head, number};
use crate::codegen::error::CodegenError;
use crate::codegen::program::Program;
use crate::codegen::record::{Id, Node};

/// How Rust source is written.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct RustOptions {
    /// Path of the trait of numbers, such as `costate::scalar::Scalar`; `None` for a trait that the text
    /// itself defines and implements for `f64`. Its methods are a subset of those of
    /// [`Scalar`](crate::scalar::Scalar).
    pub number: Option<String>,
    /// Most steps, [`Program::steps`].
    pub limit: usize,
}

impl Default for RustOptions {
    fn default() -> Self {
        Self { number: None, limit: DEFAULT_LIMIT }
    }
}

impl RustOptions {
    /// The same with this path of the [trait of numbers](Self::number).
    #[must_use]
    pub fn with_number(self, number: Option<String>) -> Self {
        Self { number, ..self }
    }

    /// The same with this [`limit`](Self::limit).
    #[must_use]
    pub fn with_limit(self, limit: usize) -> Self {
        Self { limit, ..self }
    }
}

impl Program {
    /// The program as Rust source: one function that is generic over the number, and the trait that it needs.
    ///
    /// Arguments are references to arrays, so no index is checked at run time. The same program gives the
    /// same text. Use it as a module or in an `include!`.
    ///
    /// # Errors
    /// [`CodegenError::TooLarge`] for a program above the limit; [`CodegenError::Name`] where the trait of
    /// numbers is not a path.
    pub fn to_rust(&self, options: &RustOptions) -> Result<String, CodegenError> {
        self.check_limit(options.limit)?;
        if let Some(path) = options.number.as_deref().filter(|path| !is_path(path)) {
            return Err(CodegenError::Name { what: "the trait of numbers", name: path.into() });
        }
        let lines: Vec<String> =
            head(self).iter().map(|line| format!("// {line}").trim_end().into()).collect();
        let mut out = lines.join("\n") + "\n\n";
        if options.number.is_none() {
            out += NUMBER;
        }
        out += &self.signature(options.number.as_deref().unwrap_or("Number"));
        let names = Names::new(self);
        for (k, node) in self.nodes().iter().enumerate() {
            if let Some(line) = self.line(&names, k, *node) {
                out += &format!("    {line}\n");
            }
            if !node.is_leaf() {
                for target in names.targets(k) {
                    out += &format!("    {target} = {};\n", names.step(k));
                }
            }
        }
        for (k, node) in self.nodes().iter().enumerate().filter(|(_, node)| node.is_leaf()) {
            let value = self.value(&names, Id(k as u32), *node);
            names.targets(k).iter().for_each(|target| out += &format!("    {target} = {value};\n"));
        }
        Ok(out + "}\n")
    }

    fn signature(&self, number: &str) -> String {
        let arguments = self.arguments().iter().map(|a| format!("    {}: &[T; {}],\n", a.name, a.entries));
        let results =
            self.results().iter().map(|r| format!("    {}: &mut [T; {}],\n", r.name, r.entries.len()));
        let parameters: String = arguments.chain(results).collect();
        format!(
            "/// See the comment at the head of this source.\n#[rustfmt::skip]\n\
             #[allow(unused_variables, unused_parens, clippy::all, clippy::pedantic)]\n\
             pub fn {}<T: {number}>(\n{parameters}) {{\n",
            self.name()
        )
    }

    fn value(&self, names: &Names, id: Id, node: Node) -> String {
        match node {
            Node::Constant(value) => format!("T::from_f64({})", constant(value)),
            Node::Input(k) => names.input(k),
            _ => names.step(id.index()),
        }
    }

    /// The statement that computes a step; `None` for constants, inputs, and cosines computed with their
    /// sine.
    fn line(&self, names: &Names, k: usize, node: Node) -> Option<String> {
        let known = |id: Id| match self.nodes()[id.index()] {
            Node::Constant(value) => Some(value),
            _ => None,
        };
        let of = |id: Id| self.value(names, id, self.nodes()[id.index()]);
        let text = match node {
            Node::Constant(_) | Node::Input(_) => return None,
            Node::Neg(a) => format!("-{}", of(a)),
            Node::Add(a, b) => match (known(a), known(b)) {
                (_, Some(c)) => format!("{}.plus({})", of(a), constant(c)),
                (Some(c), _) => format!("{}.plus({})", of(b), constant(c)),
                _ => format!("{} + {}", of(a), of(b)),
            },
            Node::Sub(a, b) => match known(b) {
                Some(c) => format!("{}.plus({})", of(a), constant(-c)),
                None => format!("{} - {}", of(a), of(b)),
            },
            Node::Mul(a, b) => match (known(a), known(b)) {
                (Some(2.0), _) => format!("{} + {}", of(b), of(b)),
                (_, Some(2.0)) => format!("{} + {}", of(a), of(a)),
                (Some(c), _) => format!("{}.times({})", of(b), constant(c)),
                (_, Some(c)) => format!("{}.times({})", of(a), constant(c)),
                _ => format!("{} * {}", of(a), of(b)),
            },
            Node::Div(a, b) if known(a) == Some(1.0) => format!("{}.recip()", of(b)),
            Node::Div(a, b) => format!("{} / {}", of(a), of(b)),
            Node::MulAdd(a, b, c) => format!("{}.mul_add({}, {})", of(a), of(b), of(c)),
            Node::MulSub(a, b, c) => format!("{}.mul_add({}, -{})", of(a), of(b), of(c)),
            Node::NegMulAdd(a, b, c) => format!("(-{}).mul_add({}, {})", of(a), of(b), of(c)),
            Node::Sqrt(a) => format!("{}.sqrt()", of(a)),
            Node::Exp(a) => format!("{}.exp()", of(a)),
            Node::ExpM1(a) => format!("{}.exp_m1()", of(a)),
            Node::Less(a, b) => format!("{}.less({})", of(a), of(b)),
            Node::Select(mask, a, b) => format!("T::select({}, {}, {})", of(mask), of(a), of(b)),
            Node::Sin(a) | Node::Cos(a) => return sin_cos(names, k, a, &of(a)),
        };
        Some(format!("let {} = {text};", names.step(k)))
    }
}

/// The first of sine and cosine of one angle computes both.
fn sin_cos(names: &Names, k: usize, angle: Id, of: &str) -> Option<String> {
    match names.angle(angle) {
        [Some(sin), Some(cos)] if k == sin.min(cos) => {
            Some(format!("let ({}, {}) = {of}.sin_cos();", names.step(sin), names.step(cos)))
        }
        [Some(_), Some(_)] => None,
        [sin, _] => {
            let part = if sin.is_some() { 0 } else { 1 };
            Some(format!("let {} = {of}.sin_cos().{part};", names.step(k)))
        }
    }
}

fn constant(value: f64) -> String {
    match value {
        value if value.is_nan() => "f64::NAN".into(),
        f64::INFINITY => "f64::INFINITY".into(),
        f64::NEG_INFINITY => "f64::NEG_INFINITY".into(),
        value => number(value),
    }
}

/// Whether it consists of names with `::` between them.
fn is_path(path: &str) -> bool {
    let is_name = |name: &str| {
        name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
            && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
    };
    path.strip_prefix("::").unwrap_or(path).split("::").all(is_name)
}

/// The trait of numbers with its implementation for `f64`, sine and cosine first.
const NUMBER: &str = concat!(include_str!("runtime/sin_cos.rs"), "\n", include_str!("runtime/number.rs"));
