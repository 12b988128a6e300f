// Uses: nothing. Fills: nothing.
// Gauss-Legendre panels of 8 points (Abramowitz & Stegun 1964, 25.4.30), four and four. Twin of
// `lanes::optics::quadrature`.

const NODES_LOW = vec4f(0.019855072, 0.10166676, 0.2372338, 0.40828268);
const NODES_HIGH = vec4f(0.5917173, 0.7627662, 0.89833325, 0.9801449);
const WEIGHTS_LOW = vec4f(0.050614268, 0.11119052, 0.15685332, 0.18134189);
const WEIGHTS_HIGH = vec4f(0.18134189, 0.15685332, 0.11119052, 0.050614268);

// ∫ from 0 to node i (row) of the polynomial that is 1 at node k (column) and 0 at the others.
const LOW_FROM_LOW = mat4x4f(
    vec4f(0.025307134, 0.054759324, 0.048587535, 0.05186552),
    vec4f(-0.009105943, 0.05559526, 0.120859526, 0.10619349),
    vec4f(0.006280831, -0.0136397965, 0.07842666, 0.17067114),
    vec4f(-0.0044830157, 0.008149709, -0.015975103, 0.09067094),
);
const LOW_FROM_HIGH = mat4x4f(
    vec4f(0.0030784914, -0.005215352, 0.008371733, -0.016021041),
    vec4f(-0.0019176753, 0.003139753, -0.004643466, 0.0072412067),
    vec4f(0.00097275764, -0.001564935, 0.0022257147, -0.0031978143),
    vec4f(-0.00027750834, 0.0004428023, -0.0006188057, 0.0008592366),
);
const HIGH_FROM_LOW = mat4x4f(
    vec4f(0.049755033, 0.051233076, 0.050171465, 0.050891776),
    vec4f(0.11438833, 0.1089648, 0.112755455, 0.11021776),
    vec4f(0.14961211, 0.16149679, 0.15371357, 0.158771),
    vec4f(0.19736293, 0.17297016, 0.18655725, 0.1782634),
);
const HIGH_FROM_HIGH = mat4x4f(
    vec4f(0.09067094, 0.19731699, 0.17319219, 0.1858249),
    vec4f(-0.013817811, 0.07842666, 0.17049313, 0.1505725),
    vec4f(0.004997027, -0.009669008, 0.05559526, 0.12029646),
    vec4f(-0.0012512528, 0.002026732, -0.0041450537, 0.025307134),
);

// Something at the 8 points of a panel.
struct Points {
    low: vec4f,
    high: vec4f,
}

// ∫ f from the panel's start to each node, from f at the nodes, for a panel of length 1.
fn to_nodes(values: Points) -> Points {
    return Points(
        LOW_FROM_LOW * values.low + LOW_FROM_HIGH * values.high,
        HIGH_FROM_LOW * values.low + HIGH_FROM_HIGH * values.high,
    );
}

// ∫ f over a panel of length 1.
fn over_panel(values: Points) -> f32 {
    return dot(values.low, WEIGHTS_LOW) + dot(values.high, WEIGHTS_HIGH);
}
