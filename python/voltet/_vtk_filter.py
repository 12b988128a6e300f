"""What the VTK filters share: errors that are not lost, progress and abort, the array that is processed."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import Any

from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import vtkOutputWindow
from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm, vtkStreamingDemandDrivenPipeline as executive

from . import _vtk_grid
from ._errors import Error, usage
from ._grid import Grid


class _Aborted(Exception):
    """AbortExecute was set while something was drawn."""


class Filter(VTKPythonAlgorithmBase):
    """A filter whose errors are raised by its own `Update`, kept in `GetError()` whoever updated it, and told to observers of
    ErrorEvent (to VTK's output window, where there are none)."""

    def __init__(self, inputs: int, input_type: str, output_type: str):
        self._error: BaseException | None = None
        self._done = 0.0
        self._taken: tuple[tuple, Grid] | None = None
        super().__init__(nInputPorts=inputs, inputType=input_type, nOutputPorts=1, outputType=output_type)

    def SetInputData(self, data: Any) -> None:
        """The input, without a connection."""
        self.SetInputDataObject(0, data)

    def GetInput(self) -> Any:
        """The input of the last update."""
        return self.GetInputDataObject(0, 0)

    def GetOutput(self) -> Any:
        """The output."""
        return self.GetOutputDataObject(0)

    # --- errors

    def GetError(self) -> BaseException | None:
        """What the last execution raised; None where it was done. Of a filter whose input was taken away, that it is missing."""
        return self._missing_input() or self._error

    def _missing_input(self) -> Error | None:
        for port in range(self.GetNumberOfInputPorts()):
            is_optional = self.GetInputPortInformation(port).Get(vtkAlgorithm.INPUT_IS_OPTIONAL())
            if not is_optional and not self.GetNumberOfInputConnections(port):
                return usage(f"{type(self).__name__} has no input", None, "SetInputConnection(port) or SetInputData(data set)")
        return None

    def Update(self, *args: Any) -> None:
        """Brings the output up to date. Raises what was wrong here; of filters before it, whoever updates sees theirs."""
        self._update(super().Update, *args)

    def UpdateWholeExtent(self) -> None:
        """As `Update`, for the whole extent."""
        self._update(super().UpdateWholeExtent)

    def UpdateTimeStep(self, *args: Any) -> None:
        """As `Update`, for a time."""
        self._update(super().UpdateTimeStep, *args)

    def UpdatePiece(self, *args: Any) -> None:
        """As `Update`, for a piece: the output is all of it."""
        self._update(super().UpdatePiece, *args)

    def UpdateExtent(self, *args: Any) -> None:
        """As `Update`, for an extent: the output is all of it."""
        self._update(super().UpdateExtent, *args)

    def _update(self, update: Callable[..., Any], *args: Any) -> None:
        if self._missing_input() is None:
            update(*args)
        else:
            self._empty()
        self.RaiseError()

    def _empty(self) -> None:
        """Leaves nothing of a former result, where there is no new one: VTK keeps it where nothing was begun."""
        if (output := self.GetOutputDataObject(0)) is not None:
            output.Initialize()

    def RaiseError(self) -> None:
        """Raises what the last execution raised, if it did: for programs that update a later filter."""
        if (error := self.GetError()) is not None:
            raise error

    def ProcessRequest(self, request, inInfo, outInfo):
        """Carries out a pass; an exception of it is kept, as VTK would print and forget it."""
        try:
            return super().ProcessRequest(request, inInfo, outInfo)
        except BaseException as error:
            self._error = error
            self._empty()
            self._tell(error)
            return 0

    def _tell(self, error: BaseException) -> None:
        if isinstance(error, KeyboardInterrupt):
            return
        text = f"{type(self).__name__}: {error}"
        if self.HasObserver("ErrorEvent"):
            self.InvokeEvent("ErrorEvent", text)
        else:
            vtkOutputWindow.GetInstance().DisplayErrorText(f"ERROR: In {text}\n")

    def RequestData(self, request, inInfo, outInfo):
        """Does the work, and remembers that it was done."""
        self._done = 0.0
        try:
            done = self._execute(inInfo, outInfo)
        except _Aborted:
            self._empty()
            self._error = None
            return 1
        self._error = None
        self.UpdateProgress(1.0)
        return done

    # --- progress and abort

    #: Where the work of each node of the pipeline begins and ends in the whole.
    SHARES = {"grid": (0.0, 0.05), "gradient": (0.05, 0.3), "look": (0.3, 0.35), "picture": (0.35, 1.0)}

    def _follow(self, node: str, stage: str, fraction: float) -> None:
        if self.GetAbortExecute() or getattr(self, "CheckAbort", bool)():
            raise _Aborted
        begin, end = self.SHARES.get(node, (self._done, 1.0))
        done = begin + (end - begin) * min(max(fraction, 0.0), 1.0)
        if done > self._done:
            self._done = min(done, 0.999)
            self.SetProgressText(f"{node} {stage}".strip())
            self.UpdateProgress(self._done)

    # --- what is processed

    def _quantity(self, data: Any) -> tuple[str, int]:
        """The name of the array to process and where it sits: as SetInputArrayToProcess says, else the active scalars, else the
        only array of one component."""
        drawn, _ = _vtk_grid.parts(data)
        if not drawn:
            raise usage("there is nothing to draw", "no data", "a data set with cells")
        both = (_vtk_grid.POINT, _vtk_grid.CELL)
        name, association = self._asked()
        if name is not None:
            return name, _vtk_grid.find_array(drawn, name, both if association is None else (association,))
        for place in both:
            active = drawn[0].data.GetAttributes(place).GetScalars()
            if active is not None and active.GetName():
                return active.GetName(), _vtk_grid.find_array(drawn, active.GetName(), (place,))
        single = [
            (name, place)
            for name, place in _vtk_grid.common_arrays(drawn).items()
            if drawn[0].data.GetAttributes(place).GetArray(name).GetNumberOfComponents() == 1
        ]
        if len(single) == 1:
            return single[0]
        expected = "SetInputArrayToProcess(0, 0, 0, association, name), or active scalars"
        raise usage("the array to process is not named", f"{len(single)} arrays of one component", expected)

    def _asked(self) -> tuple[str | None, int | None]:
        """What SetInputArrayToProcess said."""
        info = self.GetInputArrayInformation(0)
        name = info.Get(vtkDataObject.FIELD_NAME()) if info.Has(vtkDataObject.FIELD_NAME()) else None
        association = info.Get(vtkDataObject.FIELD_ASSOCIATION()) if info.Has(vtkDataObject.FIELD_ASSOCIATION()) else None
        # Points, then cells.
        return name or None, association if association in (_vtk_grid.POINT, _vtk_grid.CELL) else None

    def _grid(self, data: vtkDataObject, names: list[str], association: int) -> tuple[Grid, bool]:
        """The input as a grid, the former one where nothing of it has changed; and whether it is another."""
        state = (_vtk_grid.state(data, names), tuple(names), association)
        if self._taken is not None and self._taken[0] == state:
            return self._taken[1], False
        # The former one's memory may be gone: nothing of it is looked at.
        self._taken = None
        grid = _vtk_grid.grid(data, names, scalar=None, association=association)
        self._taken = (state, grid)
        return grid, True

    # --- requests that all make

    def FillInputPortInformation(self, port, info):
        """Data sets with cells, and composite ones."""
        info.Set(vtkAlgorithm.INPUT_REQUIRED_DATA_TYPE(), self.InputType)
        if self.InputType == "vtkDataObject":
            return 1
        info.Append(vtkAlgorithm.INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet")
        return 1

    def RequestUpdateExtent(self, request, inInfo, outInfo):
        """A picture, and a gradient, need all of the grid, whatever piece or extent is asked for."""
        for vector in inInfo:
            for i in range(vector.GetNumberOfInformationObjects()):
                info = vector.GetInformationObject(i)
                info.Set(executive.UPDATE_PIECE_NUMBER(), 0)
                info.Set(executive.UPDATE_NUMBER_OF_PIECES(), 1)
                info.Set(executive.UPDATE_NUMBER_OF_GHOST_LEVELS(), 0)
                if info.Has(executive.WHOLE_EXTENT()):
                    info.Set(executive.UPDATE_EXTENT(), info.Get(executive.WHOLE_EXTENT()), 6)
        return 1


def changed(method):
    """A setter that calls Modified() where it changes something: it gives whether it did."""

    def setter(self, *args: Any, **kwargs: Any) -> None:
        if method(self, *args, **kwargs):
            self.Modified()

    setter.__doc__ = method.__doc__
    setter.__name__ = method.__name__
    return setter


class Watched:
    """An object of VTK whose changes are those of a filter; neither keeps the other alive."""

    def __init__(self, watcher: Filter, subject: Any):
        self.subject = subject
        known = weakref.ref(watcher)

        def modified(*_: Any) -> None:
            if (filter := known()) is not None:
                filter.Modified()

        self._tag = subject.AddObserver("ModifiedEvent", modified)

    def end(self) -> None:
        """Watches no longer."""
        self.subject.RemoveObserver(self._tag)


__all__ = ["Error", "Filter", "Watched", "changed"]
