//! The parameter `order`: the requested order of a pixel's segments.

use voltet_core::Result;
use voltet_graph::{DefaultValue, Diagnostics, Parameter, ParameterType, Parameters, SavedWork};
use voltet_optics::shading::VisibilityOrder;

/// The parameter, for the declarations of `sort` and `renderer`.
pub const ORDER: Parameter = Parameter {
    name: "order",
    parameter_type: ParameterType::Choice(&VisibilityOrder::NAMES),
    unit: "",
    default: DefaultValue::Text("exact"),
    help: "the order in which a pixel's ray segments are composited",
};

/// The order that the parameters request.
pub fn order(p: &Parameters) -> Result<VisibilityOrder> {
    p.text("order")?.parse()
}

/// Records that no order is needed; `segment_count`: of the segments that are not sorted, where it is known.
pub fn record_unsorted(notes: &mut Diagnostics, segment_count: Option<u64>) {
    let why = "one colour and no light: the picture does not depend on the order";
    notes.record_skipped("visibility order", why, segment_count.map(SavedWork::Segments));
}
