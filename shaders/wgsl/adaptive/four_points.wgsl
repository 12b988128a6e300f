// Uses: elementary/exponential. Fills: nothing.
// Gauss-Legendre panels of 4 points (Abramowitz & Stegun 1964, 25.4.30). Twin of `optics::integrators::adaptive::panel`.

const FOUR_NODES = vec4f(0.06943184, 0.3300095, 0.66999054, 0.93056816);
const FOUR_WEIGHTS = vec4f(0.17392743, 0.32607257, 0.32607257, 0.17392743);

// ∫ from 0 to node i (row) of the polynomial that is 1 at node k (column) and 0 at the others.
const FOUR_FROM_FOUR = mat4x4f(
    vec4f(0.08696371, 0.18811812, 0.16719192, 0.17748258),
    vec4f(-0.02660418, 0.16303629, 0.353953, 0.31344512),
    vec4f(0.012627463, -0.027880428, 0.16303629, 0.35267675),
    vec4f(-0.0035551498, 0.0067355004, -0.014190695, 0.08696371),
);

// Light of a panel, from light (red, green, blue) and rate in the columns, behind the depth `depth`.
fn four_points_light(values: mat4x4f, dt: f32, depth: f32) -> vec3f {
    let within = FOUR_FROM_FOUR * values[3];
    let seen = transmittances(vec4f(depth) + dt * within) * (dt * FOUR_WEIGHTS);
    return vec3f(dot(seen, values[0]), dot(seen, values[1]), dot(seen, values[2]));
}
