//! What a node type declares: ports, parameters, an example. Command-line help, the checker, editor panels and
//! the reference of nodes are made from this alone.

use super::call::{Asking, Call, Outputs, Preparation};
use super::parameters::Parameters;
use super::value::Value;
use crate::Result;

/// See [`Node::outline`].
pub type Outline = dyn Fn(&Parameters, &[Option<Value>]) -> Result<Outputs> + Send + Sync;

/// A node type: its declaration and the functions that work for it. A constant for the nodes that ship; a plug-in
/// leaks its own (`Box::leak`), since node types live as long as the program.
pub struct Node {
    /// The name that a pipeline file gives as `type`.
    pub name: &'static str,
    /// What it does, one sentence.
    pub summary: &'static str,
    /// What it takes; each input is fed by one output.
    pub inputs: &'static [Port],
    /// What it takes besides: each of these may be left out, or be fed by one output or by a list of them.
    pub optional_inputs: &'static [Port],
    /// What it gives; a node without outputs is a sink, and the run is made for the sinks.
    pub outputs: &'static [Port],
    /// Its parameters, in the order in which help lists them.
    pub parameters: &'static [Parameter],
    /// A pipeline file that uses it; must pass the checker.
    pub example: &'static str,
    /// True for cheap nodes without data (a camera, a transfer function): they run before the demand pass, which
    /// can then look at their values.
    pub early: bool,
    /// What its outputs will be made of, as far as the demand pass asks for it before any data is known: values that
    /// stand for the outputs, given what stands for the inputs (`None`: not known). Nothing at all where it cannot be
    /// said. Must ask for no less than the true outputs will.
    pub outline: &'static Outline,
    /// Checks what single declarations cannot say (parameters that exclude each other). Touches no file.
    pub check: &'static (dyn Fn(&Parameters) -> Result<()> + Send + Sync),
    /// Says what is needed of the inputs for what is asked of the node.
    pub demand: &'static (dyn Fn(&mut Asking) -> Result<()> + Send + Sync),
    /// Finds out before any long work whether the run can succeed (files exist, folders can be written).
    pub prepare: &'static (dyn Fn(&Preparation) -> Result<()> + Send + Sync),
    /// Does the work: one value for each output, in their order.
    pub run: &'static (dyn Fn(&mut Call) -> Result<Outputs> + Send + Sync),
}

impl Node {
    /// A node with nothing declared, for `..Node::BLANK`: nothing to check or prepare, every demand passed on to
    /// every input.
    pub const BLANK: Node = Node {
        name: "",
        summary: "",
        inputs: &[],
        optional_inputs: &[],
        outputs: &[],
        parameters: &[],
        example: "",
        early: false,
        outline: &|_, _| Ok(Vec::new()),
        check: &|_| Ok(()),
        demand: &|asking| asking.pass_on(),
        prepare: &|_| Ok(()),
        run: &|_| Ok(Vec::new()),
    };

    /// The inputs that must be fed, then the optional ones.
    pub fn all_inputs(&self) -> impl Iterator<Item = &'static Port> + Clone {
        self.inputs.iter().chain(self.optional_inputs)
    }

    /// The parameter of that name.
    pub fn parameter(&self, name: &str) -> Option<&'static Parameter> {
        self.parameters.iter().find(|p| p.name == name)
    }
}

impl std::fmt::Debug for Node {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Node").field("name", &self.name).finish_non_exhaustive()
    }
}

/// An input or an output of a node.
#[derive(Debug, Clone, Copy)]
pub struct Port {
    /// Its name.
    pub name: &'static str,
    /// What runs through it.
    pub port_type: PortType,
    /// One sentence.
    pub summary: &'static str,
}

/// What runs through a port.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PortType {
    /// Points, tetrahedra, arrays.
    Grid,
    /// A grid with its scalar and, where asked for, the gradient.
    Volume,
    /// Widgets and an optical model.
    TransferFunction,
    /// Where the picture is seen from.
    Camera,
    /// Cells that can contribute.
    Cells,
    /// Cells projected to the picture.
    Projection,
    /// A picture: premultiplied linear colour and opacity.
    Image,
    /// Figures about a run.
    Report,
}

impl PortType {
    /// The name in help and messages.
    pub fn name(self) -> &'static str {
        match self {
            PortType::Grid => "grid",
            PortType::Volume => "volume",
            PortType::TransferFunction => "transfer-function",
            PortType::Camera => "camera",
            PortType::Cells => "cells",
            PortType::Projection => "projection",
            PortType::Image => "image",
            PortType::Report => "report",
        }
    }

    /// The name with its article, for messages.
    pub fn with_article(self) -> String {
        let article = if self == PortType::Image { "an" } else { "a" };
        format!("{article} {}", self.name())
    }

    /// Whether an output of this type can be wired to an input of type `input`. A grid serves as a volume without
    /// gradient.
    pub fn serves(self, input: PortType) -> bool {
        self == input || (self == PortType::Grid && input == PortType::Volume)
    }
}

/// A parameter of a node, or of a table within one.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// The key in a pipeline file.
    pub name: &'static str,
    /// What it may be.
    pub parameter_type: ParameterType,
    /// Its unit, empty where it has none.
    pub unit: &'static str,
    /// What holds when the file does not say.
    pub standard: Standard,
    /// One line of help.
    pub help: &'static str,
}

/// What holds when the file does not give a parameter.
#[derive(Debug, Clone, Copy)]
pub enum Standard {
    /// The file must give it.
    Required,
    /// Nothing; the text says what that means.
    Unset(&'static str),
    /// A flag.
    Boolean(bool),
    /// A whole number.
    Integer(i64),
    /// A number.
    Number(f64),
    /// A word or text.
    Text(&'static str),
    /// A vector.
    Numbers(&'static [f64]),
    /// A vector of whole numbers.
    Integers(&'static [i64]),
}

/// What a parameter may be.
#[derive(Debug, Clone, Copy)]
pub enum ParameterType {
    /// `true` or `false`.
    Boolean,
    /// A whole number within the range.
    Integer(Range),
    /// A number within the range.
    Number(Range),
    /// A number within the range, or the word.
    NumberOr(Range, &'static str),
    /// Any text.
    Text,
    /// One of the words; each with its meaning.
    Choice(&'static [(&'static str, &'static str)]),
    /// A file to read, relative to the pipeline file.
    InputPath,
    /// A file to write, relative to the pipeline file.
    OutputPath,
    /// Several numbers, each within the range; `Some(n)`: exactly n of them.
    Numbers(Option<usize>, Range),
    /// Exactly n whole numbers, each within the range.
    Integers(usize, Range),
    /// Rows of numbers; `Some(n)`: exactly n in each row.
    Rows(Option<usize>),
    /// Several texts.
    Texts,
    /// A table with these keys.
    Table(&'static [Parameter]),
    /// A list of tables, each of a kind that its key `kind` names.
    Kinds(&'static [Kind]),
}

/// A kind of table in a [`ParameterType::Kinds`] list.
#[derive(Debug, Clone, Copy)]
pub struct Kind {
    /// The word for `kind`.
    pub name: &'static str,
    /// What it is, one sentence.
    pub summary: &'static str,
    /// Its keys beside `kind`.
    pub parameters: &'static [Parameter],
}

/// The range of a number. Numbers are finite unless the range says otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// Whether `min` itself is excluded.
    pub above_min: bool,
    /// Whether `max` itself is excluded.
    pub below_max: bool,
    /// Whether infinite values are allowed.
    pub infinite: bool,
}

impl Range {
    /// Any finite number.
    pub const ANY: Range = Range {
        min: f64::NEG_INFINITY,
        max: f64::INFINITY,
        above_min: false,
        below_max: false,
        infinite: false,
    };
    /// Any number, infinite ones too.
    pub const ANY_OR_INFINITE: Range = Range { infinite: true, ..Range::ANY };

    /// `min` or more.
    pub const fn at_least(min: f64) -> Range {
        Range { min, ..Range::ANY }
    }

    /// More than `min`.
    pub const fn above(min: f64) -> Range {
        Range { min, above_min: true, ..Range::ANY }
    }

    /// From `min` to `max`, both included.
    pub const fn within(min: f64, max: f64) -> Range {
        Range { min, max, ..Range::ANY }
    }

    /// Between `min` and `max`, both excluded.
    pub const fn between(min: f64, max: f64) -> Range {
        Range { min, max, above_min: true, below_max: true, infinite: false }
    }

    /// Whether `x` lies in the range; NaN never does.
    pub fn holds(&self, x: f64) -> bool {
        (x.is_finite() || (self.infinite && x.is_infinite()))
            && (x > self.min || (x == self.min && !self.above_min))
            && (x < self.max || (x == self.max && !self.below_max))
    }
}

impl std::fmt::Display for Range {
    /// "above 0", "0 or more", "from 0 to 1", "between 0 and 180", or nothing.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Range { min, max, above_min, below_max, infinite } = *self;
        match (min.is_finite(), max.is_finite()) {
            (false, false) => Ok(()),
            (true, false) if above_min => write!(f, "above {min}"),
            (true, false) => write!(f, "{min} or more"),
            (false, true) if below_max => write!(f, "below {max}"),
            (false, true) => write!(f, "{max} or less"),
            (true, true) if above_min && below_max => write!(f, "between {min} and {max}"),
            (true, true) if above_min => write!(f, "above {min}, up to {max}"),
            (true, true) if below_max => write!(f, "from {min} to below {max}"),
            (true, true) => write!(f, "from {min} to {max}"),
        }?;
        if infinite && (min.is_finite() || max.is_finite()) {
            f.write_str(", or inf")?;
        }
        Ok(())
    }
}

impl ParameterType {
    /// The type in words, with its range: "number above 0", "3 numbers", "exact | centroid | none | auto".
    pub fn describe(&self) -> String {
        let ranged = |noun: &str, range: &Range| {
            let range = range.to_string();
            if range.is_empty() { noun.to_string() } else { format!("{noun} {range}") }
        };
        match self {
            ParameterType::Boolean => "true | false".into(),
            ParameterType::Integer(range) => ranged("whole number", range),
            ParameterType::Number(range) => ranged("number", range),
            ParameterType::NumberOr(range, word) => format!("{} or \"{word}\"", ranged("number", range)),
            ParameterType::Text => "text".into(),
            ParameterType::Choice(words) => words.iter().map(|w| w.0).collect::<Vec<_>>().join(" | "),
            ParameterType::InputPath | ParameterType::OutputPath => "path".into(),
            ParameterType::Numbers(Some(n), range) => ranged(&format!("{n} numbers"), range),
            ParameterType::Numbers(None, range) => ranged("list of numbers", range),
            ParameterType::Integers(n, range) => ranged(&format!("{n} whole numbers"), range),
            ParameterType::Rows(Some(n)) => format!("list of rows of {n} numbers"),
            ParameterType::Rows(None) => "list of rows of numbers".into(),
            ParameterType::Texts => "list of texts".into(),
            ParameterType::Table(fields) => {
                format!("table of {}", fields.iter().map(|p| p.name).collect::<Vec<_>>().join(", "))
            }
            ParameterType::Kinds(_) => "list of tables, each with a kind".into(),
        }
    }
}

impl std::fmt::Display for Standard {
    /// As a pipeline file would write it; "required" or the meaning of leaving it out otherwise.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Standard::Required => f.write_str("required"),
            Standard::Unset(meaning) => f.write_str(meaning),
            other => match other.datum() {
                Some(datum) => write!(f, "{datum}"),
                None => Ok(()),
            },
        }
    }
}
