//! The program voltet with an integrator of its own, the midpoint rule.
//!
//! ```sh
//! cargo run --release -- run midpoint.toml      # writes midpoint.png
//! cargo run --release -- nodes renderer         # lists the integrator with its parameter
//! cargo run --release -- study midpoint.toml --only midpoint --only analytic
//! ```

mod midpoint;

use voltet::core::Result;
use voltet::graph::Registry;
use voltet::optics::integrators::{INTEGRATOR, variant};

fn main() -> std::process::ExitCode {
    voltet::run(registry())
}

/// The program's registry, and the integrator.
fn registry() -> Result<Registry> {
    let mut registry = voltet::registry()?;
    registry.add_variant(INTEGRATOR, variant(&midpoint::Midpoint)?)?;
    Ok(registry)
}
