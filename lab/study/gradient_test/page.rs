//! The test as one HTML page that needs no other file.

use super::report::GradientTest;
use super::text::tables;
use crate::work_precision::canvas::escaped;
use crate::work_precision::page::{figure, head, line_to as line};

/// Black on white, figures in columns, nothing that needs colour.
const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;max-width:1100px;margin:2em auto;padding:0 1em;\
color:#141414;background:#fff}table{border-collapse:collapse;font-size:13px;margin-bottom:.3em}.wide{overflow-x:auto}\
th,td{padding:2px 10px;text-align:right;white-space:nowrap;border-bottom:1px solid #ddd}\
th:first-child,td:first-child,td.name,th.name{text-align:left}th{border-bottom:2px solid #141414}\
.note{font-size:13px;color:#444;margin-top:0}.broken{font-weight:700}svg,img{max-width:100%;height:auto}\
figure{margin:0 1em 1em 0;display:inline-block;vertical-align:top;width:256px}figcaption{font-size:13px}";

/// The page. `plot`: the SVG document.
pub fn page(test: &GradientTest, plot: &str) -> String {
    let names: Vec<String> = test.filters.iter().map(|filter| escaped(&filter.name)).collect();
    let title =
        names.first().map_or("Gradient filters".to_string(), |name| format!("Gradient filter {name}"));
    let mut html = head(&title, STYLE);
    for filter in test.filters.iter().take(1) {
        let set: Vec<String> =
            filter.parameters.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        let with =
            if set.is_empty() { String::new() } else { format!(" With {}.", escaped(&set.join(", "))) };
        line(&mut html, &format!("<p>{}{with}</p>", escaped(&filter.summary)));
    }
    line(
        &mut html,
        &format!(
            "<p>Beside {}. Every error is against a formula; voltet {}.</p>",
            names.get(1..).filter(|rest| !rest.is_empty()).map_or("no other".into(), |rest| rest.join(", ")),
            env!("CARGO_PKG_VERSION")
        ),
    );
    if !test.requirements.is_empty() {
        line(&mut html, "<h2>What it is held to</h2>\n<ul>");
        for requirement in &test.requirements {
            let (class, mark) =
                if requirement.holds { ("", "held") } else { (" class=\"broken\"", "BROKEN") };
            let (what, found) = (escaped(&requirement.what), escaped(&requirement.found));
            line(&mut html, &format!("<li{class}>{mark}: {what}; found {found}</li>"));
        }
        line(&mut html, "</ul>");
    }
    line(&mut html, "<h2>Error against fineness</h2>");
    line(&mut html, plot);
    for table in tables(test) {
        let first_figure = table.heads.len() - test.filters.len();
        let class = |k: usize| if k < first_figure { " class=\"name\"" } else { "" };
        let cells = |tag: &str, row: &[String]| -> String {
            row.iter()
                .enumerate()
                .map(|(k, cell)| format!("<{tag}{}>{}</{tag}>", class(k), escaped(cell)))
                .collect()
        };
        line(&mut html, &format!("<h2>{}</h2>\n<div class=\"wide\"><table>", escaped(&table.title)));
        line(&mut html, &format!("<thead><tr>{}</tr></thead>\n<tbody>", cells("th", &table.heads)));
        for row in &table.rows {
            line(&mut html, &format!("<tr>{}</tr>", cells("td", row)));
        }
        line(&mut html, &format!("</tbody></table></div>\n<p class=\"note\">{}</p>", escaped(&table.note)));
    }
    figure(&mut html, &test.exact_png, "the exact gradient");
    for filter in &test.filters {
        if let Some(picture) = &filter.picture {
            figure(
                &mut html,
                &picture.png,
                &format!("{}: largest error {:.1e}", filter.name, picture.maximum),
            );
        }
    }
    faults(&mut html, test);
    html + "</body>\n</html>\n"
}

fn faults(html: &mut String, test: &GradientTest) {
    if test.filters.iter().all(|filter| filter.faults.is_empty()) {
        return;
    }
    line(html, "<h2>Failures and fall-backs</h2>\n<ul>");
    for filter in &test.filters {
        for fault in &filter.faults {
            let text = fault.said(&filter.name);
            line(html, &format!("<li>{}</li>", escaped(&text)));
        }
    }
    line(html, "</ul>");
}
