//! Ways out of an error, each a button: to the node that it is about, to another file, to the line of the text, to fewer pixels, and once more.

use crate::drawn_with::inputs_of_picture;
use crate::expression::in_expression;
use crate::fields::{REASON, texts};
use crate::scene::{Action, Command, FilePurpose, Scene, camera_of, error_text};
use crate::theme;
use crate::worker::size_of;
use eframe::egui::{Button, Label, RichText, Ui};
use std::ops::Range;
use std::path::PathBuf;
use voltet_core::Error;
use voltet_core::error::{ErrorKind, Remedy};
use voltet_core::expression::Expression;
use voltet_core::parameters::nearest;
use voltet_document::panel::{Control, Row};
use voltet_document::{Edit, Path};
use voltet_graph::{NodeEntry, ParameterValue, SourceSpan};

/// The words of a button, and what it does.
pub(crate) type WayOut = (String, Action);

/// Words of the button that tries the same once more.
pub(crate) const AGAIN: &str = "Try again";

/// Words of the button that makes pictures smaller.
pub(crate) const FEWER_PIXELS: &str = "Fewer pixels";

/// Words of the button that writes another file.
pub(crate) const ELSEWHERE: &str = "Save elsewhere …";

/// A line for the user.
#[derive(Debug, Clone)]
pub(crate) struct Message {
    pub text: String,
    pub error: Option<Error>,
    /// The command that failed by it, to be given once more.
    pub again: Option<Command>,
}

impl Message {
    /// Ways out of the error that it says.
    pub fn ways_out(&self, scene: &Scene) -> Vec<WayOut> {
        let Some(error) = &self.error else { return Vec::new() };
        let mut ways = ways_out(scene, error);
        let saves = matches!(self.again, Some(Command::Save | Command::SaveAs));
        ways.extend(saves.then(|| (ELSEWHERE.to_string(), Action::Do(Command::SaveAs))));
        let again = self.again.filter(|again| *again != Command::SaveAs);
        ways.extend(again.map(|again| (AGAIN.to_string(), Action::Do(again))));
        ways
    }
}

/// The ways out of an error that it says itself.
pub(crate) fn ways_out(scene: &Scene, error: &Error) -> Vec<WayOut> {
    let mut ways = Vec::new();
    let node = error.location.node.as_deref().filter(|node| scene.entry(node).is_some());
    match node {
        Some(node) => {
            let shows = (!scene.selection.contains(node) || scene.selection.len() > 1)
                .then(|| (format!("Show '{node}'"), Action::Select([node.to_string()].into())));
            ways.extend(shows);
            ways.extend(scene.entry(node).into_iter().flat_map(|entry| joins(scene, entry, error)));
            let rows = scene.document.rows(scene.registry, node);
            let rows = all_rows(&rows);
            let of_array = array_of(&rows, error);
            let of_arrays = of_array.map(|(row, wrong)| other_arrays(node, row, &wrong, error));
            let of_arrays = of_arrays.unwrap_or_default();
            let file = file_of(scene, node, &rows, error).filter(|_| of_arrays.is_empty());
            ways.extend(of_arrays);
            ways.extend(file.map(|(path, file, writes)| {
                let words = if writes { ELSEWHERE } else { "Choose a file …" };
                let purpose = FilePurpose::Parameter { node: node.to_string(), path, writes };
                (words.to_string(), Action::ChooseFile(purpose, Some(file)))
            }));
        }
        None => ways.extend(
            scene
                .line_of(error)
                .map(|line| (format!("Show the text at line {line}"), Action::ShowText(line))),
        ),
    }
    if is_of_pixels(error)
        && let Some((camera, size)) = node
            .or(scene.shown_node)
            .and_then(|node| camera_of(&scene.document.pipeline().nodes, node))
            .and_then(|camera| Some((camera, size_of(camera)?)))
    {
        let size = size.map(|length| i64::from((length / 2).max(1)));
        let edit = Edit::set(&camera.name, ["size"], size.map(ParameterValue::Integer).into_iter().collect());
        ways.push((FEWER_PIXELS.to_string(), Action::Edit(FEWER_PIXELS.to_lowercase(), vec![edit])));
    }
    ways
}

/// True if what failed may succeed with fewer pixels.
pub(crate) fn is_of_pixels(error: &Error) -> bool {
    error.remedy.as_deref() == Some(&Remedy::FewerPixels)
}

/// The ways out of an error of what is computed of the data by itself, which a new reading computes once more.
pub(crate) fn ways_out_of_data(scene: &Scene, error: &Error) -> Vec<WayOut> {
    let mut ways = ways_out(scene, error);
    // What a parameter has wrong is so once more.
    let is_of_file = ways.iter().any(|(_, action)| matches!(action, Action::ChooseFile(..)));
    if error.kind != ErrorKind::Usage || is_of_file || scene.is_of_other_file(error) {
        ways.push((AGAIN.into(), Action::Do(Command::ReadAgain)));
    }
    ways
}

/// Shows an error in a sheet, and buttons of ways out below it.
pub(crate) fn show_error(ui: &mut Ui, scene: &Scene, error: &Error, ways: &[WayOut]) {
    ui.add(Label::new(end_text(ui, scene, error)).wrap());
    ui.horizontal_wrapped(|ui| buttons(ui, scene, ways));
}

/// Words for the end of work in the background that has no result: in the colour of errors, unless a hand stopped it.
pub(crate) fn end_text(ui: &Ui, scene: &Scene, error: &Error) -> RichText {
    let dark = ui.visuals().dark_mode;
    let is_stopped = error.kind == ErrorKind::Cancelled;
    let color = if is_stopped { theme::weak(dark) } else { theme::wrong(dark) };
    RichText::new(why_ended(scene, error)).color(color)
}

/// Words for the end of work in the background that has no result.
pub(crate) fn why_ended(scene: &Scene, error: &Error) -> String {
    match error.kind {
        ErrorKind::Cancelled => "stopped".into(),
        _ => error_text(error, scene.document),
    }
}

/// Shows buttons, and asks for the action of the one that is clicked.
pub(crate) fn buttons(ui: &mut Ui, scene: &Scene, ways: &[WayOut]) {
    for (text, action) in ways {
        if ui.add(Button::new(text).small()).clicked() {
            scene.actions.push(action.clone());
        }
    }
}

/// Buttons that join the input which an error says is needed, as it is joined where the node's picture is drawn.
fn joins(scene: &Scene, entry: &NodeEntry, error: &Error) -> Vec<WayOut> {
    let Some(Remedy::Input(needed)) = error.remedy.as_deref() else { return Vec::new() };
    let inputs = inputs_of_picture(scene, entry).into_iter().filter(|(_, _, port)| port == needed);
    let join = |(from, output, port): (String, String, &str)| {
        let edit = scene.document.join(scene.registry, (&from, &output), (&entry.name, port)).ok()?;
        Some((format!("Join '{from}' to '{port}'"), Action::Edit(edit.label(), vec![edit])))
    };
    inputs.filter_map(join).collect()
}

/// Rows and all that is within them.
fn all_rows(rows: &[Row]) -> Vec<&Row> {
    let within = rows.iter().flat_map(|row| row.entries.iter().map(|entry| &entry.rows).chain([&row.rows]));
    rows.iter().chain(within.flat_map(|inner| all_rows(inner))).collect()
}

/// Most buttons for arrays of which none is near to the one that is named.
const MAX_ARRAYS: usize = 3;

/// The parameter that names an array which an error says is not as it has to be; and that name.
fn array_of<'a>(rows: &[&'a Row], error: &Error) -> Option<(&'a Row, String)> {
    let is_meant = |name: &String| !name.is_empty() && error.what.contains(&format!("'{name}'"));
    rows.iter().find_map(|row| array_names(row).into_iter().find(is_meant).map(|name| (*row, name)))
}

/// Names of arrays that the value of a parameter has.
fn array_names(row: &Row) -> Vec<String> {
    let named = row.set_value.as_ref().map(texts).unwrap_or_default();
    match row.control {
        Control::Array | Control::Arrays => named,
        Control::Expression => {
            let parsed = named.iter().filter_map(|text| Expression::parse(text).ok());
            parsed.flat_map(|expression| expression.arrays.into_iter().map(|array| array.name)).collect()
        }
        _ => Vec::new(),
    }
}

/// The value of a parameter with another array in the place of one.
fn with_array(row: &Row, wrong: &str, name: &str) -> ParameterValue {
    let named = row.set_value.as_ref().map(texts).unwrap_or_default();
    match row.control {
        Control::Expression => {
            let mut text = named.into_iter().next().unwrap_or_default();
            let place = |text: &str| {
                let arrays = Expression::parse(text).ok()?.arrays;
                arrays.into_iter().find(|array| array.name == wrong).map(|array| array.span)
            };
            // An expression names an array as often as it likes, at most at each character.
            for _ in 0..text.len() {
                let Some(span) = place(&text) else { break };
                text.replace_range(span, &in_expression(name));
            }
            text.into()
        }
        Control::Arrays => named.iter().map(|known| if known == wrong { name } else { known }).collect(),
        _ => name.into(),
    }
}

/// Buttons that name one of the arrays which an error says are there: the nearest, or the first ones.
fn other_arrays(node: &str, row: &Row, wrong: &str, error: &Error) -> Vec<WayOut> {
    let Some(Remedy::Names(there)) = error.remedy.as_deref() else { return Vec::new() };
    let stem = wrong.rsplit_once(':').map_or(wrong, |(stem, _)| stem);
    let near = nearest(stem, there.iter().map(String::as_str));
    let offered =
        near.map_or_else(|| there.iter().map(String::as_str).take(MAX_ARRAYS).collect(), |near| vec![near]);
    let way = |name: &str| {
        let value = with_array(row, wrong, name);
        let edit = Edit::Set { node: node.to_string(), path: row.path.clone(), value };
        (format!("Use '{name}'"), Action::Edit(edit.label(), vec![edit]))
    };
    offered.into_iter().map(way).collect()
}

/// Why there is no picture, where that is because of the value of a parameter.
pub(crate) struct RowFailure {
    path: Path,
    text: String,
    ways: Vec<WayOut>,
}

impl RowFailure {
    /// Finds it among the parameters of a node.
    pub fn find(scene: &Scene, node: &str, rows: &[Row]) -> Option<Self> {
        let error = scene.failure.as_ref().filter(|error| error.location.node.as_deref() == Some(node))?;
        if scene.faults.iter().any(|fault| fault.what == error.what) {
            return None;
        }
        let rows = all_rows(rows);
        let (path, ways) = match array_of(&rows, error) {
            Some((row, wrong)) => (row.path.clone(), other_arrays(node, row, &wrong, error)),
            None => (file_of(scene, node, &rows, error)?.0, Vec::new()),
        };
        Some(RowFailure { path, text: error_text(error, scene.document), ways })
    }

    /// Says it below the value of that parameter.
    pub fn say(&self, ui: &mut Ui, scene: &Scene, path: &Path) {
        if self.path == *path {
            ui.set_max_width(REASON);
            let text = RichText::new(&self.text).small();
            ui.add(Label::new(text.color(theme::wrong(ui.visuals().dark_mode))).wrap());
            ui.horizontal_wrapped(|ui| buttons(ui, scene, &self.ways));
        }
    }
}

/// The parameter of a node that names the file that an error is about; `path`, where the error is of that parameter or of another file, as
/// one of a series. With that file, and true if it is written.
fn file_of(scene: &Scene, node: &str, rows: &[&Row], error: &Error) -> Option<(Path, PathBuf, bool)> {
    let file = |row: &&Row| {
        let Some(ParameterValue::Text(text)) = &row.set_value else { return None };
        let writes = matches!(row.control, Control::OutputFile);
        let is_file = writes || row.parameter.parameter_type.is_input_path(text);
        is_file.then(|| (row.path.clone(), scene.document.folder().join(text), writes))
    };
    let mut files = rows.iter().filter_map(file).collect::<Vec<_>>();
    let named = error.location.file.as_deref();
    let is_named = |(_, file, _): &(Path, PathBuf, bool)| named == Some(&*file.to_string_lossy());
    let place = files.iter().position(is_named);
    let stands = |span: &Range<usize>| {
        let path = scene.entry(node).and_then(|entry| entry.setting("path"));
        path.is_some_and(|path| matches!(&path.origin, SourceSpan::Span(all) if all.start <= span.start && span.end <= all.end))
    };
    let is_of_path = scene.is_of_other_file(error)
        || match (&error.location.item, &error.location.span) {
            (Some(item), _) => item == "path",
            (None, Some(span)) => stands(span),
            (None, None) => true,
        };
    let usual = || files.iter().position(|(path, ..)| *path == "path".into()).filter(|_| is_of_path);
    let place = place.or_else(usual);
    place.map(|place| files.swap_remove(place))
}
