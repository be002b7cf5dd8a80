//! Motions at a fixed rate: the argument of `--sample`, and the table that `--sample-to` writes.

use crate::terminal;
use costate_control::{Problem, SampleError, Samples, Solution};
use std::fmt::Write;

/// A rate (Hz): `1kHz`, `500Hz`, `1000`.
pub fn rate(text: &str) -> Result<f64, String> {
    let unit = |name: &str| {
        let (head, tail) = text.split_at_checked(text.len().checked_sub(name.len())?)?;
        tail.eq_ignore_ascii_case(name).then(|| head.trim_end())
    };
    let (number, factor) = match (unit("khz"), unit("hz")) {
        (Some(number), _) => (number, 1000.0),
        (None, Some(number)) => (number, 1.0),
        (None, None) => (text, 1.0),
    };
    let rate = number.parse::<f64>().ok().map(|rate| factor * rate);
    rate.filter(|rate| *rate > 0.0 && rate.is_finite())
        .ok_or_else(|| "must be a positive rate, such as 1kHz, 500Hz or 1000 (in Hz)".to_owned())
}

/// The motion at this rate; without samples if there is no motion, with a warning.
///
/// # Errors
/// [`SampleError`], other than for a missing motion.
pub fn sample(problem: &Problem, solution: &Solution, rate: f64) -> Result<Samples, SampleError> {
    match solution.sample(problem, rate) {
        Err(SampleError::NoMotion) => {
            terminal::warning("there is no motion to sample");
            let mut samples = Samples::default();
            samples.rate = rate;
            Ok(samples)
        }
        outcome => outcome,
    }
}

/// One line for each sample after a line of names: t, then q, v, a, tau and u of each joint; with vias the
/// phase, from 1.
pub fn table(samples: &Samples, joints: &[String]) -> String {
    let lists = [("q", &samples.q), ("v", &samples.v), ("a", &samples.a), ("tau", &samples.tau)];
    let lists: Vec<_> = lists.into_iter().chain([("u", &samples.u)]).collect();
    let mut text = String::from("t");
    for (name, _) in &lists {
        joints.iter().for_each(|joint| text += &format!(",{}", field(&format!("{name}_{joint}"))));
    }
    text += if samples.phase.is_empty() { "\n" } else { ",phase\n" };
    for (k, t) in samples.t.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = write!(text, "{t:?}");
        for value in lists.iter().flat_map(|(_, rows)| &rows[k]) {
            let _ = write!(text, ",{value:?}");
        }
        if let Some(phase) = samples.phase.get(k) {
            let _ = write!(text, ",{phase}");
        }
        text.push('\n');
    }
    text
}

/// A field of a table, in quotation marks where its characters ask for them (RFC 4180).
fn field(text: &str) -> String {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::{field, rate};

    #[test]
    fn rates_have_units_or_none() {
        for (text, hertz) in
            [("1kHz", 1000.0), ("0.5 kHz", 500.0), ("500Hz", 500.0), ("250", 250.0), ("2.5e2HZ", 250.0)]
        {
            assert_eq!(rate(text), Ok(hertz), "{text}");
        }
        for text in ["", "Hz", "kHz", "0", "-1kHz", "inf", "nanHz", "1e308kHz", "1MHz", "\u{3bc}Hz", "fast"] {
            assert!(rate(text).is_err(), "{text}");
        }
    }

    #[test]
    fn names_with_commas_are_quoted() {
        assert_eq!(field("q_waist"), "q_waist");
        assert_eq!(field("q_a,\"b\""), "\"q_a,\"\"b\"\"\"");
    }
}
