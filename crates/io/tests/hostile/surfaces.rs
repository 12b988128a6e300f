//! Surface files cut short everywhere, and with bits of each byte changed.

use crate::memory::peak_of;
use voltet_core::progress::NoProgress;
use voltet_io::formats::{SurfaceColors, read_surface};
use voltet_testing::files::surfaces::{PIECES, POINTS, ply, stl_binary, stl_text};

/// Beside the file's own bytes: buffers, error texts, and what the PLY crate sets aside for its rows at once (65,536).
const ALLOWED: usize = 16 << 20;

#[test]
fn no_damage_panics_or_takes_much_memory() {
    let points: String = POINTS.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
    let cloud = "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
                 property uchar red\nproperty uchar green\nproperty uchar blue\nelement edge 1\nproperty int vertex1\n\
                 property int vertex2\nend_header\n";
    let cloud = [cloud.as_bytes(), &[0; 30], &[1, 0, 0, 0, 0, 0, 0, 0]].concat();
    let files: [(&str, Vec<u8>, Option<&str>); 9] = [
        ("a.stl", stl_text(" a").into_bytes(), None),
        ("a.stl", stl_binary("x"), None),
        ("a.ply", ply("ascii"), Some("level")),
        ("a.ply", ply("binary_little_endian"), Some("load")),
        ("a.ply", ply("binary_big_endian"), None),
        (
            "a.obj",
            format!("{points}vn 0 0 1\nf 1//1 2//-1 3//1 4//1\nf -1 2/3 4\nl 1 2 -1\np 3\n").into_bytes(),
            None,
        ),
        ("a.ply", cloud, None),
        ("a.csv", b"x,y,z,\"T\"\n1,2,3,4\n5,6,7,\n".to_vec(), Some("T")),
        ("a.vtp", PIECES.as_bytes().to_vec(), Some("part")),
    ];
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes, array) in files {
        let path = folder.path().join(name);
        let attempt = |damaged: &[u8], what: &str| {
            std::fs::write(&path, damaged).unwrap();
            let colors = array.map_or(SurfaceColors::Own, SurfaceColors::Array);
            let (read, peak) = peak_of(|| read_surface(&path, colors, array.is_none(), &NoProgress));
            assert!(peak < ALLOWED, "{what}: {peak} bytes");
            match read {
                Ok(surface) => {
                    let count = surface.points.len();
                    let lines = surface.lines.concat();
                    let mut all =
                        surface.triangles.as_flattened().iter().chain(&lines).chain(&surface.vertices);
                    assert!(all.all(|&p| (p as usize) < count), "{what}");
                    let fits = |given: usize| given == count || given == 0;
                    assert!(fits(surface.normals.len()), "{what}");
                    assert!(surface.values.is_none_or(|values| values.len() == count), "{what}");
                    assert!(surface.colors.is_none_or(|colors| colors.len() == count), "{what}");
                }
                Err(error) => {
                    assert!(error.location.file.is_some() && !error.what.is_empty(), "{what}: {error}")
                }
            }
        };
        // Long texts are much alike.
        for at in (0..bytes.len()).step_by(if bytes.len() > 900 { 3 } else { 1 }) {
            attempt(&bytes[..at], &format!("{name} cut at {at}"));
            for bit in [at % 8, (at + 5) % 8] {
                let mut damaged = bytes.clone();
                damaged[at] ^= 1 << bit;
                attempt(&damaged, &format!("{name} with bit {bit} of byte {at} changed"));
            }
            if bytes[at].is_ascii_digit() {
                let mut damaged = bytes.clone();
                damaged.splice(at..at, *b"999999999");
                attempt(&damaged, &format!("{name} with a large number at {at}"));
            }
        }
    }
}
