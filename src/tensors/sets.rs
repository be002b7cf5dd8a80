//! The independent indices, in the order of storage.

use super::paths::Paths;
use crate::robot::Tree;

/// The sets of independent indices of a tree; each in the order of storage.
///
/// On a serial chain the first derivatives have `N1 = (n-1) n (n+1) / 3` independent entries, the second
/// derivatives `N2 = (n-1) n (n+1) (3n+2) / 24`; on a tree with branches there are fewer.
#[derive(Clone, Debug)]
pub struct IndexSets {
    paths: Paths,
}

impl IndexSets {
    /// The sets of a tree.
    pub fn new(tree: &Tree) -> Self {
        Self { paths: Paths::new(tree) }
    }

    /// Applies `list` to the path to each joint in turn.
    fn each<const N: usize>(
        &self,
        mut list: impl FnMut(&[usize], usize, &mut Vec<[usize; N]>),
    ) -> Vec<[usize; N]> {
        let mut all = Vec::new();
        for d in 0..self.paths.len() {
            list(self.paths.of(d), self.paths.depth(d), &mut all);
        }
        all
    }

    /// `Gamma^k_ij`: i < j, k <= j (38), as `[k, i, j]`.
    pub fn gamma(&self) -> Vec<[usize; 3]> {
        self.each(|path, h, all| {
            for &i in &path[..h] {
                all.extend(path.iter().map(|&k| [k, i, path[h]]));
            }
        })
    }

    /// `M_ij,k`: i <= j, i < k (39), as `[i, j, k]`.
    pub fn mass_first(&self) -> Vec<[usize; 3]> {
        self.each(|path, h, all| {
            for i in 0..h {
                all.extend(path[i..h].iter().map(|&j| [path[i], j, path[h]]));
                all.extend(path[i + 1..].iter().map(|&k| [path[i], path[h], k]));
            }
        })
    }

    /// `Gamma^k_ij,l`: i < j <= l, k <= j, cases (a) and (b), or i < k <= l < j, case (c) of (45), as
    /// `[k, i, j, l]`.
    pub fn gamma_derivatives(&self) -> Vec<[usize; 4]> {
        self.each(|path, h, all| {
            for j in 0..=h {
                for i in 0..j {
                    all.extend(path[..=j].iter().map(|&k| [k, path[i], path[j], path[h]]));
                }
            }
            for l in 0..h {
                for k in 1..=l {
                    all.extend(path[..k].iter().map(|&i| [path[k], i, path[h], path[l]]));
                }
            }
        })
    }

    /// `M_ij,kl`: i <= j, i < k <= l (41), as `[i, j, k, l]`.
    pub fn mass_second(&self) -> Vec<[usize; 4]> {
        self.each(|path, h, all| {
            for i in 0..h {
                for &j in &path[i..] {
                    all.extend(path[i + 1..].iter().map(|&k| [path[i], j, k, path[h]]));
                }
                for k in i + 1..h {
                    all.extend(path[k..h].iter().map(|&l| [path[i], path[h], path[k], l]));
                }
            }
        })
    }
}
