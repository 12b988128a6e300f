//! The parameters of a node as rows of a panel: what each is, what holds now, how it is to be changed. Made from the
//! declarations alone.

mod begin;
mod control;
mod typed;

pub use begin::default_value;
pub use control::{Control, Relative, Scale};
pub use typed::{rounded, to_text, typed};

use crate::Document;
use crate::path::Path;
use voltet_graph::{
    DefaultValue, Field, LocatedValue, Parameter, ParameterType, ParameterValue, Registry, VariantSchema,
};

/// A parameter as a row.
#[derive(Debug, Clone)]
pub struct Row {
    /// Path from the node's table, for [`Edit::Set`](crate::Edit::Set) and [`Edit::Unset`](crate::Edit::Unset).
    pub path: Path,
    /// Its declaration: name, unit, help, range, standard value.
    pub parameter: &'static Parameter,
    /// Control that edits it.
    pub control: Control,
    /// Value that the file sets.
    pub set_value: Option<ParameterValue>,
    /// Default value, or the reason why there is none.
    pub default: Option<ParameterValue>,
    /// The rows within it: of a table.
    pub rows: Vec<Row>,
    /// The entries of a list of tables.
    pub entries: Vec<Entry>,
}

/// An entry of a list of tables, such as a widget.
#[derive(Debug, Clone)]
pub struct Entry {
    /// Path from the node's table.
    pub path: Path,
    /// Its kind; none where the file names none that is known.
    pub kind: Option<&'static VariantSchema>,
    /// Its parameters.
    pub rows: Vec<Row>,
}

impl Row {
    /// The value that holds: stated, else the standard one.
    pub fn value(&self) -> Option<&ParameterValue> {
        self.set_value.as_ref().or(self.default.as_ref())
    }

    /// True if the value is given relative to data: texts in place of numbers.
    pub fn is_relative(&self) -> bool {
        fn has_text(datum: &ParameterValue) -> bool {
            match datum {
                ParameterValue::Text(_) => true,
                ParameterValue::List(list) => list.iter().any(|part| has_text(&part.datum)),
                ParameterValue::Boolean(_)
                | ParameterValue::Integer(_)
                | ParameterValue::Number(_)
                | ParameterValue::Table(_) => false,
            }
        }
        match &self.control {
            Control::Number { word, relative: Some(_), .. } => match self.value() {
                Some(ParameterValue::Text(text)) => Some(text.as_str()) != *word,
                _ => false,
            },
            Control::Vector { relative: Some(_), .. } | Control::Rows { relative: Some(_), .. } => {
                self.value().is_some_and(has_text)
            }
            _ => false,
        }
    }

    /// True if the file must state it, and does not.
    pub fn is_missing(&self) -> bool {
        self.set_value.is_none() && matches!(self.parameter.default, DefaultValue::Required)
    }

    /// Default value as text: "0.5", "no widgets: an empty picture", "required".
    pub fn default_text(&self) -> String {
        self.parameter.default.to_string()
    }
}

impl Document {
    /// The rows of a node: its own parameters and, where it names a gradient filter or a variant, those of the filter or the variant. Empty where its type is
    /// not known.
    pub fn rows(&self, registry: &Registry, node: &str) -> Vec<Row> {
        let entry = self.pipeline().nodes.iter().find(|entry| entry.name == node);
        let Some((entry, node)) = entry.zip(self.node_type(registry, node)) else { return Vec::new() };
        let mut rows = rows(registry, node.parameters, &entry.settings, &Path::default());
        let word = |parameter: &Parameter| match rows
            .iter()
            .find(|row| row.parameter.name == parameter.name)?
            .value()
        {
            Some(ParameterValue::Text(word)) => Some(word.clone()),
            _ => None,
        };
        let filter = node.method().and_then(word);
        let variant = node.registered_parameter().and_then(|parameter| {
            let word = word(parameter)?;
            registry.variants(parameter.name).find(|variant| variant.schema.name == word)
        });
        if let Some(variant) = variant {
            let declared = variant.schema.parameters;
            rows.extend(self::rows(registry, declared, &entry.settings, &Path::default()));
        }
        if let Some(filter) = filter.and_then(|word| registry.find_filter(&word).ok()) {
            let declared = filter.declaration().parameters;
            rows.extend(self::rows(registry, declared, &entry.settings, &Path::default()));
        }
        rows
    }
}

/// The rows of a table that states some of what is declared.
fn rows(registry: &Registry, declared: &'static [Parameter], stated: &[Field], path: &Path) -> Vec<Row> {
    let row = |parameter: &'static Parameter| {
        let setting = stated.iter().find(|field| field.name == parameter.name).map(|field| &field.setting);
        let path = path.with(parameter.name);
        let (mut inner, mut entries) = (Vec::new(), Vec::new());
        if let ParameterType::Table(declared) = parameter.parameter_type {
            inner =
                rows(registry, declared, setting.and_then(LocatedValue::table).unwrap_or_default(), &path);
        }
        if let ParameterType::Kinds(kinds) = parameter.parameter_type {
            let list = setting.and_then(LocatedValue::list).unwrap_or_default();
            entries =
                list.iter().enumerate().map(|(i, one)| entry(registry, kinds, one, path.with(i))).collect();
        }
        Row {
            path,
            parameter,
            control: Control::from_parameter(parameter, registry),
            set_value: setting.map(|setting| setting.datum.clone()),
            default: parameter.default.datum(),
            rows: inner,
            entries,
        }
    };
    declared.iter().map(row).collect()
}

fn entry(registry: &Registry, kinds: &'static [VariantSchema], setting: &LocatedValue, path: Path) -> Entry {
    let fields = setting.table().unwrap_or_default();
    let word = fields.iter().find(|field| field.name == "kind").and_then(|field| field.setting.text());
    let kind = kinds.iter().find(|kind| Some(kind.name) == word);
    let rows = kind.map(|kind| rows(registry, kind.parameters, fields, &path)).unwrap_or_default();
    Entry { path, kind, rows }
}
