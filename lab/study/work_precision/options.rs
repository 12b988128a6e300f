//! Options of a study.

use super::Frames;
use super::variant::Engines;

/// Measure of error that decides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Measure {
    /// The largest error of a pixel.
    #[default]
    Maximum,
    /// The root of the mean square.
    RootMeanSquare,
    /// 99.9th percentile of the pixels' errors.
    Percentile,
    /// The mean of FLIP.
    Flip,
}

impl Measure {
    /// Every measure with its name on the command line and a description.
    pub const NAMES: [(Measure, &'static str, &'static str); 4] = [
        (Measure::Maximum, "max", "The largest difference of a channel of premultiplied linear RGBA"),
        (Measure::RootMeanSquare, "rms", "The root of the mean square of these differences"),
        (Measure::Percentile, "p99.9", "The 99.9th percentile of these differences"),
        (Measure::Flip, "flip", "The perceptual difference FLIP, mean over the pixels"),
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        Measure::NAMES[self as usize].1
    }

    /// Label of an axis.
    pub fn label(self) -> &'static str {
        match self {
            Measure::Maximum => "largest error of premultiplied linear RGBA (1 = full scale)",
            Measure::RootMeanSquare => "root-mean-square error of premultiplied linear RGBA (1 = full scale)",
            Measure::Percentile => {
                "99.9 percentile of the error of premultiplied linear RGBA (1 = full scale)"
            }
            Measure::Flip => "mean FLIP difference (0 = equal, 1 = largest)",
        }
    }
}

/// Options of a study.
#[derive(Debug, Clone)]
pub struct StudyOptions {
    /// Integrators to look at; none for all.
    pub only: Vec<String>,
    /// Engines to look at.
    pub engines: Engines,
    /// The adapter, by a part of its name or its kind; none for the file's, or the fastest that is hardware.
    pub adapter: Option<String>,
    /// Number of times each is drawn.
    pub frames: Frames,
    /// Measure of error that decides about the front and the recommendation.
    pub measure: Measure,
    /// The error that is allowed.
    pub max_error: Option<f64>,
    /// Number of times the grid is refined, to tell the integration's error from the data model's; 0: not at all.
    pub refine: u32,
}
