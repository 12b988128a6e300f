//! Limits of 32-bit arithmetic, for every engine that computes in it: the CPU engine integrates such segments in 64 bits, a
//! device's shaders refuse such scenes before anything is drawn.

/// Widths of a Gaussian that a segment may span: the rounding of its ends (6e-8 of the span) moves the path by a share of a
/// width, which enters the square of its distance from the centre: 1e-5 of the depth at this limit, 4e-3 at 1e6 widths.
pub const MAX_GAUSSIAN_WIDTHS: f64 = 1e5;

/// Widths of a triangular Gaussian, at its wider end, that a segment may span: t finds where the profile is to 1e-7 of the
/// segment, and the quadrature's panels begin there.
pub const MAX_TRIANGULAR_WIDTHS: f64 = 50.0;

/// Width of a profile on a logarithmic axis, in decades, down to which a device draws: it finds positions to 1.5e-7 near a widget, and to
/// 6e-8 of the decades between several. So a place of a profile this narrow is known to 3e-5 of its peak, over twelve decades to 1e-4.
pub const MIN_DECADES: f64 = 5e-3;

/// Bands of a wave, over what values span, within which 32 bits tell one from the next.
pub const MAX_BANDS: f64 = 1e6;

/// Bands of a segment, by band width, that are walked one by one: beyond, the rounding of t blurs where the bands begin (by
/// 6e-5 of their width here).
pub const MAX_WALKED_BANDS: f64 = 1000.0;

/// Rate of a segment's densest place, depth per t, up to which panels resolve what is seen: t finds a step to 5e-7, so to
/// 1e-4 of depth.
pub const MAX_RATE: f32 = 200.0;

/// Largest rate of Gaussians and uniform widgets whose walk begins each panel at 0: beyond, errors outside of where a Gaussian is
/// resolved may be seen.
pub const MAX_DENSE_RATE: f32 = 1e7;

/// Depth from which on all that is seen of a wave of the constant-emitter is where its band begins to glow.
pub const OPAQUE: f64 = 30.0;

/// That place is then within rounding of where the band begins if the segment crosses more than this times the cutoff of
/// bands, by band width: the rate there, `cutoff` of its peak, has few digits. Under the limit the colour errs by less
/// than 1e-4.
pub const SUDDEN_BANDS: f64 = 2e4;

/// Depth of the longest segment, all of it at the peak, up to which 32 bits find the colour of several widgets in their
/// order: what is seen of them lies within so small a part of the segment (t finds places to 6e-8) that their shares in it
/// are known to 1e-4 up to here, and to nothing at ten times that.
pub const MAX_ORDERED_DEPTH: f64 = 2e7;

/// Rate, depth per t, of a ramp between two control points of different colours where it becomes opaque, up to which 32 bits
/// find what is seen of both: t finds the ramp to 6e-8, which moves its depth by 2e-3 here and colours by a tenth of that.
pub const MAX_RAMP_RATE: f64 = 4e4;

/// Pieces of a segment that a t tells apart.
pub const MAX_PIECES: u32 = 1 << 20;

/// Lengths and depths of a segment, in unit distances: within these no product of two steps leaves the normal range.
pub const LENGTHS: std::ops::Range<f64> = f32::MIN_POSITIVE as f64..f32::MAX as f64 / 4.0;

/// Under this length in unit distances the products of a walk in panels leave the normal range.
pub const MIN_WALKED_LENGTH: f32 = 1e-30;
