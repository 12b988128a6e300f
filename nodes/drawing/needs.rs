//! Demand of a scene on its data.

use super::engines::NATIVE;
use super::shading::shading;
use voltet_core::Result;
use voltet_core::transfer::TransferFunction;
use voltet_cpu::needs_gradient;
use voltet_graph::{Demand, DemandContext, Parameters, TransferFunctionSpec};
use voltet_optics::engine::EngineInfo;
use voltet_optics::integrators::{INTEGRATOR, Integrator, kinds};
use voltet_optics::scene::needs_order;
use voltet_optics::shading::Shading;

/// Asks at `port` for what drawing the transfer function at `look_port` with the node's parameters needs; gives what
/// was asked for.
pub fn ask(asking: &mut DemandContext, port: &str, look_port: &str) -> Result<Demand> {
    let (look, shading) = (asking.look(look_port), shading(asking.parameters)?);
    if let Some(look) = &look {
        // Refused before any data are read.
        check_engine(&NATIVE, asking.parameters, &look.transfer_function, &shading)?;
    }
    let mut demand = demand(look.as_deref(), &shading);
    // A table spans the range of g.
    if !shading.integrator.has_table() {
        demand.gradient_for = asking.known_look(look_port).map(|look| vec![look]);
    }
    asking.ask(port, &demand)?;
    Ok(demand)
}

/// Checks, without any data, that an engine can draw the transfer function with this shading.
///
/// Errors: those of [`EngineInfo::can_serve`], with the integrators by which it could.
pub fn check_engine(
    engine: &EngineInfo,
    parameters: &Parameters,
    transfer_function: &TransferFunction,
    shading: &Shading,
) -> Result<()> {
    let check = |integrator| engine.can_serve(transfer_function, &Shading { integrator, ..*shading });
    check(shading.integrator).map_err(|mut error| {
        let kinds = kinds(parameters.variants(INTEGRATOR)).into_iter();
        let others: Vec<&str> = kinds
            .filter(|kind| check(Integrator::new(*kind)).is_ok())
            .map(|kind| kind.schema().name)
            .collect();
        if !others.is_empty() {
            let accepted = error.expected.take().map_or(String::new(), |accepted| format!("{accepted}, or "));
            error = error.expected(format!("{accepted}one of the integrators {}", others.join(", ")));
        }
        parameters.locate(INTEGRATOR, error)
    })
}

fn demand(look: Option<&TransferFunctionSpec>, shading: &Shading) -> Demand {
    let gradient = needs_gradient(shading);
    let known = match look {
        None => Demand::unknown(),
        Some(look) => {
            let transfer_function = &look.transfer_function;
            Demand {
                arrays: transfer_function.fields().iter().map(|name| name.to_string()).collect(),
                gradient_magnitude: transfer_function.uses_gradient_magnitude(),
                gradient: false,
                order: needs_order(transfer_function, shading),
                ..Demand::default()
            }
        }
    };
    Demand { gradient, ..known }
}

#[cfg(test)]
mod tests {
    use super::*;
    use voltet_core::transfer::OpticalModel;
    use voltet_core::transfer::{ControlPoint, Profile, Widget};
    use voltet_optics::WidgetBlend;
    use voltet_optics::shading::Light;

    fn widget(color: [f64; 3], extinction: f64) -> Widget {
        let profile = Profile::Gaussian { centre: [0.0; 2], matrix: [[1.0, 0.0], [0.0, 0.0]] };
        Widget { profile, color, extinction, region: None }
    }

    fn look(widgets: Vec<Widget>) -> TransferFunctionSpec {
        let model = OpticalModel::DensityEmitter;
        let transfer_function = TransferFunction { model, unit_distance: 1.0, widgets };
        TransferFunctionSpec { transfer_function, auto_unit_distance: false }
    }

    fn shading(diffuse: Option<f64>, silhouette: Option<f64>) -> Shading {
        let direction = glam::DVec3::X;
        let light = diffuse.map(|diffuse| Light { direction, ambient: 0.3, diffuse });
        Shading { integrator: Integrator::ANALYTIC, overlap: WidgetBlend::Exact, silhouette, light }
    }

    #[test]
    fn one_colour_needs_no_order_unless_it_is_lit_or_glows_evenly() {
        let red = [1.0, 0.0, 0.0];
        let one = look(vec![widget(red, 1.0), widget(red, 2.0), widget([0.0; 3], 0.0)]);
        assert!(!demand(Some(&one), &shading(None, Some(2.0))).order);
        assert!(demand(Some(&one), &shading(Some(0.5), None)).order);
        assert!(
            demand(Some(&look(vec![widget(red, 1.0), widget([0.0; 3], 1.0)])), &shading(None, None)).order
        );
        let mut even = one.clone();
        even.transfer_function.model = OpticalModel::ConstantEmitter { cutoff: 0.1 };
        assert!(demand(Some(&even), &shading(None, None)).order);
        let point = |s: f64, color| ControlPoint { s, color, extinction: 1.0 };
        let profile = Profile::PiecewiseLinear { points: vec![point(0.0, red), point(1.0, [0.5, 0.0, 0.0])] };
        let ramp = Widget { profile, ..widget(red, 1.0) };
        assert!(demand(Some(&look(vec![ramp])), &shading(None, None)).order);
    }

    #[test]
    fn gradients_are_asked_for_where_something_looks_at_them() {
        let scalar_only = look(vec![widget([1.0; 3], 1.0)]);
        assert_eq!(demand(Some(&scalar_only), &shading(None, Some(0.0))), Demand::default());
        let lit = demand(Some(&scalar_only), &shading(Some(0.0), None));
        assert!(lit.gradient && !lit.gradient_magnitude);
        assert!(demand(Some(&scalar_only), &shading(None, Some(1.0))).gradient);
        let unknown = demand(None, &shading(None, None));
        assert!(unknown.gradient_magnitude && unknown.order && !unknown.gradient);
    }
}
