//! Origins of pictures, and which of them are the same.

use std::path::{Path, PathBuf};
use std::time::{Duration, UNIX_EPOCH};
use voltet_core::field::Plugin;
use voltet_graph::{FileRead, NamedPath, Origins, ResolvedPipeline, SourceSpan, Stamp};
use voltet_io::provenance::Provenance;

fn origins(stamp: Stamp, fingerprint: u64) -> Origins {
    let named = NamedPath {
        parameter: "path".into(),
        path: "run.pvd".into(),
        written: false,
        origin: SourceSpan::Nowhere,
    };
    let files = |name: &str| vec![(PathBuf::from(format!("data/{name}")), stamp)];
    let path = PathBuf::from("data/run.pvd");
    let plugin = Plugin {
        name: "p".into(),
        version: "1".into(),
        path: "p.so".into(),
        bytes: 8,
        fingerprint,
        modified: None,
    };
    Origins {
        files: vec![FileRead {
            node: "grid".into(),
            named,
            path,
            stamp: Some((1, UNIX_EPOCH)),
            beside: files("a.vtu"),
            other_steps: files("b.vtu"),
        }],
        plugins: vec![("gradient".into(), plugin)],
        ..Origins::default()
    }
}

#[test]
fn a_picture_is_of_another_origin_where_any_file_or_plug_in_differs() {
    let stated = ResolvedPipeline::default();
    let of = |origins: &Origins| {
        Provenance::for_picture(origins, (&stated, Path::new("")), "p.png", Path::new("p.png"))
    };
    let at = |seconds, nanoseconds| UNIX_EPOCH + Duration::new(seconds, nanoseconds);
    let own = of(&origins(Some((5, at(9, 1))), 7));
    assert!(own.is_of_same_origin(&of(&origins(Some((5, at(9, 1))), 7))));
    let others =
        [origins(Some((5, at(9, 1))), 8), origins(Some((6, at(9, 1))), 7), origins(Some((5, at(9, 2))), 7)];
    for other in others.into_iter().chain([origins(None, 7)]) {
        assert!(!own.is_of_same_origin(&of(&other)), "{other:?}");
    }
    // Alone a file of another step, whose size and time are not the last ones.
    let mut other = origins(Some((5, at(9, 1))), 7);
    other.files[0].other_steps.push(("data/c.vtu".into(), Some((0, at(1, 0)))));
    let with_one = of(&other);
    other.files[0].other_steps[1].1 = Some((0, at(2, 0)));
    assert!(!with_one.is_of_same_origin(&of(&other)));
    let steps = with_one.data[0].other_steps.as_ref().unwrap();
    assert_eq!((steps.files, steps.bytes, &steps.names[..]), (2, 5, &["b.vtu".into(), "c.vtu".into()][..]));
}
