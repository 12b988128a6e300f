//! The work-precision plot: error over time, both in powers of ten, the Pareto front marked.

use super::canvas::{Anchor, Axis, BLACK, CHARACTER, CIRCLE, Canvas, Color, STYLES, Style, WHITE, shown};
use super::settings::Numbers;
use super::{RendererVariant, Row, Study};
use voltet_integrators::{DEFAULT_OVERSAMPLING, DEFAULT_PLANES, DEFAULT_SIDE};
use voltet_optics::WidgetBlend;
use voltet_optics::integrators::Integrator;
use voltet_optics::shading::VisibilityOrder;
use voltet_reference::REFERENCE;

const SIZE: [f64; 2] = [960.0, 600.0];

/// Grey of the Pareto front.
const FRONT: Color = [205, 205, 205];

/// Left, top, right, bottom of the plane within the axes.
const PLANE: [f64; 4] = [84.0, 46.0, 716.0, 540.0];

/// Errors are drawn no lower than this: less is below what 32-bit numbers near 1 can tell apart.
const MIN_ERROR: f64 = 1e-8;

/// Every kind with its style and its rows. The referee's, with which the others are compared, has no rows.
fn kinds(study: &Study) -> impl Iterator<Item = (Integrator, &'static Style, Vec<&Row>)> {
    let of = |(kind, style): (Integrator, &'static Style)| {
        let rows = study.rows.iter().filter(|row| row.setting.integrator.is_kind_of(&kind)).collect();
        (kind, style, rows)
    };
    let kinds = study.subject.integrators.iter().copied();
    kinds.filter(|kind| *kind != REFERENCE).zip(STYLES.iter().cycle()).map(of)
}

pub fn plot(study: &Study, title: &str) -> Canvas {
    let measure = study.wish.measure;
    let error = |row: &Row| row.error(measure).max(MIN_ERROR);
    let time = |row: &Row| row.cost.picture.median_ms;
    let [left, top, right, bottom] = PLANE;
    let x = Axis::over(study.rows.iter().map(time), left, right);
    let bound = study.wish.max_error.map(|bound| bound.max(MIN_ERROR));
    let y = Axis::over(study.rows.iter().map(error).chain(bound), bottom, top);
    let at = |row: &Row| [x.place(time(row)), y.place(error(row).min(10f64.powf(y.high)))];

    let mut canvas = Canvas::new(SIZE, &format!("{title}: error against time of every integrator"));
    // A device keeps what it has set up.
    let time_label = match variants(study).iter().any(|variant| variant.engine.on_device) {
        true => "time of a picture, set-up included on the CPU, not on the device (ms)",
        false => "time of a picture, set-up included (ms)",
    };
    axes(&mut canvas, [&x, &y], title, [time_label, &measure.label()]);
    if let Some(bound) = bound {
        let height = y.place(bound);
        canvas.line(&[[left, height], [right, height]], 1.2, BLACK, &[3.0, 3.0]);
        let text = format!("error allowed: {bound}");
        canvas.text([right - 6.0, height - 9.0], &text, Anchor::End);
    }
    front(&mut canvas, study, &at);
    for (_, style, rows) in kinds(study) {
        for variant in variants(study) {
            let main = rows.iter().filter(|row| is_main(row) && row.setting.variant == variant);
            let main: Vec<[f64; 2]> = main.map(|row| at(row)).collect();
            if main.len() > 1 {
                canvas.line(&main, 1.4, style.color, style.dashes);
            }
        }
        for row in rows {
            let radius = if row.on_front { 6.5 } else { 5.0 };
            let fill = if row.on_front { style.color } else { WHITE };
            let hint =
                format!("{}: {:.3} ms, error {:.2e}", row.setting.label(), time(row), row.error(measure));
            canvas.symbol(at(row), radius, style, fill, &hint);
            around(&mut canvas, style, row.setting.variant, at(row), radius);
        }
    }
    if let Some(row) = study.recommended.map(|i| &study.rows[i]) {
        canvas.ring(at(row), 11.0, CIRCLE, 1.8, BLACK);
    }
    labels(&mut canvas, study, &at);
    legend(&mut canvas, study);
    canvas
}

fn variants(study: &Study) -> Vec<RendererVariant> {
    RendererVariant::all()
        .filter(|variant| study.rows.iter().any(|row| row.setting.variant == *variant))
        .collect()
}

const OUTLINE: f64 = 3.0;

/// By how much the outlines of a variant reach further than a symbol.
fn further(variant: RendererVariant) -> f64 {
    OUTLINE * variant.number() as f64
}

/// Outlines that distinguish the variants' symbols without colour: each has an outline more than the one before.
fn around(canvas: &mut Canvas, style: &Style, variant: RendererVariant, at: [f64; 2], radius: f64) {
    for outline in 1..=variant.number() {
        canvas.ring(at, radius + OUTLINE * outline as f64, style.symbol, 1.0, style.color);
    }
}

/// True if a row belongs to its integrator's line: the sweep of one number, everything else as usual.
fn is_main(row: &Row) -> bool {
    let numbers = Numbers::of(&row.setting.integrator);
    let usual_table = match numbers.count {
        Some(_) => numbers.table_size.is_none_or(|side| side == DEFAULT_SIDE),
        None => {
            numbers.oversampling.is_none_or(|n| n == DEFAULT_OVERSAMPLING)
                && numbers.planes.is_none_or(|n| n == DEFAULT_PLANES)
        }
    };
    is_swept(&row.setting.integrator) && usual_table && row.setting.order != VisibilityOrder::Centroid
}

/// True if the integrator has a number that its line is drawn over.
fn is_swept(integrator: &Integrator) -> bool {
    !integrator.parameters().is_empty()
}

fn axes(canvas: &mut Canvas, [x, y]: [&Axis; 2], title: &str, [time, error]: [&str; 2]) {
    let [left, top, right, bottom] = PLANE;
    canvas.plane([x, y], PLANE);
    canvas.heading([left, 22.0], &shown(title, 72));
    canvas.text([0.5 * (left + right), bottom + 40.0], time, Anchor::Middle);
    canvas.upward_text([18.0, 0.5 * (top + bottom)], error);
}

/// A broad grey line in steps: what is to the right of it and above is beaten.
fn front(canvas: &mut Canvas, study: &Study, at: &dyn Fn(&Row) -> [f64; 2]) {
    let mut places: Vec<[f64; 2]> = study.rows.iter().filter(|row| row.on_front).map(at).collect();
    places.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut steps: Vec<[f64; 2]> = Vec::new();
    for place in places {
        if let Some(last) = steps.last() {
            steps.push([place[0], last[1]]);
        }
        steps.push(place);
    }
    if steps.len() > 1 {
        canvas.line(&steps, 7.0, FRONT, &[]);
    }
}

/// The number that a row differs by from its neighbours on the line.
fn short(row: &Row) -> String {
    let mut text = match Numbers::of(&row.setting.integrator) {
        Numbers { tolerance: Some(tolerance), .. } => format!("{tolerance:e}"),
        Numbers { count: Some(count), table_size: None | Some(256), .. } => count.to_string(),
        Numbers { count: Some(count), table_size: Some(side), .. } => format!("{count}, table {side}"),
        Numbers { table_size: Some(side), oversampling, planes, .. } => {
            let mut text = side.to_string();
            let unusual = |number: Option<usize>, usual| number.filter(|n| *n != usual);
            text.extend(unusual(oversampling, DEFAULT_OVERSAMPLING).map(|n| format!(", oversampling {n}")));
            text.extend(unusual(planes, DEFAULT_PLANES).map(|n| format!(", planes {n}")));
            text
        }
        Numbers { .. } => row.setting.integrator.name().to_string(),
    };
    if row.setting.overlap == WidgetBlend::Mix {
        text += ", mix";
    }
    if row.setting.order == VisibilityOrder::Centroid {
        text += ", centroid";
    }
    text
}

/// Labels where there is room: the recommended row first, then the front, then the others.
fn labels(canvas: &mut Canvas, study: &Study, at: &dyn Fn(&Row) -> [f64; 2]) {
    let around = |row: &Row| {
        let ([x, y], reach) = (at(row), 6.0 + further(row.setting.variant));
        [x - reach, y - reach, x + reach, y + reach]
    };
    let mut taken: Vec<[f64; 4]> = study.rows.iter().map(around).collect();
    let mut order: Vec<usize> = (0..study.rows.len()).collect();
    order.sort_by_key(|&i| (Some(i) != study.recommended, !study.rows[i].on_front));
    let [left, top, right, bottom] = PLANE;
    for i in order {
        let row = &study.rows[i];
        let (text, [x, y]) = (short(row), at(row));
        // Beside the ring around the recommended one.
        let gap = if study.recommended == Some(i) { 15.0 } else { 9.0 + further(row.setting.variant) };
        let (width, half) = (CHARACTER[0] * text.chars().count() as f64, 0.5 * CHARACTER[1]);
        let boxes = [
            [x + gap, y - half, x + gap + width, y + half],
            [x - gap - width, y - half, x - gap, y + half],
            [x - 0.5 * width, y - gap - 2.0 * half, x + 0.5 * width, y - gap],
            [x - 0.5 * width, y + gap, x + 0.5 * width, y + gap + 2.0 * half],
        ];
        let free = |b: &[f64; 4]| {
            let within = b[0] > left && b[1] > top && b[2] < right && b[3] < bottom;
            within && taken.iter().all(|t| b[2] < t[0] || b[0] > t[2] || b[3] < t[1] || b[1] > t[3])
        };
        if let Some(place) = boxes.into_iter().find(free) {
            taken.push(place);
            // Lines behind a label make it hard to read.
            let [left, top, right, bottom] = place;
            canvas.rectangle([left - 1.0, top + 1.0, right + 1.0, bottom - 1.0], Some(WHITE), WHITE, "");
            canvas.text([left, 0.5 * (top + bottom)], &text, Anchor::Start);
        }
    }
}

fn legend(canvas: &mut Canvas, study: &Study) {
    let x = PLANE[2] + 14.0;
    let mut y = PLANE[1] + 8.0;
    for (kind, style, rows) in kinds(study) {
        if !rows.is_empty() {
            canvas.entry([x, y], style, is_swept(&kind), kind.name());
            y += 20.0;
        }
    }
    let plain = &STYLES[0];
    let variants = variants(study);
    for variant in variants.iter().filter(|_| variants != [RendererVariant::NATIVE]) {
        y += 6.0;
        canvas.entry([x, y], plain, false, &format!("on {}", variant.label()));
        around(canvas, plain, *variant, [x + 14.0, y], 5.0);
        y += 20.0;
    }
    y += 8.0;
    canvas.line(&[[x, y], [x + 28.0, y]], 7.0, FRONT, &[]);
    canvas.entry([x, y], plain, false, "Pareto front (filled)");
    canvas.symbol([x + 14.0, y], 5.0, plain, BLACK, "");
    if study.recommended.is_some() {
        y += 22.0;
        canvas.ring([x + 14.0, y], 9.0, CIRCLE, 1.8, BLACK);
        canvas.text([x + 34.0, y], "recommended", Anchor::Start);
    }
    for line in ["Numbers: tolerance,", "pieces, samples or", "side of the table"] {
        y += 14.0;
        canvas.text([x, y + 16.0], line, Anchor::Start);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_cover_what_is_drawn_and_label_powers_of_ten() {
        let axis = Axis::over([0.5, 300.0, f64::INFINITY, 0.0].into_iter(), 0.0, 100.0);
        assert!(axis.place(0.5) > 0.0 && axis.place(300.0) < 100.0);
        let labels: Vec<String> = axis.ticks().into_iter().filter_map(|(_, label)| label).collect();
        assert_eq!(labels, ["1", "10", "100"]);
        // One value, or none, makes an axis too.
        assert!(Axis::over([7.0].into_iter(), 0.0, 1.0).ticks().iter().any(|tick| tick.1.is_some()));
        assert!(Axis::over([].into_iter(), 0.0, 1.0).ticks().iter().any(|tick| tick.1.is_some()));
    }
}
