//! What could make a small text expensive is refused before it is parsed.

use crate::robot::error::RobotError;

/// Most arrays and tables, up to 2 kB of memory each; 10 000 joints need about 100 000.
const MOST_BRACKETS: usize = 120_000;
/// Most entries of arrays and tables, about 300 bytes of memory each. 10 000 joints, or an armature matrix of
/// 700 rows, need about 500 000.
const MOST_ENTRIES: usize = 600_000;

/// Refuses texts with very many arrays, tables or entries.
pub(super) fn check(text: &str) -> Result<(), RobotError> {
    let limits: [(&[char], usize, &str); 2] =
        [(&['[', '{'], MOST_BRACKETS, "arrays and tables"), (&[',', '='], MOST_ENTRIES, "entries")];
    for (characters, most, what) in limits {
        if let Some((byte, _)) = text.match_indices(characters).nth(most) {
            let message =
                format!("the file has more than {most} {what}; a robot of 10 000 joints needs fewer");
            return Err(RobotError::malformed(message).at(super::explain::line(text, byte)));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::check;

    #[test]
    fn what_would_take_hundreds_of_megabytes_is_refused_before_it_is_parsed() {
        for (text, what) in
            [("[[joint]]\n", "120000 arrays and tables"), ("a = {},", "arrays"), ("1,", "600000 entries")]
        {
            assert!(check(&text.repeat(50_000)).is_ok(), "{text}");
            let message = check(&text.repeat(700_000)).unwrap_err().to_string();
            assert!(message.contains(what), "{message}");
        }
    }
}
