//! Widgets of transfer functions that are to be rescaled to other data, and the edits that do it.

use crate::transfer;
use crate::worker::DataScales;
use voltet_core::Result;
use voltet_core::arithmetic::decimal;
use voltet_core::parameters::{ArrayRef, Parameters};
use voltet_core::transfer::{AxisScale, DataStatistics, WIDGET_KINDS, on_other_scales, rescaled};
use voltet_document::{Edit, Gesture, Path};
use voltet_graph::{LocatedValue, NodeEntry, ParameterValue, SourceSpan, find_setting};

/// Share of the volume whose gradient magnitude counts as its range: that of the others, of a few slivers, is many times as large.
const NEARLY_ALL: f64 = 0.999;

/// Widgets whose numbers are those of an array that is not drawn any more.
#[derive(Clone)]
pub(crate) struct PendingRescale {
    /// The node that chooses the other array, as it does.
    pub chooser: NodeEntry,
    /// Transfer functions that are rescaled, as they stand.
    pub looks: Vec<NodeEntry>,
    /// Names of those that stay at their numbers, though the array is theirs.
    pub left: Vec<String>,
    /// Output that gives the volume.
    pub output: String,
    /// Ranges of the former array, where they are known.
    pub before: Option<DataScales>,
    /// The step that chose the array.
    pub gesture: Gesture,
}

/// Ranges along the axes of a transfer function: of *g* that of nearly all of the volume.
struct Axes<'a> {
    known: &'a DataScales,
    scales: [AxisScale; 2],
}

impl DataStatistics for Axes<'_> {
    fn scale(&self, quantity: &ArrayRef) -> AxisScale {
        match quantity {
            ArrayRef::Named("s") => self.scales[0],
            ArrayRef::Named("g") => self.scales[1],
            _ => AxisScale::Linear,
        }
    }

    fn range(&self, quantity: &ArrayRef) -> Result<[f64; 2]> {
        let [low, high] = self.known.range(quantity)?;
        Ok(match (quantity, self.known.spreads.get(quantity)) {
            (ArrayRef::Named("g"), Some(spread)) => [low, spread.value_at(NEARLY_ALL)],
            _ => [low, high],
        })
    }

    fn percentile(&self, quantity: &ArrayRef, percent: f64) -> Result<f64> {
        self.known.percentile(quantity, percent)
    }
}

/// Edits by which the widgets of a transfer function, and the linear part of its axes, are those of other data.
pub(crate) fn edits(look: &NodeEntry, before: &DataScales, after: &DataScales) -> Vec<Edit> {
    let scales = transfer::scales(look, &transfer::S_AND_G);
    let mut edits = Vec::new();
    let mut scales_after = scales;
    for (k, name) in ["s", "g"].into_iter().enumerate() {
        let largest = |known: &DataScales| {
            let [low, high] = known.range(&ArrayRef::Named(name)).ok()?;
            Some(low.abs().max(high.abs())).filter(|largest| *largest > 0.0)
        };
        if let (AxisScale::SymLog { linear_below }, Some(from), Some(to)) =
            (scales[k], largest(before), largest(after))
            && from != to
        {
            let linear_below = decimal(linear_below * to / from, 1e-4 * linear_below * to / from);
            scales_after[k] = AxisScale::SymLog { linear_below };
            edits.push(Edit::set(&look.name, [&*format!("{name}_linear_below")], linear_below.into()));
        }
    }
    let [before, after] =
        [(before, scales), (after, scales_after)].map(|(known, scales)| Axes { known, scales });
    edits.extend(of_widgets(look, &mut |_, widget| rescaled(widget, &before, &after)));
    edits
}

/// Edits by which the widgets of a transfer function reach to the same values on axes of other scales; and the numbers, from 1, of widgets
/// that cannot. `known`: what is known of its data.
pub(crate) fn edits_of_scales(
    look: &NodeEntry,
    known: Option<&DataScales>,
    after: &[AxisScale; 2],
) -> (Vec<Edit>, Vec<usize>) {
    let axes = transfer::scales(look, &transfer::S_AND_G);
    let before = DataScales { axes, ..known.cloned().unwrap_or_default() };
    let mut left = Vec::new();
    let edits = of_widgets(look, &mut |place, widget| {
        on_other_scales(widget, &before, after).inspect_err(|_| left.push(place + 1))
    });
    (edits, left)
}

/// Data whose quantities reach from 0 to a number.
struct Span(f64);

impl DataStatistics for Span {
    fn range(&self, _: &ArrayRef) -> Result<[f64; 2]> {
        Ok([0.0, self.0])
    }

    fn percentile(&self, _: &ArrayRef, percent: f64) -> Result<f64> {
        Ok(percent)
    }
}

/// True if numbers of a transfer function's widgets, or of its axes, are those of its data, and not all relative to them.
pub(crate) fn is_absolute(look: &NodeEntry) -> bool {
    let is_of_axis = ["s_linear_below", "g_linear_below"].iter().any(|name| look.setting(name).is_some());
    is_of_axis || !of_widgets(look, &mut |_, widget| rescaled(widget, &Span(1.0), &Span(2.0))).is_empty()
}

/// Edits that make of each widget, by its place and parameters, what a function gives; where it gives an error, the widget stays.
fn of_widgets(
    look: &NodeEntry,
    replace: &mut dyn FnMut(usize, &Parameters) -> Result<Parameters>,
) -> Vec<Edit> {
    let mut edits = Vec::new();
    let widgets = look.setting("widgets").and_then(LocatedValue::list).unwrap_or_default();
    for (place, widget) in widgets.iter().enumerate() {
        let Some(fields) = widget.table() else { continue };
        let kind = find_setting(fields, "kind").and_then(LocatedValue::text);
        let Some(kind) = WIDGET_KINDS.iter().find(|known| Some(known.name) == kind) else { continue };
        // What is wrong with a widget is said elsewhere.
        let found =
            Parameters::survey(kind.parameters, fields, &SourceSpan::Nowhere, &["kind"], &mut |_, _| {});
        let Ok(found) = replace(place, &found) else { continue };
        let path = Path::from("widgets").with(place);
        for (parameter, setting, _) in found.iter() {
            let Some(new) = setting else { continue };
            let stated = find_setting(fields, parameter.name);
            let usual = parameter.default.datum().map(LocatedValue::from);
            if let Some(old) = stated.or(usual.as_ref()) {
                let whole = stated.is_none();
                differences(&look.name, path.with(parameter.name), old, new, whole, &mut edits);
            }
        }
    }
    edits
}

/// Edits that make of a value another: of each number that differs where both are lists or tables of the same parts, so that what stands
/// between them in the file stays.
fn differences(
    node: &str,
    path: Path,
    old: &LocatedValue,
    new: &LocatedValue,
    whole: bool,
    edits: &mut Vec<Edit>,
) {
    if old == new {
        return;
    }
    match (&old.datum, &new.datum) {
        (ParameterValue::List(olds), ParameterValue::List(news)) if olds.len() == news.len() && !whole => {
            for (place, (old, new)) in olds.iter().zip(news).enumerate() {
                differences(node, path.with(place), old, new, false, edits);
            }
        }
        (ParameterValue::Table(olds), ParameterValue::Table(news)) if !whole => {
            for old in olds {
                if let Some(new) = find_setting(news, &old.name) {
                    differences(node, path.with(&*old.name), &old.setting, new, false, edits);
                }
            }
        }
        (_, new) => edits.push(Edit::set(node, path, new.clone())),
    }
}
