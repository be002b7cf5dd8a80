//! A program as C source.

use super::error::CodegenError;
use super::node::{Id, Node};
use super::program::Program;
use super::text::{DEFAULT_LIMIT, Names, check_limit, head, number};

/// How C source is written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct COptions {
    /// Most steps, [`Program::steps`].
    pub limit: usize,
}

impl Default for COptions {
    fn default() -> Self {
        Self { limit: DEFAULT_LIMIT }
    }
}

impl Program {
    /// The program as C99 source: one function on `double`, which needs `math.h` and nothing else.
    ///
    /// Arguments and results must not overlap. The same program gives the same text.
    ///
    /// # Errors
    /// [`CodegenError::TooLarge`].
    pub fn to_c(&self, options: &COptions) -> Result<String, CodegenError> {
        check_limit(self, options.limit)?;
        let lines: Vec<String> =
            head(self).iter().map(|line| format!(" * {}", safe(line)).trim_end().into()).collect();
        let names = Names::new(self);
        let mut out = format!("/*\n{}\n */\n\n{FMA}", lines.join("\n"));
        if names.has_pair() {
            out += SIN_COS;
        }
        out += &self.declaration();
        for name in names.unused(self) {
            out += &format!("    (void){name};\n");
        }
        for (k, node) in self.nodes().iter().enumerate() {
            if let Some(line) = self.statement(&names, k, *node) {
                out += &format!("    {line}\n");
            }
            if !node.is_leaf() {
                for target in names.targets(k) {
                    out += &format!("    {target} = {};\n", names.step(k));
                }
            }
        }
        for (k, node) in self.nodes().iter().enumerate().filter(|(_, node)| node.is_leaf()) {
            let value = self.operand(&names, Id(k as u32));
            let value = if matches!(node, Node::Constant(c) if c.is_sign_negative() && !c.is_nan()) {
                value[1..value.len() - 1].into()
            } else {
                value
            };
            names.targets(k).iter().for_each(|target| out += &format!("    {target} = {value};\n"));
        }
        Ok(out + "}\n")
    }

    /// The statement that computes a step; `None` for what is there already.
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

    /// A value that can stand anywhere in an expression.
    fn operand(&self, names: &Names, id: Id) -> String {
        match self.nodes()[id.index()] {
            Node::Constant(value) => constant(value),
            Node::Input(k) => names.input(k),
            _ => names.step(id.index()),
        }
    }

    /// The right side of the statement that computes a step; `None` for what is there already.
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

/// A line that does not end the comment it stands in.
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
const FMA: &str = "\
#include <math.h>

#if defined(__FMA__) || defined(__ARM_FEATURE_FMA) || defined(FP_FAST_FMA)
#define MUL_ADD(a, b, c) fma((a), (b), (c))
#else
#define MUL_ADD(a, b, c) ((a) * (b) + (c))
#endif

";

/// Sine and cosine at once, without a call that the compiler cannot see into.
const SIN_COS: &str = "\
#include <stdint.h>
#include <string.h>

/* Sine and cosine to two units in the last place. */
static inline void sin_cos(double x, double *sine, double *cosine)
{
    static const double s[] = {
        1.0 / 6227020800.0, -1.0 / 39916800.0, 1.0 / 362880.0, -1.0 / 5040.0, 1.0 / 120.0, -1.0 / 6.0};
    static const double c[] = {
        -1.0 / 87178291200.0, 1.0 / 479001600.0, -1.0 / 3628800.0, 1.0 / 40320.0, -1.0 / 720.0, 1.0 / 24.0};
    double turns, k, r, z, p, t;
    uint64_t quarter, swap, sign, bits[2];
    if (!(fabs(x) < 1e5)) {
        *sine = sin(x);
        *cosine = cos(x);
        return;
    }
    /* k: the nearest multiple of pi/2; r: what is beyond it. */
    turns = x * 0.6366197723675814;
    quarter = (uint64_t)(int64_t)(turns + copysign(0.5, turns));
    k = (double)(int64_t)quarter;
    r = MUL_ADD(-k, 1.5707963267341256, x);
    r = MUL_ADD(-k, 6.077100506303966e-11, r);
    r = MUL_ADD(-k, 2.0222662487959506e-21, r);
    /* Taylor series, |r| <= pi/4: to r^15 and r^16. */
    z = r * r;
    p = -1.0 / 1307674368000.0;
    t = 1.0 / 20922789888000.0;
    for (int i = 0; i < 6; i++) {
        p = MUL_ADD(p, z, s[i]);
        t = MUL_ADD(t, z, c[i]);
    }
    p = MUL_ADD(r * z, p, r);
    t = MUL_ADD(z * z, t, MUL_ADD(-0.5, z, 1.0));
    memcpy(&bits[0], &p, sizeof p);
    memcpy(&bits[1], &t, sizeof t);
    swap = (bits[0] ^ bits[1]) & (0 - (quarter & 1));
    sign = (quarter & 2) << 62;
    bits[0] ^= swap ^ sign;
    sign = ((quarter + 1) & 2) << 62;
    bits[1] ^= swap ^ sign;
    memcpy(sine, &bits[0], sizeof p);
    memcpy(cosine, &bits[1], sizeof t);
}

";
