//! An engine under test, and what it is held to.

use super::compare::{ORDINARY, nearly_all_within, referee_shaded, within};
use super::scene::{NamedScene, SHADING};
use voltet_core::picture::Picture;
use voltet_core::transfer::TransferFunction;
use voltet_optics::shading::{Integrator, Shading};

/// An engine under test.
pub trait Engine {
    /// Its picture of a scene in the exact order; `None` where it cannot be tested here, which was said loudly.
    fn picture(&self, scene: &NamedScene, shading: &Shading) -> Option<Picture>;

    /// True if it has the integrator for a look.
    fn serves(&self, integrator: &Integrator, look: &TransferFunction) -> bool;

    /// Error of a depth that is known, on a dozen segments.
    fn rounding(&self) -> f64;

    /// Error where rays graze the grid's surface at an angle of 0.002 and the extinction behind it is 9.
    fn grazing(&self) -> f64;

    /// Asserts the bound of ordinary scenes, and that there is something to see.
    fn ordinary(&self, scene: &NamedScene) {
        self.ordinary_shaded(scene, &SHADING);
    }

    /// Compares with another shading.
    fn ordinary_shaded(&self, scene: &NamedScene, shading: &Shading) {
        self.close(scene, shading, ORDINARY);
    }

    /// Compares with a bound of the scene's own.
    fn close(&self, scene: &NamedScene, shading: &Shading, bound: f64) {
        if let Some((actual, expected)) = self.beside_referee(scene, shading) {
            within(&scene.name, &actual, &expected, bound);
        }
    }

    /// Asserts the bound of stiff scenes, and that there is something to see.
    fn stiff(&self, scene: &NamedScene) {
        if let Some((actual, expected)) = self.beside_referee(scene, &SHADING) {
            nearly_all_within(&scene.name, &actual, &expected);
        }
    }

    /// Its picture and the referee's, in which there is something to see.
    fn beside_referee(&self, scene: &NamedScene, shading: &Shading) -> Option<(Picture, Picture)> {
        let actual = self.picture(scene, shading)?;
        let expected = referee_shaded(scene, shading);
        let covered = expected.rgba.iter().filter(|p| p[3] > 0.01).count();
        assert!(covered > 0, "{}: the scene shows nothing, so it proves nothing", scene.name);
        Some((actual, expected))
    }

    /// Asserts that it draws a picture that is known.
    fn matches(&self, scene: &NamedScene, expected: &Picture, bound: f64) {
        if let Some(actual) = self.picture(scene, &SHADING) {
            within(&scene.name, &actual, expected, bound);
        }
    }
}
