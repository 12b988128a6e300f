//! Table widgets: an image over the (s, g) plane, bilinear in colour and in extinction × alpha.
//!
//! Symbols: x, y texel coordinates with texel (i, j) at the integers, row 0 at the largest g; along a straight
//! path both are linear in t, so between texel lines the extinction is a quadratic in t and the emission of
//! the density-emitter a quartic. Source: Song et al. 2009, section 3.3.2; docs/src/explanation/optics.md, section 5.
//! The optical depth is exact (Simpson's rule on each quadratic); colours come from the ordered integral of
//! module `overlap`.

use crate::track::Track;
use voltet_core::transfer::Table;

/// A table along one segment, inside its ranges of s and g; `peak` is ρ₀ D.
#[derive(Debug, Clone, Copy)]
pub struct TablePath<'a> {
    table: &'a Table,
    /// x at front and back.
    x: [f64; 2],
    /// y at front and back.
    y: [f64; 2],
    peak: f64,
    /// Alpha above which it glows.
    cutoff: Option<f64>,
}

/// The texels about a place and its shares between them.
struct Cell {
    corners: [usize; 4],
    shares: [f64; 4],
}

impl<'a> TablePath<'a> {
    /// From the values at both ends.
    pub fn new(table: &'a Table, front: [f64; 2], back: [f64; 2], peak: f64, cutoff: Option<f64>) -> Self {
        let (width, height) = (table.width as f64, table.height as f64);
        let column = |s: f64| (s - table.s[0]) / (table.s[1] - table.s[0]) * width - 0.5;
        let row = |g: f64| (table.g[1] - g) / (table.g[1] - table.g[0]) * height - 0.5;
        TablePath {
            table,
            x: [column(front[0]), column(back[0])],
            y: [row(front[1]), row(back[1])],
            peak,
            cutoff,
        }
    }

    fn cell(&self, t: f64) -> Cell {
        let at = |v: [f64; 2], count: usize| {
            let place = (v[0] * (1.0 - t) + v[1] * t).clamp(0.0, (count - 1) as f64);
            let low = (place.floor() as usize).min(count.saturating_sub(2));
            (low, (low + 1).min(count - 1), place - low as f64)
        };
        let (i0, i1, u) = at(self.x, self.table.width);
        let (j0, j1, v) = at(self.y, self.table.height);
        let index = |i: usize, j: usize| j * self.table.width + i;
        Cell {
            corners: [index(i0, j0), index(i1, j0), index(i0, j1), index(i1, j1)],
            shares: [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v],
        }
    }

    fn channel(&self, t: f64, channel: usize) -> f64 {
        let cell = self.cell(t);
        let texel = |k: usize| f64::from(self.table.texels[cell.corners[k]][channel]);
        (0..4).map(|k| cell.shares[k] * texel(k)).sum()
    }

    /// Colour at t.
    pub fn color(&self, t: f64) -> [f64; 3] {
        let cell = self.cell(t);
        std::array::from_fn(|c| {
            (0..4).map(|k| cell.shares[k] * f64::from(self.table.texels[cell.corners[k]][c])).sum()
        })
    }

    /// The next t' > t on a line through texel centres.
    fn next_line(&self, t: f64) -> f64 {
        let next = |v: [f64; 2], count: usize| {
            let span = v[1] - v[0];
            if span == 0.0 {
                return f64::INFINITY;
            }
            let last = (count - 1) as f64;
            let place = v[0] * (1.0 - t) + v[1] * t;
            let past = place + span.signum() * 4.0 * f64::EPSILON * (1.0 + place.abs() + span.abs());
            let line = if span > 0.0 { past.floor() + 1.0 } else { past.ceil() - 1.0 };
            let line = if span > 0.0 { line.max(0.0) } else { line.min(last) };
            if (0.0..=last).contains(&line) { (line - v[0]) / span } else { f64::INFINITY }
        };
        next(self.x, self.table.width).min(next(self.y, self.table.height))
    }

    /// Place where alpha passes the cutoff between t and the next line, if it does.
    fn next_crossing(&self, t: f64, end: f64) -> f64 {
        let Some(cutoff) = self.cutoff else { return f64::INFINITY };
        let length = end.min(1.0) - t;
        // α(t + length u) − cutoff = a u² + b u + c through three values.
        let value = |u: f64| self.channel(t + length * u, 3) - cutoff;
        let (start, middle, end) = (value(1e-12), value(0.5), value(1.0));
        let (a, b, c) = (2.0 * (start - 2.0 * middle + end), 4.0 * middle - 3.0 * start - end, start);
        let root = (b * b - 4.0 * a * c).sqrt();
        if root.is_nan() {
            return f64::INFINITY;
        }
        let q = -0.5 * (b + root.copysign(b));
        [q / a, c / q]
            .into_iter()
            .filter(|u| *u > 1e-9 && *u < 1.0 - 1e-9)
            .fold(f64::INFINITY, |first, u| first.min(t + length * u))
    }
}

impl Track for TablePath<'_> {
    fn rate(&self, t: f64) -> f64 {
        self.peak * self.channel(t, 3)
    }

    /// Line by line; exact.
    fn depth(&self, t: f64, dt: f64) -> f64 {
        let (mut start, mut rest, mut sum) = (t, dt, 0.0);
        while rest > 0.0 {
            let next = self.next_line(start);
            let length = if next < start + rest { next - start } else { rest };
            // Simpson's rule.
            let inside = self.rate(start) + 4.0 * self.rate(start + 0.5 * length) + self.rate(start + length);
            sum += length * inside / 6.0;
            start += length;
            rest = if length == rest { 0.0 } else { dt - (start - t) };
        }
        sum
    }

    fn next_break(&self, t: f64) -> f64 {
        let line = self.next_line(t);
        line.min(self.next_crossing(t, line))
    }
}
