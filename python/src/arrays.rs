//! NumPy arrays in: their checks, their leading axes, and numbers by states.

use crate::argument::{Argument, Entries};
pub use crate::axes::Axes;
use crate::axes::MOST_AXES;
use crate::errors::argument;
use crate::fours;
use numpy::npyffi::NPY_TYPES;
use numpy::{PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::type_object::PyTypeInfo;

/// The arrays of a call, whose memory is read.
pub type Held<'py, const N: usize> = [Option<Bound<'py, PyUntypedArray>>; N];

/// The numbers of an argument, without its owner.
#[derive(Clone, Copy)]
pub struct Source {
    data: *const u8,
    /// Bytes from one index to the next, for each leading axis of the argument, then of all arguments.
    strides: [isize; MOST_AXES],
}

// SAFETY: it is only read, and the call that holds the array outlives all threads that read.
unsafe impl Send for Source {}
// SAFETY: as above.
unsafe impl Sync for Source {}

impl Source {
    /// Numbers in C order, `length` for each state.
    ///
    /// # Safety
    /// They are there as long as it is used.
    pub unsafe fn dense(data: *const u8, axes: &Axes, length: usize) -> Self {
        let mut strides = [0; MOST_AXES];
        let mut stride = (length * size_of::<f64>()) as isize;
        for k in (0..axes.count).rev() {
            strides[k] = stride;
            stride *= axes.lengths[k] as isize;
        }
        Self { data, strides }
    }

    /// The address of number `start` of a state.
    #[inline]
    pub fn address(&self, axes: &Axes, state: usize, start: usize) -> *const u8 {
        let mut offset = 0;
        let mut rest = state;
        // Along the first axis, which most batches have alone, nothing is divided.
        for k in (1..axes.count).rev() {
            let length = axes.lengths[k];
            offset += (rest % length) as isize * self.strides[k];
            rest /= length;
        }
        offset += rest as isize * self.strides[0];
        self.data.wrapping_offset(offset).wrapping_add(start * size_of::<f64>())
    }

    /// Copies numbers `start..start + to.len()` of a state.
    #[inline]
    pub fn copy(&self, axes: &Axes, state: usize, start: usize, to: &mut [f64]) {
        // SAFETY: `read_all` has checked that the array has this many numbers along its last axis, one after
        // the other, at every index of its leading axes, and that the state is one of them; the caller of
        // `dense` has promised it. Bytes are copied, which need no alignment. As in NumPy, a thread that
        // writes to the array meanwhile decides what is read.
        unsafe {
            let from = self.address(axes, state, start);
            std::ptr::copy_nonoverlapping(from, to.as_mut_ptr().cast::<u8>(), size_of_val(to));
        }
    }

    /// The same of four states.
    ///
    /// # Safety
    /// `WIDE` only where the processor has AVX.
    #[inline(always)]
    pub unsafe fn copy_four<const WIDE: bool>(
        &self,
        axes: &Axes,
        states: [usize; 4],
        start: usize,
        to: &mut [[f64; 4]],
    ) {
        let from = states.map(|state| self.address(axes, state, start));
        // SAFETY: the numbers are there, as for `copy`; the rest is the promise of the caller.
        unsafe { fours::read::<WIDE>(from, to) }
    }
}

/// Reads an argument without a copy, a vector of numbers for each state; a sequence of numbers is converted.
///
/// # Errors
/// `ArgumentError` for another type of numbers, another length of the last axis, and another layout.
#[inline]
fn read<'py>(
    given: &Bound<'py, PyAny>,
    expected: &Argument,
) -> PyResult<(Bound<'py, PyUntypedArray>, Source, Axes)> {
    let array = match given.cast::<PyUntypedArray>() {
        Ok(array) => array.clone(),
        Err(_) => converted(given, expected)?,
    };
    if given.get_type_ptr() != PyUntypedArray::type_object_raw(given.py()) {
        refuse_mask(given, expected)?;
    }
    if !is_float64(&array) {
        return Err(wrong_type(&array, expected));
    }
    let (shape, strides) = (array.shape(), array.strides());
    let Some((last, leading)) =
        shape.split_last().filter(|(last, leading)| **last == expected.length && leading.len() <= MOST_AXES)
    else {
        return Err(wrong_shape(&array, expected));
    };
    let empty = leading.contains(&0);
    if *last > 1 && !empty && strides[leading.len()] != size_of::<f64>() as isize {
        return Err(wrong_layout(&array, expected));
    }
    // SAFETY: it is an array of doubles.
    let data = unsafe { array.cast_unchecked::<PyArrayDyn<f64>>() }.data();
    let mut axes = Axes { count: leading.len(), lengths: [1; MOST_AXES] };
    axes.lengths[..leading.len()].copy_from_slice(leading);
    let mut source = Source { data: data.cast(), strides: [0; MOST_AXES] };
    source.strides[..leading.len()].copy_from_slice(&strides[..leading.len()]);
    Ok((array, source, axes))
}

/// Reads all arguments and broadcasts their leading axes.
///
/// # Errors
/// `ArgumentError` where an argument does not fit.
#[inline]
pub fn read_all<'py, const N: usize>(
    py: Python<'py>,
    given: [&Bound<'py, PyAny>; N],
    expected: &[Argument],
) -> PyResult<(Held<'py, N>, [Source; N], Axes)> {
    let mut axes = Axes { count: 0, lengths: [1; MOST_AXES] };
    let mut held = [const { None }; N];
    let mut sources = [Source { data: std::ptr::null(), strides: [0; MOST_AXES] }; N];
    let mut own = [axes; N];
    for (k, expected) in expected.iter().enumerate() {
        let (array, source, leading) = read(given[k], expected)?;
        (held[k], sources[k], own[k]) = (Some(array), source, leading);
        if leading.count != 0 && !axes.include(&leading) {
            let (found, others) = (leading.shape(), axes.shape());
            let name = expected.name;
            let message = format!(
                "the leading axes {found:?} of {name} cannot be broadcast to those before it, {others:?}"
            );
            return Err(argument(py, name, message));
        }
    }
    if axes.count != 0 {
        for (source, own) in sources.iter_mut().zip(&own) {
            let missing = axes.count - own.count;
            let given = source.strides;
            for (k, stride) in source.strides[..axes.count].iter_mut().enumerate() {
                *stride = match k.checked_sub(missing) {
                    Some(k) if own.lengths[k] != 1 => given[k],
                    _ => 0,
                };
            }
        }
    }
    Ok((held, sources, axes))
}

/// A sequence as an array of doubles.
#[cold]
fn converted<'py>(given: &Bound<'py, PyAny>, expected: &Argument) -> PyResult<Bound<'py, PyUntypedArray>> {
    static CONVERT: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let py = given.py();
    let convert = CONVERT.import(py, "numpy", "array")?;
    let refused = |reason: String| {
        let (name, length) = (expected.name, expected.length);
        argument(py, name, format!("{name} is not an array or a sequence of {length} numbers: {reason}"))
    };
    let array = convert.call1((given,)).and_then(|array| Ok(array.cast_into::<PyUntypedArray>()?));
    let array = array.map_err(|error| refused(error.to_string()))?;
    let kind = array.dtype().kind();
    if !matches!(kind, b'i' | b'u' | b'f') {
        return Err(refused(format!("its entries have the type {}", array.dtype())));
    }
    let array = array.call_method1(intern!(py, "astype"), ("f8",))?;
    Ok(array.cast_into::<PyUntypedArray>()?)
}

/// Refuses a masked array, whose mask would be lost.
#[cold]
fn refuse_mask(given: &Bound<'_, PyAny>, expected: &Argument) -> PyResult<()> {
    let py = given.py();
    if !given.hasattr(intern!(py, "mask"))? || !given.hasattr(intern!(py, "filled"))? {
        return Ok(());
    }
    let name = expected.name;
    let message = format!(
        "{name} is a masked array, whose mask would have no effect; pass {name}.filled(0.0), or another number"
    );
    Err(argument(py, name, message))
}

/// Whether its numbers are doubles of this processor.
#[inline]
pub fn is_float64(array: &Bound<'_, PyUntypedArray>) -> bool {
    let kind = array.dtype();
    kind.num() == NPY_TYPES::NPY_DOUBLE as i32 && kind.is_native_byteorder() != Some(false)
}

#[cold]
fn wrong_type(array: &Bound<'_, PyUntypedArray>, expected: &Argument) -> PyErr {
    let (name, found) = (expected.name, array.dtype());
    // A cast would drop the imaginary parts.
    let advice = if found.kind() == b'c' { "real if its imaginary parts are zero" } else { "astype(float)" };
    let message = format!("{name} has the type {found}, not float64; pass {name}.{advice}");
    argument(array.py(), name, message)
}

#[cold]
fn wrong_shape(array: &Bound<'_, PyUntypedArray>, expected: &Argument) -> PyErr {
    let Argument { name, length, entries } = expected;
    let whose = match entries {
        Entries::Joints => {
            "one entry for each of the joints of `robot.joint_names`, in their order (y: twice, d: three times as \
             many)"
        }
        Entries::Positions => {
            "one entry for each position, in the order of `robot.joint_names`: a floating joint has x, y, z and its \
             quaternion (x, y, z, w), a spherical one the quaternion; `robot.free_joints` says where"
        }
        Entries::Axes => "one entry for each of the axes x, y, z",
        Entries::Rows => "one entry for each row of the constraints, of `row_names`",
    };
    let message = if array.ndim() > MOST_AXES + 1 {
        format!("{name} has {} axes; at most {MOST_AXES} may come before that of the joints", array.ndim())
    } else {
        format!("{name} has the shape {:?}, not (..., {length}); the last axis has {whose}", array.shape())
    };
    argument(array.py(), name, message)
}

#[cold]
fn wrong_layout(array: &Bound<'_, PyUntypedArray>, expected: &Argument) -> PyErr {
    let name = expected.name;
    let message = format!(
        "the numbers of one state of {name} are not one after the other in memory (Fortran order, or a view with \
         steps); pass numpy.ascontiguousarray({name})"
    );
    argument(array.py(), name, message)
}
