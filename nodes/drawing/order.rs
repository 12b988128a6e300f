//! The order of a pixel's segments: the parameter, and what becomes of it.

use voltet_core::Result;
use voltet_graph::{
    DefaultValue, MayLeaveOut, NodeDiagnostics, Parameter, ParameterType, Parameters, SavedWork,
};
use voltet_optics::shading::VisibilityOrder;

/// The parameter, for the declarations of `sort` and `renderer`.
pub const ORDER: Parameter = Parameter {
    name: "order",
    parameter_type: ParameterType::Choice(&[
        ("exact", "by entry distance at every pixel"),
        ("centroid", "by the distance of the cells' centroids: an approximation"),
        ("none", "as the cells come"),
        ("auto", "exact where the scene needs an order, none otherwise"),
    ]),
    unit: "",
    default: DefaultValue::Text("exact"),
    help: "the order in which a pixel's ray segments are composited",
};

/// The order that the parameters ask for; `needed`: whether it changes the picture, or is to be carried out anyway.
pub fn order(p: &Parameters, needed: bool) -> Result<VisibilityOrder> {
    Ok(match p.text("order")? {
        "centroid" => VisibilityOrder::Centroid,
        "none" => VisibilityOrder::None,
        // The same picture without the work.
        _ if !needed => VisibilityOrder::Auto,
        "auto" => VisibilityOrder::Auto,
        _ => VisibilityOrder::Exact,
    })
}

/// Notes that no order is needed; `segment_count`: of the segments that are not sorted, where it is known.
pub fn leave_out_order(notes: &mut NodeDiagnostics, leave: MayLeaveOut, segment_count: Option<u64>) {
    let why = "one colour and no light: the picture does not depend on the order";
    notes.record_skipped(leave, "visibility order", why, segment_count.map(SavedWork::Segments));
}
