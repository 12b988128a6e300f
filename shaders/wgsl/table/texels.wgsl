// Uses: nothing. Fills: nothing.
// The images of all table widgets, one behind the other: linear RGB and alpha.

@group(0) @binding(2) var<storage, read> texels: array<vec4f>;
