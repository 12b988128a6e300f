//! `report-writer`: figures to a file, or to the standard output.

use crate::files::{self, BY_ENDING, FORMAT, PATH};
use serde_json::Value;
use voltet_core::{Error, Result};
use voltet_graph::{Node, Outputs, Parameter, ParameterType, Parameters, Port, PortType, RunContext};

const JSON: &str = "json";
const CSV: &str = "csv";

pub const NODE: Node = Node {
    name: "report-writer",
    summary: "Writes figures: .json with all there is, .csv with the table alone.",
    inputs: &[Port { name: "report", port_type: PortType::Report, summary: "the figures" }],
    parameters: &[
        PATH,
        Parameter {
            parameter_type: ParameterType::Choice(&[
                (
                    BY_ENDING,
                    "what the path ends in, .json or .csv; json on the standard output and on devices",
                ),
                (JSON, "everything"),
                (CSV, "the figures' table (its keys columns and rows)"),
            ]),
            help: "how the figures are written",
            ..FORMAT
        },
    ],
    example: include_str!("examples/histogram.toml"),
    check: &|parameters| is_csv(parameters).map(drop),
    prepare: &files::prepare,
    run: &run,
    ..Node::BLANK
};

fn run(call: &mut RunContext) -> Result<Outputs> {
    let report = call.report("report")?;
    let content = if is_csv(call.parameters)? { csv(&report)? } else { format!("{report}\n") };
    files::write(call, content.as_bytes())?;
    Ok(Vec::new())
}

fn is_csv(parameters: &Parameters) -> Result<bool> {
    Ok(files::format(parameters, "the format of the figures", &[JSON, CSV])? == 1)
}

/// The table of figures: a head line and a line for each row.
fn csv(report: &str) -> Result<String> {
    let figures: Value = serde_json::from_str(report)
        .map_err(|error| Error::run("the figures are not valid JSON").got(error))?;
    let (Some(columns), Some(rows)) = (figures["columns"].as_array(), figures["rows"].as_array()) else {
        let error = Error::usage("these figures have no table").got("no keys 'columns' and 'rows'");
        return Err(error.expected("a path that ends in .json"));
    };
    let cell = |value: &Value| match value.as_str() {
        Some(text) if text.contains([',', '"', '\n', '\r']) => format!("\"{}\"", text.replace('"', "\"\"")),
        Some(text) => text.to_string(),
        None if value.is_null() => String::new(),
        None => value.to_string(),
    };
    let line = |values: &[Value]| values.iter().map(cell).collect::<Vec<_>>().join(",") + "\n";
    let rows = rows.iter().map(|row| line(row.as_array().map_or(&[], Vec::as_slice)));
    Ok(line(columns) + &rows.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_becomes_lines_and_text_is_quoted_where_it_must_be() {
        let text = csv(r#"{"columns": ["s", "a \"b\", c"], "rows": [[1.5, null], [-2e-7, "x"]]}"#).unwrap();
        assert_eq!(text, "s,\"a \"\"b\"\", c\"\n1.5,\n-2e-7,x\n");
        assert!(csv("{}").unwrap_err().to_string().contains("no table"));
    }
}
