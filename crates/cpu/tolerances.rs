//! Tolerances: every number that decides how exact a picture is, with its reason. Numbers that only decide speed stand where they are used.

// Compositing.

/// Transmittance behind which nothing is visible (early ray termination): an optical depth of 25.
pub(crate) const MIN_TRANSMITTANCE: f32 = 1e-11;

/// Like [`MIN_TRANSMITTANCE`], where the transmittance is an upper bound: so much less that rounding never leaves out what the sum
/// would still show.
pub(crate) const MIN_TRANSMITTANCE_SAFE: f32 = 0.5 * MIN_TRANSMITTANCE;

/// Optical depth at which a pixel is opaque: its transmittance is below 1e-11.
pub(crate) const OPAQUE_OPTICAL_DEPTH: f32 = 25.0;

/// Transmittance in front of a segment below which a slower kernel does not run on it: its colour changes the picture by less.
pub(crate) const MIN_DEFERRED_VISIBILITY: f32 = 1e-8;

/// Entries that differ by less than this fraction of themselves may be one face, found from both of its cells.
pub(crate) const ENTRY_NOISE: f32 = 3e-7;

// Shading.

/// Optical depth along the longest ray that all widgets together may lose where their supports end: a hundredth of the 1e-6 that a
/// pixel may change, and a tenth of [`CULLED_DEPTH`].
pub const NEGLIGIBLE_DEPTH: f64 = 1e-8;

/// Overlaps whose pairwise product of optical depths is below this are mixed without regard to order: the error is at most the product
/// times the colour, 1e-8.
pub(crate) const MIX_PRODUCT: f32 = 1e-8;

/// Margin that values must have inside a region's half-plane, as a fraction of their range, so that no rounding of theirs leaves it.
pub(crate) const REGION_MARGIN: f64 = 1e-5;

// Culling.

/// Optical depth that all culled cells together may have along the longest ray: a tenth of the 1e-6 that a pixel may change.
pub(crate) const CULLED_DEPTH: f64 = 1e-7;

/// Fraction of its distance in pixels by which a point must lie outside a plane of the view to be culled, so that rounding never drops a
/// cell that touches the outermost samples.
pub(crate) const FRUSTUM_SLACK: f64 = 1e-9;

// Projection: cells beyond these bounds are crossed in 64 bits.

/// Spacing of pixel coordinates.
pub(crate) const PIXEL_STEP: f64 = 1.0 / (1u64 << 24) as f64;

/// Fraction of its size below which a cell's volume is rounding alone: no ray has a length there.
pub(crate) const FLAT_VOLUME: f64 = 1e-14;

/// Fraction of a cell's greatest depth up to which its corners are projected, where it reaches behind the eye: nearer ones may cover any
/// pixel.
pub(crate) const EYE_CUT: f64 = 1e-6;

/// Attribute coefficients by a cell's own range of values: of 24 bits 12 would cancel, and a length or a value be off by 2e-4 of its
/// range.
pub(crate) const MAX_CONDITION: f64 = 4e3;

/// Optical depth over a cell's range of depths, at the densest place, from which on a cell that is flatter than [`FLATNESS`] is
/// crossed in 64 bits: the rounding of its faces, some 6e-8 of that range, is an optical depth of 2e-5 by itself.
pub(crate) const DENSE_CELL_DEPTH: f64 = 300.0;

/// Range of depths over the thickest place of a cell that is optically thick: the rounding of the faces is 6e-5 of that.
pub(crate) const FLATNESS: f64 = 1e3;

/// Change of v over the pixels of a cell along one of its faces: a face seen nearly edge-on, whose terms cancel where a ray meets it.
/// They leave 6e-8 times this of v.
pub(crate) const MAX_FACE_SLOPE: f64 = 3e3;

/// Pixels within which a face may cross the cell's whole range of depths: the rounding of pixel coordinates moves it by 3e-5 of that
/// range.
pub(crate) const MIN_FACE_WIDTH: f64 = 2e-3;

/// Ratio of the depths of a perspective cell: v would span too many octaves for 24 bits.
pub(crate) const MAX_CELL_DEPTH_RATIO: f64 = 4.0;

/// Pixels by which a span may be rounded beyond its cell: its edges cross rows at multiples of 2⁻¹⁷.
pub(crate) const SPAN_SLACK: f64 = 1.0 / (1 << 16) as f64;

/// Projected area of a face by its extent on the screen that may be the rounding of pixel coordinates alone: it is seen edge-on.
pub(crate) const EDGE_ON_AREA: f64 = 4.0 * PIXEL_STEP;

/// Length of a line by its fall from which on it is level: spans would find its crossings of a row to more than a pixel only.
pub(crate) const LEVEL_RATIO: f64 = 65536.0;

/// Distance of a row from a level line (pixels) within which rounding decides on which side it lies.
pub(crate) const LEVEL_ROW_DISTANCE: f64 = 1.0 / LEVEL_RATIO;

/// Distance of a column from the crossing of an edge-on face with its row, by the columns that the face goes on in a row, within which
/// rounding decides on which side it lies.
pub(crate) const EDGE_ON_COLUMN_DISTANCE: f32 = 1.0 / (1 << 15) as f32;

// Ray casting.

/// Fraction of the product of its edges below which a tetrahedron's volume is rounding alone: no ray enters it.
pub(crate) const FLAT_CELL: f64 = 1e-12;

/// Optical depth over the longest thin cell ([`voltet_core::grid::extent::longest_edges`]), at the densest place: rounding moves a face by some 1e-7 of the cell's size.
pub(crate) const MAX_THIN_CELL_DEPTH: f64 = 4e3;

/// Depth of the farthest point by that of the nearest up to which depths are told apart by their inverse.
pub(crate) const MAX_DEPTH_RATIO: f64 = 64.0;

/// Pixels by which the box of a boundary face is enlarged: the coarsest step of screen positions.
pub(crate) const BOUNDARY_SLACK: f64 = 1.0 / 4096.0;

/// Steps of depth in which cells that a ray enters may overlap those that it has left: cells that meet at a boundary do, by rounding.
pub(crate) const ENTRY_OVERLAP: u32 = 1 << 11;

/// Weight added to a corner of a face, so that three of no weight have a mean: less than any that is not 0.
pub(crate) const MIN_CORNER_WEIGHT: f32 = 1e-15;

// Segment cache.

/// Width of a widget by the range of the values: 32 bits that are counted from the centre of the range hold a 20,000th of it.
pub(crate) const MIN_CACHED_WIDTH: f64 = 1.0 / 2000.0;
