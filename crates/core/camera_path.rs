//! Way of a camera through several pictures: a smooth curve through keys, and an orbit.
//!
//! Between keys the target runs along a cubic Hermite curve with the slopes of Catmull and Rom ("A class of local interpolating
//! splines", 1974), for keys at uneven places as in Kochanek and Bartels 1984. So do the logarithm of the distance of the eye from the
//! target and, scaled back to length 1, the direction to the eye: it stays on the sphere about the target, as a great circle does.

use crate::arithmetic::unit_vector;
use crate::camera::Camera;
use crate::{Error, Result};
use glam::{DQuat, DVec3};

/// Place that a camera passes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraKey {
    /// Its share of the way, 0 to 1.
    pub place: f64,
    /// Position of the eye, world units.
    pub eye: DVec3,
    /// The point in the middle of the picture, world units.
    pub target: DVec3,
}

/// Eye and target at a share of the way through keys; before the first and after the last they stand still.
///
/// # Errors
/// - fewer than two keys, places that do not ascend, an eye at its target;
/// - neighbouring keys that look in opposite directions, between which no way is given.
pub fn camera_on_way(keys: &[CameraKey], phase: f64) -> Result<[DVec3; 2]> {
    if keys.len() < 2 {
        return Err(Error::usage("a way has two keys at least").got(keys.len()).expected("2 keys or more"));
    }
    if let Some(pair) = keys.windows(2).find(|pair| pair[0].place >= pair[1].place) {
        let found = format!("{} and then {}", pair[0].place, pair[1].place);
        return Err(Error::usage("the places of keys must ascend").got(found).expected("0 to 1, ascending"));
    }
    let offsets: Vec<DVec3> = keys.iter().map(|key| key.eye - key.target).collect();
    let directions: Vec<DVec3> = offsets.iter().map(|&offset| unit_vector(offset)).collect();
    if let Some(place) = directions.iter().position(|&direction| direction == DVec3::ZERO) {
        let error = Error::usage("the eye of a key is at its target").got(keys[place].eye);
        return Err(error.expected("an eye apart from the target"));
    }
    if let Some(pair) = directions.windows(2).find(|pair| pair[0].dot(pair[1]) < OPPOSITE) {
        let error = Error::usage("two keys in a row look in opposite directions");
        return Err(error.got(format!("{} and {}", pair[0], pair[1])).expected("a key between them"));
    }
    let places: Vec<f64> = keys.iter().map(|key| key.place).collect();
    let targets: Vec<DVec3> = keys.iter().map(|key| key.target).collect();
    let distances: Vec<DVec3> = offsets.iter().map(|offset| DVec3::splat(offset.length().ln())).collect();
    let target = on_curve(&places, &targets, phase);
    let distance = on_curve(&places, &distances, phase).x.exp();
    Ok([target + distance * unit_vector(on_curve(&places, &directions, phase)), target])
}

/// Cosine below which directions count as opposite: 175 degrees, beyond which the way between them is mostly rounding.
const OPPOSITE: f64 = -0.996;

/// The point of the curve through `values` at `places`.
fn on_curve(places: &[f64], values: &[DVec3], at: f64) -> DVec3 {
    let last = places.len() - 1;
    if at <= places[0] || at >= places[last] {
        return if at <= places[0] { values[0] } else { values[last] };
    }
    let i = places.partition_point(|&place| place <= at) - 1;
    let width = places[i + 1] - places[i];
    let slope = |k: usize| {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
        (values[after] - values[before]) / (places[after] - places[before])
    };
    let t = (at - places[i]) / width;
    let (t2, t3) = (t * t, t * t * t);
    values[i] * (2.0 * t3 - 3.0 * t2 + 1.0)
        + slope(i) * width * (t3 - 2.0 * t2 + t)
        + values[i + 1] * (3.0 * t2 - 2.0 * t3)
        + slope(i + 1) * width * (t3 - t2)
}

/// Directions in which an orbit is looked at, for a picture that holds all of it.
const ORBIT_SAMPLES: u32 = 48;

/// The points as a camera sees them on its orbit of so many degrees about an axis through `middle`: turned against it.
pub fn points_on_orbit(points: &[DVec3], middle: DVec3, axis: DVec3, degrees: f64) -> Vec<DVec3> {
    let turned = |step: u32| {
        let angle = -degrees * f64::from(step) / f64::from(ORBIT_SAMPLES);
        let turn = DQuat::from_axis_angle(unit_vector(axis), angle.to_radians());
        points.iter().map(move |&point| middle + turn * (point - middle))
    };
    (0..=ORBIT_SAMPLES).flat_map(turned).collect()
}

impl Camera {
    /// The camera turned as a whole about an axis through a point, by so many degrees.
    pub fn turned_about(self, middle: DVec3, axis: DVec3, degrees: f64) -> Camera {
        if degrees == 0.0 {
            return self;
        }
        let turn = DQuat::from_axis_angle(unit_vector(axis), degrees.to_radians());
        let place = |point: DVec3| middle + turn * (point - middle);
        Camera { eye: place(self.eye), target: place(self.target), up: turn * self.up, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(place: f64, eye: [f64; 3]) -> CameraKey {
        CameraKey { place, eye: eye.into(), target: DVec3::ZERO }
    }

    /// Four keys on a circle of radius 2.
    fn circle() -> Vec<CameraKey> {
        let eye = |k: usize| {
            let angle = std::f64::consts::FRAC_PI_4 * k as f64;
            key(k as f64 / 4.0, [2.0 * angle.cos(), 2.0 * angle.sin(), 0.0])
        };
        (0..5).map(eye).collect()
    }

    #[test]
    fn the_way_goes_through_its_keys_and_stays_on_the_sphere_between_them() {
        let keys = circle();
        for key in &keys {
            let [eye, target] = camera_on_way(&keys, key.place).unwrap();
            // The logarithm and back.
            assert!((eye - key.eye).length() < 1e-14 && target == DVec3::ZERO, "{eye}");
        }
        for step in 0..=100 {
            let [eye, _] = camera_on_way(&keys, f64::from(step) / 100.0).unwrap();
            assert!((eye.length() - 2.0).abs() < 1e-14, "{eye}");
        }
        // A fifth of the way of half a turn: the cubic is off the great circle by less than half a degree.
        let [eye, _] = camera_on_way(&keys, 0.4).unwrap();
        assert!((eye.y.atan2(eye.x).to_degrees() - 72.0).abs() < 0.5, "{eye}");
    }

    #[test]
    fn the_way_has_no_kinks() {
        let keys = circle();
        let at = |phase: f64| camera_on_way(&keys, phase).unwrap()[0];
        let h = 1e-5;
        for key in &keys[1..4] {
            let [before, after] = [at(key.place) - at(key.place - h), at(key.place + h) - at(key.place)];
            // Differences of second order in h, of a curve whose second derivatives are below 1e3.
            assert!((before - after).length() / h < 1e3 * h, "{}", (before - after).length() / h);
        }
    }

    #[test]
    fn keys_without_a_way_are_refused() {
        let error = |keys: &[CameraKey]| camera_on_way(keys, 0.5).unwrap_err().to_string();
        assert!(error(&circle()[..1]).contains("two keys"));
        assert!(error(&[key(0.5, [1.0, 0.0, 0.0]), key(0.5, [0.0, 1.0, 0.0])]).contains("ascend"));
        assert!(error(&[key(0.0, [1.0, 0.0, 0.0]), key(1.0, [-1.0, 0.0, 0.0])]).contains("opposite"));
        assert!(error(&[key(0.0, [0.0; 3]), key(1.0, [-1.0, 0.0, 0.0])]).contains("at its target"));
    }
}
