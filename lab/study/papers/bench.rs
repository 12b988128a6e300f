//! The page (sections of papers with tables as Markdown, and figures), its options; a scene drawn in one way, and two ways in equal
//! time.

use crate::columns::markdown;
use crate::work_precision::{
    self as work, Benches, Engines, Errors, Frames, RenderConfig, StudyOptions, Subject,
};
use std::path::PathBuf;
use std::time::SystemTime;
use voltet_core::Result;
use voltet_core::grid::extent::range;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_io::encode;
use voltet_io::provenance::iso_date;
use voltet_nodes::drawing::NATIVE;
use voltet_optics::shading::Integrator;
use voltet_simd::LaneSet;

#[derive(Debug, Clone)]
pub struct Figure {
    /// The file's name.
    pub name: String,
    pub png: Vec<u8>,
}

/// Claims of a paper, and the results here.
#[derive(Debug, Clone)]
pub struct Section {
    pub paper: Paper,
    pub text: String,
    pub figures: Vec<Figure>,
}

/// Folder of the figures' links.
pub const FOLDER: &str = "papers";

pub fn page(sections: &[Section]) -> Result<String> {
    let lanes = LaneSet::detect()?.name();
    let threads = rayon::current_num_threads();
    let (system, machine) = (std::env::consts::OS, std::env::consts::ARCH);
    let mut text = format!(
        "# The papers' tables and figures, made anew\n\n\
         What is printed in the papers that this program follows, beside what is found here. `voltet papers --output docs/src/explanation` writes this \
         page and its figures.\n\n\
         Drawn on the CPU alone ({threads} threads, {lanes}, {system} {machine}), on {}, by version {}. All ways run in the same 32-bit \
         vector lanes. Times are medians of whole pictures, without tables, which the papers make once for many; what tables of \
         a millisecond or more take stands behind a plus. Errors are those of premultiplied linear RGBA against the 64-bit reference, 1 \
         being full scale. \"Holds\" and \"does not hold here\" are said by the program, of the figures beside it.\n",
        today(),
        env!("CARGO_PKG_VERSION"),
    );
    for section in sections {
        text += &format!("\n{}", section.text);
    }
    Ok(text)
}

/// The date, in UTC.
fn today() -> String {
    iso_date(SystemTime::now()).split('T').next().unwrap_or_default().into()
}

impl Section {
    pub(super) fn new(paper: Paper, title: &str) -> Section {
        Section { paper, text: format!("## {title}\n"), figures: Vec::new() }
    }

    pub(super) fn part(&mut self, title: &str) {
        self.text += &format!("\n### {title}\n");
    }

    pub(super) fn say(&mut self, text: &str) {
        self.text += &format!("\n{text}\n");
    }

    /// A table; the first column is text, the others numbers.
    pub(super) fn table(&mut self, heads: &[&str], rows: &[Vec<String>]) {
        self.text += &format!("\n{}", markdown(heads, |column| column == 0, rows));
    }

    /// Pictures side by side, over their backgrounds.
    pub(super) fn figure(&mut self, name: &str, caption: &str, pictures: &[Panel<'_>]) -> Result<()> {
        let png = encode::png(&beside(pictures), [1.0; 3], None)?;
        let name = format!("{}_{name}.png", self.paper.name());
        self.text += &format!("\n![{caption}]({FOLDER}/{name})\n\n{caption}\n");
        self.figures.push(Figure { name, png });
        Ok(())
    }
}

/// A picture with the background that it is shown over, linear RGB.
pub(super) type Panel<'a> = (&'a Picture, [f64; 3]);

/// Pixels between two pictures.
const GAP: usize = 6;

/// Pictures in a row, white between them.
fn beside(pictures: &[Panel<'_>]) -> Picture {
    let height = pictures.iter().map(|(picture, _)| picture.height).max().unwrap_or(0);
    let width = pictures.iter().map(|(picture, _)| picture.width + GAP).sum::<usize>().saturating_sub(GAP);
    let mut row = Picture { width, height, rgba: vec![[1.0; 4]; width * height] };
    let mut left = 0;
    for (picture, background) in pictures {
        for (j, line) in picture.rgba.chunks_exact(picture.width.max(1)).enumerate() {
            for (i, pixel) in line.iter().enumerate() {
                let over = |c: usize| pixel[c] + (1.0 - pixel[3]) * background[c] as f32;
                row.rgba[j * width + left + i] = [over(0), over(1), over(2), 1.0];
            }
        }
        left += picture.width + GAP;
    }
    row
}

pub(super) fn verdict(holds: bool) -> &'static str {
    if holds { "**holds**" } else { "**does not hold here**" }
}

/// Least and largest.
pub(super) fn span(values: &[f64]) -> String {
    let [low, high] = range(values).unwrap_or_default();
    format!("{} to {}", number(low), number(high))
}

/// Three digits.
pub(super) fn number(x: f64) -> String {
    match x.abs() {
        y if !y.is_finite() => "–".into(),
        0.0 => "0".into(),
        y if (0.01..1e5).contains(&y) => {
            let digits = (2 - y.log10().floor() as i32).clamp(0, 4) as usize;
            format!("{x:.digits$}")
        }
        _ => format!("{x:.1e}"),
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Paper {
    Song,
    Moreland,
    RoettgerErtl,
    Kniss,
}

impl Paper {
    pub const ALL: [Paper; 4] = [Paper::Song, Paper::Moreland, Paper::RoettgerErtl, Paper::Kniss];

    pub fn name(self) -> &'static str {
        ["song", "moreland", "roettger-ertl", "kniss"][self as usize]
    }
}

/// Fills a square: `at` gives straight linear RGB and opacity at places from 0 to 1, upward.
pub(super) fn square(side: usize, at: impl Fn(f64, f64) -> ([f64; 3], f64)) -> Picture {
    let pixel = |k: usize| {
        let (i, j) = (k % side, k / side);
        let place = |n: usize| (n as f64 + 0.5) / side as f64;
        let (color, opacity) = at(place(i), 1.0 - place(j));
        let [r, g, b] = color.map(|c| (c * opacity) as f32);
        [r, g, b, opacity as f32]
    };
    Picture { width: side, height: side, rgba: (0..side * side).map(pixel).collect() }
}

/// e^(−((x − x₀)/w)²) (Kniss et al. 2003, Eq. 1).
pub(super) fn gaussian(x: f64, centre: f64, width: f64) -> f64 {
    (-((x - centre) / width).powi(2)).exp()
}

#[derive(Debug, Clone)]
pub struct PapersOptions {
    pub papers: Vec<Paper>,
    /// Pixels of the figures.
    pub size: [u32; 2],
    pub frames: Frames,
    /// The largest grid of Song's Table 1 that is generated.
    pub max_cells: u64,
    /// A folder that may hold `bluntfin.vtu`.
    pub data: Option<PathBuf>,
    /// Folder of the reference pictures.
    pub cache: PathBuf,
}

/// Opens one of the pipelines, by the path from the folder of the papers', with options as `--set` takes them.
pub type OpenPipeline<'a> = dyn Fn(&str, &[String]) -> Result<Subject> + 'a;

pub(super) struct Bench<'a> {
    pub wish: &'a PapersOptions,
    /// Opens one of the pipelines, as it is but for some options.
    pub open: &'a OpenPipeline<'a>,
    pub progress: &'a dyn Progress,
}

#[derive(Debug, Clone)]
pub(super) struct TimedRender {
    pub picture: Picture,
    background: [f64; 3],
    /// Median milliseconds of a picture, without what serves further ones.
    pub ms: f64,
    /// Milliseconds of that: tables.
    pub set_up_ms: f64,
    pub errors: Errors,
}

pub(super) struct Scene {
    pub subject: Subject,
    pub reference: Picture,
}

impl Bench<'_> {
    pub fn sized(&self, file: &str) -> Result<Subject> {
        let [width, height] = self.wish.size;
        (self.open)(file, &[format!("view.size=[{width},{height}]")])
    }

    /// One of the pipelines in the figures' size, with its reference picture.
    pub fn scene(&self, file: &str) -> Result<Scene> {
        self.referred(self.sized(file)?)
    }

    pub fn referred(&self, subject: Subject) -> Result<Scene> {
        let reference = work::reference(&subject, &self.wish.cache, self.progress)?.picture;
        Ok(Scene { subject, reference })
    }

    pub fn shot(&self, scene: &Scene, integrator: Integrator) -> Result<TimedRender> {
        let (picture, cost) = self.measured(&scene.subject, integrator)?;
        let errors = work::errors(&picture, &scene.reference);
        let (background, ms, set_up_ms) =
            (scene.subject.background, cost.frame.median_ms, cost.set_up.median_ms);
        Ok(TimedRender { picture, background, ms, set_up_ms, errors })
    }

    /// Draws a scene on the CPU without a reference.
    pub fn measured(&self, subject: &Subject, integrator: Integrator) -> Result<(Picture, work::Cost)> {
        let wish = StudyOptions {
            engines: Engines::One(NATIVE),
            frames: self.wish.frames,
            ..StudyOptions::default()
        };
        let setting = RenderConfig::native(integrator);
        Benches::open(subject, &wish)?.measure(subject, &setting, &wish.frames, self.progress)
    }

    /// As many samples a segment as take no longer than `ms`, at least one, at most 1024; and the picture.
    pub fn in_equal_time(
        &self,
        scene: &Scene,
        ms: f64,
        with: impl Fn(usize) -> Integrator,
    ) -> Result<(usize, TimedRender)> {
        let mut best = (1, self.shot(scene, with(1))?);
        let mut last = best.1.ms;
        while best.1.ms < ms && best.0 < 1024 {
            let count = 2 * best.0;
            let shot = self.shot(scene, with(count))?;
            last = shot.ms;
            if shot.ms > ms {
                break;
            }
            best = (count, shot);
        }
        // Between two powers of two the time is about linear.
        let share = (ms - best.1.ms) / (last - best.1.ms);
        if last > ms && share.is_finite() && share > 0.0 {
            let count = best.0 + (share.min(1.0) * best.0 as f64) as usize;
            if count > best.0 {
                return Ok((count, self.shot(scene, with(count))?));
            }
        }
        Ok(best)
    }
}

impl TimedRender {
    pub fn panel(&self) -> Panel<'_> {
        (&self.picture, self.background)
    }

    pub fn row(&self, names: &[&str]) -> Vec<String> {
        names.iter().map(|name| name.to_string()).chain(self.cells()).collect()
    }

    /// Time and errors as cells of a table: ms, with those of tables behind a plus; rms, largest, pixels over a step of 8 bits.
    pub fn cells(&self) -> [String; 4] {
        let Errors { root_mean_square, maximum, pixels_over_step, .. } = self.errors;
        let tables = if self.set_up_ms < 1.0 { String::new() } else { format!(" + {:.1}", self.set_up_ms) };
        [
            format!("{:.1}{tables}", self.ms),
            format!("{root_mean_square:.1e}"),
            format!("{maximum:.1e}"),
            pixels_over_step.to_string(),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let shown = [0.0, 0.01234, 1.0, 12.34, 123.4, 99_999.0, 1.2e-5, f64::NAN].map(number);
        assert_eq!(shown, ["0", "0.0123", "1.00", "12.3", "123", "99999", "1.2e-5", "–"]);
    }

    #[test]
    fn pictures_stand_beside_each_other_over_their_backgrounds() {
        let half = Picture { width: 1, height: 1, rgba: vec![[0.25, 0.0, 0.0, 0.5]] };
        let tall = Picture { width: 2, height: 2, rgba: vec![[0.0, 0.0, 0.0, 1.0]; 4] };
        let row = beside(&[(&half, [1.0; 3]), (&tall, [0.0; 3])]);
        assert_eq!((row.width, row.height), (3 + GAP, 2));
        assert_eq!(row.rgba[0], [0.75, 0.5, 0.5, 1.0]);
        assert_eq!(row.rgba[1], [1.0; 4], "the gap");
        assert_eq!(row.rgba[row.width], [1.0; 4], "below the shorter one");
        assert_eq!(row.rgba[1 + GAP], [0.0, 0.0, 0.0, 1.0]);
    }
}
