//! Pre-integration in a frame buffer of few bits a channel (Roettger and Ertl 2002, section 3), beside standard numerical
//! integration.
//!
//! Symbols: m entries of the transfer function; l the length, a share of the longest; κ, ρ emission and extinction of the longest
//! length. Hardware blends n = m rectangles (Eq. 8, Figure 3): every place of a slice takes n equal steps from S_b to S_f, whose
//! colours and opacities are rounded to the bits of a channel, and so is each result. Software takes as many steps as Eq. 5 says,
//! ⌈2 m |S_f − S_b|⌉, in full precision.

/// κ by channel and ρ.
pub(super) type Material = ([f64; 3], f64);

/// A transfer function as a table of m entries, linear between them.
pub(super) struct Lookup {
    entries: Vec<Material>,
}

impl Lookup {
    /// Samples a transfer function of S ∈ [0, 1].
    pub fn new(count: usize, of: impl Fn(f64) -> Material) -> Lookup {
        Lookup { entries: (0..count).map(|k| of((k as f64 + 0.5) / count as f64)).collect() }
    }

    fn at(&self, s: f64) -> Material {
        let last = (self.entries.len() - 1) as f64;
        let place = (s * self.entries.len() as f64 - 0.5).clamp(0.0, last);
        let low = (place as usize).min(self.entries.len().saturating_sub(2));
        let share = place - low as f64;
        let (a, b) = (self.entries[low], self.entries[(low + 1).min(self.entries.len() - 1)]);
        let mix = |x: f64, y: f64| x + share * (y - x);
        ([0, 1, 2].map(|c| mix(a.0[c], b.0[c])), mix(a.1, b.1))
    }

    /// RGB and opacity by Eq. 5 to 7, as printed, with o m |S_f − S_b| steps; at least one, where Eq. 5 has none.
    pub fn software(&self, front: f64, back: f64, length: f64, oversampling: f64) -> [f64; 4] {
        let steps = oversampling * self.entries.len() as f64 * (front - back).abs();
        let count = (steps.ceil() as usize).max(1);
        self.composited(front, back, length, [count; 2], &|x| x)
    }

    /// RGB and opacity by blending `count` rectangles in a frame buffer of so many bits a channel.
    pub fn hardware(&self, front: f64, back: f64, length: f64, count: usize, bits: u32) -> [f64; 4] {
        self.blended([front, back, length], [count; 2], bits)
    }

    /// Value after the first of so many; the ends, and the length.
    pub fn blended(&self, [front, back, length]: [f64; 3], steps: [usize; 2], bits: u32) -> [f64; 4] {
        let most = f64::from((1_u32 << bits) - 1);
        self.composited(front, back, length, steps, &|x: f64| (x.clamp(0.0, 1.0) * most).round() / most)
    }

    /// From back to front, the first of so many steps; `stored`: what becomes of a number that is written.
    fn composited(
        &self,
        front: f64,
        back: f64,
        length: f64,
        [taken, count]: [usize; 2],
        stored: &dyn Fn(f64) -> f64,
    ) -> [f64; 4] {
        let step = length / count as f64;
        let mut rgba = [0.0, 0.0, 0.0, 1.0];
        for i in 0..taken {
            let share = if count > 1 { i as f64 / (count - 1) as f64 } else { 0.5 };
            let (glow, extinction) = self.at(back + share * (front - back));
            let through = 1.0 - stored(1.0 - (-step * extinction).exp());
            for (c, value) in rgba.iter_mut().enumerate() {
                let added = if c < 3 { stored(step * glow[c]) } else { 0.0 };
                *value = stored(*value * through + added);
            }
        }
        rgba[3] = 1.0 - rgba[3];
        rgba
    }

    /// Difference of hardware from software, which oversamples twice.
    pub fn of_hardware(&self, bits: u32, side: usize) -> [f64; 2] {
        let count = self.entries.len();
        deviation(side, |f, b, l| self.hardware(f, b, l, count, bits), |f, b, l| self.software(f, b, l, 2.0))
    }

    /// Difference of software that oversamples so often from one that does 64 times.
    pub fn of_oversampling(&self, oversampling: f64, side: usize) -> [f64; 2] {
        deviation(
            side,
            |f, b, l| self.software(f, b, l, oversampling),
            |f, b, l| self.software(f, b, l, 64.0),
        )
    }
}

/// Root of the mean square and largest difference of two ways over a net of S_f, S_b and eight lengths.
fn deviation(
    side: usize,
    found: impl Fn(f64, f64, f64) -> [f64; 4],
    wanted: impl Fn(f64, f64, f64) -> [f64; 4],
) -> [f64; 2] {
    let (mut sum, mut most, mut number) = (0.0, 0.0_f64, 0);
    let place = |k: usize| k as f64 / (side - 1) as f64;
    let net =
        (0..side * side * 8).map(|k| (place(k / 8 / side), place(k / 8 % side), (k % 8 + 1) as f64 / 8.0));
    for (front, back, length) in net {
        for (a, b) in found(front, back, length).into_iter().zip(wanted(front, back, length)) {
            let error = (a.clamp(0.0, 1.0) - b.clamp(0.0, 1.0)).abs();
            (sum, most, number) = (sum + error * error, most.max(error), number + 1);
        }
    }
    [(sum / f64::from(number)).sqrt(), most]
}

/// κ and ρ of the longest length, which takes half of the light.
pub(super) fn interleaved(s: f64) -> Material {
    let colors = [[0.9, 0.4, 0.05], [0.05, 0.3, 0.9]];
    let extinction = std::f64::consts::LN_2;
    (colors[(8.0 * s) as usize % 2].map(|c| c * extinction), extinction)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without variation every count of steps gives the same opacity, and in many bits light by Eq. 6 tends to (κ/ρ)(1 − e^(−ρl)).
    #[test]
    fn a_constant_function_tends_to_its_closed_form() {
        let lookup = Lookup::new(256, |_| ([0.5, 0.25, 0.0], 2.0));
        let [red, green, blue, opacity] = lookup.software(0.0, 1.0, 1.0, 2.0);
        let exact = 1.0 - (-2.0_f64).exp();
        assert!((opacity - exact).abs() < 1e-12);
        // Eq. 6 is of first order: ρ l/2n, n = 512.
        assert!((red / (0.25 * exact) - 1.0).abs() < 2.1 / 1024.0 && (green / red - 0.5).abs() < 1e-12);
        assert_eq!(blue, 0.0);
        let [red, .., opacity] = lookup.hardware(0.0, 1.0, 1.0, 256, 30);
        assert!((opacity - exact).abs() < 1e-6 && (red / (0.25 * exact) - 1.0).abs() < 2.1 / 512.0);
    }

    /// A part of the steps leaves what the whole begins with: the light at the back.
    #[test]
    fn a_part_of_the_steps_is_the_back_of_the_path() {
        let lookup = Lookup::new(64, |s| ([s, 1.0 - s, 0.0], 1.0));
        let [red, green, _, opacity] = lookup.blended([1.0, 0.0, 1.0], [32, 128], 30);
        // A quarter of the length, from S_b = 0 up to a quarter.
        assert!((opacity - (1.0 - (-0.25_f64).exp())).abs() < 1e-6, "{opacity}");
        assert!(green > 4.0 * red && red > 0.0, "{red} {green}");
        assert_eq!(lookup.blended([1.0, 0.0, 1.0], [128; 2], 12), lookup.hardware(1.0, 0.0, 1.0, 128, 12));
    }

    /// More steps in few bits make it worse: steps fall below what a channel can hold.
    #[test]
    fn few_bits_do_not_bear_many_steps() {
        let deviation = |count, bits| {
            let half = |s: f64| {
                if ((4.0 * s) as u32).is_multiple_of(2) {
                    ([0.9, 0.4, 0.0], 1.0)
                } else {
                    ([0.0, 0.2, 0.9], 1.0)
                }
            };
            Lookup::new(count, half).of_hardware(bits, 9)[0]
        };
        assert!(deviation(256, 8) > 2.0 * deviation(64, 8));
        assert!(deviation(256, 12) < 0.2 * deviation(256, 8));
    }
}
