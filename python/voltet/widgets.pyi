# Made by scripts/stubs.py from the program's declarations.
from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Literal

__all__ = ["colormap", "gaussian", "gaussian_colormap", "gaussian_nd", "piecewise_linear", "sine_wave", "table", "triangle_wave", "triangular_gaussian", "triangular_gaussian_nd", "uniform"]

def uniform(
    *,
    color: Sequence[float] | str,
    extinction: float,
    region: Mapping[str, Any],
    name: str | None = None,
) -> dict[str, Any]:
    """The same extinction everywhere in its region."""
def gaussian(
    *,
    color: Sequence[float] | str,
    extinction: float,
    centre: Sequence[float | str],
    sigma: Sequence[float | str] | None = None,
    matrix: Sequence[Sequence[float | str]] | None = None,
    region: Mapping[str, Any] | None = None,
    name: str | None = None,
) -> dict[str, Any]:
    """A Gaussian over the scalar and its gradient magnitude."""
def gaussian_nd(
    *,
    color: Sequence[float] | str,
    extinction: float,
    fields: Sequence[str],
    centre: Sequence[float | str],
    sigma: Sequence[float | str] | None = None,
    matrix: Sequence[Sequence[float | str]] | None = None,
    region: Mapping[str, Any] | None = None,
    name: str | None = None,
) -> dict[str, Any]:
    """A Gaussian over one to eight point arrays."""
def triangular_gaussian(
    *,
    color: Sequence[float] | str,
    extinction: float,
    centre: float | str,
    sigma: float | str,
    region: Mapping[str, Any] | None = None,
    name: str | None = None,
) -> dict[str, Any]:
    """exp(-((s - centre) / (sigma g))²): a Gaussian in s that widens with the gradient magnitude."""
def triangular_gaussian_nd(
    *,
    color: Sequence[float] | str,
    extinction: float,
    fields: Sequence[str],
    magnitude: str | None = None,
    centre: Sequence[float | str],
    sigma: Sequence[float | str] | None = None,
    matrix: Sequence[Sequence[float | str]] | None = None,
    region: Mapping[str, Any] | None = None,
    name: str | None = None,
) -> dict[str, Any]:
    """A Gaussian over one to seven point arrays that widens with the magnitude of all their gradients."""
def triangle_wave(
    *,
    color: Sequence[float] | str,
    extinction: float,
    origin: Sequence[float | str] | None = None,
    angle: float | None = None,
    scale: Sequence[float | str] | None = None,
    period: float | str,
    band_width: float | None = None,
    region: Mapping[str, Any] | None = None,
    name: str | None = None,
) -> dict[str, Any]:
    """Bands with straight flanks."""
def sine_wave(
    *,
    color: Sequence[float] | str,
    extinction: float,
    origin: Sequence[float | str] | None = None,
    angle: float | None = None,
    scale: Sequence[float | str] | None = None,
    period: float | str,
    band_width: float | None = None,
    region: Mapping[str, Any] | None = None,
    name: str | None = None,
) -> dict[str, Any]:
    """Bands shaped like |sin|."""
def piecewise_linear(
    *,
    points: Sequence[Sequence[float | str]],
    region: Mapping[str, Any] | None = None,
    name: str | None = None,
) -> dict[str, Any]:
    """Colour and extinction linear between control points in s, constant beyond the ends."""
def colormap(
    *,
    colormap: str | PathLike[str] | None = None,
    range: Sequence[float | str] | None = None,
    centre: float | str | None = None,
    extinction: float | None = None,
    opacity: str | Sequence[Sequence[float]] | None = None,
    reversed: bool | None = None,
    steps: int | None = None,
    below: Sequence[float] | str | None = None,
    above: Sequence[float] | str | None = None,
    region: Mapping[str, Any] | None = None,
    name: str | None = None,
) -> dict[str, Any]:
    """A colour map along s, and an opacity curve over it: a piecewise-linear function of s."""
def gaussian_colormap(
    *,
    extinction: float,
    centre: Sequence[float | str],
    sigma: Sequence[float | str],
    colormap: str | PathLike[str] | None = None,
    range: Sequence[float | str] | None = None,
    reversed: bool | None = None,
    steps: int | None = None,
    region: Mapping[str, Any] | None = None,
    name: str | None = None,
) -> dict[str, Any]:
    """A Gaussian over the scalar and its gradient magnitude, in the colours of a map along s."""
def table(
    *,
    color: Sequence[float] | str | None = None,
    extinction: float,
    image: str | PathLike[str],
    s: Sequence[float | str],
    g: Sequence[float | str],
    region: Mapping[str, Any] | None = None,
    name: str | None = None,
) -> dict[str, Any]:
    """A picture over the (s, g) plane: its colour, and its alpha times the extinction."""
