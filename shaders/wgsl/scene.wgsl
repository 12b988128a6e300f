// Uses: nothing. Fills: scene.
// What may change from frame to frame without another shader. Its layout is that of `SceneHead` and `WidgetRecord`, which a test checks.

struct Widget {
    // Linear RGB.
    color: vec3f,
    // ρ₀ per scene length.
    extinction: f32,
    // Numbers of the profile; each kind says which.
    matrix: vec4f,
    // 1/w, reach, half area, half-width of what glows (waves); columns and rows (tables).
    bell: vec4f,
    // In the values' own units.
    centre: vec2f,
    // Where the region's edges and the profile's further numbers, or a table's texels, begin.
    first_edge: u32,
    first_number: u32,
    // Bit 0: a sine wave; bit 1: nothing is cut away.
    bell_kind: u32,
}

struct Scene {
    // Unit vector in world axes.
    light_direction: vec3f,
    // k_a.
    light_ambient: f32,
    // k_d.
    light_diffuse: f32,
    // p.
    silhouette_exponent: f32,
    // −ln cutoff.
    level: f32,
    // Share of the peak above which a widget glows.
    cutoff: f32,
    // 1/U in scene lengths.
    per_unit: f32,
    // Largest error of a channel (adaptive).
    tolerance: f32,
    // The largest channel of any colour.
    brightest: f32,
    // Pieces of a segment, for integrators that cut it.
    piece_count: u32,
    // Where the integrator's entries, or the numbers of curved axes, begin in `numbers`.
    first_entry: u32,
    widgets: array<Widget, WIDGET_COUNT>,
}

@group(0) @binding(0) var<uniform> scene: Scene;
