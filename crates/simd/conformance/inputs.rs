//! Rows of awkward numbers, one for each lane.

/// Inputs of one lane.
#[derive(Clone, Copy)]
pub(super) struct Row {
    pub a: f32,
    pub b: f32,
    pub c: f32,
    pub i: u32,
    pub j: u32,
    pub h: u16,
    pub p: f64,
    pub q: f64,
    pub r: f64,
}

/// Every pair of awkward numbers, with others beside them. Deterministic.
pub(super) fn rows() -> Vec<Row> {
    let two = |power: i32| 2f32.powi(power);
    let positive = [
        0.0,
        1.0,
        0.3,
        0.5,
        0.5 - two(-25),
        0.5 + two(-24),
        1.5,
        2.5,
        3.0,
        1e-3,
        255.0,
        1e6,
        two(22) + 0.5,
        two(23) - 0.5,
        two(23),
        two(24) + 2.0,
        two(31),
        two(31) - 128.0,
        two(32),
        1e-30,
        f32::MIN_POSITIVE,
        1e-45,
        f32::MAX,
        f32::INFINITY,
        f32::NAN,
    ];
    let floats: Vec<f32> = positive.iter().flat_map(|&x| [x, -x]).collect();
    let two = |power: i32| 2f64.powi(power);
    let more = [
        0.5 - two(-54),
        two(51) + 0.5,
        two(52) - 0.5,
        two(52) + 1.0,
        two(53),
        1.0 + two(-24),
        1.0 + two(-25),
        1e300,
        1e-310,
    ];
    let doubles: Vec<f64> =
        floats.iter().map(|&x| f64::from(x)).chain(more.iter().flat_map(|&x| [x, -x])).collect();
    let integers = [
        0,
        1,
        2,
        3,
        7,
        255,
        256,
        999,
        1000,
        0x7fff,
        0xffff,
        0x7fff_ffff,
        0x8000_0000,
        0x8000_0001,
        u32::MAX - 1,
        u32::MAX,
    ];
    let mut state = 1u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 32) as u32
    };
    // Interpreted, a test has time for fewer.
    let step = if cfg!(miri) { 61 } else { 1 };
    (0..floats.len() * floats.len())
        .step_by(step)
        .map(|k| {
            let mut any = |of: &[f64]| of[random() as usize % of.len()];
            let (p, q, r) = (any(&doubles), any(&doubles), any(&doubles));
            let c = if random() % 4 == 0 {
                f32::from_bits(random())
            } else {
                floats[random() as usize % floats.len()]
            };
            let mut whole =
                || if random() % 4 == 0 { random() } else { integers[random() as usize % integers.len()] };
            let (i, j) = (whole(), whole());
            Row {
                a: floats[k / floats.len()],
                b: floats[k % floats.len()],
                c,
                i,
                j,
                h: (i ^ j) as u16,
                p,
                q,
                r,
            }
        })
        .collect()
}

/// The rows in vectors of a width, each in every lane.
pub(super) fn vectors(width: usize) -> Vec<Vec<Row>> {
    let rows = rows();
    let shifts = if cfg!(miri) { 1 } else { width };
    let mut vectors = Vec::new();
    for shift in 0..shifts {
        let shifted: Vec<Row> = rows.iter().cycle().skip(shift).take(rows.len()).copied().collect();
        vectors.extend(shifted.chunks_exact(width).map(<[Row]>::to_vec));
    }
    vectors
}
