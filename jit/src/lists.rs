//! A list for each of a number of keys, all in one vector.

use std::ops::Range;

/// The entries of key k are in `entries[starts[k]..starts[k + 1]]`.
#[derive(Clone, Debug)]
pub(crate) struct Lists<T> {
    starts: Vec<u32>,
    entries: Vec<T>,
}

impl<T: Copy> Lists<T> {
    /// The entries by their keys, which are below `keys`; those of one key keep their order.
    pub fn new(keys: usize, pairs: &[(usize, T)]) -> Self {
        let mut starts = vec![0_u32; keys + 1];
        pairs.iter().for_each(|&(key, _)| starts[key + 1] += 1);
        for key in 0..keys {
            starts[key + 1] += starts[key];
        }
        let mut entries: Vec<T> = pairs.iter().map(|&(_, entry)| entry).collect();
        let mut next = starts.clone();
        for &(key, entry) in pairs {
            entries[next[key] as usize] = entry;
            next[key] += 1;
        }
        Self { starts, entries }
    }

    /// Where the entries of a key are.
    pub fn range(&self, key: usize) -> Range<usize> {
        self.starts[key] as usize..self.starts[key + 1] as usize
    }

    /// The entries of a key.
    pub fn of(&self, key: usize) -> &[T] {
        &self.entries[self.range(key)]
    }

    /// The entry at a place in the range of its key.
    pub fn at(&self, place: usize) -> T {
        self.entries[place]
    }
}

#[cfg(test)]
mod tests {
    use super::Lists;

    #[test]
    fn entries_are_found_by_their_keys_in_order() {
        let lists = Lists::new(4, &[(2, 'a'), (0, 'b'), (2, 'c'), (3, 'd'), (2, 'e')]);
        let all: Vec<String> = (0..4).map(|key| lists.of(key).iter().collect()).collect();
        assert_eq!(all, ["b", "", "ace", "d"]);
        assert_eq!(lists.range(2).map(|place| lists.at(place)).collect::<String>(), "ace");
    }
}
