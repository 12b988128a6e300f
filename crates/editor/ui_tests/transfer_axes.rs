//! The transfer function editor: where a press counts, arrays to choose axes from, tables, numbers relative to a series.

use super::transfer::with_distribution;
use super::transfer_more::{CUBE, of, place, widgets};
use super::*;
use voltet_document::Edit;
use voltet_graph::ArrayRef;

/// A hand that presses and moves on within one slow frame.
#[test]
fn what_is_taken_hold_of_lies_where_the_button_was_pressed() {
    let mut hand = Hand::new(TEXT);
    with_distribution(&mut hand);
    let (from, to) = (place(&hand, [150.0, 20.0]), place(&hand, [190.0, 30.0]));
    hand.move_to(from + vec2(80.0, 60.0), Modifiers::NONE);
    let button = |pos: Pos2, pressed: bool| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    // The last place lies on the picture above, which would be turned.
    let picture = hand.named("picture picture");
    let moved = Event::PointerMoved;
    let events =
        vec![moved(from), button(from, true), moved(picture), moved(to), button(to, false), moved(picture)];
    hand.frame(events, Modifiers::NONE);
    hand.frames(3);
    let centre = of(&widgets(&hand)[0], "centre").numbers().unwrap();
    assert!((centre[0] - 190.0).abs() < 0.5 && (centre[1] - 30.0).abs() < 0.2, "{centre:?}");
    assert_eq!(hand.steps(), 1);
}

#[test]
fn axes_are_chosen_among_the_arrays_that_the_data_have() {
    let text = TEXT.replace(
        "type = \"wavelet\"\nresolution = [12, 12, 12] # coarse",
        "type = \"reader\"\npath = \"cube.vtk\"\nscalar = \"a\"",
    );
    let mut hand = Hand::with_file(&text, "cube.vtk", CUBE);
    with_distribution(&mut hand);
    hand.click_on("axes s, g");
    let listed = |hand: &Hand| hand.texts("b  (points, 0 to 4)");
    for _ in 0..4000 {
        if !listed(&hand).is_empty() {
            break;
        }
        hand.frames(1);
        std::thread::sleep(Duration::from_millis(5));
    }
    let both = listed(&hand);
    assert_eq!(both.len(), 2, "one list an axis");
    let right = both.into_iter().min_by(|a, b| a.x.total_cmp(&b.x)).unwrap();
    hand.click(right);
    hand.frames(4);
    assert_eq!(hand.editor.panels.transfer.axes(), [ArrayRef::Array("b".into()), ArrayRef::Named("g")]);
    with_distribution(&mut hand);
    let [[low, high], _] = hand.editor.panels.transfer.shown_axes();
    assert!(low < 0.0 && high > 4.0 && high < 4.3, "{low} {high}");
}

/// On the plane a table is moved by what is within, and scaled by its corners; undone, the file is as before.
#[test]
fn a_table_is_moved_and_scaled_on_the_plane() {
    let (i, j) = (TEXT.find("kind = \"gaussian\"").unwrap(), TEXT.find("[nodes.view]").unwrap());
    let table = "kind = \"table\" # painted\nextinction = 4.0\nimage = \"look.png\"\ns = [100.0, 200.0]\ng = [10.0, \"90 %\"]\n\n";
    let text = format!("{}{table}{}", &TEXT[..i], &TEXT[j..]).replace(
        "type = \"transfer-function\"",
        "type = \"transfer-function\"\ninputs = { volume = \"gradient\" }",
    );
    let image = include_bytes!("../transfer/two_texels.png");
    let mut hand = Hand::in_folder(&text, &|folder| std::fs::write(folder.join("look.png"), image).unwrap());
    with_distribution(&mut hand);
    for _ in 0..4000 {
        if hand.has_textures(4) {
            break;
        }
        hand.frames(1);
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(hand.has_textures(4), "letters, the picture, the histogram, and the table");
    let range = |hand: &Hand, key: &str| of(&widgets(hand)[0], key);
    let from = place(&hand, [150.0, 12.0]);
    hand.drag(from, from + (place(&hand, [120.0, 12.0]) - place(&hand, [100.0, 12.0])));
    let s = range(&hand, "s").numbers().unwrap();
    assert!((s[0] - 120.0).abs() < 0.5 && (s[1] - 220.0).abs() < 0.5, "{s:?}");
    assert_eq!(range(&hand, "g").datum.to_string(), "[10.0, \"90 %\"]");
    let corner = place(&hand, [s[1], 10.0]);
    hand.drag(corner, place(&hand, [240.0, 5.0]));
    let [s, g] = ["s", "g"].map(|key| range(&hand, key));
    assert!((s.numbers().unwrap()[1] - 240.0).abs() < 0.5, "{s:?}");
    let g = g.list().unwrap().to_vec();
    assert!((g[0].number().unwrap() - 5.0).abs() < 0.3 && g[1].text() == Some("90 %"), "{g:?}");
    (0..2).for_each(|_| hand.key(Key::Z, Modifiers::COMMAND));
    assert_eq!(hand.text(), text);
}

/// Two steps: x, and 2 x; over 0 to 2.
fn write_series(folder: &Path) {
    let mut steps = String::new();
    for step in 0..2 {
        let values: Vec<String> = (0..27).map(|i| (i % 3 * (step + 1)).to_string()).collect();
        let data = format!(
            "<VTKFile type=\"ImageData\" version=\"0.1\"><ImageData WholeExtent=\"0 2 0 2 0 2\" Origin=\"0 0 0\" Spacing=\"1 1 1\">\
             <Piece Extent=\"0 2 0 2 0 2\"><PointData><DataArray type=\"Float64\" Name=\"a\" format=\"ascii\">{}\
             </DataArray></PointData></Piece></ImageData></VTKFile>",
            values.join(" ")
        );
        std::fs::write(folder.join(format!("step{step}.vti")), data).unwrap();
        steps += &format!("<DataSet timestep=\"{step}\" file=\"step{step}.vti\"/>");
    }
    let series =
        format!("<VTKFile type=\"Collection\" version=\"0.1\"><Collection>{steps}</Collection></VTKFile>");
    std::fs::write(folder.join("all.pvd"), series).unwrap();
}

#[test]
fn numbers_relative_to_a_series_are_drawn_and_stay_relative() {
    // Of two steps a sample is all.
    ["series", "sample"].into_iter().for_each(check_relative_numbers);
}

fn check_relative_numbers(scope: &str) {
    let text = TEXT
        .replace(
            "type = \"wavelet\"\nresolution = [12, 12, 12] # coarse",
            "type = \"reader\"\npath = \"all.pvd\"\ntime_step = 0\nscalar = \"a\"",
        )
        .replace(
            "type = \"transfer-function\"",
            &format!(
                "type = \"transfer-function\"\nrelative_to = \"{scope}\"\ninputs = {{ volume = \"gradient\" }}"
            ),
        )
        .replace("centre = [150.0, 20.0]", "centre = [\"50 %\", 0.5]")
        .replace("sigma = [60.0, 40.0]", "sigma = [\"10 %\", 0.2]");
    // The steps come before the window.
    let mut hand = Hand::in_folder(&text, &write_series);
    with_distribution(&mut hand);
    let known = hand.editor.scene().distribution.clone().unwrap();
    let s = ArrayRef::Named("s");
    assert_eq!(known.known.ranges[&s], [0.0, 4.0], "of both steps");
    assert!((known.known.spreads[&s].below(1.0) - 0.375).abs() < 1e-3, "half and a quarter");
    let [_, high] = hand.editor.panels.transfer.shown_axes()[0];
    assert!(high < 2.2, "the plane is that of the step that is shown");
    let from = place(&hand, [2.0, 0.5]);
    hand.drag(from, place(&hand, [1.0, 0.5]));
    let centre = of(&widgets(&hand)[0], "centre");
    let share = centre.list().unwrap()[0].text().unwrap().trim_end_matches(" %").parse::<f64>().unwrap();
    assert!((share - 25.0).abs() < 0.3, "{centre:?}");
    assert_eq!(of(&widgets(&hand)[0], "sigma").datum.to_string(), "[\"10 %\", 0.2]");
}

/// Widgets lie at decades where the axis has them, and are dragged there.
#[test]
fn a_widget_is_moved_along_a_logarithmic_axis() {
    let text = TEXT.replace(
        "type = \"transfer-function\"",
        "type = \"transfer-function\"\ns_scale = \"log\"\ninputs = { volume = \"gradient\" }",
    );
    let text = text.replace("sigma = [60.0, 40.0]", "sigma = [0.1, 40.0]");
    let mut hand = Hand::new(&text);
    with_distribution(&mut hand);
    let [[low, high], _] = hand.editor.panels.transfer.shown_axes();
    assert!(low > 1.0 && high < 3.0, "decades: {low} to {high}");
    assert!(!hand.texts("100").is_empty(), "ticks are values");
    hand.drag(place(&hand, [150f64.log10(), 20.0]), place(&hand, [200f64.log10(), 20.0]));
    let centre = of(&widgets(&hand)[0], "centre").numbers().unwrap();
    assert!((centre[0] - 200.0).abs() < 1.0 && (centre[1] - 20.0).abs() < 0.2, "{centre:?}");
}

/// Sets a parameter of the transfer function, as its row does.
fn set(hand: &mut Hand, name: &str, value: impl Into<voltet_graph::ParameterValue>) {
    hand.editor.actions.edit(Edit::set("look", [name], value.into()));
    hand.frames(2);
}

#[test]
fn on_another_scale_widgets_reach_to_the_same_values_in_the_step_that_chose_it() {
    let text = TEXT.replace("sigma = [60.0, 40.0]", "sigma = [60.0, 40.0] # wide");
    let mut hand = Hand::new(&text);
    let sigma = |hand: &Hand| of(&widgets(hand)[0], "sigma").numbers().unwrap();
    let is = |hand: &Hand, wanted: [f64; 2]| {
        let found = sigma(hand);
        assert!((0..2).all(|k| (found[k] / wanted[k] - 1.0).abs() < 1e-5), "{found:?} {wanted:?}");
    };
    set(&mut hand, "s_scale", "log");
    is(&hand, [(210.0f64 / 150.0).log10(), 40.0]);
    assert!(
        hand.text().contains("# wide") && hand.text().contains("centre = [150.0, 20.0]"),
        "{}",
        hand.text()
    );
    assert_eq!((hand.steps(), hand.said().as_str()), (1, ""));
    set(&mut hand, "g_scale", "log");
    is(&hand, [(210.0f64 / 150.0).log10(), 3f64.log10()]);
    (0..2).for_each(|_| hand.key(Key::Z, Modifiers::COMMAND));
    assert_eq!(hand.text(), text);
    // A symmetric logarithm is one once it has its linear part.
    set(&mut hand, "s_scale", "symlog");
    is(&hand, [60.0, 40.0]);
    set(&mut hand, "s_linear_below", 1.0);
    is(&hand, [(211.0f64 / 151.0).log10(), 40.0]);
    set(&mut hand, "s_linear_below", 10.0);
    is(&hand, [(220.0f64 / 160.0).log10(), 40.0]);
    set(&mut hand, "s_scale", "linear");
    is(&hand, [60.0, 40.0]);
}

#[test]
fn a_width_that_another_scale_cannot_have_stays_and_the_window_says_so() {
    let mut hand = Hand::new(&TEXT.replace("centre = [150.0, 20.0]", "centre = [-150.0, 20.0]"));
    set(&mut hand, "s_scale", "log");
    assert!(hand.text().contains("sigma = [60.0, 40.0]"), "{}", hand.text());
    assert!(
        hand.said().starts_with("the widths of 1 widget of 'look' (1) stay as they are"),
        "{}",
        hand.said()
    );
    set(&mut hand, "s_scale", "linear");
    assert!(hand.text().contains("sigma = [60.0, 40.0]"), "{}", hand.text());
    // A middle that is relative to the data is known with them.
    let text = TEXT
        .replace(
            "type = \"transfer-function\"",
            "type = \"transfer-function\"\ninputs = { volume = \"gradient\" }",
        )
        .replace("centre = [150.0, 20.0]", "centre = [\"50 %\", 20.0]");
    let mut hand = Hand::new(&text);
    with_distribution(&mut hand);
    let [low, high] = hand.editor.scene().distribution.clone().unwrap().known.ranges[&ArrayRef::Named("s")];
    let middle = 0.5 * (low + high);
    set(&mut hand, "s_scale", "log");
    let sigma = of(&widgets(&hand)[0], "sigma").numbers().unwrap();
    assert!((sigma[0] / (1.0 + 60.0 / middle).log10() - 1.0).abs() < 1e-5, "{sigma:?}");
    assert!(hand.text().contains("centre = [\"50 %\", 20.0]") && hand.steps() == 1, "{}", hand.text());
}

/// Bins that a haze over everything holds are free, and what has no histogram has no peak.
#[test]
fn a_widget_at_the_peak_lies_where_the_data_are() {
    let haze = "[[nodes.look.widgets]]\nkind = \"gaussian\"\ncolor = [0.5, 0.5, 0.6]\nextinction = 0.02\n\
                centre = [150.0, 0.0]\nsigma = [400.0, inf]\n\n[nodes.view]";
    let text = TEXT.replace("[nodes.view]", haze).replace("sigma = [60.0, 40.0]", "sigma = [10.0, 5.0]");
    let mut hand = Hand::new(&text);
    assert!(hand.editor.scene().distribution.is_none());
    hand.click_on("+ at peak");
    hand.frames(2);
    assert_eq!(hand.text().matches("[[nodes.look.widgets]]").count(), 2);
    with_distribution(&mut hand);
    hand.click_on("+ at peak");
    hand.frames(2);
    let nodes = &hand.editor.document().pipeline().nodes;
    let look = nodes.iter().find(|node| node.name == "look").unwrap();
    let widgets = look.setting("widgets").unwrap().list().unwrap();
    let third = voltet_graph::find_setting(widgets[2].table().unwrap(), "centre").unwrap();
    let at = third.numbers().unwrap();
    let scene = hand.editor.scene();
    let histogram = &scene.distribution.as_ref().unwrap().histogram;
    let bin = |k: usize| {
        let axis = histogram.axes[k];
        ((at[k] - axis.low) / (axis.high - axis.low) * axis.bins as f64) as usize
    };
    let volume = |place: usize| histogram.volumes[place];
    let place = bin(1) * histogram.axes[0].bins + bin(0);
    // Only the first widget holds bins, within 2.2 of its widths.
    let is_held = |place: usize| {
        let middle = |k: usize, i: usize| {
            let axis = histogram.axes[k];
            axis.low + (i as f64 + 0.5) * (axis.high - axis.low) / axis.bins as f64
        };
        let [s, g] = [place % histogram.axes[0].bins, place / histogram.axes[0].bins];
        let [x, y] = [(middle(0, s) - 150.0) / 10.0, (middle(1, g) - 20.0) / 5.0];
        (-0.5 * (x * x + y * y)).exp() >= 0.1
    };
    let most = (0..histogram.volumes.len()).filter(|&place| !is_held(place)).map(volume).fold(0.0, f64::max);
    assert!(most > 0.0 && volume(place) == most, "{at:?}: {} of {most}", volume(place));
}
