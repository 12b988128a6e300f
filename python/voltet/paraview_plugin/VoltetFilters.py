"""ParaView plug-in: the filters of voltet with their property panels. Tools > Manage Plugins > Load New, or pvpython's LoadPlugin.

ParaView's Python must find the module voltet (PYTHONPATH with a folder that `pip install --target` filled). ParaView 5.11 or later.
"""

from paraview.util.vtkAlgorithm import smdomain, smhint, smproperty, smproxy

import voltet
import voltet.paraview
import voltet.vtk as filters
from voltet._declared import declarations

_METHODS = [kind["name"] for kind in declarations()["filters"] if not any(p["required"] for p in kind["parameters"])]
_INTEGRATORS = ("analytic", "adaptive", "segments", "pre-integrated", "reference")
_REGIONS = ("whole grid", "box", "sphere")


def _array(name="SelectArray"):
    return f"""
<StringVectorProperty name="{name}" label="Scalar" command="SetInputArrayToProcess" number_of_elements="5"
    element_types="0 0 0 0 2" animateable="0">
  <ArrayListDomain name="array_list" attribute_type="Scalars" input_domain_name="inputs_array">
    <RequiredProperties><Property name="Input" function="Input"/></RequiredProperties>
  </ArrayListDomain>
</StringVectorProperty>
"""


def _input(composite=True):
    composite = '<DataType value="vtkCompositeDataSet"/>' if composite else ""
    return f"""
<InputProperty name="Input" command="SetInputConnection">
  <ProxyGroupDomain name="groups"><Group name="sources"/><Group name="filters"/></ProxyGroupDomain>
  <DataTypeDomain name="input_type"><DataType value="vtkDataSet"/>{composite}</DataTypeDomain>
  <InputArrayDomain name="inputs_array" attribute_type="any" optional="1"/>
</InputProperty>
"""


def _choice(name, command, words, standard):
    entries = "".join(f'<Entry value="{i}" text="{word}"/>' for i, word in enumerate(words))
    return f"""
<IntVectorProperty name="{name}" command="{command}" number_of_elements="1" default_values="{words.index(standard)}">
  <EnumerationDomain name="enum">{entries}</EnumerationDomain>
</IntVectorProperty>
"""


def _numbers(name, help, standard, limits=None):
    domain = '<DoubleRangeDomain name="range" min="{}" max="{}"/>'.format(*limits) if limits else ""
    return f"""
<DoubleVectorProperty name="{name}" command="Set{name}" number_of_elements="{len(standard)}"
    default_values="{" ".join(map(str, standard))}">{domain}<Documentation>{help}</Documentation></DoubleVectorProperty>
"""


_METHOD = _choice("Method", "SetMethodNumber", _METHODS, "least-squares")

#: What is said of a drawing.
_LOOK = (
    _input(),
    _array(),
    _METHOD,
    _choice("Integrator", "SetIntegratorNumber", _INTEGRATORS, "analytic"),
    _numbers("Centre", "Centre of the Gaussian: the share of the volume, in %, that has a lower s; g in % of its range.", (50.0, 30.0), (0, 100)),
    _numbers("Width", "Deviations of the Gaussian along s and g: % of their ranges.", (10.0, 30.0), (0.1, 100)),
    _numbers("Extinction", "Peak of the extinction, per hundredth of the grid's diagonal.", (0.2,), (0, 10)),
    _numbers("Color", "The colour: linear RGB, 0 to 1.", (1.0, 0.55, 0.2), (0, 1)),
)


def _panel(*properties):
    """A class with these properties, shown in this order."""

    def decorate(proxy):
        for xml in properties:
            proxy = smproperty.xml(xml)(proxy)
        return smhint.xml('<ShowInMenu category="Voltet"/>')(proxy)

    return decorate


class _Look:
    """A transfer function of one Gaussian, relative to the data."""

    def SetMethodNumber(self, number):
        self.SetParameter("gradient.method", _METHODS[number])

    def SetIntegratorNumber(self, number):
        self.SetParameter("picture.integrator", _INTEGRATORS[number])

    def SetCentre(self, s, g):
        self._set_widget(centre=[f"p{s}", f"{g} %"])

    def SetWidth(self, s, g):
        self._set_widget(sigma=[f"{s} %", f"{g} %"])

    def SetExtinction(self, extinction):
        self._set_widget(extinction=extinction)

    def SetColor(self, red, green, blue):
        self._set_widget(color=[red, green, blue])

    def _set_widget(self, **keys):
        standard = {"color": [1.0, 0.55, 0.2], "extinction": 0.2, "centre": ["p50", "30 %"], "sigma": ["10 %", "30 %"]}
        self._stated = {**standard, **getattr(self, "_stated", {}), **keys}
        self.SetWidgets([voltet.widgets.gaussian(**self._stated)])


class _Chosen:
    """A gradient filter by its place in the drop-down."""

    def SetMethodNumber(self, number):
        self.SetMethod(_METHODS[number])


@smproxy.filter(name="VoltetVolume", label="Voltet Volume")
@_panel(*_LOOK, _numbers("Scale", "Pixels of the picture per pixel of the view: less is faster, and coarser.", (1.0,), (0.1, 1)))
class Volume(_Look, filters.VoltetVolume):
    """The grid drawn in the render view: two-dimensional transfer functions, exact in every cell, among opaque surfaces."""


@smproxy.filter(name="VoltetGradientMagnitude", label="Voltet Gradient Magnitude")
@_panel(_input(composite=False), _array(), _METHOD)
class GradientMagnitude(_Chosen, filters.VoltetGradientMagnitude):
    """The same grid with the gradient magnitude of a scalar at its points."""

    @smproperty.intvector(name="ComputeGradient", default_values=0)
    @smdomain.xml('<BooleanDomain name="bool"/>')
    def SetComputeGradient(self, flag):
        filters.VoltetGradientMagnitude.SetComputeGradient(self, flag)


@smproxy.filter(name="VoltetRenderer", label="Voltet Renderer")
@_panel(*_LOOK)
class Renderer(_Look, filters.VoltetRenderer):
    """A picture of the grid, as an image: two-dimensional transfer functions, exact in every cell."""

    @smproperty.intvector(name="Size", default_values=[640, 480])
    @smdomain.intrange(min=1, max=4096)
    def SetSize(self, width, height):
        filters.VoltetRenderer.SetSize(self, width, height)


@smproxy.filter(name="VoltetProbe", label="Voltet Probe")
@_panel(
    _input(),
    _array(),
    _METHOD,
    _choice("Region", "SetRegionNumber", _REGIONS, "whole grid"),
    _numbers("Low", "Lower corner of the box.", (0.0, 0.0, 0.0)),
    _numbers("High", "Upper corner of the box.", (1.0, 1.0, 1.0)),
    _numbers("Centre", "Centre of the sphere.", (0.0, 0.0, 0.0)),
    _numbers("Radius", "Radius of the sphere.", (1.0,)),
)
class Probe(_Chosen, filters.VoltetProbe):
    """A table of mean and deviation of a scalar and its gradient magnitude in a region, exact in every cell."""

    def SetRegionNumber(self, number):
        self._set_place(region=_REGIONS[number])

    def SetLow(self, x, y, z):
        self._set_place(low=(x, y, z))

    def SetHigh(self, x, y, z):
        self._set_place(high=(x, y, z))

    def SetCentre(self, x, y, z):
        self._set_place(centre=(x, y, z))

    def SetRadius(self, radius):
        self._set_place(radius=radius)

    def _set_place(self, **keys):
        standard = {"region": "whole grid", "low": (0, 0, 0), "high": (1, 1, 1), "centre": (0, 0, 0), "radius": 1.0}
        self._place = {**standard, **getattr(self, "_place", {}), **keys}
        if self._place["region"] == "box":
            self.SetBox(self._place["low"], self._place["high"])
        elif self._place["region"] == "sphere":
            self.SetSphere(self._place["centre"], self._place["radius"])
        else:
            self.SetWholeGrid()


@smproxy.source(name="VoltetPipeline", label="Voltet Pipeline")
@smhint.xml('<ShowInMenu category="Voltet"/>')
class PipelineFile(filters.VoltetPipeline):
    """The picture of a pipeline file."""

    @smproperty.stringvector(name="FileName", panel_visibility="default")
    @smdomain.filelist()
    @smhint.filechooser(extensions="toml", file_description="Pipeline files")
    def SetFileName(self, path):
        filters.VoltetPipeline.SetFileName(self, None if path in (None, "", "None") else path)

    @smproperty.intvector(name="Size", default_values=[0, 0])
    def SetPictureSize(self, width, height):
        """0: the file's own."""
        if width > 0 and height > 0:
            camera = "view.size"
            self.SetParameter(camera, [width, height])


voltet.paraview.follow_views()
