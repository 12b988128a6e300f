//! WGSL pieces, twins of the segment integrals of `voltet-core`, and what composes them for one scene.
//!
//! No device is needed here: [`compose()`] makes a text, [`Parameters`] the bytes that the text reads. A
//! [`ShaderKey`] names the pieces of a scene; equal keys give equal text. What may change per frame (colours, extinctions, centres, corners, light) is in [`Parameters`] only. Tables are
//! [`Resources`], with the passes that fill them. [`check_32_bits`] tells what 32 bits cannot hold.
//!
//! A piece is a file under `wgsl/`. Its first line says which pieces it uses, which slot it fills and which slots it
//! asks for; a slot that no file fills (`values`, `members`, `segment`) is filled by the generated block.

mod curved_axes;
mod generate;
mod kinds;
mod parameters;
mod passes;
mod resources;
pub mod segment_list;
mod shader_key;
mod text;
mod writer;

pub use generate::compose;
pub use kinds::{Kind, Spans};
pub use parameters::{Parameters, SceneHead, check_32_bits};
pub use passes::{
    Access, FramePass, GRID_GROUP, GridArray, Layout, PartedArray, Parts, PlacementRecord, RoundRecord,
    RunRecord, ViewRecord, cells_read,
};
pub use resources::{
    Buffer, Contents, Pass, Places, Resources, TEXEL_BYTES, TableScene, WgslTable, WgslTableExtension, images,
};
pub use shader_key::{
    AxisShape, Blend, Combine, CompositorProgram, Method, ShaderKey, TableSize, TileOrder, WgslCall,
    WgslExtension, WgslIntegrator, WidgetChoice, has_method,
};
pub use text::{PIECES, Shader, WgslPiece, compose_pieces, compose_pieces_with, piece};
pub use writer::{Axis, WidgetRecord};
