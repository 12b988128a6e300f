//! The lists of a tile against compositing in 64 bits, for every number of segments and on every lane set.

use crate::composite::growing_lists::GrowingLists;
use crate::composite::kernels::Blend;
use crate::composite::lists::{DEPTH, Layer, Lists};
use crate::project::record::TILE;
use voltet_lanes::{LaneSet, dispatch};

const PIXELS: usize = TILE * TILE;

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
fn segments(count: usize, place: Place, random: &mut Random) -> Vec<Layer> {
    let mut layers: Vec<Layer> = (0..count)
        .map(|k| {
            let [entry, exit] = place(k, random);
            Layer::new(entry, exit, [0.0; 4])
        })
        .collect();
    for _ in 0..VISIBLE.min(count) {
        let color = [random.unit(), random.unit(), random.unit()].map(|c| c * OPACITY);
        layers[random.below(count)].rgba = [color[0], color[1], color[2], OPACITY];
    }
    layers
}

fn shuffled(layers: &[Layer], random: &mut Random) -> Vec<Layer> {
    let mut layers = layers.to_vec();
    for k in (1..layers.len()).rev() {
        layers.swap(k, random.below(k + 1));
    }
    layers
}

fn blended(layers: &[Layer]) -> [f64; 4] {
    let mut sum = [0.0; 4];
    for layer in layers {
        let through = 1.0 - sum[3];
        for (sum, c) in sum.iter_mut().zip(layer.rgba) {
            *sum += through * f64::from(c);
        }
    }
    sum
}

/// Composites on each lane set that the processor has; `pixels` holds the segments in the order of arrival.
fn composited(pixels: &[Vec<Layer>], sorted: bool, mut check: impl FnMut(&str, &[[f32; 4]], u64)) {
    for lanes in LaneSet::ALL {
        if !lanes.is_supported() {
            continue;
        }
        let mut lists = Lists::new();
        for (pixel, layers) in pixels.iter().enumerate() {
            for &layer in layers {
                assert!(lists.push(pixel, layer).is_ok());
            }
        }
        let mut picture = [[f32::NAN; 4]; PIXELS];
        let disordered =
            dispatch(lanes, Blend { lists: &mut lists, sorted, picture: &mut picture, resolve: None });
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
    let most = if cfg!(miri) { 20 } else { DEPTH };
    let step = if cfg!(miri) { 3 } else { 1 };
    (0..=most)
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
        let mut lists = GrowingLists::default();
        let rows: Vec<_> = (0..TILE).map(|k| segments(longer * k, place, &mut random)).collect();
        for (column, layers) in rows.iter().enumerate() {
            shuffled(layers, &mut random).into_iter().for_each(|layer| lists.push(column, layer));
        }
        let mut out = [[f32::NAN; 4]; TILE];
        assert_eq!(lists.composite(true, &mut out), 0);
        for (found, layers) in out.iter().zip(&rows) {
            assert_near(*found, blended(layers), &format!("{} segments", layers.len()));
        }
    }
}

/// What shines through 16 segments that leave 3e-11 is seen; where less than 1e-11 is left the list ends.
#[test]
fn lists_end_where_next_to_nothing_is_seen() {
    for (left, seen) in [(3e-11, 0.3), (1e-12, 0.0)] {
        let opacity = (1.0 - f64::powf(left, 1.0 / 16.0)) as f32;
        let wall = (0..16).map(|k| Layer::new(k as f32, k as f32 + 1.0, [0.0, 0.0, 0.0, opacity]));
        let layers: Vec<Layer> = wall.chain([Layer::new(16.0, 17.0, [1e10, 0.0, 0.0, 0.5])]).collect();
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
        let wrong = |layers: &&Vec<Layer>| layers.windows(2).any(|pair| pair[1].entry < pair[0].entry);
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
    let mut lists = Lists::new();
    let layer = |k: usize| Layer::new(k as f32, k as f32 + 1.0, [0.0; 4]);
    for k in 0..DEPTH {
        assert!(lists.push(17, layer(k)).is_ok());
    }
    assert!(lists.push(17, Layer::new(-1.0, 0.0, [1.0; 4])).is_err());
    assert!(lists.push(18, Layer::new(0.0, 1.0, [0.25, 0.5, 0.75, 1.0])).is_ok());
    let mut picture = [[f32::NAN; 4]; PIXELS];
    dispatch(
        LaneSet::detect().unwrap(),
        Blend { lists: &mut lists, sorted: true, picture: &mut picture, resolve: None },
    );
    assert_eq!([picture[17], picture[18], picture[19]], [[0.0; 4], [0.25, 0.5, 0.75, 1.0], [0.0; 4]]);
    lists.clear();
    dispatch(
        LaneSet::detect().unwrap(),
        Blend { lists: &mut lists, sorted: true, picture: &mut picture, resolve: None },
    );
    assert!(picture.iter().all(|pixel| *pixel == [0.0; 4]));
}
