//! Names that Rust and C both accept.

use super::error::CodegenError;

/// Words that mean something in Rust or C, or that generated code uses itself.
const TAKEN: &str = "\
    as async await box break const continue crate dyn else enum extern false fn for gen if impl in let \
    loop match mod move mut pub ref return self static struct super trait true try type unsafe use where \
    while yield abstract become do final macro override priv typeof unsized virtual union auto case char \
    default double float goto inline int long register restrict short signed sizeof switch typedef \
    unsigned void volatile sin cos sqrt exp expm1 fma main f64 core std sin_cos recip exp_m1 less select \
    mul_add plus times from_f64 bool u32 i64 memcpy _ sin_cos_in_range";

/// Names that `math.h` declares or defines: no names of functions.
const MATH: &str = "\
    acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cosh erf erfc exp2 fabs fdim floor fmax \
    fmin fmod fpclassify frexp hypot ilogb isfinite isgreater isgreaterequal isinf isless islessequal \
    islessgreater isnan isnormal isunordered ldexp lgamma llrint llround log log10 log1p log2 logb lrint \
    lround modf nan nearbyint nextafter nexttoward pow remainder remquo rint round scalbln scalbn \
    signbit sinh tan tanh tgamma trunc j0 j1 jn y0 y1 yn gamma drem scalb significand sincos exp10 pow10 \
    finite signgam float_t double_t math_errhandling roundeven fmaximum fminimum llogb getpayload \
    canonicalize totalorder";

fn lists(words: &str, name: &str) -> bool {
    words.split(' ').any(|word| word == name)
}

/// Whether Rust and C both accept it as a name.
fn is_name(name: &str) -> bool {
    let mut characters = name.chars();
    characters.next().is_some_and(|first| first.is_ascii_lowercase() || first == '_')
        && characters.all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
        && !name.starts_with("__")
        && !lists(TAKEN, name)
}

/// Checks that a program and its arguments and results can have these names in source text.
///
/// # Errors
/// [`CodegenError::Name`] for the first name that cannot be used, or that is used twice.
pub(super) fn check_names<'a>(
    program: &str,
    others: impl Iterator<Item = &'a String> + Clone,
) -> Result<(), CodegenError> {
    let refuse = |what, name: &str| Err(CodegenError::Name { what, name: name.into() });
    if !is_name(program) || lists(MATH, program) {
        return refuse("the function", program);
    }
    for (k, name) in others.clone().enumerate() {
        let macros = lists(MATH, name) && (name.starts_with("is") || name == "signbit");
        if !is_name(name) || macros || name == program || others.clone().take(k).any(|other| other == name) {
            return refuse("an argument or result", name);
        }
    }
    Ok(())
}

/// A name made from any text: small letters, digits and `_`.
///
/// ```
/// assert_eq!(costate::codegen::name_from("UR5e, left arm"), "ur5e_left_arm");
/// ```
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
