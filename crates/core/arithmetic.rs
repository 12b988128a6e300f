//! Arithmetic that keeps the digits which plain sums of products lose.

/// p q − r s with one rounding of each product's error kept (Kahan; Jeannerod et al. 2013: within 1.5 ulp).
#[inline]
pub fn difference_of_products(p: f64, q: f64, r: f64, s: f64) -> f64 {
    let rs = r * s;
    let error = (-r).mul_add(s, rs);
    p.mul_add(q, -rs) + error
}
