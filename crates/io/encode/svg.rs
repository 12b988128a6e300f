//! SVG: the picture as an embedded PNG, and its annotation as shapes over it (Scalable Vector Graphics 1.1, second edition).

use super::colors::{code, srgb_opacity};
use super::format::{PictureContent, PictureFile, PictureFormat, SampleForm};
use super::{png, xml};
use crate::provenance::Provenance;
use quick_xml::escape::escape;
use std::fmt::Write;
use std::io::Read;
use voltet_core::Result;
use voltet_core::picture_parts::{PathStep, Place, Shape, ShapeForm};

pub(super) const FORMAT: PictureFormat = PictureFormat {
    name: "svg",
    endings: &["svg"],
    summary: "the picture as a PNG within, over the background or with straight alpha, and its annotation as shapes over it",
    signature: b"<svg xml",
    bits: &[8, 16],
    has_alpha: true,
    has_layers: false,
    has_shapes: true,
    encode: svg,
    embedded_texts: Some(embedded_texts),
};

/// The drawing, in pixels. What it was made from stands before the picture, so that it is found without reading that.
fn svg(content: PictureContent, form: SampleForm, carried: Option<&Provenance>) -> Result<Vec<u8>> {
    let (ground, shapes) = content.drawing();
    let [width, height] = [ground.width, ground.height];
    let picture = (png::FORMAT.encode)(ground.into(), form, None)?;
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" xmlns:voltet=\"{}\" \
         width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n",
        xml::NAMESPACE
    );
    if let Some((carried, texts)) = carried.and_then(|carried| Some((carried, carried.texts()?))) {
        if let Some(title) = &carried.title {
            text += &format!("<title>{}</title>\n", escape(title.as_str()));
        }
        text += &format!("<!-- {} -->\n<metadata>\n", carried.program.replace("--", "—"));
        text += &xml::elements(&texts);
        text += "</metadata>\n";
    }
    text += &format!("<image width=\"{width}\" height=\"{height}\" xlink:href=\"data:image/png;base64,");
    text += &base64_simd::STANDARD.encode_to_string(picture);
    text += "\"/>\n";
    shapes.iter().for_each(|shape| text += &element(shape));
    text += "</svg>\n";
    Ok(text.into_bytes())
}

/// The element of a shape, in a line.
fn element(shape: &Shape) -> String {
    let color = shape.color.map(|linear| code(linear, 255.0));
    let color = format!("#{:02x}{:02x}{:02x}", color[0], color[1], color[2]);
    let paint = |what: &str| {
        let opacity = srgb_opacity(shape);
        let opacity = if opacity < 1.0 { format!(" {what}-opacity=\"{opacity:.3}\"") } else { String::new() };
        format!("{what}=\"{color}\"{opacity}")
    };
    match &shape.form {
        ShapeForm::Line { ends: [from, to], width } => format!(
            "<path d=\"M{} L{}\" stroke-width=\"{}\" {}/>\n",
            place(*from),
            place(*to),
            number(*width),
            paint("stroke")
        ),
        ShapeForm::Rectangle([from, to]) => format!(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" shape-rendering=\"crispEdges\" {}/>\n",
            number(from[0]),
            number(from[1]),
            number(to[0] - from[0]),
            number(to[1] - from[1]),
            paint("fill")
        ),
        ShapeForm::Area(path) => format!("<path d=\"{}\" {}/>\n", data(path), paint("fill")),
        ShapeForm::Outline { path, width } => format!(
            "<path d=\"{}\" fill=\"none\" stroke-width=\"{}\" {}/>\n",
            data(path),
            number(*width),
            paint("stroke")
        ),
    }
}

/// Path data (section 8.3).
fn data(path: &[PathStep]) -> String {
    let mut data = String::new();
    for step in path {
        // Writing to a text cannot fail.
        let _ = match step {
            PathStep::Move(to) => write!(data, "M{}", place(*to)),
            PathStep::Line(to) => write!(data, "L{}", place(*to)),
            PathStep::Quadratic(control, to) => write!(data, "Q{} {}", place(*control), place(*to)),
            PathStep::Cubic(first, second, to) => {
                write!(data, "C{} {} {}", place(*first), place(*second), place(*to))
            }
            PathStep::Close => write!(data, "Z"),
        };
    }
    data
}

fn place([x, y]: Place) -> String {
    format!("{} {}", number(x), number(y))
}

/// A length to a hundredth of a pixel.
fn number(x: f32) -> String {
    let text = format!("{x:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

/// The named texts of a drawing of this program.
fn embedded_texts(file: &mut dyn PictureFile) -> Result<Vec<(String, String)>> {
    xml::texts("SVG", file.take(xml::MAX_BEGIN), "metadata")
}

#[cfg(test)]
mod tests {
    use super::super::png::png;
    use super::super::{format_of, read};
    use super::*;
    use std::io::Cursor;
    use std::sync::Arc;
    use voltet_core::picture::Picture;
    use voltet_core::picture_parts::Annotation;

    const FORM: SampleForm = SampleForm { alpha: false, background: [0.0; 3], bits: 8 };

    /// Bytes of the PNG within.
    fn embedded(text: &str) -> Vec<u8> {
        let begin = text.find("base64,").unwrap() + 7;
        let end = begin + text[begin..].find('"').unwrap();
        base64_simd::STANDARD.decode_to_vec(&text[begin..end]).unwrap()
    }

    fn picture() -> Picture {
        Picture { width: 3, height: 2, rgba: vec![[0.5, 0.25, 0.0, 1.0]; 6] }
    }

    #[test]
    fn a_drawing_holds_the_picture_under_its_shapes() {
        let shape = |form: ShapeForm| Shape { form, color: [0.0; 3], opacity: 1.0 };
        let path: Arc<[PathStep]> =
            [PathStep::Move([0.0, 1.0]), PathStep::Quadratic([1.0, 1.0], [2.001, 0.5]), PathStep::Close]
                .into();
        let shapes = vec![
            shape(ShapeForm::Line { ends: [[0.0, 0.5], [3.0, 0.5]], width: 1.5 }),
            shape(ShapeForm::Rectangle([[1.0, 0.0], [3.0, 2.0]])),
            shape(ShapeForm::Area(path.clone())),
            Shape { color: [1.0; 3], opacity: 0.25, ..shape(ShapeForm::Outline { path, width: 0.5 }) },
        ];
        let annotation = Annotation { ground: picture(), shapes };
        // The picture with its shapes is none that stands in the file.
        let whole = Picture::transparent(3, 2);
        let content = PictureContent { picture: &whole, layers: None, annotation: Some(&annotation) };
        let text = String::from_utf8(svg(content, FORM, None).unwrap()).unwrap();
        assert_eq!(embedded(&text), png(&picture(), [0.0; 3], None).unwrap());
        for element in [
            "<svg xmlns=",
            "width=\"3\" height=\"2\" viewBox=\"0 0 3 2\">",
            "<path d=\"M0 0.5 L3 0.5\" stroke-width=\"1.5\" stroke=\"#000000\"/>",
            "<rect x=\"1\" y=\"0\" width=\"2\" height=\"2\" shape-rendering=\"crispEdges\" fill=\"#000000\"/>",
            "<path d=\"M0 1Q1 1 2 0.5Z\" fill=\"#000000\"/>",
            // 25 % of white light over black is 0.537 in sRGB.
            "<path d=\"M0 1Q1 1 2 0.5Z\" fill=\"none\" stroke-width=\"0.5\" stroke=\"#ffffff\" stroke-opacity=\"0.537\"/>",
        ] {
            assert!(text.contains(element), "{element}\n{text}");
        }
    }

    #[test]
    fn a_drawing_carries_its_pipeline() {
        let pipeline = "a = \"<ü & 'b'>\"\r\n# ]]> &amp;\n".to_string();
        let carried = Provenance {
            program: "voltet -- 1".into(),
            title: Some("a < b".into()),
            pipeline: pipeline.clone(),
            ..Provenance::default()
        };
        let file = svg((&picture()).into(), FORM, Some(&carried)).unwrap();
        let found = read(format_of(&file[..8]).unwrap(), Cursor::new(&file)).unwrap();
        assert_eq!((found.pipeline, found.program), (pipeline, carried.program));
        let bare = svg((&picture()).into(), FORM, None).unwrap();
        let error = read(format_of(&bare[..8]).unwrap(), Cursor::new(&bare)).unwrap_err();
        assert!(error.to_string().contains("carries no pipeline"), "{error}");
        for length in 8..file.len() {
            // Never a panic.
            let _ = read(&FORMAT, Cursor::new(&file[..length]));
        }
    }
}
