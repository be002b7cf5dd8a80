//! Names that resemble a misspelt one.

use super::printable::list;

/// Longest name that is compared with the known ones.
const LONGEST_COMPARED: usize = 64;

/// Most names that are offered in place of an unknown one.
const OFFERED: usize = 3;

/// Fewest letters of a beginning, or of a part of a name, by which it is recognised.
const SHORTEST_PART: usize = 2;

/// The known word that differs by the fewest letters, if it differs by few.
#[cfg(feature = "urdf")]
pub(super) fn nearest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let word = word.to_lowercase();
    let short = known.iter().filter(|_| word.len() <= LONGEST_COMPARED);
    short
        .filter_map(|known| Some((by_letters(&word, &known.to_lowercase())?, *known)))
        .min()
        .map(|(_, known)| known)
}

/// What a message says of names that resemble an unknown one, or `otherwise` where there are none.
pub(super) fn offer(nearest: &[String], otherwise: &str) -> String {
    match nearest {
        [] => otherwise.into(),
        nearest => format!("; did you mean '{}'?", list(nearest, "' or '")),
    }
}

/// The known names that resemble an unknown one, the most similar first.
pub(crate) fn resembling<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Vec<String> {
    ranked(name, known).into_iter().take(OFFERED).map(str::to_owned).collect()
}

/// How a known name resembles another one; the smallest is the most similar.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Likeness {
    /// It differs by this many letters.
    Letters(usize),
    /// It begins with the other one, or the other one with it; letters beyond.
    Beginning(usize),
    /// It has parts between underscores in common: letters of the longer name that are not in them.
    Parts(usize),
}

/// The names that resemble another one, the most similar first, those that do equally by name.
fn ranked<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    if name.len() > LONGEST_COMPARED {
        return Vec::new();
    }
    let name = name.to_lowercase();
    let mut known: Vec<&str> = known.filter(|known| known.len() <= LONGEST_COMPARED).collect();
    known.sort_unstable();
    known.dedup();
    let lower: Vec<String> = known.iter().map(|known| known.to_lowercase()).collect();
    let parts = telling_parts(&name, &lower);
    let like = |known: &str| by_letters(&name, known).or_else(|| by_parts(&name, known, &parts));
    let mut ranked: Vec<(Likeness, &str)> =
        lower.iter().zip(&known).filter_map(|(lower, known)| Some((like(lower)?, *known))).collect();
    ranked.sort_unstable();
    // Parts are a makeshift.
    let by_parts = |likeness: &Likeness| matches!(likeness, Likeness::Parts(_));
    if ranked.first().is_some_and(|(best, _)| !by_parts(best)) {
        ranked.retain(|(likeness, _)| !by_parts(likeness));
    }
    ranked.into_iter().map(|(_, known)| known).collect()
}

/// Whether few letters differ: one, and one more for every four, but not a whole word.
fn by_letters(name: &str, known: &str) -> Option<Likeness> {
    let length = name.chars().count();
    let most = (1 + length / 4).min(length.min(known.chars().count()).saturating_sub(1));
    let distance = distance(name, known);
    (distance <= most).then_some(Likeness::Letters(distance))
}

/// Whether one name is the beginning of the other, or most of it are parts of the other that tell names
/// apart.
fn by_parts(name: &str, known: &str, parts: &[&str]) -> Option<Likeness> {
    let [shorter, longer] = if name.len() < known.len() { [name, known] } else { [known, name] };
    if shorter.len() >= SHORTEST_PART && longer.starts_with(shorter) {
        return Some(Likeness::Beginning(longer.len() - shorter.len()));
    }
    let common: usize = known.split('_').filter(|part| parts.contains(part)).map(str::len).sum();
    let letters = name.chars().filter(|&c| c != '_').count();
    (2 * common > letters).then(|| Likeness::Parts(longer.len().saturating_sub(common)))
}

/// The parts of a name between underscores that few of the known names have; `joint` and `link` are often
/// in all of them.
fn telling_parts<'n>(name: &'n str, known: &[String]) -> Vec<&'n str> {
    let owners = |part: &str| known.iter().filter(|known| known.split('_').any(|own| own == part)).count();
    name.split('_').filter(|part| part.len() >= SHORTEST_PART && owners(part) <= OFFERED).collect()
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
        assert_eq!(resembling("gripper_link", ["a_link", "b_link", "c_link", "d_link"].into_iter()), [""; 0]);
        assert_eq!(resembling(&"x".repeat(1000), known()), [""; 0]);
        assert_eq!((distance("", "abc"), distance("ca", "abc"), distance("same", "same")), (3, 3, 0));
    }

    #[test]
    fn a_beginning_or_a_part_is_enough() {
        let joints = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"];
        let both = joints.iter().flat_map(|name| [format!("{name}_joint"), format!("{name}_link")]);
        let names: Vec<String> = both.chain(["ee_link".into()]).collect();
        let offered = |name| resembling(name, names.iter().map(String::as_str));
        assert_eq!(offered("elbo"), ["elbow_link", "elbow_joint"]);
        assert_eq!(offered("elbow"), ["elbow_link", "elbow_joint"]);
        assert_eq!(offered("shoulder_pan"), ["shoulder_pan_link", "shoulder_pan_joint"]);
        assert_eq!(offered("ee"), ["ee_link"]);
        assert_eq!(offered("turn_elbow"), ["elbow_link", "elbow_joint"]);
        assert_eq!(offered("elbow_joint_left")[0], "elbow_joint");
        assert_eq!(offered("x"), [""; 0]);
        let of = |name, known: [&'static str; 3]| resembling(name, known.into_iter());
        assert_eq!(of("x", ["a", "b", "y"]), [""; 0], "one letter is a whole word");
        assert_eq!(of("a1", ["a2", "b7", "world"]), ["a2"]);
    }
}
