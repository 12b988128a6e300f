//! Pictures of procedural scenes that every engine is held to, against the 64-bit referee and against formulas.
//!
//! Each `pub fn name(engine: &dyn Engine)` of the modules with scenes is a test; [`picture_tests`](crate::picture_tests) makes
//! them tests of one engine.

#![allow(missing_docs, reason = "a scene is called what it is for")]

pub mod compare;
pub mod coverage;
pub mod curved_axes;
pub mod difficult;
mod engine;
pub mod grids;
pub mod integrators;
pub mod lit;
pub mod looks;
pub mod ordinary;
mod scene;
pub mod surfaces;
pub mod widgets;
pub mod worked_example;

pub use engine::Engine;

/// The modules with scenes, as they are written.
pub const SOURCES: &[&str] = &[
    include_str!("coverage.rs"),
    include_str!("difficult.rs"),
    include_str!("integrators.rs"),
    include_str!("lit.rs"),
    include_str!("ordinary.rs"),
    include_str!("widgets.rs"),
    include_str!("worked_example.rs"),
];

/// The tests of the modules with scenes, one for each scene, of the engine `$engine` (its path from the crate's root).
#[macro_export]
macro_rules! picture_tests {
    ($engine:expr) => {
        $crate::picture_tests! {
            $engine;
            coverage: rays_in_shared_faces_and_edges, perspective_rays_in_shared_faces, ramp_along_the_view, gaussian_along_the_view, subdividing_cells_leaves_the_picture, cell_numbering_does_not_matter;
            difficult: two_arms_with_an_opening, disconnected, cyclic_order, flat_cells, cells_in_a_plane, cells_with_equal_points, cells_on_a_line, scaled_and_far_away, constant_field, large_values_that_hardly_vary, deep_pixels, huge_cell, tiny_cells, cells_that_overlap_behind_a_shared_face;
            integrators: a_function_of_the_scalar_is_served_by_all, bivariate_widgets_are_served_by_all_but_tables_of_the_scalar;
            lit: several_colours, one_colour, cameras, gradients_without_and_with_little_length, what_changes_nothing_is_left_out;
            ordinary: perspective_from_outside, orthographic_oblique, eye_inside, eye_inside_orthographic, near_plane_cuts_cells, near_plane_seen_from_far, samples_at_the_border_of_the_picture, picture_sizes, several_samples_a_pixel, wide_angle_and_telephoto;
            widgets: each_alone_under_both_models, all_at_once, overlaps_that_glow, a_gaussian_over_eight_fields;
            worked_example: each_kind_of_widget, widgets_that_overlap, a_colour_that_varies_in_a_mix, silhouette_and_light, another_ray_and_a_near_plane, nothing_glows_without_extinction;
        }
    };
    ($engine:expr; $($module:ident: $($name:ident),*;)*) => {
        $(mod $module {
            $(#[test]
            fn $name() {
                $crate::pictures::$module::$name(&$engine);
            })*
        })*

        #[test]
        fn every_scene_is_a_test() {
            let listed = [$($(stringify!($name)),*),*].len();
            let written = $crate::pictures::SOURCES.iter().flat_map(|source| source.lines());
            let written = written.filter(|line| line.starts_with("pub fn ") && line.ends_with("(engine: &dyn Engine) {"));
            assert_eq!(listed, written.count());
        }

        #[test]
        fn the_comparison_sees_what_is_wrong() {
            $crate::pictures::compare::sees_what_is_wrong();
        }
    };
}
