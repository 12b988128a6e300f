// Uses: nothing. Fills: numbers.
// Edges of regions, control points, Gaussians of further fields: what has no fixed length.

@group(0) @binding(1) var<storage, read> numbers: array<f32>;
