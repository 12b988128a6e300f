//! The table of twins: each WGSL formula with its 64-bit truth, its range and its tolerance.

use voltet_core::transfer::{AxisScale, OpticalModel, Profile, TransferFunction, Wave, Widget};
use voltet_optics::clip::ClippedSpan;
use voltet_optics::kinds::gaussian::GaussianPath;
use voltet_optics::kinds::triangular_gaussian::TriangularPath;
use voltet_optics::kinds::wave::Bell;
use voltet_optics::shading::{Integrator, Shading};
use voltet_optics::{WidgetBlend, linear, special};
use voltet_shaders::{Axis, Parameters};
use voltet_testing::twin::{INPUTS, Range};

/// A 64-bit formula of the inputs.
type Truth = Box<dyn Fn(&[f64; INPUTS]) -> f64>;

/// A twin. The error allowed is `tolerance` ε (4 |value| + change of the truth for a relative change of the inputs by 1).
pub struct Twin {
    pub name: &'static str,
    /// The piece it is in.
    pub piece: &'static str,
    /// In terms of `x: vec4f`.
    pub expression: String,
    pub truth: Truth,
    pub inputs: &'static [Range],
    pub tolerance: f64,
    /// Reason of the tolerance.
    pub reason: &'static str,
    /// Text that fills the slots of the piece.
    pub generated: &'static str,
}

const DEPTH: Range = Range::Log(-12.0, 6.0);
const PHASE: Range = Range::Even(-30.0, 30.0);
const NEAR: Range = Range::Even(-4.0, 4.0);
const WIDTH: Range = Range::Even(0.0, 3.0);
const UNIT: Range = Range::Even(-1.0, 1.0);

/// Share of the peak above which the constant-emitter glows.
const CUTOFF: f64 = 0.01;

const TRIANGLE: &str = "
fn wave_mean_on_flank(bell: Bell, low: Spot, high: Spot) -> f32 { return triangle_mean_on_flank(bell, low, high); }
fn phase(x: f32) -> Phase { return Phase(round(x), x - round(x)); }
";
const SINE: &str = "
fn wave_mean_on_flank(bell: Bell, low: Spot, high: Spot) -> f32 { return sine_mean_on_flank(bell, low, high); }
fn phase(x: f32) -> Phase { return Phase(round(x), x - round(x)); }
";

fn wave(band_width: f64) -> Wave {
    Wave { origin: [0.0; 2], angle: 0.0, scale: [1.0; 2], period: 1.0, band_width }
}

/// The bell of a wave as a scene's parameters state it.
fn bell(profile: Profile) -> String {
    let transfer_function = TransferFunction {
        model: OpticalModel::ConstantEmitter { cutoff: CUTOFF },
        unit_distance: 1.0,
        widgets: vec![Widget { profile, color: [1.0; 3], extinction: 1.0, region: None }],
        axes: Default::default(),
    };
    let shading = Shading {
        integrator: Integrator::ANALYTIC,
        overlap: WidgetBlend::Exact,
        silhouette: None,
        light: None,
    };
    let parameters = Parameters::new(&transfer_function, &shading, &[Axis::PLAIN; 2], 1.0).expect("in range");
    let record = parameters.widgets[0];
    let [inverse, reach, half, lit] = record.bell;
    let kind = record.bell_kind;
    format!("Bell({inverse:?}, {reach:?}, {half:?}, {lit:?}, {}u, {}u)", kind & 1, kind >> 1)
}

fn twin(
    name: &'static str,
    piece: &'static str,
    expression: &str,
    inputs: &'static [Range],
    tolerance: (f64, &'static str),
    truth: impl Fn(&[f64; INPUTS]) -> f64 + 'static,
) -> Twin {
    let (tolerance, reason) = tolerance;
    let (expression, truth) = (expression.to_owned(), Box::new(truth));
    Twin { name, piece, expression, truth, inputs, tolerance, reason, generated: "" }
}

fn gaussian(x: &[f64; INPUTS]) -> GaussianPath {
    GaussianPath::new([x[0], x[1]], [x[2], x[3]], [x[2] - x[0], x[3] - x[1]])
}

fn waves(sine: bool, width: f64, peak: Option<f64>) -> Twin {
    let of = |wave: Wave| if sine { Bell::sine(&wave) } else { Bell::triangle(&wave) };
    let truth = of(wave(width));
    let profile = if sine { Profile::SineWave(wave(width)) } else { Profile::TriangleWave(wave(width)) };
    let bell = bell(profile);
    let path = move |x: &[f64; INPUTS]| truth.path([x[0], 0.0], [x[1], 0.0]);
    let generated = if sine { SINE } else { TRIANGLE };
    let made = match peak {
        None => twin(
            if sine { "sine mean" } else { "triangle mean" },
            if sine { "wave/sine" } else { "wave/triangle" },
            &format!("wave_mean({bell}, phase(x.x), phase(x.y))"),
            &[PHASE, PHASE],
            (4.0, "sums of positive areas, divided once"),
            move |x| path(x).integral(&ClippedSpan::WHOLE),
        ),
        Some(peak) => twin(
            if sine { "sine glow" } else { "triangle glow" },
            if sine { "wave/sine" } else { "wave/triangle" },
            &format!("wave_glow({bell}, phase(x.x), phase(x.y), {peak:?})"),
            &[PHASE, PHASE],
            (16.0, "a series of walks; panels of depth 2.5 leave 4e-6"),
            move |x| path(x).glow(peak, &ClippedSpan::WHOLE, CUTOFF),
        ),
    };
    Twin { generated, ..made }
}

/// Numbers of an axis whose positions are decades as they are, with 1/c = 100 where it is symmetric.
const DECADES: &str = "
fn number(index: u32) -> f32 { return select(select(0.0, 100.0, index == 6u), 0.30102999566398, index == 0u); }
";

/// Position of a value on a logarithmic axis.
fn position(
    name: &'static str,
    piece: &'static str,
    call: &str,
    scale: AxisScale,
    values: &'static [Range],
) -> Twin {
    let truth = move |x: &[f64; INPUTS]| scale.position(x[0]);
    let made = twin(name, piece, call, values, (4.0, "the logarithm's own error, in decades"), truth);
    Twin { generated: DECADES, ..made }
}

/// Triangular Gaussian of three fields, with a width of 1 at the back.
const TRIANGULAR_OF_FIELDS: &str = "fn triangular_of_fields(x: vec4f) -> f32 {
    let front = Fields(x.x, x.y, 0.3, 0.0, 0.0, 0.0, 0.0, 0.0);
    let back = Fields(x.z, -0.5, 0.7, 0.0, 0.0, 0.0, 0.0, 0.0);
    let path = triangular_fields_path(front, back, vec2f(x.w, 1.0));
    return exponential(-path.offset_squared) * triangular_gaussian_mean_profile(path.offset, path.width);
}";

/// Every twin. On the software driver each needs 2.1 ε (4 + k) at most; the rest is left to devices whose quotients err
/// by 2.5 and whose exponentials by 3 + 2|x| units in the last place, as WGSL allows.
pub fn twins() -> Vec<Twin> {
    let exponential = "elementary/exponential";
    let walk = (16.0, "walks of 8-point panels: 1e-5");
    let panels = (8.0, "up to 21 panels of 8 points: 1e-6");
    let plane = "gaussian_plane_path(x.xy, x.zw)";
    let level = -CUTOFF.ln();
    let mut twins = vec![
        twin(
            "log2",
            "axes/binary_logarithm",
            "binary_logarithm(x.x).whole + binary_logarithm(x.x).rest",
            &[Range::Log(-30.0, 30.0)],
            (4.0, "the device's own errs by 2^-21 between 1 and 2"),
            |x| x[0].log2(),
        ),
        position("log axis", "axes/log", "log_position(0u, x.x)", AxisScale::Log, &[Range::Log(-30.0, 30.0)]),
        position(
            "symlog axis",
            "axes/symlog",
            "symlog_position(0u, x.x)",
            AxisScale::SymLog { linear_below: 1e-2 },
            &[Range::Log(-1.0, 12.0)],
        ),
        twin(
            "exp",
            exponential,
            "exponential(x.x)",
            &[Range::Even(-87.0, 87.0)],
            (2.0, "3 + 2|x| ulp"),
            |x| x[0].exp(),
        ),
        twin(
            "one_minus_exp",
            "elementary/one_minus_exp",
            "one_minus_exp(x.x)",
            &[Range::Log(-30.0, 2.0)],
            (2.0, "exp and one difference"),
            |x| special::opacity(x[0]),
        ),
        twin(
            "mean_transmittance",
            "elementary/mean_transmittance",
            "mean_transmittance(x.x)",
            &[Range::Log(-30.0, 4.0)],
            (2.0, "and a quotient of 2.5 ulp"),
            |x| special::mean_transmittance(x[0]),
        ),
        twin(
            "erfcx",
            "elementary/erfcx",
            "erfcx(x.x)",
            &[Range::Log(-6.0, 6.0)],
            (2.0, "fit of 2e-7, one quotient"),
            |x| special::erfcx(x[0]),
        ),
        twin(
            "power",
            "elementary/power",
            "power(x.x, x.y)",
            &[Range::Log(-9.0, 0.0), Range::Log(-2.0, 0.9)],
            (8.0, "log2 has an absolute error of 2^-21 near 1"),
            |x| x[0].powf(x[1]),
        ),
        twin(
            "clip length",
            "clip",
            "stretch_cut(stretch_whole(), x.x, x.y).length",
            &[Range::Even(-1.0, 0.0), Range::Even(0.1, 1.0)],
            (2.0, "one quotient"),
            |x| x[1] / (x[1] - x[0]),
        ),
        twin(
            "gaussian mean, one quantity",
            "gaussian/mean_profile",
            "gaussian_mean_profile(gaussian_line_path(x.x, x.y))",
            &[NEAR, NEAR],
            (4.0, "sums of 2 erfcx and exp"),
            |x| {
                GaussianPath::new([x[0], 0.0], [x[1], 0.0], [x[1] - x[0], 0.0])
                    .optical_depth(1.0, &ClippedSpan::WHOLE)
            },
        ),
        twin(
            "gaussian mean, plane",
            "gaussian/mean_profile",
            &format!("gaussian_mean_profile({plane})"),
            &[NEAR, NEAR, NEAR, NEAR],
            (4.0, "sums of 2 erfcx and exp"),
            |x| gaussian(x).optical_depth(1.0, &ClippedSpan::WHOLE),
        ),
        twin(
            "gaussian mean, fields",
            "gaussian/mean_profile",
            "gaussian_mean_profile(gaussian_fields_path(Fields(x.x, x.y, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), \
             Fields(x.z, x.w, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)))",
            &[NEAR, NEAR, NEAR, NEAR],
            (4.0, "sums of 2 erfcx and exp"),
            |x| gaussian(x).optical_depth(1.0, &ClippedSpan::WHOLE),
        ),
        twin(
            "triangular gaussian mean",
            "triangular_gaussian/mean_profile",
            "triangular_gaussian_mean_profile(x.xy, x.zw)",
            &[NEAR, NEAR, WIDTH, WIDTH],
            (8.0, "up to 24 panels of 8 points: 1e-6"),
            |x| TriangularPath::new([x[0], x[1]], [x[2], x[3]], 1.0).optical_depth(&ClippedSpan::WHOLE),
        ),
        Twin {
            generated: TRIANGULAR_OF_FIELDS,
            ..twin(
                "triangular gaussian mean, fields",
                "triangular_gaussian/mean_profile",
                "triangular_of_fields(x)",
                &[NEAR, NEAR, NEAR, WIDTH],
                (8.0, "up to 24 panels of 8 points: 1e-6"),
                |x| {
                    let (front, back) = ([x[0], x[1], 0.3], [x[2], -0.5, 0.7]);
                    let along = [0, 1, 2].map(|i| back[i] - front[i]);
                    TriangularPath::over_fields(front, back, along, [x[3], 1.0], 1.0)
                        .optical_depth(&ClippedSpan::WHOLE)
                },
            )
        },
        twin("psi", "linear/psi", "psi(x.x, x.y)", &[DEPTH, DEPTH], panels, |x| linear::psi(x[0], x[1])),
        twin("F", "linear/front_back", "front_back(x.x, x.y).x", &[DEPTH, DEPTH], panels, |x| {
            linear::front_back(x[0], x[1]).0
        }),
        twin("B", "linear/front_back", "front_back(x.x, x.y).y", &[DEPTH, DEPTH], panels, |x| {
            linear::front_back(x[0], x[1]).1
        }),
        twin(
            "front weight",
            "linear/emission_weights",
            "emission_weights(x.x, x.y).x",
            &[DEPTH, DEPTH],
            panels,
            |x| linear::emission_weights(x[0], x[1]).0,
        ),
        twin(
            "back weight",
            "linear/emission_weights",
            "emission_weights(x.x, x.y).y",
            &[DEPTH, DEPTH],
            panels,
            |x| linear::emission_weights(x[0], x[1]).1,
        ),
        twin(
            "silhouette factor",
            "light/silhouette",
            "silhouette_factor(vec3f(x.xy, 0.5), vec3f(0.6, 0.0, 0.8), 1.0)",
            &[UNIT, UNIT],
            (16.0, "a cross product that cancels where the gradient is along the ray"),
            |x| {
                let (g, view) = (glam::DVec3::new(x[0], x[1], 0.5), glam::DVec3::new(0.6, 0.0, 0.8));
                1.0 - g.normalize().dot(view).abs()
            },
        ),
        twin(
            "diffuse factor",
            "light/diffuse",
            "diffuse_factor(vec3f(x.xy, 0.5), vec3f(0.6, 0.0, 0.8), 0.2, 0.7)",
            &[UNIT, UNIT],
            (4.0, "a dot product, one square root, one quotient"),
            |x| {
                0.2 + 0.7
                    * glam::DVec3::new(x[0], x[1], 0.5).normalize().dot(glam::DVec3::new(0.6, 0.0, 0.8)).abs()
            },
        ),
    ];
    for peak in [0.01, 300.0] {
        let expression = format!("gaussian_glow({plane}, {peak:?}, {level:?})");
        let truth = move |x: &[f64; INPUTS]| gaussian(x).glow(peak, &ClippedSpan::WHOLE, level);
        twins.push(twin(
            "gaussian glow",
            "gaussian/glow",
            &expression,
            &[NEAR, NEAR, NEAR, NEAR],
            walk,
            truth,
        ));
    }
    twins.extend([1.0, 0.01].map(|width| waves(false, width, None)));
    twins.extend([1.0, 0.3, 0.001].map(|width| waves(true, width, None)));
    twins.extend([(1.0, 3.0), (0.1, 300.0)].map(|(width, peak)| waves(false, width, Some(peak))));
    twins.extend([(1.0, 3.0), (0.1, 300.0)].map(|(width, peak)| waves(true, width, Some(peak))));
    twins
}
