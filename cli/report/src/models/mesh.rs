//! Triangles with shared vertices, few enough for a page.

use std::collections::HashMap;

/// Most triangles; meshes with more are made coarser.
const MOST_TRIANGLES: usize = 20_000;

/// Cells along the longest side within which vertices become one: first only those that are the same to the
/// precision of the page, then more and more.
const CELLS: [f64; 9] = [65_535.0, 1024.0, 512.0, 300.0, 200.0, 128.0, 80.0, 48.0, 24.0];

/// A mesh of triangles. Its vertices lie on a grid of 65 536 places along each side of its box, which is as
/// precise as a page shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    low: [f32; 3],
    high: [f32; 3],
    vertices: Vec<[u16; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// From the corners of triangles, three for each.
    pub(super) fn of_corners(corners: impl Iterator<Item = [f32; 3]>) -> Result<Self, String> {
        let corners: Vec<[f32; 3]> = corners.collect();
        if corners.len() < 3 {
            return Err("has no triangle; write it again".into());
        }
        if corners.iter().flatten().any(|x| !x.is_finite()) {
            return Err("a coordinate is not finite; write it again".into());
        }
        let bound = |pick: fn(f32, f32) -> f32| {
            corners.iter().fold(corners[0], |all, x| [0, 1, 2].map(|k| pick(all[k], x[k])))
        };
        let (low, high) = (bound(f32::min), bound(f32::max));
        let mut mesh = Self { low, high, vertices: Vec::new(), triangles: Vec::new() };
        for cells in CELLS {
            mesh.weld(&corners, cells);
            if mesh.triangles.len() <= MOST_TRIANGLES {
                break;
            }
        }
        Ok(mesh)
    }

    /// Makes one vertex of those in each cell, in their middle, and leaves out triangles without an area.
    fn weld(&mut self, corners: &[[f32; 3]], cells: f64) {
        let sides = [0, 1, 2].map(|k| f64::from(self.high[k]) - f64::from(self.low[k]));
        let cell = sides.into_iter().fold(0.0, f64::max) / cells;
        let place = |x: f32, k: usize, unit: f64| {
            if unit > 0.0 { (f64::from(x) - f64::from(self.low[k])) / unit } else { 0.0 }
        };
        let mut numbers: HashMap<[u32; 3], u32> = HashMap::new();
        let mut sums: Vec<([f64; 3], f64)> = Vec::new();
        let corner = |x: &[f32; 3]| -> u32 {
            let key = [0, 1, 2].map(|k| place(x[k], k, cell).round() as u32);
            let next = sums.len() as u32;
            let number = *numbers.entry(key).or_insert(next);
            if number == next {
                sums.push(([0.0; 3], 0.0));
            }
            let (sum, count) = &mut sums[number as usize];
            (0..3).for_each(|k| sum[k] += f64::from(x[k]));
            *count += 1.0;
            number
        };
        let all: Vec<u32> = corners.iter().map(corner).collect();
        let triangles = all.chunks_exact(3).map(|t| [t[0], t[1], t[2]]);
        let triangles = triangles.filter(|[a, b, c]| a != b && b != c && c != a).collect();
        let vertex = |(sum, count): &([f64; 3], f64)| {
            [0, 1, 2].map(|k| place((sum[k] / count) as f32, k, sides[k] / 65_535.0).round() as u16)
        };
        let vertices = sums.iter().map(vertex).collect();
        (self.triangles, self.vertices) = (triangles, vertices);
    }

    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        self.triangles.len()
    }

    /// Number of vertices.
    pub fn vertices(&self) -> usize {
        self.vertices.len()
    }

    /// Least and largest coordinates.
    pub(crate) fn corners(&self) -> [[f32; 3]; 2] {
        [self.low, self.high]
    }

    /// The places of the vertices from 0 to 65535 along each side, and the vertices of the triangles: little
    /// endian, 2 and 4 bytes a number.
    pub(crate) fn bytes(&self) -> [Vec<u8>; 2] {
        let vertices = self.vertices.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        [vertices, self.triangles.iter().flatten().flat_map(|x| x.to_le_bytes()).collect()]
    }
}

#[cfg(test)]
mod tests {
    use super::{MOST_TRIANGLES, Mesh};

    /// The triangles of a square grid with so many cells along each side.
    fn grid(cells: usize) -> Vec<[f32; 3]> {
        let at = |i: usize, j: usize| [i as f32, j as f32, ((i * j) as f32).sqrt()];
        let cell = |k: usize| {
            let (i, j) = (k / cells, k % cells);
            [at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
        };
        (0..cells * cells).flat_map(cell).collect()
    }

    #[test]
    fn vertices_are_shared_and_large_meshes_become_coarse() {
        let small = Mesh::of_corners(grid(10).into_iter()).unwrap();
        assert_eq!((small.vertices(), small.triangles()), (121, 200));
        assert_eq!(small.corners(), [[0.0; 3], [10.0; 3]]);
        let large = Mesh::of_corners(grid(300).into_iter()).unwrap();
        assert!((MOST_TRIANGLES / 4..=MOST_TRIANGLES).contains(&large.triangles()), "{}", large.triangles());
        assert_eq!(large.corners(), [[0.0; 3], [300.0; 3]]);
        let [vertices, triangles] = small.bytes();
        assert_eq!((vertices.len(), triangles.len()), (6 * 121, 12 * 200));
    }
}
