//! PDF: a page with the picture, and its annotation as paths over it (ISO 32000-1:2008, PDF 1.7).

use super::colors::{srgb_from_linear, srgb_opacity};
use super::format::{PictureContent, PictureFile, PictureFormat, SampleForm};
use super::xml;
use crate::provenance::Provenance;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::Predictor;
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, TextStr};
use std::io::{Read, Write};
use voltet_core::picture::Picture;
use voltet_core::picture_parts::{PathStep, Shape, ShapeForm};
use voltet_core::{Error, Result};

pub(super) const FORMAT: PictureFormat = PictureFormat {
    name: "pdf",
    endings: &["pdf"],
    summary: "a page with the picture, over the background or with straight alpha, and its annotation as shapes over it",
    signature: b"%PDF-1.7",
    bits: &[8],
    has_alpha: true,
    has_layers: false,
    has_shapes: true,
    encode: pdf,
    embedded_texts: Some(embedded_texts),
};

/// Points per pixel: 96 pixels an inch, as in SVG.
const POINTS: f32 = 0.75;

/// Begin of the metadata (Adobe, XMP specification part 1, section 7.3).
const XMP: &str = "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\">";

const CATALOG: Ref = Ref::new(1);
const PAGES: Ref = Ref::new(2);
const PAGE: Ref = Ref::new(3);
const IMAGE: Ref = Ref::new(4);
const MASK: Ref = Ref::new(5);
const CONTENT: Ref = Ref::new(6);
const METADATA: Ref = Ref::new(7);
const INFORMATION: Ref = Ref::new(8);

/// The file. What it was made from stands first, as plain text, so that it is found without reading the rest.
fn pdf(content: PictureContent, form: SampleForm, carried: Option<&Provenance>) -> Result<Vec<u8>> {
    let (ground, shapes) = content.drawing();
    let mut pdf = Pdf::new();
    let texts = carried.and_then(|carried| Some((carried, carried.texts()?)));
    if let Some((carried, texts)) = &texts {
        pdf.metadata(METADATA, xmp(texts).as_bytes());
        let mut information = pdf.document_info(INFORMATION);
        information.creator(TextStr(&carried.program));
        if let Some(title) = &carried.title {
            information.title(TextStr(title));
        }
    }
    let mut catalog = pdf.catalog(CATALOG);
    catalog.pages(PAGES);
    if texts.is_some() {
        catalog.metadata(METADATA);
    }
    catalog.finish();
    pdf.pages(PAGES).kids([PAGE]).count(1);
    let size = [ground.width, ground.height].map(|side| side as f32);
    let opacities = opacities(shapes);
    let mut page = pdf.page(PAGE);
    page.media_box(Rect::new(0.0, 0.0, POINTS * size[0], POINTS * size[1])).parent(PAGES).contents(CONTENT);
    let mut resources = page.resources();
    resources.x_objects().pair(Name(b"picture"), IMAGE);
    let mut states = resources.ext_g_states();
    for (number, opacity) in opacities.iter().enumerate() {
        let mut state = states.insert(Name(&state(number))).start::<pdf_writer::writers::ExtGraphicsState>();
        state.stroking_alpha(*opacity).non_stroking_alpha(*opacity);
    }
    states.finish();
    resources.finish();
    page.finish();
    write_image(&mut pdf, ground, form)?;
    let drawn = deflated(&drawing(size, shapes, &opacities))?;
    pdf.stream(CONTENT, &drawn).filter(Filter::FlateDecode);
    Ok(pdf.finish())
}

/// The picture in sRGB, and its opacity where the file has it.
fn write_image(pdf: &mut Pdf, picture: &Picture, form: SampleForm) -> Result<()> {
    let samples = form.bytes(picture);
    let per_pixel = if form.alpha { 4 } else { 3 };
    let channels = |from: usize, to: usize| -> Vec<u8> {
        samples.chunks(per_pixel).flat_map(|pixel| pixel[from..to].iter().copied()).collect()
    };
    let planes = [(IMAGE, channels(0, 3), 3), (MASK, channels(3, per_pixel), 1)];
    for (id, samples, count) in planes.into_iter().filter(|(_, samples, _)| !samples.is_empty()) {
        let rows = deflated(&differences(&samples, count * picture.width))?;
        let mut image = pdf.image_xobject(id, &rows);
        image.filter(Filter::FlateDecode);
        // Within what a camera may have.
        let [width, height] = [picture.width, picture.height].map(|side| side as i32);
        let mut form_of_rows = image.decode_parms();
        form_of_rows.predictor(Predictor::PngUp).colors(count as i32).columns(width);
        form_of_rows.finish();
        image.width(width).height(height).bits_per_component(8);
        match count {
            3 => image.color_space().device_rgb(),
            _ => image.color_space().device_gray(),
        };
        if id == IMAGE && form.alpha {
            image.s_mask(MASK);
        }
    }
    Ok(())
}

/// Rows as differences from the row above, each behind the number of this filter (PNG, third edition, section 9).
fn differences(samples: &[u8], row_length: usize) -> Vec<u8> {
    let mut filtered = Vec::with_capacity(samples.len() + samples.len() / row_length);
    let mut above = vec![0; row_length];
    for row in samples.chunks(row_length) {
        filtered.push(2);
        filtered
            .extend(row.iter().zip(&above).map(|(sample, above): (&u8, &u8)| sample.wrapping_sub(*above)));
        above.copy_from_slice(row);
    }
    filtered
}

fn deflated(bytes: &[u8]) -> Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    let done = encoder.write_all(bytes).and_then(|()| encoder.finish());
    done.map_err(|error| Error::run("the picture cannot be encoded as PDF").got(error))
}

/// Opacities of shapes, each once.
fn opacities(shapes: &[Shape]) -> Vec<f32> {
    let mut opacities: Vec<f32> = shapes.iter().map(srgb_opacity).collect();
    opacities.sort_by(f32::total_cmp);
    opacities.dedup();
    opacities
}

/// Name of the graphics state that sets an opacity.
fn state(number: usize) -> Vec<u8> {
    format!("opacity{number}").into_bytes()
}

/// Operators that draw picture and shapes, in pixels from the upper left corner.
fn drawing([width, height]: [f32; 2], shapes: &[Shape], opacities: &[f32]) -> Vec<u8> {
    let mut content = Content::new();
    content.transform([POINTS, 0.0, 0.0, -POINTS, 0.0, POINTS * height]);
    content.save_state().transform([width, 0.0, 0.0, -height, 0.0, height]);
    content.x_object(Name(b"picture")).restore_state();
    // Corners as zeno and SVG make them.
    content.set_miter_limit(4.0);
    for shape in shapes {
        let opacity = srgb_opacity(shape);
        let number = opacities.iter().position(|known| *known == opacity).unwrap_or_default();
        content.set_parameters(Name(&state(number)));
        let [r, g, b] = shape.color.map(srgb_from_linear);
        content.set_fill_rgb(r, g, b).set_stroke_rgb(r, g, b);
        match &shape.form {
            ShapeForm::Line { ends: [from, to], width } => {
                content.set_line_width(*width).move_to(from[0], from[1]).line_to(to[0], to[1]).stroke();
            }
            ShapeForm::Rectangle([from, to]) => {
                content.rect(from[0], from[1], to[0] - from[0], to[1] - from[1]).fill_nonzero();
            }
            ShapeForm::Area(path) => {
                add_path(&mut content, path);
                content.fill_nonzero();
            }
            ShapeForm::Outline { path, width } => {
                content.set_line_width(*width);
                add_path(&mut content, path);
                content.stroke();
            }
        }
    }
    content.finish().into_vec()
}

/// Adds a path. A quadratic curve becomes the cubic one that it is.
fn add_path(content: &mut Content, path: &[PathStep]) {
    let mut last = [0.0; 2];
    for step in path {
        match *step {
            PathStep::Move([x, y]) => content.move_to(x, y),
            PathStep::Line([x, y]) => content.line_to(x, y),
            PathStep::Quadratic(control, [x, y]) => {
                let toward = |end: [f32; 2], k: usize| end[k] + 2.0 / 3.0 * (control[k] - end[k]);
                let (first, second) = ([0, 1].map(|k| toward(last, k)), [0, 1].map(|k| toward([x, y], k)));
                content.cubic_to(first[0], first[1], second[0], second[1], x, y)
            }
            PathStep::Cubic(first, second, [x, y]) => {
                content.cubic_to(first[0], first[1], second[0], second[1], x, y)
            }
            PathStep::Close => content.close_path(),
        };
        if let PathStep::Move(to)
        | PathStep::Line(to)
        | PathStep::Quadratic(_, to)
        | PathStep::Cubic(_, _, to) = step
        {
            last = *to;
        }
    }
}

fn xmp(texts: &[(&'static str, String)]) -> String {
    format!(
        "<?xpacket begin=\"\u{feff}\" id=\"W5M0MpCehiHzreSzNTczkc9d\"?>\n{XMP}\n\
         <rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">\n\
         <rdf:Description rdf:about=\"\" xmlns:voltet=\"{}\">\n{}</rdf:Description>\n</rdf:RDF>\n</x:xmpmeta>\n\
         <?xpacket end=\"r\"?>",
        xml::NAMESPACE,
        xml::elements(texts)
    )
}

fn embedded_texts(file: &mut dyn PictureFile) -> Result<Vec<(String, String)>> {
    let mut begin = Vec::new();
    let read = file.take(xml::MAX_BEGIN).read_to_end(&mut begin);
    read.map_err(|error| Error::usage("the drawing cannot be read as PDF").got(error))?;
    let found = begin.windows(XMP.len()).position(|bytes| bytes == XMP.as_bytes());
    found.map_or(Ok(Vec::new()), |first| xml::texts("PDF", &begin[first..], "x:xmpmeta"))
}

#[cfg(test)]
mod tests {
    use super::super::{format_of, read};
    use super::*;
    use std::io::Cursor;
    use voltet_core::picture_parts::Annotation;

    fn picture() -> Picture {
        Picture { width: 3, height: 2, rgba: (0..6).map(|k| [0.1 * k as f32, 0.25, 0.0, 1.0]).collect() }
    }

    /// Contents of all compressed streams, in their order.
    fn streams(file: &[u8]) -> Vec<Vec<u8>> {
        let find = |bytes: &[u8], what: &[u8]| bytes.windows(what.len()).position(|part| part == what);
        let (mut rest, mut found) = (file, Vec::new());
        while let Some(begin) =
            find(rest, b"FlateDecode").map(|at| at + find(&rest[at..], b"stream\n").unwrap() + 7)
        {
            let mut content = Vec::new();
            flate2::read::ZlibDecoder::new(&rest[begin..]).read_to_end(&mut content).unwrap();
            found.push(content);
            rest = &rest[begin..];
        }
        found
    }

    #[test]
    fn a_page_holds_the_picture_under_its_shapes() {
        let path =
            [PathStep::Move([0.0, 1.0]), PathStep::Quadratic([3.0, 1.0], [3.0, 4.0]), PathStep::Close].into();
        let line = ShapeForm::Line { ends: [[0.0, 0.5], [3.0, 0.5]], width: 1.5 };
        let shapes = vec![
            Shape { form: line, color: [1.0; 3], opacity: 0.25 },
            Shape { form: ShapeForm::Area(path), color: [0.0; 3], opacity: 1.0 },
        ];
        let annotation = Annotation { ground: picture(), shapes };
        let whole = Picture::transparent(3, 2);
        let content = PictureContent { picture: &whole, layers: None, annotation: Some(&annotation) };
        let form = SampleForm { alpha: true, ..SampleForm::over([0.0; 3]) };
        let file = pdf(content, form, None).unwrap();
        let [colors, opacities, drawn] = streams(&file).try_into().unwrap();
        let (samples, filter) = (form.bytes(&picture()), 2_u8);
        let row = |k: usize| {
            samples[12 * k..12 * (k + 1)].chunks(4).flat_map(|p| p[..3].to_vec()).collect::<Vec<u8>>()
        };
        let below: Vec<u8> = row(1).iter().zip(row(0)).map(|(a, b)| a.wrapping_sub(b)).collect();
        assert_eq!(colors, [vec![filter], row(0), vec![filter], below].concat());
        assert_eq!(opacities, [2, 255, 255, 255, 2, 0, 0, 0]);
        let drawn = String::from_utf8(drawn).unwrap();
        for operators in [
            "0.75 0 0 -0.75 0 1.5 cm",
            "/picture Do",
            "1.5 w\n0 0.5 m\n3 0.5 l\nS",
            "0 1 m\n2 1 3 2 3 4 c\nh\nf",
        ] {
            assert!(drawn.contains(operators), "{operators}\n{drawn}");
        }
        // 25 % of white light over black is 0.537 in sRGB.
        assert!(file.windows(7).any(|part| part == b"/CA 0.5"), "{}", String::from_utf8_lossy(&file));
    }

    #[test]
    fn a_page_carries_its_pipeline() {
        let pipeline = "a = \"<ü & 'b'>\"\r\n".to_string();
        let carried = Provenance {
            program: "voltet 1".into(),
            title: Some("größer".into()),
            pipeline: pipeline.clone(),
            ..Provenance::default()
        };
        let file = pdf((&picture()).into(), SampleForm::over([0.0; 3]), Some(&carried)).unwrap();
        let found = read(format_of(&file[..8]).unwrap(), Cursor::new(&file)).unwrap();
        assert_eq!((found.pipeline, found.program), (pipeline, carried.program));
        let bare = pdf((&picture()).into(), SampleForm::over([0.0; 3]), None).unwrap();
        let error = read(format_of(&bare[..8]).unwrap(), Cursor::new(&bare)).unwrap_err();
        assert!(error.to_string().contains("carries no pipeline"), "{error}");
        for length in 8..file.len() {
            // Never a panic.
            let _ = read(&FORMAT, Cursor::new(&file[..length]));
        }
    }
}
