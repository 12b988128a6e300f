"""Arrays of HDF5 in chunks of many forms, for the test of hdf5_chunks.rs: `python make_chunks.py` (pip install h5py numpy)."""

import gzip
from pathlib import Path

import h5py
import numpy as np

HERE = Path(__file__).resolve().parent
# Name, type, shape, chunks, options; those whose names begin with "other" are of a kind that the crate hdf5-reader decodes.
FORMS = [
    ("line", "<f8", (1000,), (64,), dict(compression="gzip")),
    ("plain", "<i4", (1000,), (128,), {}),
    ("shuffled", ">f4", (777,), (100,), dict(compression="gzip", shuffle=True)),
    ("shuffled_alone", "<i2", (500,), (60,), dict(shuffle=True)),
    ("rows", "<f8", (301, 3), (50, 3), dict(compression="gzip", shuffle=True)),
    ("columns", "<i8", (301, 4), (40, 1), dict(compression="gzip")),
    ("tiles", "<f4", (101, 7), (20, 3), dict(compression="gzip")),
    ("tensors", "<f8", (90, 3, 3), (16, 2, 3), dict(compression="gzip")),
    ("large_chunk", "u1", (10, 2), (16, 4), dict(compression="gzip", maxshape=(None, None))),
    ("steps", "<f8", (4, 200), (1, 64), dict(compression="gzip", maxshape=(None, 200))),
    ("other_sum", "<f8", (200,), (64,), dict(compression="gzip", fletcher32=True)),
    ("other_tensors", "<f8", (20, 3, 3), (8, 3, 2), dict(compression="gzip")),
]

path = HERE / "chunks.h5"
with h5py.File(path, "w", libver="earliest") as file:
    for name, kind, shape, chunks, options in FORMS:
        numbers = np.arange(np.prod(shape)).reshape(shape) * 7 % 1013 + (0.25 if "f" in kind else 0)
        file.create_dataset(name, data=numbers.astype(kind), chunks=chunks, **options)
    holes = file.create_dataset("other_holes", (100,), "<f8", chunks=(10,), fillvalue=3.0)
    holes[25:45] = 1.0
(HERE / "chunks.h5.gz").write_bytes(gzip.compress(path.read_bytes(), 9, mtime=0))
path.unlink()
