//! A program as Rust source.

use super::error::CodegenError;
use super::node::{Id, Node};
use super::program::Program;
use super::text::{DEFAULT_LIMIT, Names, check_limit, head, number};

/// How Rust source is written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RustOptions {
    /// Path of the trait of numbers, such as `costate::scalar::Scalar`; `None` for one that the text defines itself, and
    /// implements for `f64`. Its methods are among those of [`Scalar`](crate::scalar::Scalar).
    pub number: Option<String>,
    /// Most steps, [`Program::steps`].
    pub limit: usize,
}

impl Default for RustOptions {
    fn default() -> Self {
        Self { number: None, limit: DEFAULT_LIMIT }
    }
}

impl Program {
    /// The program as Rust source: one function that is generic over the number, and the trait it asks for.
    ///
    /// Arguments are references to arrays, so no index is checked; the same program gives the same text. It stands as a
    /// module of its own or in an `include!`.
    ///
    /// # Errors
    /// [`CodegenError::TooLarge`]; [`CodegenError::Name`] where the trait of numbers is no path.
    pub fn to_rust(&self, options: &RustOptions) -> Result<String, CodegenError> {
        check_limit(self, options.limit)?;
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
            "/// See the head of this text.\n#[rustfmt::skip]\n\
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

    /// The statement that computes a step; `None` for what is there already.
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

/// Whether it is names with `::` between them.
fn is_path(path: &str) -> bool {
    let is_name = |name: &str| {
        name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
            && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
    };
    path.strip_prefix("::").unwrap_or(path).split("::").all(is_name)
}

/// The trait of numbers, and what it is for `f64`.
const NUMBER: &str = "\
/// What the function below asks of a number.
#[allow(dead_code, missing_docs)]
pub trait Number:
    Copy
    + core::ops::Add<Output = Self>
    + core::ops::Sub<Output = Self>
    + core::ops::Mul<Output = Self>
    + core::ops::Div<Output = Self>
    + core::ops::Neg<Output = Self>
{
    /// Outcome of a comparison.
    type Mask: Copy;
    fn from_f64(value: f64) -> Self;
    fn times(self, factor: f64) -> Self;
    fn plus(self, term: f64) -> Self;
    fn mul_add(self, factor: Self, term: Self) -> Self;
    fn recip(self) -> Self;
    fn sqrt(self) -> Self;
    fn sin_cos(self) -> (Self, Self);
    fn exp(self) -> Self;
    fn exp_m1(self) -> Self;
    fn less(self, other: Self) -> Self::Mask;
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self;
}

#[rustfmt::skip]
#[allow(clippy::all, clippy::pedantic)]
impl Number for f64 {
    type Mask = bool;
    #[inline(always)]
    fn from_f64(value: f64) -> Self { value }
    #[inline(always)]
    fn times(self, factor: f64) -> Self { self * factor }
    #[inline(always)]
    fn plus(self, term: f64) -> Self { self + term }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        if cfg!(any(target_feature = \"fma\", target_arch = \"aarch64\")) {
            f64::mul_add(self, factor, term)
        } else {
            self * factor + term
        }
    }
    #[inline(always)]
    fn recip(self) -> Self { 1.0 / self }
    #[inline(always)]
    fn sqrt(self) -> Self { f64::sqrt(self) }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        if !(self.abs() < 1e5) {
            return f64::sin_cos(self);
        }
        // k = the nearest multiple of pi/2, whose last bits are in the lowest digits of k + 1.5 2^52; r = what is beyond.
        let shifted = Number::mul_add(self, core::f64::consts::FRAC_2_PI, 6755399441055744.0);
        let (k, quarter) = (shifted - 6755399441055744.0, shifted.to_bits());
        let r = Number::mul_add(-k, 2.0222662487959506e-21, Number::mul_add(
            -k, 6.077100506303966e-11, Number::mul_add(-k, 1.5707963267341256, self)));
        // Taylor series, |r| <= pi/4: to r^15 and r^16.
        let z = r * r;
        let mut s = -1.0 / 1307674368000.0;
        for c in [1.0 / 6227020800.0, -1.0 / 39916800.0, 1.0 / 362880.0, -1.0 / 5040.0, 1.0 / 120.0, -1.0 / 6.0] {
            s = Number::mul_add(s, z, c);
        }
        let mut c = 1.0 / 20922789888000.0;
        for d in [
            -1.0 / 87178291200.0, 1.0 / 479001600.0, -1.0 / 3628800.0, 1.0 / 40320.0, -1.0 / 720.0, 1.0 / 24.0,
        ] {
            c = Number::mul_add(c, z, d);
        }
        let (s, c) = (Number::mul_add(r * z, s, r), Number::mul_add(z * z, c, Number::mul_add(-0.5, z, 1.0)));
        let (s, c) = if quarter & 1 == 0 { (s, c) } else { (c, s) };
        let negate = |x: f64, quarter: u64| f64::from_bits(x.to_bits() ^ ((quarter & 2) << 62));
        (negate(s, quarter), negate(c, quarter.wrapping_add(1)))
    }
    #[inline(always)]
    fn exp(self) -> Self { f64::exp(self) }
    #[inline(always)]
    fn exp_m1(self) -> Self { f64::exp_m1(self) }
    #[inline(always)]
    fn less(self, other: Self) -> bool { self < other }
    #[inline(always)]
    fn select(mask: bool, if_true: Self, if_false: Self) -> Self { if mask { if_true } else { if_false } }
}

";
