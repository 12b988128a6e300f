//! Volumetric depth images: along each ray the stretches that a part of a grid fills, with colour and opacity, so that parts whose cells
//! lie between each other composite to the picture of the whole grid.
//!
//! Frey, Sadlo and Ertl 2013, "Explorable volumetric depth images from raycasting", call a stretch a supersegment. Theirs approximate the
//! volume; these end just where the part's cells do. The cells within one follow each other face to face, so none of another part lies
//! between them, and front-to-back compositing, which is associative, may take it as one layer: the picture is exact for every partition
//! of disjoint cells.
//!
//! Memory: 32 bytes a supersegment. A ray has one for each time that it leaves the part and enters it again, which is once or a few times
//! for compact parts, and once for each cell where cells are dealt out at random.

use crate::ray_events::{RayEvent, RayEventKind, RayEvents};
use rayon::prelude::*;
use std::ops::Range;
use voltet_core::picture::Picture;
use voltet_core::{Error, Result, counted};

/// A stretch of a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Supersegment {
    /// Depth of its beginning along the view direction, world units.
    pub entry: f64,
    /// Depth of its end.
    pub exit: f64,
    /// Premultiplied linear colour and opacity.
    pub rgba: [f32; 4],
}

impl Supersegment {
    fn middle(&self) -> f64 {
        0.5 * (self.entry + self.exit)
    }

    /// True if it comes behind another: by its beginning, and where both begin at one place by its end.
    fn is_behind(&self, other: &Supersegment, resolution: f64) -> bool {
        match (self.entry - other.entry).abs() <= resolution {
            true => self.exit > other.exit,
            false => self.entry > other.entry,
        }
    }
}

/// Supersegments of the rays of one sample a pixel, front to back.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleStretches {
    /// First of each pixel's, row by row, and the end of the last one's.
    first: Vec<u32>,
    stretches: Vec<Supersegment>,
}

/// A volumetric depth image.
#[derive(Debug, Clone, PartialEq)]
pub struct VolumetricDepthImage {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// Row of the picture that its first one is.
    pub top: usize,
    /// Difference up to which depths are the same, world units: that of their rounding.
    pub resolution: f64,
    /// The stretches of each sample of the pixels.
    pub samples: Vec<SampleStretches>,
}

impl SampleStretches {
    /// None, for so many pixels.
    pub fn none(pixel_count: usize) -> SampleStretches {
        SampleStretches { first: vec![0; pixel_count + 1], stretches: Vec::new() }
    }

    /// Stretches of each pixel, row by row.
    ///
    /// # Errors
    /// - more than 2³² of them.
    pub fn new(pixels: &[impl AsRef<[Supersegment]>]) -> Result<SampleStretches> {
        let mut first = Vec::with_capacity(pixels.len() + 1);
        let mut stretches = Vec::with_capacity(pixels.iter().map(|own| own.as_ref().len()).sum());
        first.push(0);
        for own in pixels {
            stretches.extend_from_slice(own.as_ref());
            first.push(number(stretches.len())?);
        }
        Ok(SampleStretches { first, stretches })
    }

    /// From a table of the first of each pixel's and of the end, as [`SampleStretches::parts`] gives it.
    ///
    /// # Errors
    /// - a table that does not run up from 0 to the number of stretches.
    pub fn from_parts(first: Vec<u32>, stretches: Vec<Supersegment>) -> Result<SampleStretches> {
        let ends = first.first().copied().zip(first.last().copied());
        if ends != Some((0, number(stretches.len())?)) || !first.is_sorted() {
            return Err(Error::run("a depth image does not say which pixel its stretches are of")
                .got(format!("{} stretches of {} pixels", stretches.len(), first.len().saturating_sub(1)))
                .expected("the first stretch of each pixel, ascending, and their number"));
        }
        Ok(SampleStretches { first, stretches })
    }

    /// The first of each pixel's stretches with the end of the last one's, and all stretches.
    pub fn parts(&self) -> (&[u32], &[Supersegment]) {
        (&self.first, &self.stretches)
    }

    /// The stretches of a pixel.
    pub fn of_pixel(&self, pixel: usize) -> &[Supersegment] {
        &self.stretches[self.first[pixel] as usize..self.first[pixel + 1] as usize]
    }
}

fn number(count: usize) -> Result<u32> {
    let error = |_| Error::run("the rays of a part of the grid have too many gaps").got(count);
    u32::try_from(count).map_err(|failed| error(failed).expected("at most 4,294,967,295 stretches"))
}

impl VolumetricDepthImage {
    /// An image of nothing.
    pub fn empty(size: [usize; 2], sample_count: usize) -> VolumetricDepthImage {
        let samples = vec![SampleStretches::none(size[0] * size[1]); sample_count];
        VolumetricDepthImage { size, top: 0, resolution: 0.0, samples }
    }

    /// Some of its rows.
    ///
    /// # Errors
    /// - rows that there are not.
    pub fn rows(&self, rows: Range<usize>) -> Result<VolumetricDepthImage> {
        let width = self.size[0];
        let part = |sample: &SampleStretches| {
            let first = sample.first.get(rows.start * width..=rows.end * width)?;
            let (&from, &to) = (first.first()?, first.last()?);
            let stretches = sample.stretches.get(from as usize..to as usize)?.to_vec();
            Some(SampleStretches { first: first.iter().map(|at| at - from).collect(), stretches })
        };
        let samples = self.samples.iter().map(part).collect::<Option<_>>();
        let error =
            || Error::run("a depth image has no such rows").got(format!("{} to {}", rows.start, rows.end));
        let samples = samples.ok_or_else(|| error().expected(format!("rows below {}", self.size[1])))?;
        Ok(VolumetricDepthImage { size: [width, rows.len()], top: self.top + rows.start, samples, ..*self })
    }

    /// The image as bytes, to be sent to another process.
    pub fn to_bytes(&self) -> Vec<u8> {
        let stretches: usize = self.samples.iter().map(|sample| sample.stretches.len()).sum();
        let firsts: usize = self.samples.iter().map(|sample| sample.first.len()).sum();
        let mut bytes = Vec::with_capacity(40 + 8 * self.samples.len() + 4 * firsts + 32 * stretches);
        let [width, height] = self.size;
        for number in [width, height, self.top, self.samples.len()] {
            bytes.extend((number as u64).to_le_bytes());
        }
        bytes.extend(self.resolution.to_le_bytes());
        for SampleStretches { first, stretches } in &self.samples {
            bytes.extend((stretches.len() as u64).to_le_bytes());
            first.iter().for_each(|at| bytes.extend(at.to_le_bytes()));
            for Supersegment { entry, exit, rgba } in stretches {
                bytes.extend(entry.to_le_bytes());
                bytes.extend(exit.to_le_bytes());
                rgba.iter().for_each(|value| bytes.extend(value.to_le_bytes()));
            }
        }
        bytes
    }

    /// The image from [`VolumetricDepthImage::to_bytes`].
    ///
    /// # Errors
    /// - other bytes.
    pub fn from_bytes(bytes: &[u8]) -> Result<VolumetricDepthImage> {
        let mut reader = ByteReader(bytes);
        let image = reader.image().filter(|_| reader.0.is_empty());
        let error =
            || Error::run("another process sent a broken depth image").got(counted(bytes.len(), "byte"));
        image.ok_or_else(|| error().expected("the program in one version on all processes"))
    }

    /// The image of two parts. `events`: surfaces that keep stretches apart, for each sample; none where there are no surfaces.
    ///
    /// # Errors
    /// - images of different sizes or numbers of samples; more than 2³² stretches.
    pub fn merged(&self, other: &Self, events: &[RayEvents]) -> Result<VolumetricDepthImage> {
        if self.size != other.size || self.samples.len() != other.samples.len() {
            let size = |image: &Self| {
                format!("{} × {} with {} samples", image.size[0], image.size[1], image.samples.len())
            };
            return Err(Error::run("images of parts have different sizes")
                .got(size(other))
                .expected(size(self)));
        }
        let resolution = self.resolution.max(other.resolution);
        let pixel_count = self.size[0] * self.size[1];
        let samples = self.samples.iter().zip(&other.samples).enumerate();
        let samples = samples.map(|(sample, (one, other))| {
            let pixels: Vec<Vec<Supersegment>> = (0..pixel_count)
                .into_par_iter()
                .map(|pixel| {
                    let surfaces = self.events_of(events.get(sample), pixel).unwrap_or_default();
                    merged(one.of_pixel(pixel), other.of_pixel(pixel), surfaces, resolution)
                })
                .collect();
            SampleStretches::new(&pixels)
        });
        Ok(VolumetricDepthImage { resolution, samples: samples.collect::<Result<_>>()?, ..*self })
    }

    /// The picture, with surfaces in their places.
    pub fn picture(&self, events: &[RayEvents]) -> Picture {
        let [width, height] = self.size;
        let weight = 1.0 / self.samples.len().max(1) as f64;
        let mut picture = Picture::transparent(width, height);
        picture.rgba.par_iter_mut().enumerate().for_each(|(pixel, rgba)| {
            let mut sum = [0.0; 4];
            for (sample, stretches) in self.samples.iter().enumerate() {
                let surfaces = self.events_of(events.get(sample), pixel);
                let own = composited(stretches.of_pixel(pixel), surfaces.unwrap_or_default());
                sum.iter_mut().zip(own).for_each(|(sum, value)| *sum += weight * value);
            }
            *rgba = sum.map(|value| value as f32);
        });
        picture
    }

    fn events_of<'e>(&self, events: Option<&'e RayEvents>, pixel: usize) -> Option<&'e [RayEvent]> {
        let width = self.size[0].max(1);
        events.map(|events| events.of_pixel(pixel % width, self.top + pixel / width))
    }

    /// Pixels in which stretches overlap: cells of different parts fill the same place, and are drawn twice as dense there.
    pub fn overlapping_pixels(&self) -> u64 {
        let overlap = |pair: &[Supersegment]| {
            let thickness = |own: &Supersegment| own.exit - own.entry;
            let depth = pair[0].exit - pair[1].entry;
            depth > 16.0 * self.resolution && depth > 1e-3 * thickness(&pair[0]).min(thickness(&pair[1]))
        };
        let pixels = 0..self.size[0] * self.size[1];
        let is_overlapping =
            |pixel: &usize| self.samples.iter().any(|sample| sample.of_pixel(*pixel).windows(2).any(overlap));
        pixels.into_par_iter().filter(is_overlapping).count() as u64
    }

    /// Pixels with a stretch.
    pub fn covered_pixels(&self) -> u64 {
        let is_covered =
            |pixel: &usize| self.samples.iter().any(|sample| !sample.of_pixel(*pixel).is_empty());
        (0..self.size[0] * self.size[1]).into_par_iter().filter(is_covered).count() as u64
    }

    /// Number of stretches of all samples.
    pub fn stretch_count(&self) -> u64 {
        self.samples.iter().map(|sample| sample.stretches.len() as u64).sum()
    }
}

/// Reader of [`VolumetricDepthImage::to_bytes`]; `None` at the end of the bytes.
struct ByteReader<'a>(&'a [u8]);

impl ByteReader<'_> {
    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (head, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*head)
    }

    fn count(&mut self) -> Option<usize> {
        usize::try_from(u64::from_le_bytes(self.array()?)).ok()
    }

    fn image(&mut self) -> Option<VolumetricDepthImage> {
        let [width, height, top, sample_count] = [self.count()?, self.count()?, self.count()?, self.count()?];
        let resolution = f64::from_le_bytes(self.array()?);
        let pixels = width.checked_mul(height)?;
        let sample = |reader: &mut Self| {
            let count = reader.count()?;
            // Nothing is allocated that the bytes do not hold.
            let bytes = pixels.checked_add(1)?.checked_mul(4)?.checked_add(count.checked_mul(32)?)?;
            if bytes > reader.0.len() {
                return None;
            }
            let first =
                (0..=pixels).map(|_| Some(u32::from_le_bytes(reader.array()?))).collect::<Option<_>>()?;
            let stretches = (0..count).map(|_| reader.stretch()).collect::<Option<_>>()?;
            SampleStretches::from_parts(first, stretches).ok()
        };
        let mut samples = Vec::new();
        for _ in 0..sample_count {
            samples.push(sample(self)?);
        }
        Some(VolumetricDepthImage { size: [width, height], top, resolution, samples })
    }

    fn stretch(&mut self) -> Option<Supersegment> {
        let [entry, exit] = [self.array()?, self.array()?].map(f64::from_le_bytes);
        let rgba = [self.array()?, self.array()?, self.array()?, self.array()?].map(f32::from_le_bytes);
        Some(Supersegment { entry, exit, rgba })
    }
}

/// Depths of the surfaces among events.
fn surfaces(events: &[RayEvent]) -> impl Iterator<Item = (f64, [f32; 4])> {
    events.iter().filter_map(|event| match event.kind {
        RayEventKind::Surface(rgba) => Some((event.depth, rgba)),
        RayEventKind::Hide | RayEventKind::Show => None,
    })
}

/// Puts stretches of a ray in order, and joins them where one begins as the one before ends and no surface lies between them.
pub fn sort_and_join(stretches: &mut Vec<Supersegment>, events: &[RayEvent], resolution: f64) {
    stretches.sort_by(|a, b| a.entry.total_cmp(&b.entry).then_with(|| a.exit.total_cmp(&b.exit)));
    for k in 1..stretches.len() {
        let mut to = k;
        while to > 0 && stretches[to - 1].is_behind(&stretches[to], resolution) {
            stretches.swap(to - 1, to);
            to -= 1;
        }
    }
    // Colours of the stretch at hand, which are rounded when it ends.
    let mut sum = [0.0; 4];
    let mut kept = 0;
    for next in 0..stretches.len() {
        let behind = stretches[next];
        if next > 0 {
            let front = &mut stretches[kept];
            // Those that overlap stay, to be counted.
            let is_apart = (behind.entry - front.exit).abs() > resolution;
            let between = front.middle()..=behind.middle();
            if !is_apart && !surfaces(events).any(|(depth, _)| between.contains(&depth)) {
                composite_behind(&mut sum, behind.rgba);
                front.exit = front.exit.max(behind.exit);
                continue;
            }
            front.rgba = sum.map(|value| value as f32);
            kept += 1;
        }
        sum = behind.rgba.map(f64::from);
        stretches[kept] = behind;
    }
    if let Some(last) = stretches.get_mut(kept) {
        last.rgba = sum.map(|value| value as f32);
    }
    stretches.truncate(kept + 1);
}

/// Composites a layer, premultiplied, behind others.
fn composite_behind(sum: &mut [f64; 4], rgba: [f32; 4]) {
    let transmittance = 1.0 - sum[3];
    sum.iter_mut().zip(rgba).for_each(|(sum, value)| *sum += transmittance * f64::from(value));
}

/// The stretches of two parts along a ray, in order, joined.
fn merged(
    one: &[Supersegment],
    other: &[Supersegment],
    events: &[RayEvent],
    resolution: f64,
) -> Vec<Supersegment> {
    let mut all = Vec::with_capacity(one.len() + other.len());
    all.extend_from_slice(one);
    all.extend_from_slice(other);
    if !one.is_empty() && !other.is_empty() {
        sort_and_join(&mut all, events, resolution);
    }
    all
}

/// Colour and opacity of a ray.
fn composited(stretches: &[Supersegment], events: &[RayEvent]) -> [f64; 4] {
    let mut sum = [0.0; 4];
    let mut take = |rgba: [f32; 4]| composite_behind(&mut sum, rgba);
    let mut surfaces = surfaces(events).peekable();
    for stretch in stretches {
        while let Some((_, rgba)) = surfaces.next_if(|(depth, _)| *depth <= stretch.middle()) {
            take(rgba);
        }
        take(stretch.rgba);
    }
    surfaces.for_each(|(_, rgba)| take(rgba));
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stretch(entry: f64, exit: f64, rgba: [f32; 4]) -> Supersegment {
        Supersegment { entry, exit, rgba }
    }

    fn image(stretches: &[Supersegment]) -> VolumetricDepthImage {
        let samples = vec![SampleStretches::new(&[stretches.to_vec()]).unwrap()];
        VolumetricDepthImage { size: [1, 1], top: 0, resolution: 1e-9, samples }
    }

    const RED: [f32; 4] = [0.5, 0.0, 0.0, 0.5];
    const BLUE: [f32; 4] = [0.0, 0.0, 0.25, 0.25];

    #[test]
    fn stretches_between_each_other_are_composited_front_to_back() {
        let one = image(&[stretch(1.0, 2.0, RED), stretch(3.0, 4.0, RED)]);
        let other = image(&[stretch(2.0, 3.0, BLUE)]);
        for merged in [one.merged(&other, &[]).unwrap(), other.merged(&one, &[]).unwrap()] {
            assert_eq!(merged.stretch_count(), 1);
            assert_eq!(merged.samples[0].of_pixel(0)[0].exit, 4.0);
            assert_eq!(merged.picture(&[]).rgba[0], [0.6875, 0.0, 0.125, 0.8125]);
            assert_eq!(merged.overlapping_pixels(), 0);
        }
    }

    #[test]
    fn a_gap_keeps_room_for_further_parts() {
        let one = image(&[stretch(1.0, 2.0, RED)]);
        let last = image(&[stretch(3.0, 4.0, RED)]);
        let both = one.merged(&last, &[]).unwrap();
        assert_eq!(both.stretch_count(), 2);
        let all = both.merged(&image(&[stretch(2.0, 3.0, BLUE)]), &[]).unwrap();
        assert_eq!(all.picture(&[]).rgba[0], [0.6875, 0.0, 0.125, 0.8125]);
    }

    #[test]
    fn rounded_ends_do_not_change_the_order() {
        let thin = image(&[stretch(2.0 - 1e-10, 2.0 + 1e-10, BLUE)]);
        let before = image(&[stretch(1.0, 2.0 + 2e-10, RED)]);
        let behind = image(&[stretch(2.0 - 2e-10, 3.0, [0.0, 1.0, 0.0, 1.0])]);
        let all = behind.merged(&thin, &[]).unwrap().merged(&before, &[]).unwrap();
        assert_eq!(all.picture(&[]).rgba[0], [0.5, 0.375, 0.125, 1.0]);
        assert_eq!(all.overlapping_pixels(), 0);
    }

    #[test]
    fn cells_at_one_place_are_counted() {
        let one = image(&[stretch(1.0, 2.0, RED), stretch(5.0, 6.0, RED)]);
        let other = image(&[stretch(1.5, 3.0, BLUE)]);
        assert_eq!(one.merged(&other, &[]).unwrap().overlapping_pixels(), 1);
        assert_eq!(one.overlapping_pixels(), 0);
    }

    #[test]
    fn rows_arrive_at_another_process_as_they_are() {
        let pixels = [
            vec![stretch(1.0, 2.0, RED)],
            vec![],
            vec![stretch(1.0, 2.0, BLUE), stretch(3.0, 4.0, RED)],
            vec![],
        ];
        let samples = vec![SampleStretches::new(&pixels).unwrap(); 2];
        let whole = VolumetricDepthImage { size: [2, 2], top: 0, resolution: 1e-9, samples };
        assert_eq!(VolumetricDepthImage::from_bytes(&whole.to_bytes()).unwrap(), whole);
        let below = whole.rows(1..2).unwrap();
        assert_eq!((below.top, below.size, below.stretch_count()), (1, [2, 1], 4));
        assert_eq!(below.picture(&[]).rgba, whole.picture(&[]).rgba[2..]);
        assert!(whole.rows(1..3).is_err());
        let bytes = whole.to_bytes();
        for end in 0..bytes.len() {
            assert!(VolumetricDepthImage::from_bytes(&bytes[..end]).is_err(), "{end}");
        }
        let mut huge = bytes.clone();
        huge[..8].copy_from_slice(&u64::MAX.to_le_bytes());
        assert!(VolumetricDepthImage::from_bytes(&huge).is_err());
    }

    #[test]
    fn damaged_tables_and_other_sizes_are_refused() {
        assert!(SampleStretches::from_parts(vec![0, 2], Vec::new()).is_err());
        assert!(SampleStretches::from_parts(Vec::new(), Vec::new()).is_err());
        assert!(SampleStretches::from_parts(vec![0, 0], Vec::new()).is_ok());
        let (one, other) = (VolumetricDepthImage::empty([2, 1], 1), VolumetricDepthImage::empty([2, 1], 4));
        assert!(one.merged(&other, &[]).unwrap_err().to_string().contains("2 × 1 with 4 samples"));
    }
}
