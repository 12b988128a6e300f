//! Reading files of every format.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod blocks;
mod encodings;
mod ensight;
mod gmsh;
mod legacy;
mod meshes;
mod openfoam;
mod pieces;
mod plot3d;
mod real_files;
mod surfaces;
mod tecplot;
mod writers;
