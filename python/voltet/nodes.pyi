# Made by scripts/stubs.py from the program's declarations.
from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Literal

from ._node import Node
from ._pipeline import Pipeline

__all__ = ["annotation", "bands", "boundary", "calculator", "camera", "composite", "contour", "cull", "edges", "gpu_renderer", "gradient_magnitude", "grid_writer", "histogram", "image_writer", "multi_gradient", "probe", "project", "reader", "renderer", "report_writer", "slice", "slice_image", "sort", "surface_reader", "threshold", "transfer_function", "wavelet"]

_Source = str | Node | Sequence[str | Node]

def reader(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    path: str | PathLike[str],
    scalar: str | None = None,
    association: Literal["auto", "point", "cell"] | None = None,
    cell_values: Literal["average", "constant"] | None = None,
    blocks: Sequence[str] | None = None,
    displacement: str | None = None,
    displacement_factor: float | None = None,
    time_step: int | str | None = None,
    time: float | None = None,
    subdivision: int | None = None,
    solution: str | PathLike[str] | None = None,
) -> Node:
    """Reads a data file: its cells as tetrahedra, one scalar, and the arrays that other nodes use."""
def wavelet(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    resolution: Sequence[int] | None = None,
    field: Literal["wavelet", "distance"] | None = None,
    jitter: float | None = None,
) -> Node:
    """Computes a grid of tetrahedra and a field on it, of any size: VTK's analytic source "Wavelet"."""
def calculator(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    grid: _Source | None = None,
    other: _Source | None = None,
    expression: str,
    name: str | None = None,
    association: Literal["point", "cell"] | None = None,
    cell_values: Literal["average", "constant"] | None = None,
    scalar: bool | None = None,
    method: str | None = None,
    units: Sequence[str] | None = None,
    unit: str | None = None,
    length_unit: str | None = None,
    **of_method: Any,
) -> Node:
    """Computes an array from others by an expression, and makes it the scalar that is drawn."""
def gradient_magnitude(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    grid: _Source | None = None,
    method: str | None = None,
    **of_method: Any,
) -> Node:
    """Computes the gradient of the scalar and its length, by a filter of your choice."""
def multi_gradient(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    volume: _Source | None = None,
    fields: Sequence[str],
    scale: Sequence[float] | None = None,
    name: str | None = None,
    method: str | None = None,
    **of_method: Any,
) -> Node:
    """Computes the magnitude of the gradients of several fields together, as a point array."""
def threshold(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    volume: _Source | None = None,
    array: str | None = None,
    association: Literal["point", "cell"] | None = None,
    range: Sequence[float | str] | None = None,
    values: Sequence[float] | None = None,
    clip: Sequence[Mapping[str, Any]] | None = None,
    blocks: Sequence[str] | None = None,
    keep: Literal["all", "any"] | None = None,
    smooth: bool | None = None,
    invert: bool | None = None,
    relative_to: Literal["step", "sample", "series"] | None = None,
) -> Node:
    """Keeps the cells in which an array has values of a range or a list, or those of a part of space or of blocks."""
def probe(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    volume: _Source | None = None,
    box: Mapping[str, Any] | None = None,
    sphere: Mapping[str, Any] | None = None,
    points: Sequence[Sequence[float | str]] | None = None,
    mask: Mapping[str, Any] | None = None,
    fields: Sequence[str] | None = None,
    color: Sequence[float] | str | None = None,
    extinction: float | None = None,
    sigma_scale: float | None = None,
    least_sigma: float | None = None,
    correlated: bool | None = None,
) -> Node:
    """Places a Gaussian widget on the data of a region: their mean, deviations and correlation there."""
def histogram(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    volume: _Source | None = None,
    bins: Sequence[int] | None = None,
    s: Sequence[float] | None = None,
    g: Sequence[float] | None = None,
    scale: Literal["log", "linear"] | None = None,
    decades: float | None = None,
    magnify: int | None = None,
) -> Node:
    """Gives the volume in each bin of the scalar and its gradient magnitude, exact within every cell."""
def transfer_function(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    volume: _Source | None = None,
    model: Literal["density-emitter", "constant-emitter"] | None = None,
    cutoff: float | None = None,
    unit_distance: float | str | None = None,
    relative_to: Literal["step", "sample", "series"] | None = None,
    widgets: Sequence[Mapping[str, Any]] | None = None,
    s_scale: Literal["linear", "log", "symlog"] | None = None,
    s_linear_below: float | None = None,
    g_scale: Literal["linear", "log", "symlog"] | None = None,
    g_linear_below: float | None = None,
) -> Node:
    """Turns the scalar and its gradient magnitude into colour and extinction, by a list of widgets."""
def bands(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    volume: _Source | None = None,
    transfer_function: _Source | None = None,
) -> Node:
    """Says how many bands of each wave widget the cells cross: more than one is finer than the grid."""
def contour(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    volume: _Source | None = None,
    array: str | None = None,
    values: Sequence[float | str],
    smooth: bool | None = None,
    relative_to: Literal["step", "sample", "series"] | None = None,
    color: Sequence[float] | str | None = None,
    color_by: str | None = None,
    colormap: str | PathLike[str] | None = None,
    reversed: bool | None = None,
    steps: int | None = None,
    range: Sequence[float | str] | None = None,
    opacity: float | None = None,
    ambient: float | None = None,
) -> Node:
    """Makes surfaces on which a quantity has given values, exact for values that are linear in each cell."""
def slice(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    volume: _Source | None = None,
    origin: Sequence[float | str] | None = None,
    normal: Sequence[float] | None = None,
    shape: Literal["plane", "sphere", "cylinder"] | None = None,
    radius: float | str | None = None,
    relative_to: Literal["step", "sample", "series"] | None = None,
    color: Sequence[float] | str | None = None,
    color_by: str | None = None,
    colormap: str | PathLike[str] | None = None,
    reversed: bool | None = None,
    steps: int | None = None,
    range: Sequence[float | str] | None = None,
    opacity: float | None = None,
    ambient: float | None = None,
) -> Node:
    """Cuts the cells by a plane, a sphere or a cylinder, and colours the cut by values there."""
def boundary(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    volume: _Source | None = None,
    smooth: bool | None = None,
    feature_angle: float | None = None,
    relative_to: Literal["step", "sample", "series"] | None = None,
    color: Sequence[float] | str | None = None,
    color_by: str | None = None,
    colormap: str | PathLike[str] | None = None,
    reversed: bool | None = None,
    steps: int | None = None,
    range: Sequence[float | str] | None = None,
    opacity: float | None = None,
    ambient: float | None = None,
) -> Node:
    """Makes a surface of the faces that one cell alone has: the outside of the grid."""
def edges(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    volume: _Source | None = None,
    kind: Literal["features", "cells", "outline"] | None = None,
    feature_angle: float | None = None,
    radius: float | str | None = None,
    sides: int | None = None,
    relative_to: Literal["step", "sample", "series"] | None = None,
    color: Sequence[float] | str | None = None,
    color_by: str | None = None,
    colormap: str | PathLike[str] | None = None,
    reversed: bool | None = None,
    steps: int | None = None,
    range: Sequence[float | str] | None = None,
    opacity: float | None = None,
    ambient: float | None = None,
) -> Node:
    """Makes tubes of edges: of the cells on the outside of the grid, of its features, or of the box of the data."""
def surface_reader(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    path: str | PathLike[str],
    style: Literal["surface", "wireframe"] | None = None,
    smooth: bool | None = None,
    radius: float | str | None = None,
    sides: int | None = None,
    bad: Sequence[float] | str | None = None,
    color: Sequence[float] | str | None = None,
    color_by: str | None = None,
    colormap: str | PathLike[str] | None = None,
    reversed: bool | None = None,
    steps: int | None = None,
    range: Sequence[float | str] | None = None,
    opacity: float | None = None,
    ambient: float | None = None,
) -> Node:
    """Reads a surface file: polygons as triangles, lines as tubes, points as spheres, and what they are coloured by."""
def camera(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    volume: _Source | None = None,
    view: Literal["+x", "-x", "+y", "-y", "+z", "-z", "isometric"] | None = None,
    direction: Sequence[float] | None = None,
    fit: Sequence[float | str] | None = None,
    eye: Sequence[float] | None = None,
    target: Sequence[float] | None = None,
    up: Sequence[float] | None = None,
    azimuth: float | None = None,
    elevation: float | None = None,
    roll: float | None = None,
    zoom: float | None = None,
    fov_y: float | None = None,
    height: float | str | None = None,
    near: float | None = None,
    size: Sequence[int] | None = None,
    samples: int | None = None,
    relative_to: Literal["step", "sample", "series"] | None = None,
    orbit: float | None = None,
    keys: Sequence[Sequence[float]] | None = None,
    phase: float | None = None,
) -> Node:
    """Says where the picture is seen from, how wide the view is and how many pixels it has."""
def cull(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    volume: _Source | None = None,
    transfer_function: _Source | None = None,
    camera: _Source | None = None,
) -> Node:
    """Keeps the cells that could contribute: those that a widget touches and that the camera sees."""
def sort(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    cells: _Source | None = None,
    camera: _Source | None = None,
    order: Literal["exact", "centroid", "none", "auto"] | None = None,
) -> Node:
    """Says in which order ray segments are composited; the exact order is carried out pixel by pixel."""
def project(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    cells: _Source | None = None,
    camera: _Source | None = None,
) -> Node:
    """Projects each cell's silhouette, and prepares what the compositor walks."""
def composite(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    projection: _Source | None = None,
    transfer_function: _Source | None = None,
    surfaces: _Source | None = None,
    integrator: Literal["analytic", "adaptive", "reference", "segments", "riemann", "pre-integrated", "pre-integrated-cylindrical", "vertex-sampled", "tabulated"] | None = None,
    overlap: Literal["exact", "mix"] | None = None,
    silhouette: float | None = None,
    light: Mapping[str, Any] | None = None,
    clip: Sequence[Mapping[str, Any]] | None = None,
    tolerance: float | None = None,
    segments: int | None = None,
    table_size: int | None = None,
    oversampling: int | None = None,
    planes: int | None = None,
) -> Node:
    """Integrates every ray segment and composites each pixel's segments front to back."""
def renderer(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    volume: _Source | None = None,
    transfer_function: _Source | None = None,
    camera: _Source | None = None,
    surfaces: _Source | None = None,
    engine: Literal["auto", "cpu", "gpu"] | None = None,
    adapter: str | None = None,
    compositor: Literal["auto", "tiles", "raster"] | None = None,
    order: Literal["exact", "centroid", "none", "auto"] | None = None,
    integrator: Literal["analytic", "adaptive", "reference", "segments", "riemann", "pre-integrated", "pre-integrated-cylindrical", "vertex-sampled", "tabulated"] | None = None,
    overlap: Literal["exact", "mix"] | None = None,
    silhouette: float | None = None,
    light: Mapping[str, Any] | None = None,
    clip: Sequence[Mapping[str, Any]] | None = None,
    tolerance: float | None = None,
    segments: int | None = None,
    table_size: int | None = None,
    oversampling: int | None = None,
    planes: int | None = None,
) -> Node:
    """Draws a volume in one node: culls, sorts, projects and composites."""
def gpu_renderer(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    volume: _Source | None = None,
    transfer_function: _Source | None = None,
    camera: _Source | None = None,
    surfaces: _Source | None = None,
    adapter: str | None = None,
    compositor: Literal["auto", "tiles", "raster"] | None = None,
    order: Literal["exact", "centroid", "none", "auto"] | None = None,
    integrator: Literal["analytic", "adaptive", "reference", "segments", "riemann", "pre-integrated", "pre-integrated-cylindrical", "vertex-sampled", "tabulated"] | None = None,
    overlap: Literal["exact", "mix"] | None = None,
    silhouette: float | None = None,
    light: Mapping[str, Any] | None = None,
    clip: Sequence[Mapping[str, Any]] | None = None,
    tolerance: float | None = None,
    segments: int | None = None,
    table_size: int | None = None,
    oversampling: int | None = None,
    planes: int | None = None,
) -> Node:
    """Draws a volume on the graphics device, where the grid stays: culls, projects, sorts and composites."""
def slice_image(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    volume: _Source | None = None,
    camera: _Source | None = None,
    transfer_function: _Source | None = None,
    origin: Sequence[float | str] | None = None,
    normal: Sequence[float] | None = None,
    color_by: str | None = None,
    colormap: str | PathLike[str] | None = None,
    reversed: bool | None = None,
    steps: int | None = None,
    range: Sequence[float | str] | None = None,
    relative_to: Literal["step", "sample", "series"] | None = None,
    thickness: float | None = None,
) -> Node:
    """Draws a plane through the cells alone: colours of values, or those of a transfer function at each place."""
def annotation(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    image: _Source | None = None,
    transfer_function: _Source | None = None,
    volume: _Source | None = None,
    camera: _Source | None = None,
    title: str | None = None,
    text: str | None = None,
    texts: Sequence[Mapping[str, Any]] | None = None,
    bar: Literal["right", "left", "bottom", "top", "none"] | None = None,
    bar_title: str | None = None,
    bar_range: Sequence[float] | None = None,
    unit: str | None = None,
    axes: Literal["none", "box", "directions"] | None = None,
    scale_bar: bool | None = None,
    length_unit: str | None = None,
    theme: Literal["dark", "light"] | None = None,
    scale: float | None = None,
) -> Node:
    """Writes a title, texts, the scale of the colours, axes and a scale bar over a picture."""
def grid_writer(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    volume: _Source | None = None,
    cell_values: _Source | None = None,
    path: str | PathLike[str],
    arrays: Sequence[str] | None = None,
    point_arrays: Sequence[str] | None = None,
    cell_arrays: Sequence[str] | None = None,
    cells: Literal["auto", "file", "tetrahedra"] | None = None,
    precision: Literal["auto", "single", "double"] | None = None,
    compression: Literal["none", "zlib"] | None = None,
) -> Node:
    """Writes the grid with what was computed of it as .vtu or .vtkhdf: gradient, culled cells, bands, arrays of the file."""
def image_writer(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    image: _Source | None = None,
    path: str | PathLike[str],
    format: Literal["auto", "png", "exr", "tiff", "webp", "jpeg", "svg", "pdf"] | None = None,
    background: Sequence[float] | str | None = None,
    alpha: bool | None = None,
    bits: int | None = None,
    layers: Sequence[str] | None = None,
    provenance: bool | None = None,
) -> Node:
    """Writes a picture in the format that its path ends in."""
def report_writer(
    pipeline: Pipeline,
    node: str,
    /,
    *,
    report: _Source | None = None,
    path: str | PathLike[str],
    format: Literal["auto", "json", "csv"] | None = None,
) -> Node:
    """Writes figures: .json with all there is, .csv with the table alone."""
