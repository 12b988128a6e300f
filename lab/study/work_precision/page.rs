//! The study as one HTML page that needs no other file: for a colleague, or kept by a build server.

use super::canvas::escaped;
use super::table::{
    COLUMNS, COMPARED, by_time, cells, convergence_lines, engine_lines, milliseconds, refinement_lines,
};
use super::{Measure, Row, Study};
use std::fmt::Write;

/// The look of pages: black on white, figures in columns, nothing that needs colour.
const STYLE: &str = include_str!("page.css");

/// Head of a page, up to its title. `title`: without characters of HTML.
pub(crate) fn head(title: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n<title>{title}</title>\n<style>{STYLE}</style>\n\
         </head>\n<body>\n<h1>{title}</h1>\n"
    )
}

const SHOWN: usize = 12;

/// The page. `plot`: the SVG document; `reference`: the reference picture as PNG.
pub fn page(study: &Study, title: &str, plot: &str, reference: &[u8]) -> String {
    let subject = &study.subject;
    let [width, height] = subject.scene.camera.size;
    let title = escaped(title);
    let mut html = head(&title);
    let drawn = if study.reference.cached { "kept from an earlier study; drawn" } else { "drawn" };
    paragraph(
        &mut html,
        &format!(
            "Node <code>{}</code>, {width} × {height} pixels, {} tetrahedra, {} threads, {}, voltet {}. Every setting against \
         the 64-bit reference ({drawn} in {:.1} s): adaptive quadrature of every ray segment, exact order.",
            escaped(&subject.node),
            subject.scene.volume.grid.tetrahedra.len(),
            rayon::current_num_threads(),
            escaped(study.vector_units),
            env!("CARGO_PKG_VERSION"),
            study.reference.seconds,
        ),
    );
    let notes: Vec<String> = engine_lines(study).iter().map(|line| escaped(line)).collect();
    notes.iter().for_each(|line| paragraph(&mut html, line));
    if study.stopped() {
        let done =
            format!("Stopped: {} of {} settings were measured.", study.rows.len(), study.setting_count);
        paragraph(&mut html, &format!("<strong>{done}</strong>"));
    }
    if let Some(text) = recommendation(study) {
        paragraph(&mut html, &format!("<strong>{}</strong>", escaped(&text)));
    }
    html += "<h2>Error against time</h2>\n";
    html += plot;
    html += &table(study);
    if study.refinement.is_some() {
        html += "<h2>Integration and data model</h2>\n<ul>\n";
        for line in refinement_lines(study) {
            line_to(&mut html, &format!("<li>{}</li>", escaped(&line)));
        }
        html += "</ul>\n";
    }
    if !study.convergence.is_empty() {
        html += "<h2>Order of convergence</h2>\n<ul>\n";
        for line in convergence_lines(study) {
            line_to(&mut html, &format!("<li>{}</li>", escaped(&line)));
        }
        html += "</ul>\n";
        paragraph(
            &mut html,
            "With an error of c·N<sup>−p</sup> for N pieces of a ray segment, p = log(e(N₁)/e(N₂)) / \
            log(N₂/N₁), after Etiene et al. 2014. Root-mean-square errors, less (by their squares) the floor that the closed \
            forms leave in the same order of segments; those under twice that floor are left out. Observed is the slope of the \
            four finest that are left.",
        );
    }
    html += &pictures(study, reference);
    html += MEANINGS;
    html + "</body>\n</html>\n"
}

/// Recommendation for the allowed error, in a sentence.
pub fn recommendation(study: &Study) -> Option<String> {
    let (bound, measure) = (study.wish.max_error?, study.wish.measure);
    let name = match measure {
        Measure::Maximum => "the largest error",
        Measure::RootMeanSquare => "the root-mean-square error",
        Measure::Percentile => "the 99.9 percentile of the error",
        Measure::Flip => "the mean of FLIP",
    };
    Some(match study.recommended.map(|i| &study.rows[i]) {
        Some(row) => format!(
            "Cheapest with {name} at most {bound}: {} ({} ms a picture{}, error {:.1e}).",
            row.setting.label(),
            milliseconds(row.cost.picture.median_ms),
            match row.setting.variant.engine.on_device {
                false => String::new(),
                true => format!(" after a set-up of {} ms", milliseconds(row.cost.set_up.median_ms)),
            },
            row.error(measure)
        ),
        None => {
            let least = study.rows.iter().map(|row| row.error(measure)).fold(f64::INFINITY, f64::min);
            format!("No setting measured keeps {name} at most {bound}; the least is {least:.1e}.")
        }
    })
}

fn paragraph(html: &mut String, text: &str) {
    line_to(html, &format!("<p>{text}</p>"));
}

pub(crate) fn line_to(html: &mut String, text: &str) {
    // Writing to a String cannot fail.
    let _ = writeln!(html, "{text}");
}

fn table(study: &Study) -> String {
    let heads: String = COLUMNS.iter().map(|column| format!("<th>{}</th>", escaped(column.0))).collect();
    let mut html = format!(
        "<h2>Every setting</h2>\n<p>Cheapest first; on the Pareto front in bold. Medians; all times in milliseconds. {}</p>\n\
         <div class=\"wide\"><table>\n<thead><tr>{heads}</tr></thead>\n<tbody>\n",
        escaped(COMPARED)
    );
    for i in by_time(study) {
        let row = &study.rows[i];
        let class = match (study.recommended == Some(i), row.on_front) {
            (true, _) => " class=\"front chosen\"",
            (_, true) => " class=\"front\"",
            _ => "",
        };
        let cells: String = cells(study, row).map(|cell| format!("<td>{}</td>", escaped(&cell))).collect();
        line_to(&mut html, &format!("<tr{class}>{cells}</tr>"));
    }
    html + "</tbody></table></div>\n"
}

/// The reference, and the differences of the front's rows, or of the cheapest where there are many.
fn pictures(study: &Study, reference: &[u8]) -> String {
    let mut html = String::from(
        "<h2>Pictures</h2>\n<p>Differences from the reference: the largest of a pixel's four channels, on a \
         logarithmic scale.</p>\n<div class=\"scale\"></div>\n<div class=\"ends\"><span>1e-6 and less</span>\
         <span>1e-3</span><span>1</span></div>\n<p></p>\n",
    );
    figure(&mut html, reference, "reference");
    let shown =
        |i: &usize| study.rows[*i].on_front || study.recommended == Some(*i) || study.rows[*i].of_file;
    for row in by_time(study).into_iter().filter(shown).take(SHOWN).map(|i| &study.rows[i]) {
        figure(&mut html, &row.difference_png, &caption(row));
    }
    html
}

fn caption(row: &Row) -> String {
    format!(
        "{}: rms {:.1e}, max {:.1e}",
        row.setting.label(),
        row.errors.root_mean_square,
        row.errors.maximum
    )
}

pub(crate) fn figure(html: &mut String, png: &[u8], caption: &str) {
    let caption = escaped(caption);
    let data = base64_simd::STANDARD.encode_to_string(png);
    let image = format!("<img src=\"data:image/png;base64,{data}\" alt=\"{caption}\">");
    line_to(html, &format!("<figure>{image}<figcaption>{caption}</figcaption></figure>"));
}

const MEANINGS: &str = include_str!("meanings.html");
