//! The program, with the nodes and filters that ship.

fn main() -> std::process::ExitCode {
    voltet::run(voltet::nodes::registry())
}
