//! Data items of XDMF: numbers in HDF5, in files of bytes or in the XML itself, and parts of them.

use super::paths::Document;
use crate::formats::contents::{Compute, Encoding, Stored};
use crate::formats::hdf5::{Array, Extent, Group};
use crate::formats::numbers::{ByteOrder, NumberType};
use crate::formats::source::Source;
use crate::formats::xml::header::Element;
use crate::formats::xml::{beside, open_named};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;
use voltet_core::{Error, Result};

/// Deepest nesting of items in items.
const MAX_DEPTH: usize = 8;

/// The items of a document, and the files that they lie in.
pub(super) struct Items<'a> {
    pub document: Document<'a>,
    source: Arc<Source>,
    /// Files in HDF5, by their roots.
    opened: RefCell<Vec<(PathBuf, Group)>>,
    /// Files of bytes.
    binary: RefCell<Vec<Arc<Source>>>,
}

/// An item: its numbers, one a tuple, and how many along each axis.
pub(super) struct Item {
    pub stored: Stored,
    pub shape: Vec<u64>,
    /// The array of an item that is all of one in HDF5.
    array: Option<Array>,
}

impl Item {
    pub fn count(&self) -> u64 {
        self.stored.tuple_count.unwrap_or(0)
    }

    pub fn tuples(self, name: &str, component_count: usize) -> Stored {
        let tuple_count = Some(self.count() / component_count.max(1) as u64);
        Stored { name: name.to_owned(), component_count, tuple_count, ..self.stored }
    }

    pub fn numbers(&self) -> Result<Vec<f64>> {
        self.stored.load(&crate::formats::contents::Meter::new(&voltet_core::progress::NoProgress, 1))
    }
}

fn product(shape: &[u64]) -> Result<u64> {
    let product = shape.iter().try_fold(1_u64, |product, &n| product.checked_mul(n));
    product.ok_or_else(|| Error::run("the item cannot be that large").got(format_args!("{shape:?}")))
}

pub(super) fn whole(text: &str) -> Option<Vec<u64>> {
    text.split_ascii_whitespace().map(|word| word.parse().ok()).collect()
}

/// File and path of `file.h5:/path`, after which a part may stand.
fn place_in_hdf5(text: &str) -> Option<(&str, &str)> {
    text.split('|').next()?.trim().rsplit_once(':')
}

/// The part of a data set that stands after its path: starts, strides and counts, which XDMF 3 follows by the size of the whole.
fn extents(selection: &str) -> Result<Vec<Extent>> {
    if selection.contains('|') {
        let error = Error::run("a data item of several datasets is not read");
        return Err(error.got(format_args!("'{selection}'")).expected("one dataset in each data item"));
    }
    let numbers: Option<Vec<Vec<u64>>> = selection.split(':').take(3).map(whole).collect();
    match numbers.as_deref() {
        Some([start, stride, count]) if [start.len(), stride.len()] == [count.len(); 2] => {
            Ok(start.iter().zip(stride).zip(count).map(|((&first, &step), &n)| (first, n, step)).collect())
        }
        _ => Err(Error::run("the part of a data item is damaged")
            .got(format_args!("'{selection}'"))
            .expected("starts, strides and counts of each axis, with ':' between")),
    }
}

impl<'a> Items<'a> {
    pub fn new(source: &'a Arc<Source>, root: &'a Element) -> Items<'a> {
        let document = Document::new(source, root);
        Items { document, source: source.clone(), opened: RefCell::default(), binary: RefCell::default() }
    }

    /// Files that items lie in, of those that were read.
    pub fn files(&self) -> Vec<PathBuf> {
        let opened = self.opened.borrow();
        let linked =
            opened.iter().flat_map(|(path, root)| std::iter::once(path.clone()).chain(root.linked_files()));
        linked.chain(self.binary.borrow().iter().map(|source| source.path().to_owned())).collect()
    }

    /// Files that the items in an element name, whatever step they are of, each once.
    pub fn files_below(&self, root: &Element) -> BTreeSet<PathBuf> {
        let (mut files, mut pending) = (BTreeSet::new(), vec![root]);
        while let Some(element) = pending.pop() {
            pending.extend(&element.children);
            let format = element.attribute("Format").filter(|_| element.tag == "DataItem").unwrap_or("XML");
            if !["Binary", "HDF", "HDF5"].contains(&format) {
                continue;
            }
            // What cannot be read is an error of the reading itself.
            let Ok(text) = self.document.text(element) else { continue };
            let name = if format == "Binary" {
                Some(text.as_str())
            } else {
                place_in_hdf5(&text).map(|place| place.0)
            };
            files.extend(name.map(|name| beside(self.source.path(), name)));
        }
        files
    }

    /// Bytes of the file and of those that items lie in.
    pub fn file_bytes(&self) -> u64 {
        let in_hdf5: u64 = self.opened.borrow().iter().map(|(_, root)| root.file_bytes()).sum();
        let binary: u64 = self.binary.borrow().iter().map(|source| source.len()).sum();
        self.source.len().saturating_add(in_hdf5).saturating_add(binary)
    }

    /// Reads the headers of the items in an element.
    pub fn all<const N: usize>(&self, element: &'a Element) -> Result<[Item; N]> {
        let items = self.of_element(element)?;
        let found = items.len();
        let items = items.into_iter().map(|item| self.item(item, 0)).collect::<Result<Vec<Item>>>()?;
        items.try_into().map_err(|_| {
            let error = Error::run(format!("<{}> holds the wrong number of data items", element.tag));
            error.got(found).expected(N)
        })
    }

    pub fn of_element(&self, element: &'a Element) -> Result<Vec<&'a Element>> {
        self.document.children_of(element, "DataItem")
    }

    pub fn only(&self, element: &'a Element) -> Result<Item> {
        self.all(element).map(|[item]| item)
    }

    /// Reads the header of an item.
    fn item(&self, element: &'a Element, depth: usize) -> Result<Item> {
        if depth > MAX_DEPTH {
            return Err(Error::run("data items stand too deep in others"));
        }
        let shape = element
            .attribute("Dimensions")
            .map(|text| whole(text).ok_or_else(|| element.wrong("Dimensions", "whole numbers")));
        let shape = shape.transpose()?;
        match element.attribute("ItemType").or(element.attribute("Type")).unwrap_or("Uniform") {
            "Uniform" => match element.attribute("Format").unwrap_or("XML") {
                "HDF" | "HDF5" => self.in_hdf5(element, shape),
                "Binary" => self.in_binary(element, shape),
                "XML" => self.in_xml(element, shape),
                _ => Err(element.wrong("Format", "HDF, Binary or XML")),
            },
            "HyperSlab" => self.slab(element, depth),
            "Function" => self.function(element, depth),
            _ => Err(element.wrong("ItemType", "Uniform, HyperSlab, or Function with JOIN")),
        }
    }

    /// `file.h5:/path`, in XDMF 3 with `|start:stride:count` after it.
    fn in_hdf5(&self, element: &Element, shape: Option<Vec<u64>>) -> Result<Item> {
        let text = self.document.text(element)?;
        let text = text.trim_end_matches(['|', ' ']);
        let (place, selection) =
            text.split_once('|').map_or((text, None), |(place, rest)| (place, Some(rest)));
        let Some((name, path)) = place_in_hdf5(place) else {
            let error =
                Error::run("a data item does not say where it lies in HDF5").got(format_args!("'{text}'"));
            return Err(error.expected("FILE.h5:/PATH"));
        };
        let file = beside(self.source.path(), name);
        let array = self.array(&file, path).map_err(|error| error.in_file(&file))?;
        let (stored, own_shape, array) = match selection {
            None => (array.stored(array.path(), 1)?, array.shape().to_vec(), Some(array)),
            Some(selection) => {
                let part = extents(selection)?;
                let counts = part.iter().map(|axis| axis.1).collect();
                (array.part(array.path(), &part, 1)?, counts, None)
            }
        };
        let shape = shape.unwrap_or_else(|| own_shape.clone());
        if Some(product(&shape)?) != stored.tuple_count {
            let error = Error::run("a data item has other dimensions than its dataset, or the part of it")
                .got(format_args!("{shape:?}"));
            return Err(error.expected(format_args!("{own_shape:?}")).at_item(&stored.name));
        }
        Ok(Item { stored, shape, array })
    }

    fn array(&self, file: &std::path::Path, path: &str) -> Result<Array> {
        let known = self.opened.borrow().iter().find(|(own, _)| own == file).map(|(_, root)| root.clone());
        let mut group = match known {
            Some(root) => root,
            None => {
                let source = open_named(self.source.path(), file, self.opened.borrow().len())?;
                let root = Group::root(source)?;
                self.opened.borrow_mut().push((file.to_owned(), root.clone()));
                root
            }
        };
        let steps: Vec<&str> = path.split('/').filter(|step| !step.is_empty()).collect();
        let (last, above) = steps
            .split_last()
            .ok_or_else(|| Error::run("a data item names no dataset").got(format_args!("'{path}'")))?;
        for step in above {
            group = group.required_group(step)?;
        }
        group.required_array(last)
    }

    /// Dimensions and type of the numbers.
    fn declared(&self, element: &Element, shape: Option<Vec<u64>>) -> Result<(Vec<u64>, NumberType)> {
        let shape = shape.ok_or_else(|| {
            element.required("Dimensions").err().unwrap_or_else(|| Error::run("no dimensions"))
        })?;
        let precision: u64 = element.number("Precision")?.unwrap_or(4);
        let name = element.attribute("NumberType").or(element.attribute("DataType")).unwrap_or("Float");
        let number_type = match (name, precision) {
            ("Float", 4) => NumberType::F32,
            ("Float", 8) => NumberType::F64,
            ("Int", 1) | ("Char", _) => NumberType::I8,
            ("Int", 2) | ("Short", _) => NumberType::I16,
            ("Int", 4) => NumberType::I32,
            ("Int", 8) => NumberType::I64,
            ("UInt", 1) | ("UChar", _) => NumberType::U8,
            ("UInt", 2) | ("UShort", _) => NumberType::U16,
            ("UInt", 4) => NumberType::U32,
            ("UInt", 8) => NumberType::U64,
            _ => {
                let error = Error::run("the type of a data item is not known")
                    .got(format_args!("{name} of {precision} bytes"));
                return Err(error
                    .expected("Float of 4 or 8 bytes, Int or UInt of 1 to 8, Char, UChar, Short or UShort"));
            }
        };
        Ok((shape, number_type))
    }

    fn in_binary(&self, element: &Element, shape: Option<Vec<u64>>) -> Result<Item> {
        if element.attribute("Compression").is_some_and(|codec| codec != "Raw") {
            return Err(element.wrong("Compression", "Raw"));
        }
        let order = match element.attribute("Endian").unwrap_or("Native") {
            "Little" | "Native" => ByteOrder::Little,
            "Big" => ByteOrder::Big,
            _ => return Err(element.wrong("Endian", "Little, Big or Native")),
        };
        let (shape, number_type) = self.declared(element, shape)?;
        let file = beside(self.source.path(), &self.document.text(element)?);
        let known = self.binary.borrow().iter().find(|source| source.path() == file).cloned();
        let source = match known {
            Some(source) => source,
            None => {
                let source = open_named(self.source.path(), &file, self.binary.borrow().len())?;
                self.binary.borrow_mut().push(source.clone());
                source
            }
        };
        let at = element.number("Seek")?.unwrap_or(0);
        let stored = Stored::of_f64(&source, &element.tag, 1, product(&shape)?, Encoding::Bytes(at));
        let bytes = stored.promised()?.and_then(|count| number_type.byte_count(count)).unwrap_or(u64::MAX);
        source.check(at, bytes)?;
        Ok(Item { stored: Stored { number_type, order, ..stored }, shape, array: None })
    }

    fn in_xml(&self, element: &Element, shape: Option<Vec<u64>>) -> Result<Item> {
        let (shape, number_type) = self.declared(element, shape)?;
        let encoding = Encoding::Text(element.text.clone());
        let stored = Stored::of_f64(&self.source, &element.tag, 1, product(&shape)?, encoding);
        // Text holds as many digits as its writer gave, whatever precision is meant.
        let number_type = if number_type == NumberType::F32 { NumberType::F64 } else { number_type };
        Ok(Item { stored: Stored { number_type, ..stored }, shape, array: None })
    }

    /// A box of an item; the first item in it holds starts, strides and counts.
    fn slab(&self, element: &'a Element, depth: usize) -> Result<Item> {
        let [selection, of] = self.of_element(element)?[..] else {
            return Err(Error::run("a HyperSlab needs two data items")
                .expected("starts, strides and counts; the data"));
        };
        let numbers = self.item(selection, depth + 1)?.numbers()?;
        let of = self.item(of, depth + 1)?;
        let axes = of.shape.len();
        let is_whole = |&n: &f64| n >= 0.0 && n.fract() == 0.0 && n < 9e15;
        if axes == 0 || numbers.len() != 3 * axes || !numbers.iter().all(is_whole) {
            let error =
                Error::run("the selection of a HyperSlab is damaged").got(format_args!("{numbers:?}"));
            return Err(error.expected(format_args!("starts, strides and counts of {axes} axes")));
        }
        let at = |place: usize| numbers[place] as u64;
        let part: Vec<Extent> =
            (0..axes).map(|axis| (at(axis), at(2 * axes + axis), at(axes + axis))).collect();
        let shape: Vec<u64> = part.iter().map(|axis| axis.1).collect();
        if let Some(array) = of.array.as_ref().filter(|array| array.shape() == of.shape) {
            return Ok(Item { stored: array.part(array.path(), &part, 1)?, shape, array: None });
        }
        let reaches = |(&(first, count, stride), &n): (&Extent, &u64)| {
            count == 0
                || (count - 1)
                    .checked_mul(stride)
                    .and_then(|last| last.checked_add(first))
                    .is_none_or(|last| last >= n)
        };
        if part.iter().zip(&of.shape).any(reaches) {
            let error =
                Error::run("a HyperSlab reaches beyond its data, or is empty").got(format_args!("{part:?}"));
            return Err(error.expected(format_args!("a part of {:?}", of.shape)));
        }
        let count = product(&shape)?;
        if count > of.count() {
            return Err(Error::run("a HyperSlab is larger than its data").got(count).expected(of.count()));
        }
        let (source, whole, of_shape) = (of.stored.source.clone(), of.stored, of.shape);
        let compute: Compute = Arc::new(move |meter| {
            let values: Vec<f64> = whole.load(meter)?;
            Ok(places(&part, &of_shape).filter_map(|place| values.get(place).copied()).collect())
        });
        let stored = Stored::of_f64(&source, &element.tag, 1, count, Encoding::Computed(compute));
        Ok(Item { stored, shape, array: None })
    }

    /// `JOIN($0, $1, $2)`: three items as vectors.
    fn function(&self, element: &'a Element, depth: usize) -> Result<Item> {
        let function = element.required("Function")?;
        let plain: String = function.chars().filter(|letter| !letter.is_whitespace()).collect();
        let items = self.of_element(element)?;
        let [x, y, z] = items[..] else { return Err(unread_function(function)) };
        if !["JOIN($0,$1,$2)", "JOIN($0;$1;$2)"].contains(&plain.to_uppercase().as_str()) {
            return Err(unread_function(function));
        }
        let [x, y, z] = [self.item(x, depth + 1)?, self.item(y, depth + 1)?, self.item(z, depth + 1)?];
        if [y.count(), z.count()] != [x.count(); 2] {
            let error = Error::run("the parts of a JOIN differ in length");
            return Err(error.got(format_args!("{}, {} and {}", x.count(), y.count(), z.count())));
        }
        let shape = [&x.shape[..], &[3]].concat();
        let joined = Stored::joined(&element.tag, [x.stored, y.stored, z.stored]);
        let stored = Stored { component_count: 1, tuple_count: Some(product(&shape)?), ..joined };
        Ok(Item { stored, shape, array: None })
    }
}

fn unread_function(function: &str) -> Error {
    let error = Error::run("a function of data items is not read").got(format_args!("'{function}'"));
    error.expected("JOIN($0, $1, $2) of three items; the node calculator computes others")
}

/// Places of the numbers of a box in the array that it is a part of.
fn places(part: &[Extent], shape: &[u64]) -> impl Iterator<Item = usize> {
    let count = part.iter().fold(1_u64, |product, axis| product.saturating_mul(axis.1));
    let (part, shape) = (part.to_vec(), shape.to_vec());
    (0..count).map(move |number| {
        let (mut rest, mut place, mut step) = (number, 0_u64, 1_u64);
        for (&(first, count, stride), &n) in part.iter().zip(&shape).rev() {
            place = place.saturating_add((first + rest % count * stride).saturating_mul(step));
            rest /= count;
            step = step.saturating_mul(n);
        }
        usize::try_from(place).unwrap_or(usize::MAX)
    })
}
