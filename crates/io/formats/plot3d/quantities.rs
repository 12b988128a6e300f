//! Quantities of a PLOT3D solution: the five that it holds and those that follow from them.
//!
//! Symbols, in PLOT3D's dimensionless form: density ρ, momentum ρ**u**, energy e per volume, v² = |**u**|², ratio of specific
//! heats γ = 1.4, gas constant R = 1. Source: PLOT3D User's Manual (NASA TM 101067), chapter 4, as
//! vtkMultiBlockPLOT3DReader evaluates it (its defaults for γ and R).

/// Ratio of specific heats.
const GAMMA: f64 = 1.4;

/// A quantity: its name, other names that are understood, components, formula of (ρ, ρu, e).
pub(super) struct DerivedQuantity {
    pub name: &'static str,
    /// Without capitals, spaces, hyphens and underscores.
    pub aliases: &'static [&'static str],
    pub formula: Formula,
}

/// Formula of a quantity from density, momentum and energy.
pub(super) enum Formula {
    /// One value a point.
    Scalar(fn(f64, [f64; 3], f64) -> f64),
    /// Three values a point.
    Vector(fn(f64, [f64; 3], f64) -> [f64; 3]),
}

fn speed_squared(density: f64, momentum: [f64; 3]) -> f64 {
    momentum.iter().map(|m| (m / density).powi(2)).sum()
}

/// p = (γ − 1) (e − ρ v² / 2)
fn pressure(density: f64, momentum: [f64; 3], energy: f64) -> f64 {
    (GAMMA - 1.0) * (energy - 0.5 * density * speed_squared(density, momentum))
}

/// c = √(γ p / ρ)
fn sound_speed(density: f64, momentum: [f64; 3], energy: f64) -> f64 {
    (GAMMA * pressure(density, momentum, energy) / density).sqrt()
}

/// All quantities, those of the file first.
pub(super) const QUANTITIES: &[DerivedQuantity] = &[
    DerivedQuantity { name: "density", aliases: &["density"], formula: Formula::Scalar(|d, _, _| d) },
    DerivedQuantity { name: "momentum", aliases: &["momentum"], formula: Formula::Vector(|_, m, _| m) },
    DerivedQuantity {
        name: "energy",
        aliases: &["energy", "stagnationenergy"],
        formula: Formula::Scalar(|_, _, e| e),
    },
    DerivedQuantity { name: "pressure", aliases: &["pressure"], formula: Formula::Scalar(pressure) },
    // T = p / (ρ R)
    DerivedQuantity {
        name: "temperature",
        aliases: &["temperature"],
        formula: Formula::Scalar(|d, m, e| pressure(d, m, e) / d),
    },
    // h = γ (e/ρ − v² / 2)
    DerivedQuantity {
        name: "enthalpy",
        aliases: &["enthalpy"],
        formula: Formula::Scalar(|d, m, e| GAMMA * (e / d - 0.5 * speed_squared(d, m))),
    },
    DerivedQuantity {
        name: "internal_energy",
        aliases: &["internalenergy"],
        formula: Formula::Scalar(|d, m, e| e / d - 0.5 * speed_squared(d, m)),
    },
    DerivedQuantity {
        name: "kinetic_energy",
        aliases: &["kineticenergy"],
        formula: Formula::Scalar(|d, m, _| 0.5 * speed_squared(d, m)),
    },
    DerivedQuantity {
        name: "velocity",
        aliases: &["velocity"],
        formula: Formula::Vector(|d, m, _| m.map(|m| m / d)),
    },
    DerivedQuantity {
        name: "velocity_magnitude",
        aliases: &["velocitymagnitude", "speed"],
        formula: Formula::Scalar(|d, m, _| speed_squared(d, m).sqrt()),
    },
    // s = R / (γ − 1) · ln((p / p∞) / (ρ / ρ∞)^γ) with ρ∞ = 1, p∞ = 1 / γ
    DerivedQuantity {
        name: "entropy",
        aliases: &["entropy"],
        formula: Formula::Scalar(|d, m, e| (pressure(d, m, e) * GAMMA / d.powf(GAMMA)).ln() / (GAMMA - 1.0)),
    },
    DerivedQuantity { name: "sound_speed", aliases: &["soundspeed"], formula: Formula::Scalar(sound_speed) },
    DerivedQuantity {
        name: "mach",
        aliases: &["mach", "machnumber"],
        formula: Formula::Scalar(|d, m, e| speed_squared(d, m).sqrt() / sound_speed(d, m, e)),
    },
];

impl DerivedQuantity {
    /// True if a person means this quantity by `word`, however it is capitalised and joined.
    pub fn is_called(&self, word: &str) -> bool {
        let plain: String = word.chars().filter(char::is_ascii_alphanumeric).collect();
        self.aliases.contains(&plain.to_ascii_lowercase().as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ρ = 2, u = (3, 0, 4), p = 5: v² = 25, e = p / 0.4 + ρ v² / 2 = 37.5.
    #[test]
    fn quantities_follow_from_density_momentum_and_energy() {
        let value = |name: &str| match &QUANTITIES.iter().find(|q| q.is_called(name)).unwrap().formula {
            Formula::Scalar(formula) => formula(2.0, [6.0, 0.0, 8.0], 37.5),
            Formula::Vector(formula) => formula(2.0, [6.0, 0.0, 8.0], 37.5)[2],
        };
        // Rounding of a handful of operations on numbers below 100.
        let same = |a: f64, b: f64| assert!((a - b).abs() < 1e-13 * b.abs().max(1.0), "{a} {b}");
        same(value("Density"), 2.0);
        same(value("StagnationEnergy"), 37.5);
        same(value("pressure"), 5.0);
        same(value("temperature"), 2.5);
        same(value("enthalpy"), 8.75);
        same(value("InternalEnergy"), 6.25);
        same(value("kinetic energy"), 12.5);
        same(value("velocity"), 4.0);
        same(value("velocity-magnitude"), 5.0);
        same(value("SoundSpeed"), 3.5_f64.sqrt());
        same(value("MachNumber"), 5.0 / 3.5_f64.sqrt());
        same(value("entropy"), (7.0 / 2.0_f64.powf(1.4)).ln() / 0.4);
    }
}
