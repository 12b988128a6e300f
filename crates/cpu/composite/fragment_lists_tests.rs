//! The lists of a tile against compositing in 64 bits, for every number of segments and on every lane set.

use crate::composite::accumulators::{Fragment, TileAccumulator, UnboundedFragmentLists};
use crate::composite::fragment_lists::{Arrange, Fill, FragmentLists};
use crate::composite::row_shader::blend_by_numbers;
use crate::fragments::batch::{BATCH, Batch};
use crate::fragments::spans::MAX_LIST_LENGTH;
use crate::tile::{PIXELS, TILE};
use voltet_simd::{LaneSet, dispatch};

/// Visible segments of a pixel; the others are clear, so that a wrong order shows at any depth.
const VISIBLE: usize = 8;
const OPACITY: f32 = 0.5;

/// Two roundings for each visible segment, and one of its colour.
const TOLERANCE: f64 = 3.0 * VISIBLE as f64 / (1 << 24) as f64;

/// Deterministic numbers.
struct Random(u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % limit
    }

    fn unit(&mut self) -> f32 {
        self.below(1 << 20) as f32 / (1 << 20) as f32
    }
}

/// Entry and exit of segment k, which lies in front of segment k + 1.
type Place = fn(usize, &mut Random) -> [f32; 2];

/// Evenly placed, with room between entries.
fn even(k: usize, random: &mut Random) -> [f32; 2] {
    let entry = 10.0 + 0.125 * (k as f32 + 0.3 * random.unit());
    [entry, entry + 0.125]
}

/// Each a fiftieth farther than the one before: most share a level of the keys with many others.
fn growing(k: usize, random: &mut Random) -> [f32; 2] {
    let entry = 1.02f64.powf(k as f64 + 0.3 * f64::from(random.unit())) as f32;
    [entry, entry * 1.02]
}

/// Pairs that enter through one face, found twice with other roundings; the one that ends first comes first.
fn paired(k: usize, random: &mut Random) -> [f32; 2] {
    let face = 1000.0 + 2.0 * (k / 2) as f32;
    [face + (random.unit() - 0.5) * 1e-4, face + if k.is_multiple_of(2) { 0.5 } else { 1.0 }]
}

/// Entries a millionth apart, three times what may be rounding, of cells that overlap: the exits come in the other order.
fn close(k: usize, _: &mut Random) -> [f32; 2] {
    [100.0 + 1e-4 * k as f32, 200.0 - 0.05 * k as f32]
}

/// Two segments enter at each depth.
fn doubled(k: usize, _: &mut Random) -> [f32; 2] {
    [(k / 2) as f32, (k / 2) as f32 + 1.0]
}

/// Segments of one pixel, front to back.
fn segments(count: usize, place: Place, random: &mut Random) -> Vec<Fragment> {
    let mut layers: Vec<Fragment> = (0..count)
        .map(|k| {
            let [entry, exit] = place(k, random);
            Fragment::new(entry, exit, [0.0; 4])
        })
        .collect();
    for _ in 0..VISIBLE.min(count) {
        let color = [random.unit(), random.unit(), random.unit()].map(|c| c * OPACITY);
        layers[random.below(count)].rgba = [color[0], color[1], color[2], OPACITY];
    }
    layers
}

fn shuffled(layers: &[Fragment], random: &mut Random) -> Vec<Fragment> {
    let mut layers = layers.to_vec();
    for k in (1..layers.len()).rev() {
        layers.swap(k, random.below(k + 1));
    }
    layers
}

fn blended(layers: &[Fragment]) -> [f64; 4] {
    let mut sum = [0.0; 4];
    for layer in layers {
        let through = 1.0 - sum[3];
        for (sum, c) in sum.iter_mut().zip(layer.rgba) {
            *sum += through * f64::from(c);
        }
    }
    sum
}

/// Lists of pixels' segments in the order of arrival; in place of attributes they have numbers, by which their colours are found in the
/// second.
fn listed(pixels: &[Vec<Fragment>]) -> (FragmentLists, Vec<[f32; 4]>) {
    let (mut lists, mut rgba) = (FragmentLists::default(), Vec::new());
    lists.clear(1);
    for (pixel, layers) in pixels.iter().enumerate() {
        for layer in layers {
            let number = f32::from_bits(rgba.len() as u32);
            let length = layer.exit - layer.entry;
            // Each is a segment, whatever its depths are.
            let length = if length > 0.0 { length } else { f32::MAX };
            assert!(lists.push(pixel, [layer.entry, length], [[number; 2]]).is_ok());
            rgba.push(layer.rgba);
        }
    }
    (lists, rgba)
}

fn supported() -> impl Iterator<Item = LaneSet> {
    LaneSet::ALL.into_iter().filter(|lanes| lanes.is_supported())
}

fn picture_of(
    lanes: LaneSet,
    lists: &mut FragmentLists,
    sorted: bool,
    rgba: &[[f32; 4]],
) -> ([[f32; 4]; PIXELS], u64) {
    let (mut pixels, mut picture) = (TileAccumulator::new(), [[f32::NAN; 4]; PIXELS]);
    let disordered = blend_by_numbers(lanes, lists, sorted, rgba, &mut pixels);
    pixels.store(&mut picture);
    (picture, disordered)
}

/// Composites on each lane set that the processor has; `pixels` holds the segments in the order of arrival.
fn composited(pixels: &[Vec<Fragment>], sorted: bool, mut check: impl FnMut(&str, &[[f32; 4]], u64)) {
    for lanes in supported() {
        let (mut lists, rgba) = listed(pixels);
        let (picture, disordered) = picture_of(lanes, &mut lists, sorted, &rgba);
        check(lanes.name(), &picture, disordered);
    }
}

fn assert_near(found: [f32; 4], expected: [f64; 4], what: &str) {
    for (found, expected) in found.into_iter().zip(expected) {
        assert!((f64::from(found) - expected).abs() <= TOLERANCE, "{found} for {expected}: {what}");
    }
}

/// Numbers of segments, a tile's pixels at a time.
fn tiles() -> impl Iterator<Item = Vec<usize>> {
    // Interpreted, a test has time for short lists.
    let max = if cfg!(miri) { 20 } else { MAX_LIST_LENGTH };
    let step = if cfg!(miri) { 3 } else { 1 };
    (0..=max)
        .step_by(step)
        .collect::<Vec<_>>()
        .chunks(PIXELS)
        .map(<[usize]>::to_vec)
        .collect::<Vec<_>>()
        .into_iter()
}

#[test]
fn every_number_of_segments_is_put_in_order() {
    for place in [even as Place, growing, paired, close] {
        for (tile, counts) in tiles().enumerate() {
            let mut random = Random(tile as u64);
            let ordered: Vec<_> = counts.iter().map(|&count| segments(count, place, &mut random)).collect();
            let arrived: Vec<_> = ordered.iter().map(|layers| shuffled(layers, &mut random)).collect();
            composited(&arrived, true, |lanes, picture, disordered| {
                assert_eq!(disordered, 0);
                for (found, layers) in picture.iter().zip(&ordered) {
                    assert_near(*found, blended(layers), &format!("{} segments on {lanes}", layers.len()));
                }
            });
        }
    }
}

/// Lists that grow keep the same order, beyond what the others hold.
#[test]
#[cfg_attr(miri, ignore = "thousands of segments take it minutes")]
fn rows_of_any_number_of_segments_are_put_in_order() {
    // Short ones, too: among thousands of segments few of those that are seen are neighbours.
    for (place, longer) in
        [even as Place, paired, close].into_iter().flat_map(|place| [(place, 1), (place, 190)])
    {
        let mut random = Random(7);
        let mut lists = UnboundedFragmentLists::default();
        let pixels: Vec<_> = (0..TILE).map(|k| segments(longer * k, place, &mut random)).collect();
        for (column, layers) in pixels.iter().enumerate() {
            shuffled(layers, &mut random).into_iter().for_each(|layer| lists.push(column, layer));
        }
        let mut out = [[f32::NAN; 4]; TILE];
        assert_eq!(lists.composite(true, &mut out), 0);
        for (found, layers) in out.iter().zip(&pixels) {
            assert_near(*found, blended(layers), &format!("{} segments", layers.len()));
        }
    }
}

/// A light behind 16 segments that leave 3e-11 is visible; the list ends where less than 1e-11 is left.
#[test]
fn lists_end_where_next_to_nothing_is_seen() {
    for (left, seen) in [(3e-11, 0.3), (1e-12, 0.0)] {
        let opacity = (1.0 - f64::powf(left, 1.0 / 16.0)) as f32;
        let wall = (0..16).map(|k| Fragment::new(k as f32, k as f32 + 1.0, [0.0, 0.0, 0.0, opacity]));
        let layers: Vec<Fragment> = wall.chain([Fragment::new(16.0, 17.0, [1e10, 0.0, 0.0, 0.5])]).collect();
        composited(&vec![layers; PIXELS], true, |lanes, picture, _| {
            for pixel in picture {
                // 16 roundings of what is left, each many times of it.
                assert!((f64::from(pixel[0]) - seen).abs() < 1e-3, "{} for {seen} on {lanes}", pixel[0]);
            }
        });
    }
}

#[test]
fn without_sorting_segments_stay_as_they_came_and_those_out_of_order_are_counted() {
    for (tile, counts) in tiles().enumerate() {
        let mut random = Random(tile as u64);
        let arrived: Vec<_> = counts
            .iter()
            .map(|&count| {
                let layers = segments(count, doubled, &mut random);
                if count % 2 == 0 { layers } else { shuffled(&layers, &mut random) }
            })
            .collect();
        let wrong = |layers: &&Vec<Fragment>| layers.windows(2).any(|pair| pair[1].entry < pair[0].entry);
        let expected = arrived.iter().filter(wrong).count() as u64;
        composited(&arrived, false, |lanes, picture, disordered| {
            assert_eq!(disordered, expected, "{lanes}");
            for (found, layers) in picture.iter().zip(&arrived) {
                assert_near(*found, blended(layers), lanes);
            }
        });
    }
}

/// Depths that are no numbers may come in any order; but each segment is taken once, and no other pixel changes.
#[test]
fn depths_that_are_no_numbers_spoil_nothing() {
    let awkward = [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, -0.0, 1e-45];
    for (tile, counts) in tiles().enumerate() {
        let mut random = Random(tile as u64);
        let spoiled = |pixel: usize| pixel.is_multiple_of(3);
        let mut pixels: Vec<_> = counts.iter().map(|&count| segments(count, even, &mut random)).collect();
        for layers in pixels.iter_mut().step_by(3) {
            for layer in layers.iter_mut() {
                match random.below(4) {
                    0 => layer.entry = awkward[random.below(awkward.len())],
                    1 => layer.exit = awkward[random.below(awkward.len())],
                    _ => {}
                }
            }
        }
        let arrived: Vec<_> = pixels.iter().map(|layers| shuffled(layers, &mut random)).collect();
        composited(&arrived, true, |lanes, picture, _| {
            for (pixel, (found, layers)) in picture.iter().zip(&pixels).enumerate() {
                let expected = blended(layers);
                // Powers of one half: exact in any order.
                assert_eq!(f64::from(found[3]), expected[3], "{} segments on {lanes}", layers.len());
                if !spoiled(pixel) {
                    assert_near(*found, expected, lanes);
                }
            }
        });
    }
}

#[test]
#[cfg_attr(miri, ignore = "a thousand segments take it minutes")]
fn a_full_list_refuses_and_keeps_what_it_has() {
    let lanes = LaneSet::detect().unwrap();
    let mut lists = FragmentLists::default();
    lists.clear(1);
    let numbered = |number: u32| [[f32::from_bits(number); 2]];
    let rgba = [[0.0; 4], [1.0; 4], [0.25, 0.5, 0.75, 1.0]];
    for k in 0..MAX_LIST_LENGTH {
        assert!(lists.push(17, [k as f32, 1.0], numbered(0)).is_ok());
    }
    assert!(!lists.is_over_full());
    assert!(lists.push(17, [-1.0, 1.0], numbered(1)).is_err());
    assert!(lists.push(18, [0.0, 1.0], numbered(2)).is_ok());
    let (picture, _) = picture_of(lanes, &mut lists, true, &rgba);
    assert_eq!([picture[17], picture[18], picture[19]], [[0.0; 4], [0.25, 0.5, 0.75, 1.0], [0.0; 4]]);
    lists.next.0[17] += 1;
    assert!(lists.is_over_full());
    lists.clear(1);
    let (picture, _) = picture_of(lanes, &mut lists, true, &rgba);
    assert!(picture.iter().all(|pixel| *pixel == [0.0; 4]));
}

/// A batch gets the next segments of all pixels of a row in order, with every attribute at both ends; pixels that have no further one
/// get fragments of no length.
#[test]
fn a_batch_gets_every_attribute_in_order() {
    for (lanes, attributes) in supported().flat_map(|lanes| [1, 2, 3, 4].map(|count| (lanes, count))) {
        let mut random = Random(attributes as u64);
        let mut lists = FragmentLists::default();
        lists.clear(attributes);
        let row = 5;
        // Segment k of a pixel is from k to k + 1; pixel x has 3 x of them.
        let ends = |x: usize, k: usize| (0..attributes).map(move |a| [(100 * x + k) as f32, a as f32]);
        for x in 0..TILE {
            let mut order: Vec<usize> = (0..3 * x).collect();
            (1..order.len()).for_each(|k| order.swap(k, random.below(k + 1)));
            for k in order {
                assert!(lists.push(row * TILE + x, [k as f32, 1.0], ends(x, k)).is_ok());
            }
        }
        dispatch(lanes, Arrange { lists: &mut lists, row, sorted: true });
        let (mut counts, mut batch) = ([0; TILE], Batch::new(attributes, attributes));
        for first in (0..lists.max_length(row)).step_by(BATCH / TILE) {
            let slices = first..(first + BATCH / TILE).min(lists.max_length(row));
            let count = slices.len() * TILE;
            let length_per_depth = &[2.0; PIXELS];
            dispatch(
                lanes,
                Fill { lists: &lists, row, slices, length_per_depth, depths: true, batch: &mut batch },
            );
            for k in (0..count).filter(|&k| batch.length[k] > 0.0) {
                let x = k % TILE;
                assert_eq!((batch.pixel[k] as usize, batch.length[k]), (row * TILE + x, 2.0));
                assert_eq!((batch.entry[k], batch.exit[k]), (counts[x] as f32, counts[x] as f32 + 1.0));
                for (a, end) in ends(x, counts[x]).enumerate() {
                    let values = [batch.front[a][k], batch.back[a][k]];
                    assert_eq!(values, end, "attribute {a} on {}", lanes.name());
                }
                counts[x] += 1;
            }
        }
        assert_eq!(counts, std::array::from_fn(|x| 3 * x));
    }
}
