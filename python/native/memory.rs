//! Arrays of Python that are lent, changes of their bytes, and arrays for Python.

use glam::DVec3;
use pyo3::buffer::{Element, PyBuffer};
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyByteArray, PyDict};
use rayon::prelude::*;
use std::cell::UnsafeCell;
use std::ffi::c_int;
use std::sync::Arc;
use voltet_core::picture::Picture;
use voltet_core::volume::Volume;
use voltet_core::{Error, hash_of_bytes};

/// Memory of a Python object that stays where it is: the object is held, and pinned.
#[derive(Clone)]
pub struct Lent<T: 'static> {
    values: &'static [T],
    keep: Arc<PyBuffer<T>>,
}

impl<T: Element + Sync> Lent<T> {
    /// The memory of an array of this type whose rows lie one after the other; `name` is for messages.
    pub fn borrow(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Lent<T>> {
        let wrong = |found: String| {
            let error = Error::usage(format!("{name} cannot be lent")).got(found);
            let error = error.expected("a C-contiguous array of the type that voltet.Grid makes of it");
            crate::error::exception(object.py(), &error)
        };
        let buffer: PyBuffer<T> = PyBuffer::get(object).map_err(|error| wrong(error.to_string()))?;
        let Some(memory) = buffer.as_slice_ptr() else { return Err(wrong("an array with gaps".into())) };
        let values: &'static [T] = match buffer.item_count() {
            0 => &[],
            // SAFETY: so many elements stand there, aligned, as PyBuffer has checked, and stay there until the buffer is
            // released. Whoever writes them meanwhile may make others of them, of which any bytes are some.
            _ => unsafe { memory.as_ref() },
        };
        Ok(Lent { values, keep: Arc::new(buffer) })
    }

    /// The numbers: they live as long as what [`Lent::keep`] gives.
    pub fn values(&self) -> &'static [T] {
        self.values
    }

    /// Owner of the memory.
    pub fn keep(&self) -> Arc<PyBuffer<T>> {
        self.keep.clone()
    }
}

/// A numpy array of its own memory, that may be written: these numbers as elements of `dtype`.
pub fn array<'py, T: bytemuck::NoUninit>(
    py: Python<'py>,
    dtype: &str,
    numbers: &[T],
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    static ARRAY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let own = PyByteArray::new(py, bytemuck::cast_slice(numbers));
    ARRAY.import(py, "numpy", "ndarray")?.call1((shape.to_vec(), dtype, own))
}

/// A `voltet.Picture` of the very memory that it was drawn into: float32, height × width × 4, that may be written.
pub fn handed_over(py: Python<'_>, picture: Picture) -> PyResult<Bound<'_, PyAny>> {
    static PICTURE: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let Picture { width, height, rgba } = picture;
    let own = Bound::new(py, Memory(UnsafeCell::new(rgba)))?;
    PICTURE.import(py, "voltet._picture", "Picture")?.call1(([height, width, 4], "f4", own))
}

/// Pixels that Python reads and writes; Rust no longer does.
#[pyclass(frozen, module = "voltet._native")]
struct Memory(UnsafeCell<Vec<[f32; 4]>>);

// SAFETY: no reference to the numbers is ever made here, only their address and count are given away, and neither changes.
unsafe impl Sync for Memory {}

#[pymethods]
impl Memory {
    /// Python's buffer protocol: bytes that may be written.
    ///
    /// # Safety
    /// Python alone calls it, with a view to fill.
    unsafe fn __getbuffer__(slf: Bound<'_, Self>, view: *mut ffi::Py_buffer, flags: c_int) -> PyResult<()> {
        let numbers = slf.get().0.get();
        // SAFETY: the vector stays as it is for as long as the object lives, which the view holds.
        let filled = unsafe {
            let bytes = (*numbers).len() * size_of::<[f32; 4]>();
            ffi::PyBuffer_FillInfo(
                view,
                slf.as_ptr(),
                (*numbers).as_mut_ptr().cast(),
                bytes as isize,
                0,
                flags,
            )
        };
        match filled {
            0 => Ok(()),
            _ => Err(PyErr::fetch(slf.py())),
        }
    }
}

/// A picture as the bytes of a file, in the format that its path ends in; `background`: linear RGB, for formats without opacity.
#[pyfunction]
pub fn encode<'py>(
    py: Python<'py>,
    rgba: &Bound<'py, PyAny>,
    path: &str,
    background: [f64; 3],
) -> PyResult<Bound<'py, pyo3::types::PyBytes>> {
    let [height, width, _] = rgba.getattr("shape")?.extract::<[usize; 3]>()?;
    let lent: Lent<f32> = Lent::borrow("the picture", rgba)?;
    let rgba = lent.values().as_chunks::<4>().0.to_vec();
    let bytes = crate::error::guarded(py, || {
        crate::error::refuse_forked()?;
        let picture = Picture { width, height, rgba };
        let format = voltet_io::encode::format_by_ending(path.as_ref())?;
        let form = voltet_io::encode::SampleForm::over(background);
        format.file(&picture, form, None).map(|(file, _)| file)
    })?;
    Ok(pyo3::types::PyBytes::new(py, &bytes))
}

/// The bytes of a piece.
const TOGETHER: usize = 1 << 18;

/// The bytes of an array, and a fingerprint of every piece of them as it was.
pub struct Watched {
    memory: Lent<u8>,
    prints: Vec<u64>,
}

impl Watched {
    /// As the bytes are now; on all cores.
    pub fn new(memory: Lent<u8>) -> Watched {
        let prints = memory.values().par_chunks(TOGETHER).map(hash_of_bytes).collect();
        Watched { memory, prints }
    }

    /// The pieces.
    pub fn pieces(&self) -> impl Iterator<Item = Piece<'_>> {
        self.memory.values().chunks(TOGETHER).zip(self.prints.iter().copied())
    }
}

/// Bytes, and their former fingerprint.
pub type Piece<'a> = (&'a [u8], u64);

/// True if the bytes have changed.
pub fn is_changed((bytes, print): &Piece<'_>) -> bool {
    hash_of_bytes(bytes) != *print
}

/// True if any piece has changed; on all cores.
pub fn any_changed(pieces: &[Piece<'_>]) -> bool {
    pieces.par_iter().any(is_changed)
}

/// The scalar, and g and ∇s where they are requested and available; NaN at points of no cell.
pub fn in_caller_order<'py>(
    py: Python<'py>,
    volume: &Volume,
    magnitude: bool,
    gradient: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let grid = &*volume.grid;
    let joined = grid.file_cells.as_ref().and_then(|cells| cells.joined_points.as_ref());
    let grid_point = |point: usize| match &grid.file_cells {
        Some(cells) => cells.grid_point(joined.map_or(point, |joined| joined[point] as usize)),
        None => Some(point),
    };
    let count = grid.file_cells.as_ref().map_or(grid.points.len(), |cells| cells.points.len());
    let count = joined.map_or(count, Vec::len);
    let numbers = |values: &[f64]| -> Vec<f64> {
        (0..count).map(|point| grid_point(point).map_or(f64::NAN, |p| values[p])).collect()
    };
    let arrays = PyDict::new(py);
    arrays.set_item("scalar", array(py, "f8", &numbers(&volume.scalar), &[count])?)?;
    if let Some(g) = volume.gradient_magnitude.as_ref().filter(|_| magnitude) {
        arrays.set_item("gradient_magnitude", array(py, "f8", &numbers(g), &[count])?)?;
    }
    if let Some(vectors) = volume.gradient.as_ref().filter(|_| gradient) {
        let all: Vec<DVec3> =
            (0..count).map(|point| grid_point(point).map_or(DVec3::NAN, |p| vectors[p])).collect();
        arrays.set_item("gradient", array(py, "f8", &all, &[count, 3])?)?;
    }
    Ok(arrays)
}
