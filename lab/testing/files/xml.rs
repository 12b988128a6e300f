//! Writes small files in every encoding, independently of the reader.

use flate2::write::ZlibEncoder;
use std::fmt::Write as _;
use std::io::Write as _;

/// Encoding of arrays in an XML file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Words of text within the element.
    Ascii,
    /// Base64 within the element.
    Inline,
    /// Bytes at the end of the file.
    AppendedRaw,
    /// Base64 at the end of the file.
    AppendedBase64,
}

/// Compression of blocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Compressor {
    /// Not at all.
    None,
    /// By zlib.
    Zlib,
    /// By LZ4.
    Lz4,
    /// By LZMA2 in an xz container.
    Lzma,
}

/// One way to write an XML file.
#[derive(Debug, Clone, Copy)]
pub struct Encoding {
    /// Position of the values.
    pub mode: Mode,
    /// Compression of their blocks.
    pub compressor: Compressor,
    /// Most significant byte first.
    pub big_endian: bool,
    /// Lengths of 64 bits.
    pub wide_headers: bool,
    /// Uncompressed bytes of a block.
    pub block: usize,
}

/// Every combination.
pub fn encodings() -> Vec<Encoding> {
    let mut all = Vec::new();
    for mode in [Mode::Ascii, Mode::Inline, Mode::AppendedRaw, Mode::AppendedBase64] {
        for compressor in [Compressor::None, Compressor::Zlib, Compressor::Lz4, Compressor::Lzma] {
            for big_endian in [false, true] {
                for wide_headers in [false, true] {
                    // Blocks that hold whole values, one that holds all, and one that cuts values apart.
                    for block in [64, 1 << 15, 13] {
                        if compressor == Compressor::None && block != 64
                            || mode == Mode::Ascii && compressor != Compressor::None
                        {
                            continue;
                        }
                        all.push(Encoding { mode, compressor, big_endian, wide_headers, block });
                    }
                }
            }
        }
    }
    all
}

/// Values of an array with their type.
#[derive(Debug, Clone)]
pub struct Values {
    /// VTK's name of the type.
    pub number_type: &'static str,
    /// The values.
    pub values: Vec<f64>,
}

impl Values {
    /// Values of a type.
    pub fn new(number_type: &'static str, values: impl IntoIterator<Item = f64>) -> Self {
        Values { number_type, values: values.into_iter().collect() }
    }

    /// The values as bytes.
    pub fn bytes(&self, big_endian: bool) -> Vec<u8> {
        let mut bytes = Vec::new();
        for &value in &self.values {
            let mut one = match self.number_type {
                "Int8" => (value as i8).to_le_bytes().to_vec(),
                "UInt8" => (value as u8).to_le_bytes().to_vec(),
                "Int16" => (value as i16).to_le_bytes().to_vec(),
                "UInt16" => (value as u16).to_le_bytes().to_vec(),
                "Int32" => (value as i32).to_le_bytes().to_vec(),
                "UInt32" => (value as u32).to_le_bytes().to_vec(),
                "Int64" => (value as i64).to_le_bytes().to_vec(),
                "UInt64" => (value as u64).to_le_bytes().to_vec(),
                "Float32" => (value as f32).to_le_bytes().to_vec(),
                "Float64" => value.to_le_bytes().to_vec(),
                other => panic!("{other}"),
            };
            if big_endian {
                one.reverse();
            }
            bytes.extend(one);
        }
        bytes
    }
}

/// An XML file in the making.
pub struct XmlWriter {
    encoding: Encoding,
    header: String,
    appended: Vec<u8>,
}

impl XmlWriter {
    /// A file of a kind of grid.
    pub fn new(kind: &str, encoding: Encoding) -> Self {
        let compressor = match encoding.compressor {
            Compressor::None => "",
            Compressor::Zlib => " compressor=\"vtkZLibDataCompressor\"",
            Compressor::Lz4 => " compressor=\"vtkLZ4DataCompressor\"",
            Compressor::Lzma => " compressor=\"vtkLZMADataCompressor\"",
        };
        let order = if encoding.big_endian { "BigEndian" } else { "LittleEndian" };
        let header_type = if encoding.wide_headers { "UInt64" } else { "UInt32" };
        let header = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"{order}\" header_type=\"{header_type}\"{compressor}>\n"
        );
        XmlWriter { encoding, header, appended: Vec::new() }
    }

    /// Adds text as it is.
    pub fn raw(&mut self, text: &str) {
        self.header.push_str(text);
    }

    /// Adds an array.
    pub fn array(&mut self, name: &str, component_count: usize, values: &Values) {
        let number_type = values.number_type;
        let _ = write!(
            self.header,
            "<DataArray type=\"{number_type}\" Name=\"{name}\" NumberOfComponents=\"{component_count}\" "
        );
        match self.encoding.mode {
            Mode::Ascii => {
                let words: Vec<String> = values.values.iter().map(|v| format!("{v}")).collect();
                let _ = writeln!(self.header, "format=\"ascii\">\n{}\n</DataArray>", words.join(" "));
            }
            Mode::Inline => {
                let text = self.base64(values);
                let _ = writeln!(self.header, "format=\"binary\">\n  {text}\n</DataArray>");
            }
            Mode::AppendedRaw => {
                let _ = writeln!(self.header, "format=\"appended\" offset=\"{}\"/>", self.appended.len());
                let (table, data) = self.parts(values);
                self.appended.extend(table.into_iter().chain(data));
            }
            Mode::AppendedBase64 => {
                let _ = writeln!(self.header, "format=\"appended\" offset=\"{}\"/>", self.appended.len());
                let text = self.base64(values);
                self.appended.extend(text.into_bytes());
            }
        }
    }

    /// The whole file, after `end` has closed the elements that are open.
    pub fn finish(mut self, end: &str) -> Vec<u8> {
        self.header.push_str(end);
        let encoding = match self.encoding.mode {
            Mode::AppendedRaw => "raw",
            Mode::AppendedBase64 => "base64",
            _ => {
                self.header.push_str("</VTKFile>\n");
                return self.header.into_bytes();
            }
        };
        let _ = write!(self.header, "<AppendedData encoding=\"{encoding}\">\n  _");
        let mut bytes = self.header.into_bytes();
        bytes.extend(self.appended);
        bytes.extend(b"\n</AppendedData>\n</VTKFile>\n");
        bytes
    }

    fn words(&self, words: &[usize]) -> Vec<u8> {
        let number_type = if self.encoding.wide_headers { "UInt64" } else { "UInt32" };
        Values::new(number_type, words.iter().map(|&w| w as f64)).bytes(self.encoding.big_endian)
    }

    /// The length header or block table, and the data.
    fn parts(&self, values: &Values) -> (Vec<u8>, Vec<u8>) {
        let bytes = values.bytes(self.encoding.big_endian);
        if self.encoding.compressor == Compressor::None {
            return (self.words(&[bytes.len()]), bytes);
        }
        let blocks: Vec<Vec<u8>> =
            bytes.chunks(self.encoding.block).map(|block| self.compress(block)).collect();
        let mut table = vec![blocks.len(), self.encoding.block, bytes.len() % self.encoding.block];
        table.extend(blocks.iter().map(Vec::len));
        (self.words(&table), blocks.concat())
    }

    fn base64(&self, values: &Values) -> String {
        let (mut table, data) = self.parts(values);
        if self.encoding.compressor == Compressor::None {
            table.extend(data);
            return base64_simd::STANDARD.encode_to_string(table);
        }
        base64_simd::STANDARD.encode_to_string(table) + &base64_simd::STANDARD.encode_to_string(data)
    }

    fn compress(&self, block: &[u8]) -> Vec<u8> {
        match self.encoding.compressor {
            Compressor::None => block.to_vec(),
            Compressor::Zlib => {
                let mut encoder = ZlibEncoder::new(Vec::new(), flate2::Compression::default());
                encoder.write_all(block).unwrap();
                encoder.finish().unwrap()
            }
            Compressor::Lz4 => lz4_flex::block::compress(block),
            Compressor::Lzma => {
                let mut out = Vec::new();
                lzma_rs::xz_compress(&mut &block[..], &mut out).unwrap();
                out
            }
        }
    }
}
