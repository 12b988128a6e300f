//! S. Roettger, T. Ertl, "A two-step approach for interactive pre-integrated volume rendering of unstructured grids", 2002.

use super::bench::Bench;
use super::cylinder;
use super::frame_buffer::{Lookup, interleaved};
use super::moreland::verdict;
use super::options::Paper;
use super::page::{Section, number};
use super::plane::square;
use super::song::span;
use std::time::Instant;
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_integrators::Ramp;
use voltet_optics::integrators::Extent;
use voltet_optics::special::mean_transmittance;

/// Table 1: steps, RMS and largest error in % with 12 and with 8 bits a channel.
const TABLE_1: [(usize, [f64; 2], Option<[f64; 2]>); 6] = [
    (32, [0.1348, 13.9828], Some([1.1050, 18.5028])),
    (64, [0.1515, 13.9661], Some([2.0477, 27.3640])),
    (128, [0.2445, 13.8732], Some([3.4929, 43.9580])),
    (256, [0.4565, 14.4455], Some([5.0901, 70.5962])),
    (512, [0.9102, 19.8741], None),
    (1024, [1.8131, 24.0693], None),
];

/// Table 2: the side, seconds in software and by hardware, and the speed-up.
const TABLE_2: [(usize, [f64; 3]); 3] =
    [(64, [13.499, 0.188, 71.80]), (128, [216.204, 2.859, 75.62]), (256, [3413.444, 35.550, 96.01])];

/// Places a side of the net that Table 1 is evaluated on.
const NET: usize = 33;

pub(super) fn section(bench: &mut Bench) -> Result<Section> {
    let title = "Roettger and Ertl 2002: pre-integration in two steps";
    let mut section = Section::new(Paper::RoettgerErtl, title);
    section.say(
        "The transfer function of the paper's Figures 4 and 5 is not printed as numbers; eight interleaved regions of orange and blue \
         with constant opacity, as its Figures 9 to 11 have them, stand in for it throughout. Graphics hardware of 2002 is imitated: \
         every blended number is rounded to the bits of a channel.",
    );
    table_1(&mut section);
    frame_buffers(&mut section)?;
    oversampling(&mut section);
    table_2(bench, &mut section)?;
    cylinder::pictures(bench, &mut section)?;
    Ok(section)
}

fn table_1(section: &mut Section) {
    section.part("Table 1: accuracy of blending in few bits, in % of full scale");
    let percent = |[rms, most]: [f64; 2]| [100.0 * rms, 100.0 * most];
    let mut rows = Vec::new();
    let mut found = Vec::new();
    for (steps, twelve, eight) in TABLE_1 {
        let lookup = Lookup::new(steps, interleaved);
        let here = [12, 8].map(|bits| percent(lookup.of_hardware(bits, NET)));
        found.push(here);
        let shown = |value: Option<f64>| value.map_or("–".into(), number);
        rows.push([
            steps.to_string(),
            number(twelve[0]),
            number(here[0][0]),
            number(twelve[1]),
            number(here[0][1]),
            shown(eight.map(|e| e[0])),
            number(here[1][0]),
            shown(eight.map(|e| e[1])),
            number(here[1][1]),
        ]);
    }
    section.table(
        [
            "steps",
            "12 bits, rms: printed",
            "here",
            "largest: printed",
            "here",
            "8 bits, rms: printed",
            "here",
            "largest: printed",
            "here",
        ],
        &rows,
    );
    // From 64 steps on in 12 bits, and in 8 as far as the paper goes.
    let rms = |bits: usize| found.iter().map(|row| row[bits][0]).collect::<Vec<_>>();
    let rises = |values: &[f64]| values.windows(2).all(|pair| pair[1] > pair[0]);
    let grows = rises(&rms(0)[1..]) && rises(&rms(1)[..4]);
    section.say(&format!(
        "\"Beyond that limit the quality is not sufficient\": that the error in few bits grows with the number of steps {}; of 512 steps and more 8 bits \
         hold nothing. The largest \
         error of 12 bits hardly changes, there as here: it is the software's own, where S_f = S_b. Eq. 5 gives it no step there (one \
         is taken here), and by Eq. 6 a step does not absorb its own light; the bright diagonal of Figure 9 below is this. The figures \
         themselves depend on the transfer function.",
        verdict(grows),
    ));
}

/// S_f to the right and S_b upward, of the longest length.
fn frame_buffer(lookup: &Lookup, steps: [usize; 2]) -> Picture {
    square(128, |front, back| {
        let [r, g, b, _] = lookup.blended([front, back, 1.0], steps, 12);
        ([r, g, b], 1.0)
    })
}

fn frame_buffers(section: &mut Section) -> Result<()> {
    let lookup = Lookup::new(64, interleaved);
    let parts = [16, 48, 80, 112].map(|taken| frame_buffer(&lookup, [taken, 128]));
    section.figure(
        "figure_4",
        "Figure 4: RGB of a frame buffer of 12 bits after 16, 48, 80 and 112 of 128 steps, S_f to the right, S_b upward",
        &parts.each_ref().map(|picture| (picture, [0.0; 3])),
    )?;
    let ends = [frame_buffer(&lookup, [128; 2]), frame_buffer(&Lookup::new(1024, interleaved), [1024; 2])];
    section.figure(
        "figure_5",
        "Figure 5: the same after all of 128 steps (left), and after 1024, where light and opacity of a step are rounded away (right)",
        &ends.each_ref().map(|picture| (picture, [0.0; 3])),
    )
}

fn oversampling(section: &mut Section) {
    section.part("\"An oversampling factor of o = 2 is regarded to be sufficient\" (section 3)");
    let lookup = Lookup::new(64, interleaved);
    let factors = [1.0, 2.0, 4.0, 8.0, 16.0];
    let found = factors.map(|o| lookup.of_oversampling(o, NET).map(|x| 100.0 * x));
    let rows: Vec<[String; 3]> = factors
        .iter()
        .zip(&found)
        .map(|(o, [rms, most])| [o.to_string(), number(*rms), number(*most)])
        .collect();
    section.table(["o", "here: rms, %", "largest, %"], &rows);
    section.say(&format!(
        "With Eq. 6 as printed, for 64 entries, against o = 64. Half a step of 8 bits is 0.2 %: that o = 2 is sufficient for it {} on the \
         mean, and {} at worst. The tables of this program take the exact means of each piece and absorb within it.",
        verdict(found[1][0] < 0.2),
        verdict(found[1][1] < 0.2),
    ));
}

fn table_2(bench: &Bench, section: &mut Section) -> Result<()> {
    section.part("Table 2: seconds for the table");
    let subject = bench.subject("roettger_ertl_sphere.toml", &[])?;
    let extent = Extent { scalar: [0.0, 10.0], longest: 2.5 };
    let (mut rows, mut speeds) = (Vec::new(), Vec::new());
    for (side, printed) in TABLE_2 {
        let ramp = Ramp::new(&subject.scene.transfer_function, side, 2, &extent)?;
        let depths: Vec<f64> = (0..side / 2).map(|k| k as f64 / (side / 2 - 1) as f64).collect();
        let mut slice = vec![[0.0; 3]; side * side];
        let start = Instant::now();
        depths.iter().for_each(|length| ramp.fill(*length, std::hint::black_box(&mut slice)));
        let windows = start.elapsed().as_secs_f64();
        // The four loops take as long for every slice: the last one stands for all.
        let start = Instant::now();
        plain(&ramp, 1.0, std::hint::black_box(&mut slice));
        let loops = start.elapsed().as_secs_f64() * depths.len() as f64;
        speeds.push(loops / windows);
        let [software, hardware, speed] = printed.map(number);
        rows.push([
            format!("{side} × {side} × {}", side / 2),
            software,
            hardware,
            speed,
            number(loops),
            number(windows),
            number(loops / windows),
        ]);
    }
    section.table(
        ["table", "printed: software", "hardware", "speed-up", "here: four loops", "windows", "speed-up"],
        &rows,
    );
    section.say(&format!(
        "Both of ours on one core: paths of equal span share their sums (`slice.rs`), n³ of them in place of n⁴, with the same result. \
         So {} times as fast without graphics hardware, and without its bits.",
        span(&speeds),
    ));
    Ok(())
}

/// One slice by the loops of section 3 over S_f, S_b and the pieces between them, with two pieces a step.
fn plain(ramp: &Ramp, length: f64, slice: &mut [[f32; 3]]) {
    let n = ramp.size();
    for (k, entry) in slice.iter_mut().enumerate() {
        let (i, j) = (k / n, k % n);
        let lowest = i.min(j) * ramp.parts();
        let pieces = &ramp.pieces()[lowest..i.max(j) * ramp.parts()];
        let step = length / pieces.len().max(1) as f64;
        let (mut light, mut depth) = ([0.0; 3], 0.0_f64);
        for m in 0..pieces.len() {
            let piece = &pieces[if j < i { pieces.len() - 1 - m } else { m }];
            let held = piece.extinction * step;
            let seen = (-depth).exp() * step * mean_transmittance(held);
            for (sum, glow) in light.iter_mut().zip(piece.glow) {
                *sum += seen * glow;
            }
            depth += held;
        }
        *entry = light.map(|x| x as f32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use voltet_core::transfer::{ControlPoint, OpticalModel, Profile, TransferFunction, Widget};

    /// The loops and the windows find the same light: C/(D E₁) times what it is divided by.
    #[test]
    fn both_ways_fill_the_same_table() {
        let point = |s, extinction| ControlPoint { s, color: [s, 1.0 - s, 0.5], extinction };
        let points = vec![point(0.0, 0.5), point(0.4, 3.0), point(1.0, 0.0)];
        let profile = Profile::PiecewiseLinear { points };
        let widgets = vec![Widget { profile, color: [0.0; 3], extinction: 0.0, region: None }];
        let model = OpticalModel::DensityEmitter;
        let look = TransferFunction { model, unit_distance: 1.0, widgets };
        let ramp = Ramp::new(&look, 17, 2, &Extent { scalar: [0.0, 1.0], longest: 2.0 }).unwrap();
        let mut slices = [vec![[0.0; 3]; 17 * 17], vec![[0.0; 3]; 17 * 17]];
        ramp.fill(0.7, &mut slices[0]);
        plain(&ramp, 0.7, &mut slices[1]);
        let means = ramp.mean_extinctions();
        for k in (0..17 * 17).filter(|k| k / 17 != k % 17) {
            let reach = 0.7 * mean_transmittance(0.7 * f64::from(means[k]));
            for (shared, plain) in slices[0][k].iter().zip(slices[1][k]) {
                // 32 bits.
                assert!((f64::from(*shared) * reach - f64::from(plain)).abs() < 1e-6, "{k}");
            }
        }
    }
}
