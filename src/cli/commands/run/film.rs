//! Films of the pictures of frames: GIF and animated PNG by the program itself, others by the program ffmpeg.

use crate::cli::arguments::Run;
use crate::core::picture::Picture;
use crate::core::{Error, Result, counted};
use crate::document::{Document, LocatedError};
use crate::graph::Observer;
use crate::io::encode::film::{FilmFrame, MAX_GIF_RATE, apng, gif, unequal_sizes};
use crate::io::encode::{read_picture, srgb8};
use crate::nodes::files::{self, FileIdentity};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStderr, Command, ExitStatus, Stdio};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Type of the node that writes pictures.
const WRITER: &str = "image-writer";

pub(super) struct DrawnFrame {
    pub path: PathBuf,
    /// Words for the frame.
    pub label: String,
}

/// Kinds of films by the ending of their names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Gif,
    Apng,
    /// By ffmpeg, with the options that its codec needs.
    Encoded(&'static [&'static str]),
}

/// Films by their endings. The constant quality is what the encoders' authors call visually lossless or nearly so.
const KINDS: [(&str, Kind); 4] = [
    ("mp4", Kind::Encoded(&["-c:v", "libx264", "-crf", "18", "-movflags", "+faststart"])),
    ("webm", Kind::Encoded(&["-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0"])),
    ("gif", Kind::Gif),
    ("png", Kind::Apng),
];

/// Endings of pictures that a film or a sheet is made of.
const PICTURES: [&str; 7] = ["png", "exr", "jpg", "jpeg", "tif", "tiff", "webp"];

fn kind(path: &Path) -> Result<Kind> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let found = KINDS.iter().find(|(name, _)| ending.as_deref() == Some(*name));
    let unknown = || {
        let error =
            Error::usage("the format of the film is not known").got(format!("--film {}", path.display()));
        error.expected("a path that ends in .mp4, .webm, .gif or .png")
    };
    found.map(|(_, kind)| *kind).ok_or_else(unknown)
}

/// Checks, before any work, the film and the sheet that are asked for.
/// Errors: a film of no known format, one that cannot be written or is a file of the call; a pipeline without a picture, or with several.
pub(super) fn check(arguments: &Run, documents: &[Document]) -> std::result::Result<(), LocatedError> {
    let options = &arguments.frames;
    if let Some(path) = &options.film {
        if kind(path)? == Kind::Gif && options.fps > MAX_GIF_RATE {
            let error = Error::usage("a GIF film shows no more frames a second than 50")
                .got(format!("--fps {}", options.fps));
            return Err(error.expected("--fps of up to 50, or a film .png, .mp4 or .webm").into());
        }
        files::refuse_unwritable(path)?;
        crate::document::refuse_conflicts(documents, true, &[("--film", path)])?;
        if documents.len() > 1 {
            let error =
                Error::usage("a film is of one pipeline").got(counted(documents.len(), "pipeline file"));
            return Err(error.expected("one pipeline file").into());
        }
    }
    if options.film.is_none() && (options.sweep.is_empty() || options.part.is_some()) {
        return Ok(());
    }
    for document in documents {
        let Some(path) = picture_path(document) else {
            let error = Error::usage("a film, and a sheet of a sweep, are made of one picture of each frame");
            let expected = "a pipeline with one node of type image-writer that writes a file";
            return Err(error.expected(expected).in_file(&document.path).into());
        };
        let ending =
            path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
        if !PICTURES.contains(&ending.as_str()) {
            let error = Error::usage("a film, and a sheet of a sweep, are not made of such pictures");
            return Err(error
                .got(path.display())
                .expected("a path that ends in .png")
                .in_file(&document.path)
                .into());
        }
    }
    Ok(())
}

/// Refuses a film that is one of its pictures.
pub(super) fn refuse_frame<'a>(arguments: &Run, mut frames: impl Iterator<Item = &'a PathBuf>) -> Result<()> {
    let Some(film) = &arguments.frames.film else { return Ok(()) };
    let own = FileIdentity::from_path(film);
    match frames.find(|frame| own.is_some() && FileIdentity::from_path(frame) == own) {
        Some(frame) => {
            let error = Error::usage("the film is one of its pictures").got(frame.display());
            Err(error.expected("another path for the film"))
        }
        None => Ok(()),
    }
}

/// The only picture that a pipeline writes into a file.
pub(super) fn picture_path(document: &Document) -> Option<PathBuf> {
    let graph = &document.graph;
    let nodes = graph.order.iter().map(|&place| &graph.nodes[place]);
    let mut writers = nodes.filter(|node| node.node.name == WRITER);
    let (writer, None) = (writers.next()?, writers.next()) else { return None };
    let path = writer.parameters.text("path").ok()?;
    (!files::is_stream(path)).then(|| graph.folder.join(path))
}

/// The background of that picture, linear.
pub(super) fn background(document: &Document) -> [f64; 3] {
    let mut nodes = document.graph.nodes.iter();
    let writer = nodes.find(|node| node.node.name == WRITER);
    writer.and_then(|node| node.parameters.color("background").ok()).unwrap_or_default()
}

/// Settings of a film, and who follows its making.
pub(super) struct Making<'a> {
    /// Frames a second.
    pub rate: f64,
    /// The background of its pictures, linear.
    pub background: [f64; 3],
    /// The words of `voltet` by which it is made again, for an error.
    pub command: Vec<String>,
    pub observer: &'a dyn Observer,
}

/// Writes the film of pictures; gives a line about it.
///
/// # Errors
/// - pictures that cannot be read, or are of different sizes;
/// - ffmpeg that is not there, or fails;
/// - the run was stopped: what was there under the name of the film stays.
pub(super) fn write(path: &Path, pictures: &[DrawnFrame], making: &Making) -> Result<String> {
    let &Making { rate, background, observer, .. } = making;
    let size = film_frame(&pictures[0].path, background)?.size;
    let frame = |drawn: &DrawnFrame| {
        if observer.cancelled() {
            return Err(Error::cancelled());
        }
        let frame = film_frame(&drawn.path, background)?;
        match frame.size == size {
            true => Ok(frame),
            false => Err(unequal_sizes(size, frame.size, &drawn.path.display().to_string())),
        }
    };
    let even = size.map(|side| side + side % 2);
    let (mut padding, kind) = (String::new(), kind(path)?);
    let written = match kind {
        Kind::Gif => {
            files::write_whole_in_parts(path, &mut |out| gif(out, &mut pictures.iter().map(frame), rate))
        }
        Kind::Apng => files::write_whole_in_parts(path, &mut |out| {
            apng(out, &mut pictures.iter().map(frame), pictures.len() as u32, size, rate)
        }),
        Kind::Encoded(codec) => {
            if even != size {
                padding = format!(
                    ", padded with the background from {} × {} to even {} × {}",
                    size[0], size[1], even[0], even[1]
                );
            }
            let mut frames = pictures.iter().map(|drawn| Ok(padded(frame(drawn)?, even, background)));
            encode(path, &mut frames, (even, codec), making)
        }
    };
    // Writers of films give the stop on as one of their own errors.
    written.map_err(|error| if observer.cancelled() { Error::cancelled().in_file(path) } else { error })?;
    let seconds = pictures.len() as f64 / rate;
    let frames = counted(pictures.len(), "frame");
    Ok(format!("{}: a film of {frames}, {seconds:.2} s{padding}\n", path.display()))
}

fn film_frame(path: &Path, background: [f64; 3]) -> Result<FilmFrame> {
    let (Picture { width, height, rgba }, _) = read_picture(path)?;
    let rgb = rgba.iter().flat_map(|&pixel| srgb8(pixel, background)).collect();
    Ok(FilmFrame { size: [width as u32, height as u32], rgb })
}

/// A frame with background at its right and lower borders.
fn padded(frame: FilmFrame, size: [u32; 2], background: [f64; 3]) -> FilmFrame {
    if frame.size == size {
        return frame;
    }
    let [width, height] = size.map(|side| side as usize);
    let empty = srgb8([0.0; 4], background);
    let mut rgb = Vec::with_capacity(3 * width * height);
    for row in frame.rgb.chunks_exact(3 * frame.size[0] as usize) {
        rgb.extend_from_slice(row);
        (frame.size[0] as usize..width).for_each(|_| rgb.extend_from_slice(&empty));
    }
    while rgb.len() < 3 * width * height {
        rgb.extend_from_slice(&empty);
    }
    FilmFrame { size, rgb }
}

/// Options of ffmpeg for frames that come through a pipe.
fn options(path: &Path, [width, height]: [u32; 2], rate: f64, codec: &[&str]) -> Vec<String> {
    let input = format!("-f rawvideo -pix_fmt rgb24 -s {width}x{height} -r {rate} -i -");
    let words = ["-y", "-loglevel", "error"].into_iter().chain(input.split(' ')).chain(["-an"]);
    // Players expect half the resolution in colour, and the colours of Rec. 709.
    let colors = "-vf scale=out_color_matrix=bt709 -pix_fmt yuv420p -colorspace bt709 -color_primaries bt709 -color_trc iec61966-2-1";
    let mut words: Vec<String> =
        words.chain(codec.iter().copied()).chain(colors.split(' ')).map(String::from).collect();
    words.push(path.to_string_lossy().into_owned());
    words
}

/// Lets ffmpeg encode frames into a file beside the film, which takes the film's name when it is whole.
fn encode(
    path: &Path,
    frames: &mut dyn Iterator<Item = Result<FilmFrame>>,
    (size, codec): ([u32; 2], &[&str]),
    making: &Making,
) -> Result<()> {
    let film = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let name = film.file_name().unwrap_or_default().to_string_lossy();
    let part = film.with_file_name(format!(".{}.{name}", std::process::id()));
    let made = send(&part, frames, options(&part, size, making.rate, codec), (path, making))
        .and_then(|()| std::fs::rename(&part, &film).map_err(|error| failed(path, &error.to_string())));
    if made.is_err() {
        // Where ffmpeg began no file there is none to remove.
        let _ = std::fs::remove_file(&part);
    }
    made
}

/// Lets ffmpeg write a file of frames. `film`: the name for errors.
fn send(
    part: &Path,
    frames: &mut dyn Iterator<Item = Result<FilmFrame>>,
    options: Vec<String>,
    (film, making): (&Path, &Making),
) -> Result<()> {
    let child = Command::new("ffmpeg").args(&options).stdin(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut child = child.map_err(|error| missing(film, &error, &options, &making.command))?;
    let said = child.stderr.take().map(last_words);
    let sent = send_pixels(&mut child, frames);
    let status = match &sent {
        Ok(_) => ended(&mut child, making.observer),
        Err(_) => Ok(None),
    };
    if !matches!(status, Ok(Some(_))) {
        // It may have ended by itself meanwhile.
        let _ = child.kill();
        let _ = child.wait();
    }
    let sent = sent?;
    let status = status.map_err(|error| failed(film, &error.to_string()))?.ok_or_else(Error::cancelled)?;
    let said = said.and_then(|said| said.join().ok()).unwrap_or_default();
    match (status.success(), sent) {
        (true, Ok(())) if part.exists() => Ok(()),
        (true, Ok(())) => Err(failed(film, "it ended without a file")),
        (true, Err(error)) => Err(failed(film, &error.to_string())),
        (false, _) if said.trim().is_empty() => Err(failed(film, &status.to_string())),
        (false, _) => Err(failed(film, said.trim())),
    }
}

/// Gives the pixels to ffmpeg and closes its input. Within: the error of a pipe that it closed.
fn send_pixels(
    child: &mut Child,
    frames: &mut dyn Iterator<Item = Result<FilmFrame>>,
) -> Result<io::Result<()>> {
    let Some(mut sink) = child.stdin.take() else { return Ok(Ok(())) };
    for frame in frames {
        if let Err(error) = sink.write_all(&frame?.rgb) {
            return Ok(Err(error));
        }
    }
    Ok(Ok(()))
}

/// Waits for the end of ffmpeg; `None` if the run was stopped before.
fn ended(child: &mut Child, observer: &dyn Observer) -> io::Result<Option<ExitStatus>> {
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        if observer.cancelled() {
            return Ok(None);
        }
        thread::sleep(Duration::from_millis(10));
    }
}

/// Bytes of what ffmpeg says that are kept.
const MAX_SAID: usize = 1024;

/// Reads all that ffmpeg says, for it waits where nobody does; gives the end of it.
fn last_words(mut stderr: ChildStderr) -> JoinHandle<String> {
    thread::spawn(move || {
        let (mut said, mut block) = (Vec::new(), [0; 4096]);
        while let Ok(length @ 1..) = stderr.read(&mut block) {
            said.extend_from_slice(&block[..length]);
            said.drain(..said.len().saturating_sub(MAX_SAID));
        }
        String::from_utf8_lossy(&said).into_owned()
    })
}

fn failed(path: &Path, why: &str) -> Error {
    Error::run("ffmpeg did not make the film")
        .got(why)
        .expected("an ffmpeg with this codec; the pictures are there")
        .in_file(path)
}

/// The error where ffmpeg is not there, with the command that would be run, and the one that makes the film of the pictures.
fn missing(path: &Path, error: &io::Error, options: &[String], command: &[String]) -> Error {
    let line = |words: &mut dyn Iterator<Item = String>| {
        words.map(|word| files::argument(&word)).collect::<Vec<String>>().join(" ")
    };
    let mut given = command.to_vec();
    if !given.iter().any(|word| word == "--resume") {
        given.push("--resume".into());
    }
    Error::run("the film is not made, for the program ffmpeg cannot be run; the pictures are there")
        .got(error)
        .expected(format!(
            "ffmpeg on the PATH (`apt install ffmpeg`, `brew install ffmpeg`, or https://ffmpeg.org); it would be given the pixels as \
             `ffmpeg {}`. Where it is, `voltet {}` makes the film of the pictures. Films .gif and .png need no ffmpeg",
            line(&mut options.iter().cloned()),
            line(&mut given.into_iter())
        ))
        .in_file(path)
}
