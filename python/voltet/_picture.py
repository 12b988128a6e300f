"""Pictures, and what runs give."""

from __future__ import annotations

import json
from functools import cached_property
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _native
from ._errors import real_numbers, usage

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Account:
    """What a run did, put into words when it is asked for."""

    def __init__(self, native: _native.Report):
        self._native = native

    def __getstate__(self) -> dict[str, Any]:
        return {"report": self.report}

    @cached_property
    def report(self) -> dict[str, Any]:
        whole = json.loads(self._native.json())
        return {**(whole["runs"][0] if whole["runs"] else {}), **whole}


class Picture(np.ndarray):
    """A picture: a float32 array of height × width × 4, premultiplied linear RGBA, row 0 at the top; with its `report`."""

    _account: Account | None

    def __array_finalize__(self, parent):
        self._account = getattr(parent, "_account", None)

    @property
    def report(self) -> dict[str, Any]:
        """What was done for it, as `voltet run --report` says it; empty where nothing is known."""
        return {} if self._account is None else self._account.report

    def __reduce__(self) -> tuple[Any, ...]:
        # What rebuilds the array, its arguments, and its state.
        parts: Any = super().__reduce__()
        return parts[0], parts[1], (parts[2], self._account)

    def __setstate__(self, state: Any) -> None:
        array, self._account = state
        super().__setstate__(array)

    def __array_wrap__(self, array, context=None, return_scalar=False):
        # What was computed of a picture is an array.
        return array[()] if return_scalar else np.asarray(array)

    def srgb8(self, background: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> NDArray[np.uint8]:
        """The picture over a background (linear RGB), for a screen: height × width × 3 bytes, sRGB."""
        rgba = self._checked()
        linear = rgba[..., :3] + (1.0 - rgba[..., 3:]) * np.asarray(_linear_rgb(background), np.float32)
        return _srgb8(linear)

    def rgba8(self) -> NDArray[np.uint8]:
        """The picture for programs that lay it over others: height × width × 4 bytes, sRGB not premultiplied, alpha."""
        rgba = self._checked()
        alpha = rgba[..., 3:]
        straight = np.divide(rgba[..., :3], alpha, out=np.zeros_like(rgba[..., :3]), where=alpha > 0)
        opacity = np.rint(255.0 * np.clip(alpha, 0.0, 1.0)).astype(np.uint8)
        return np.concatenate([_srgb8(straight), opacity], axis=-1)

    def save(self, path: str | PathLike[str], background: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> None:
        """Writes the format that the path ends in, such as .png (8-bit sRGB over a background in linear RGB) or .exr (32-bit floats)."""
        data = self._encoded(fspath(path), background)
        with open(path, "wb") as file:
            file.write(data)

    def _checked(self) -> NDArray[np.float32]:
        if self.ndim != 3 or self.shape[2] != 4:
            raise usage("a part of a picture is no picture", f"shape {self.shape}", "(height, width, 4)")
        return np.asarray(self, np.float32)

    def _encoded(self, path: str, background: tuple[float, float, float]) -> bytes:
        return _native.encode(np.ascontiguousarray(self._checked()), path, _linear_rgb(background))

    def _repr_png_(self) -> bytes | None:
        if self.ndim != 3 or self.shape[2] != 4 or self.size == 0:
            return None
        return self._encoded("a.png", (0.0, 0.0, 0.0))


def _linear_rgb(background: Any) -> tuple[float, float, float]:
    """A background's three numbers."""
    if (rgb := real_numbers(background, 3)) is None:
        raise usage("the background is no colour", repr(background)[:80], "linear red, green and blue, as (1, 1, 1) for white")
    red, green, blue = rgb
    return red, green, blue


def encoded_srgb(linear: NDArray[Any]) -> NDArray[Any]:
    """IEC 61966-2-1, from 0 to 1."""
    v = np.clip(linear, 0.0, 1.0)
    return np.where(v <= 0.0031308, 12.92 * v, 1.055 * np.power(v, 1.0 / 2.4) - 0.055)


def _srgb8(linear: NDArray[np.float32]) -> NDArray[np.uint8]:
    return np.rint(255.0 * encoded_srgb(linear)).astype(np.uint8)


class Result:
    """What a run gave.

    Attributes
    ----------
    images : dict of str to Picture
        The picture of every node that gave one: float32, height × width × 4, premultiplied linear RGBA, row 0 at the top.
    """

    def __init__(self, images: dict[str, NDArray[np.float32]], account: Account):
        self._account = account
        self.images = {name: picture(rgba, account) for name, rgba in images.items()}

    @property
    def report(self) -> dict[str, Any]:
        """What `voltet run --report` writes; as there is one run, its keys stand at the top, too: `engine`, `seconds`, `counts`, …."""
        return self._account.report

    @property
    def found(self) -> dict[str, Any]:
        """What nodes found out about the data (probes, histograms, bands): figures by node."""
        return {finding["node"]: finding["figures"] for finding in self.report["findings"]}

    @property
    def files(self) -> list[str]:
        """The files that were written."""
        return self.report["files"]

    @property
    def warnings(self) -> list[str]:
        """What should be known; each a sentence."""
        return self.report["warnings"]

    def __repr__(self) -> str:
        images = ", ".join(f"{name} {rgba.shape[1]} × {rgba.shape[0]}" for name, rgba in self.images.items())
        return f"<voltet.Result: {images or 'no pictures'}, {self.report['seconds']:.2f} s>"

    def _repr_html_(self) -> str:
        from base64 import b64encode

        from ._html import table

        report = self.report
        counts = {name: count for name, count in report["counts"].items() if count}
        rows = [("engine", report["engine"]), ("seconds", f"{report['seconds']:.3f}")]
        rows += [(name.replace("_", " "), f"{count:,}") for name, count in counts.items()]
        pictures = "".join(
            f"<figure><img src='data:image/png;base64,{b64encode(shown).decode()}'/><figcaption>{name}</figcaption></figure>"
            for name, rgba in self.images.items()
            if (shown := rgba._repr_png_())
        )
        return pictures + table("Run", rows, self.warnings)


def picture(rgba: NDArray[np.float32], account: Account | None = None) -> Picture:
    """An array as a picture, with what is known of how it was made."""
    shown = rgba if isinstance(rgba, Picture) else rgba.view(Picture)
    shown._account = account
    return shown
