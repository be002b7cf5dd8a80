//! Where inputs come from. An input is known by its source, its kind and its number.

use crate::kind::Kind;
use crate::large::{self, Large};
use crate::mutate::mutated;
use fastrand::Rng;
use std::path::PathBuf;

/// A sequence of inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Mutated seeds, as many as are asked for.
    Mutated { seed: u64 },
    /// The files of the corpus.
    Corpus,
    /// What `large` makes.
    Large,
}

/// The inputs of one kind.
pub struct Inputs {
    kind: Kind,
    source: Source,
    seeds: Vec<Vec<u8>>,
    files: Vec<PathBuf>,
    large: Vec<&'static Large>,
}

impl Inputs {
    /// Reads the seeds or lists the files.
    pub fn new(kind: Kind, source: Source) -> Self {
        let seeds = if matches!(source, Source::Mutated { .. }) { kind.seeds() } else { Vec::new() };
        let large = large::ALL.iter().filter(|large| large.kind == kind).collect();
        Self { kind, source, seeds, files: kind.corpus(), large }
    }

    /// How many there are; of mutated ones there is no end.
    pub fn count(&self) -> Option<usize> {
        match self.source {
            Source::Mutated { .. } => None,
            Source::Corpus => Some(self.files.len()),
            Source::Large => Some(self.large.len()),
        }
    }

    /// Input `index`.
    pub fn input(&self, index: usize) -> Vec<u8> {
        match self.source {
            Source::Mutated { seed } => {
                let number = (index as u64) << 3 | self.kind as u64;
                mutated(&self.seeds, &mut Rng::with_seed(seed.rotate_left(40) ^ number))
            }
            Source::Corpus => {
                self.files.get(index).and_then(|file| std::fs::read(file).ok()).unwrap_or_default()
            }
            Source::Large => {
                self.large.get(index).map(|large| (large.make)().into_bytes()).unwrap_or_default()
            }
        }
    }

    /// How messages call it.
    pub fn name(&self, index: usize) -> String {
        let kind = self.kind.name();
        match self.source {
            Source::Mutated { seed } => format!("{kind} {index} of seed {seed}"),
            Source::Corpus => self.files.get(index).map_or(String::new(), |file| file.display().to_string()),
            Source::Large => {
                self.large.get(index).map_or(String::new(), |large| format!("{kind}: {}", large.name))
            }
        }
    }
}

impl Source {
    /// As words of a command line.
    pub fn words(self) -> [String; 2] {
        match self {
            Self::Mutated { seed } => ["mutated".into(), seed.to_string()],
            Self::Corpus => ["corpus".into(), "0".into()],
            Self::Large => ["large".into(), "0".into()],
        }
    }

    /// From such words.
    pub fn from_words(name: &str, seed: &str) -> Option<Self> {
        match name {
            "mutated" => Some(Self::Mutated { seed: seed.parse().ok()? }),
            "corpus" => Some(Self::Corpus),
            "large" => Some(Self::Large),
            _ => None,
        }
    }
}
