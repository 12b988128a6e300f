"""Volumes in ParaView's render views: what the plug-in `VoltetFilters.py` begins when it is loaded.

ParaView's representations are C++. Those of a `Voltet Volume` show its outline; over every frame of a render view in which one is
visible, the volume itself is laid: it follows camera and size, stands before and behind opaque surfaces as it should, and is drawn
again only where something has changed. Views and states know nothing of that; visibility, deletion and states are ParaView's own.

The views and the filters must live in one process: ParaView with its built-in server, and pvpython.
"""

from __future__ import annotations

import weakref
from collections.abc import Iterator
from typing import Any

from paraview import servermanager

from ._overlay import VolumeOverlay
from ._vtk_volume import VoltetVolume

#: By address of a renderer the overlays of what it shows.
_overlays: dict[str, weakref.WeakKeyDictionary[VoltetVolume, VolumeOverlay]] = {}
_begun = False


def follow_views() -> None:
    """Follows all render views, those that are to come too."""
    global _begun
    if not _begun:
        _begun = True
        manager = servermanager.vtkSMProxyManager.GetProxyManager()
        manager.AddObserver("RegisterEvent", lambda *_: _look())
    _look()


def overlays(view: Any) -> list[VolumeOverlay]:
    """The volumes that were drawn in a render view, each with `picture`, `pipeline` and `error`."""
    return list(_overlays.get(_address(_renderer(view)), {}).values())


def _views() -> Iterator[Any]:
    manager = servermanager.ProxyManager() if servermanager.ActiveConnection else None
    views = manager.GetProxiesInGroup("views").values() if manager else ()
    for view in views:
        if _renderer(view) is not None:
            yield view


def _renderer(view: Any) -> Any:
    """The renderer of a render view; None of other views."""
    own = view.GetClientSideObject()
    return own.GetRenderer() if own is not None and own.IsA("vtkPVRenderView") else None


def _address(renderer: Any) -> str:
    return renderer.GetAddressAsString("")


def _look() -> None:
    """Finds views that are not followed yet."""
    for view in _views():
        renderer = _renderer(view)
        address = _address(renderer)
        if address not in _overlays:
            _overlays[address] = weakref.WeakKeyDictionary()
            renderer.AddObserver("EndEvent", _frame)
            renderer.AddObserver("DeleteEvent", lambda *_, gone=address: _overlays.pop(gone, None))


def _frame(renderer: Any, _: str) -> None:
    """Lays the volumes that are visible over a frame."""
    known = _overlays.get(_address(renderer))
    if known is None:
        return
    for view in _views():
        if _renderer(view) is not renderer:
            continue
        for volume in _visible(view):
            overlay = known.get(volume)
            if overlay is None:
                overlay = known[volume] = VolumeOverlay(volume)
            overlay.frame(renderer)


def _visible(view: Any) -> Iterator[VoltetVolume]:
    for shown in view.Representations:
        source = getattr(shown, "Input", None)
        own = source.GetClientSideObject() if source is not None and shown.Visibility else None
        if isinstance(own, VoltetVolume):
            yield own
