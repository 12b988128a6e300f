//! Reading files of every format.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod adaptive;
mod blocks;
mod cgns;
mod encodings;
mod ensight;
mod exodus;
mod gmsh;
mod legacy;
mod meshes;
mod mfem;
mod mfem_collections;
mod openfoam;
mod openfoam_parts;
mod packed;
mod parts;
mod pieces;
mod plot3d;
mod real_files;
mod refusals;
mod su2;
mod surfaces;
mod tecplot;
mod units;
mod vtkhdf;
mod writers;
mod xdmf;
