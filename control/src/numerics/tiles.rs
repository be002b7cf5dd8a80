//! Steps of a Cholesky factorisation A = U'U on tiles: four rows and eight columns that stay in registers.
//!
//! Matrices are upper triangles of rows, a stride apart. The reciprocals of the diagonal of U stand in its
//! place, so that no solution divides. What is called from outside is compiled once for each kind of vectors,
//! not for each place that calls it: all sizes of tiles together are much code.

use super::padded::multiply_add;
use costate_numerics::in_widest;

/// A pivot below this part of the diagonal entry that it came from counts as zero.
const LEAST_PIVOT: f64 = 1e-14;

/// Rows of a panel.
pub(super) const ROWS: usize = 4;

/// A pivot was not positive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct BadPivot;

/// `C` entries of a row from the column `j`.
#[inline(always)]
pub(super) fn part<const C: usize>(row: &[f64], j: usize) -> [f64; C] {
    let mut part = [0.0; C];
    part.copy_from_slice(&row[j..j + C]);
    part
}

/// `to -= factor from`.
#[inline(always)]
pub(super) fn subtract<const FUSED: bool, const C: usize>(to: &mut [f64; C], factor: f64, from: &[f64; C]) {
    for c in 0..C {
        to[c] = multiply_add::<FUSED>(-factor, from[c], to[c]);
    }
}

/// `R` rows and `C` columns of a matrix.
#[derive(Clone, Copy)]
pub(super) struct Tile<const R: usize, const C: usize>(pub(super) [[f64; C]; R]);

impl<const R: usize, const C: usize> Tile<R, C> {
    /// The columns from `j` of the first rows.
    #[inline(always)]
    pub(super) fn load(rows: &[f64], stride: usize, j: usize) -> Self {
        let mut tile = [[0.0; C]; R];
        for (tile, row) in tile.iter_mut().zip(rows.chunks_exact(stride)) {
            *tile = part(row, j);
        }
        Self(tile)
    }

    #[inline(always)]
    fn store(&self, rows: &mut [f64], stride: usize, j: usize) {
        for (tile, row) in self.0.iter().zip(rows.chunks_exact_mut(stride)) {
            row[j..j + C].copy_from_slice(tile);
        }
    }

    /// Subtracts for each row above the product of its entries from `i` and those from `j`.
    #[inline(always)]
    fn subtract_products<const FUSED: bool>(&mut self, above: &[f64], stride: usize, i: usize, j: usize) {
        for row in above.chunks_exact(stride) {
            let (factors, entries) = (part::<R>(row, i), part::<C>(row, j));
            for (to, factor) in self.0.iter_mut().zip(factors) {
                subtract::<FUSED, C>(to, factor, &entries);
            }
        }
    }
}

/// Runs `$body` with so many rows of a panel that begins at `$i`: four, or what is left of `$size`.
macro_rules! with_rows {
    ($i:ident of $size:expr, $rows:ident => $body:expr) => {
        match $size - $i {
            1 => {
                const $rows: usize = 1;
                $body
            }
            2 => {
                const $rows: usize = 2;
                $body
            }
            3 => {
                const $rows: usize = 3;
                $body
            }
            _ => {
                const $rows: usize = 4;
                $body
            }
        }
    };
}
pub(super) use with_rows;

/// Runs `$body` for the columns from `$from` to `$to`, in tiles of 8, 4, 2 and 1.
macro_rules! in_tiles {
    ($from:expr, $to:expr, $j:ident, $columns:ident => $body:expr) => {{
        let (mut $j, to) = ($from, $to);
        while $j < to {
            match to - $j {
                1 => {
                    const $columns: usize = 1;
                    $body;
                    $j += 1;
                }
                2..=3 => {
                    const $columns: usize = 2;
                    $body;
                    $j += 2;
                }
                4..=7 => {
                    const $columns: usize = 4;
                    $body;
                    $j += 4;
                }
                _ => {
                    const $columns: usize = 8;
                    $body;
                    $j += 8;
                }
            }
        }
    }};
}
pub(super) use in_tiles;

/// Rows 0 to `size` of U from those of A, `width` columns.
#[inline(never)]
pub(super) fn factorise_rows(
    rows: &mut [f64],
    stride: usize,
    size: usize,
    width: usize,
) -> Result<(), BadPivot> {
    in_widest!(factorise_panels(rows, stride, size, width))
}

#[inline(always)]
fn factorise_panels<const FUSED: bool>(
    rows: &mut [f64],
    stride: usize,
    size: usize,
    width: usize,
) -> Result<(), BadPivot> {
    for i in (0..size).step_by(ROWS) {
        with_rows!(i of size, R => factorise_panel::<FUSED, R>(rows, stride, i, width)?);
    }
    Ok(())
}

/// Rows i to i + `R` of U, where those above are of U already.
#[inline(always)]
fn factorise_panel<const FUSED: bool, const R: usize>(
    rows: &mut [f64],
    stride: usize,
    i: usize,
    width: usize,
) -> Result<(), BadPivot> {
    let (above, panel) = rows.split_at_mut(i * stride);
    let mut corner = Tile::<R, R>::load(panel, stride, i);
    let before = corner;
    corner.subtract_products::<FUSED>(above, stride, i, i);
    let Tile(u) = &mut corner;
    for r in 0..R {
        for s in 0..r {
            let above = u[s];
            subtract::<FUSED, R>(&mut u[r], above[r], &above);
        }
        let pivot = u[r][r];
        if !(pivot > LEAST_PIVOT * before.0[r][r] && pivot.is_finite()) {
            return Err(BadPivot);
        }
        let inverse = 1.0 / pivot.sqrt();
        u[r].iter_mut().for_each(|entry| *entry *= inverse);
        u[r][r] = inverse;
    }
    corner.store(panel, stride, i);
    in_tiles!(i + R, width, j, C => {
        let mut tile = Tile::<R, C>::load(panel, stride, j);
        tile.subtract_products::<FUSED>(above, stride, i, j);
        for r in 0..R {
            for s in 0..r {
                let above = tile.0[s];
                subtract::<FUSED, C>(&mut tile.0[r], corner.0[s][r], &above);
            }
            tile.0[r].iter_mut().for_each(|entry| *entry *= corner.0[r][r]);
        }
        tile.store(panel, stride, j);
    });
    Ok(())
}

/// Subtracts the first `size` rows of X'X, up to the column `width`, from the upper triangle of the rows
/// below, where X are the columns from `from` of the rows above. Both come with their strides.
#[inline(never)]
pub(super) fn subtract_square(
    above: (&[f64], usize),
    from: usize,
    below: (&mut [f64], usize),
    size: usize,
    width: usize,
) {
    in_widest!(subtract_panels(above, from, below, size, width));
}

#[inline(always)]
fn subtract_panels<const FUSED: bool>(
    (above, above_stride): (&[f64], usize),
    from: usize,
    (below, stride): (&mut [f64], usize),
    size: usize,
    width: usize,
) {
    for i in (0..size).step_by(ROWS) {
        let rows = &mut below[i * stride..];
        with_rows!(i of size, R => in_tiles!(i, width, j, C => {
            let mut tile = Tile::<R, C>::load(rows, stride, j);
            tile.subtract_products::<FUSED>(above, above_stride, from + i, from + j);
            tile.store(rows, stride, j);
        }));
    }
}
