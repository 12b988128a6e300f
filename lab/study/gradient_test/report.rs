//! Options and results of a test of gradient filters: as tables of plain text, as one HTML page that needs no other file, and as a
//! plot of error against fineness.

use crate::columns::aligned;
use crate::gradient_test::manufactured::Mesh;
use crate::gradient_test::requirements::{Requirement, RequirementKind};
use crate::work_precision::canvas::{Anchor, Axis, Canvas, STYLES, WHITE, escaped, shown};
use crate::work_precision::output::{figure, head, line_to as line};
use serde::Serialize;
use voltet_core::field::Method;
use voltet_core::{Error, Result, counted};
use voltet_graph::{Field, Parameters, Registry, SourceSpan};

#[derive(Debug, Clone)]
pub struct TestOptions {
    /// Boxes along a side of each grid, coarse to fine, two at least.
    pub levels: Vec<usize>,
    /// Boxes along a side of the grid that is timed.
    pub timed: usize,
    /// Number of times each filter is timed, after once that warms up.
    pub rounds: usize,
    pub hold_to: Vec<RequirementKind>,
    /// The least order of convergence inside.
    pub order: f64,
    /// The least order of convergence on the boundary.
    pub boundary_order: f64,
    /// The largest error on linear fields, by the largest gradient.
    pub linear_error: f64,
}

impl TestOptions {
    /// Refuses what cannot be measured. `named`: what a number is called where it was given.
    pub fn check(&self, named: impl Fn(&str) -> String) -> Result<()> {
        let wrong = |what: &str, found: String, accepted: &str| {
            let error = Error::usage(format!("{} is out of range", named(what)));
            Err(error.got(found).expected(accepted))
        };
        let rising = self.levels.windows(2).all(|pair| pair[0] < pair[1]);
        if self.levels.len() < 2 || !rising || self.levels.iter().any(|n| !(2..=128).contains(n)) {
            let accepted = "two or more rising numbers from 2 to 128, such as 4,8,16";
            return wrong("levels", format!("{:?}", self.levels), accepted);
        }
        if !(2..=200).contains(&self.timed) {
            return wrong("timed", self.timed.to_string(), "2 to 200 boxes along a side");
        }
        if self.rounds == 0 {
            return wrong("rounds", "0".into(), "1 or more");
        }
        for (name, order) in [("order", self.order), ("boundary_order", self.boundary_order)] {
            if !order.is_finite() {
                return wrong(name, order.to_string(), "a number");
            }
        }
        if self.linear_error.is_nan() || self.linear_error < 0.0 {
            return wrong("linear_error", self.linear_error.to_string(), "a number of at least 0");
        }
        Ok(())
    }
}

impl Default for TestOptions {
    fn default() -> TestOptions {
        TestOptions {
            levels: vec![4, 8, 16, 24],
            timed: 40,
            rounds: 5,
            hold_to: vec![
                RequirementKind::Finite,
                RequirementKind::Linear,
                RequirementKind::Order,
                RequirementKind::Invariance,
            ],
            order: 0.8,
            boundary_order: 0.5,
            linear_error: 1e-9,
        }
    }
}

/// The filter of this name with what is set of its parameters, then those `beside` it with their standard values: all others that can
/// be tested, without names.
///
/// Errors: no such filter or parameter; a filter that reads arrays, of which manufactured grids carry none.
pub fn methods(
    name: &str,
    set: &[Field],
    beside: Option<&[String]>,
    registry: &Registry,
) -> Result<Vec<Method>> {
    let testable = |method: Method| match method.arrays()?.first() {
        None => Ok(method),
        Some(array) => Err(Error::usage("the filter reads a point array, and manufactured grids carry none")
            .got(format!("'{array}'"))
            .expected("a filter that computes gradients")),
    };
    let filter = registry.find_filter(name)?.clone();
    let declared = filter.declaration().parameters;
    let parameters = Parameters::check(declared, set, &SourceSpan::Nowhere, &[])?;
    let method = testable(Method::new(filter, parameters)?).map_err(|error| error.at_item(name))?;
    let mut methods = vec![method];
    let others: Vec<String> = match beside {
        Some(names) => names.to_vec(),
        None => registry.filters().map(|filter| filter.declaration().name.to_string()).collect(),
    };
    for name in others.iter().filter(|other| *other != name && !other.is_empty()) {
        // Those that cannot go without parameters or arrays are left out, unless they were asked for.
        match Method::with_defaults(registry.find_filter(name)?.clone()).and_then(testable) {
            Ok(other) => methods.push(other),
            Err(error) if beside.is_some() => return Err(error.at_item(name)),
            Err(_) => {}
        }
    }
    Ok(methods)
}

/// Filters measured side by side: the first is the one that was asked about.
#[derive(Debug, Clone, Serialize)]
pub struct GradientTest {
    pub filters: Vec<FilterReport>,
    pub requirements: Vec<Requirement>,
    /// What it is not held to, does not keep, and users find out.
    pub warnings: Vec<Requirement>,
    /// Boxes along a side of each grid, coarse to fine.
    pub levels: Vec<usize>,
    /// Threads that filters may use.
    pub threads: usize,
    pub engine: String,
    /// The picture with the exact gradient, PNG.
    #[serde(skip)]
    pub exact_png: Vec<u8>,
}

#[derive(Debug, Clone, Default, Serialize)]
pub struct FilterReport {
    pub name: String,
    pub summary: String,
    /// Its parameters with their values, as a pipeline file would write them.
    pub parameters: Vec<(String, String)>,
    /// Errors on finer and finer grids: one entry a family of grids and field.
    pub convergence: Vec<Convergence>,
    /// Errors where a filter may be exact: one entry a family of grids.
    pub exactness: Vec<Exactness>,
    /// Two materials that meet in a plane of the grid.
    pub materials: Option<Materials>,
    /// Differences by changes that should have no effect.
    pub invariance: Vec<Invariance>,
    /// Gradients of noise: one entry a family of grids.
    pub noise: Vec<Noise>,
    pub cost: Option<Cost>,
    /// Errors on the user's own grid.
    pub data: Option<DataError>,
    pub picture: Option<PictureError>,
    /// Places at which the filter failed or fell back, with its words.
    pub faults: Vec<Fault>,
}

/// Errors of one field on one family of grids.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Convergence {
    pub mesh: &'static str,
    pub field: &'static str,
    pub inside: Series,
    pub boundary: Series,
}

/// Errors from coarse to fine.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Series {
    /// Root of the mean square of |found − exact|, by that of |exact| over all points.
    pub root_mean_square: Vec<f64>,
    /// The largest |found − exact|, by the same.
    pub maximum: Vec<f64>,
    /// log(e₁/e₂) / log(n₂/n₁) of the two finest root mean squares; `None` where there is only rounding left to compare.
    pub order: Option<f64>,
}

/// Largest errors on a field that a filter may get exactly, relative to the largest gradient.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Exactness {
    pub mesh: &'static str,
    pub linear: f64,
    pub quadratic_inside: f64,
    pub quadratic_boundary: f64,
}

/// Two materials that meet in a plane of the grid: the slope across jumps there.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Materials {
    /// The largest error beyond two cells from the plane, by the jump, from coarse to fine.
    pub beyond: Vec<f64>,
    /// Its order; `None` where rounding is all that is left.
    pub order: Option<f64>,
    /// Cells from the plane, on the finest grid, within which errors are above a hundredth of the jump.
    pub reach: usize,
    /// The largest overshoot of ∂s/∂x beyond both of its values, by the jump, on the finest grid.
    pub overshoot: f64,
}

/// Difference by a change that moves a gradient in space alone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Invariance {
    /// Change of the grid or the scalar.
    pub under: &'static str,
    /// The largest difference, by the largest gradient.
    pub difference: f64,
    /// Differences that rounding alone may make.
    pub rounding: f64,
}

/// Gradients of independent noise of variance 1 at the points.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Noise {
    pub mesh: &'static str,
    /// Root of the mean square of |∇noise| × spacing, inside.
    pub inside: f64,
    /// Root of the mean square of |∇noise| × spacing, on the boundary.
    pub boundary: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cost {
    pub points: usize,
    pub tetrahedra: usize,
    /// Median of the seconds, filters taking turns.
    pub median_s: f64,
    pub fastest_s: f64,
    pub slowest_s: f64,
    /// The largest error on a linear field there, by the gradient.
    pub linear_error: f64,
    /// Bytes that the process held at most beyond those before; `None` where the system does not tell.
    pub memory_bytes: Option<u64>,
}

/// Errors on the user's own grid.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DataError {
    pub points: usize,
    /// Pairs of points that share an edge and a position.
    pub coincident_pairs: usize,
    /// The largest error on a linear field, by the gradient.
    pub linear: f64,
}

/// A picture with its gradient magnitude, against the same with the exact one.
#[derive(Debug, Clone, Serialize)]
pub struct PictureError {
    pub size: [u32; 2],
    pub maximum: f64,
    pub root_mean_square: f64,
    /// Pixels that differ by more than 1/255.
    pub pixels_over_step: u64,
    #[serde(skip)]
    pub png: Vec<u8>,
}

/// A filter that failed, or did with less than it promises.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fault {
    /// While what was measured.
    pub at: String,
    /// Message of the filter, or of the check of its vectors.
    pub what: String,
    /// True if it gave nothing; else it fell back at some points.
    pub failed: bool,
}

impl GradientTest {
    /// True if the first filter keeps all that it is held to.
    pub fn passed(&self) -> bool {
        self.requirements.iter().all(|requirement| requirement.holds)
    }
}

/// Everything, filters side by side.
pub fn text(test: &GradientTest) -> String {
    let mut text = tables(test).concat();
    for filter in &test.filters {
        for Fault { at, what, failed } in &filter.faults {
            let did = if *failed { "failed" } else { "fell back" };
            line(&mut text, &format!("{} {did}, {at}: {what}", filter.name));
        }
    }
    if let Some(DataError { points, coincident_pairs, .. }) =
        test.filters.iter().find_map(|found| found.data.as_ref())
    {
        let (points, pairs) = (counted(*points, "point"), counted(*coincident_pairs, "pair"));
        line(
            &mut text,
            &format!("\nThe given grid has {points}, and {pairs} of neighbours at the same position"),
        );
    }
    let name = test.filters.first().map_or("", |filter| filter.name.as_str());
    if !test.requirements.is_empty() {
        line(&mut text, &format!("\nWhat {name} is held to"));
    }
    for requirement in &test.requirements {
        let mark = if requirement.holds { "held  " } else { "BROKEN" };
        line(&mut text, &format!("  {mark}  {}; found {}", requirement.what, requirement.found));
    }
    for Requirement { what, found, .. } in &test.warnings {
        line(&mut text, &format!("  WARNING it does not hold: {what}; found {found}"));
    }
    text.trim_start().to_string()
}

/// A row of one filter: what it is of, and its cell.
type Cell = (Vec<String>, String);

fn cell<const N: usize>(names: [&str; N], value: String) -> Cell {
    (names.map(str::to_string).to_vec(), value)
}

/// A table with columns of names and one a filter: rows by what they are of, that of any filter that has it.
fn table(
    test: &GradientTest,
    title: String,
    heads: &[&str],
    cells: impl Fn(&FilterReport) -> Vec<Cell>,
    note: &str,
) -> String {
    let each: Vec<Vec<Cell>> = test.filters.iter().map(cells).collect();
    let mut keys: Vec<&Vec<String>> = Vec::new();
    for (key, _) in each.iter().flatten() {
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    let value = |cells: &Vec<Cell>, key: &Vec<String>| {
        cells.iter().find(|(other, _)| other == key).map_or("failed".into(), |(_, value)| value.clone())
    };
    let names = test.filters.iter().map(|filter| filter.name.clone());
    let mut rows = vec![heads.iter().map(|head| head.to_string()).chain(names).collect::<Vec<_>>()];
    rows.extend(keys.iter().map(|&key| {
        key.iter().cloned().chain(each.iter().map(|cells| value(cells, key))).collect::<Vec<_>>()
    }));
    // The first column at least is a name; further ones stand before the filters.
    let table = aligned(&rows, |k| k == 0 || matches!(rows[0][k].as_str(), "field" | "where"));
    let lines: String = table.lines().map(|row| format!("  {row}\n")).collect();
    format!("\n{title}\n{lines}  {note}\n")
}

fn tables(test: &GradientTest) -> Vec<String> {
    let order = |order: Option<f64>, error: Option<&f64>| {
        let order = order.map_or("–".into(), |order| format!("{order:.2}"));
        format!("{order} ({:.1e})", error.copied().unwrap_or(f64::NAN))
    };
    let finest = test.levels.last().copied().unwrap_or(0);
    let cost = test.filters.iter().find_map(|filter| filter.cost.as_ref());
    let cost = cost.map_or(String::new(), |cost| {
        format!(": {}, {}", counted(cost.points, "point"), counted(cost.tetrahedra, "tetrahedron"))
    });
    let picture = test.filters.iter().find_map(|filter| filter.picture.as_ref()).map(|picture| picture.size);
    let picture = picture.map_or(String::new(), |[w, h]| format!(" of {w} × {h} pixels"));
    vec![
        table(
            test,
            format!("Order of convergence, and relative error (rms) at {finest} boxes a side"),
            &["grid", "field", "where"],
            |found| {
                let both = found.convergence.iter().flat_map(|one| {
                    [("inside", &one.inside), ("boundary", &one.boundary)].map(|(place, series)| {
                        cell(
                            [one.mesh, one.field, place],
                            order(series.order, series.root_mean_square.last()),
                        )
                    })
                });
                both.collect()
            },
            &format!(
                "between the two finest of {:?} boxes a side; relative to the rms of the exact gradient",
                test.levels
            ),
        ),
        table(
            test,
            "Largest error on a linear and a quadratic field".into(),
            &["grid", "field", "where"],
            |found| {
                let each = found.exactness.iter().flat_map(|one| {
                    [
                        ("linear", "everywhere", one.linear),
                        ("quadratic", "inside", one.quadratic_inside),
                        ("quadratic", "boundary", one.quadratic_boundary),
                    ]
                    .map(|(field, place, error)| cell([one.mesh, field, place], format!("{error:.1e}")))
                });
                let large = found.cost.iter().map(|cost| ("timed", cost.linear_error));
                let own = found.data.iter().map(|data| ("given", data.linear));
                let linear = |(mesh, error)| cell([mesh, "linear", "everywhere"], format!("{error:.1e}"));
                each.chain(large.chain(own).map(linear)).collect()
            },
            "relative to the largest gradient; 1e-12 and less is rounding",
        ),
        table(
            test,
            "Two materials: ∂s/∂x jumps from 1 to 10 in a plane of the grid".into(),
            &["what"],
            |found| {
                found.materials.as_ref().map_or(Vec::new(), |one| {
                    vec![
                        cell(["order beyond two cells (largest error)"], order(one.order, one.beyond.last())),
                        cell(["cells that errors of 1 % reach"], one.reach.to_string()),
                        cell(["overshoot"], format!("{:.1e}", one.overshoot)),
                    ]
                })
            },
            "by the jump",
        ),
        table(
            test,
            "What should change nothing: largest difference".into(),
            &["under", "rounding"],
            |found| {
                let each = found.invariance.iter();
                let each = each.map(|one| {
                    cell([one.under, &format!("{:.0e}", one.rounding)], format!("{:.1e}", one.difference))
                });
                each.collect()
            },
            "relative to the largest gradient; rounding: what differences of values may make of the last digit",
        ),
        table(
            test,
            "Noise of variance 1 at the points: rms of its gradient × spacing".into(),
            &["grid", "where"],
            |found| {
                let both = found.noise.iter().flat_map(|one| {
                    [("inside", one.inside), ("boundary", one.boundary)]
                        .map(|(place, size)| cell([one.mesh, place], format!("{size:.2}")))
                });
                both.collect()
            },
            "less is smoother; it is paid for by errors above",
        ),
        table(
            test,
            format!("Cost{cost}, {}", counted(test.threads, "thread")),
            &["what"],
            |found| {
                let Some(one) = &found.cost else { return Vec::new() };
                let ms = |seconds: f64| format!("{:.1}", 1e3 * seconds);
                let mib = one.memory_bytes.map(|bytes| format!("{:.1}", bytes as f64 / f64::from(1 << 20)));
                vec![
                    cell(["median, ms"], ms(one.median_s)),
                    cell(["fastest, ms"], ms(one.fastest_s)),
                    cell(["slowest, ms"], ms(one.slowest_s)),
                    cell(["10⁶ points/s"], format!("{:.2}", 1e-6 * one.points as f64 / one.median_s)),
                    cell(["memory, MiB"], mib.unwrap_or("–".into())),
                ]
            },
            "filters take turns; memory beyond what the process held",
        ),
        table(
            test,
            format!(
                "A picture{picture} whose widgets look at |∇s|, against the same with the exact gradient"
            ),
            &["what"],
            |found| {
                let Some(one) = &found.picture else { return Vec::new() };
                vec![
                    cell(["largest error"], format!("{:.1e}", one.maximum)),
                    cell(["rms error"], format!("{:.1e}", one.root_mean_square)),
                    cell(["pixels over 1/255"], one.pixels_over_step.to_string()),
                ]
            },
            &format!("lit, 16 boxes a side, engine {}; 1 is full scale", test.engine),
        ),
    ]
}

/// The page: the plot, an SVG document, the tables as text, and the pictures.
pub fn page(test: &GradientTest, plot: &str) -> String {
    let names: Vec<String> = test.filters.iter().map(|filter| escaped(&filter.name)).collect();
    let title =
        names.first().map_or("Gradient filters".to_string(), |name| format!("Gradient filter {name}"));
    let mut html = head(&title);
    if let Some(filter) = test.filters.first() {
        let set: Vec<String> =
            filter.parameters.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        let with =
            if set.is_empty() { String::new() } else { format!(" With {}.", escaped(&set.join(", "))) };
        line(&mut html, &format!("<p>{}{with}</p>", escaped(&filter.summary)));
    }
    let beside =
        names.get(1..).filter(|rest| !rest.is_empty()).map_or("no other".into(), |rest| rest.join(", "));
    let version = env!("CARGO_PKG_VERSION");
    line(&mut html, &format!("<p>Beside {beside}. Every error is against a formula; voltet {version}.</p>"));
    line(&mut html, &format!("<h2>Error against fineness</h2>\n{plot}"));
    line(&mut html, &format!("<h2>Tables</h2>\n<pre>{}</pre>", escaped(&text(test))));
    figure(&mut html, &test.exact_png, "the exact gradient");
    for filter in &test.filters {
        if let Some(picture) = &filter.picture {
            let caption = format!("{}: largest error {:.1e}", filter.name, picture.maximum);
            figure(&mut html, &picture.png, &caption);
        }
    }
    html + "</body>\n</html>\n"
}

const SIZE: [f64; 2] = [960.0, 760.0];
/// Left and right ends of the panels in a row, top and bottom of those in a column.
const ACROSS: [[f64; 2]; 2] = [[80.0, 460.0], [560.0, 940.0]];
const DOWN: [[f64; 2]; 2] = [[70.0, 310.0], [390.0, 630.0]];

/// Root-mean-square errors inside on the first smooth field.
pub fn plot(test: &GradientTest) -> Canvas {
    let name = test.filters.first().map_or("", |filter| filter.name.as_str());
    let title = format!("{name}: error of the gradient inside against fineness");
    let mut canvas = Canvas::new(SIZE, &title);
    canvas.heading([ACROSS[0][0], 26.0], &shown(&title, 90));
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
        for (found, style) in test.filters.iter().zip(STYLES.iter().cycle()) {
            let errors = errors(found, mesh);
            let places: Vec<[f64; 2]> = test
                .levels
                .iter()
                .zip(&errors)
                .map(|(&n, &e)| [x.place(n as f64), y.place(visible(e))])
                .collect();
            if places.len() > 1 {
                canvas.line(&places, 1.4, style.color, style.dashes);
            }
            for ((at, n), e) in places.iter().zip(&test.levels).zip(&errors) {
                let hint = format!("{}: {n} boxes a side, error {e:.2e}", found.name);
                canvas.symbol(*at, 5.0, style, WHITE, &hint);
            }
        }
    }
    for (k, (found, style)) in test.filters.iter().zip(STYLES.iter().cycle()).enumerate() {
        let at = [ACROSS[0][0] + 300.0 * (k % 3) as f64, 700.0 + 24.0 * (k / 3) as f64];
        canvas.entry(at, style, true, &shown(&found.name, 36));
    }
    canvas
}

/// Errors are drawn no lower: less is rounding.
const LEAST: f64 = 1e-14;

fn frame(canvas: &mut Canvas, name: &str, [x, y]: [&Axis; 2], [left, top, right, bottom]: [f64; 4]) {
    canvas.plane([x, y], [left, top, right, bottom]);
    canvas.text([left, top - 14.0], &format!("{name} grid"), Anchor::Start);
    canvas.text([right, top - 14.0], "relative error, rms", Anchor::End);
    canvas.text([0.5 * (left + right), bottom + 34.0], "boxes along a side", Anchor::Middle);
}
