"""ParaView plug-in: the filters of voltet with their property panels. Tools > Manage Plugins > Load New, or pvpython's LoadPlugin.

ParaView's Python must find the module voltet (PYTHONPATH with a folder that `pip install --target` filled). ParaView 5.11 or later.
"""

from paraview.util.vtkAlgorithm import smdomain, smhint, smproperty, smproxy

import voltet
import voltet.vtk as filters
from voltet._declared import declarations

_METHODS = [kind["name"] for kind in declarations()["filters"] if not any(p["required"] for p in kind["parameters"])]
_INTEGRATORS = ("analytic", "adaptive", "segments", "pre-integrated", "reference")

_ARRAY = """
<StringVectorProperty name="SelectArray" label="Scalar" command="SetInputArrayToProcess" number_of_elements="5"
    element_types="0 0 0 0 2" animateable="0">
  <ArrayListDomain name="array_list" attribute_type="Scalars" input_domain_name="inputs_array">
    <RequiredProperties><Property name="Input" function="Input"/></RequiredProperties>
  </ArrayListDomain>
</StringVectorProperty>
"""

_INPUT = """
<InputProperty name="Input" command="SetInputConnection">
  <ProxyGroupDomain name="groups"><Group name="sources"/><Group name="filters"/></ProxyGroupDomain>
  <DataTypeDomain name="input_type"><DataType value="vtkDataSet"/>{composite}</DataTypeDomain>
  <InputArrayDomain name="inputs_array" attribute_type="any" optional="1"/>
</InputProperty>
"""
_COMPOSITE = '<DataType value="vtkCompositeDataSet"/>'


def _choice(name, command, words, standard):
    entries = "".join(f'<Entry value="{i}" text="{word}"/>' for i, word in enumerate(words))
    return f"""
<IntVectorProperty name="{name}" command="{command}" number_of_elements="1" default_values="{words.index(standard)}">
  <EnumerationDomain name="enum">{entries}</EnumerationDomain>
</IntVectorProperty>
"""


_METHOD = _choice("Method", "SetMethodNumber", _METHODS, "least-squares")


class _Chosen:
    """A gradient filter by its place in the drop-down."""

    def SetMethodNumber(self, number):
        if isinstance(self, filters.VoltetRenderer):
            self.SetParameter("gradient.method", _METHODS[number])
        else:
            self.SetMethod(_METHODS[number])


@smproxy.filter(name="VoltetGradientMagnitude", label="Voltet Gradient Magnitude")
@smhint.xml('<ShowInMenu category="Voltet"/>')
@smproperty.xml(_METHOD)
@smproperty.xml(_ARRAY)
@smproperty.xml(_INPUT.format(composite=""))
class GradientMagnitude(_Chosen, filters.VoltetGradientMagnitude):
    """The same grid with the gradient magnitude of a scalar at its points."""

    @smproperty.intvector(name="ComputeGradient", default_values=0)
    @smdomain.xml('<BooleanDomain name="bool"/>')
    def SetComputeGradient(self, flag):
        filters.VoltetGradientMagnitude.SetComputeGradient(self, flag)


@smproxy.filter(name="VoltetRenderer", label="Voltet Renderer")
@smhint.xml('<ShowInMenu category="Voltet"/>')
@smproperty.xml(_choice("Integrator", "SetIntegratorNumber", _INTEGRATORS, "analytic"))
@smproperty.xml(_METHOD)
@smproperty.xml(_ARRAY)
@smproperty.xml(_INPUT.format(composite=_COMPOSITE))
class Renderer(_Chosen, filters.VoltetRenderer):
    """A picture of the grid, as an image: two-dimensional transfer functions, exact in every cell."""

    def SetIntegratorNumber(self, number):
        self.SetParameter("picture.integrator", _INTEGRATORS[number])

    @smproperty.intvector(name="Size", default_values=[640, 480])
    @smdomain.intrange(min=1, max=4096)
    def SetSize(self, width, height):
        filters.VoltetRenderer.SetSize(self, width, height)

    @smproperty.doublevector(name="Centre", label="Centre (percentile of s, share of g in %)", default_values=[50.0, 30.0])
    @smdomain.doublerange(min=0, max=100)
    def SetCentre(self, s, g):
        self._set_widget(centre=[f"p{s:g}", f"{g:g} %"])

    @smproperty.doublevector(name="Width", label="Width (% of the ranges)", default_values=[10.0, 30.0])
    @smdomain.doublerange(min=0.1, max=100)
    def SetWidth(self, s, g):
        self._set_widget(sigma=[f"{s:g} %", f"{g:g} %"])

    @smproperty.doublevector(name="Extinction", default_values=[0.2])
    @smdomain.doublerange(min=0, max=10)
    def SetExtinction(self, extinction):
        self._set_widget(extinction=extinction)

    @smproperty.doublevector(name="Color", default_values=[1.0, 0.55, 0.2], panel_visibility="default")
    def SetColor(self, red, green, blue):
        self._set_widget(color=[red, green, blue])

    def _set_widget(self, **keys):
        standard = {"color": [1.0, 0.55, 0.2], "extinction": 0.2, "centre": ["p50", "30 %"], "sigma": ["10 %", "30 %"]}
        self._stated = {**standard, **getattr(self, "_stated", {}), **keys}
        self.SetWidgets([voltet.widgets.gaussian(**self._stated)])


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
