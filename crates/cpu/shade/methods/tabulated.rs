//! Gaussians' integrals from tables. Twin of `optics::integrators::Tabulated`: each widget by itself, all of them averaged without
//! their order.

use crate::fragments::batch::meant;
use crate::shade::along::{Along, Fields};
use crate::shade::kinds::{LaneWidget, Making, Through};
use crate::shade::reach::Spread;
use crate::shade::roads::{Form, Part};
use crate::shade::shaded::{Left, Shaded};
use crate::shade::shader::{overlaps, push};
use voltet_optics::research::GaussianTables;
use voltet_simd::limits::GAUSSIAN_WIDTHS_MOST;
use voltet_simd::optics::elementary::{exp, mean_transparency, one_minus_exp};
use voltet_simd::optics::gaussian_table::LaneGaussianTables;
use voltet_simd::{Float, Lanes, Mask, array};

/// The tables, and what they are read for.
pub(crate) struct Tabulated {
    tables: LaneGaussianTables,
    /// The constant-emitter's glow per scene length and −ln cutoff; `None` for the density-emitter.
    glow: Option<(f32, f32)>,
    /// Whether widgets look at further fields.
    reads_fields: bool,
}

impl Tabulated {
    /// Errors: why lanes do not serve it.
    pub fn new(tables: &GaussianTables, widgets: &[LaneWidget], making: &Making) -> Result<Tabulated, Left> {
        if !widgets.iter().all(LaneWidget::has_path) {
            return Err(Left::NoLanes);
        }
        let glow = making.glow_scale()?.zip(making.model.cutoff());
        Ok(Tabulated {
            tables: LaneGaussianTables::new(tables),
            glow: glow.map(|(scale, cutoff)| (scale, -cutoff.ln() as f32)),
            reads_fields: !making.fields.is_empty(),
        })
    }

    /// Bytes of the tables in lanes.
    pub fn bytes(&self) -> usize {
        self.tables.bytes()
    }

    /// Depth and light of one widget where it is met, the light over the mean transparency of that depth; and the lanes (bits) whose
    /// paths span more widths than 32 bits resolve.
    #[inline(always)]
    fn of<L: Lanes>(
        &self,
        widget: &LaneWidget,
        along: &Along<L>,
        fields: &Fields<L>,
        depth_only: bool,
    ) -> (L::F, L::F, u32) {
        let splat = L::F::splat;
        let (zero, one) = (splat(0.0), splat(1.0));
        let Through { path, share, there } = widget.through(along, fields);
        let rate = splat(widget.density()) * along.length * share;
        // Where there is no stretch its ends are no numbers.
        let there = there.and(zero.lt(rate));
        let (mut mean, mut unsure) = (one, 0);
        if let Some(path) = &path {
            mean = self.tables.mean::<L>(path.front, path.back) * exp::<L>(-path.offset_squared);
            unsure = path.length.le(splat(GAUSSIAN_WIDTHS_MOST as f32)).not().bits() & there.bits();
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
        let light = L::F::select(there, splat(scale) * along.length * seen, zero);
        (own, light, unsure)
    }
}

impl Form for Tabulated {
    #[inline(always)]
    fn shade<L: Lanes>(&self, part: Part<'_>, out: &mut Shaded) {
        let Part { widgets, one_color, batch, count } = part;
        let zero = L::F::splat(0.0);
        let mut fields = Fields::<L>::none();
        for at in (0..count).step_by(L::WIDTH) {
            let along = Along::<L>::load(batch, at);
            if self.reads_fields {
                fields = Fields::<L>::load(batch, at);
            }
            let spread = Spread::new(&along);
            let (mut depth, mut product, mut light) = (zero, zero, [zero; 3]);
            let (mut asked, mut unsure) = (0, 0);
            for widget in widgets {
                let meets = widget.path_meets::<L>(&spread);
                if !meets.any() {
                    continue;
                }
                asked |= meets.bits();
                let (own, glow, no) = self.of::<L>(widget, &along.only(meets), &fields, one_color);
                unsure |= no;
                product = own.mul_add(depth, product);
                depth = depth + own;
                if !one_color {
                    for c in 0..3 {
                        light[c] = glow.mul_add(L::F::splat(widget.color[c]), light[c]);
                    }
                }
            }
            depth.store(&mut out.depth[at..]);
            let mut whole = depth;
            if !one_color {
                let dimmed = mean_transparency::<L>(depth);
                let [r, g, b]: [L::F; 3] = array(
                    #[inline(always)]
                    |c| light[c] * dimmed,
                );
                // A number that is none, or has left 32 bits, makes the sum one.
                whole = depth + (r + (g + b));
                for (column, value) in out.rgba.iter_mut().zip([r, g, b, one_minus_exp::<L>(depth)]) {
                    value.store(&mut column[at..]);
                }
            }
            unsure |= whole.le(L::F::splat(f32::MAX)).not().bits();
            let meant = meant::<L>(along.crossing, count - at);
            unsure &= meant;
            push(&mut out.rest, unsure, at);
            out.evaluation_count += u64::from((asked & meant).count_ones());
            if widgets.len() > 1 {
                let overlapping = overlaps::<L>(product, &along, count - at) & !unsure;
                out.overlap_count += u64::from(overlapping.count_ones());
            }
        }
    }
}
