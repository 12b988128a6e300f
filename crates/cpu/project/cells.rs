//! Projection kernel: cells to face planes in screen space, and the tiles that they touch.
//!
//! One pass over the selected cells in grid order, as many at a time as the processor has 64-bit lanes. Cells that
//! cover no pixel centre go no further. Cells that 32 bits cannot hold (behind or very near the eye, slivers
//! beyond 1 : 4,000, cells flatter than the pixel coordinates resolve) are set apart and crossed in 64 bits by [`super::precise_cell`].

use crate::attribute::{Attribute, MAX_ATTRIBUTES};
use crate::project::edge_on::{edge_on, may_be_edge_on};
use crate::tile::{Area, tiles_of};
use crate::tolerances::{
    DENSE_CELL_DEPTH, FLATNESS, MAX_CELL_DEPTH_RATIO, MAX_CONDITION, MAX_FACE_SLOPE, MIN_FACE_WIDTH,
    PIXEL_STEP, SPAN_SLACK,
};
use crate::view::{ScreenVertex, View};
use voltet_simd::{Double, Kernel, Lanes, Mask, array, inlined};

#[derive(Debug, Default)]
pub(crate) struct ProjectedCells {
    /// Face planes of each cell that covers a pixel centre.
    pub planes: Vec<ProjectedCell>,
    /// Attributes: `attribute_count` a cell.
    pub attributes: Vec<AttributePlane>,
    /// Points of the cells' tetrahedra.
    pub corners: Vec<[u32; 4]>,
    /// Tiles of the area that each cell touches: x0, y0, x1, y1 (exclusive).
    pub tiles: Vec<[u16; 4]>,
    /// Cells that touch each tile of the area.
    pub tile_counts: Vec<u32>,
    /// Tetrahedra that are crossed in 64 bits.
    pub precise_cells: Vec<u32>,
}

#[derive(Clone, Copy)]
pub(crate) struct Input<'a> {
    pub view: &'a View,
    pub screen_vertices: &'a [ScreenVertex],
    pub tetrahedra: &'a [[u32; 4]],
    pub attributes: &'a [Attribute<'a>],
    /// Depth that distances are counted from (scene lengths).
    pub distance_origin: f64,
    /// Upper bound of the optical depth, or colour, that the widgets give together over a scene length.
    pub max_optical_depth: f64,
    /// Tiles to project for: cells that touch none of them are dropped.
    pub area: Area,
}

pub(crate) struct ProjectCells<'a> {
    pub input: Input<'a>,
    pub cells: &'a [u32],
    pub part: &'a mut ProjectedCells,
}

impl ProjectedCells {
    /// Empties all lists, and keeps their memory.
    pub fn begin(&mut self, area: Area) {
        let ProjectedCells { planes, attributes, corners, tiles, tile_counts, precise_cells } = self;
        planes.clear();
        attributes.clear();
        corners.clear();
        tiles.clear();
        tile_counts.clear();
        tile_counts.resize(area.tile_count(), 0);
        precise_cells.clear();
    }
}

impl Kernel for ProjectCells<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let ProjectCells { input, cells, part } = self;
        part.planes.reserve(cells.len());
        part.attributes.reserve(cells.len() * input.attributes.len());
        part.corners.reserve(cells.len());
        part.tiles.reserve(cells.len());
        for group in cells.chunks(L::D::COUNT) {
            project_group::<L>(&input, group, part);
        }
    }
}

#[inline(always)]
fn project_group<L: Lanes>(input: &Input<'_>, group: &[u32], part: &mut ProjectedCells) {
    let view = input.view;
    let n = group.len();
    let splat = L::D::splat;
    let (one, zero) = (splat(1.0), splat(0.0));

    let corners = Corners::<L::D>::gather(input.screen_vertices, input.tetrahedra, group);
    let PixelBounds { columns: [x0, x1], rows: [y0, y1], in_depth, any: covered } = corners.covered(view);
    let Corners { x, y, z } = corners;
    let (width, height) = (splat(view.size[0] as f64), splat(view.size[1] as f64));
    let live = (1u32 << n) - 1;
    let mut in_64_bits = !in_depth.bits() & live;
    let ordinary = in_depth.and(covered).bits() & live;
    if ordinary == 0 {
        push_cells64(group, in_64_bits, part);
        return;
    }

    // v of the corners, about the mean depth; pixel coordinates about the middle of the covered box.
    let middle = (z[0] + z[1] + (z[2] + z[3])) * splat(0.25);
    let (v, depth) = if view.perspective {
        (array!(|k| (middle - z[k]) / z[k]), middle)
    } else {
        (array!(|k| middle - z[k]), one)
    };
    let pixel_x = ((x0 + x1) * splat(0.5)).ceil().min(width - one);
    let pixel_y = ((y0 + y1) * splat(0.5)).ceil().min(height - one);

    // Edges from corner 0, their cross products: normals of the faces opposite corners 1, 2, 3.
    let edge = inlined!(|c: &[L::D; 4], k: usize| c[k] - c[0]);
    let e: [[L::D; 3]; 3] = array!(|k| [edge(&x, k + 1), edge(&y, k + 1), edge(&v, k + 1)]);
    let cross = inlined!(|a: &[L::D; 3], b: &[L::D; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    });
    let n1 = cross(&e[1], &e[2]);
    let n2 = cross(&e[2], &e[0]);
    let n3 = cross(&e[0], &e[1]);
    let determinant = e[0][0] * n1[0] + e[0][1] * n1[1] + e[0][2] * n1[2];
    // The face opposite corner 0 from corner 1, so that a neighbour finds the same area, bit for bit: both
    // start from the face's lowest point number.
    let f: [[L::D; 3]; 2] = array!(|k| [x[k + 2] - x[1], y[k + 2] - y[1], v[k + 2] - v[1]]);
    let n0 = cross(&f[0], &f[1]);

    let reach = (max_of(&x) - min_of(&x)) + (max_of(&y) - min_of(&y));
    let range = max_of(&v) - min_of(&v);
    // What is narrow compares with MAX_FACE_SLOPE like what is steep.
    let narrow = splat(MIN_FACE_WIDTH * MAX_FACE_SLOPE) / range;
    let face = inlined!(|c: &[L::D; 4], opposite: usize| -> [L::D; 3] {
        array!(|k| c[if k < opposite { k } else { k + 1 }])
    });
    let mut front_bits = [0u32; 4];
    let mut planes = [[[0f32; MAX_DOUBLE_LANES]; 3]; 4];
    let (mut ill, mut areas) = (0, zero);
    for (k, normal) in [n0, n1, n2, n3].iter().enumerate() {
        // Inside, (normal · (p − corner)) has the sign of the determinant (opposite for face 0); a face is a
        // front face where a smaller v leads inside.
        let orientation = if k == 0 { -determinant } else { determinant };
        let faces_eye = (orientation * normal[2]).lt(zero);
        let from = if k == 0 { 1 } else { 0 };
        let inverse = one / normal[2];
        let (a, b) = (-(normal[0] * inverse), -(normal[1] * inverse));
        let c = v[from] + (a * (pixel_x - x[from]) + b * (pixel_y - y[from]));
        let largest = a.abs().max(b.abs()).max(c.abs());
        // NaN (0/0 of an edge-on face) fails the comparison too.
        let mut bounded = largest.lt(splat(UNBOUNDED_SLOPE));
        // Few cells come near.
        let area = normal[2].abs();
        areas = areas + area;
        if may_be_edge_on(area, reach).bits() & ordinary != 0 {
            let class = edge_on(face(&x, k), face(&y, k), area);
            bounded = bounded.and(class.edge_on.not());
            ill |= class.undecided.bits();
        }
        let across = a.abs() * (x1 - x0) + b.abs() * (y1 - y0);
        let within = (a.abs() + b.abs()) * narrow;
        ill |= bounded.and(splat(MAX_FACE_SLOPE).lt(across.max(within))).bits();
        let open = L::D::select(faces_eye, splat(UNBOUNDED_SLOPE), splat(-UNBOUNDED_SLOPE));
        // An edge-on face constrains nothing: the silhouette does.
        L::D::select(bounded, a, zero).store_f32(&mut planes[k][0]);
        L::D::select(bounded, b, zero).store_f32(&mut planes[k][1]);
        L::D::select(bounded, c, open).store_f32(&mut planes[k][2]);
        front_bits[k] = faces_eye.bits();
    }

    // The greatest thickness of a flat cell is the determinant over the area that it covers, half of the areas' sum.
    let dense = splat(DENSE_CELL_DEPTH).lt(range * depth * splat(input.max_optical_depth)).bits();
    if dense & ordinary != 0 {
        ill |= dense & (splat(FLATNESS) * determinant.abs()).lt(range * areas * splat(0.5)).bits();
    }

    // Attributes: (s − base)(1 + v) is affine in (x, y, v).
    let inverse = one / determinant;
    let sound = determinant.abs().lt(splat(f64::MAX));
    let mut stored = [[[0f32; MAX_DOUBLE_LANES]; 6]; MAX_ATTRIBUTES];
    let extent = [x1 - x0, y1 - y0, range];
    for (attribute, stored) in input.attributes.iter().zip(stored.iter_mut()) {
        let mut raw = [[0f64; MAX_DOUBLE_LANES]; 4];
        for lane in 0..L::D::COUNT {
            let tetrahedron = &input.tetrahedra[group[lane.min(n - 1)] as usize];
            for (k, &point) in tetrahedron.iter().enumerate() {
                raw[k][lane] = attribute.at(point as usize);
            }
        }
        let raw = load::<L::D>(&raw);
        let scaled: [L::D; 4] = array!(|k| (raw[k] - splat(attribute.offset)) * splat(1.0 / attribute.scale));
        let (low, high) = (min_of(&scaled), max_of(&scaled));
        let mean = (low + high) * splat(0.5);
        let weighted: [L::D; 4] = array!(|k| {
            let s = scaled[k] - mean;
            if view.perspective { s.mul_add(v[k], s) } else { s }
        });
        let d: [L::D; 3] = array!(|k| weighted[k + 1] - weighted[0]);
        let gradient: [L::D; 3] = array!(|i| (d[0] * n1[i] + d[1] * n2[i] + d[2] * n3[i]) * inverse);
        let at_pixel = weighted[0] + gradient[0] * (pixel_x - x[0]) + gradient[1] * (pixel_y - y[0])
            - gradient[2] * v[0];
        let base = mean + at_pixel;
        let r = if view.perspective { gradient[2] - at_pixel } else { gradient[2] };
        let range = high - low;
        let steepest = (gradient[0].abs() * extent[0])
            .max(gradient[1].abs() * extent[1])
            .max(gradient[2].abs() * extent[2]);
        ill |= splat(MAX_CONDITION).mul_add(range, splat(f64::MIN_POSITIVE)).lt(steepest).bits();
        gradient[0].store_f32(&mut stored[0]);
        gradient[1].store_f32(&mut stored[1]);
        r.store_f32(&mut stored[2]);
        base.store_f32(&mut stored[3]);
        low.store_f32(&mut stored[4]);
        high.store_f32(&mut stored[5]);
    }
    // A determinant that the rounding of the pixel coordinates could have made says nothing: in 64 bits, without
    // pixels, a cell whose points lie on a line or a plane is found to have no volume.
    let mut across = zero;
    for normal in [&n1, &n2, &n3] {
        across = across + (normal[0].abs() + normal[1].abs());
    }
    let noise = splat(16.0 * PIXEL_STEP) * across;
    ill |= determinant.abs().le(noise).bits();
    let drawn = ordinary & sound.bits();
    in_64_bits |= drawn & ill;
    push_cells64(group, in_64_bits, part);

    // Store lane by lane.
    let mut words = [[0f64; MAX_DOUBLE_LANES]; 8];
    for (row, value) in words.iter_mut().zip([x0, y0, x1, y1, pixel_x, pixel_y, depth, middle]) {
        value.store(row);
    }
    for lane in 0..n {
        if drawn & !ill & (1 << lane) == 0 {
            continue;
        }
        let pixels = [0, 1, 2, 3].map(|k: usize| words[k][lane] as usize);
        let Some(rectangle) = input.area.intersection(tiles_of(pixels)) else { continue };
        let mut cell = ProjectedCell {
            depth: words[6][lane] as f32,
            distance: (words[7][lane] - input.distance_origin) as f32,
            pixel: words[4][lane] as u32 | (words[5][lane] as u32) << 16,
            ..ProjectedCell::default()
        };
        for k in 0..4 {
            cell.a[k] = planes[k][0][lane];
            cell.b[k] = planes[k][1][lane];
            cell.c[k] = planes[k][2][lane];
            cell.front |= (front_bits[k] >> lane & 1) << k;
        }
        for ty in rectangle[1]..rectangle[3] {
            let first = input.area.index([rectangle[0], ty]);
            for count in &mut part.tile_counts[first..first + (rectangle[2] - rectangle[0])] {
                *count += 1;
            }
        }
        part.planes.push(cell);
        part.corners.push(input.tetrahedra[group[lane] as usize]);
        part.tiles.push(rectangle.map(|tile| tile as u16));
        for stored in stored.iter().take(input.attributes.len()) {
            part.attributes.push(AttributePlane {
                p: stored[0][lane],
                q: stored[1][lane],
                r: stored[2][lane],
                base: stored[3][lane],
                low: stored[4][lane],
                high: stored[5][lane],
            });
        }
    }
}

#[inline(always)]
fn push_cells64(group: &[u32], in_64_bits: u32, part: &mut ProjectedCells) {
    if in_64_bits != 0 {
        part.precise_cells.extend(
            group.iter().enumerate().filter(|(lane, _)| in_64_bits >> lane & 1 != 0).map(|(_, &id)| id),
        );
    }
}

/// Face planes of a projected cell, in 64 bytes.
///
/// With z the depth of a point and z₀ the depth chosen for the cell, v = z₀/z − 1 (perspective) or v = z₀ − z (parallel rays) is affine
/// on every plane, in pixel coordinates: nearer points have the larger v, and v is small in a small cell, so 32 bits keep the
/// *thickness* of the cell to full relative precision however far away it is. A ray enters the cell at the smallest v of its front faces
/// and leaves at the largest v of its back faces.
#[derive(Debug, Clone, Copy, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(64))]
pub(crate) struct ProjectedCell {
    /// ∂v/∂x of the four faces (opposite vertices 0 … 3).
    pub a: [f32; 4],
    /// ∂v/∂y of the four faces.
    pub b: [f32; 4],
    /// v of the four faces at the cell's pixel.
    pub c: [f32; 4],
    /// z₀ (perspective), or 1: scene lengths of depth per unit of v near v = 0.
    pub depth: f32,
    /// z₀ − the depth that distances are counted from, scene lengths.
    pub distance: f32,
    /// Bit i: face i looks towards the eye.
    pub front: u32,
    /// Reference pixel, x + (y << 16).
    pub pixel: u32,
}

/// One attribute of a projected cell: s, linear in space, is `base + (p Δx + q Δy + r v) / (1 + v)` (without the quotient for parallel
/// rays), Δ being taken from the cell's pixel: s/z is affine as v is.
#[derive(Debug, Clone, Copy, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct AttributePlane {
    /// Coefficient of Δx.
    pub p: f32,
    /// Coefficient of Δy.
    pub q: f32,
    /// Coefficient of v.
    pub r: f32,
    /// Value at the cell's pixel and v = 0.
    pub base: f32,
    /// Smallest value of the cell: the linear form is clamped to it, since slivers extrapolate.
    pub low: f32,
    /// Largest value of the cell.
    pub high: f32,
}

/// Words of 32 bits in the planes of a cell.
pub(crate) const CELL_WORDS: usize = 16;
/// Coefficients beyond this stand for "no constraint": the face is seen edge-on.
pub(crate) const UNBOUNDED_SLOPE: f64 = 1e30;

/// Most 64-bit lanes.
pub(crate) const MAX_DOUBLE_LANES: usize = 8;

/// Four corners of each cell.
#[derive(Clone, Copy)]
pub(crate) struct Corners<D: Double> {
    pub x: [D; 4],
    pub y: [D; 4],
    pub z: [D; 4],
}

/// Pixel centres that a cell's box covers, and those that its spans may round to.
#[derive(Clone, Copy)]
pub(crate) struct PixelBounds<D: Double> {
    /// First column, and the one behind the last.
    pub columns: [D; 2],
    /// First row, and the one behind the last.
    pub rows: [D; 2],
    /// True if 32 bits hold its depths.
    pub in_depth: D::Mask,
    /// True if there are such pixels.
    pub any: D::Mask,
}

#[inline(always)]
pub(crate) fn load<D: Double>(rows: &[[f64; MAX_DOUBLE_LANES]; 4]) -> [D; 4] {
    [D::load(&rows[0]), D::load(&rows[1]), D::load(&rows[2]), D::load(&rows[3])]
}

#[inline(always)]
pub(crate) fn min_of<D: Double>(c: &[D; 4]) -> D {
    c[0].min(c[1]).min(c[2].min(c[3]))
}

#[inline(always)]
pub(crate) fn max_of<D: Double>(c: &[D; 4]) -> D {
    c[0].max(c[1]).max(c[2].max(c[3]))
}

impl<D: Double> Corners<D> {
    /// `group`: numbers of the tetrahedra, at least one; the lanes behind them are filled with the last.
    #[inline(always)]
    pub fn gather(vertices: &[ScreenVertex], tetrahedra: &[[u32; 4]], group: &[u32]) -> Corners<D> {
        let [mut x, mut y, mut z] = [[[0.0; MAX_DOUBLE_LANES]; 4]; 3];
        for lane in 0..D::COUNT {
            let tetrahedron = &tetrahedra[group[lane.min(group.len() - 1)] as usize];
            for (k, &point) in tetrahedron.iter().enumerate() {
                let vertex = &vertices[point as usize];
                x[k][lane] = vertex.x;
                y[k][lane] = vertex.y;
                z[k][lane] = vertex.z;
            }
        }
        Corners { x: load(&x), y: load(&y), z: load(&z) }
    }

    /// Pixels of a picture that the boxes cover.
    #[inline(always)]
    pub fn covered(&self, view: &View) -> PixelBounds<D> {
        let splat = D::splat;
        let zero = splat(0.0);
        let size = [view.size[0] as f64, view.size[1] as f64];
        let within = inlined!(|end: D, size: f64| end.ceil().max(zero).min(splat(size)));
        let beside = splat(SPAN_SLACK);
        let columns = [within(min_of(&self.x) - beside, size[0]), within(max_of(&self.x) + beside, size[0])];
        let rows = [within(min_of(&self.y), size[1]), within(max_of(&self.y), size[1])];
        let (nearest, farthest) = (min_of(&self.z), max_of(&self.z));
        let in_depth = if view.perspective {
            zero.lt(nearest).and(farthest.le(splat(MAX_CELL_DEPTH_RATIO) * nearest))
        } else {
            nearest.le(farthest)
        };
        let any = columns[0].lt(columns[1]).and(rows[0].lt(rows[1]));
        PixelBounds { columns, rows, in_depth, any }
    }
}
