//! Damage to files, always the same: cuts, changed bytes, numbers that are wrong, bytes turned round.

use crate::memory::peak_of;
use std::io::Read;
use std::path::Path;
use std::time::{Duration, Instant};
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Request, inspect, read};
use voltet_testing::files::samples::file;

/// Beside the file's own bytes: buffers, threads' stacks of work, error texts, and the grid of a file of a few kilobytes
/// whose compressed blocks may promise the codec's greatest ratio.
const ALLOWED: usize = 48 << 20;

/// A scalar by name; without one where the name is empty, for meshes alone.
fn request(scalar: &str) -> Request {
    let scalar = Some(scalar.to_owned()).filter(|name| !name.is_empty());
    Request { without_scalar: scalar.is_none(), scalar, ..Request::default() }
}

/// Contents of a file in short, or the message of an error.
type Outcome = Result<String, String>;

/// Reads and inspects; whatever comes is fine but a panic, an empty message or too much memory.
fn try_file(path: &Path, scalar: &str, what: &str) -> [Outcome; 2] {
    let request = request(scalar);
    let (results, peak) = peak_of(|| {
        let inspected = inspect(path, &Request::default(), &NoProgress)
            .map(|own| format!("{} points, {} cells", own.point_count, own.cell_count));
        let read = read(path, &request, &NoProgress).map(|grid| {
            let point_count = grid.points.len();
            assert!(
                grid.tetrahedra.as_flattened().iter().all(|&corner| (corner as usize) < point_count),
                "{what}"
            );
            assert!(grid.points.iter().all(|point| point.is_finite()), "{what}");
            assert!(grid.scalar.iter().all(|scalar| scalar.iter().all(|value| value.is_finite())), "{what}");
            format!("{point_count} points, {} tetrahedra", grid.tetrahedra.len())
        });
        [inspected, read]
    });
    assert!(peak < ALLOWED, "{what}: {peak} bytes");
    results.map(|result| {
        result.map_err(|error| {
            assert!(!error.what.is_empty() && error.location.file.is_some(), "{what}: {error}");
            error.to_string()
        })
    })
}

/// Tries damaged files that `prepare` writes by the number of the case, of which it says what they are.
///
/// In a pool of one thread, for to hand each of thousands of small files to other threads takes longer than to read it; a few in one of
/// four, too, with the same outcome.
fn try_cases(path: &Path, scalar: &str, case_count: usize, mut prepare: impl FnMut(usize) -> String) {
    let [one, four] =
        [1, 4].map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap());
    let mut slowest = (Duration::ZERO, String::new());
    for case in 0..case_count {
        let what = prepare(case);
        let start = Instant::now();
        let outcome = one.install(|| try_file(path, scalar, &what));
        if start.elapsed() > slowest.0 {
            slowest = (start.elapsed(), what.clone());
        }
        // Each of the twelve ways to damage a file in its turn.
        if case % 17 == 0 {
            let in_four = four.install(|| try_file(path, scalar, &what));
            assert_eq!(outcome, in_four, "{what}: in one thread and in four");
        }
    }
    if std::env::var_os("VOLTET_FUZZ").is_some() {
        println!("slowest of {case_count} damaged files: {:.3} s, {}", slowest.0.as_secs_f64(), slowest.1);
    }
}

/// Without damage the files are read: damage to what is an error anyway would show nothing.
fn expect_sound(path: &Path, scalar: &str) {
    let read = read(path, &request(scalar), &NoProgress);
    assert!(read.is_ok(), "{}", read.err().map_or(String::new(), |error| error.to_string()));
}

/// Number of damaged files of each kind: `VOLTET_FUZZ`, or few.
pub fn case_count() -> usize {
    std::env::var("VOLTET_FUZZ").ok().and_then(|count| count.parse().ok()).unwrap_or(120)
}

/// A packed file of `tests/files`.
pub fn packed(name: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files").join(format!("{name}.gz"));
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(std::fs::File::open(path).unwrap()).read_to_end(&mut bytes).unwrap();
    bytes
}

/// Lengths and numbers of which none is right: 2^63 - 1, 2^63, -1 and 0, of eight bytes or four.
const WRONG_NUMBERS: [u64; 4] = [u64::MAX >> 1, 1 << 63, u64::MAX, 0];

/// Cuts and changes bytes at a place, in a way that the number of the case says.
fn damage(bytes: &[u8], case: usize, random: &mut impl FnMut(usize) -> usize) -> (Vec<u8>, String) {
    let mut damaged = bytes.to_vec();
    let at = random(bytes.len());
    let end = (at + 8).min(bytes.len());
    let what = match case % 12 {
        0 => {
            damaged.truncate(at);
            format!("cut at {at}")
        }
        1 => {
            damaged.remove(at);
            format!("without byte {at}")
        }
        2 => {
            damaged.insert(at, b'0' + (case % 10) as u8);
            format!("with a byte more at {at}")
        }
        3 => {
            let number = WRONG_NUMBERS[random(4)];
            let number = if random(2) == 0 { number.to_le_bytes() } else { number.to_be_bytes() };
            let skipped = 4 * random(2);
            damaged.splice(at..end - skipped.min(end - at), number[skipped..].iter().copied());
            format!("with {:?} at {at}", &number[skipped..])
        }
        4 => {
            let width = if random(2) == 0 { 4 } else { 8 };
            let begin = at / width * width;
            let end = (begin + width).min(bytes.len());
            damaged[begin..end].reverse();
            format!("with bytes {begin} to {end} turned round")
        }
        5 => {
            let number = ["-1", "9223372036854775808", "99999999", "nan", "1e999", ""][random(6)];
            let is_of_number = |byte: &&u8| byte.is_ascii_digit();
            let begin = at + bytes[at..].iter().take_while(|byte| !is_of_number(byte)).count();
            let length = bytes[begin..].iter().take_while(is_of_number).count();
            damaged.splice(begin..begin + length, number.bytes());
            format!("with '{number}' for the number at {begin}")
        }
        6 => {
            let (from, length) = (random(bytes.len()), random(64));
            let copied = bytes[from..(from + length).min(bytes.len())].to_vec();
            let end = (at + random(64)).min(bytes.len());
            damaged.splice(at..end, copied);
            format!("with {length} bytes from {from} in place of those from {at} to {end}")
        }
        7 => {
            damaged[at..end].fill(0xFF);
            format!("with 0xFF from {at}")
        }
        8 if damaged[at].is_ascii_digit() => {
            damaged[at] = b'9';
            format!("with a 9 at {at}")
        }
        _ => {
            damaged[at] ^= 1 << random(8);
            format!("with a bit changed at {at}")
        }
    };
    (damaged, what)
}

/// Numbers below a bound: the same in every run.
fn random_numbers() -> impl FnMut(usize) -> usize {
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    move |below: usize| {
        // xorshift64 (Marsaglia 2003).
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % below as u64) as usize
    }
}

/// Cuts and changes a file at places spread over it.
pub fn corrupt(name: &str, scalar: &str, bytes: &[u8], case_count: usize) {
    let folder = tempfile::tempdir().unwrap();
    corrupt_in(&folder, [name, name], scalar, bytes, case_count);
}

/// Cuts and changes a file of a folder at places spread over it. Names: of the file, and of that which is read.
pub fn corrupt_in(
    folder: &tempfile::TempDir,
    [name, read]: [&str; 2],
    scalar: &str,
    bytes: &[u8],
    case_count: usize,
) {
    file(folder, name, bytes);
    let path = folder.path().join(read);
    expect_sound(&path, scalar);
    let mut random = random_numbers();
    try_cases(&path, scalar, case_count, |case| {
        let (damaged, what) = damage(bytes, case, &mut random);
        file(folder, name, &damaged);
        format!("{name} {what}")
    });
}

/// Cuts and changes files of a folder, one after the other, and reads what is named.
pub fn corrupt_case(name: &str, named: &str, scalar: &str, files: &[&str], case_count: usize) {
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files").join(name);
    let files = files.iter().map(|file| (*file, std::fs::read(sample.join(file)).unwrap()));
    corrupt_files(&files.collect::<Vec<_>>(), named, scalar, case_count);
}

/// Cuts and changes files that belong together, given by name and bytes, one after the other, and reads what is named.
pub fn corrupt_files(files: &[(&str, Vec<u8>)], named: &str, scalar: &str, case_count: usize) {
    let folder = tempfile::tempdir().unwrap();
    let write = |file: &str, bytes: &[u8]| {
        let path = folder.path().join(file);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    };
    files.iter().for_each(|(file, bytes)| write(file, bytes));
    let path = folder.path().join(named);
    expect_sound(&path, scalar);
    let (mut random, mut last) = (random_numbers(), 0);
    try_cases(&path, scalar, case_count, |case| {
        write(files[last].0, &files[last].1);
        last = case / 12 % files.len();
        let (file, sound) = &files[last];
        let (damaged, what) = damage(sound, case, &mut random);
        write(file, &damaged);
        format!("{file} {what}, read by {named}")
    });
}
