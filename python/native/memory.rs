//! Arrays of Python that are lent, and arrays for Python.

use pyo3::buffer::{Element, PyBuffer};
use pyo3::prelude::*;
use pyo3::types::PyByteArray;
use rayon::prelude::*;
use std::sync::Arc;
use voltet_core::Error;
use voltet_core::picture::Picture;
use voltet_nodes::encode as file;

/// Memory of a Python object that stays where it is: the object is held, and told not to move it.
#[derive(Clone)]
pub struct Lent<T: 'static> {
    values: &'static [T],
    keep: Arc<PyBuffer<T>>,
}

impl<T: Element + Sync> Lent<T> {
    /// The memory of an array of this type whose rows lie one after the other; `name` is for messages.
    pub fn of(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Lent<T>> {
        let wrong = |found: String| {
            let error = Error::usage(format!("{name} cannot be lent")).found(found);
            let error = error.accepted("a C-contiguous array of the type that voltet.Grid makes of it");
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

    /// What holds the memory.
    pub fn keep(&self) -> Arc<PyBuffer<T>> {
        self.keep.clone()
    }
}

/// Bytes that one task hashes.
const TOGETHER: usize = 1 << 18;

/// A number made of all bytes, on all cores: other bytes have another, but for chance. The sums of eight lanes of 64-bit words,
/// each multiplied by an odd number of its own, so that the memory is what it waits for.
pub fn fingerprint(bytes: &[u8]) -> u64 {
    let parts = bytes.par_chunks(TOGETHER).enumerate();
    let sum =
        parts.map(|(i, part)| of_part(part).wrapping_mul(odd(i as u64))).reduce(|| 0, u64::wrapping_add);
    // Once, and not by every task that adds up a share.
    sum.wrapping_add(bytes.len() as u64)
}

fn of_part(bytes: &[u8]) -> u64 {
    let (words, rest) = bytes.as_chunks::<64>();
    let mut lanes: [u64; 8] = std::array::from_fn(|i| odd(i as u64));
    for word in words {
        for (lane, eight) in lanes.iter_mut().zip(word.as_chunks::<8>().0) {
            *lane = (*lane ^ u64::from_le_bytes(*eight)).wrapping_mul(MULTIPLIER).rotate_left(29);
        }
    }
    for &byte in rest {
        lanes[0] = (lanes[0] ^ u64::from(byte)).wrapping_mul(MULTIPLIER);
    }
    lanes.iter().fold(0, |sum, &lane| (sum ^ lane ^ (lane >> 32)).wrapping_mul(MULTIPLIER))
}

/// Of Steele and Vigna (2021), for 64 bits.
const MULTIPLIER: u64 = 0xd134_2543_de82_ef95;

fn odd(i: u64) -> u64 {
    (i + 1).wrapping_mul(MULTIPLIER) | 1
}

/// A numpy array of its own memory, that may be written: these numbers as elements of `dtype`.
pub fn array<'py, T: bytemuck::NoUninit>(
    py: Python<'py>,
    dtype: &str,
    numbers: &[T],
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    let own = PyByteArray::new(py, bytemuck::cast_slice(numbers));
    let array = py.import("numpy")?.call_method1("frombuffer", (own, dtype))?;
    array.call_method1("reshape", (shape.to_vec(),))
}

/// A picture as the bytes of a file: `form` is "png" (8-bit sRGB over a background in linear RGB) or "exr".
#[pyfunction]
pub fn encode<'py>(
    py: Python<'py>,
    rgba: &Bound<'py, PyAny>,
    form: &str,
    background: [f64; 3],
) -> PyResult<Bound<'py, pyo3::types::PyBytes>> {
    let [height, width, _] = rgba.getattr("shape")?.extract::<[usize; 3]>()?;
    let lent: Lent<f32> = Lent::of("the picture", rgba)?;
    let rgba = lent.values().as_chunks::<4>().0.to_vec();
    let bytes = crate::error::guarded(py, || {
        let picture = Picture { width, height, rgba };
        match form {
            "exr" => file::exr(&picture, None),
            _ => file::png(&picture, background, None),
        }
    })?;
    Ok(pyo3::types::PyBytes::new(py, &bytes))
}
