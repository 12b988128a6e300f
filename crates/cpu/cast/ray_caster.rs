//! Ray caster, the acceleration structure of a picture; the boundary of the drawn cells, by which its rays enter and exit; and the cost
//! model of casting rays against projecting cells.

use super::edge_functions::{FacePoint, Offset, edge_function, edges_inside, moved_by_depth};
use super::half_faces::{BoundaryFace, EXIT_FLAG, FaceCache, HalfFaces, MAX_CELLS, NO_FACE};
use super::points::{Points, ScreenExtent};
use crate::fragments::batch::MAX_LANES;
use crate::project::cells::Input;
use crate::selection::{CellSelection, Traversal};
use crate::tile::{Area, PIXELS, TILE, TileRect, tiles_of};
use crate::tolerances::{BOUNDARY_SLACK, EYE_CUT, MAX_THIN_CELL_DEPTH};
use crate::view::{ScreenVertex, View};
use rayon::prelude::*;
use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher};
use std::sync::Arc;
use voltet_core::transfer::TransferFunction;
use voltet_optics::scene_parts::PartTally;
use voltet_optics::shading::Ordering;
use voltet_simd::{Float, Kernel, LaneSet, Lanes, Mask, Unsigned, array, dispatch, inlined, mask_of};

/// Attributes that rays interpolate: s, g and the components of ∇s.
pub(crate) const MAX_RAYCAST_ATTRIBUTES: usize = 5;

/// Cells of the sample that estimates how many pixels a cell covers.
const SAMPLED_CELLS: usize = 4096;

/// Acceleration structure of a picture's rays.
#[derive(Debug)]
pub(crate) struct RayCaster {
    pub(super) half_faces: Arc<HalfFaces>,
    pub(super) points: Points,
    pub(super) boundary: Boundary,
}

impl RayCaster {
    /// Prepares rays through the cells of a picture. `None` where cells are projected instead: in another order than the exact one; by the
    /// selection's `traversal`; where attributes are many; where the policy is not met, or thin cells are optically thick.
    ///
    /// Where the near plane or the eye lies among the cells, rays go through those in view alone: they enter by faces of these on the
    /// eye's side of the near plane, and their segments begin at it.
    pub fn new(
        cells: &CellSelection,
        faces: &FaceCache,
        input: &Input<'_>,
        (extent, policy): (&ScreenExtent, RayCastPolicy),
    ) -> Option<RayCaster> {
        let Input { view, screen_vertices, tetrahedra, attributes, max_optical_depth, .. } = *input;
        let drawn = drawn(cells, faces, view, extent);
        if !serves(cells, drawn, attributes.len()) {
            return None;
        }
        let segments = covered_pixels(view, screen_vertices, tetrahedra, &cells.ids) / drawn.len() as f64;
        if cells.traversal != Traversal::RayCast && !cells.casts_rays && !policy.pays(segments) {
            return None;
        }
        // Faces are found last: of a volume that takes longer than a frame.
        let grid = &cells.volume.grid;
        let mesh = faces.mesh(grid, longest_of_whole(cells));
        if are_thin_cells_dense(cells, mesh.longest, max_optical_depth) {
            return None;
        }
        let longest = mesh.longest[0] / cells.length;
        let half_faces = faces.half_faces(&mesh, grid, drawn);
        let allows_boundary = policy.allows_boundary(half_faces.boundary.len() as f64, drawn.len() as f64);
        if !cells.casts_rays && !allows_boundary {
            return None;
        }
        let points = Points::new(view, &grid.points, screen_vertices, extent, longest, attributes)?;
        let corner = |point| points.corner(screen_vertices, &grid.points, point);
        let boundary = Boundary::new(&half_faces, corner, view.size);
        Some(RayCaster { half_faces, points, boundary })
    }

    /// Tiles that rays enter at, numbered row by row, those with most boundary faces first.
    pub fn queue(&self) -> Vec<u32> {
        let starts = &self.boundary.starts;
        let count = |tile: usize| starts[tile + 1] - starts[tile];
        let mut queue: Vec<u32> =
            (0..starts.len() - 1).filter(|&tile| count(tile) > 0).map(|tile| tile as u32).collect();
        queue.sort_by_key(|&tile| std::cmp::Reverse(count(tile as usize)));
        queue
    }
}

/// True if rays can be cast through cells in their order, with so many attributes.
fn serves(cells: &CellSelection, drawn: &[u32], attribute_count: usize) -> bool {
    cells.traversal != Traversal::Project
        && matches!(cells.ordering, Ordering::Independent | Ordering::PerPixel)
        && attribute_count <= MAX_RAYCAST_ATTRIBUTES
        && !drawn.is_empty()
        && drawn.len() <= MAX_CELLS
}

/// The longest edges of the whole grid that the cells are a part of: of all cells and of thin ones, world units.
fn longest_of_whole(cells: &CellSelection) -> Option<[f64; 2]> {
    cells.whole.as_ref().map(|whole| whole.longest_edges)
}

/// True if thin cells are optically thick: they are projected. `longest_edges`: of all cells and of thin ones, world units.
fn are_thin_cells_dense(cells: &CellSelection, [_, longest_thin]: [f64; 2], max_optical_depth: f64) -> bool {
    MAX_THIN_CELL_DEPTH < max_optical_depth * (longest_thin / cells.length)
}

/// Figures of the selected cells, as those of a part of a grid. `caster`: that of the rays, where they are cast; `finds_boundary`: true
/// to find the boundary wherever they could be.
pub(crate) fn tally(
    cells: &CellSelection,
    faces: Option<&FaceCache>,
    (view, screen_vertices): (&View, &[ScreenVertex]),
    (extent, policy): (&ScreenExtent, RayCastPolicy),
    (attribute_count, max_optical_depth): (usize, f64),
    (caster, finds_boundary): (Option<&RayCaster>, bool),
) -> PartTally {
    let grid = &cells.volume.grid;
    let drawn = faces.map_or(&cells.ids, |faces| drawn(cells, faces, view, extent));
    let covered_pixels = covered_pixels(view, screen_vertices, &grid.tetrahedra, &cells.ids);
    let longest = longest_of_whole(cells);
    let is_dense = longest.is_some_and(|longest| are_thin_cells_dense(cells, longest, max_optical_depth));
    let possible = faces.filter(|_| serves(cells, drawn, attribute_count) && !is_dense);
    let is_in_view = !cells.ids.is_empty();
    let could_be_cast = caster.is_none() && possible.is_some();
    // Where rays are not cast for the boundary alone, or for the view alone, it is found.
    let pays = policy.pays(covered_pixels / drawn.len().max(1) as f64);
    let is_found = finds_boundary || caster.is_some() || pays || !is_in_view;
    let mesh = possible.filter(|_| is_found).map(|faces| faces.mesh(grid, longest));
    let half_faces = match (caster, faces, &mesh) {
        (Some(caster), ..) => Some(caster.half_faces.clone()),
        (None, Some(faces), Some(mesh)) => Some(faces.half_faces(mesh, grid, drawn)),
        _ => None,
    };
    // A face that two cells of the part share, of which one is drawn, is at the boundary whatever the other parts have.
    let is_inner = |face: &&BoundaryFace| {
        let [index, opposite] = [face.half_face as usize / 4, face.half_face as usize % 4];
        let of_cell = |drawn: &Arc<HalfFaces>| 4 * drawn.cells[index] as usize + opposite;
        half_faces
            .as_ref()
            .zip(mesh.as_ref())
            .is_some_and(|(drawn, mesh)| mesh.neighbours[of_cell(drawn)] != NO_FACE)
    };
    let key = |face: &BoundaryFace| {
        let of_corner = |corner: u32| {
            let hasher = BuildHasherDefault::<DefaultHasher>::default();
            hasher.hash_one(grid.points[corner as usize].to_array().map(|x| (x + 0.0).to_bits()))
        };
        face.corners.map(of_corner).into_iter().fold(0, u64::wrapping_add)
    };
    let faces = half_faces.as_ref().map_or(&[][..], |half_faces| &half_faces.boundary);
    let boundary: Vec<u64> =
        faces.par_iter().with_min_len(CHUNK).filter(|face| !is_inner(face)).map(key).collect();
    PartTally {
        covered_pixels,
        cells: drawn.len() as f64,
        outer_faces: (faces.len() - boundary.len()) as f64,
        boundary,
        lacks_boundary: could_be_cast && half_faces.is_none(),
        methods: [caster.is_some(), could_be_cast && is_in_view],
        active_widgets: Vec::new(),
    }
}

/// The cells that rays go through: those in widgets' supports, in view or not; where the near plane may cut cells, those in view.
fn drawn<'a>(
    cells: &'a CellSelection,
    faces: &'a FaceCache,
    view: &View,
    extent: &ScreenExtent,
) -> &'a Arc<Vec<u32>> {
    if extent.is_cut(view) { &cells.ids } else { faces.drawn() }
}

/// Pixels that cells cover in front of the near plane, estimated from some of them. A tetrahedron covers half of the sum of its four faces.
fn covered_pixels(
    view: &View,
    screen_vertices: &[ScreenVertex],
    tetrahedra: &[[u32; 4]],
    cells: &[u32],
) -> f64 {
    let step = (cells.len() / SAMPLED_CELLS).max(1);
    let area = |cell: &u32| {
        let corners @ [a, b, c, d] = tetrahedra[*cell as usize].map(|p| &screen_vertices[p as usize]);
        if corners.iter().any(|corner| corner.z <= view.near) {
            return 0.0;
        }
        let face = |a: &ScreenVertex, b: &ScreenVertex, c: &ScreenVertex| {
            (0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x))).abs()
        };
        0.5 * (face(a, b, c) + face(a, b, d) + face(a, c, d) + face(b, c, d))
    };
    cells.iter().step_by(step).map(area).sum::<f64>() * step as f64
}

/// Cost model that decides if rays are cast. The gain over projecting cells is counted in the time to find the faces that they share,
/// both by cells; measured over grids of 0.2 to 16 million cells, 2 to 140 segments each (`lab/bench/frames.py`).
#[derive(Debug, Clone, Copy)]
pub(crate) struct RayCastPolicy {
    /// Gain of each segment of a cell: negative where nothing has to be sorted.
    gain_of_segment: f64,
    /// Boundary faces by cells.
    max_boundary: f64,
}

/// Gain of a cell that is not projected; in proportion less where cells cover less than a pixel each: the projection soon drops those that
/// cover none.
const GAIN_OF_CELL: f64 = 0.8;

/// Gain from which on rays are cast. A picture could be drawn once, for which finding faces takes longer than is gained by less than 1;
/// or often. Neither is known beforehand, and a picture has the same bits whatever was drawn before: less than a frame is lost at most.
const MIN_RAYCAST_GAIN: f64 = 0.3;

/// Optical depth over the scene length, at the densest place, from which on rays soon end.
const OPAQUE_SCENE_DEPTH: f64 = 100.0;

impl RayCastPolicy {
    /// Policy for a scene whose optical depth over the scene length is `max_optical_depth` at the densest place.
    pub fn new(transfer_function: &TransferFunction, max_optical_depth: f64) -> RayCastPolicy {
        let (gain_of_segment, max_boundary) = match transfer_function.uniform_color() {
            None => (0.01, 1.0),
            Some(_) if OPAQUE_SCENE_DEPTH < max_optical_depth => (0.0, 0.2),
            Some(_) => (-0.01, 0.2),
        };
        RayCastPolicy { gain_of_segment, max_boundary }
    }

    /// True if casting rays is faster by enough. `segments`: of a cell on average.
    pub fn pays(&self, segments: f64) -> bool {
        MIN_RAYCAST_GAIN <= GAIN_OF_CELL * segments.min(1.0) + self.gain_of_segment * segments
    }

    /// True if the boundary is small enough.
    pub fn allows_boundary(&self, faces: f64, cells: f64) -> bool {
        faces <= self.max_boundary * cells
    }
}

/// Faces of a chunk of work.
const CHUNK: usize = 1 << 12;

/// Boundary faces that may cover a pixel's centre, by the tiles that they touch.
#[derive(Debug)]
pub(super) struct Boundary {
    starts: Vec<u32>,
    faces: Vec<u32>,
}

impl Boundary {
    /// `corner`: see [`super::points::Points::corner`].
    pub fn new(
        half_faces: &HalfFaces,
        corner: impl Fn(u32) -> ([f64; 3], f64) + Sync,
        size: [usize; 2],
    ) -> Boundary {
        let area = Area::of_picture(size);
        let touches: Vec<Vec<(u32, u32)>> = half_faces
            .boundary
            .par_chunks(CHUNK)
            .enumerate()
            .map(|(chunk, faces)| {
                let mut touches = Vec::with_capacity(2 * faces.len());
                for (k, face) in faces.iter().enumerate() {
                    let corners = face.corners.map(&corner);
                    let boxes = boxes(corners.map(|(corner, _)| corner), corners[0].1, size);
                    let [front, behind] =
                        boxes.map(|pixels| pixels.and_then(|pixels| area.intersection(tiles_of(pixels))));
                    let is_in_front = |x: usize, y: usize| {
                        front.is_some_and(|[x0, y0, x1, y1]| (x0..x1).contains(&x) && (y0..y1).contains(&y))
                    };
                    let mut add = |x: usize, y: usize| {
                        touches.push((area.index([x, y]) as u32, (chunk * CHUNK + k) as u32));
                    };
                    if let Some([x0, y0, x1, y1]) = front {
                        (y0..y1).for_each(|y| (x0..x1).for_each(|x| add(x, y)));
                    }
                    if let Some([x0, y0, x1, y1]) = behind {
                        for y in y0..y1 {
                            (x0..x1).filter(|&x| !is_in_front(x, y)).for_each(|x| add(x, y));
                        }
                    }
                }
                touches
            })
            .collect();
        let (mut starts, mut faces) = (vec![0; area.tile_count() + 1], Vec::new());
        let touches = touches.iter().flatten();
        counting_sort(touches.map(|(tile, face)| (*tile as usize, *face)), &mut starts, &mut faces);
        Boundary { starts, faces }
    }

    pub fn faces_of(&self, tile: usize) -> &[u32] {
        &self.faces[self.starts[tile] as usize..self.starts[tile + 1] as usize]
    }
}

/// Sorts values by their keys, in their order. `starts`: the first value of each key, then the end of the last.
fn counting_sort<T: Copy + Default>(
    values: impl Iterator<Item = (usize, T)> + Clone,
    starts: &mut [u32],
    sorted: &mut Vec<T>,
) {
    starts.fill(0);
    for (key, _) in values.clone() {
        starts[key + 1] += 1;
    }
    for key in 1..starts.len() {
        starts[key] += starts[key - 1];
    }
    sorted.resize(starts.last().map_or(0, |end| *end as usize), T::default());
    for (key, value) in values {
        sorted[starts[key] as usize] = value;
        starts[key] += 1;
    }
    // Each has become the one behind it.
    starts.copy_within(..starts.len() - 1, 1);
    starts[0] = 0;
}

/// Pixels whose centres lie in the boxes of the parts of a face in front of the eye and behind it: x0, y0, x1, y1 (exclusive). A corner is
/// (x z, y z, z), of which x z and y z are rounded by `rounding` at most.
fn boxes(corners: [[f64; 3]; 3], rounding: f64, size: [usize; 2]) -> [Option<[usize; 4]>; 2] {
    let largest = corners.iter().fold(0.0, |largest: f64, [_, _, z]| largest.max(z.abs()));
    // Nearer to the eye positions leave the range of numbers.
    let least = EYE_CUT * largest;
    let (mut front, mut behind, mut beside) = (Bounds::NONE, Bounds::NONE, Bounds::NONE);
    for (k, &a) in corners.iter().enumerate() {
        let b = corners[(k + 1) % 3];
        match a[2] {
            z if z > least => front.add_position(a, rounding),
            z if z < -least => behind.add_position(a, rounding),
            _ => beside.add([a[0], a[1]], rounding),
        }
        for (bounds, z) in [(&mut front, least), (&mut behind, -least)] {
            if (a[2] > z) != (b[2] > z) {
                let share = (z - a[2]) / (b[2] - a[2]);
                let [x, y] = [0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis]));
                bounds.add_position([x, y, z], rounding);
                beside.add([x, y], rounding);
            }
        }
    }
    // A face that comes as near to the eye may be met by any ray.
    if beside.is_near_zero(least * size[0].max(size[1]) as f64) {
        return [Some([0, 0, size[0], size[1]]), None];
    }
    [front.pixels(size), behind.pixels(size)]
}

struct Bounds {
    low: [f64; 2],
    high: [f64; 2],
}

impl Bounds {
    const NONE: Bounds = Bounds { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };

    fn add(&mut self, at: [f64; 2], slack: f64) {
        for (axis, at) in at.into_iter().enumerate() {
            self.low[axis] = self.low[axis].min(at - slack);
            self.high[axis] = self.high[axis].max(at + slack);
        }
    }

    /// Adds the position on the screen of a corner (x z, y z, z).
    fn add_position(&mut self, [x, y, z]: [f64; 3], rounding: f64) {
        self.add([x / z, y / z], BOUNDARY_SLACK + rounding / z.abs());
    }

    /// True if they come as near to 0 on both axes as `distance`.
    fn is_near_zero(&self, distance: f64) -> bool {
        (0..2).all(|axis| self.low[axis] <= distance && -distance <= self.high[axis])
    }

    /// Pixels whose centres lie within.
    fn pixels(&self, size: [usize; 2]) -> Option<[usize; 4]> {
        let within = |axis: usize| {
            // A cast from float saturates.
            let from = self.low[axis].ceil().max(0.0) as usize;
            let to = ((self.high[axis].floor() + 1.0).max(0.0) as usize).min(size[axis]);
            (from < to).then_some([from, to])
        };
        let ([x0, x1], [y0, y1]) = (within(0)?, within(1)?);
        Some([x0, y0, x1, y1])
    }
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Entry {
    /// Depth (steps).
    pub depth: u32,
    /// Number of the boundary face.
    pub face: u32,
}

/// Boundary faces by which the rays of a tile enter and exit.
#[derive(Debug)]
pub(crate) struct BoundaryHits {
    /// Entries in the order of faces, with the pixels.
    unsorted: Vec<(u8, Entry)>,
    /// First entry of each pixel; then the end of the last.
    starts: [u32; PIXELS + 1],
    /// Entries pixel by pixel, by depth.
    entries: Vec<Entry>,
    /// Sum of the numbers of the half-faces by which each pixel's ray exits, each with [`EXIT_FLAG`].
    pub(super) exit_checksum: [u32; PIXELS],
}

impl Default for BoundaryHits {
    fn default() -> BoundaryHits {
        BoundaryHits {
            unsorted: Vec::new(),
            starts: [0; PIXELS + 1],
            entries: Vec::new(),
            exit_checksum: [0; PIXELS],
        }
    }
}

impl BoundaryHits {
    pub fn find(&mut self, caster: &RayCaster, lanes: LaneSet, rect: TileRect) {
        self.unsorted.clear();
        self.exit_checksum = [0; PIXELS];
        let BoundaryHits { unsorted, exit_checksum, .. } = self;
        dispatch(lanes, FindHits { caster, rect, unsorted, exit_checksum });
        let by_pixel = self.unsorted.iter().map(|(pixel, entry)| (usize::from(*pixel), *entry));
        counting_sort(by_pixel, &mut self.starts, &mut self.entries);
        for pixel in 0..PIXELS {
            self.entries[self.starts[pixel] as usize..self.starts[pixel + 1] as usize].sort_unstable();
        }
    }

    /// Entries of a pixel's ray, the nearest first.
    pub(super) fn entries_of(&self, pixel: usize) -> &[Entry] {
        &self.entries[self.starts[pixel] as usize..self.starts[pixel + 1] as usize]
    }
}

struct FindHits<'a> {
    caster: &'a RayCaster,
    rect: TileRect,
    unsorted: &'a mut Vec<(u8, Entry)>,
    exit_checksum: &'a mut [u32; PIXELS],
}

impl Kernel for FindHits<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self) {
        let FindHits { caster, rect, unsorted, exit_checksum } = self;
        let TileRect { tile, left, top, size } = rect;
        let points = &caster.points;
        let Points { pixel_bits: bits, pixel, ray_spacing, ray_spread, .. } = *points;
        for &number in caster.boundary.faces_of(tile) {
            let face = caster.half_faces.boundary[number as usize];
            let corner = |k: usize| {
                let [x, y, depth, _] = points.quads[0][face.corners[k] as usize];
                [x.to_bits(), y.to_bits(), depth.to_bits()]
            };
            let corners = [corner(0), corner(1), corner(2)];
            // From the tile's first row, in whole rows.
            let tile_top = (top << bits) as u32;
            let row_of = |k: usize| i64::from(corners[k][1].wrapping_sub(tile_top) as i32) >> bits;
            let (a, b, c) = (row_of(0), row_of(1), row_of(2));
            let [first, last] = if ray_spread == 0 {
                [a.min(b).min(c), a.max(b).max(c) + 1]
                    .map(inlined!(|row: i64| row.clamp(0, size[1] as i64) as usize))
            } else {
                [0, size[1]]
            };
            for row in first..last {
                for half in (0..size[0]).step_by(L::WIDTH) {
                    let column = L::U::iota() + L::U::splat((left + half) as u32);
                    let spacing = L::U::splat(ray_spacing);
                    let of_ray = [column, L::U::splat((top + row) as u32)];
                    let at: [Offset<L>; 3] = array!(|k| {
                        let scaled = inlined!(|axis: usize| {
                            let mut position = L::U::splat(corners[k][axis]) - of_ray[axis] * spacing;
                            if ray_spread != 0 {
                                let spread = of_ray[axis] * L::U::splat(ray_spread);
                                let moved = moved_by_depth::<L>(L::U::splat(corners[k][2]), spread);
                                position = position - moved;
                            }
                            position.to_float() * L::F::splat(pixel)
                        });
                        [scaled(0), scaled(1)]
                    });
                    let edges = [[at[0], at[1]], [at[1], at[2]], [at[2], at[0]]];
                    let functions = [
                        edge_function::<L>(at[0], at[1]),
                        edge_function::<L>(at[1], at[2]),
                        edge_function::<L>(at[2], at[0]),
                    ];
                    let valid = u32::MAX >> (32 - L::WIDTH.min(size[0] - half));
                    let (side_0, side_1, side_2) = edges_inside::<L>(functions, edges, mask_of::<L>(valid));
                    let mut in_by = side_0.and(side_1).and(side_2).bits() & valid;
                    let out_by = side_0.or(side_1).or(side_2).not();
                    let first = row * TILE + half;
                    if out_by.bits() & valid != 0 {
                        let of_half = &mut exit_checksum[first..];
                        let (sum, more) = (L::U::load(of_half), L::U::splat(EXIT_FLAG | face.half_face));
                        let out_by = mask_of::<L>(out_by.bits() & valid);
                        (sum + L::U::select(out_by, more, L::U::splat(0))).store(of_half);
                    }
                    if in_by == 0 {
                        continue;
                    }
                    let depth = array!(|k| L::U::splat(corners[k][2]));
                    let mut depths = [0; MAX_LANES];
                    FacePoint::<L>::new(points, array!(|k| functions[k].abs()), depth)
                        .depth
                        .store(&mut depths);
                    while in_by != 0 {
                        let lane = in_by.trailing_zeros() as usize;
                        unsorted.push(((first + lane) as u8, Entry { depth: depths[lane], face: number }));
                        in_by &= in_by - 1;
                    }
                }
            }
        }
    }
}
