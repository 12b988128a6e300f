//! Ray segments drawn by lot over the unit square, and widgets of every kind for them: what integrators are held to, on lanes and on
//! devices.

use std::sync::Arc;
use voltet_core::transfer::{
    ControlPoint, OpticalModel, Profile, Region, Table, TransferFunction, Wave, Widget,
};
use voltet_optics::Segment;

/// Numbers in [0, 1) that 32 bits hold: SplitMix64 (Steele, Lea & Flood 2014).
pub struct Numbers(pub u64);

impl Numbers {
    /// The next one.
    #[allow(clippy::should_implement_trait, reason = "it never ends")]
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        f64::from((((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64) as f32)
    }
}

/// Segments over the unit square, of lengths up to `longest`; every eighth flat in s, in g or in both. The first spans what all do.
pub fn segments(count: usize, longest: f64) -> Vec<Segment<'static>> {
    let mut numbers = Numbers(7);
    let mut segment = |i: usize| {
        let [front, mut back] = [[numbers.next(), numbers.next()], [numbers.next(), numbers.next()]];
        for (axis, back) in back.iter_mut().enumerate() {
            if i.is_multiple_of(8) && (i / 8) % 3 != axis {
                *back = front[axis];
            }
        }
        let length = numbers.next() * longest;
        let whole = ([0.0; 2], [1.0; 2], longest);
        let (front, back, length) = if i == 0 { whole } else { (front, back, length) };
        Segment { length, front, back, fields_front: &[], fields_back: &[] }
    };
    (0..count).map(&mut segment).collect()
}

/// Both optical models.
pub const MODELS: [OpticalModel; 2] =
    [OpticalModel::DensityEmitter, OpticalModel::ConstantEmitter { cutoff: 0.25 }];

/// A widget without a region.
pub fn widget(profile: Profile, color: [f64; 3], extinction: f64) -> Widget {
    Widget { profile, color, extinction, region: None }
}

/// Widgets whose extinctions are those of a unit of length.
pub fn look(model: OpticalModel, widgets: Vec<Widget>) -> TransferFunction {
    TransferFunction { model, unit_distance: 1.0, widgets, axes: Default::default() }
}

/// A table widget of any texels.
pub fn image(width: usize, height: usize) -> Widget {
    let mut numbers = Numbers((width * 100 + height) as u64);
    let texels = (0..width * height).map(|_| std::array::from_fn(|_| numbers.next() as f32)).collect();
    let table = Table { width, height, texels, s: [0.125, 0.875], g: [0.0, 0.75] };
    widget(Profile::Table(Arc::new(table)), [0.0; 3], 3.0)
}

/// A uniform widget within a triangle.
pub fn uniform(extinction: f64) -> Widget {
    let region = Region { corners: vec![[0.2, 0.0], [1.0, 0.3], [0.3, 1.0]] };
    Widget { region: Some(region), ..widget(Profile::Uniform, [0.1, 0.2, 1.0], extinction) }
}

/// A Gaussian about s whose axes are not those of the plane.
pub fn gaussian(s: f64, color: [f64; 3], extinction: f64) -> Widget {
    widget(Profile::Gaussian { centre: [s, 0.5], matrix: [[6.0, 1.0], [0.0, 3.0]] }, color, extinction)
}

/// A triangular Gaussian.
pub fn triangular(extinction: f64) -> Widget {
    widget(Profile::TriangularGaussian { centre: 0.5, sigma: 0.4 }, [0.2, 1.0, 0.5], extinction)
}

/// One to three widgets, of every kind.
pub fn overlapping(extinction: f64) -> Vec<Vec<Widget>> {
    let wave = Wave { origin: [0.1, 0.2], angle: 0.4, scale: [1.0; 2], period: 0.3, band_width: 0.6 };
    let point = |s, extinction, r| ControlPoint { s, color: [r, 0.5, 0.1], extinction };
    let points =
        vec![point(0.0, 0.0, 1.0), point(0.5, 2.0 * extinction, 0.2), point(1.0, 0.5 * extinction, 0.4)];
    let linear = widget(Profile::PiecewiseLinear { points }, [0.0; 3], 1.0);
    let triangular = triangular(extinction);
    let red = gaussian(0.4, [1.0, 0.1, 0.0], extinction);
    let blue = gaussian(0.6, [0.0, 0.3, 1.2], 0.7 * extinction);
    let sine = widget(Profile::SineWave(wave), [0.9, 0.8, 0.1], extinction);
    let triangle = widget(Profile::TriangleWave(wave), [0.0, 0.8, 0.6], extinction);
    vec![
        vec![red.clone(), blue.clone()],
        vec![red.clone(), uniform(extinction), triangular.clone()],
        vec![blue.clone(), sine],
        vec![triangle, linear.clone(), red],
        vec![linear, triangular.clone()],
        vec![Widget { extinction, ..image(5, 4) }, blue],
        vec![triangular],
        vec![Widget { extinction, ..image(3, 5) }],
    ]
}
