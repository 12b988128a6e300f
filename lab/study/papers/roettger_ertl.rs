//! S. Roettger, T. Ertl, "A two-step approach for interactive pre-integrated volume rendering of unstructured grids", 2002.

use super::bench::{Bench, TimedRender};
use crate::papers::bench::*;
use crate::work_precision::errors;
use std::time::Instant;
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_integrators::{Ramp, from_cylinder, pre_integrated, pre_integrated_cylindrical};
use voltet_optics::integrators::Extent;
use voltet_optics::shading::Integrator;
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

pub(super) fn section(bench: &Bench) -> Result<Section> {
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
    cylinder(bench, &mut section)?;
    Ok(section)
}

fn table_1(section: &mut Section) {
    section.part("Table 1: accuracy of blending in few bits, in % of full scale");
    let (mut rows, mut found) = (Vec::new(), Vec::new());
    for (steps, twelve, eight) in TABLE_1 {
        let lookup = Lookup::new(steps, interleaved);
        let here = [12, 8].map(|bits| lookup.of_hardware(bits, NET).map(|error| 100.0 * error));
        let mut row = vec![steps.to_string()];
        for (printed, here) in [Some(twelve), eight].into_iter().zip(here) {
            for (k, here) in here.into_iter().enumerate() {
                row.extend([printed.map_or("–".into(), |errors| number(errors[k])), number(here)]);
            }
        }
        rows.push(row);
        found.push(here);
    }
    section.table(
        &[
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
    let rows = factors.iter().zip(&found);
    let rows: Vec<_> =
        rows.map(|(o, [rms, most])| vec![o.to_string(), number(*rms), number(*most)]).collect();
    section.table(&["o", "here: rms, %", "largest, %"], &rows);
    section.say(&format!(
        "With Eq. 6 as printed, for 64 entries, against o = 64. Half a step of 8 bits is 0.2 %: that o = 2 is sufficient for it {} on the \
         mean, and {} at worst. The tables of this program take the exact means of each piece and absorb within it.",
        verdict(found[1][0] < 0.2),
        verdict(found[1][1] < 0.2),
    ));
}

fn table_2(bench: &Bench, section: &mut Section) -> Result<()> {
    section.part("Table 2: seconds for the table");
    let subject = (bench.open)("roettger_ertl_sphere.toml", &[])?;
    let extent = Extent { scalar: [0.0, 10.0], longest: 2.5 };
    let (mut rows, mut speeds) = (Vec::new(), Vec::new());
    for (side, printed) in TABLE_2 {
        let ramp = Ramp::new(&subject.scene.transfer_function, side, 2, &extent)?;
        let depths: Vec<f64> = (0..side / 2).map(|k| k as f64 / (side / 2 - 1) as f64).collect();
        let mut slice = vec![[0.0; 4]; side * side];
        let start = Instant::now();
        depths.iter().for_each(|length| ramp.fill(*length, std::hint::black_box(&mut slice)));
        let windows = start.elapsed().as_secs_f64();
        // The four loops take as long for every slice: the last one stands for all.
        let start = Instant::now();
        plain(&ramp, 1.0, std::hint::black_box(&mut slice));
        let loops = start.elapsed().as_secs_f64() * depths.len() as f64;
        speeds.push(loops / windows);
        let here = [loops, windows, loops / windows].map(number).to_vec();
        let name = format!("{side} × {side} × {}", side / 2);
        rows.push([vec![name], printed.map(number).to_vec(), here].concat());
    }
    section.table(
        &["table", "printed: software", "hardware", "speed-up", "here: four loops", "windows", "speed-up"],
        &rows,
    );
    section.say(&format!(
        "Both of ours on one core: paths of equal span share their sums (`ramp.rs`), n³ of them in place of n⁴, with the same result. \
         So {} times as fast without graphics hardware, and without its bits.",
        span(&speeds),
    ));
    Ok(())
}

/// One slice by the loops of section 3 over S_f, S_b and the pieces between them, with two pieces a step.
fn plain(ramp: &Ramp, length: f64, slice: &mut [[f32; 4]]) {
    let n = ramp.size();
    for (k, entry) in slice.iter_mut().enumerate() {
        let (i, j) = (k / n, k % n);
        let lowest = i.min(j) * ramp.parts;
        let pieces = &ramp.pieces[lowest..i.max(j) * ramp.parts];
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
        *entry = [light[0] as f32, light[1] as f32, light[2] as f32, 0.0];
    }
}

/// κ by channel and ρ.
type Material = ([f64; 3], f64);

/// A transfer function as a table of m entries, linear between them.
struct Lookup {
    entries: Vec<Material>,
}

impl Lookup {
    /// Samples a transfer function of S ∈ [0, 1].
    fn new(count: usize, of: impl Fn(f64) -> Material) -> Lookup {
        Lookup { entries: (0..count).map(|k| of((k as f64 + 0.5) / count as f64)).collect() }
    }

    fn at(&self, s: f64) -> Material {
        let last = (self.entries.len() - 1) as f64;
        let place = (s * self.entries.len() as f64 - 0.5).clamp(0.0, last);
        let low = (place as usize).min(self.entries.len().saturating_sub(2));
        let share = place - low as f64;
        let (a, b) = (self.entries[low], self.entries[(low + 1).min(self.entries.len() - 1)]);
        let mix = |x: f64, y: f64| x + share * (y - x);
        ([0, 1, 2].map(|c| mix(a.0[c], b.0[c])), mix(a.1, b.1))
    }

    /// RGB and opacity by Eq. 5 to 7, as printed, with o m |S_f − S_b| steps; at least one, where Eq. 5 has none.
    fn software(&self, front: f64, back: f64, length: f64, oversampling: f64) -> [f64; 4] {
        let steps = oversampling * self.entries.len() as f64 * (front - back).abs();
        let count = (steps.ceil() as usize).max(1);
        self.composited(front, back, length, [count; 2], &|x| x)
    }

    /// RGB and opacity by blending the first of so many rectangles in a frame buffer of so many bits a channel; the ends, and the
    /// length.
    fn blended(&self, [front, back, length]: [f64; 3], steps: [usize; 2], bits: u32) -> [f64; 4] {
        let most = f64::from((1_u32 << bits) - 1);
        self.composited(front, back, length, steps, &|x: f64| (x.clamp(0.0, 1.0) * most).round() / most)
    }

    /// From back to front, the first of so many steps; `stored`: what becomes of a number that is written.
    fn composited(
        &self,
        front: f64,
        back: f64,
        length: f64,
        [taken, count]: [usize; 2],
        stored: &dyn Fn(f64) -> f64,
    ) -> [f64; 4] {
        let step = length / count as f64;
        let mut rgba = [0.0, 0.0, 0.0, 1.0];
        for i in 0..taken {
            let share = if count > 1 { i as f64 / (count - 1) as f64 } else { 0.5 };
            let (glow, extinction) = self.at(back + share * (front - back));
            let through = 1.0 - stored(1.0 - (-step * extinction).exp());
            for (c, value) in rgba.iter_mut().enumerate() {
                let added = if c < 3 { stored(step * glow[c]) } else { 0.0 };
                *value = stored(*value * through + added);
            }
        }
        rgba[3] = 1.0 - rgba[3];
        rgba
    }

    /// Difference of hardware from software, which oversamples twice.
    fn of_hardware(&self, bits: u32, side: usize) -> [f64; 2] {
        let count = self.entries.len();
        deviation(
            side,
            |f, b, l| self.blended([f, b, l], [count; 2], bits),
            |f, b, l| self.software(f, b, l, 2.0),
        )
    }

    /// Difference of software that oversamples so often from one that does 64 times.
    fn of_oversampling(&self, oversampling: f64, side: usize) -> [f64; 2] {
        deviation(
            side,
            |f, b, l| self.software(f, b, l, oversampling),
            |f, b, l| self.software(f, b, l, 64.0),
        )
    }
}

/// Root of the mean square and largest difference of two ways over a net of S_f, S_b and eight lengths.
fn deviation(
    side: usize,
    found: impl Fn(f64, f64, f64) -> [f64; 4],
    wanted: impl Fn(f64, f64, f64) -> [f64; 4],
) -> [f64; 2] {
    let (mut sum, mut most, mut number) = (0.0, 0.0_f64, 0);
    let place = |k: usize| k as f64 / (side - 1) as f64;
    let net =
        (0..side * side * 8).map(|k| (place(k / 8 / side), place(k / 8 % side), (k % 8 + 1) as f64 / 8.0));
    for (front, back, length) in net {
        for (a, b) in found(front, back, length).into_iter().zip(wanted(front, back, length)) {
            let error = (a.clamp(0.0, 1.0) - b.clamp(0.0, 1.0)).abs();
            (sum, most, number) = (sum + error * error, most.max(error), number + 1);
        }
    }
    [(sum / f64::from(number)).sqrt(), most]
}

/// κ and ρ of the longest length, which takes half of the light.
fn interleaved(s: f64) -> Material {
    let colors = [[0.9, 0.4, 0.05], [0.05, 0.3, 0.9]];
    let extinction = std::f64::consts::LN_2;
    (colors[(8.0 * s) as usize % 2].map(|c| c * extinction), extinction)
}

fn cylinder(bench: &Bench, section: &mut Section) -> Result<()> {
    section.part("Figures 8 to 12: tables as planes, the spherical distance volume, and many cells");
    let lookup = Lookup::new(64, interleaved);
    let slices =
        [1, 2, 3, 4, 5, 6, 7, 8].map(|k| square(64, |s, t| texel(&lookup, [s, t, f64::from(k) / 8.0])));
    let row = slices.each_ref().map(|picture| (picture, [0.0; 3]));
    section.figure(
        "figure_9",
        "Figure 9: eight of 64 slices of the table for growing length, S_f to the right, S_b upward",
        &row,
    )?;
    section.figure(
        "figure_10",
        "Figure 10: the same table as 64 planes of 64², s to the right and t upward, from α = 0° left below to 180° right above; black where \
         S_f leaves the table",
        &[(&tiles(&lookup), [0.0; 3])],
    )?;
    let subject = (bench.open)("roettger_ertl_sphere.toml", &[])?;
    let cells = subject.scene.volume.grid.tetrahedra.len();
    let scene = bench.referred(subject)?;
    let shot = |integrator| bench.shot(&scene, integrator);
    let exact = shot(Integrator::ANALYTIC)?;
    let (table_size, oversampling) = (64, 2);
    let table = shot(pre_integrated(table_size, oversampling))?;
    let mut rows = Vec::new();
    let mut add = |what: String, shot: &TimedRender, loss: String| {
        let [_, rms, most, _] = shot.cells();
        rows.push(vec![what, number(1e3 / shot.ms), rms, most, loss]);
    };
    add("cut at its control points".into(), &exact, "–".into());
    add("table of 64³".into(), &table, "–".into());
    let mut losses = Vec::new();
    let mut speed = 0.0;
    for planes in [1, 2, 4, 8] {
        let tiles = shot(pre_integrated_cylindrical(table_size, oversampling, planes))?;
        let loss = errors(&tiles.picture, &table.picture);
        let over = loss.pixels_over_step;
        let differs = format!("{:.1e}, {over} pixels", loss.maximum);
        add(format!("{} planes", planes * table_size + 1), &tiles, differs);
        losses.push(loss.maximum);
        if planes == 1 {
            speed = table.ms / tiles.ms;
        }
    }
    let difference = "largest difference from the table of 64³";
    section.table(&["512 × 384", "frames a second", "rms error", "largest error", difference], &rows);
    section.figure(
        "figure_11",
        "Figure 11: cut at the control points (left), from the table of 64³ (right)",
        &[exact.panel(), table.panel()],
    )?;
    section.say(&format!(
        "{cells} tetrahedra; 2,560 in the paper. \"In order to reconstruct the original table exactly, the number of planes must be four times \
         the resolution\": with four times as many the largest difference is {:.1e}, with eight times {:.1e}: exactness {}, as the \
         places on a plane are resampled, too, and the slices of this program's table lie closer where lengths are small. \"In most \
         cases the number of planes can be reduced by a factor of two or four without introducing visible artifacts\": with as many \
         planes as entries {:.1e}, which {}.",
        losses[2],
        losses[3],
        verdict(losses[2] < 1e-6),
        losses[0],
        verdict(losses[0] < 1.0 / 255.0),
    ));
    section.say(&format!(
        "Two-dimensional tables were 1.13 to 3.8 times as fast as three-dimensional ones on hardware (printed: 13 % to 282 % faster); \
         here {} times. Times without making the table.",
        number(speed),
    ));
    many(bench, section)
}

/// Straight RGB and opacity of an entry at S_f, S_b and the length.
fn texel(lookup: &Lookup, [front, back, length]: [f64; 3]) -> ([f64; 3], f64) {
    let [r, g, b, opacity] = lookup.software(front, back, length, 2.0);
    ([r, g, b].map(|c| if opacity > 0.0 { c / opacity } else { 0.0 }), opacity)
}

/// 8 × 8 planes from α = 0 to 1.
fn tiles(lookup: &Lookup) -> Picture {
    const ACROSS: usize = 8;
    square(ACROSS * 64, |x, y| {
        let [x, y] = [x, y].map(|place| place * ACROSS as f64);
        let plane = y as usize * ACROSS + x as usize;
        let angle = plane as f64 / (ACROSS * ACROSS - 1) as f64;
        let place = from_cylinder(angle, x.fract(), y.fract());
        if (0.0..=1.0).contains(&place[0]) { texel(lookup, place) } else { ([0.0; 3], 0.0) }
    })
}

/// Figure 12: as many cells, in a scene of another kind.
fn many(bench: &Bench, section: &mut Section) -> Result<()> {
    let subject = (bench.open)("roettger_ertl_many.toml", &["grid.resolution=[58,58,59]".into()])?;
    let cells = subject.scene.volume.grid.tetrahedra.len();
    let planes = pre_integrated_cylindrical(256, 2, 1);
    let (exact, closed) = bench.measured(&subject, Integrator::ANALYTIC)?;
    let (picture, tiled) = bench.measured(&subject, planes)?;
    let loss = errors(&picture, &exact);
    section.figure(
        "figure_12",
        "Figure 12, the bonsai there, the field by formula of VTK's \"Wavelet\" here: from 257 planes",
        &[(&picture, subject.background)],
    )?;
    section.say(&format!(
        "{cells} tetrahedra in grid order; about 1,200,000 of several sizes in the paper. {:.0} ms from planes and {:.0} ms cut at its \
         control points, which the planes differ from by {:.1e} at worst and {:.1e} on the mean (rms). The planes take {:.0} ms to make.",
        tiled.frame.median_ms,
        closed.frame.median_ms,
        loss.maximum,
        loss.root_mean_square,
        tiled.set_up.median_ms,
    ));
    Ok(())
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
        let look = TransferFunction { model, unit_distance: 1.0, widgets, axes: Default::default() };
        let ramp = Ramp::new(&look, 17, 2, &Extent { scalar: [0.0, 1.0], longest: 2.0 }).unwrap();
        let mut slices = [vec![[0.0; 4]; 17 * 17], vec![[0.0; 4]; 17 * 17]];
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

    /// Without variation every count of steps gives the same opacity, and in many bits light by Eq. 6 tends to (κ/ρ)(1 − e^(−ρl)).
    #[test]
    fn a_constant_function_tends_to_its_closed_form() {
        let lookup = Lookup::new(256, |_| ([0.5, 0.25, 0.0], 2.0));
        let [red, green, blue, opacity] = lookup.software(0.0, 1.0, 1.0, 2.0);
        let exact = 1.0 - (-2.0_f64).exp();
        assert!((opacity - exact).abs() < 1e-12);
        // Eq. 6 is of first order: ρ l/2n, n = 512.
        assert!((red / (0.25 * exact) - 1.0).abs() < 2.1 / 1024.0 && (green / red - 0.5).abs() < 1e-12);
        assert_eq!(blue, 0.0);
        let [red, .., opacity] = lookup.blended([0.0, 1.0, 1.0], [256; 2], 30);
        assert!((opacity - exact).abs() < 1e-6 && (red / (0.25 * exact) - 1.0).abs() < 2.1 / 512.0);
    }

    /// A part of the steps leaves what the whole begins with: the light at the back.
    #[test]
    fn a_part_of_the_steps_is_the_back_of_the_path() {
        let lookup = Lookup::new(64, |s| ([s, 1.0 - s, 0.0], 1.0));
        let [red, green, _, opacity] = lookup.blended([1.0, 0.0, 1.0], [32, 128], 30);
        // A quarter of the length, from S_b = 0 up to a quarter.
        assert!((opacity - (1.0 - (-0.25_f64).exp())).abs() < 1e-6, "{opacity}");
        assert!(green > 4.0 * red && red > 0.0, "{red} {green}");
    }

    /// More steps in few bits make it worse: steps fall below what a channel can hold.
    #[test]
    fn few_bits_do_not_bear_many_steps() {
        let deviation = |count, bits| {
            let half = |s: f64| {
                if ((4.0 * s) as u32).is_multiple_of(2) {
                    ([0.9, 0.4, 0.0], 1.0)
                } else {
                    ([0.0, 0.2, 0.9], 1.0)
                }
            };
            Lookup::new(count, half).of_hardware(bits, 9)[0]
        };
        assert!(deviation(256, 8) > 2.0 * deviation(64, 8));
        assert!(deviation(256, 12) < 0.2 * deviation(256, 8));
    }
}
