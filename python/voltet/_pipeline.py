"""Pipelines: opened, built, changed, checked, run, saved."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _native
from ._errors import usage
from ._grid import Grid
from ._measured import Measured
from ._node import Node, sources
from ._picture import Account, Picture, Result, picture
from ._progress import Progress, followed

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.image import AxesImage

    from ._series import Frame


class Pipeline(Measured):
    """A pipeline, and what its last run left: what serves again is used again.

    >>> import voltet
    >>> p = voltet.Pipeline(title="A ball of waves")
    >>> _ = p.add("grid", "wavelet", resolution=[8, 8, 8])
    >>> _ = p.add("gradient", "gradient-magnitude", grid="grid")
    >>> _ = p.add("look", "transfer-function", volume="gradient",
    ...           widgets=[voltet.widgets.gaussian(color=[1, 0.5, 0.2], extinction=4, centre=["50 %", "50 %"], sigma=["9 %", "30 %"])])
    >>> _ = p.add("view", "camera", eye=[0, -40, 10], target=[0, 0, 0], size=[64, 48])
    >>> _ = p.add("picture", "renderer", volume="gradient", transfer_function="look", camera="view", engine="cpu")
    >>> p.render().shape
    (48, 64, 4)
    >>> p["view"]["size"] = [32, 24]
    >>> p.render().shape
    (24, 32, 4)

    Its text is that of a pipeline file (`print(pipeline)`); comments and order of a file that was opened stay where nothing is
    changed. One thread at a time may use it.
    """

    def __init__(self, text: str | None = None, *, title: str | None = None):
        self._begin(None, text)
        if title is not None:
            self._native.set_title(title)

    def _begin(self, path: str | None, text: str | None, is_picture: bool = False) -> None:
        self._native = _native.Pipeline(path, text, is_picture)
        self._grids: dict[str, tuple[Grid, _native.Grid | None]] = {}

    @classmethod
    def open(cls, path: str | PathLike[str]) -> Pipeline:
        """Opens a pipeline file, or a picture that carries one."""
        pipeline = cls.__new__(cls)
        pipeline._begin(fspath(path), None)
        return pipeline

    def __getstate__(self) -> dict[str, Any]:
        # Files are found from its folder, wherever the other process works.
        path = None if self.path is None else str(Path(self.path).absolute())
        grids = {name: grid for name, (grid, _) in self._grids.items() if name in self}
        is_picture = self._native.is_picture()
        return {"path": path, "is_picture": is_picture, "text": self.text, "title": self.title, "nodes": len(self), "grids": grids}

    def __setstate__(self, state: dict[str, Any]) -> None:
        # A text without nodes is no pipeline yet.
        path, text = (state["path"], state["text"]) if state["nodes"] else (None, None)
        self._begin(path, text, state["is_picture"])
        if text is None:
            self.title = state["title"]
        for name, grid in state["grids"].items():
            self.give(grid, name)

    # --- what is stated

    @property
    def text(self) -> str:
        """The text of the pipeline file."""
        return self._native.text()

    @property
    def path(self) -> str | None:
        """The file; None for a pipeline that was never saved."""
        path = self._native.path()
        return None if path is None else fspath(path)

    @property
    def title(self) -> str | None:
        """The title, for people."""
        return self._native.title()

    @title.setter
    def title(self, title: str | None) -> None:
        self._native.set_title(title)

    def add(
        self,
        name: str,
        type: str,
        /,
        *,
        inputs: Mapping[str, str | Node | Sequence[str | Node]] | None = None,
        **parameters: Any,
    ) -> Node:
        """Adds a node.

        Parameters
        ----------
        name, type : str
            Its name, and the name of its type as in files (`voltet.nodes` lists them).
        inputs : mapping
            What feeds its inputs: a node or its name, `"node.port"` where that has several outputs, or a list of these.
        **parameters
            Its parameters; what has the name of an input, and of no parameter, is a wire. A value of None is left out.
        """
        from ._declared import ports

        wires = dict(inputs or {})
        for port in ports(type):
            if port in parameters:
                wires[port] = parameters.pop(port)
        stated = {key: value for key, value in parameters.items() if value is not None}
        fed = [(port, sources(source)) for port, source in wires.items() if source is not None]
        self._native.add(str(name), str(type), stated, fed)
        return Node(self, str(name))

    def set(self, values: Mapping[str, Any]) -> None:
        """Sets parameters by `node.parameter`, and parts of them by further points (`look.widgets.0.centre`), in one step; None
        takes out."""
        wanted = []
        for key, value in values.items():
            node, point, path = str(key).partition(".")
            if not point or not path:
                raise usage("this names no parameter", repr(key), "node.parameter")
            wanted.append((node, path, value))
        self._native.set(wanted)

    def rename(self, node: str, to: str) -> None:
        """Gives a node another name; wires follow."""
        self._native.rename(node, to)
        if node in self._grids:
            grid, _ = self._grids.pop(node)
            self._grids[to] = (grid, None)

    def undo(self) -> bool:
        """Takes the last change of the text back; False where there is none."""
        return self._native.undo()

    def __getitem__(self, name: str) -> Node:
        if name not in self:
            # Says which there are.
            self._native.node(name)
        return Node(self, name)

    def __delitem__(self, name: str) -> None:
        self._native.remove(name)
        self._grids.pop(name, None)

    def __contains__(self, name: object) -> bool:
        return name in self._native.nodes()

    def __iter__(self) -> Iterator[str]:
        return iter(self._native.nodes())

    def __len__(self) -> int:
        return len(self._native.nodes())

    # --- grids of the program's own

    def give(self, grid: Grid | None, node: str | None = None) -> None:
        """Puts a grid of yours in place of what a node reads or makes; None takes it away again.

        `node` may be left out where only one gives a grid. What the node says of the scalar (`scalar = "T"`) stays."""
        if grid is not None and not isinstance(grid, Grid):
            raise usage("this is no grid", builtin_type(grid), "a voltet.Grid; voltet.vtk.grid makes one of a VTK data set")
        native = None if grid is None else grid._current()
        name = self._native.give(node, native)
        if grid is None:
            self._grids.pop(name, None)
        else:
            self._grids[name] = (grid, native)

    def _lend(self, keep_cells: bool = False, look: bool = True) -> list[_native.Grid]:
        """Gives the grids, as their arrays are now where they are looked at: those whose arrays are watched."""
        watched = []
        for name, (grid, given) in list(self._grids.items()):
            if name not in self:
                del self._grids[name]
                continue
            native = grid._current(keep_cells, look)
            if native is not given:
                self._native.give(name, native)
                self._grids[name] = (grid, native)
            if grid._watch:
                watched.append(native)
        return watched

    # --- what is done

    def check(self) -> list[str]:
        """Checks names, types, ranges, wires, outputs and integrators, without data: the warnings. Raises `Error`."""
        return self._native.check()

    def run(self, progress: bool | None | Progress = None) -> Result:
        """Runs all of it and writes what it writes; see `voltet.run`."""
        self._lend()
        with followed(progress) as told:
            images, report = self._native.run(told)
        return Result(images, Account(report))

    def render(self, node: str | None = None, progress: bool | None | Progress = None) -> Picture:
        """Draws the picture of a node (of the only one that gives one, where none is named), and writes nothing.

        Returns
        -------
        Picture
            A float32 array, height × width × 4, premultiplied linear RGBA, row 0 at the top, with its `report`.
        """
        # Whether the arrays are as they were is found while it is drawn; if not, it is drawn anew of what they are then.
        watched = self._lend(look=False)
        with followed(progress) as told:
            while (drawn := self._native.render(node, told, watched)) is None:
                self._lend()
                watched = []
        rgba, report = drawn
        return picture(rgba, Account(report))

    def frames(
        self,
        node: str | None = None,
        *,
        steps: str | int | Iterable[int] | None = None,
        times: str | float | Iterable[float] | None = None,
        ranges: str | None = None,
        files: str | PathLike[str] | Iterable[str | PathLike[str]] = (),
        sweep: Mapping[str, Sequence[Any]] | None = None,
        turns: int | None = None,
        part: str | None = None,
        progress: bool | None | Progress = None,
    ) -> Iterator[Frame]:
        """The pictures of a series, one after the other, as `voltet run` draws them with the options of these names (`files` is its
        `--for`, `turns` its `--frames`). The pipeline is between them as it was; what the pictures share is computed once.

        Parameters
        ----------
        node : str
            The node whose picture is drawn, where there are several.
        steps : str or numbers
            Steps of the time series that it reads: `"0:365:5"`, `"3,5,-1"`, `"all"`, `range(10)`.
        times : str or numbers
            The steps at or between times: `"0.1:0.5"`, or with a stride `"0:1:0.01"`.
        ranges : "step", "sample" or "all"
            The data that relative numbers and fitted views come from: each step, up to 8 steps of the series (default), all.
        files : path or list of path
            Data files that are read in place of the reader's own; `*` stands for any letters.
        sweep : mapping of `node.parameter` to values
            Values of parameters, each with each: `{"look.widgets.0.extinction": [1, 2, 4]}`.
        turns : int
            So many pictures on the camera's way (`orbit`, `keys`), as `--frames`.
        part : str
            A share of the pictures: `"2/8"`.

        >>> import numpy as np, voltet
        >>> pipeline = voltet.scene(np.random.rand(4, 4, 4), size=(16, 12), engine="cpu")
        >>> [frame.label for frame in pipeline.frames(sweep={"look.unit_distance": [0.5, 1.0]})]
        ['unit_distance = 0.5', 'unit_distance = 1.0']
        """
        from ._series import frames

        return frames(self, node, steps, times, ranges, files, sweep, turns, part, progress)

    def render_until(
        self, ends: Any, node: str = "picture", progress: bool | None | Progress = None
    ) -> Picture:
        """Draws the picture of a node whose rays end, as at opaque surfaces that another program draws; on the CPU.

        `ends`: an array of height × width, row 0 at the top: the depth of the end of each pixel's ray along the view direction, in
        the grid's units; infinite where nothing ends it. Laid over a picture of the surfaces, what is drawn stands before and
        about them as it should."""
        width, height = self.size(node)
        depths = np.require(np.asarray(ends), np.float32, ["C", "A"])
        if depths.shape != (height, width):
            raise usage("the rays' ends have the wrong shape", f"shape {depths.shape}", f"({height}, {width})", "ends")
        self._lend()
        with followed(progress) as told:
            return picture(self._native.render_until(node, depths, told))

    def imshow(
        self,
        ax: Axes | None = None,
        node: str | None = None,
        *,
        colorbar: bool = True,
        progress: bool | None | Progress = None,
        **options: Any,
    ) -> AxesImage:
        """Draws the picture of a node into axes of matplotlib, over their face colour, with a colour bar beside them.

        Parameters
        ----------
        ax : matplotlib.axes.Axes
            The axes. Default: the current ones.
        node : str
            The node whose picture is drawn, where there are several.
        colorbar : bool
            Whether a colour bar is added, where the colours depend on the scalar alone.
        **options
            Of `Axes.imshow`.

        The extent is that of the plane through the camera's target, in the grid's units. An orthographic camera along an axis of space
        gives ticks that are coordinates; other cameras give none.

        >>> import matplotlib.pyplot as plt, numpy as np, voltet
        >>> pipeline = voltet.scene(np.random.rand(4, 4, 4), camera={"view": "+z", "height": "auto"}, size=(64, 64))
        >>> pipeline.imshow(plt.figure().add_subplot()).axes.get_ylabel()
        'y'
        """
        from ._axes import imshow

        return imshow(self, ax, node, colorbar, progress, options)

    def size(self, node: str | None = None) -> tuple[int, int]:
        """Width and height of a node's picture, pixels."""
        width, height = self._native.size(node)
        return width, height

    def save(self, path: str | PathLike[str] | None = None) -> str:
        """Saves the pipeline file, which `voltet run` and `voltet edit` take; gives its path.

        Files that it reads are found from the new place, too. Grids that you gave are written beside it, as
        `NAME.NODE.vtu`, and read from there by the file; this pipeline keeps yours. Where no node writes anything, a node `file` is
        added that writes the picture as `NAME.png`."""
        if path is None and self.path is None:
            raise usage("the pipeline has no file yet", None, "a path to save it to")
        to = Path(fspath(path or self.path or ""))
        readers = [
            (name, *_write_grid(self[name], grid, to.with_name(f"{to.stem}.{name}.vtu")))
            for name, (grid, _) in self._grids.items()
            if name in self
        ]
        return fspath(self._native.save(to, readers))

    # --- how it shows itself

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        nodes = ", ".join(f"{name} ({self[name].type})" for name in self)
        return f"<voltet.Pipeline {self.path or self.title or 'without a file'}: {nodes}>"

    def _repr_html_(self) -> str:
        from ._html import table

        def line(name):
            node = self[name]
            stated = ", ".join(f"{key} = {value!r}" for key, value in node.parameters.items() if key != "widgets")
            widgets = len(node.parameters.get("widgets", []))
            wires = ", ".join(f"{port} ← {source}" for port, source in node.inputs.items())
            parts = [f"[{node.type}]", wires, stated, f"{widgets} widgets" if widgets else ""]
            return name, " · ".join(part for part in parts if part)

        return table(self.title or self.path or "Pipeline", map(line, self))


def builtin_type(value: object) -> str:
    """The type of a value, for messages."""
    return f"a {type(value).__module__}.{type(value).__qualname__}"


def _write_grid(node: Node, grid: Grid, file: Path) -> tuple[str, str]:
    """Writes a grid for a reader in place of the node: the file's name and the scalar."""
    arrays = grid.about["arrays"]
    scalars = [name for name, known in arrays.items() if known["components"] == 1]
    scalar = node.parameters.get("scalar") or grid.about["scalar"]
    # Whatever is drawn, a file of a grid has a scalar.
    scalar = scalar or (scalars[0] if scalars else f"{next(iter(arrays))}:magnitude")
    writer = Pipeline()
    writer.add("grid", "given-grid", scalar=scalar)
    writer.add("file", "grid-writer", volume="grid", path=str(file.absolute()), point_arrays=list(arrays))
    writer.give(grid)
    writer.run()
    return file.name, scalar
