//! What was measured of a device, remembered in the user's cache folder: one small file a device and kind of scene.

use std::fs;
use std::path::Path;
use voltet_core::Result;
use voltet_gpu::Times;

use crate::files::{Fnv, write_whole};

/// The file's first line. The number changes with the format, and with what is measured.
const HEAD: &str = "voltet compositors 1";

/// Everything that a measurement holds for.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Key {
    pub adapter: String,
    pub driver: String,
    pub needs_order: bool,
}

/// The times that the folder holds under the key, or else new ones, which it then holds if it can be written; and
/// whether they were found. A damaged file is as none.
pub fn remembered(
    folder: &Path,
    key: &Key,
    measure: impl FnOnce() -> Result<Times>,
) -> Result<(Times, bool)> {
    let head = head(key);
    let mut name = Fnv::default();
    name.text(&head);
    let path = folder.join(format!("{:032x}.txt", name.0));
    if let Some(times) = fs::read_to_string(&path).ok().and_then(|text| decode(&text, &head)) {
        return Ok((times, true));
    }
    let times = measure()?;
    // What cannot be kept is measured again the next time.
    let _ = fs::create_dir_all(folder).map(|()| write_whole(&path, encode(&times, &head).as_bytes()));
    Ok((times, false))
}

fn head(key: &Key) -> String {
    let line = |text: &str| text.replace(['\n', '\r'], " ");
    let scene = if key.needs_order { "order of centroids" } else { "no order" };
    let version = env!("CARGO_PKG_VERSION");
    format!("{HEAD}\n{}\n{}\nprogram {version}\n{scene}\n", line(&key.adapter), line(&key.driver))
}

fn encode(times: &Times, head: &str) -> String {
    let content = format!("{head}tiles {:e} s\nraster {:e} s\n", times.tiles, times.raster);
    let mut check = Fnv::default();
    check.bytes(content.as_bytes());
    format!("{content}check {:032x}\n", check.0)
}

/// `None` for what is damaged or of another key.
fn decode(text: &str, head: &str) -> Option<Times> {
    let number = |line: &str, name: &str| -> Option<f64> {
        let seconds: f64 = line.strip_prefix(name)?.strip_suffix(" s")?.trim().parse().ok()?;
        (seconds.is_finite() && seconds > 0.0).then_some(seconds)
    };
    let mut lines = text.strip_prefix(head)?.lines();
    let times = Times { tiles: number(lines.next()?, "tiles ")?, raster: number(lines.next()?, "raster ")? };
    (encode(&times, head) == text).then_some(times)
}

#[cfg(test)]
mod tests {
    use super::*;
    use voltet_core::Error;

    const TIMES: Times = Times { tiles: 1.25e-3, raster: 3.5e-4 };

    fn key() -> Key {
        Key { adapter: "Some GPU (discrete, vulkan)".into(), driver: "driver 1.2".into(), needs_order: false }
    }

    fn must_not_measure() -> Result<Times> {
        Err(Error::run("measured again"))
    }

    #[test]
    fn what_was_measured_is_found_again_under_its_own_key() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().join("not there yet");
        assert_eq!(remembered(&folder, &key(), || Ok(TIMES)).unwrap(), (TIMES, false));
        assert_eq!(remembered(&folder, &key(), must_not_measure).unwrap(), (TIMES, true));
        for other in [
            Key { adapter: "Another GPU".into(), ..key() },
            Key { driver: "driver 1.3".into(), ..key() },
            Key { needs_order: true, ..key() },
        ] {
            assert!(remembered(&folder, &other, must_not_measure).is_err(), "{other:?}");
        }
    }

    #[test]
    fn a_damaged_file_is_measured_anew_and_mended() {
        let folder = tempfile::tempdir().unwrap();
        remembered(folder.path(), &key(), || Ok(TIMES)).unwrap();
        let file = fs::read_dir(folder.path()).unwrap().next().unwrap().unwrap().path();
        let whole = fs::read(&file).unwrap();
        let other = Times { tiles: 2.0, raster: 1.0 };
        for place in 0..whole.len() {
            let mut damaged = whole.clone();
            damaged[place] ^= 1;
            for content in [&damaged[..], &whole[..place]] {
                fs::write(&file, content).unwrap();
                let found = remembered(folder.path(), &key(), || Ok(other)).unwrap();
                assert_eq!(found, (other, false), "byte {place}");
            }
            assert_eq!(remembered(folder.path(), &key(), must_not_measure).unwrap(), (other, true));
        }
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_no_error() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a file");
        fs::write(&file, "in the way").unwrap();
        assert_eq!(remembered(&file.join("below"), &key(), || Ok(TIMES)).unwrap(), (TIMES, false));
    }
}
