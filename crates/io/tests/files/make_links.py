"""A group of HDF5 whose links fill more than half a MiB, for the test of hdf5_heaps.rs: `python make_links.py` (pip install h5py)."""

import gzip
from pathlib import Path

import h5py

HERE = Path(__file__).resolve().parent

path = HERE / "links.h5"
with h5py.File(path, "w", libver="latest") as file:
    links, target = file.create_group("links"), file.create_group("target")
    for number in range(900):
        links[f"{number:04}" + "x" * 1500] = target
    links["elsewhere"] = h5py.SoftLink("/target")
(HERE / "links.h5.gz").write_bytes(gzip.compress(path.read_bytes(), 9, mtime=0))
path.unlink()
