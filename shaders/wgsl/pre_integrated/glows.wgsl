// Uses: nothing. Fills: glows.
// The table of colours: C/(D E₁) by (D, s_f, s_b), or by (α, s, t).

@group(0) @binding(5) var<storage, read> glows: array<vec4f>;
