"""Groups of HDF5 whose links fill more than half a MiB, for the tests of hdf5_heaps.rs: `python make_links.py` (pip install h5py).

The group `links` has 900 links; `many` had 3,500, some of which are no more: blocks of its heap lie three levels deep, and some are gone.
The group `beside` has 20 groups and an array with many attributes, which have a heap of their own.
"""

import gzip
from pathlib import Path

import h5py

HERE = Path(__file__).resolve().parent

path = HERE / "links.h5"
with h5py.File(path, "w", libver="latest") as file:
    links, target, many = (file.create_group(name) for name in ("links", "target", "many"))
    for number in range(900):
        links[f"{number:04}" + "x" * 1500] = target
    links["elsewhere"] = h5py.SoftLink("/target")
    for number in range(3500):
        many[f"{number:04}" + "x" * 1500] = target
    for number in range(1000, 1200):
        del many[f"{number:04}" + "x" * 1500]
    beside = file.create_group("beside")
    for number in range(20):
        beside.create_group(f"{number:02}")
    beside["array"] = [1.0]
    for number in range(20):
        beside["array"].attrs[f"{number:02}"] = number
(HERE / "links.h5.gz").write_bytes(gzip.compress(path.read_bytes(), 9, mtime=0))
path.unlink()
