//! How often the text of a zone is read.

use super::*;
use crate::formats::assemble::assemble;
use std::sync::{Mutex, PoisonError};
use voltet_core::progress::NoProgress;

/// Each read: if it was of points and cells, too, and the places of the arrays.
type Reads = Arc<Mutex<Vec<(bool, Vec<usize>)>>>;

struct CountedZone(OpenZone, Reads);

impl OpenGrid for CountedZone {
    fn head(&self) -> &GridHead {
        self.0.head()
    }

    fn read(&self, geometry: bool, arrays: &[usize], progress: &dyn Progress) -> Result<GridRead> {
        self.1.lock().unwrap_or_else(PoisonError::into_inner).push((geometry, arrays.to_vec()));
        self.0.read(geometry, arrays, progress)
    }
}

#[test]
fn points_cells_and_arrays_of_a_zone_are_read_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.dat");
    let zone = |x: u8| {
        format!(
            "ZONE N=4 E=1 ET=TETRAHEDRON F=FEBLOCK\n{x} {x}9 {x} {x}\n0 0 1 0\n3*0 1\n1 2 3 4\n4*5\n4*6\n1 2 3 4\n"
        )
    };
    std::fs::write(&path, format!("VARIABLES = x y z f g h\n{}{}", zone(0), zone(1))).unwrap();
    let source = Source::open(&path).unwrap();
    let file = Arc::new(TecplotFile::read(&source).unwrap());
    let request = Request {
        scalar: Some("h".into()),
        point_arrays: vec!["f".into(), "h".into()],
        ..Request::default()
    };
    for zone_count in [1, 2] {
        let reads = Vec::from_iter((0..zone_count).map(|_| Reads::default()));
        let piece = |(zone, reads): (usize, &Reads)| {
            let counted = CountedZone(OpenZone::new(&file, zone), reads.clone());
            Piece::of_open(&source, Arc::new(counted))
        };
        let pieces = reads.iter().enumerate().map(piece).collect();
        let grid = assemble(&Dataset { pieces, ..Dataset::default() }, &request, &NoProgress).unwrap();
        assert_eq!(grid.tetrahedra.len(), zone_count);
        assert_eq!(grid.point_arrays["f"].values[..4], [1.0, 2.0, 3.0, 4.0]);
        for reads in &reads {
            assert_eq!(*reads.lock().unwrap(), [(true, vec![0, 2])]);
        }
    }
}
