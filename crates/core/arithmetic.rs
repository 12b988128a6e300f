//! Arithmetic that keeps the digits which plain sums of products lose.

use glam::DVec3;

/// p q − r s with one rounding of each product's error kept (Kahan; Jeannerod et al. 2013: within 1.5 ulp).
#[inline]
pub fn difference_of_products(p: f64, q: f64, r: f64, s: f64) -> f64 {
    let rs = r * s;
    let error = (-r).mul_add(s, rs);
    p.mul_add(q, -rs) + error
}

/// v / |v| for any magnitude of v; zero where v is, or is not finite.
pub fn unit_vector(v: DVec3) -> DVec3 {
    let largest = v.abs().max_element();
    if largest > 0.0 && largest.is_finite() { (v / largest).normalize() } else { DVec3::ZERO }
}

/// The number with the fewest decimal places that is as near as half of `step`: written in full, it comes back as it is.
pub fn decimal(x: f64, step: f64) -> f64 {
    if !(step > 0.0 && x.abs() < 1e15 * step) {
        return x;
    }
    let places = (-step.log10()).ceil() as i32;
    let rounded = match usize::try_from(places) {
        Ok(places) => format!("{x:.*}", places.min(340)).parse(),
        Err(_) => {
            let zeros = places.unsigned_abs() as i32;
            format!("{:.0}e{zeros}", x / 10f64.powi(zeros)).parse()
        }
    };
    // Minus zero is no place.
    rounded.map_or(x, |x: f64| x + 0.0)
}

/// The exact sign of the edge function of a → b; 0 only where both project to the same point.
pub fn edge_sign(a: [f64; 3], b: [f64; 3]) -> i8 {
    let compare = |x: f64, y: f64| i8::from(x > y) - i8::from(x < y);
    // Rounding keeps order: if the rounded products differ, so do the exact ones.
    let (p, q) = (a[0] * b[1], a[1] * b[0]);
    let rounded = compare(p, q);
    if rounded != 0 {
        return rounded;
    }
    let exact = compare(a[0].mul_add(b[1], -p), a[1].mul_add(b[0], -q));
    if exact != 0 {
        return exact;
    }
    // Moving the ray by (ε, ε²) subtracts ε (b_y − a_y) and adds ε² (b_x − a_x).
    match compare(a[1], b[1]) {
        0 => compare(b[0], a[0]),
        sign => sign,
    }
}
