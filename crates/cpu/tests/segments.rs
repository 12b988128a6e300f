//! What the engine draws with against the exact values of single segments, rays, chains and tables, on every lane set.

use voltet_core::transfer::{ControlPoint, OpticalModel, Profile, TransferFunction, Wave, Widget};
use voltet_cpu::introspect::{integrate_segments, lane_sets};
use voltet_introspect::LaneEvaluator;
use voltet_judge::SegmentEvaluator;
use voltet_judge::{Case, Report, judge_cases, shipped};
use voltet_optics::shading::{Integrator, Shading};
use voltet_optics::{Segment, WidgetBlend};

/// Each value that broke its bound, and why the lanes left cases to 64 bits.
fn shown(report: &Report) -> String {
    let mut text = format!("{}\n", report.forms);
    text.extend(report.rows.iter().filter(|row| row.broken > 0).map(|row| format!("{row:?}\n")));
    for broken in &report.broken {
        text += &format!(
            "{} {}: {:e} for {:e}, {:.2} of the bound\n",
            broken.id, broken.quantity, broken.found, broken.exact, broken.ratio
        );
    }
    for exemption in &report.exemptions {
        text += &format!(
            "{} {}: {}\n",
            exemption.count,
            if exemption.wider { "wider" } else { "skipped" },
            exemption.reason
        );
    }
    text
}

fn reports(cases: &[Case], sets: &[LaneEvaluator]) -> Vec<Report> {
    let forms: Vec<&dyn SegmentEvaluator> = sets.iter().map(|set| set as &dyn SegmentEvaluator).collect();
    judge_cases(cases, &forms).expect("the engine draws")
}

#[test]
fn every_lane_set_keeps_every_bound_of_the_exact_values() {
    let cases = shipped().expect("the cases are well formed");
    let sets: Vec<LaneEvaluator> = LaneEvaluator::all().collect();
    for report in reports(&cases, &sets) {
        println!("{}", shown(&report));
        assert!(report.passed(), "\n{}", shown(&report));
        // Served by lanes, not by the 64-bit forms behind them: more would mean that these draw what lanes are for.
        let judged = report.total(|row| row.judged);
        assert!(judged >= 5000, "only {judged} values were judged\n{}", shown(&report));
        // ψ, F and B of 6 tables without extinction: what does not absorb does not glow.
        let skipped: usize = report.exemptions.iter().filter(|e| !e.wider).map(|e| e.count).sum();
        assert!(skipped <= 6, "{}", shown(&report));
    }
}

/// A vector holds segments of many cells: what becomes of one is not what its neighbours are.
#[test]
fn no_segment_depends_on_its_neighbours() {
    let widget = |profile, extinction, color| Widget { profile, color, extinction, region: None };
    let wave = Wave { origin: [0.1, 0.0], angle: 0.3, scale: [1.0; 2], period: 0.4, band_width: 0.7 };
    let gaussian = |s, k| Profile::Gaussian { centre: [s, 0.4], matrix: [[k, 0.0], [0.5, 1.2]] };
    let point = |s, extinction, r| ControlPoint { s, color: [r, 0.5, 0.1], extinction };
    let points = [point(0.1, 0.0, 1.0), point(0.5, 9.0, 0.2), point(0.9, 1.0, 0.4)].to_vec();
    let scenes = [
        vec![
            widget(gaussian(0.4, 3.0), 2.0, [1.0, 0.0, 0.2]),
            widget(gaussian(0.7, 1.0), 0.3, [0.0, 1.0, 0.5]),
        ],
        vec![
            widget(gaussian(0.4, 3.0), 2.0, [1.0, 0.0, 0.2]),
            widget(Profile::SineWave(wave), 1.0, [0.0, 1.0, 0.5]),
        ],
        vec![widget(Profile::PiecewiseLinear { points }, 0.0, [0.0; 3])],
    ];
    let (integrator, overlap) = (Integrator::ANALYTIC, WidgetBlend::Exact);
    let shading = Shading { integrator, overlap, silhouette: None, light: None };
    // Any 300 segments; the first spans what all of them do, so that lists with it are scaled alike.
    let share = |i: usize, step: f64| (0.5 + i as f64 * step).fract();
    let list: Vec<Segment> = (0..300)
        .map(|i| Segment {
            length: if i == 0 { 3.0 } else { 3.0 * share(i, 0.755).powi(4) },
            front: if i == 0 { [0.0; 2] } else { [share(i, 0.618), share(i, 0.57)] },
            back: if i == 0 { [1.0; 2] } else { [share(i, 0.41), share(i, 0.83)] },
            fields_front: &[],
            fields_back: &[],
        })
        .collect();
    for (number, widgets) in scenes.into_iter().enumerate() {
        let look = TransferFunction {
            model: OpticalModel::DensityEmitter,
            unit_distance: 1.0,
            widgets,
            axes: Default::default(),
        };
        for lanes in lane_sets() {
            let draw =
                |list: &[Segment]| integrate_segments(lanes, &look, &shading, false, list).expect("draws");
            let together = draw(&list);
            assert!(
                together.iter().any(|found| found.fallback.is_none())
                    && together[7].contribution.opacity > 0.0
            );
            for (i, found) in together.iter().enumerate() {
                let alone = draw(&[list[0], list[i]])[1];
                assert_eq!(*found, alone, "segment {i} of scene {number} on {}", lanes.name());
            }
        }
    }
}

/// The same as in a scene of several colours, where the shapes of single widgets are found, too.
#[test]
fn widgets_of_one_colour_keep_every_bound_in_order() {
    let cases = shipped().expect("the cases are well formed");
    let sets: Vec<LaneEvaluator> =
        LaneEvaluator::all().map(|set| LaneEvaluator { ordered: true, ..set }).collect();
    for report in reports(&cases, &sets) {
        assert!(report.passed(), "\n{}", shown(&report));
    }
}
