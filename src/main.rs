//! The program, with the nodes and filters that ship.

#[global_allocator]
static ALLOCATOR: voltet::ExitOnOutOfMemory = voltet::ExitOnOutOfMemory;

fn main() -> std::process::ExitCode {
    voltet::run(voltet::registry())
}
