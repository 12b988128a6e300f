//! HDF5 files of groups, attributes and arrays, written from front to back: first all headers, then the arrays one after the other.
//!
//! Source: HDF5 File Format Specification 3.0 (The HDF Group). Superblock 2, object headers 2 with links in them, arrays in one part,
//! numbers least significant byte first: what libhdf5 reads since version 1.8.

use super::numbers::{Numbers, WrittenType};
use hdf5_reader::checksum::jenkins_lookup3;
use std::io::{self, Write};
use voltet_core::{Error, Result};

/// Bytes of the superblock, at the beginning of the file.
const SUPERBLOCK_BYTES: u64 = 48;
/// The address of what there is not.
const UNDEFINED: u64 = u64::MAX;
/// Objects and arrays begin at multiples of this.
const ALIGNMENT: u64 = 8;
/// Bytes that a name may have: a message of a header, which holds it, has at most 65,535.
const MAX_NAME_BYTES: usize = 60_000;

#[derive(Default)]
pub(super) struct OutputGroup<'a> {
    attributes: Vec<Attribute>,
    members: Vec<(String, Member<'a>)>,
}

enum Member<'a> {
    Group(OutputGroup<'a>),
    Array(OutputArray<'a>),
}

/// An array of numbers in one part of the file.
pub(super) struct OutputArray<'a> {
    numbers: &'a Numbers<'a>,
    shape: Vec<u64>,
    attributes: Vec<Attribute>,
}

/// An attribute: its name, and the messages of its type and shape with its bytes.
struct Attribute {
    name: &'static str,
    datatype: Vec<u8>,
    dataspace: Vec<u8>,
    bytes: Vec<u8>,
}

impl Attribute {
    fn text(name: &'static str, text: &str) -> Attribute {
        // Padded with zeros, of ASCII: class 3 of version 1.
        let mut datatype = vec![0x13, 0x01, 0, 0];
        datatype.extend((text.len() as u32).to_le_bytes());
        Attribute { name, datatype, dataspace: dataspace(&[]), bytes: text.as_bytes().to_vec() }
    }

    fn integers(name: &'static str, values: &[i64]) -> Attribute {
        let bytes = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let (datatype, dataspace) = (datatype(WrittenType::I64), dataspace(&[values.len() as u64]));
        Attribute { name, datatype, dataspace, bytes }
    }

    fn message(&self) -> Vec<u8> {
        // Version 3, not shared; names in ASCII.
        let mut message = vec![3, 0];
        let sizes = [self.name.len() + 1, self.datatype.len(), self.dataspace.len()];
        message.extend(sizes.into_iter().flat_map(|size| (size as u16).to_le_bytes()));
        message.push(0);
        message.extend_from_slice(self.name.as_bytes());
        message.push(0);
        [&self.datatype, &self.dataspace, &self.bytes]
            .iter()
            .for_each(|part| message.extend_from_slice(part));
        message
    }
}

impl<'a> OutputGroup<'a> {
    /// Adds an attribute of text in ASCII.
    pub fn text(&mut self, name: &'static str, text: &str) {
        self.attributes.push(Attribute::text(name, text));
    }

    /// Adds an attribute of whole numbers.
    pub fn integers(&mut self, name: &'static str, values: &[i64]) {
        self.attributes.push(Attribute::integers(name, values));
    }

    pub fn group(&mut self, name: &str, group: OutputGroup<'a>) {
        self.members.push((name.to_owned(), Member::Group(group)));
    }

    /// Adds an array whose shape holds as many numbers as there are.
    ///
    /// Errors: a name that is none in HDF5, or that another member has.
    pub fn array(&mut self, name: &str, array: OutputArray<'a>) -> Result<()> {
        if name.is_empty() || name == "." || name.contains(['/', '\0']) || name.len() > MAX_NAME_BYTES {
            let error = Error::run("the array has a name that HDF5 does not allow").got(format!("'{name}'"));
            return Err(error.expected(format!(
                "a name without '/' that is not empty, not '.' and of at most {MAX_NAME_BYTES} bytes"
            )));
        }
        if self.members.iter().any(|(other, _)| other == name) {
            let error = Error::run("two arrays have one name").got(format!("'{name}'"));
            return Err(error.expected("names that differ"));
        }
        self.members.push((name.to_owned(), Member::Array(array)));
        Ok(())
    }
}

impl<'a> OutputArray<'a> {
    /// An array of tuples; of single numbers where `component_count` is 1.
    pub fn new(numbers: &'a Numbers<'a>, component_count: usize) -> OutputArray<'a> {
        let tuples = numbers.count().checked_div(component_count).unwrap_or(0) as u64;
        let shape = if component_count == 1 { vec![tuples] } else { vec![tuples, component_count as u64] };
        OutputArray { numbers, shape, attributes: Vec::new() }
    }

    /// With an attribute of text in ASCII.
    pub fn with_text(mut self, name: &'static str, text: &str) -> OutputArray<'a> {
        self.attributes.push(Attribute::text(name, text));
        self
    }
}

/// A group or an array with its place in the file.
struct ObjectLayout<'g> {
    object: Object<'g>,
    /// Places of the members of a group in the list of all.
    members: Vec<usize>,
    header_address: u64,
    array_address: u64,
}

#[derive(Clone, Copy)]
enum Object<'g> {
    Group(&'g OutputGroup<'g>),
    Array(&'g OutputArray<'g>),
}

pub(super) fn write(root: &OutputGroup, out: &mut dyn Write) -> io::Result<()> {
    let mut objects = Vec::new();
    list(Object::Group(root), &mut objects);
    let mut end = SUPERBLOCK_BYTES;
    for i in 0..objects.len() {
        objects[i].header_address = end;
        // A header is as long wherever it points to.
        end = aligned(end + header(i, &objects).len() as u64);
    }
    for placed in &mut objects {
        if let Object::Array(array) = placed.object
            && array.numbers.count() > 0
        {
            placed.array_address = end;
            end = aligned(end + array.numbers.byte_count());
        }
    }
    out.write_all(&superblock(objects[0].header_address, end))?;
    for i in 0..objects.len() {
        let header = header(i, &objects);
        out.write_all(&header)?;
        pad(header.len() as u64, out)?;
    }
    for placed in &objects {
        if let Object::Array(array) = placed.object {
            array.numbers.write(out)?;
            pad(array.numbers.byte_count(), out)?;
        }
    }
    Ok(())
}

/// Adds an object and all below it to a list; gives its place there.
fn list<'g>(object: Object<'g>, all: &mut Vec<ObjectLayout<'g>>) -> usize {
    let place = all.len();
    all.push(ObjectLayout { object, members: Vec::new(), header_address: 0, array_address: UNDEFINED });
    if let Object::Group(group) = object {
        let members = group.members.iter().map(|(_, member)| match member {
            Member::Group(group) => list(Object::Group(group), all),
            Member::Array(array) => list(Object::Array(array), all),
        });
        let members = members.collect();
        all[place].members = members;
    }
    place
}

fn aligned(address: u64) -> u64 {
    address.next_multiple_of(ALIGNMENT)
}

/// Writes what is missing to the next multiple of the alignment.
fn pad(length: u64, out: &mut dyn Write) -> io::Result<()> {
    out.write_all(&[0; ALIGNMENT as usize][..(aligned(length) - length) as usize])
}

fn superblock(root_address: u64, end: u64) -> Vec<u8> {
    let mut bytes = b"\x89HDF\r\n\x1a\n".to_vec();
    // Version 2, offsets and lengths of 8 bytes, no flags.
    bytes.extend([2, 8, 8, 0]);
    // The file begins at 0 and has no extension of this block.
    bytes.extend([0, UNDEFINED, end, root_address].into_iter().flat_map(u64::to_le_bytes));
    with_checksum(bytes)
}

fn header(place: usize, objects: &[ObjectLayout]) -> Vec<u8> {
    let placed = &objects[place];
    let mut messages = Vec::new();
    let mut add = |kind: u8, message: &[u8]| {
        messages.push(kind);
        messages.extend((message.len() as u16).to_le_bytes());
        messages.push(0);
        messages.extend_from_slice(message);
    };
    let attributes = match placed.object {
        Object::Group(group) => {
            // Link info: no other place of links; group info: nothing.
            add(0x02, &[&[0, 0][..], &UNDEFINED.to_le_bytes(), &UNDEFINED.to_le_bytes()].concat());
            add(0x0a, &[0, 0]);
            for ((name, _), &member) in group.members.iter().zip(&placed.members) {
                add(0x06, &link(name, objects[member].header_address));
            }
            &group.attributes
        }
        Object::Array(array) => {
            add(0x01, &dataspace(&array.shape));
            add(0x03, &datatype(array.numbers.number_type));
            // Fill value: of version 3, none; place taken late, filled where one is set.
            add(0x05, &[3, 0x0a]);
            // Layout: of version 3, in one part.
            let place = [placed.array_address, array.numbers.byte_count()].map(u64::to_le_bytes);
            add(0x08, &[&[3, 1][..], place.as_flattened()].concat());
            &array.attributes
        }
    };
    attributes.iter().for_each(|attribute| add(0x0c, &attribute.message()));
    // Version 2; the size of the messages has 4 bytes.
    let mut bytes = b"OHDR\x02\x02".to_vec();
    bytes.extend((messages.len() as u32).to_le_bytes());
    bytes.extend(messages);
    with_checksum(bytes)
}

/// A link to an object of this file: version 1; the set of letters is given, the name's size has 2 bytes.
fn link(name: &str, address: u64) -> Vec<u8> {
    let mut message = vec![1, 0x11, 1];
    message.extend((name.len() as u16).to_le_bytes());
    message.extend_from_slice(name.as_bytes());
    message.extend(address.to_le_bytes());
    message
}

/// A shape: of version 2; of no axes a single value.
fn dataspace(shape: &[u64]) -> Vec<u8> {
    let mut message = vec![2, shape.len() as u8, 0, u8::from(!shape.is_empty())];
    message.extend(shape.iter().flat_map(|count| count.to_le_bytes()));
    message
}

/// A type of numbers: of version 1, class 0 (whole numbers) or 1 (IEEE 754).
fn datatype(number_type: WrittenType) -> Vec<u8> {
    let size = number_type.size() as u32;
    let bits = (8 * size as u16).to_le_bytes();
    let with_size = |head: [u8; 4]| [head, size.to_le_bytes()].concat();
    let whole = |signed: u8| [&with_size([0x10, signed << 3, 0, 0])[..], &[0, 0], &bits].concat();
    // The place of the sign; places and bits of the exponent and the mantissa; the exponent's bias.
    let real = |sign: u8, exponent: [u8; 2], mantissa: u8, bias: u32| {
        let head = with_size([0x11, 0x20, sign, 0]);
        let [at, count] = exponent;
        [&head[..], &[0, 0], &bits, &[at, count, 0, mantissa], &bias.to_le_bytes()].concat()
    };
    match number_type {
        WrittenType::U8 => whole(0),
        WrittenType::I32 | WrittenType::I64 => whole(1),
        WrittenType::F32 => real(31, [23, 8], 23, 127),
        WrittenType::F64 => real(63, [52, 11], 52, 1023),
    }
}

fn with_checksum(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.extend(jenkins_lookup3(&bytes).to_le_bytes());
    bytes
}
