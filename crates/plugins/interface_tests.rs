//! The structs here and in the header are the same to the byte.
#![allow(clippy::unwrap_used)] // A test that cannot go on has failed.

use crate::interface::*;
use std::mem::{offset_of, size_of};
use voltet_testing::compilers;

/// Each struct with its fields: their offsets as Rust has them, and C's expressions for the same.
macro_rules! layout {
    ($($c:ident = $rust:ident { $($($field:ident).+ $(as $named:ident)?),* })*) => {
        vec![$(
            (format!("sizeof({})", stringify!($c)), size_of::<$rust>()),
            $((format!("offsetof({}, {})", stringify!($c), name!($($field).+ $($named)?)), offset_of!($rust, $($field).+)),)*
        )*]
    };
}

macro_rules! name {
    ($field:ident) => {
        stringify!($field)
    };
    ($($field:ident).+ $named:ident) => {
        stringify!($named)
    };
}

#[test]
fn the_header_has_the_same_layout() {
    let layout = layout! {
        voltet_host = Host { size, major, minor, patch, thread_count, reserved, program, context, progress, cancelled, error,
                             fallback, parallel_for }
        voltet_parameter = Parameter { size, parameter_type as type, name, unit, help, flags, length, min, max, number, text,
                                       numbers, unset, word_count, reserved, words, meanings }
        voltet_values = Values { size, count, integers, numbers, texts, vectors, lengths }
        voltet_call = GradientCall { size, reserved, point_count, cell_count, points, cells, neighbour_starts, neighbours, cell_starts,
                             cells_of_points, scalar, arrays, values, gradient, at_boundary,
                             second_ring_starts, second_rings }
        voltet_gradient_filter = GradientFilter { item.size as size, item.needs as needs, item.name as name,
                                                  item.summary as summary, item.parameter_count as parameter_count,
                                                  item.name_count as reserved, item.parameters as parameters,
                                                  item.check as check, gradient }
        voltet_gradient_factory = Factory { size, reserved, count as filter_count, at as filter }
        voltet_array_head = ArrayHead { size, component_count, name, on_cells, reserved }
        voltet_grid_head = GridHead { size, flags, point_count, cell_count, connectivity_count, array_count, step_count, arrays,
                                      scalar, times, format }
        voltet_grid_buffers = GridBuffers { size, array_count, point_count, cell_count, connectivity_count, points, tetrahedra,
                                            types, offsets, connectivity_u32, arrays }
        voltet_reading = Reading { size, reserved, path, step, values, describe, buffers, context }
        voltet_reader = Reader { item.size as size, item.needs as reserved, item.name as name, item.summary as summary,
                                 item.parameter_count as parameter_count, item.name_count as extension_count,
                                 item.parameters as parameters, item.check as check, inspect, read, extensions, magic,
                                 magic_length, reserved as reserved_too }
        voltet_reader_factory = Factory { size, reserved, count as reader_count, at as reader }
        voltet_given_array = GivenArray { size, component_count, name, values }
        voltet_grid_call = GridCall { size, array_count, point_count, cell_count, points, tetrahedra, carried, scalar, arrays,
                                      values, begin, context }
        voltet_grid_filter = GridFilter { item.size as size, item.needs as reserved, item.name as name, item.summary as summary,
                                          item.parameter_count as parameter_count, item.name_count as made_count,
                                          item.parameters as parameters, item.check as check, filter, made }
        voltet_grid_factory = Factory { size, reserved, count as filter_count, at as filter }
        voltet_image_call = ImageCall { size, reserved, width, height, rgba, values, filtered }
        voltet_image_filter = ImageFilter { item.size as size, item.needs as reserved, item.name as name,
                                            item.summary as summary, item.parameter_count as parameter_count,
                                            item.name_count as reserved_too, item.parameters as parameters,
                                            item.check as check, filter }
        voltet_image_factory = Factory { size, reserved, count as filter_count, at as filter }
        voltet_plugin = Plugin { size, reserved, name, version }
        voltet_entry = Entry { size, major, minor, patch, init, deinit, get_factory }
    };
    let numbers = [
        ("VOLTET_PLUGIN_MAJOR", MAJOR),
        ("VOLTET_PLUGIN_MINOR", MINOR),
        ("VOLTET_PLUGIN_PATCH", PATCH),
        ("VOLTET_OK", OK as u32),
        ("VOLTET_CANCELLED", CANCELLED as u32),
        ("VOLTET_ERROR", ERROR as u32),
        ("VOLTET_BOOLEAN", BOOLEAN),
        ("VOLTET_INTEGER", INTEGER),
        ("VOLTET_NUMBER", NUMBER),
        ("VOLTET_CHOICE", CHOICE),
        ("VOLTET_TEXT", TEXT),
        ("VOLTET_VECTOR", VECTOR),
        ("VOLTET_POINT_ARRAY", POINT_ARRAY),
        ("VOLTET_REQUIRED", REQUIRED),
        ("VOLTET_EXCLUSIVE_MIN", EXCLUSIVE_MIN),
        ("VOLTET_EXCLUSIVE_MAX", EXCLUSIVE_MAX),
        ("VOLTET_ABOVE_LEAST", EXCLUSIVE_MIN),
        ("VOLTET_BELOW_MOST", EXCLUSIVE_MAX),
        ("VOLTET_NEEDS_NEIGHBOURS", NEEDS_NEIGHBOURS),
        ("VOLTET_NEEDS_CELLS_OF_POINTS", NEEDS_CELLS_OF_POINTS),
        ("VOLTET_NEEDS_BOUNDARY", NEEDS_BOUNDARY),
        ("VOLTET_NEEDS_SECOND_RINGS", NEEDS_SECOND_RINGS),
        ("VOLTET_TETRAHEDRA", TETRAHEDRA),
        ("VOLTET_SAME_POINTS", SAME_POINTS),
        ("VOLTET_SAME_CELLS", SAME_CELLS),
    ];
    let all: Vec<(String, usize)> =
        layout.into_iter().chain(numbers.map(|(name, n)| (name.to_string(), n as usize))).collect();
    let lines: String = all
        .iter()
        .map(|(expression, _)| format!("    printf(\"{expression} %zu\\n\", (size_t)({expression}));\n"))
        .collect();
    let text = format!(
        "#include \"voltet_plugin.h\"\n#include <stddef.h>\n#include <stdio.h>\nint main(void) {{\n{lines}    \
         puts(VOLTET_GRADIENT_FILTERS);\n    puts(VOLTET_READERS);\n    puts(VOLTET_GRID_FILTERS);\n    \
         puts(VOLTET_IMAGE_FILTERS);\n    return 0;\n}}\n"
    );
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("layout.c");
    std::fs::write(&source, text).unwrap();
    let Some(program) = compilers::program(folder.path(), "layout", &[source], &[]) else { return };
    let output = std::process::Command::new(program).output().unwrap();
    let found = String::from_utf8(output.stdout).unwrap();
    let mut wanted: Vec<String> = all.iter().map(|(expression, n)| format!("{expression} {n}")).collect();
    let kinds = [GRADIENT_FILTERS, READERS, GRID_FILTERS, IMAGE_FILTERS];
    wanted.extend(kinds.map(|kind| kind.to_str().unwrap().to_string()));
    assert_eq!(found.lines().collect::<Vec<_>>(), wanted);
}
