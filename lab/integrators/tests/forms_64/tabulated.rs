//! Widgets' integrals from tables against the closed forms.

use super::*;
use std::f64::consts::FRAC_1_SQRT_2;

fn gaussian(sigma: f64, extinction: f64, color: [f64; 3]) -> Widget {
    let profile =
        Profile::Gaussian { centre: [0.5, 0.0], matrix: [[FRAC_1_SQRT_2 / sigma, 0.0], [0.0, 0.0]] };
    Widget { profile, color, extinction, region: None }
}

fn look(model: OpticalModel, widgets: Vec<Widget>) -> TransferFunction {
    TransferFunction { model, unit_distance: 1.0, widgets, axes: Default::default() }
}

/// The largest error of (C, A) on paths all over the range, against the closed forms mixed alike.
fn largest(transfer_function: &TransferFunction, table_size: usize) -> f64 {
    let tabled = Tabulated::new(transfer_function, table_size).expect("serves");
    let exact = Analytic::new(transfer_function, WidgetBlend::Mix).expect("valid");
    let paths = (0..29).flat_map(|i| (0..29).map(move |j| [i, j].map(|k| (f64::from(k) + 0.4) / 29.0)));
    paths.fold(0.0_f64, |worst, [front, back]| {
        let segment = Segment { front: [front, 0.6], back: [back, 0.9], ..ACROSS };
        worst.max(largest_error(&exact.integrate(&segment), &tabled.integrate(&segment)))
    })
}

/// Kniss et al. 2003, section 5.2.1: 128² numbers of 16 bits over [−10, 10]² are sufficient. They are to a step of 8 bits.
#[test]
fn a_table_of_128_a_side_is_right_to_a_step_of_8_bits() {
    let two = vec![gaussian(0.08, 2.0, [1.0, 0.5, 0.2]), gaussian(0.2, 1.0, [0.0, 0.4, 1.0])];
    let transfer_function = look(OpticalModel::DensityEmitter, two);
    let errors = [33, 65, 129, 257].map(|side| largest(&transfer_function, side));
    println!("{errors:?}");
    assert!(errors[2] < 1.0 / 255.0, "{errors:?}");
    // Bilinear: of second order, until 16 bits are left.
    assert!(errors[0] > 3.0 * errors[1] && errors[1] > 3.0 * errors[2], "{errors:?}");
}

/// Beyond the domain the table's ends hold on: over a path of 60 widths the mean is taken for that over 20.
#[test]
fn a_gaussian_much_narrower_than_a_cell_is_three_times_too_dense() {
    let narrow = look(OpticalModel::DensityEmitter, vec![gaussian(FRAC_1_SQRT_2 / 60.0, 0.1, [1.0; 3])]);
    let across = Segment { front: [0.0, 0.0], back: [1.0, 0.0], ..ACROSS };
    let depth = |integrator: &dyn SegmentIntegrator| integrator.integrate(&across).optical_depth;
    let exact = depth(&Analytic::new(&narrow, WidgetBlend::Exact).expect("valid"));
    let ratio = depth(&Tabulated::new(&narrow, 257).expect("serves")) / exact;
    // 16 bits of a mean of 0.09.
    assert!((ratio - 3.0).abs() < 1e-3, "{ratio}");
}

/// The mean gradient magnitude in place of the linear one, as `crates/optics/kinds/triangular_gaussian.rs` measures it.
#[test]
fn a_triangular_gaussian_takes_one_width_for_all_of_a_segment() {
    let profile = Profile::TriangularGaussian { centre: 0.5, sigma: 0.4 };
    let widget = Widget { profile, color: [1.0; 3], extinction: 1.0, region: None };
    let transfer_function = look(OpticalModel::DensityEmitter, vec![widget]);
    let error = |g: f64| {
        let segment = Segment { length: 1.0, front: [0.1, g], back: [0.9, 1.0], ..ACROSS };
        let depth = |integrator: &dyn SegmentIntegrator| integrator.integrate(&segment).optical_depth;
        let exact = depth(&Analytic::new(&transfer_function, WidgetBlend::Exact).expect("valid"));
        (depth(&Tabulated::new(&transfer_function, 513).expect("serves")) - exact).abs()
    };
    assert!(error(1.0) < 1e-4, "equal ends: {}", error(1.0));
    assert!(error(0.1) > 5e-3, "{}", error(0.1));
}

/// Song et al. 2009, section 4.2: the table of light converges where P is under 40 and the path long.
#[test]
fn the_table_of_light_converges() {
    for cutoff in [0.3, 1e-6] {
        let widgets = vec![gaussian(0.1, 0.8, [0.6; 3])];
        let transfer_function = look(OpticalModel::ConstantEmitter { cutoff }, widgets);
        let errors = [65, 129, 257, 513].map(|side| largest(&transfer_function, side));
        println!("{cutoff}: {errors:?}");
        // Bilinear: of second order, until the bounds of what is possible take over.
        assert!(errors.windows(2).all(|pair| pair[0] > 2.5 * pair[1]), "{errors:?}");
        assert!(errors[3] < 0.5 / 255.0, "{errors:?}");
    }
}
