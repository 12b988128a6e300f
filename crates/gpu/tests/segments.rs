//! Complete composed shaders on a device against the exact values of single segments, rays, chains and tables.

use std::sync::Arc;
use voltet_gpu::Device;
use voltet_introspect::WgslEvaluator;
use voltet_judge::{Report, judge_cases, shipped};

fn table(report: &Report) -> String {
    let mut text: String = report.rows.iter().map(|row| format!("{row:?}\n")).collect();
    for broken in &report.broken {
        text += &format!(
            "{} {}: {:e} for {:e}, {:.2} of the bound\n",
            broken.id, broken.quantity, broken.found, broken.exact, broken.ratio
        );
    }
    text + &format!("{:?}\n", report.exemptions)
}

#[test]
fn composed_shaders_keep_every_bound_of_the_exact_values() {
    let device = match Device::open(std::env::var("VOLTET_ADAPTER").ok().as_deref(), false) {
        Ok(device) => Arc::new(device),
        Err(why) => {
            voltet_testing::skipped_without_device(why);
            return;
        }
    };
    // One in five in a short series, among them every kind.
    let stride = if voltet_testing::whole_series() { 1 } else { 5 };
    let cases: Vec<_> = shipped().expect("the cases are well formed").into_iter().step_by(stride).collect();
    let forms = WgslEvaluator::new(device.clone());
    let report = judge_cases(&cases, &[&forms]).expect("the device draws").remove(0);
    println!("{}{} shaders", table(&report), device.work().shader_builds);
    assert!(report.passed(), "\n{}", table(&report));
    let judged = report.total(|row| row.judged);
    assert!(judged > 6000 / stride, "only {judged} values were judged");
    // Refused are 81 cases that span over 100,000 widths of a Gaussian, have more bands than 32 bits tell apart, are too dense
    // for an order or too steep between two colours; 7 leave the range of 32 bits.
    let skipped: usize = report.exemptions.iter().map(|exemption| exemption.count).sum();
    assert!(skipped <= 88, "{:?}", report.exemptions);
}
