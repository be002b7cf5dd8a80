//! Result arrays: new ones, or those that a caller gives.

use crate::argument::Argument;
use crate::arrays::Held;
use crate::axes::{Axes, MOST_AXES};
use crate::errors::argument;
use crate::plan::Output;
use numpy::npyffi::flags::{NPY_ARRAY_ALIGNED, NPY_ARRAY_WRITEABLE};
use numpy::npyffi::{NpyTypes, PY_ARRAY_API, get_type_object};
use numpy::{
    Element, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};
use std::ffi::c_int;
use std::ops::Range;
use std::ptr::null_mut;

/// The memory of a result array.
#[derive(Clone, Copy)]
pub struct Target {
    data: *mut f64,
    length: usize,
}

// SAFETY: threads write different states, see `of`.
unsafe impl Send for Target {}
// SAFETY: as above.
unsafe impl Sync for Target {}

impl Target {
    /// Memory for `length` numbers of each state.
    ///
    /// # Safety
    /// It is there, and nobody else's, as long as it is used.
    pub unsafe fn dense(data: *mut f64, length: usize) -> Self {
        Self { data, length }
    }

    /// The numbers of one state.
    ///
    /// # Safety
    /// The state is one of the array, the array is alive, and nobody else uses this state.
    #[inline]
    #[expect(clippy::mut_from_ref, reason = "the caller promises that no other reference is alive")]
    pub unsafe fn of(&self, state: usize) -> &mut [f64] {
        // SAFETY: the promise of the caller.
        unsafe { std::slice::from_raw_parts_mut(self.data.add(state * self.length), self.length) }
    }

    /// The numbers of states that follow each other.
    ///
    /// # Safety
    /// As for `of`, for each of these states.
    #[expect(clippy::mut_from_ref, reason = "the caller promises that no other reference is alive")]
    pub unsafe fn of_all(&self, states: Range<usize>) -> &mut [f64] {
        let (start, length) = (states.start * self.length, states.len() * self.length);
        // SAFETY: the promise of the caller.
        unsafe { std::slice::from_raw_parts_mut(self.data.add(start), length) }
    }
}

/// A result array and its memory.
pub type Array<'py> = (Bound<'py, PyAny>, Target);

/// The shape of a result at all states.
fn shape_of(axes: &Axes, output: &Output) -> ([usize; MOST_AXES + 2], usize) {
    let mut shape = [0; MOST_AXES + 2];
    let count = axes.count + output.shape.len();
    shape[..axes.count].copy_from_slice(axes.shape());
    shape[axes.count..count].copy_from_slice(&output.shape);
    (shape, count)
}

/// A new array for a result at all states. It is not initialised: every state must be written.
///
/// # Errors
/// `MemoryError`, or `ValueError` where the size is no number of bytes.
#[inline]
pub fn allocate<'py>(py: Python<'py>, axes: &Axes, output: &Output) -> PyResult<Array<'py>> {
    let (mut shape, count) = shape_of(axes, output);
    // SAFETY: NumPy takes the reference to the type and reads `count` lengths, which are those of arrays or
    // of a robot and so no larger than `npy_intp`; without strides and data it allocates in C order. It
    // returns a new reference, or none and sets an exception. Doubles need no initialisation before they are
    // written, and all are written before Python sees the array.
    let array = unsafe {
        let array = PY_ARRAY_API.PyArray_NewFromDescr(
            py,
            get_type_object(py, NpyTypes::PyArray_Type),
            f64::get_dtype(py).into_dtype_ptr(),
            count as c_int,
            shape.as_mut_ptr().cast(),
            null_mut(),
            null_mut(),
            0,
            null_mut(),
        );
        Bound::from_owned_ptr_or_err(py, array)?.cast_into_unchecked::<PyArrayDyn<f64>>()
    };
    let data = array.data();
    Ok((array.into_any(), Target { data, length: output.length }))
}

/// The arrays that a caller gives for all results: one array, or a tuple or list with one, or None for a new
/// one, for each.
///
/// # Errors
/// `ArgumentError` for an array that does not fit, or whose memory is also that of an argument or of another
/// result.
#[cold]
pub fn given<'py, const N: usize>(
    out: &Bound<'py, PyAny>,
    axes: &Axes,
    outputs: &[Output],
    arguments: (&[Argument], &Held<'py, N>),
) -> PyResult<Vec<Array<'py>>> {
    let py = out.py();
    if let [output] = outputs {
        return Ok(vec![taken(out, "out", axes, output, arguments)?.0]);
    }
    let parts: Option<Vec<_>> = match (out.cast::<PyTuple>(), out.cast::<PyList>()) {
        (Ok(tuple), _) => Some(tuple.iter().collect()),
        (_, Ok(list)) => Some(list.iter().collect()),
        _ => None,
    };
    let parts = parts.filter(|parts| parts.len() == outputs.len()).ok_or_else(|| {
        let count = outputs.len();
        argument(
            py,
            "out",
            format!("out is not a tuple of {count} arrays, one for each result (None: a new one)"),
        )
    })?;
    let mut results = Vec::with_capacity(outputs.len());
    let mut ranges: Vec<Range<usize>> = Vec::with_capacity(outputs.len());
    for (k, (part, output)) in parts.iter().zip(outputs).enumerate() {
        if part.is_none() {
            results.push(allocate(py, axes, output)?);
            continue;
        }
        let (result, range) = taken(part, &format!("out[{k}]"), axes, output, arguments)?;
        if ranges.iter().any(|other| overlap(other, &range)) {
            return Err(argument(py, "out", format!("out[{k}] shares memory with another array of out")));
        }
        ranges.push(range);
        results.push(result);
    }
    Ok(results)
}

/// An array that a caller gives for a result, and the addresses of its memory.
fn taken<'py, const N: usize>(
    given: &Bound<'py, PyAny>,
    name: &str,
    axes: &Axes,
    output: &Output,
    (arguments, held): (&[Argument], &Held<'py, N>),
) -> PyResult<(Array<'py>, Range<usize>)> {
    let py = given.py();
    let refused = |reason: String| argument(py, "out", format!("{name} {reason}"));
    let Ok(array) = given.cast::<PyUntypedArray>() else {
        return Err(refused(format!("is a {}, not an array", given.get_type().name()?)));
    };
    if !crate::arrays::is_float64(array) {
        return Err(refused(format!("has the type {}, not float64", array.dtype())));
    }
    let (shape, count) = shape_of(axes, output);
    if array.shape() != &shape[..count] {
        return Err(refused(format!("has the shape {:?}, not {:?}", array.shape(), &shape[..count])));
    }
    // SAFETY: the array is alive.
    let flags = unsafe { (*array.as_array_ptr()).fields.flags };
    if !array.is_c_contiguous() || flags & NPY_ARRAY_ALIGNED == 0 {
        return Err(refused("is not C-contiguous; give numpy.empty(shape)".into()));
    }
    if flags & NPY_ARRAY_WRITEABLE == 0 {
        return Err(refused("cannot be written to".into()));
    }
    let range = addresses(array);
    for (expected, array) in arguments.iter().zip(held) {
        if array.as_ref().is_some_and(|array| overlap(&addresses(array), &range)) {
            return Err(refused(format!("shares memory with {}; give an array of its own", expected.name)));
        }
    }
    // SAFETY: it is an array of doubles.
    let data = unsafe { array.cast_unchecked::<PyArrayDyn<f64>>() }.data();
    Ok(((given.clone(), Target { data, length: output.length }), range))
}

/// The addresses from the first to the last number of an array; those of views with steps include others'.
fn addresses(array: &Bound<'_, PyUntypedArray>) -> Range<usize> {
    // SAFETY: the array is alive.
    let start = unsafe { (*array.as_array_ptr()).fields.data } as usize;
    if array.is_empty() {
        return start..start;
    }
    let (mut first, mut last) = (start, start + size_of::<f64>());
    for (&length, &stride) in array.shape().iter().zip(array.strides()) {
        let reach = (length - 1) * stride.unsigned_abs();
        if stride < 0 { first -= reach } else { last += reach }
    }
    first..last
}

fn overlap(a: &Range<usize>, b: &Range<usize>) -> bool {
    a.start < b.end && b.start < a.end
}
