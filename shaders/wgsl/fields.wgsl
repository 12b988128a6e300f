// Uses: nothing. Fills: nothing.
// Of up to 8 fields; unused components are 0.

alias Fields = array<f32, 8>;
