"""A pipeline about a grid, to begin with."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from inspect import signature
from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from ._colors import colormap_widget
from ._declared import parameters, ports
from ._errors import mapping, nearest_or_one_of, number, picture_size, sequence, usage, warn
from ._grid import Grid, scalar_name
from ._picture import Picture
from ._pipeline import Pipeline
from ._progress import Progress


def scene(
    grid: Any,
    scalar: str | None = None,
    *,
    cmap: Any = None,
    clim: Sequence[Any] | None = None,
    opacity: str | Sequence[Sequence[float]] | None = None,
    extinction: float | None = None,
    widgets: Sequence[Mapping[str, Any]] | None = None,
    camera: Mapping[str, Any] | None = None,
    size: tuple[int, int] = (640, 480),
    method: str | Mapping[str, Any] | None = None,
    unit_distance: float | None = None,
    look: Mapping[str, Any] | None = None,
    surfaces: Sequence[Mapping[str, Any]] | None = None,
    clip: Sequence[Mapping[str, Any]] | None = None,
    annotation: Mapping[str, Any] | None = None,
    **renderer: Any,
) -> Pipeline:
    """A pipeline that draws a grid of yours: nodes `grid`, `gradient`, `look`, `view`, `picture`; `surface_0` and so on, and `figure` with an
    annotation.

    Parameters
    ----------
    grid : Grid or mesh
        The grid, or what `Grid.from_mesh` makes one of: a PyVista, VTK or meshio mesh, an xarray.Dataset of UGRID, an array, ….
    scalar : str
        The quantity that is drawn: `"T"`, `"U:magnitude"`, `"U:0"`. Default: the grid's.
    cmap : str, path, Colormap or list of colours
        Colours along the scalar: a colour map of voltet (`"viridis"`, `"inferno_r"`, …), a file of ParaView's, or one of matplotlib.
    clim : pair
        The scalar at the ends of the colours: numbers, or `"5 %"` and `"p95"` for maps of voltet. Default: the range of the data.
    opacity : str or list of [place, share]
        The extinction along the colours: `"ramp"` (default), `"fall"`, `"constant"`, …, or points from 0 to 1.
    extinction : float
        That where opacity is 1, per unit distance. Default: 0.08.
    widgets : list of dict
        A transfer function over s and g in their place, by `voltet.widgets`.
    camera : mapping
        Parameters of the node `camera`; those that are left out are chosen so that the whole grid is seen, also from the side of a
        `view` such as `"+x"` or from a `direction`.
    size : pair of int
        Width and height in pixels.
    method : str or mapping
        The gradient filter, or a mapping of `method` and its parameters.
    unit_distance : float
        The length over which extinction is stated. Default: a hundredth of the grid's diagonal.
    look : mapping
        Further parameters of the node `transfer-function`, such as `{"s_scale": "log"}`.
    surfaces : list of mapping
        Surfaces in the volume: the `type` of a node that makes one, `"contour"`, `"slice"`, `"boundary"` or `"surface-reader"`, and its
        parameters, such as `{"type": "slice", "normal": [0, 0, 1]}`.
    clip : list of mapping
        Parts of space in all of which the volume is drawn, as the node `renderer` takes them:
        `{"kind": "plane", "origin": [0, 0, 0], "normal": [0, 0, 1]}`, or a `"box"`, `"sphere"` or `"cylinder"`. What is not stated cuts
        through the middle of the data: `{"kind": "plane"}`.
    annotation : mapping
        Parameters of the node `annotation`, such as `{"title": "…", "axes": "box"}`; `{}` for a colour bar alone. Default: nothing is
        written over the picture.
    **renderer
        Parameters of the node `renderer`, such as `engine="cpu"`, `integrator`, `light`.

    >>> import numpy as np, voltet
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> grid = voltet.Grid(points, tetrahedra=[[0, 1, 2, 3]], point_data={"T": points[:, 0]})
    >>> voltet.scene(grid, size=(32, 24), engine="cpu").render().shape
    (24, 32, 4)
    """
    size = picture_size("size", size)
    is_told = isinstance(grid, _ToldByRun)
    grid = grid.grid if is_told else grid if isinstance(grid, Grid) else Grid.from_mesh(grid)
    about = grid.about
    scalar = scalar_name(scalar) or about["scalar"]
    if scalar is None:
        raise usage("the scalar is not named", None, "one of " + ", ".join(about["arrays"]))
    if not {scalar, scalar.rpartition(":")[0]} & about["arrays"].keys():
        # That of what was left out, which it may be.
        warn(about["warnings"])
    about = grid._about(scalar)
    if not is_told:
        # Before anything is drawn, since a volume that is plotted may never be.
        warn(about["warnings"])
    pipeline = Pipeline()
    pipeline.add("grid", "given-grid", scalar=scalar)
    method = {"method": method} if isinstance(method, str) else _words("method", method, 'a name, or {"method": "least-squares"}', "grid")
    pipeline.add("gradient", "gradient-magnitude", grid="grid", **method)
    pipeline.give(grid, "grid")
    words = {"cmap": cmap, "clim": clim, "opacity": opacity, "extinction": extinction}
    if widgets is None:
        known = about["arrays"].get(scalar, {}).get("range")
        widgets = [colormap_widget(cmap, clim, opacity, 0.08 if extinction is None else number("extinction", extinction), known)]
    elif both := [word for word, value in words.items() if value is not None]:
        raise usage("the transfer function is stated twice", f"'widgets' and '{both[0]}'", "one of them")
    widgets = sequence("widgets", widgets, "[voltet.widgets.uniform(…)]")
    # By which numbers may be relative to the data.
    further = _words("look", look, '{"s_scale": "log"}', "volume", "widgets", "unit_distance")
    pipeline.add("look", "transfer-function", volume="gradient", widgets=widgets, unit_distance=unit_distance, **further)
    camera = _words("camera", camera, '{"view": "+x"}, or {"eye": [x, y, z], "target": [x, y, z]}', "volume")
    placed = {"volume": "gradient", "size": list(size)} if {"view", "direction"} & camera.keys() else _fitted(about["bounds"], size)
    pipeline.add("view", "camera", **{**placed, **camera})
    wires: dict[str, Any] = {"volume": "gradient", "transfer_function": "look", "camera": "view"}
    given = sequence("surfaces", surfaces, '[{"type": "boundary"}]')
    drawn = [_surface(pipeline, f"surface_{number}", surface) for number, surface in enumerate(given)]
    clips = sequence("clip", clip, '[{"kind": "plane", "origin": [0, 0, 0], "normal": [0, 0, 1]}]')
    renderer = _words("the renderer", renderer, "", *wires)
    for word in renderer:
        if word not in parameters("renderer"):
            raise _unknown(word)
    pipeline.add("picture", "renderer", **wires, surfaces=drawn or None, clip=clips or None, **renderer)
    if annotation is not None:
        written = _words("annotation", annotation, '{} for a colour bar, {"title": "T"}, or None for no annotation', "image", *wires)
        pipeline.add("figure", "annotation", image="picture", **wires, **written)
    return pipeline


class _ToldByRun(NamedTuple):
    """A grid whose warnings a run will show."""

    grid: Grid


def pipeline_of(grid: Grid, scalar: str | None = None, **options: Any) -> Pipeline:
    """As `scene`, without the grid's warnings, which a run shows."""
    return scene(_ToldByRun(grid), scalar, **options)


def render(mesh: Any, scalars: str | None = None, *, progress: bool | None | Progress = None, **options: Any) -> Picture:
    """The picture of a mesh, in one line: `voltet.render(mesh, "T", cmap="inferno")`.

    Parameters
    ----------
    mesh : mesh
        A PyVista or VTK data set, a `meshio.Mesh`, an `xarray.Dataset` of UGRID, a `Grid`, a mapping of its arguments, or an array of
        three dimensions; see `Grid.from_mesh`.
    scalars : str
        The quantity that is drawn: `"T"`, `"U:magnitude"`, `"U:0"`. Default: the mesh's active scalars, or its only one.
    progress : True or function
        A bar, or a function of (node, stage, fraction); what it raises stops the run.
    **options
        As of `scene`: `cmap`, `clim`, `opacity`, `widgets`, `camera`, `size`, `surfaces`, `clip`, `annotation`, `engine`, ….

    Returns
    -------
    Picture
        A float32 array, height × width × 4, premultiplied linear RGBA, row 0 at the top, with its `report`; notebooks show it.

    >>> import numpy as np, voltet
    >>> x, y, z = np.mgrid[-1:1:8j, -1:1:8j, -1:1:8j]
    >>> voltet.render(x * x + y * y + z * z, cmap="inferno", size=(32, 24), engine="cpu").shape
    (24, 32, 4)
    """
    for word, own in (("grid", "mesh"), ("scalar", "scalars")):
        if word in options:
            raise usage(f"unknown word '{word}'", None, f"'{own}'")
    grid = mesh if isinstance(mesh, Grid) else Grid.from_mesh(mesh)
    return pipeline_of(grid, scalars, **options).render(progress=progress)


def _words(name: str, value: Any, expected: str, *own: str) -> dict[str, Any]:
    """Parameters of a node in a mapping, without those that the scene states itself."""
    words = mapping(name, value, expected)
    if both := [word for word in (*own, "inputs") if word in words]:
        remedy = f"{both[0]}=… of the scene itself" if both[0] in signature(scene).parameters else "a pipeline of your own, whose nodes are wired freely"
        raise usage(f"the scene states '{both[0]}' itself", f"in {name}", remedy)
    return words


def _unknown(word: str) -> Exception:
    """The exception for a word that neither a scene nor the node `renderer` has."""
    own = [name for name in signature(scene).parameters if name not in ("grid", "renderer")]
    known = list(dict.fromkeys([*own, *parameters("renderer")]))
    return usage(f"unknown word '{word}'", None, nearest_or_one_of(word, known, known))


def _surface(pipeline: Pipeline, name: str, given: Mapping[str, Any]) -> str:
    """The node of a surface, added under this name."""
    if not isinstance(given, Mapping) or "type" not in given:
        raise usage("a surface is not stated", given, 'a mapping of "type" and parameters, such as {"type": "boundary"}')
    type = given["type"]
    if not isinstance(type, str):
        raise usage("the type of a surface is no name", repr(type)[:80], '"contour", "slice", "boundary" or "surface-reader"')
    parameters = _words("a surface", {word: value for word, value in given.items() if word != "type"}, '{"type": "boundary"}', "volume")
    volume: dict[str, Any] = {"volume": "gradient"} if "volume" in ports(type) else {}
    pipeline.add(name, type, **volume, **parameters)
    return name


def _fitted(bounds: Sequence[Sequence[float]], size: tuple[int, int]) -> dict[str, Any]:
    """A camera that looks from the front, the side and above at all of a box."""
    low, high = np.asarray(bounds, float)
    middle, radius = 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))
    direction = np.array([-1.0, -2.0, 1.0]) / sqrt(6.0)
    fov = 30.0
    # The ball about the box fits the narrower side.
    narrow = min(1.0, size[0] / size[1])
    distance = radius / np.sin(np.arctan(narrow * np.tan(np.radians(fov / 2))))
    return {
        "eye": (middle + distance * direction).tolist(),
        "target": middle.tolist(),
        "up": [0.0, 0.0, 1.0],
        "fov_y": fov,
        "size": list(size),
    }
