//! The numbers of four states at once: entry k holds number k of all four.

/// Room for the numbers of four states; none of them spans two cache lines.
#[derive(Default)]
pub struct Fours {
    lines: Vec<Line>,
}

/// A cache line.
#[derive(Clone, Copy, Default)]
#[repr(C, align(64))]
struct Line([[f64; 4]; 2]);

impl Fours {
    /// Makes room for so many numbers of each state.
    pub fn fit(&mut self, count: usize) {
        let lines = count.div_ceil(2);
        if self.lines.len() < lines {
            self.lines.resize(lines, Line::default());
        }
    }

    /// The numbers, at least as many as were asked for.
    #[inline]
    pub fn numbers(&mut self) -> &mut [[f64; 4]] {
        let count = 2 * self.lines.len();
        // SAFETY: a line is just two entries one after the other, and this borrow is the only one.
        unsafe { std::slice::from_raw_parts_mut(self.lines.as_mut_ptr().cast(), count) }
    }
}

/// Four numbers of each of four states.
type Block = [[f64; 4]; 4];

/// Exchanges states and numbers.
///
/// # Safety
/// `WIDE` only where the processor has AVX.
#[inline(always)]
unsafe fn transposed<const WIDE: bool>(block: Block) -> Block {
    #[cfg(target_arch = "x86_64")]
    if WIDE {
        // SAFETY: the promise of the caller.
        return unsafe { transposed_in_registers(block) };
    }
    std::array::from_fn(|j| block.map(|row| row[j]))
}

/// The same by eight instructions; the compiler copies number by number.
#[cfg(target_arch = "x86_64")]
#[inline]
#[target_feature(enable = "avx")]
fn transposed_in_registers(block: Block) -> Block {
    use std::arch::x86_64::{
        _mm256_loadu_pd, _mm256_permute2f128_pd, _mm256_storeu_pd, _mm256_unpackhi_pd, _mm256_unpacklo_pd,
    };
    // SAFETY: a row is four doubles.
    let [a, b, c, d] = block.map(|row| unsafe { _mm256_loadu_pd(row.as_ptr()) });
    let (even, odd) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
    let (even_below, odd_below) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
    let columns = [
        _mm256_permute2f128_pd::<0x20>(even, even_below),
        _mm256_permute2f128_pd::<0x20>(odd, odd_below),
        _mm256_permute2f128_pd::<0x31>(even, even_below),
        _mm256_permute2f128_pd::<0x31>(odd, odd_below),
    ];
    columns.map(|column| {
        let mut row = [0.0; 4];
        // SAFETY: as above.
        unsafe { _mm256_storeu_pd(row.as_mut_ptr(), column) };
        row
    })
}

/// Reads the numbers of four states, which begin at these addresses.
///
/// # Safety
/// As many doubles as there are entries follow each other from each address on; they need not be aligned.
/// `WIDE` only where the processor has AVX.
#[inline(always)]
pub unsafe fn read<const WIDE: bool>(from: [*const u8; 4], to: &mut [[f64; 4]]) {
    let (blocks, rest) = to.as_chunks_mut::<4>();
    let behind = 4 * blocks.len();
    for (k, block) in blocks.iter_mut().enumerate() {
        // SAFETY: the promise of the caller.
        *block =
            unsafe { transposed::<WIDE>(from.map(|state| state.cast::<[f64; 4]>().add(k).read_unaligned())) };
    }
    for (k, entry) in rest.iter_mut().enumerate() {
        // SAFETY: as above.
        *entry = from.map(|state| unsafe { state.cast::<f64>().add(behind + k).read_unaligned() });
    }
}

/// From so many numbers on, results are written where 32 bytes of them are in one cache line: memory that is
/// not in the cache takes stores that span two lines much more slowly.
const LONG: usize = 64;

/// Writes the results of four states one after the other: number k of each is that of entry `places[k]`.
///
/// # Safety
/// `WIDE` only where the processor has AVX.
#[inline(always)]
pub unsafe fn write<const WIDE: bool>(entries: &[[f64; 4]], places: &[u32], results: &mut [f64]) {
    let length = places.len();
    // The four begin alike in a cache line.
    let alike = length >= LONG && length.is_multiple_of(4);
    let head = if alike { results.as_ptr().align_offset(size_of::<[f64; 4]>()).min(length) } else { 0 };
    let (upper, lower) = results.split_at_mut(2 * length);
    let ((a, b), (c, d)) = (upper.split_at_mut(length), lower.split_at_mut(length));
    let [(a_head, a), (b_head, b), (c_head, c), (d_head, d)] = [a, b, c, d].map(|row| row.split_at_mut(head));
    let (places_head, places) = places.split_at(head);
    write_singly(entries, places_head, [a_head, b_head, c_head, d_head]);
    let (blocks, rest) = places.as_chunks::<4>();
    let [(a, a_rest), (b, b_rest), (c, c_rest), (d, d_rest)] =
        [a, b, c, d].map(|row| row.as_chunks_mut::<4>());
    for ((block, (a, b)), (c, d)) in blocks.iter().zip(a.iter_mut().zip(b)).zip(c.iter_mut().zip(d)) {
        // SAFETY: the promise of the caller.
        [*a, *b, *c, *d] = unsafe { transposed::<WIDE>(block.map(|place| entries[place as usize])) };
    }
    write_singly(entries, rest, [a_rest, b_rest, c_rest, d_rest]);
}

/// The same of a few numbers.
#[inline(always)]
fn write_singly(entries: &[[f64; 4]], places: &[u32], [a, b, c, d]: [&mut [f64]; 4]) {
    let rows = a.iter_mut().zip(b).zip(c.iter_mut().zip(d));
    for (place, ((a, b), (c, d))) in places.iter().zip(rows) {
        [*a, *b, *c, *d] = entries[*place as usize];
    }
}
