//! The innermost loops: a few rows or columns at once, as far as they fit into registers.
//!
//! Inlined into code for the widest vectors ([`in_widest`](costate_numerics::in_widest)). Sums are written so
//! that the compiler keeps them in vectors of [`LANES`] numbers.

/// Rows and columns of matrices that are read by tiles are padded to multiples of this.
pub(crate) const LANES: usize = 4;

/// Partial sums of four scalar products. They are part of a workspace: of sums that nobody else sees, the
/// compiler makes vectors across the products, and transposes all entries for them.
pub(crate) type Sums = [[f64; LANES]; 4];

/// `a b + c`.
#[inline(always)]
pub(crate) fn fused<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// The largest absolute value.
#[inline(always)]
pub(crate) fn largest(values: &[f64]) -> f64 {
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

/// Keeps values in `product`, and multiplies them by a factor.
#[inline(always)]
pub(crate) fn scale(values: &mut [f64], factor: f64, product: &mut [f64]) {
    for (value, product) in
        values.as_chunks_mut::<LANES>().0.iter_mut().zip(product.as_chunks_mut::<LANES>().0)
    {
        *product = *value;
        value.iter_mut().for_each(|value| *value *= factor);
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
    let mut row = first;
    if count >= 4 {
        while row + 8 <= stride {
            tile::<FUSED, ADD, 4, 8>(from, to, stride, j, row);
            row += 8;
        }
        if row < stride {
            tile::<FUSED, ADD, 4, 4>(from, to, stride, j, row);
        }
        return 4;
    }
    if count >= 2 {
        while row + 8 <= stride {
            tile::<FUSED, ADD, 2, 8>(from, to, stride, j, row);
            row += 8;
        }
        if row < stride {
            tile::<FUSED, ADD, 2, 4>(from, to, stride, j, row);
        }
        return 2;
    }
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
    for (column, weights) in columns.chunks_exact(stride).zip(products.chunks_exact(stride)) {
        let (Some(column), Some(weights)) =
            (column[row..].first_chunk::<R>(), weights[j..].first_chunk::<W>())
        else {
            break;
        };
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
    let rows = rows.map(|row| &row[..n]);
    let (chunks, rest) = x.as_chunks::<LANES>();
    let columns = rows.map(|row| &row.as_chunks::<LANES>().0[..chunks.len()]);
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
        let last: [f64; LANES] =
            std::array::from_fn(|lane| if lane < LANES - rest.len() { 0.0 } else { last[lane] });
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
    std::array::from_fn(|w| {
        let [p, q, r, s] = sums[w];
        rows[w].iter().zip(x).take(few).fold((p + q) + (r + s), |sum, (a, b)| fused::<FUSED>(*a, *b, sum))
    })
}

/// Adds four rows, times factors.
#[inline(always)]
pub(crate) fn add_rows<const FUSED: bool>(rows: [&[f64]; 4], factors: [f64; 4], to: &mut [f64]) {
    let n = to.len();
    let rows = rows.map(|row| &row[..n]);
    // Sums that do not wait for those of the rows before.
    let sum = |[a, b, c, d]: [f64; 4]| {
        let [p, q, r, s] = factors;
        fused::<FUSED>(q, b, p * a) + fused::<FUSED>(s, d, r * c)
    };
    let chunks = rows.map(|row| &row.as_chunks::<LANES>().0[..n / LANES]);
    for (i, to) in to.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
        for lane in 0..LANES {
            to[lane] += sum(chunks.map(|row| row[i][lane]));
        }
    }
    let rest = n % LANES;
    if rest == 0 {
        return;
    }
    let ends = rows.map(|row| row.last_chunk::<LANES>());
    if let ([Some(a), Some(b), Some(c), Some(d)], Some(to)) = (ends, to.last_chunk_mut::<LANES>()) {
        // The last ones once more, of which some are not added.
        let sums: [f64; LANES] = std::array::from_fn(|lane| sum([a[lane], b[lane], c[lane], d[lane]]));
        for lane in LANES - rest..LANES {
            to[lane] += sums[lane];
        }
    } else {
        to.iter_mut().enumerate().for_each(|(i, to)| *to += sum(rows.map(|row| row[i])));
    }
}

/// `to = factor (a b)`, entry by entry.
#[inline(always)]
pub(crate) fn scaled_product(factor: f64, a: &[f64], b: &[f64], to: &mut [f64]) {
    let n = a.len();
    let (b, to) = (&b[..n], &mut to[..n]);
    let chunks = a.as_chunks::<LANES>().0.iter().zip(b.as_chunks::<LANES>().0);
    for (to, (a, b)) in to.as_chunks_mut::<LANES>().0.iter_mut().zip(chunks) {
        for lane in 0..LANES {
            to[lane] = factor * a[lane] * b[lane];
        }
    }
    // The last ones once more.
    if let (Some(to), Some(a), Some(b)) =
        (to.last_chunk_mut::<LANES>(), a.last_chunk::<LANES>(), b.last_chunk::<LANES>())
    {
        for lane in 0..LANES {
            to[lane] = factor * a[lane] * b[lane];
        }
    } else {
        to.iter_mut().zip(a.iter().zip(b)).for_each(|(to, (a, b))| *to = factor * a * b);
    }
}

/// The place of the only entry that is not zero, if there is one.
#[inline(always)]
pub(crate) fn only_entry(row: &[f64]) -> Option<usize> {
    let (chunks, rest) = row.as_chunks::<LANES>();
    let mut found = None;
    for (i, chunk) in chunks.iter().enumerate() {
        let mut lanes = 0_u32;
        for lane in 0..LANES {
            lanes |= u32::from(chunk[lane] != 0.0) << lane;
        }
        if lanes != 0 {
            if found.is_some() || !lanes.is_power_of_two() {
                return None;
            }
            found = Some(LANES * i + lanes.trailing_zeros() as usize);
        }
    }
    for (i, _) in rest.iter().enumerate().filter(|(_, entry)| **entry != 0.0) {
        if found.replace(LANES * chunks.len() + i).is_some() {
            return None;
        }
    }
    found
}
