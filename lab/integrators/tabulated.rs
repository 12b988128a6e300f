//! Widgets' integrals from tables in place of closed forms, as printed ([`GaussianTables`]).
//!
//! Density-emitter (Kniss et al. 2003, sections 4 and 5): the mean of e^(−x²) between both ends is IGauss (Eq. 16); with
//! K (v − v₀) in several dimensions the path's distance h from the centre gives the factor e^(−h²) (Eq. 11). Triangular Gaussians
//! take the mean of both gradient magnitudes for all of the segment (section 5.2.1). Several widgets are averaged
//! without regard to their order (Eq. 15), whatever `overlap` says.
//!
//! Constant-emitter (Song et al. 2009, section 4.2): the light of a Gaussian from a table over P = ρ₀ D e^(−h²)
//! √π/(2d) and the place x on the path; that of a stretch is kept between its length and that times the transmittance of all of it.
//!
//! Uniform widgets are closed forms without a table. What waves would take is refused.
//!
//! Integrals of Gaussians in tables, for [`Tabulated`].
//!
//! IGauss(x₁, x₂) (Kniss et al. 2003, Eq. 16), the mean of e^(−x²) between two places: 16-bit numbers over [−10, 10]² whose ends
//! hold on beyond.
//!
//! Light (Song et al. 2009, section 4.2): the paper's ∫ e^(−P erf x) dx and its prefactor leave the range of numbers at
//! P > 709, so kept is J(P, x) = ∫ from x to the table's end of e^(−P (erf u − erf x)) du, which is the same product.
//! Its P ends at 40, where the entry holds on.

use crate::settings::{
    PARTIAL_SIDE_PARAMETER, PreparedKernel, SIDE, boxed, count, shared_table, widget_label,
};
use crate::square::{Bilinear, LaneSquare};
use std::any::Any;
use voltet_core::Result;
use voltet_core::parameters::VariantSchema;
use voltet_core::transfer::{Convex, MAX_FIELDS, Profile, TransferFunction};
use voltet_cpu::integrator::{
    FallbackReason, FieldLanes, LaneExtension, LaneIntegratorKind, LaneKernel, LaneScene, LaneWidget,
    RegionPath, SegmentBatch, SegmentLanes, SegmentResults,
};
use voltet_optics::clip::ClippedSpan;
use voltet_optics::integrators::{
    Extent, Integrator, IntegratorKind, Obstacle, SegmentIntegrator, TableDomain, can_serve,
};
use voltet_optics::kinds::gaussian::GaussianPath;
use voltet_optics::special::{HALF_SQRT_PI, gaussian_mean, mean_transmittance, opacity};
use voltet_optics::{Contribution, Segment, WidgetBlend};
use voltet_simd::limits::MAX_GAUSSIAN_WIDTHS;
use voltet_simd::optics::elementary::{self, exp, mean_transparency};
use voltet_simd::optics::gaussian::LaneGaussianPath;
use voltet_simd::{Float, Lanes, Mask, array};

/// Integrals of uniform and Gaussian widgets from tables of 2 … [`crate::MAX_PARTIAL_SIDE`] entries a side.
pub const fn tabulated(side: usize) -> Integrator {
    Integrator::with_settings(&TabulatedKind, [side as f64])
}

pub(crate) struct TabulatedKind;

impl IntegratorKind for TabulatedKind {
    fn schema(&self) -> VariantSchema {
        VariantSchema {
            name: "tabulated",
            summary: "integrals of Gaussians from tables, widgets mixed without their order",
            parameters: &[PARTIAL_SIDE_PARAMETER],
        }
    }

    fn obstacle(&self, transfer_function: &TransferFunction) -> Option<Obstacle> {
        let has_table = |profile: &Profile| {
            matches!(
                profile,
                Profile::Uniform
                    | Profile::Gaussian { .. }
                    | Profile::GaussianNd { .. }
                    | Profile::TriangularGaussian { .. }
                    | Profile::TriangularGaussianNd { .. }
            )
        };
        let without = transfer_function.widgets.iter().position(|widget| !has_table(&widget.profile))?;
        let found = widget_label(transfer_function, without, "whose integral it has no table of");
        Some(Obstacle { found, accepted: "uniform widgets and Gaussians" })
    }

    fn table(&self) -> TableDomain {
        TableDomain::Fixed
    }

    fn compile(
        &self,
        integrator: &Integrator,
        _: WidgetBlend,
        transfer_function: &TransferFunction,
        _: &Extent,
    ) -> Result<Box<dyn SegmentIntegrator>> {
        Ok(Box::new(Tabulated::new(transfer_function, count(integrator, SIDE))?))
    }

    fn extensions(&self) -> &'static [&'static (dyn Any + Send + Sync)] {
        &[&LaneExtension(&TabulatedKind)]
    }
}

impl LaneIntegratorKind for TabulatedKind {
    fn prepare(&self, _: &Integrator, scene: &LaneScene<'_>) -> Result<PreparedKernel> {
        let tables = shared_table::<GaussianTables>(scene);
        Ok(tables.and_then(|tables| TabulatedKernel::new(tables, scene)).map(boxed))
    }
}

/// The tables, and the widgets made ready, in 64 bits.
#[derive(Debug, Clone)]
pub struct Tabulated {
    tables: GaussianTables,
    level: f64,
    unit_distance: f64,
    widgets: Vec<Tabled>,
}

#[derive(Debug, Clone)]
struct Tabled {
    color: [f64; 3],
    /// Per world unit.
    extinction: f64,
    clip: Option<Convex>,
    /// Columns of its coordinates among a value's [s, g, fields …]; none of a uniform one.
    columns: Vec<usize>,
    centre: Vec<f64>,
    matrix: Vec<Vec<f64>>,
    /// Column of the magnitude that widths grow with, and the factor on it.
    width: Option<(usize, f64)>,
}

impl Tabulated {
    /// Fills the tables. Serves uniform widgets and Gaussians of all kinds; `table_size` ≥ 2 entries a side.
    pub fn new(transfer_function: &TransferFunction, table_size: usize) -> Result<Self> {
        can_serve(&tabulated(table_size), transfer_function)?;
        transfer_function.check()?;
        let fields = transfer_function.fields();
        let column = |name: &String| 2 + fields.iter().position(|field| field == name).unwrap_or(0);
        let mut widgets = Vec::new();
        for widget in &transfer_function.widgets {
            let (columns, centre, matrix, width) = match &widget.profile {
                Profile::Gaussian { centre, matrix } => {
                    (vec![0, 1], centre.to_vec(), matrix.map(Vec::from).into(), None)
                }
                Profile::GaussianNd { fields, centre, matrix } => {
                    (fields.iter().map(column).collect(), centre.clone(), matrix.clone(), None)
                }
                Profile::TriangularGaussian { centre, sigma } => {
                    (vec![0], vec![*centre], vec![vec![1.0]], Some((1, *sigma)))
                }
                Profile::TriangularGaussianNd { fields, magnitude, centre, matrix } => {
                    let width = Some((column(magnitude), 1.0));
                    (fields.iter().map(column).collect(), centre.clone(), matrix.clone(), width)
                }
                // Uniform: others are refused by `obstacle` of the kind.
                _ => (Vec::new(), Vec::new(), Vec::new(), None),
            };
            let extinction = widget.extinction / transfer_function.unit_distance;
            let clip = widget.region.as_ref().map(Convex::new).transpose()?;
            widgets.push(Tabled { color: widget.color, extinction, clip, columns, centre, matrix, width });
        }
        let cutoff = transfer_function.model.cutoff();
        Ok(Tabulated {
            tables: GaussianTables::new(table_size, cutoff.is_some()),
            level: cutoff.map_or(0.0, |cutoff| -cutoff.ln()),
            unit_distance: transfer_function.unit_distance,
            widgets,
        })
    }

    /// ∫ e^(−T) dt over the part of a path where it glows; T counts from its start, through `depth` in all.
    fn glow(&self, path: Option<GaussianPath>, length: f64, depth: f64, rate: f64) -> f64 {
        let Some(GaussianPath { front, back, offset_squared, .. }) = path else {
            return length * mean_transmittance(depth);
        };
        let room = self.level - offset_squared;
        let (span, half) = (back - front, room.max(0.0).sqrt());
        if room <= 0.0 {
            return 0.0;
        }
        if span <= 0.0 {
            return if front.abs() < half { length * mean_transmittance(depth) } else { 0.0 };
        }
        let (start, end) = (front.max(-half), back.min(half));
        if start >= end {
            return 0.0;
        }
        let scale = rate * (-offset_squared).exp();
        let depth_of = |from: f64, to: f64| scale * (to - from) / span * self.tables.mean(from, to);
        let before = depth_of(front, start);
        let within = depth_of(start, end);
        let p = scale * HALF_SQRT_PI / span;
        let found = self.tables.lit(p, start) - (-within).exp() * self.tables.lit(p, end);
        let lit = end - start;
        length * (-before).exp() * found.clamp(lit * (-within).exp(), lit) / span
    }
}

impl SegmentIntegrator for Tabulated {
    fn table_bytes(&self) -> usize {
        self.tables.bytes()
    }

    fn table(&self) -> Option<&dyn Any> {
        Some(&self.tables)
    }

    fn integrate(&self, segment: &Segment) -> Contribution {
        let (mut depth, mut color) = (0.0, [0.0; 3]);
        for widget in &self.widgets {
            let stretch = match &widget.clip {
                None => ClippedSpan::WHOLE,
                Some(clip) => match ClippedSpan::within(clip, segment.front, segment.back) {
                    Some(stretch) => stretch,
                    None => continue,
                },
            };
            let Some(path) = widget.path(segment, &stretch) else { continue };
            let rate = widget.extinction * segment.length * stretch.length;
            let mean = path
                .map_or(1.0, |path| self.tables.mean(path.front, path.back) * (-path.offset_squared).exp());
            let own = rate * mean;
            if !(own >= 0.0 && rate > 0.0) {
                continue;
            }
            // Light over E₁ of the widget's own depth, for Eq. 15.
            let light = match self.tables.light.is_empty() {
                true => own,
                false => {
                    let scale = segment.length / self.unit_distance;
                    scale * self.glow(path, stretch.length, own, rate) / mean_transmittance(own)
                }
            };
            depth += own;
            for (sum, c) in color.iter_mut().zip(widget.color) {
                *sum += c * light;
            }
        }
        let dimmed = mean_transmittance(depth);
        Contribution { optical_depth: depth, color: color.map(|c| c * dimmed), opacity: opacity(depth) }
    }
}

impl Tabled {
    /// The widget's path over a stretch; `Some(None)` where its profile is 1, `None` where it is nothing.
    fn path(&self, segment: &Segment, stretch: &ClippedSpan) -> Option<Option<GaussianPath>> {
        if self.columns.is_empty() {
            return Some(None);
        }
        let front = [&segment.front, segment.fields_front].concat();
        let back = [&segment.back, segment.fields_back].concat();
        let width = self.width.map_or(1.0, |(column, factor)| factor * 0.5 * (front[column] + back[column]));
        if width <= 0.0 || width.is_nan() {
            return None;
        }
        let [front, back] = [front, back].map(|value| {
            let part = |((k, column), c): ((&f64, &usize), &f64)| k * (value[*column] - c);
            let row = |row: &Vec<f64>| row.iter().zip(&self.columns).zip(&self.centre).map(part).sum::<f64>();
            let mut q = [0.0; MAX_FIELDS];
            q.iter_mut().zip(&self.matrix).for_each(|(q, factors)| *q = row(factors) / width);
            q
        });
        // Kniss et al. 2003, Eq. 11.
        let mut path = GaussianPath::new(front, back, std::array::from_fn(|i| back[i] - front[i]));
        let (a, b) = (path.front, path.back);
        (path.front, path.back) = (stretch.at_start(a, b), stretch.at_end(a, b));
        (path.front + path.back + path.offset_squared).is_finite().then_some(Some(path))
    }
}

/// The tables in lanes, and what they are read for: each widget by itself, all of them averaged without their order.
struct TabulatedKernel {
    tables: LaneGaussianTables,
    /// The constant-emitter's glow per scene length and −ln cutoff; `None` for the density-emitter.
    glow: Option<(f32, f32)>,
    reads_fields: bool,
}

impl TabulatedKernel {
    /// Errors: the reason why the scene falls back to 64 bits.
    pub fn new(
        tables: &GaussianTables,
        scene: &LaneScene<'_>,
    ) -> std::result::Result<TabulatedKernel, FallbackReason> {
        if !scene.widgets().all(|widget| widget.has_path()) {
            return Err(FallbackReason::NoLanes);
        }
        let glow = scene.glow_scale()?.zip(scene.model().cutoff());
        Ok(TabulatedKernel {
            tables: LaneGaussianTables::new(tables),
            glow: glow.map(|(scale, cutoff)| (scale, -cutoff.ln() as f32)),
            reads_fields: scene.reads_fields(),
        })
    }

    /// Depth and light of one widget where it is met, the light over the mean transparency of that depth; and the lanes (bits) whose
    /// paths span more widths than 32 bits resolve.
    #[inline(always)]
    fn widget_light<L: Lanes>(
        &self,
        widget: &LaneWidget,
        segments: &SegmentLanes<L>,
        fields: &FieldLanes<L>,
        depth_only: bool,
    ) -> (L::F, L::F, u32) {
        let splat = L::F::splat;
        let (zero, one) = (splat(0.0), splat(1.0));
        let RegionPath { path, fraction: share, present: there } = widget.path(segments, fields);
        let rate = splat(widget.density()) * segments.length * share;
        // Where there is no stretch its ends are no numbers.
        let there = there.and(zero.lt(rate));
        let (mut mean, mut unsure) = (one, 0);
        if let Some(path) = &path {
            mean = self.tables.mean::<L>(path.front, path.back) * exp::<L>(-path.offset_squared);
            unsure = path.length.le(splat(MAX_GAUSSIAN_WIDTHS as f32)).not().bits() & there.bits();
        }
        let own = L::F::select(there, rate * mean, zero);
        let Some((scale, level)) = self.glow else { return (own, own, unsure) };
        if depth_only {
            return (own, own, unsure);
        }
        let seen = match &path {
            Some(path) => {
                self.tables.glow::<L>(path, level, [share, own, rate]) / mean_transparency::<L>(own)
            }
            None => share,
        };
        let light = L::F::select(there, splat(scale) * segments.length * seen, zero);
        (own, light, unsure)
    }
}

impl LaneKernel for TabulatedKernel {
    fn table_bytes(&self) -> usize {
        self.tables.bytes()
    }

    #[inline(always)]
    fn integrate<L: Lanes>(&self, batch: SegmentBatch<'_>, results: &mut SegmentResults<'_>) {
        let depth_only = batch.depth_only();
        let zero = L::F::splat(0.0);
        let mut fields = FieldLanes::<L>::none();
        for at in (0..batch.count()).step_by(L::WIDTH) {
            let segments = batch.segments::<L>(at);
            if self.reads_fields {
                fields = batch.fields::<L>(at);
            }
            let spread = segments.range();
            let (mut depth, mut product, mut light) = (zero, zero, [zero; 3]);
            let (mut asked, mut unsure) = (0, 0);
            for widget in batch.widgets() {
                let meets = widget.path_meets::<L>(&spread);
                if !meets.any() {
                    continue;
                }
                asked |= meets.bits();
                let (own, glow, no) =
                    self.widget_light::<L>(widget, &segments.only(meets), &fields, depth_only);
                unsure |= no;
                product = own.mul_add(depth, product);
                depth = depth + own;
                if !depth_only {
                    for c in 0..3 {
                        light[c] = glow.mul_add(L::F::splat(widget.color[c]), light[c]);
                    }
                }
            }
            results.put_depth::<L>(at, depth);
            let mut whole = depth;
            if !depth_only {
                let dimmed = mean_transparency::<L>(depth);
                let [r, g, b]: [L::F; 3] = array!(|c| light[c] * dimmed);
                // A number that is none, or has left 32 bits, makes the sum one.
                whole = depth + (r + (g + b));
                results.put::<L>(at, [r, g, b], depth);
            }
            unsure |= whole.le(L::F::splat(f32::MAX)).not().bits();
            let within = batch.within::<L>(segments.crossing, at);
            unsure &= within;
            results.fall_back(at, unsure);
            results.count_evaluations(u64::from((asked & within).count_ones()));
            if batch.widgets().len() > 1 {
                results.count_overlaps::<L>(product, &segments, batch.count() - at, unsure);
            }
        }
    }
}

/// Half the side of IGauss's domain, by Kniss et al.
pub const REACH: f64 = 10.0;

pub const MAX_P: f64 = 40.0;

/// Half the range of that table's places: erf is 1 beyond.
pub const LIT_REACH: f64 = 3.6;

/// Both tables; square, of one side.
#[derive(Debug, Clone)]
pub struct GaussianTables {
    size: usize,
    /// IGauss × 65535, by (x₁, x₂), each from −[`REACH`] to [`REACH`].
    means: Vec<u16>,
    /// J by (P, x), P from 0 to [`MAX_P`] and x from −[`LIT_REACH`] to [`LIT_REACH`]; empty where it was not asked for.
    light: Vec<f32>,
}

impl GaussianTables {
    /// Fills them, `size` ≥ 2 entries a side; `light`: also that of light.
    pub fn new(size: usize, light: bool) -> Self {
        let place = |k: usize| REACH * (2.0 * k as f64 / (size - 1) as f64 - 1.0);
        let entry = |k: usize| {
            let (a, b) = (place(k / size), place(k % size));
            let (mean, exponent) = gaussian_mean(a.min(b), a.max(b), (b - a).abs());
            (mean * (-exponent).exp() * f64::from(u16::MAX)).round() as u16
        };
        let means = (0..size * size).map(entry).collect();
        GaussianTables { size, means, light: if light { lights(size) } else { Vec::new() } }
    }

    pub fn bytes(&self) -> usize {
        size_of_val(self.means.as_slice()) + size_of_val(self.light.as_slice())
    }

    /// IGauss: the mean of e^(−x²) between two places.
    pub fn mean(&self, front: f64, back: f64) -> f64 {
        let place = |x: f64| (x + REACH) / (2.0 * REACH) * (self.size - 1) as f64;
        let at = Bilinear::new(place(front), place(back), self.size);
        at.read(|k| f64::from(self.means[k])) / f64::from(u16::MAX)
    }

    pub fn lit(&self, p: f64, x: f64) -> f64 {
        let last = (self.size - 1) as f64;
        let at = Bilinear::new(p / MAX_P * last, (x + LIT_REACH) / (2.0 * LIT_REACH) * last, self.size);
        at.read(|k| f64::from(self.light[k]))
    }
}

/// J, from its end backward: each step adds ∫ e^(−P (erf u − erf x)) du over it to what is behind, dimmed.
fn lights(size: usize) -> Vec<f32> {
    /// Parts of a step that Simpson's rule is taken over.
    const PARTS: usize = 4;
    let step = 2.0 * LIT_REACH / (size - 1) as f64;
    let place = |k: usize| k as f64 * step - LIT_REACH;
    let mut entries = vec![0.0; size * size];
    for (row, entries) in entries.chunks_exact_mut(size).enumerate() {
        let p = MAX_P * row as f64 / (size - 1) as f64;
        let mut behind = 0.0;
        for k in (0..size - 1).rev() {
            let x = place(k);
            let seen = |u: f64| (-p * (libm::erf(u) - libm::erf(x))).exp();
            let h = step / PARTS as f64;
            let simpson = |i: usize| {
                let u = x + i as f64 * h;
                h / 6.0 * (seen(u) + 4.0 * seen(u + 0.5 * h) + seen(u + h))
            };
            behind = seen(x + step) * behind + (0..PARTS).map(simpson).sum::<f64>();
            entries[k] = behind as f32;
        }
    }
    entries
}

#[derive(Debug, Clone)]
pub struct LaneGaussianTables {
    means: LaneSquare,
    /// J, where there is a constant-emitter.
    light: Option<LaneSquare>,
}

impl LaneGaussianTables {
    pub fn new(tables: &GaussianTables) -> LaneGaussianTables {
        let size = tables.size;
        let means: Vec<f32> = tables.means.iter().map(|x| f32::from(*x) / f32::from(u16::MAX)).collect();
        LaneGaussianTables {
            means: LaneSquare::new(&means, size),
            light: (!tables.light.is_empty()).then(|| LaneSquare::new(&tables.light, size)),
        }
    }

    pub fn bytes(&self) -> usize {
        self.means.bytes() + self.light.as_ref().map_or(0, LaneSquare::bytes)
    }

    /// IGauss: the mean of e^(−x²) between two places.
    #[inline(always)]
    pub fn mean<L: Lanes>(&self, front: L::F, back: L::F) -> L::F {
        let row = place::<L>(&self.means, front, REACH);
        let column = place::<L>(&self.means, back, REACH);
        self.means.read(&self.means.place::<L>(row, column))
    }

    #[inline(always)]
    fn lit<L: Lanes>(light: &LaneSquare, p: L::F, x: [L::F; 2]) -> [L::F; 2] {
        let splat = L::F::splat;
        let row = p * splat(light.last() / MAX_P as f32);
        let row = row.max(splat(0.0)).min(splat(light.last()));
        array!(|end| light.read(&light.place::<L>(row, place::<L>(light, x[end], LIT_REACH))))
    }

    /// ∫ e^(−T) dt over the part of a path of such a `length` (t) where the profile exceeds e^(−`level`), T from the path's start;
    /// `depth`: that of all of it, `rate`: at the centre, over it.
    #[inline(always)]
    pub fn glow<L: Lanes>(
        &self,
        path: &LaneGaussianPath<L>,
        level: f32,
        [length, depth, rate]: [L::F; 3],
    ) -> L::F {
        let splat = L::F::splat;
        let zero = splat(0.0);
        let Some(light) = &self.light else { return zero };
        let room = splat(level) - path.offset_squared;
        let half = room.max(zero).sqrt();
        let (front, back) = (path.front, path.back);
        let span = back - front;
        let (start, end) = (front.max(-half), back.min(half));
        let flat = span.le(zero);
        let inverse = splat(1.0) / L::F::select(flat, splat(1.0), span);
        let scale = rate * exp::<L>(-path.offset_squared) * inverse;
        let before = scale * (start - front) * self.mean::<L>(front, start);
        let within = scale * (end - start) * self.mean::<L>(start, end);
        let [from, to] = Self::lit::<L>(light, scale * splat(elementary::HALF_SQRT_PI), [start, end]);
        let (lit, through) = (end - start, exp::<L>(-within));
        let found = (from - through * to).max(lit * through).min(lit);
        let along = length * exp::<L>(-before) * found * inverse;
        let along = L::F::select(start.lt(end), along, zero);
        if !flat.any() {
            return L::F::select(zero.lt(room), along, zero);
        }
        let shines = front.abs().lt(half);
        let whole = L::F::select(shines, length * mean_transparency::<L>(depth), zero);
        L::F::select(zero.lt(room), L::F::select(flat, whole, along), zero)
    }
}

/// A place from −`reach` to `reach` in entries; the ends hold on beyond.
#[inline(always)]
fn place<L: Lanes>(table: &LaneSquare, x: L::F, reach: f64) -> L::F {
    let splat = L::F::splat;
    let half = splat(0.5 * table.last());
    x.mul_add(half * splat(1.0 / reach as f32), half).max(splat(0.0)).min(splat(table.last()))
}
