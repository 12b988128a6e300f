"""Groups of HDF5 whose links fill more than half a MiB, for the tests of hdf5_heaps.rs: `python make_links.py` (pip install h5py).

The group `links` has 900 links; `many` had 3,500, some of which are no more: blocks of its heap lie three levels deep, and some are gone.
The group `beside` has 20 groups and an array with many attributes, which have a heap of their own.

Each of the 20 groups in `among` of among_old.h5 and among_new.h5, of the older and the newer form, has an array and links by path and
to the file other.h5; the last has a link to what is in the first.
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


def pack(path: Path) -> None:
    """Replaces a file by one that gzip makes of it."""
    path.with_name(path.name + ".gz").write_bytes(gzip.compress(path.read_bytes(), 9, mtime=0))
    path.unlink()


pack(path)
for form, version in (("old", "earliest"), ("new", "latest")):
    with h5py.File(HERE / f"among_{form}.h5", "w", libver=version) as file:
        file["alone"] = [9.0]
        file["common/values"] = [7.0, 8.0]
        file["common/among"] = h5py.ExternalLink("other.h5", "/among")
        for number in range(20):
            name = "07 é%2F\\x2f" if number == 7 else f"{number:02}"
            group = file.create_group(f"among/{name}")
            group.attrs["name"] = name
            group["own"] = [float(number)]
            for link, place in (("alone", "/alone"), ("near", "own"), ("root", "/"), ("shared", "/common/values")):
                group[link] = h5py.SoftLink(place)
            group["other"] = h5py.ExternalLink("other.h5", f"/among/{name}")
        group["first"] = h5py.SoftLink("/among/00/own")
    pack(HERE / f"among_{form}.h5")
