//! The kinds of motions and how each is drawn. All ranges stand here and in `robots.rs`.
//!
//! Limits are those of the quintic from rest to rest times a random factor, so that they bite but can mostly
//! be kept. No draw depends on how a motion is solved.

mod joints;
mod others;
mod tools;

use crate::draw::Draw;
use crate::text::Case;

/// A kind of motion.
pub struct Kind {
    pub name: &'static str,
    /// Its share among the motions, relative to the others.
    share: usize,
    draw: fn(&mut Draw) -> Result<Case, String>,
}

const fn kind(name: &'static str, share: usize, draw: fn(&mut Draw) -> Result<Case, String>) -> Kind {
    Kind { name, share, draw }
}

pub const KINDS: [Kind; 22] = [
    kind("tree", 5, joints::tree),
    kind("mimic", 3, joints::mimic),
    kind("spring", 3, joints::spring),
    kind("friction", 8, joints::friction),
    kind("spindle", 6, joints::spindle),
    kind("reference", 6, joints::reference),
    kind("event", 6, joints::event),
    kind("limits", 6, joints::limits),
    kind("rates", 5, joints::rates),
    kind("power", 4, joints::power),
    kind("free-time", 5, joints::free_time),
    kind("least-time", 5, joints::least_time),
    kind("energy", 4, joints::energy),
    kind("free-end", 4, joints::free_end),
    kind("via", 5, tools::via),
    kind("tool", 5, tools::tool),
    kind("obstacle", 5, tools::obstacle),
    kind("wall", 5, tools::wall),
    kind("underactuated", 5, others::underactuated),
    kind("loop", 4, others::four_bar),
    kind("quaternion", 2, others::quaternion),
    kind("gait", 1, others::gait),
];

/// The kind of a motion.
pub fn of(seed: u64, number: usize) -> &'static Kind {
    let all: usize = KINDS.iter().map(|kind| kind.share).sum();
    let mut place = Draw::new(seed ^ 0x5DEE_CE66, number).whole(0..all);
    for kind in &KINDS {
        if place < kind.share {
            return kind;
        }
        place -= kind.share;
    }
    &KINDS[0]
}

/// The problem of a motion.
pub fn draw(seed: u64, number: usize, name: &str) -> Result<Case, String> {
    let mut draw = Draw::new(seed, number);
    (of(seed, number).draw)(&mut draw).map_err(|error| format!("{name}: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn all_kinds_are_among_the_first_motions_and_the_same_number_is_the_same_motion() {
        let kinds: HashSet<&str> = (0..600).map(|number| of(1, number).name).collect();
        assert_eq!(kinds.len(), KINDS.len());
        for number in 0..60 {
            let [first, second] = [0, 1].map(|_| draw(1, number, "motion").unwrap());
            assert_eq!((&first.from, &first.to, &first.tail), (&second.from, &second.to, &second.tail));
        }
    }
}
