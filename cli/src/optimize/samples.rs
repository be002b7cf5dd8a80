//! Motions at a fixed rate: the argument of `--sample`.

use crate::terminal;
use costate_control::{Problem, SampleError, Samples, Solution};

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

#[cfg(test)]
mod tests {
    use super::rate;

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
}
