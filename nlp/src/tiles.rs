//! The innermost loops: a few rows or columns at once, as far as they fit into registers.
//!
//! Inlined into code for the widest vectors ([`in_widest`](costate_numerics::in_widest)). Sums are written so
//! that the compiler keeps them in vectors of [`LANES`] numbers.

// Loops over lanes in this form become vectors; copies of slices and iterators keep arrays out of registers.
#![allow(clippy::manual_memcpy, clippy::needless_range_loop)]

/// Rows and columns of matrices that are read by tiles are padded to multiples of this.
pub(crate) const LANES: usize = 4;

/// Partial sums of four scalar products. They are part of a workspace: of sums that nobody else sees, the
/// compiler makes vectors across the products, and transposes all entries for them.
pub(crate) type Sums = [[f64; LANES]; 4];

/// Four values. Unlike [`std::array::from_fn`] and maps of arrays, which the compiler does not always inline,
/// it is compiled for the vectors of the code around it.
#[inline(always)]
pub(crate) fn four<T>(value: impl Fn(usize) -> T) -> [T; 4] {
    [value(0), value(1), value(2), value(3)]
}

/// `a b + c`.
#[inline(always)]
pub(crate) fn fused<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// The largest absolute value, without what is not a number.
#[inline(always)]
pub(crate) fn largest_number(values: &[f64]) -> f64 {
    let larger = |a: f64, b: f64| if b > a { b } else { a };
    // From the end: padding makes it a multiple of the vectors.
    let (rest, chunks) = values.as_rchunks::<LANES>();
    let mut most = [0.0; LANES];
    for chunk in chunks {
        for lane in 0..LANES {
            most[lane] = larger(most[lane], chunk[lane].abs());
        }
    }
    let [p, q, r, s] = most;
    rest.iter().fold(larger(larger(p, q), larger(r, s)), |most, value| larger(most, value.abs()))
}

/// `to = factor values`.
#[inline(always)]
pub(crate) fn scale(values: &[f64], factor: f64, to: &mut [f64]) {
    for_each_vector(to, [values], |_, [value]| factor * value);
}

/// Columns of a front that are eliminated at once where no pivot has to be chosen.
pub(crate) const PANEL: usize = 4;

/// Factors the square on the diagonal of a panel, of which column j has rows from j on: its columns become
/// those of L D. Returns the reciprocals of the pivots.
#[inline(always)]
pub(crate) fn factor_square<const FUSED: bool>(square: &mut [[f64; PANEL]; PANEL]) -> [f64; PANEL] {
    let mut reciprocals = [0.0; PANEL];
    for j in 0..PANEL {
        reciprocals[j] = square[j][j].recip();
        for i in j + 1..PANEL {
            let factor = square[j][i] * reciprocals[j];
            for row in i..PANEL {
                square[i][row] = fused::<FUSED>(-factor, square[j][row], square[i][row]);
            }
        }
    }
    reciprocals
}

/// The columns of a panel less the products of those before them in it, with its factored square on the
/// diagonal: `p_ij = a_ij - sum_k l_ik p_jk` for k < j, where `l_ik = p_ik / p_kk`.
#[inline(always)]
pub(crate) fn solve_panel<const FUSED: bool>(
    entries: &[f64],
    products: &mut [f64],
    stride: usize,
    (square, reciprocals): (&[[f64; PANEL]; PANEL], [f64; PANEL]),
    first: usize,
) {
    let mut at = first;
    while at < stride {
        let mut panel = [[0.0; LANES]; PANEL];
        for j in 0..PANEL {
            let Some(column) = entries[j * stride + at..].first_chunk::<LANES>() else { return };
            panel[j] = *column;
        }
        let mut factors = [[0.0; LANES]; PANEL];
        for j in 0..PANEL {
            for k in 0..j {
                for lane in 0..LANES {
                    panel[j][lane] = fused::<FUSED>(-square[k][j], factors[k][lane], panel[j][lane]);
                }
            }
            for lane in 0..LANES {
                factors[j][lane] = reciprocals[j] * panel[j][lane];
            }
        }
        for j in 0..PANEL {
            let Some(column) = products[j * stride + at..].first_chunk_mut::<LANES>() else { return };
            *column = panel[j];
        }
        at += LANES;
    }
}

/// `a_ij -= sum_k l_ik p_jk`, or `+=` where this is to be added, for rows i from `first` on, of four, two or
/// one of `count` columns from j on: returns how many. `to` begins with column j, columns k follow one
/// another; all of them have `stride` entries.
#[inline(always)]
pub(crate) fn update<const FUSED: bool, const ADD: bool>(
    (columns, products): (&[f64], &[f64]),
    to: &mut [f64],
    stride: usize,
    (j, count): (usize, usize),
    first: usize,
) -> usize {
    let from = (columns, products);
    if count >= 4 {
        return update_columns::<FUSED, ADD, 4>(from, to, stride, j, first);
    }
    if count >= 2 {
        return update_columns::<FUSED, ADD, 2>(from, to, stride, j, first);
    }
    let mut row = first;
    while row + 16 <= stride {
        tile::<FUSED, ADD, 1, 16>(from, to, stride, j, row);
        row += 16;
    }
    while row < stride {
        tile::<FUSED, ADD, 1, 4>(from, to, stride, j, row);
        row += 4;
    }
    1
}

/// The same for W columns, eight rows at a time: returns W.
#[inline(always)]
fn update_columns<const FUSED: bool, const ADD: bool, const W: usize>(
    from: (&[f64], &[f64]),
    to: &mut [f64],
    stride: usize,
    j: usize,
    mut row: usize,
) -> usize {
    while row + 8 <= stride {
        tile::<FUSED, ADD, W, 8>(from, to, stride, j, row);
        row += 8;
    }
    if row < stride {
        tile::<FUSED, ADD, W, 4>(from, to, stride, j, row);
    }
    W
}

/// The same for R rows from `row` on, of W columns.
#[inline(always)]
fn tile<const FUSED: bool, const ADD: bool, const W: usize, const R: usize>(
    (columns, products): (&[f64], &[f64]),
    to: &mut [f64],
    stride: usize,
    j: usize,
    row: usize,
) {
    // Written so that the compiler keeps the sums in vector registers.
    let mut sums = [[0.0; R]; W];
    for w in 0..W {
        let to = &to[w * stride + row..][..R];
        for r in 0..R {
            sums[w][r] = to[r];
        }
    }
    // No iterator of chunks: it divides to find their number.
    let mut at = 0;
    while at < columns.len() {
        let (Some(column), Some(weights)) =
            (columns[at + row..].first_chunk::<R>(), products[at + j..].first_chunk::<W>())
        else {
            break;
        };
        at += stride;
        for w in 0..W {
            let weight = if ADD { weights[w] } else { -weights[w] };
            for r in 0..R {
                sums[w][r] = fused::<FUSED>(weight, column[r], sums[w][r]);
            }
        }
    }
    for w in 0..W {
        let to = &mut to[w * stride + row..][..R];
        for r in 0..R {
            to[r] = sums[w][r];
        }
    }
}

/// The scalar products of four rows with x.
#[inline(always)]
pub(crate) fn products<const FUSED: bool>(rows: [&[f64]; 4], x: &[f64], sums: &mut Sums) -> [f64; 4] {
    let n = x.len();
    let rows = four(|r| &rows[r][..n]);
    let (chunks, rest) = x.as_chunks::<LANES>();
    let columns = four(|r| &rows[r].as_chunks::<LANES>().0[..chunks.len()]);
    let mut partial = [[0.0; LANES]; 4];
    for i in 0..chunks.len() {
        for w in 0..4 {
            for lane in 0..LANES {
                partial[w][lane] = fused::<FUSED>(columns[w][i][lane], chunks[i][lane], partial[w][lane]);
            }
        }
    }
    if let Some(last) = x.last_chunk::<LANES>()
        && !rest.is_empty()
    {
        // The last ones once more, without those that were added.
        let last = four(|lane| if lane < LANES - rest.len() { 0.0 } else { last[lane] });
        for w in 0..4 {
            if let Some(ends) = rows[w].last_chunk::<LANES>() {
                for lane in 0..LANES {
                    partial[w][lane] = fused::<FUSED>(ends[lane], last[lane], partial[w][lane]);
                }
            }
        }
    }
    *sums = partial;
    let few = if n < LANES { n } else { 0 };
    four(|w| {
        let [p, q, r, s] = sums[w];
        rows[w].iter().zip(x).take(few).fold((p + q) + (r + s), |sum, (a, b)| fused::<FUSED>(*a, *b, sum))
    })
}

/// Adds four rows, times factors.
#[inline(always)]
pub(crate) fn add_rows<const FUSED: bool>(rows: [&[f64]; 4], factors: [f64; 4], to: &mut [f64]) {
    let n = to.len();
    let rows = four(|r| &rows[r][..n]);
    // Sums that do not wait for those of the rows before.
    let sum = |to: f64, [a, b, c, d]: [f64; 4]| {
        let [p, q, r, s] = factors;
        to + (fused::<FUSED>(q, b, p * a) + fused::<FUSED>(s, d, r * c))
    };
    for_each_vector(to, rows, sum);
    let rest = n % LANES;
    if rest == 0 {
        return;
    }
    let ends = four(|r| rows[r].last_chunk::<LANES>());
    if let ([Some(a), Some(b), Some(c), Some(d)], Some(to)) = (ends, to.last_chunk_mut::<LANES>()) {
        // The last ones once more, without those that were added.
        let (mut sums, [a, b, c, d]) = (*to, [*a, *b, *c, *d]);
        for lane in 0..LANES {
            let added = sum(sums[lane], [a[lane], b[lane], c[lane], d[lane]]);
            sums[lane] = if lane < LANES - rest { sums[lane] } else { added };
        }
        *to = sums;
    } else {
        to.iter_mut().enumerate().for_each(|(i, to)| *to = sum(*to, four(|r| rows[r][i])));
    }
}

/// Sets entries from themselves and those of other vectors, as far as there are whole vectors of them.
///
/// All that are read are read before any is written, and the loop ends where a slice does: the compiler
/// neither has to know whether the slices overlap nor makes a loop for many vectors of it.
#[inline(always)]
fn for_each_vector<const K: usize>(to: &mut [f64], from: [&[f64]; K], value: impl Fn(f64, [f64; K]) -> f64) {
    let mut at = 0;
    while let Some(to) = to.get_mut(at..).and_then(<[f64]>::first_chunk_mut::<LANES>) {
        let mut inputs = [[0.0; LANES]; K];
        for (input, from) in inputs.iter_mut().zip(from) {
            let Some(from) = from.get(at..).and_then(<[f64]>::first_chunk::<LANES>) else { return };
            *input = *from;
        }
        let mut values = *to;
        for lane in 0..LANES {
            values[lane] = value(values[lane], inputs.map(|input| input[lane]));
        }
        *to = values;
        at += LANES;
    }
}

/// `to += sum of factor row` over any number of rows, which are as long as `to`.
#[inline(always)]
pub(crate) fn add_all_rows<'a, const FUSED: bool>(
    rows: impl Iterator<Item = (&'a [f64], f64)> + Clone,
    to: &mut [f64],
) {
    match to.len() {
        0..4 => {
            rows.for_each(|(row, factor)| {
                to.iter_mut().zip(row).for_each(|(to, entry)| *to += factor * entry)
            });
        }
        4..8 => add_in_tiles::<FUSED, 4>(rows, to),
        8..16 => add_in_tiles::<FUSED, 8>(rows, to),
        _ => add_in_tiles::<FUSED, 16>(rows, to),
    }
}

/// The same, R entries at a time.
#[inline(always)]
fn add_in_tiles<'a, const FUSED: bool, const R: usize>(
    rows: impl Iterator<Item = (&'a [f64], f64)> + Clone,
    to: &mut [f64],
) {
    let (n, mut done) = (to.len(), 0);
    while done < n {
        // The last ones once more, without those that were added.
        let at = done.min(n - R);
        // Two rows at once: their sums do not wait for each other.
        let (mut even, mut odd, mut rows) = ([0.0; R], [0.0; R], rows.clone());
        while let Some((row, factor)) = rows.next() {
            let Some(row) = row[at..].first_chunk::<R>() else { break };
            for r in 0..R {
                even[r] = fused::<FUSED>(factor, row[r], even[r]);
            }
            let Some((row, factor)) = rows.next() else { break };
            let Some(row) = row[at..].first_chunk::<R>() else { break };
            for r in 0..R {
                odd[r] = fused::<FUSED>(factor, row[r], odd[r]);
            }
        }
        let to = &mut to[at..at + R];
        for r in 0..R {
            to[r] += if r < done - at { 0.0 } else { even[r] + odd[r] };
        }
        done = at + R;
    }
}

/// `to = factor (a b)`, entry by entry.
#[inline(always)]
pub(crate) fn scaled_product(factor: f64, a: &[f64], b: &[f64], to: &mut [f64]) {
    let n = a.len();
    let (b, to) = (&b[..n], &mut to[..n]);
    let product = |_, [a, b]: [f64; 2]| factor * a * b;
    for_each_vector(to, [a, b], product);
    // The last ones once more.
    if let (Some(to), Some(a), Some(b)) =
        (to.last_chunk_mut::<LANES>(), a.last_chunk::<LANES>(), b.last_chunk::<LANES>())
    {
        for_each_vector(to, [a, b], product);
    } else {
        to.iter_mut().zip(a.iter().zip(b)).for_each(|(to, (a, b))| *to = factor * a * b);
    }
}

/// `to = factor (a b)` for four rows a, the outcomes of which are `stride` entries apart.
#[inline(always)]
pub(crate) fn scaled_products(
    factors: [f64; 4],
    rows: [&[f64]; 4],
    b: &[f64],
    to: &mut [f64],
    stride: usize,
) {
    let n = b.len();
    if n < LANES {
        for (r, (row, factor)) in rows.into_iter().zip(factors).enumerate() {
            scaled_product(factor, &row[..n], b, &mut to[r * stride..][..n]);
        }
        return;
    }
    let rows = four(|r| &rows[r][..n]);
    let chunks = four(|r| &rows[r].as_chunks::<LANES>().0[..n / LANES]);
    let product = |b: [f64; LANES], rows: [[f64; LANES]; 4]| -> [[f64; LANES]; 4] {
        four(|r| four(|lane| factors[r] * b[lane] * rows[r][lane]))
    };
    let mut store = |at: usize, products: [[f64; LANES]; 4]| {
        for r in 0..4 {
            to[r * stride + at..][..LANES].copy_from_slice(&products[r]);
        }
    };
    for (i, b) in b.as_chunks::<LANES>().0.iter().enumerate() {
        store(i * LANES, product(*b, four(|r| chunks[r][i])));
    }
    // The last ones once more.
    let ends = four(|r| rows[r].last_chunk::<LANES>());
    if let ([Some(p), Some(q), Some(r), Some(s)], Some(b)) = (ends, b.last_chunk::<LANES>()) {
        store(n - LANES, product(*b, [*p, *q, *r, *s]));
    }
}

/// `to += values`.
#[inline(always)]
pub(crate) fn add(to: &mut [f64], values: &[f64]) {
    let n = to.len().min(values.len());
    let (to, values) = (&mut to[..n], &values[..n]);
    for_each_vector(to, [values], |to, [value]| to + value);
    let rest = n / LANES * LANES;
    for i in rest..n.min(rest + LANES - 1) {
        to[i] += values[i];
    }
}

/// Adds the places of the entries that are not zero to a list, with their values; whether they are `most` or
/// fewer. If not, the list is as before.
#[inline(always)]
pub(crate) fn add_entries(row: &[f64], most: usize, to: &mut Vec<(usize, f64)>) -> bool {
    let (chunks, rest) = row.as_chunks::<LANES>();
    let before = to.len();
    for (i, chunk) in chunks.iter().enumerate() {
        let mut lanes = 0_u32;
        for lane in 0..LANES {
            lanes |= u32::from(chunk[lane] != 0.0) << lane;
        }
        if to.len() - before + lanes.count_ones() as usize > most {
            to.truncate(before);
            return false;
        }
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            to.push((LANES * i + lane, chunk[lane]));
            lanes &= lanes - 1;
        }
    }
    for (i, &entry) in rest.iter().enumerate().filter(|(_, entry)| **entry != 0.0) {
        if to.len() - before == most {
            to.truncate(before);
            return false;
        }
        to.push((LANES * chunks.len() + i, entry));
    }
    true
}
