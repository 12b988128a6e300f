//! The order of a pixel's segments: the parameter, and what becomes of it.

use voltet_core::Result;
use voltet_graph::{MayLeaveOut, Notes, Parameter, ParameterType, Parameters, Saving, Standard};
use voltet_optics::shading::Order;

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
    standard: Standard::Text("exact"),
    help: "the order in which a pixel's ray segments are composited",
};

/// The order that the parameters ask for; `needed`: whether it changes the picture, or is to be carried out anyway.
pub fn order(p: &Parameters, needed: bool) -> Result<Order> {
    Ok(match p.text("order")? {
        "centroid" => Order::Centroid,
        "none" => Order::None,
        // The same picture without the work.
        _ if !needed => Order::Auto,
        "auto" => Order::Auto,
        _ => Order::Exact,
    })
}

/// Notes that no order is needed; `segment_count`: of the segments that are not sorted, where it is known.
pub fn leave_out_order(notes: &mut Notes, leave: MayLeaveOut, segment_count: Option<u64>) {
    let why = "one colour and no light: the picture does not depend on the order";
    notes.leave_out(leave, "visibility order", why, segment_count.map(Saving::Segments));
}
