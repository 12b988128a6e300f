//! Points at which the gradient is requested.

use super::*;
use voltet_core::transfer::{OpticalModel, TransferFunction};

fn look(unit_distance: f64) -> Arc<TransferFunctionSpec> {
    let model = OpticalModel::DensityEmitter;
    let transfer_function =
        TransferFunction { model, unit_distance, widgets: Vec::new(), axes: Default::default() };
    Arc::new(TransferFunctionSpec::new(transfer_function, false))
}

fn of(looks: Option<&[f64]>) -> Demand {
    let gradient_for = looks.map(|looks| looks.iter().map(|&look_of| look(look_of)).collect());
    Demand { gradient_magnitude: true, gradient_for, ..Demand::default() }
}

#[test]
fn places_add_up_and_who_names_none_wants_all() {
    let joined = |one: &Demand, other: &Demand| {
        let mut joined = one.clone();
        joined.join(other);
        joined
    };
    let (one, two, everywhere) = (of(Some(&[1.0])), of(Some(&[2.0])), of(None));
    assert_eq!(joined(&one, &two), of(Some(&[1.0, 2.0])));
    assert_eq!(joined(&one, &one), one);
    for (a, b) in [(&one, &everywhere), (&everywhere, &one)] {
        assert_eq!(joined(a, b), everywhere);
    }
    // Who does not look at the gradient has no say.
    for (a, b) in [(&one, &Demand::default()), (&Demand::default(), &one)] {
        assert_eq!(joined(a, b), one);
    }
}

#[test]
fn a_scalar_is_left_out_where_nobody_looks_at_it() {
    let without = Demand { without_scalar: true, ..Demand::default() };
    let mut both = without.clone();
    both.join(&Demand::default());
    assert_eq!(both, Demand::default());
    assert!(both.covers(&without) && !without.covers(&both) && without.covers(&without));
}

#[test]
fn what_is_made_in_some_places_serves_who_looks_there() {
    let (one, both, everywhere) = (of(Some(&[1.0])), of(Some(&[1.0, 2.0])), of(None));
    assert!(both.covers(&one) && everywhere.covers(&both) && one.covers(&Demand::default()));
    assert!(!one.covers(&both) && !both.covers(&everywhere) && !of(Some(&[3.0])).covers(&one));
    assert!(both.everywhere().covers(&everywhere));
}
