//! Widgets of the array before, where a reader is to draw another: their numbers become the same shares of its range once that is known,
//! in the step that chose the array.

use crate::editor::Editor;
use crate::jobs::reads;
use crate::transfer;
use crate::worker::DataScales;
use voltet_core::Result;
use voltet_core::arithmetic::decimal;
use voltet_core::parameters::{ArrayRef, Parameters};
use voltet_core::transfer::{AxisScale, DataStatistics, WIDGET_KINDS, carried};
use voltet_document::links::{self, upstream};
use voltet_document::{Edit, Gesture, Path};
use voltet_graph::{LocatedValue, NodeEntry, ParameterValue, SourceSpan, find_setting};

/// Parameters of a reader that choose the array.
const CHOICE: [&str; 2] = ["scalar", "association"];

/// Share of the volume whose gradient magnitude counts as its range: that of the others, of a few slivers, is many times as large.
const NEARLY_ALL: f64 = 0.999;

/// Widgets whose numbers are those of an array that is not drawn any more.
pub(crate) struct FormerArray {
    /// Reader, as it chooses the other array.
    reader: NodeEntry,
    /// Transfer functions, as they stand.
    looks: Vec<NodeEntry>,
    /// Output that gives the volume.
    output: String,
    /// Ranges of the former array.
    known: DataScales,
    /// The step that chose the array.
    gesture: Gesture,
}

impl FormerArray {
    /// The gesture that the step is of.
    pub fn gesture(&self) -> Gesture {
        self.gesture
    }
}

impl Editor {
    /// The widgets and ranges before edits by which a reader draws another array; `None` of other edits, and where the ranges are not known.
    pub(crate) fn before_other_array(&mut self, edits: &[Edit]) -> Option<FormerArray> {
        let chooses = |edit: &&Edit| match edit {
            Edit::Set { path, .. } | Edit::Unset { path, .. } => {
                CHOICE.iter().any(|name| *path == (*name).into())
            }
            _ => false,
        };
        let (Edit::Set { node, .. } | Edit::Unset { node, .. }) = edits.iter().find(chooses)? else {
            return None;
        };
        let reader = self.node(node).filter(|entry| reads(entry, &self.registry))?.clone();
        let gesture = self.gesture.unwrap_or_else(|| self.gestures.begin());
        if let Some(former) = self.former_array.take().filter(|former| self.is_as_left(former)) {
            // Still those of the array before that one.
            return Some(FormerArray { reader, gesture, ..former });
        }
        let output = self.edited()?.1;
        let nodes = &self.document.pipeline().nodes;
        if !upstream(nodes, links::source(&output, nodes).0).contains(node) {
            return None;
        }
        let Some(Ok(known)) = self.known_of(&output) else {
            self.actions
                .say("the widgets stay at their numbers: the ranges of the array before were not known yet");
            return None;
        };
        let scene = self.scene();
        let is_drawn = |entry: &&NodeEntry| {
            entry.node_type.text() == Some("transfer-function")
                && transfer::volume_of(&scene, &entry.name).as_ref() == Some(&output)
        };
        let looks = nodes.iter().filter(is_drawn).cloned().collect();
        drop(scene);
        Some(FormerArray { reader, looks, output, known, gesture })
    }

    /// The edits were carried out: the widgets follow once the ranges of the other array are known.
    pub(crate) fn expect_ranges(&mut self, former: FormerArray) {
        let Some(reader) = self.node(&former.reader.name) else { return };
        if CHOICE.iter().any(|name| reader.setting(name) != former.reader.setting(name)) {
            self.former_array = Some(FormerArray { reader: reader.clone(), ..former });
        }
    }

    /// Has widgets follow the array that is drawn, unless a hand changed one of them since.
    pub(crate) fn carry_widgets(&mut self) {
        let Some(former) = self.former_array.take() else { return };
        if !self.is_as_left(&former) {
            return;
        }
        let (done, all) = self.document.history().position();
        let after = match self.known_of(&former.output).filter(|_| done == all) {
            Some(Ok(after)) => after,
            // Where an array cannot be read, the next choice may be one that can.
            None | Some(Err(_)) => return self.former_array = Some(former),
        };
        let edits: Vec<Edit> =
            former.looks.iter().flat_map(|look| edits(look, &former.known, &after)).collect();
        if edits.is_empty() {
            return;
        }
        let scalar =
            former.reader.setting("scalar").and_then(LocatedValue::text).unwrap_or("the array").to_string();
        let outcome = self.document.edit_all(format!("draw '{scalar}'"), &edits, Some(former.gesture));
        if self.check(outcome).is_some() {
            self.panels.transfer.show_all();
            self.say(format!("'{scalar}' is drawn; the widgets stand at the same shares of its range"));
        }
    }

    fn node(&self, name: &str) -> Option<&NodeEntry> {
        self.document.pipeline().nodes.iter().find(|entry| entry.name == name)
    }

    /// True if the array is chosen still, and the widgets are those of the one before.
    fn is_as_left(&self, former: &FormerArray) -> bool {
        let stands = |entry: &NodeEntry, names: &[&str]| {
            let now = self.node(&entry.name);
            now.is_some_and(|now| names.iter().all(|name| now.setting(name) == entry.setting(name)))
        };
        stands(&former.reader, &CHOICE) && former.looks.iter().all(|look| stands(look, &["widgets"]))
    }

    /// Ranges of the volume of an output; `None` while they are looked for.
    fn known_of(&self, output: &str) -> Option<Result<DataScales>> {
        let (source, found) = self.worker.shown(|shown| {
            let source = shown.distribution.asked()?.source.clone();
            Some((source, shown.distribution.answer()?.clone()))
        })?;
        (source.output == output && self.is_current(&source)).then(|| found.map(|found| found.known.clone()))
    }
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
fn edits(look: &NodeEntry, before: &DataScales, after: &DataScales) -> Vec<Edit> {
    let scales = transfer::scales(look, &transfer::S_AND_G);
    let mut edits = Vec::new();
    let mut carried_scales = scales;
    for (k, name) in ["s", "g"].into_iter().enumerate() {
        let largest = |known: &DataScales| {
            let [low, high] = known.range(&ArrayRef::Named(name)).ok()?;
            Some(low.abs().max(high.abs())).filter(|largest| *largest > 0.0)
        };
        if let (AxisScale::SymLog { linear_below }, Some(from), Some(to)) =
            (scales[k], largest(before), largest(after))
        {
            let linear_below = decimal(linear_below * to / from, 1e-4 * linear_below * to / from);
            carried_scales[k] = AxisScale::SymLog { linear_below };
            edits.push(Edit::set(&look.name, [&*format!("{name}_linear_below")], linear_below.into()));
        }
    }
    let [before, after] = [Axes { known: before, scales }, Axes { known: after, scales: carried_scales }];
    let widgets = look.setting("widgets").and_then(LocatedValue::list).unwrap_or_default();
    for (place, widget) in widgets.iter().enumerate() {
        let Some(fields) = widget.table() else { continue };
        let kind = find_setting(fields, "kind").and_then(LocatedValue::text);
        let Some(kind) = WIDGET_KINDS.iter().find(|known| Some(known.name) == kind) else { continue };
        // What is wrong with a widget is said elsewhere.
        let found =
            Parameters::survey(kind.parameters, fields, &SourceSpan::Nowhere, &["kind"], &mut |_, _| {});
        let Ok(found) = carried(&found, &before, &after) else { continue };
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
