// Uses: gaussian/mean_profile, widgets/widget. Fills: nothing.
// Optical depth of a Gaussian, from the path over the widget's part.

fn gaussian_depth(index: u32, part: Part, path: GaussianPath) -> f32 {
    return widget_peak(index, part) * gaussian_mean_profile(path);
}
