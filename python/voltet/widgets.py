"""Kinds of widgets as functions, made from the program's own declarations: `help(voltet.widgets.gaussian)`.

Each gives the table that a pipeline file would hold, a dictionary, for the parameter `widgets` of a transfer function:

>>> import voltet
>>> voltet.widgets.gaussian(color=[1, 0.5, 0.2], extinction=4.0, centre=[1.6, 0.8], sigma=[0.05, 0.3])
{'kind': 'gaussian', 'color': [1, 0.5, 0.2], 'extinction': 4.0, 'centre': [1.6, 0.8], 'sigma': [0.05, 0.3]}
"""

from __future__ import annotations

from typing import Any

from ._declared import described, function_name, signature, widget_kinds
from ._errors import usage


def _function(declared: dict[str, Any]):
    names = [parameter["name"] for parameter in declared["parameters"]]

    def widget(**stated):
        for name in stated:
            if name not in names:
                what = f"a widget of the kind '{declared['name']}' has no key '{name}'"
                raise usage(what, None, "one of " + ", ".join(names))
        return {"kind": declared["name"], **{key: value for key, value in stated.items() if value is not None}}

    widget.__signature__ = signature(declared["parameters"])
    widget.__name__ = widget.__qualname__ = function_name(declared["name"])
    widget.__doc__ = described(declared["summary"], declared["parameters"])
    widget.__module__ = __name__
    return widget


_ALL = {function_name(kind["name"]): kind for kind in widget_kinds()}
__all__ = sorted(_ALL)
globals().update({name: _function(kind) for name, kind in _ALL.items()})
