//! The structs of the header, as a C compiler lays them out, against those that the library reads.

use crate::library::{Installed, succeed};
use std::fmt::Write;
use std::mem::offset_of;
use voltet_c::{Array, Camera, Follow, GridInfo, GridSource, Image};

macro_rules! layout {
    ($($name:literal = $type:ty { $($field:ident),* })*) => {
        [$(($name, size_of::<$type>(), vec![$((stringify!($field), offset_of!($type, $field))),*])),*]
    };
}

#[test]
fn structs_have_the_headers_layout() {
    let structs = layout! {
        "voltet_array" = Array { size, name, values, component_count, on_cells }
        "voltet_grid_source" = GridSource {
            size, point_count, points, array_count, arrays, scalar, cell_count, tetrahedra, types, offsets, connectivity,
            connectivity_u32, connectivity_count, faces, face_locations, faces_count, degrees, ghost, subdivision,
            constant_cells, release, user, global_ids, further_pieces, further_piece_count
        }
        "voltet_grid_info" = GridInfo {
            size, point_count, tetrahedron_count, bytes_lent, bytes_copied, low, high, scalar
        }
        "voltet_camera" = Camera { size, eye, target, up, fov_y, height, near_plane, pixels, samples }
        "voltet_image" = Image { size, width, height, rgba, rgba_stride, srgb, srgb_stride, background }
        "voltet_follow" = Follow { size, user, progress, cancelled }
    };
    let mut text = String::from("#include <stdio.h>\n#include <voltet.h>\nint main(void) {\n");
    let mut expected = String::new();
    for (name, size, fields) in &structs {
        writeln!(text, "printf(\"{name} %lu\\n\", (unsigned long)sizeof({name}));").unwrap();
        writeln!(expected, "{name} {size}").unwrap();
        for (field, place) in fields {
            writeln!(text, "printf(\"{field} %lu\\n\", (unsigned long)offsetof({name}, {field}));").unwrap();
            writeln!(expected, "{field} {place}").unwrap();
        }
    }
    text += "return 0;\n}\n";
    let installed = Installed::new();
    let source = installed.path("layout.c");
    std::fs::write(&source, text).unwrap();
    let Some(program) = installed.program(&[source.to_str().unwrap()]) else { return };
    assert_eq!(succeed(&program, &[]), expected);
}
