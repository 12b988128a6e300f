//! Error against fineness: a panel a family of grids, a line a filter.

use super::manufactured::Mesh;
use super::report::{FilterReport, GradientTest};
use crate::work_precision::canvas::{Anchor, Axis, BLACK, Canvas, Color, Size, Symbol, WHITE, shown};

const SIZE: [f64; 2] = [960.0, 760.0];
/// Left and right ends of the panels in a row, top and bottom of those in a column.
const ACROSS: [[f64; 2]; 2] = [[80.0, 460.0], [560.0, 940.0]];
const DOWN: [[f64; 2]; 2] = [[70.0, 310.0], [390.0, 630.0]];

/// Styles of the filters' points (colours of Okabe and Ito 2008, symbols and dashes for those who see none); again from the
/// first where there are more filters.
const STYLES: [(Symbol, Color, &[f64]); 6] = [
    (Symbol::Circle, [0, 0, 0], &[]),
    (Symbol::Square, [0, 114, 178], &[7.0, 3.0]),
    (Symbol::TriangleUp, [213, 94, 0], &[2.0, 2.5]),
    (Symbol::Diamond, [0, 158, 115], &[10.0, 3.0, 2.0, 3.0]),
    (Symbol::TriangleDown, [204, 121, 167], &[4.0, 4.0]),
    (Symbol::Cross, [190, 140, 0], &[]),
];

/// Root-mean-square errors inside on the first smooth field.
pub fn plot(test: &GradientTest) -> Canvas {
    let name = test.filters.first().map_or("", |filter| filter.name.as_str());
    let title = format!("{name}: error of the gradient inside against fineness");
    let mut canvas = Canvas::new(SIZE, &title);
    canvas.text([ACROSS[0][0], 26.0], &shown(&title, 90), Size::Large, Anchor::Start, BLACK);
    let errors = |found: &FilterReport, mesh: Mesh| -> Vec<f64> {
        let one = found.convergence.iter().find(|one| one.mesh == mesh.name());
        one.map_or(Vec::new(), |one| one.inside.root_mean_square.clone())
    };
    let all =
        || test.filters.iter().flat_map(|found| Mesh::ALL.into_iter().flat_map(|mesh| errors(found, mesh)));
    let visible = |e: f64| e.max(LEAST);
    for (k, mesh) in Mesh::ALL.into_iter().enumerate() {
        let ([left, right], [top, bottom]) = (ACROSS[k % 2], DOWN[k / 2]);
        let x = Axis::over(test.levels.iter().map(|&n| n as f64), left, right);
        let y = Axis::over(all().map(visible), bottom, top);
        frame(&mut canvas, mesh.name(), [&x, &y], [left, top, right, bottom]);
        for (found, (symbol, color, dashes)) in test.filters.iter().zip(STYLES.iter().cycle()) {
            let errors = errors(found, mesh);
            let places: Vec<[f64; 2]> = test
                .levels
                .iter()
                .zip(&errors)
                .map(|(&n, &e)| [x.place(n as f64), y.place(visible(e))])
                .collect();
            if places.len() > 1 {
                canvas.line(&places, 1.4, *color, dashes);
            }
            for ((at, n), e) in places.iter().zip(&test.levels).zip(&errors) {
                let hint = format!("{}: {n} boxes a side, error {e:.2e}", found.name);
                canvas.shape(symbol.corners(*at, 5.0), WHITE, *color, hint);
            }
        }
    }
    for (k, (found, (symbol, color, dashes))) in test.filters.iter().zip(STYLES.iter().cycle()).enumerate() {
        let at = [ACROSS[0][0] + 300.0 * (k % 3) as f64, 700.0 + 24.0 * (k / 3) as f64];
        canvas.line(&[[at[0], at[1]], [at[0] + 34.0, at[1]]], 1.4, *color, dashes);
        canvas.shape(symbol.corners([at[0] + 17.0, at[1]], 5.0), WHITE, *color, found.name.clone());
        canvas.text([at[0] + 44.0, at[1]], &shown(&found.name, 36), Size::Small, Anchor::Start, BLACK);
    }
    canvas
}

/// Errors are drawn no lower: less is rounding.
const LEAST: f64 = 1e-14;

fn frame(canvas: &mut Canvas, name: &str, [x, y]: [&Axis; 2], [left, top, right, bottom]: [f64; 4]) {
    canvas.plane([x, y], [left, top, right, bottom]);
    canvas.text([left, top - 14.0], &format!("{name} grid"), Size::Small, Anchor::Start, BLACK);
    canvas.text([right, top - 14.0], "relative error, rms", Size::Small, Anchor::End, BLACK);
    let middle = [0.5 * (left + right), bottom + 34.0];
    canvas.text(middle, "boxes along a side", Size::Small, Anchor::Middle, BLACK);
}
