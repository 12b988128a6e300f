//! Projection kernel: cells to face planes in screen space, and the tiles that they touch.
//!
//! One pass over the selected cells in grid order, as many at a time as the processor has 64-bit lanes. Cells that
//! cover no pixel centre go no further. Cells that 32 bits cannot hold (behind or very near the eye, slivers
//! beyond 1 : 4,000, cells flatter than the pixel coordinates resolve) are set apart and crossed in 64 bits by [`super::precise_cell`].

use crate::attribute::{Attribute, MAX_ATTRIBUTES};
use crate::project::edge_on::{edge_on, may_be_edge_on};
use crate::project::pixel_bounds::{Corners, MAX_DOUBLE_LANES, PixelBounds, load, max_of, min_of};
use crate::project::projected_cell::{AttributePlane, ProjectedCell, UNBOUNDED_SLOPE};
use crate::tile::{Area, tiles_of};
use crate::tolerances::{
    DENSE_CELL_DEPTH, FLATNESS, MAX_CONDITION, MAX_FACE_SLOPE, MIN_FACE_WIDTH, PIXEL_STEP,
};
use crate::view::{ScreenVertex, View};
use voltet_simd::{Double, Kernel, Lanes, Mask, array, inlined};

/// Projected cells of a run of cells.
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

/// Input of the projection.
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
    type Output = ();

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
