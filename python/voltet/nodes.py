"""Node types as functions, made from the program's own declarations: `help(voltet.nodes.camera)`.

Each adds its node to a pipeline, as `Pipeline.add` does with the name of the type:

>>> import voltet
>>> p = voltet.Pipeline()
>>> _ = voltet.nodes.camera(p, "view", eye=[0, -10, 0], target=[0, 0, 0], size=[64, 64])
>>> p["view"].type
'camera'
"""

from __future__ import annotations

from inspect import Parameter
from typing import Any

from ._declared import declarations, described, function_name, ports, signature


def _function(declared: dict[str, Any]):
    wires = [port for port in declared["inputs"] + declared["optional_inputs"] if port["name"] in ports(declared["name"])]
    more = any(parameter["type"] == "name of a gradient filter" for parameter in declared["parameters"])

    def add(pipeline, node, /, **stated):
        return pipeline.add(node, declared["name"], **stated)

    of_all = signature(declared["parameters"], wires, more)
    first = [Parameter(name, Parameter.POSITIONAL_ONLY) for name in ("pipeline", "node")]
    add.__signature__ = of_all.replace(parameters=[*first, *of_all.parameters.values()])
    add.__name__ = add.__qualname__ = function_name(declared["name"])
    add.__doc__ = described(declared["summary"], declared["parameters"], wires)
    add.__module__ = __name__
    return add


_ALL = {function_name(node["name"]): node for node in declarations()["nodes"]}
__all__ = sorted(_ALL)
globals().update({name: _function(node) for name, node in _ALL.items()})
