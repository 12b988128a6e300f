//! voltet-catalyst: pictures in a running simulation. An implementation of the Catalyst 2 interface
//! (<https://catalyst-in-situ.readthedocs.io>), which a simulation's libcatalyst loads by the name `voltet`.
//!
//! | module | what |
//! | --- | --- |
//! | [`interface`] | the functions that Catalyst calls |
//! | [`simulation`] | the pipelines of a simulation, and its steps |
//! | [`mesh`] | meshes in Conduit's Mesh Blueprint to pieces of a grid |
//! | [`piece`] | the piece of a process of a grid that several hold |
//! | [`lockstep`] | processes that fail together |
//! | [`conduit`] | nodes of Conduit, read through its C interface |

pub mod conduit;
pub mod interface;
pub mod lockstep;
pub mod mesh;
pub mod piece;
pub mod simulation;
