//! Names that resemble a misspelt one.

/// Longest name that is compared with the known ones.
const LONGEST_COMPARED: usize = 64;

/// Most names that are offered in place of an unknown one.
const OFFERED: usize = 3;

/// The known name that differs by the fewest letters, if it differs by few.
#[cfg(feature = "urdf")]
pub(super) fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    ranked(name, known.iter().copied()).into_iter().next().map(|(_, known)| known)
}

/// The known names that resemble an unknown one, the most similar first.
pub(crate) fn resembling<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Vec<String> {
    ranked(name, known).into_iter().take(OFFERED).map(|(_, known)| known.to_owned()).collect()
}

/// Names that differ by few letters, by their number, then by name.
fn ranked<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Vec<(usize, &'a str)> {
    if name.len() > LONGEST_COMPARED {
        return Vec::new();
    }
    let name = name.to_lowercase();
    let most = 1 + name.chars().count() / 4;
    let short = known.filter(|known| known.len() <= LONGEST_COMPARED);
    let mut ranked: Vec<_> = short.map(|known| (distance(&name, &known.to_lowercase()), known)).collect();
    ranked.retain(|&(distance, _)| distance <= most);
    ranked.sort_unstable();
    ranked.dedup();
    ranked
}

/// Letters to insert, delete, replace, or exchange with their neighbour, to turn one word into the other.
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut rows = vec![(0..=b.len()).collect::<Vec<usize>>()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replaced = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut least = replaced.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(rows[i - 2][j - 2] + 1);
            }
            row.push(least);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn similar_names_are_offered_and_others_are_not() {
        let known = || ["tool0", "tool1", "wrist_3_link", "base_link"].into_iter();
        assert_eq!(resembling("tol0", known()), ["tool0", "tool1"]);
        assert_eq!(resembling("Wrist_3_Link", known()), ["wrist_3_link"]);
        assert_eq!(resembling("gripper", known()), [""; 0]);
        assert_eq!(resembling(&"x".repeat(1000), known()), [""; 0]);
        assert_eq!((distance("", "abc"), distance("ca", "abc"), distance("same", "same")), (3, 3, 0));
    }
}
