//! Nodes of Conduit, read through its C interface. Its functions are those of the process: libcatalyst has them under names that begin
//! with `catalyst_`, or is linked with a Conduit of its own.

use libloading::os::unix::{Library, RTLD_LAZY};
use rayon::prelude::*;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::marker::PhantomData;
use std::sync::{Arc, OnceLock};
use voltet_core::{Error, Result, counted};

/// Proof that the simulation's memory is borrowed, which the borrowed arrays hold.
pub type Loan = Arc<dyn Send + Sync>;

/// `conduit_node` and `conduit_datatype`, of which only addresses are known here.
type Opaque = c_void;

/// `conduit_index_t`, of 64 bits as Conduit is built by default.
type Index = i64;

/// Names under which a loaded library may have the functions where they are not the process's: a Python module loads them for itself.
const LIBRARIES: [&str; 4] = ["libcatalyst.so.3", "libcatalyst.so.2", "libcatalyst.so", "libconduit.so"];

/// Beginnings of the functions' names: in a Conduit inside of libcatalyst, and in one by itself.
const PREFIXES: [&str; 2] = ["catalyst_conduit_", "conduit_"];

macro_rules! functions {
    ($($name:ident: fn($($argument:ty),*) $(-> $output:ty)?;)*) => {
        /// Functions of Conduit, by their names without the beginning `conduit_`.
        #[derive(Debug)]
        #[allow(missing_docs)]
        struct Functions {
            $($name: unsafe extern "C" fn($($argument),*) $(-> $output)?,)*
            /// The library that has them stays loaded.
            _library: Library,
        }

        impl Functions {
            /// The functions of a library under names of this beginning; `None` if one is missing.
            fn find(library: Library, prefix: &str) -> std::result::Result<Functions, Library> {
                $(
                    let name = format!("{prefix}{}\0", stringify!($name));
                    // SAFETY: the declaration is that of Conduit's header.
                    let $name = match unsafe { library.get(name.as_bytes()) } {
                        Ok(symbol) => *symbol,
                        Err(_) => return Err(library),
                    };
                )*
                Ok(Functions { $($name,)* _library: library })
            }
        }
    };
}

functions! {
    node_number_of_children: fn(*mut Opaque) -> Index;
    node_child: fn(*mut Opaque, Index) -> *mut Opaque;
    node_has_path: fn(*const Opaque, *const c_char) -> c_int;
    node_fetch_existing: fn(*mut Opaque, *const c_char) -> *mut Opaque;
    node_name: fn(*const Opaque) -> *mut c_char;
    node_dtype: fn(*const Opaque) -> *const Opaque;
    node_element_ptr: fn(*mut Opaque, Index) -> *mut c_void;
    node_set_path_char8_str: fn(*mut Opaque, *const c_char, *const c_char);
    node_set_path_int32: fn(*mut Opaque, *const c_char, i32);
    datatype_id: fn(*const Opaque) -> Index;
    datatype_number_of_elements: fn(*const Opaque) -> Index;
    datatype_stride: fn(*const Opaque) -> Index;
    datatype_element_bytes: fn(*const Opaque) -> Index;
    datatype_endianness_matches_machine: fn(*const Opaque) -> c_int;
}

/// Functions of the process, looked for once they are needed.
static FUNCTIONS: OnceLock<Functions> = OnceLock::new();

/// The functions, found the first time.
fn functions() -> Result<&'static Functions> {
    if let Some(found) = FUNCTIONS.get() {
        return Ok(found);
    }
    let loaded = LIBRARIES.iter().filter_map(|name| {
        // SAFETY: nothing is loaded that is not there already.
        unsafe { Library::open(Some(name), RTLD_LAZY | libc::RTLD_NOLOAD) }.ok()
    });
    for mut library in std::iter::once(Library::this()).chain(loaded) {
        for prefix in PREFIXES {
            match Functions::find(library, prefix) {
                Ok(found) => return Ok(FUNCTIONS.get_or_init(|| found)),
                Err(back) => library = back,
            }
        }
    }
    let error = Error::run("the process has no functions of Conduit");
    Err(error.got("neither catalyst_conduit_node_dtype nor conduit_node_dtype").expected(
        "a simulation that is linked with libcatalyst 2, or with a Conduit of version 0.7 or later, as a shared library",
    ))
}

/// A node of a tree that the simulation holds.
#[derive(Debug, Clone)]
pub struct Node<'a> {
    pointer: *mut Opaque,
    functions: &'static Functions,
    /// Path from the root, for errors.
    path: String,
    tree: PhantomData<&'a ()>,
}

impl<'a> Node<'a> {
    /// The root of a tree.
    ///
    /// # Errors
    /// - a null pointer;
    /// - a process without Conduit.
    ///
    /// # Safety
    /// `pointer` is null or a `conduit_node` whose tree and arrays stay as they are for `'a`.
    pub unsafe fn root(pointer: *const c_void) -> Result<Node<'a>> {
        let functions = functions()?;
        if pointer.is_null() {
            return Err(Error::usage("the node is missing").got("a null pointer").expected("a conduit_node"));
        }
        Ok(Node { pointer: pointer.cast_mut(), functions, path: String::new(), tree: PhantomData })
    }

    /// Its path from the root.
    pub fn path(&self) -> &str {
        if self.path.is_empty() { "the node" } else { &self.path }
    }

    /// Name of the last step of its path.
    pub fn name(&self) -> &str {
        self.path.rsplit('/').next().unwrap_or_default()
    }

    fn inner(&self, pointer: *mut Opaque, name: &str) -> Node<'a> {
        let path = if self.path.is_empty() { name.to_string() } else { format!("{}/{name}", self.path) };
        Node { pointer, path, ..self.clone() }
    }

    /// The node at a path below it, where there is one.
    pub fn get(&self, path: &str) -> Option<Node<'a>> {
        let text = CString::new(path).ok()?;
        // SAFETY: the node lives; a path that is there can be fetched.
        let pointer = unsafe {
            if (self.functions.node_has_path)(self.pointer, text.as_ptr()) == 0 {
                return None;
            }
            (self.functions.node_fetch_existing)(self.pointer, text.as_ptr())
        };
        (!pointer.is_null()).then(|| self.inner(pointer, path))
    }

    /// The node at a path below it. Errors: there is none.
    pub fn require(&self, path: &str) -> Result<Node<'a>> {
        self.get(path).ok_or_else(|| {
            let missing =
                if self.path.is_empty() { path.to_string() } else { format!("{}/{path}", self.path) };
            let parent = path.rsplit_once('/').map_or(Some(self.clone()), |(parent, _)| self.get(parent));
            let error = Error::usage(format!("{missing} is missing"));
            match parent.map(|parent| parent.child_names()).filter(|names| !names.is_empty()) {
                Some(names) => error.got(names.join(", ")),
                None => error,
            }
        })
    }

    fn child_names(&self) -> Vec<String> {
        self.children().iter().map(|child| child.name().to_string()).collect()
    }

    /// Its children; those of a list have their numbers as names.
    pub fn children(&self) -> Vec<Node<'a>> {
        // SAFETY: the node lives.
        let count = unsafe { (self.functions.node_number_of_children)(self.pointer) };
        (0..count)
            .map(|number| {
                // SAFETY: there are so many children.
                let pointer = unsafe { (self.functions.node_child)(self.pointer, number) };
                self.inner(pointer, &self.name_of(pointer).unwrap_or_else(|| number.to_string()))
            })
            .collect()
    }

    /// Name of a child; `None` in a list.
    fn name_of(&self, child: *const Opaque) -> Option<String> {
        // SAFETY: the child lives; the text is a copy, to be freed.
        unsafe {
            let text = (self.functions.node_name)(child);
            if text.is_null() {
                return None;
            }
            let name = CStr::from_ptr(text).to_string_lossy().into_owned();
            libc::free(text.cast());
            Some(name).filter(|name| !name.is_empty())
        }
    }

    /// The numbers of a leaf. Errors: a node that is no leaf of numbers of this machine.
    pub fn numbers(&self) -> Result<Numbers<'a>> {
        let (id, numbers) = self.leaf()?;
        let Some(kind) = NumberKind::ALL.into_iter().find(|kind| *kind as Index == id) else {
            return Err(self.wrong("holds no numbers", kind_of(id), "an array of numbers"));
        };
        Ok(Numbers { kind, ..numbers })
    }

    /// Kind and bytes of a leaf.
    fn leaf(&self) -> Result<(Index, Numbers<'a>)> {
        let functions = self.functions;
        // SAFETY: the node lives, and its datatype with it; a leaf with elements has the first.
        let (id, count, stride, bytes, is_native, first) = unsafe {
            let datatype = (functions.node_dtype)(self.pointer);
            let id = (functions.datatype_id)(datatype);
            let count = if id < FIRST_LEAF { 0 } else { (functions.datatype_number_of_elements)(datatype) };
            let first = match count {
                1.. => (functions.node_element_ptr)(self.pointer, 0),
                _ => std::ptr::null_mut(),
            };
            let stride = (functions.datatype_stride)(datatype);
            let bytes = (functions.datatype_element_bytes)(datatype);
            let is_native = count == 0 || (functions.datatype_endianness_matches_machine)(datatype) != 0;
            (id, count, stride, bytes, is_native, first)
        };
        if id < FIRST_LEAF {
            return Err(self.wrong("holds no numbers", kind_of(id), "an array"));
        }
        if count > 0 && first.is_null() {
            return Err(self.wrong("has no memory", "a null pointer", "the address of an array"));
        }
        if !is_native {
            return Err(self.wrong("is of another machine", "the other order of bytes", "this machine's"));
        }
        let kind = NumberKind::ALL.into_iter().find(|kind| *kind as Index == id);
        if let Some(size) = kind.map(NumberKind::size).filter(|size| *size as Index != bytes) {
            return Err(self.wrong("has elements of a wrong size", counted(bytes as usize, "byte"), size));
        }
        let numbers = Numbers {
            first: first.cast(),
            count: usize::try_from(count).unwrap_or(0),
            stride: stride as isize,
            kind: NumberKind::Int8,
            path: self.path.clone(),
            tree: PhantomData,
        };
        Ok((id, numbers))
    }

    /// The text of a leaf. Errors: a node that is no text in UTF-8.
    pub fn text(&self) -> Result<String> {
        let id = self.kind();
        if id != TEXT {
            return Err(self.wrong("is no text", kind_of(id), "a text"));
        }
        let (_, bytes) = self.leaf()?;
        // SAFETY: so many bytes are there.
        let bytes: Vec<u8> = (0..bytes.count).map(|place| unsafe { bytes.read(place) }).collect();
        let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
        String::from_utf8(bytes[..end].to_vec())
            .map_err(|error| self.wrong("is no UTF-8", error.utf8_error(), "text in UTF-8"))
    }

    /// Texts: those of its children, or its own. Errors: numbers, or a child that is no text.
    pub fn texts(&self) -> Result<Vec<String>> {
        match self.kind() {
            TEXT => Ok(vec![self.text()?]),
            id if id < FIRST_LEAF => self.children().iter().map(Node::text).collect(),
            id => Err(self.wrong("is no list of texts", kind_of(id), "a list of texts")),
        }
    }

    /// Conduit's number of its kind.
    fn kind(&self) -> Index {
        // SAFETY: the node lives, and its datatype with it.
        unsafe { (self.functions.datatype_id)((self.functions.node_dtype)(self.pointer)) }
    }

    /// The text of a leaf below it. Errors: no such node, or no text.
    pub fn text_at(&self, path: &str) -> Result<String> {
        self.require(path)?.text()
    }

    /// The only number of a leaf. Errors: a node with another count of numbers than one.
    pub fn number(&self) -> Result<f64> {
        let numbers = self.numbers()?;
        match numbers.count {
            1 => Ok(numbers.number(0)),
            count => Err(self.wrong("is no number", counted(count, "number"), "one number")),
        }
    }

    /// The only number of a leaf, which is whole and not negative. Errors: another number.
    pub fn count(&self) -> Result<usize> {
        let number = self.number()?;
        match number {
            0.0..9.0e15 if number.fract() == 0.0 => Ok(number as usize),
            _ => Err(self.wrong("is out of range", number, "a whole number, 0 or more")),
        }
    }

    /// An error about it.
    pub fn wrong(
        &self,
        what: &str,
        found: impl std::fmt::Display,
        accepted: impl std::fmt::Display,
    ) -> Error {
        Error::usage(format!("{} {what}", self.path())).got(found).expected(accepted)
    }

    /// Sets a text below it.
    pub fn set_text(&self, path: &str, text: &str) {
        if let (Ok(path), Ok(text)) = (CString::new(path), CString::new(text)) {
            // SAFETY: the node lives; both are copied.
            unsafe { (self.functions.node_set_path_char8_str)(self.pointer, path.as_ptr(), text.as_ptr()) }
        }
    }

    /// Sets a whole number below it.
    pub fn set_integer(&self, path: &str, number: i32) {
        if let Ok(path) = CString::new(path) {
            // SAFETY: the node lives.
            unsafe { (self.functions.node_set_path_int32)(self.pointer, path.as_ptr(), number) }
        }
    }
}

const FIRST_LEAF: Index = NumberKind::Int8 as Index;
/// Number of texts.
const TEXT: Index = 13;

/// Name of a kind of node in errors.
fn kind_of(id: Index) -> &'static str {
    match id {
        0 => "nothing",
        1 => "an object",
        2 => "a list",
        TEXT => "a text",
        _ => "numbers",
    }
}

/// Type of an array's numbers, with Conduit's number of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum NumberKind {
    Int8 = 3,
    Int16 = 4,
    Int32 = 5,
    Int64 = 6,
    Uint8 = 7,
    Uint16 = 8,
    Uint32 = 9,
    Uint64 = 10,
    Float32 = 11,
    Float64 = 12,
}

impl NumberKind {
    /// All kinds.
    pub const ALL: [NumberKind; 10] = {
        use NumberKind::*;
        [Int8, Int16, Int32, Int64, Uint8, Uint16, Uint32, Uint64, Float32, Float64]
    };

    /// Bytes of a number.
    pub fn size(self) -> usize {
        match self {
            NumberKind::Int8 | NumberKind::Uint8 => 1,
            NumberKind::Int16 | NumberKind::Uint16 => 2,
            NumberKind::Int32 | NumberKind::Uint32 | NumberKind::Float32 => 4,
            NumberKind::Int64 | NumberKind::Uint64 | NumberKind::Float64 => 8,
        }
    }

    /// True for whole numbers.
    pub fn is_whole(self) -> bool {
        !matches!(self, NumberKind::Float32 | NumberKind::Float64)
    }
}

/// Numbers of an array in the simulation's memory, with any bytes between them.
#[derive(Debug, Clone)]
pub struct Numbers<'a> {
    first: *const u8,
    /// Number of them.
    pub count: usize,
    /// Bytes from one to the next.
    stride: isize,
    /// Their type.
    pub kind: NumberKind,
    /// Path of the node, for errors.
    pub path: String,
    tree: PhantomData<&'a ()>,
}

// SAFETY: the simulation does not change them while they are read.
unsafe impl Sync for Numbers<'_> {}

impl Numbers<'_> {
    /// A number of the array's own type.
    ///
    /// # Safety
    /// `place` is below the count, and `T` the type of the numbers.
    unsafe fn read<T>(&self, place: usize) -> T {
        // SAFETY: the simulation's promise for each place; any alignment is read.
        unsafe { self.first.offset(place as isize * self.stride).cast::<T>().read_unaligned() }
    }

    /// One of the numbers, in 64 bits.
    ///
    /// # Panics
    /// - a place beyond the count.
    pub fn number(&self, place: usize) -> f64 {
        assert!(place < self.count, "{place} of {}", self.count);
        // SAFETY: the place is there, and the type the kind's.
        unsafe {
            match self.kind {
                NumberKind::Int8 => f64::from(self.read::<i8>(place)),
                NumberKind::Int16 => f64::from(self.read::<i16>(place)),
                NumberKind::Int32 => f64::from(self.read::<i32>(place)),
                NumberKind::Int64 => self.read::<i64>(place) as f64,
                NumberKind::Uint8 => f64::from(self.read::<u8>(place)),
                NumberKind::Uint16 => f64::from(self.read::<u16>(place)),
                NumberKind::Uint32 => f64::from(self.read::<u32>(place)),
                NumberKind::Uint64 => self.read::<u64>(place) as f64,
                NumberKind::Float32 => f64::from(self.read::<f32>(place)),
                NumberKind::Float64 => self.read::<f64>(place),
            }
        }
    }

    /// One of the whole numbers; the nearest of 64 bits with a sign.
    fn integer(&self, place: usize) -> i64 {
        match self.kind {
            // SAFETY: `values` asks for places that are there.
            NumberKind::Int64 => unsafe { self.read::<i64>(place) },
            // SAFETY: as before.
            NumberKind::Uint64 => i64::try_from(unsafe { self.read::<u64>(place) }).unwrap_or(i64::MAX),
            _ => self.number(place) as i64,
        }
    }

    /// A copy in 64 bits.
    pub fn to_f64(&self) -> Vec<f64> {
        (0..self.count).into_par_iter().map(|place| self.number(place)).collect()
    }

    /// A copy of whole numbers, each checked and converted by `convert`.
    /// Errors: numbers that are not whole, or that `convert` refuses; the first is named. `accepted`: what would be right.
    pub fn to_whole<T: Send>(
        &self,
        accepted: impl std::fmt::Display,
        convert: impl Fn(i64) -> Option<T> + Sync,
    ) -> Result<Vec<T>> {
        if !self.kind.is_whole() {
            let error = Error::usage(format!("{} has the wrong type", self.path));
            return Err(error.got(format!("{:?}", self.kind)).expected("whole numbers"));
        }
        let each = |place| convert(self.integer(place)).ok_or(place);
        let converted: std::result::Result<Vec<T>, usize> =
            (0..self.count).into_par_iter().map(each).collect();
        converted.map_err(|_| {
            let found = (0..self.count).find(|&place| convert(self.integer(place)).is_none());
            let place = found.unwrap_or_default();
            let error = Error::usage(format!("{}[{place}] is out of range", self.path));
            error.got(self.integer(place)).expected(accepted)
        })
    }

    /// The numbers as they stand, where they lie side by side.
    ///
    /// # Safety
    /// The memory stays unchanged as long as the slice is used; `T` is a number, or an array of numbers, of the type that `kinds` have.
    pub unsafe fn lent<T>(&self, kinds: &[NumberKind]) -> Option<&'static [T]> {
        let (size, per_item) = (self.kind.size(), size_of::<T>() / self.kind.size());
        let first = self.first.cast::<T>();
        let fits = kinds.contains(&self.kind)
            && (self.stride == size as isize || self.count < 2)
            && first.is_aligned()
            && !first.is_null()
            && self.count.is_multiple_of(per_item);
        // SAFETY: not null, aligned, side by side; the rest is the caller's promise.
        fits.then(|| unsafe { std::slice::from_raw_parts(first, self.count / per_item) })
    }

    /// Components of tuples as they stand, where these lie side by side in memory: x, y, z, x, y, z, …
    ///
    /// # Safety
    /// As of [`Numbers::lent`].
    pub unsafe fn lent_tuples(components: &[Numbers]) -> Option<&'static [f64]> {
        let [first, ..] = components else { return None };
        let width = components.len() as isize * size_of::<f64>() as isize;
        let interleaved = components.iter().enumerate().all(|(number, own)| {
            own.kind == NumberKind::Float64
                && own.count == first.count
                && (own.stride == width || own.count < 2)
                && own.first as isize == first.first as isize + (number * size_of::<f64>()) as isize
        });
        let start = first.first.cast::<f64>();
        let fits = interleaved && start.is_aligned() && !start.is_null();
        // SAFETY: not null, aligned, side by side; the rest is the caller's promise.
        fits.then(|| unsafe { std::slice::from_raw_parts(start, first.count * components.len()) })
    }

    /// A copy of tuples whose components are these arrays of one length.
    pub fn to_tuples(components: &[Numbers]) -> Vec<f64> {
        let count = components.first().map_or(0, |own| own.count);
        let mut tuples = vec![0.0; count * components.len()];
        let chunks = tuples.par_chunks_exact_mut(components.len().max(1)).enumerate();
        chunks.for_each(|(place, tuple)| {
            tuple.iter_mut().zip(components).for_each(|(value, own)| *value = own.number(place));
        });
        tuples
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_without_conduit_is_told_so() {
        // SAFETY: a null pointer.
        let error = unsafe { Node::root(std::ptr::null()) }.unwrap_err().to_string();
        assert!(error.contains("no functions of Conduit") && error.contains("libcatalyst"), "{error}");
    }
}
