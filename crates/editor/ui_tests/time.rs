use super::*;
use crate::film::FilmRequest;
use crate::scene::ProbePurpose;
use eframe::egui::OutputCommand;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use voltet_document::Edit;
use voltet_graph::Observer;

/// Steps of the series, and their times.
const STEPS: usize = 5;

/// One tetrahedron whose value differs from step to step, as a collection of files.
fn write_series(folder: &Path) {
    let mut files = String::new();
    for step in 0..STEPS {
        let values = format!("0 {} 20 {}", 10 * (step + 1), 5 * (step + 1));
        let text = format!(
            "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">\
             <PointData><DataArray type=\"Float64\" Name=\"T\" format=\"ascii\">{values}</DataArray></PointData>\
             <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points>\
             <Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray>\
             <DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">4</DataArray>\
             <DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>"
        );
        std::fs::write(folder.join(format!("r{step}.vtu")), text).unwrap();
        files += &format!("<DataSet timestep=\"{}\" file=\"r{step}.vtu\"/>", 0.25 * step as f64);
    }
    let text = format!("<VTKFile type=\"Collection\"><Collection>{files}</Collection></VTKFile>");
    std::fs::write(folder.join("run.pvd"), text).unwrap();
}

/// The scene of the other tests, of the series.
fn text_of_series() -> String {
    let grid = "type = \"wavelet\"\nresolution = [12, 12, 12] # coarse";
    let reader = "type = \"reader\" # the series\npath = \"run.pvd\"\nscalar = \"T\"";
    let text = TEXT.replace(grid, reader).replace("centre = [150.0, 20.0]", "centre = [10.0, 20.0]");
    text.replace("eye = [-28.0, -38.0, 24.0]", "eye = [3.0, 2.0, 2.0]")
        .replace("extinction = 4.0", "extinction = 40.0")
}

fn before_series(text: &str, size: [f32; 2]) -> Hand {
    let mut hand = Hand::before_window(text, size, &write_series);
    until(&mut hand, "the steps are found", |hand| hand.sees("time step"));
    hand.frames(2);
    hand
}

/// The step that the file states.
fn stated(hand: &Hand) -> Option<f64> {
    let nodes = &hand.editor.document().pipeline().nodes;
    nodes.iter().find(|node| node.name == "grid")?.setting("time_step")?.number()
}

/// The place of a step on the slider.
fn on_slider(hand: &Hand, step: usize) -> Pos2 {
    let rail = hand.rect("time step").shrink2(vec2(hand.rect("time step").height() / 2.5, 0.0));
    pos2(rail.left() + rail.width() * step as f32 / (STEPS - 1) as f32, rail.center().y)
}

#[test]
fn a_drag_over_the_steps_is_one_edit_and_shows_the_step() {
    let mut hand = before_series(&text_of_series(), [1280.0, 720.0]);
    hand.settle();
    let first = hand.editor.worker().shown(|shown| shown.pixels.clone().unwrap().picture);
    hand.drag(on_slider(&hand, 0), on_slider(&hand, 3));
    hand.settle();
    assert_eq!((stated(&hand), hand.steps()), (Some(3.0), 1), "{}", hand.said());
    assert!(hand.text().contains("type = \"reader\" # the series"), "{}", hand.text());
    assert!(!hand.shown_beginning("step 3 of 0 to 4, time 0.75").is_empty());
    let third = hand.editor.worker().shown(|shown| shown.pixels.clone().unwrap().picture);
    assert_ne!(first, third);
    // It is the picture of a file that says so.
    let text = text_of_series().replace("scalar = \"T\"", "scalar = \"T\"\ntime_step = 3");
    let other = before_series(&text, [1280.0, 720.0]);
    assert_eq!(third, other.editor.worker().shown(|shown| shown.pixels.clone().unwrap().picture));
    hand.key(Key::Z, Modifiers::COMMAND);
    assert_eq!(hand.text(), text_of_series());
}

#[test]
fn keys_and_buttons_go_from_step_to_step() {
    let mut hand = before_series(&text_of_series(), [900.0, 600.0]);
    let mut goes = |key: Key, to: usize| {
        hand.key(key, Modifiers::NONE);
        hand.frames(2);
        assert_eq!(stated(&hand), Some(to as f64), "{key:?} {}", hand.said());
    };
    goes(Key::End, STEPS - 1);
    goes(Key::OpenBracket, STEPS - 2);
    goes(Key::CloseBracket, STEPS - 1);
    goes(Key::CloseBracket, STEPS - 1);
    goes(Key::Home, 0);
    hand.click_on("next frame");
    assert_eq!(stated(&hand), Some(1.0));
    hand.click_on("last frame");
    assert_eq!(stated(&hand), Some(4.0));
    let steps = hand.steps();
    hand.click_on("last frame");
    assert_eq!(hand.steps(), steps, "it is there already");
}

#[test]
fn while_it_plays_the_file_is_as_it_was_and_then_it_states_the_step() {
    let text = text_of_series().replace("scalar = \"T\"", "time = 0.25 # begins here\nscalar = \"T\"");
    let mut hand = before_series(&text, [1280.0, 720.0]);
    hand.key(Key::A, Modifiers::NONE);
    let said = |hand: &Hand, step: usize| !hand.shown_beginning(&format!("step {step} of")).is_empty();
    // Past the end it begins again.
    for step in [3, 4, 0] {
        until(&mut hand, "it plays", |hand| said(hand, step));
        assert_eq!(hand.text(), text);
    }
    hand.key(Key::A, Modifiers::NONE);
    hand.frames(2);
    assert_eq!(hand.steps(), 1);
    let step = stated(&hand).unwrap() as usize;
    assert!(said(&hand, step) && !hand.text().contains("time = 0.25"), "{}", hand.text());
    hand.settle();
    hand.frames(20);
    assert!(said(&hand, step) && !hand.ctx.has_requested_repaint(), "it stands still");
}

/// A second reader of the series, at a step that the file states, and the sum of both.
fn text_of_two(own: &str, other: &str) -> String {
    let text = text_of_series().replace("scalar = \"T\"", &format!("scalar = \"T\"\n{own}"));
    let feeds = "grid = \"grid\"";
    assert!(text.contains(feeds), "{text}");
    text.replace(feeds, "grid = \"sum\"")
        + &format!(
            "\n[nodes.other]\ntype = \"reader\"\npath = \"run.pvd\"\nscalar = \"T\"\n{other}\n\n[nodes.sum]\n\
             type = \"calculator\"\nexpression = \"T + other.T\"\ninputs = {{ grid = \"grid\", other = \"other\" }}\n"
        )
}

#[test]
fn a_reader_whose_step_the_file_fixes_stays_there() {
    let text = text_of_two("", "time_step = 3");
    let mut hand = before_series(&text, [1280.0, 720.0]);
    for step in [1, 2] {
        hand.key(Key::CloseBracket, Modifiers::NONE);
        hand.settle();
        assert!(!hand.shown_beginning(&format!("step {step} of 0 to 4")).is_empty(), "{}", hand.said());
        assert_eq!((hand.text(), hand.steps()), (text.clone(), 0), "the step is the strip's");
    }
    let asked = hand.editor.answers.asked.clone().unwrap();
    let step = |name: &str| {
        let node = asked.nodes.iter().find(|node| node.name == name).unwrap();
        node.setting("time_step").unwrap().number()
    };
    assert_eq!([step("grid"), step("other")], [Some(2.0), Some(3.0)]);
}

#[test]
fn a_move_states_the_step_of_every_reader_exactly() {
    let mut hand = before_series(&text_of_two("time_step = 2", "time_step = 4"), [1280.0, 720.0]);
    hand.key(Key::OpenBracket, Modifiers::NONE);
    hand.key(Key::CloseBracket, Modifiers::NONE);
    hand.frames(2);
    assert_eq!(hand.text().matches("time_step = 2").count(), 2, "{}", hand.text());
    // The nearest step of a time is not that time.
    let between = "time = 0.1\nbetween_steps = \"linear\"\nscalar = \"T\"";
    let mut hand = before_series(&text_of_series().replace("scalar = \"T\"", between), [1280.0, 720.0]);
    hand.key(Key::Home, Modifiers::NONE);
    hand.frames(2);
    assert!(stated(&hand) == Some(0.0) && !hand.text().contains("time = 0.1"), "{}", hand.text());
}

/// A series of blocks of cells, whose values reach to ten times the number of the step, from one.
fn write_blocks(folder: &Path) {
    const SIDE: usize = 30;
    let mut files = String::new();
    for step in 0..STEPS {
        let value =
            |i: usize| format!("{} ", 10.0 * (step + 1) as f64 * (i % SIDE) as f64 / (SIDE - 1) as f64);
        let values: String = (0..SIDE.pow(3)).map(value).collect();
        let extent = format!("0 {0} 0 {0} 0 {0}", SIDE - 1);
        let text = format!(
            "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"{extent}\" Origin=\"0 0 0\" Spacing=\"0.03 0.03 0.03\"><Piece \
             Extent=\"{extent}\"><PointData><DataArray type=\"Float64\" Name=\"T\" format=\"ascii\">{values}</DataArray></PointData>\
             </Piece></ImageData></VTKFile>"
        );
        std::fs::write(folder.join(format!("r{step}.vti")), text).unwrap();
        files += &format!("<DataSet timestep=\"{step}\" file=\"r{step}.vti\"/>");
    }
    let text = format!("<VTKFile type=\"Collection\"><Collection>{files}</Collection></VTKFile>");
    std::fs::write(folder.join("run.pvd"), text).unwrap();
}

/// Before a series of blocks, with its histogram, which needs a gradient that the picture does not.
fn before_blocks() -> Hand {
    let text = text_of_series();
    let (before, after) = (text.find("kind = \"gaussian\"").unwrap(), text.find("[nodes.view]").unwrap());
    let widget = "kind = \"colormap\"\nextinction = 1.0\nrange = [0.0, 50.0]\n\n";
    let text = [&text[..before], widget, &text[after..]].concat();
    let mut hand = Hand::before_window(&text, [1280.0, 720.0], &write_blocks);
    until(&mut hand, "the steps are found", |hand| hand.sees("time step"));
    transfer::with_distribution(&mut hand);
    hand
}

/// Each newer picture takes precedence of the histogram.
#[test]
fn escape_stops_playing_as_its_key_does() {
    let mut hand = before_series(&text_of_series(), [1280.0, 720.0]);
    hand.key(Key::A, Modifiers::NONE);
    until(&mut hand, "it plays", |hand| hand.editor.panels.time.moved.is_some_and(|frame| frame > 0));
    hand.key(Key::Escape, Modifiers::NONE);
    assert!(hand.editor.panels.time.playing.is_none());
    assert!(stated(&hand).is_some(), "{}", hand.text());
}

#[test]
fn while_it_plays_the_histogram_follows() {
    let mut hand = before_blocks();
    let highest = |hand: &Hand| {
        hand.editor.worker().shown(|shown| {
            let found = shown.distribution.last().and_then(|found| found.as_ref().ok());
            found.map_or(0.0, |found| found.histogram.axes[0].high)
        })
    };
    assert_eq!(highest(&hand), 10.0);
    hand.key(Key::A, Modifiers::NONE);
    until(&mut hand, "it is that of the first step", |hand| highest(hand) > 15.0);
    assert!(hand.editor.panels.time.playing.is_some());
}

#[test]
fn it_plays_on_while_a_hand_turns_the_picture() {
    let mut hand = before_blocks();
    hand.key(Key::A, Modifiers::NONE);
    let at = hand.named("picture picture");
    hand.move_to(at, Modifiers::NONE);
    hand.button(true, PointerButton::Primary, Modifiers::NONE);
    let mut frames = std::collections::BTreeSet::new();
    for step in 0..4000 {
        // As fast as pictures come.
        let newest = hand.editor.answers.picture_number;
        while hand.editor.worker().shown(|shown| shown.answered) < newest {
            std::thread::sleep(Duration::from_millis(1));
        }
        hand.move_to(at + vec2((step % 40) as f32, 0.0), Modifiers::NONE);
        let strip = &hand.editor.panels.time;
        // The first points are no drag yet.
        assert!(step < 20 || strip.counting.is_none(), "a histogram is not waited for");
        frames.insert(strip.requested);
        if frames.len() == STEPS {
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("it stands still: {frames:?}");
}

#[test]
fn playing_ends_at_a_step_that_cannot_be_drawn() {
    let write = |folder: &Path| {
        write_series(folder);
        std::fs::write(folder.join("r2.vtu"), "no file of VTK").unwrap();
    };
    let mut hand = Hand::before_window(&text_of_series(), [1280.0, 720.0], &write);
    until(&mut hand, "the steps are found", |hand| hand.sees("time step"));
    hand.key(Key::A, Modifiers::NONE);
    until(&mut hand, "it ends", |hand| hand.said().contains("frame 2 cannot be drawn"));
    assert_eq!((stated(&hand), hand.steps()), (Some(2.0), 1));
}

#[test]
fn a_probe_is_of_the_frame_that_is_shown() {
    let mut hand = before_series(&text_of_two("", "time_step = 3"), [1280.0, 720.0]);
    hand.key(Key::End, Modifiers::NONE);
    hand.settle();
    hand.editor.probe(vec![[0.0, 0.0]], ProbePurpose::Values);
    let source = hand.editor.worker().shown(|shown| shown.probe.asked().unwrap().source.clone());
    let grid = source.nodes.iter().find(|node| node.name == "grid").unwrap();
    assert_eq!(grid.setting("time_step").unwrap().number(), Some(4.0));
}

#[test]
fn a_moved_key_leaves_the_other_keys_as_they_are_written() {
    let keys = "keys = [\n  [0.0, -28.0, -38.0, 24.0, 0.0, 0.0, 0.0], # begins\n  [1.0, 28.0, -38.0, 24.0, 0.0, 0.0, 0.0], # ends\n]";
    let without = TEXT.replace("eye = [-28.0, -38.0, 24.0]\ntarget = [0.0, 0.0, 0.0]\n", "");
    let text = without.replace("size = [160, 120]", &format!("{keys}\nsize = [160, 120]"));
    let mut hand = Hand::new(&text);
    hand.settle();
    let (tick, middle) = (hand.named("camera key 2"), hand.rect("frame").center().x);
    hand.drag(tick, pos2(middle, tick.y));
    let now = hand.text();
    assert!(now.contains("0.0], # begins\n  [0.5, 28.0, -38.0, 24.0, 0.0, 0.0, 0.0], # ends"), "{now}");
    // With a turn beside the keys a key would be turned twice.
    let mut hand = Hand::new(&text.replace("size = [160, 120]", "azimuth = 10.0\nsize = [160, 120]"));
    hand.settle();
    hand.click_on("add a camera key");
    assert!(hand.said().contains("azimuth") && hand.steps() == 0, "{}", hand.said());
    // A row that is none keeps the others from being written anew.
    let mut hand = Hand::new(&text.replace("[0.0, -28.0, -38.0", "[0.0, -38.0"));
    hand.frames(4);
    assert!(!hand.sees("camera key 1"));
}

#[test]
fn a_series_is_found_once_a_fault_elsewhere_is_mended() {
    let text = text_of_series().replace("engine = \"cpu\"", "engine = \"none\"");
    let mut hand = Hand::before_window(&text, [1280.0, 720.0], &write_series);
    hand.settle();
    until(&mut hand, "the fault is found", |hand| hand.editor.panels.time.fault.is_some());
    let mended = Edit::set("picture", "engine", "cpu".into());
    hand.editor.edit("mend".into(), &[mended]);
    until(&mut hand, "the steps are found", |hand| hand.sees("time step"));
}

#[test]
fn the_sheet_of_films_says_why_there_is_no_frame() {
    let mut hand = Hand::new(TEXT);
    hand.command(Command::Film);
    hand.frames(3);
    assert!(!hand.shown_beginning("there is no frame: no reader has time steps").is_empty());
}

#[test]
fn without_a_series_there_is_a_strip_where_the_camera_has_a_way_alone() {
    let mut hand = Hand::new(TEXT);
    assert!(!hand.sees("frame") && !hand.sees("time step"));
    hand.command(Command::Time(crate::scene::TimeMove::Next));
    assert!(hand.said().contains("no camera has a way"), "{}", hand.said());
    let hand = Hand::new(&TEXT.replace("size = [160, 120]", "size = [160, 120]\norbit = 360.0"));
    assert!(hand.sees("frame"));
}

#[test]
fn keys_of_the_camera_are_added_moved_and_deleted_on_the_strip() {
    let mut hand = Hand::new(TEXT);
    hand.key(Key::M, Modifiers::NONE);
    hand.frames(3);
    let keys = |hand: &Hand| {
        let nodes = &hand.editor.document().pipeline().nodes;
        let keys = nodes.iter().find(|node| node.name == "view").unwrap().setting("keys").cloned();
        let rows = keys.iter().flat_map(|keys| keys.list().unwrap().to_vec());
        rows.map(|row| row.array::<7>().unwrap()).collect::<Vec<_>>()
    };
    hand.click_on("add a camera key");
    let first = [-28.0, -38.0, 24.0, 0.0, 0.0, 0.0];
    assert_eq!(keys(&hand).iter().map(|row| row[0]).collect::<Vec<_>>(), [0.0, 1.0]);
    assert!(keys(&hand).iter().all(|row| row[1..] == first), "{:?}", keys(&hand));
    assert!(hand.editor.faults.1.is_empty(), "{:?}", hand.editor.faults.1);
    // At the end the hand turns the picture, which is a key once it is said to be one.
    hand.key(Key::End, Modifiers::NONE);
    hand.settle();
    let (at, steps) = (hand.named("picture picture"), hand.steps());
    hand.drag(at, at + vec2(60.0, 0.0));
    hand.settle();
    assert_eq!((hand.steps(), keys(&hand)[1][1]), (steps, -28.0));
    hand.click_on("add a camera key");
    let second = keys(&hand)[1];
    assert!(keys(&hand).len() == 2 && (second[1] + 28.0).abs() > 1.0, "{second:?}");
    // In the middle the camera is between them, at the distance of both.
    hand.settle();
    assert!(!hand.sees("Back to your view"), "it is a key now");
    let to_middle = hand.rect("frame").center();
    hand.click(to_middle);
    hand.settle();
    let eye = hand.editor.view().unwrap().eye;
    assert!((eye.length() / glam::DVec3::from_slice(&first[..3]).length() - 1.0).abs() < 1e-4, "{eye}");
    assert!((eye.x - second[1]).abs() > 0.1 && (eye.x + 28.0).abs() > 0.1, "{eye}");
    // A tick is dragged to the middle, as one step, and deleted; the camera then stands at the other.
    let (tick, steps) = (hand.named("camera key 2"), hand.steps());
    hand.drag(tick, pos2(to_middle.x, tick.y));
    assert!((keys(&hand)[1][0] - 0.5).abs() < 0.02, "{:?}", keys(&hand));
    assert_eq!(hand.steps(), steps + 1);
    let tick = hand.named("camera key 2");
    hand.move_to(tick, Modifiers::NONE);
    hand.button(true, PointerButton::Secondary, Modifiers::NONE);
    hand.button(false, PointerButton::Secondary, Modifiers::NONE);
    hand.frames(3);
    hand.click_on("Delete this key");
    assert!(keys(&hand).is_empty(), "{}", hand.text());
    assert_eq!(hand.numbers("view", "eye"), first[..3]);
    while hand.steps() > 0 {
        hand.key(Key::Z, Modifiers::COMMAND);
    }
    assert_eq!(hand.text(), TEXT);
}

/// Another frame shows what the film will have; the view that a hand chose is not lost by it.
#[test]
fn a_view_that_is_left_for_another_frame_can_be_had_again_and_be_kept_there() {
    let keys = "keys = [[0.0, -28.0, -38.0, 24.0, 0.0, 0.0, 0.0], [1.0, 28.0, -38.0, 24.0, 0.0, 0.0, 0.0]]";
    let without = TEXT.replace("eye = [-28.0, -38.0, 24.0]\ntarget = [0.0, 0.0, 0.0]\n", "");
    let text = without.replace("size = [160, 120]", &format!("{keys}\nsize = [160, 120]"));
    let mut hand = Hand::new(&text);
    hand.settle();
    let at = hand.named("picture picture");
    hand.drag(at, at + vec2(0.0, 60.0));
    hand.settle();
    let eye = |hand: &Hand| hand.editor.view().unwrap().eye;
    let chosen = eye(&hand);
    let is_at = |hand: &Hand, place: glam::DVec3| (eye(hand) - place).length() < 1e-3;
    assert!(!is_at(&hand, [-28.0, -38.0, 24.0].into()) && !hand.sees("Back to your view"));
    hand.key(Key::End, Modifiers::NONE);
    hand.settle();
    assert!(is_at(&hand, [28.0, -38.0, 24.0].into()), "{}", eye(&hand));
    hand.click_on("Back to your view");
    hand.settle();
    assert!(is_at(&hand, chosen) && hand.text() == text, "{}", eye(&hand));
    hand.click_on("add a camera key");
    hand.settle();
    assert!(is_at(&hand, chosen) && hand.steps() == 1, "{}", hand.text());
    assert!(!hand.sees("Back to your view"), "it is a key");
    // An edit of the camera does not lose it either.
    hand.drag(at, at + vec2(40.0, 0.0));
    hand.settle();
    let chosen = eye(&hand);
    hand.editor.edit("field of view".into(), &[Edit::set("view", ["fov_y"], 40.0.into())]);
    hand.settle();
    assert!(!is_at(&hand, chosen), "{}", eye(&hand));
    hand.click_on("Back to your view");
    hand.settle();
    assert!(is_at(&hand, chosen), "{}", eye(&hand));
}

#[test]
fn a_film_that_needs_a_program_that_is_not_there_is_refused_before_it_is_drawn() {
    if crate::film::has_ffmpeg() {
        eprintln!("skipped: ffmpeg is there");
        return;
    }
    let mut hand = before_series(&text_of_series(), [900.0, 600.0]);
    let begun = Arc::new(AtomicBool::new(false));
    let of_film = begun.clone();
    hand.editor.panels.time.film.make = Some(Arc::new(move |_: &FilmRequest, _: &dyn Observer| {
        of_film.store(true, Ordering::Relaxed);
        Ok("made".into())
    }));
    hand.editor.panels.time.film.path = Some("scene.mp4".into());
    hand.command(Command::Film);
    hand.frames(3);
    hand.click_on("Make the film");
    hand.frames(3);
    assert!(!begun.load(Ordering::Relaxed));
    hand.click_on("Make a .gif");
    hand.frames(2);
    hand.click_on("Make the film");
    until(&mut hand, "the film is not made", |hand| hand.sees("made"));
    assert_eq!(hand.editor.panels.time.film.path.as_deref(), Some("scene.gif"));
}

#[test]
fn the_sheet_of_films_asks_for_what_is_chosen_and_can_be_stopped() {
    let mut hand = before_series(&text_of_series(), [900.0, 600.0]);
    let asked: Arc<Mutex<Vec<FilmRequest>>> = Arc::default();
    let of_film = asked.clone();
    hand.editor.panels.time.film.make =
        Some(Arc::new(move |request: &FilmRequest, observer: &dyn Observer| {
            of_film.lock().unwrap().push(request.clone());
            observer.progress("", "frame 2 of 3", 0.5);
            while request.rate < 26.0 && !observer.cancelled() {
                std::thread::sleep(Duration::from_millis(2));
            }
            if observer.cancelled() { Err(Error::cancelled()) } else { Ok("a film of 3 frames\n".into()) }
        }));
    hand.editor.panels.time.film.path = Some("scene.gif".into());
    hand.command(Command::Film);
    hand.frames(3);
    hand.click_on("Make the film");
    until(&mut hand, "the film is begun", |hand| !hand.texts("frame 2 of 3").is_empty());
    hand.click_on("Stop");
    until(&mut hand, "the film is stopped", |hand| !hand.texts("stopped").is_empty());
    for (field, value) in [("last step", "3"), ("step width", "2"), ("frames a second", "30")] {
        hand.click_on(field);
        hand.key(Key::A, Modifiers::COMMAND);
        hand.typed(value);
        hand.key(Key::Enter, Modifiers::NONE);
        hand.frames(2);
    }
    hand.click_on("Make the film");
    until(&mut hand, "the film is made", |hand| !hand.texts("a film of 3 frames").is_empty());
    let at = hand.named("Copy path");
    hand.move_to(at, Modifiers::NONE);
    hand.button(true, PointerButton::Primary, Modifiers::NONE);
    hand.button(false, PointerButton::Primary, Modifiers::NONE);
    let copied = OutputCommand::CopyText(hand.folder.path().join("scene.gif").display().to_string());
    assert!(hand.harness.output().platform_output.commands.contains(&copied));
    let asked = asked.lock().unwrap();
    let [first, second] = &asked[..] else { panic!("{asked:?}") };
    assert_eq!((first.steps.as_deref(), first.frames, first.rate), (Some("0:4:1"), None, 2.0));
    assert_eq!((second.steps.as_deref(), second.size, second.rate), (Some("0:3:2"), None, 30.0));
    assert_eq!(
        (second.path.clone(), second.film.clone()),
        (hand.path(), hand.folder.path().join("scene.gif"))
    );
    assert_eq!(second.text, text_of_series());
}
