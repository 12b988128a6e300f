//! Colours: linear RGB of the primaries and white of Rec. 709, which sRGB has, too.

/// sRGB to linear (IEC 61966-2-1), both 0 … 1.
pub fn linear_from_srgb(v: f64) -> f64 {
    if v <= 0.04045 { v / 12.92 } else { libm::pow((v + 0.055) / 1.055, 2.4) }
}

/// Linear RGB of a text "#rrggbb", which is 8-bit sRGB; `None` where it is none.
pub fn from_hex(text: &str) -> Option<[f64; 3]> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii())?;
    let number = u32::from_str_radix(digits, 16).ok().filter(|_| !digits.starts_with('+'))?;
    let [_, rgb @ ..] = number.to_be_bytes();
    Some(rgb.map(|byte| linear_from_srgb(f64::from(byte) / 255.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hexadecimal_colours_are_srgb() {
        // 118 of 255 is 18 % grey (section 8 of the optics).
        let grey = from_hex("#767676").unwrap();
        assert!(grey.iter().all(|v| (v - 0.18).abs() < 2e-3), "{grey:?}");
        assert_eq!(from_hex("#fF0000"), Some([1.0, 0.0, 0.0]));
        for wrong in ["ff0000", "#ff000", "#ff00000", "#gg0000", "#+f0000", "", "#é0000", "red"] {
            assert_eq!(from_hex(wrong), None, "{wrong}");
        }
    }
}
