//! Trees of Conduit, made by its C interface.

use crate::library::library;
use catalyst_voltet::conduit::Node;
use catalyst_voltet::simulation::Simulation;
use libloading::os::unix::Library;
use std::any::Any;
use std::ffi::{CString, c_char, c_void};
use std::sync::Arc;
use voltet_graph::ranks::Ranks;

/// A tree, with the arrays that its leaves lend.
pub struct Tree {
    root: *mut c_void,
    /// Path that is put before others.
    within: String,
    arrays: Vec<Box<dyn Any>>,
}

/// A number that Conduit has arrays of.
pub trait Number: Copy + 'static {
    /// Its name in Conduit's functions.
    const NAME: &'static str;
}

macro_rules! numbers {
    ($($type:ident $name:literal)*) => {
        $(impl Number for $type {
            const NAME: &'static str = $name;
        })*
    };
}

numbers! {
    i8 "int8" i16 "int16" i32 "int32" i64 "int64" u8 "uint8" u16 "uint16" u32 "uint32" u64 "uint64" f32 "float32" f64 "float64"
}

/// A function of Conduit.
///
/// # Safety
/// `F` is its type.
unsafe fn function<F: Copy>(name: &str) -> F {
    // SAFETY: the caller's promise.
    *unsafe { Library::this().get::<F>(format!("catalyst_conduit_{name}\0").as_bytes()) }.unwrap()
}

impl Tree {
    pub fn new() -> Tree {
        library().expect("a compiler for the stand-in of Conduit");
        // SAFETY: as Conduit's header declares it.
        let root = unsafe { function::<unsafe extern "C" fn() -> *mut c_void>("node_create")() };
        Tree { root, within: String::new(), arrays: Vec::new() }
    }

    /// Puts a path before those that follow.
    pub fn within(mut self, path: &str) -> Tree {
        self.within = path.into();
        self
    }

    fn path(&self, path: &str) -> CString {
        let is_whole = self.within.is_empty();
        CString::new(if is_whole { path.into() } else { format!("{}/{path}", self.within) }).unwrap()
    }

    pub fn text(self, path: &str, text: &str) -> Tree {
        let text = CString::new(text).unwrap();
        // SAFETY: as Conduit's header declares it.
        unsafe {
            let set: unsafe extern "C" fn(*mut c_void, *const c_char, *const c_char) =
                function("node_set_path_char8_str");
            set(self.root, self.path(path).as_ptr(), text.as_ptr());
        }
        self
    }

    /// Makes an empty node.
    pub fn fetch(self, path: &str) -> Tree {
        // SAFETY: as Conduit's header declares it.
        unsafe {
            let fetch: unsafe extern "C" fn(*mut c_void, *const c_char) -> *mut c_void =
                function("node_fetch");
            fetch(self.root, self.path(path).as_ptr());
        }
        self
    }

    /// Adds a text to a list.
    pub fn append(self, path: &str, text: &str) -> Tree {
        let text = CString::new(text).unwrap();
        // SAFETY: as Conduit's header declares them.
        unsafe {
            let fetch: unsafe extern "C" fn(*mut c_void, *const c_char) -> *mut c_void =
                function("node_fetch");
            let append: unsafe extern "C" fn(*mut c_void) -> *mut c_void = function("node_append");
            let set: unsafe extern "C" fn(*mut c_void, *const c_char) = function("node_set_char8_str");
            set(append(fetch(self.root, self.path(path).as_ptr())), text.as_ptr());
        }
        self
    }

    pub fn int64(self, path: &str, value: i64) -> Tree {
        self.one(path, value)
    }

    pub fn float64(self, path: &str, value: f64) -> Tree {
        self.one(path, value)
    }

    fn one<T: Number>(self, path: &str, value: T) -> Tree {
        // SAFETY: as Conduit's header declares it.
        unsafe {
            let set: unsafe extern "C" fn(*mut c_void, *const c_char, T) =
                function(&format!("node_set_path_{}", T::NAME));
            set(self.root, self.path(path).as_ptr(), value);
        }
        self
    }

    /// Lends an array.
    pub fn array<T: Number>(self, path: &str, values: Vec<T>) -> Tree {
        let count = values.len();
        self.strided(&[path], values, count, size_of::<T>(), 0)
    }

    /// Lends an array of tuples, each component under a path of its own.
    pub fn tuples<T: Number>(self, paths: &[&str], values: Vec<T>) -> Tree {
        let count = values.len() / paths.len();
        let stride = paths.len() * size_of::<T>();
        self.strided(paths, values, count, stride, 0)
    }

    /// Lends numbers of one array, the first of each path behind that of the one before; `endianness`: Conduit's number, 0 for this
    /// machine's.
    pub fn strided<T: Number>(
        mut self,
        paths: &[&str],
        mut values: Vec<T>,
        count: usize,
        stride: usize,
        endianness: i64,
    ) -> Tree {
        type Lend<T> = unsafe extern "C" fn(*mut c_void, *const c_char, *mut T, i64, i64, i64, i64, i64);
        for (number, path) in paths.iter().enumerate() {
            let bytes = size_of::<T>() as i64;
            // SAFETY: as Conduit's header declares it; the tree keeps the array.
            unsafe {
                let lend: Lend<T> = function(&format!("node_set_path_external_{}_ptr_detailed", T::NAME));
                let path = self.path(path);
                let offset = number as i64 * bytes;
                let values = values.as_mut_ptr();
                lend(
                    self.root,
                    path.as_ptr(),
                    values,
                    count as i64,
                    offset,
                    stride as i64,
                    bytes,
                    endianness,
                );
            }
        }
        self.arrays.push(Box::new(values));
        self
    }

    pub fn root(&self) -> *mut c_void {
        self.root
    }

    pub fn node(&self) -> Node<'_> {
        // SAFETY: the tree lives, and nothing changes it.
        unsafe { Node::root(self.root) }.unwrap()
    }

    /// Initializes a simulation with the tree.
    pub fn simulation(&self, ranks: Arc<dyn Ranks>) -> voltet::Result<Simulation> {
        Simulation::initialize(&self.node(), ranks)
    }

    /// Carries out a step with the tree.
    pub fn execute(&self, simulation: &mut Simulation) -> voltet::Result<()> {
        simulation.execute(&self.node())
    }
}

impl Drop for Tree {
    fn drop(&mut self) {
        // SAFETY: as Conduit's header declares it; once.
        unsafe { function::<unsafe extern "C" fn(*mut c_void)>("node_destroy")(self.root) }
    }
}
