//! Probes: boxes in the picture and in the section, and the widgets of their values. The study.

use super::transfer::with_distribution;
use super::*;
use crate::scene::Command;
use crate::study::{Studied, StudyRequest};
use voltet_graph::{LocatedValue, Observer};

fn last_widget(hand: &Hand) -> Vec<voltet_graph::Field> {
    let nodes = &hand.editor.document().pipeline().nodes;
    let look = nodes.iter().find(|node| node.name == "look").unwrap();
    let widgets = look.settings.iter().find(|field| field.name == "widgets").unwrap();
    widgets.setting.list().unwrap().last().and_then(LocatedValue::table).unwrap().to_vec()
}

#[test]
fn a_box_in_the_picture_finds_the_values_on_its_rays() {
    let mut hand = Hand::new(TEXT);
    let middle = hand.named("picture picture");
    let corner = middle - vec2(20.0, 15.0);
    hand.drag_with(corner, middle + vec2(20.0, 15.0), PointerButton::Primary, Modifiers::ALT);
    until(&mut hand, "no answer comes", |hand| hand.editor.scene().probed.is_some());
    let probed = hand.editor.scene().probed.clone().unwrap();
    assert!(probed.rays > 100 && probed.values.len() > 500, "{} {}", probed.rays, probed.values.len());
    let total: f64 = probed.values.iter().map(|(_, share)| share).sum();
    assert!((total - 1.0).abs() < 1e-6, "the shares of all rays are one: {total}");
    let seen = format!("{} values on {} rays, the most visible of each", probed.heaviest.len(), probed.rays);
    assert!(hand.said().contains(&seen), "{}", hand.said());
    assert_eq!(hand.text(), TEXT, "looking changes nothing, nor does the view turn");
}

#[test]
fn a_box_beside_the_picture_and_one_without_width_probe_nothing() {
    let mut hand = Hand::in_tall_window(TEXT);
    let picture = hand.editor.panels.picture.rect.unwrap();
    let pane = hand.rect("picture picture");
    let margin = picture.min - pane.min;
    assert!(margin.max_elem() > 17.0, "room for a drag: {picture} {pane}");
    let in_margin = match margin.x > margin.y {
        true => [pane.left_center() + vec2(4.0, -20.0), pane.left_center() + vec2(16.0, 20.0)],
        false => [pane.center_top() + vec2(-20.0, 4.0), pane.center_top() + vec2(20.0, 16.0)],
    };
    for [from, to] in [in_margin, [-20.0, 20.0].map(|down| picture.center() + vec2(0.0, down))] {
        hand.drag_with(from, to, PointerButton::Primary, Modifiers::ALT);
        assert!(hand.editor.worker().shown(|shown| shown.probe.asked().is_none()), "{from} {to}");
    }
    assert_eq!(hand.text(), TEXT, "nor does the view turn");
}

#[test]
fn an_outline_that_a_hand_draws_proposes_widgets_as_a_box_does() {
    let mut hand = Hand::in_tall_window(TEXT);
    with_distribution(&mut hand);
    let (middle, [wide, high]) = (hand.named("picture picture"), [40.0, 30.0]);
    let probed = |hand: &mut Hand| {
        until(hand, "no answer comes", |hand| hand.editor.scene().probed.is_some());
        hand.editor.scene().probed.clone().unwrap()
    };
    hand.drag_with(
        middle - vec2(wide, high),
        middle + vec2(wide, high),
        PointerButton::Primary,
        Modifiers::ALT,
    );
    let of_box = probed(&mut hand);
    hand.editor.answers.probed = None;
    // The room is small: the switches are in a menu.
    hand.click_on("probe");
    hand.click_on("outline");
    hand.frames(2);
    let at = |k: usize| {
        let angle = k as f32 / 40.0 * std::f32::consts::TAU;
        middle + vec2(wide * angle.cos(), high * angle.sin())
    };
    hand.move_to(at(0), Modifiers::NONE);
    hand.button(true, PointerButton::Primary, Modifiers::NONE);
    (1..40).for_each(|k| hand.move_to(at(k), Modifiers::NONE));
    hand.button(false, PointerButton::Primary, Modifiers::NONE);
    hand.frames(2);
    let of_outline = probed(&mut hand);
    // An ellipse is π / 4 of its box.
    let share = of_outline.rays as f64 / of_box.rays as f64;
    assert!((share - 0.785).abs() < 0.06, "{share}");
    assert!(!hand.texts("+ range").is_empty() && !hand.texts("+ at probe").is_empty());
    assert_eq!(hand.text(), TEXT, "the view does not turn");
    // Where the button is off, a drag turns it again.
    hand.click_on("outline");
    hand.click(*hand.texts("outline").last().unwrap());
    hand.frames(2);
    hand.drag(middle, middle + vec2(30.0, 0.0));
    assert_ne!(hand.text(), TEXT);
}

#[test]
fn a_box_proposes_widgets_that_cover_what_is_seen_most_below_it() {
    let mut hand = Hand::in_tall_window(TEXT);
    with_distribution(&mut hand);
    assert!(hand.texts("+ range").is_empty());
    let middle = hand.named("picture picture");
    let corner = middle - vec2(20.0, 15.0);
    hand.drag_with(corner, middle + vec2(20.0, 15.0), PointerButton::Primary, Modifiers::ALT);
    until(&mut hand, "no answer comes", |hand| hand.editor.scene().probed.is_some());
    let probed = hand.editor.scene().probed.clone().unwrap();
    assert_eq!(probed.heaviest.len(), probed.rays, "each ray meets something, once");
    // What is seen most are values that the widget holds, not all that the rays pass.
    let spread = |values: &[([f64; 2], f64)]| {
        let s = values.iter().map(|(value, _)| value[0]);
        s.clone().fold(0.0, f64::max) - s.fold(f64::INFINITY, f64::min)
    };
    assert!(spread(&probed.heaviest) < 0.6 * spread(&probed.values));
    let picture = |hand: &Hand| hand.editor.worker().shown(|shown| shown.pixels.clone().unwrap().picture);
    for (button, kind) in [("+ at probe", "gaussian"), ("+ range", "uniform")] {
        hand.move_to(pos2(5.0, 400.0), Modifiers::NONE);
        hand.settle();
        let before = picture(&hand);
        hand.frames(3);
        let at = hand.texts(button)[0];
        hand.move_to(at, Modifiers::NONE);
        hand.frames(2);
        hand.settle();
        assert!(picture(&hand) != before, "{button}: the picture shows the proposal");
        assert_eq!((hand.text(), hand.steps()), (TEXT.to_string(), 0), "{button}: and nothing else does");
        let says = |hand: &Hand| hand.shown(&|shown| shown.ends_with("with a proposed widget")).len();
        assert_eq!(says(&hand), 1, "{button}");
        hand.click(at);
        hand.frames(3);
        hand.settle();
        // The pointer is at the button still: the widget is there once.
        assert_eq!(hand.texts(button)[0], at, "{button} stays where it is");
        assert_eq!(says(&hand), 0, "{button}");
        assert!(picture(&hand) == picture(&Hand::in_tall_window(&hand.text())), "{button}");
        let widget = last_widget(&hand);
        let find = |name: &str| widget.iter().find(|field| field.name == name).unwrap().setting.clone();
        assert!(hand.steps() == 1 && find("kind").text() == Some(kind), "{}", hand.text());
        if kind == "uniform" {
            let text = hand.text();
            let line = text.lines().find(|line| line.starts_with("region")).unwrap();
            assert!(line.len() < 65, "{line}");
            let region = find("region").table().unwrap().to_vec();
            let [s, g] = ["s", "g"].map(|name| {
                let range =
                    region.iter().find(|field| field.name == name).unwrap().setting.numbers().unwrap();
                range[0]..=range[1]
            });
            let held = probed.heaviest.iter().filter(|([x, y], _)| s.contains(x) && g.contains(y)).count();
            assert!(held * 10 >= probed.rays * 8, "{held} of {}", probed.rays);
        }
        hand.key(Key::Z, Modifiers::COMMAND);
        assert_eq!(hand.text(), TEXT);
    }
}

#[test]
fn values_in_the_section_make_a_widget_of_their_mean_and_covariance() {
    let mut hand = Hand::new(TEXT);
    with_distribution(&mut hand);
    hand.command(Command::Section);
    until(&mut hand, "no section comes", |hand| matches!(hand.editor.scene().section, Some(Ok(_))));
    hand.frames(3);
    let Some(Ok(section)) = hand.editor.scene().section else { panic!("no section") };
    hand.frames(2);
    let [low] = hand.shown_beginning("wavelet from ")[..] else { panic!("the scale has its ends") };
    let (colors, high) = (hand.named("colours of viridis"), hand.shown_beginning("to "));
    assert!(low.x < colors.x && high.iter().any(|high| high.x > colors.x && (high.y - low.y).abs() < 2.0));
    assert!(section.cells > 50 && section.values.iter().flatten().count() > 5000, "{}", section.cells);
    // The wavelet's own formula is not linear, but its values stay within its range: 37 to 277.
    assert!(section.values.iter().flatten().all(|[s, g]| (30.0..280.0).contains(s) && *g >= 0.0));
    let rect = hand.editor.panels.section.rect.unwrap();
    let from = rect.center() - vec2(40.0, 40.0);
    hand.drag(from, rect.center() + vec2(30.0, 20.0));
    let probed = hand.editor.scene().probed.clone().unwrap();
    assert!(probed.values.len() > 1000 && probed.rays == 0, "{}", probed.values.len());
    assert!(hand.said().contains("in the section"), "{}", hand.said());
    let (mean, covariance) = probed.moments().unwrap();
    let entry = hand.editor.panels.transfer.at_probe_for_tests(&hand.editor.scene()).unwrap();
    let edit = voltet_document::Edit::Insert { node: "look".into(), list: "widgets".into(), place: 1, entry };
    hand.editor.edit("probe".into(), &[edit]);
    let widget = last_widget(&hand);
    let find = |name: &str| widget.iter().find(|field| field.name == name).map(|field| field.setting.clone());
    let centre = find("centre").unwrap().numbers().unwrap();
    assert!((0..2).all(|k| (centre[k] / mean[k] - 1.0).abs() < 1e-4), "{centre:?} {mean:?}");
    // K of exp(−|K v|²) is such that 2 KᵀK is the inverse of the covariance.
    let k: Vec<Vec<f64>> = match find("matrix") {
        Some(rows) => rows.list().unwrap().iter().map(|row| row.numbers().unwrap()).collect(),
        None => {
            let sigma = find("sigma").unwrap().numbers().unwrap();
            let entry = |i: usize| 1.0 / (2f64.sqrt() * sigma[i]);
            vec![vec![entry(0), 0.0], vec![0.0, entry(1)]]
        }
    };
    let product = |i: usize, j: usize| {
        let kk = |a: usize, b: usize| 2.0 * (0..2).map(|r| k[r][a] * k[r][b]).sum::<f64>();
        (0..2).map(|m| kk(i, m) * covariance[m][j]).sum::<f64>()
    };
    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let scaled = product(i, j) * (covariance[i][i] / covariance[j][j]).sqrt();
        assert!((scaled - f64::from(u8::from(i == j))).abs() < 0.06, "{i} {j}: {scaled}");
    }
    assert_eq!(hand.steps(), 1);
    // One value alone is no width: the widget is as wide as a hand can take hold of.
    let at = rect.center();
    hand.click(at);
    assert_eq!(hand.editor.scene().probed.clone().unwrap().values.len(), 1);
    let entry = hand.editor.panels.transfer.at_probe_for_tests(&hand.editor.scene()).unwrap();
    let sigma = entry.table_for_tests("sigma");
    assert!(sigma.iter().all(|sigma| *sigma > 0.0 && sigma.is_finite()), "{sigma:?}");
}

/// A quantity that is constant in the data is ignored, and the widget is sound all the same.
#[test]
fn a_probe_of_a_constant_field_makes_a_widget_that_draws() {
    let text = TEXT.replace(
        "type = \"wavelet\"\nresolution = [12, 12, 12] # coarse",
        "type = \"reader\"\npath = \"cube.vtk\"\nscalar = \"same\"",
    );
    let text =
        text.replace("centre = [150.0, 20.0]", "centre = [5.0, 0.0]").replace("[60.0, 40.0]", "[1.0, 1.0]");
    let mut hand = Hand::with_file(&text, "cube.vtk", transfer_more::CUBE);
    with_distribution(&mut hand);
    hand.key(Key::H, Modifiers::NONE);
    hand.settle();
    hand.command(Command::Section);
    until(&mut hand, "no section comes", |hand| matches!(hand.editor.scene().section, Some(Ok(_))));
    hand.frames(3);
    let rect = hand.editor.panels.section.rect.unwrap();
    hand.drag(rect.center() - vec2(30.0, 30.0), rect.center() + vec2(30.0, 30.0));
    let entry = hand.editor.panels.transfer.at_probe_for_tests(&hand.editor.scene()).unwrap();
    assert_eq!(entry.table_for_tests("centre"), [5.0, 0.0]);
    assert!(entry.table_for_tests("sigma").iter().all(|sigma| *sigma > 0.0));
    let edit = voltet_document::Edit::Insert { node: "look".into(), list: "widgets".into(), place: 1, entry };
    hand.editor.edit("probe".into(), &[edit]);
    hand.settle();
    assert!(hand.editor.scene().failure.is_none(), "{:?}", hand.editor.scene().failure);
    hand.frames(3);
}

/// A field of an entry.
trait Entry {
    fn table_for_tests(&self, name: &str) -> Vec<f64>;
}

impl Entry for voltet_graph::ParameterValue {
    fn table_for_tests(&self, name: &str) -> Vec<f64> {
        let entry = LocatedValue::from(self.clone());
        let fields = entry.table().unwrap().to_vec();
        fields.iter().find(|field| field.name == name).unwrap().setting.numbers().unwrap()
    }
}

#[test]
fn a_study_runs_beside_the_window_and_can_be_stopped() {
    let mut hand = Hand::new(TEXT);
    hand.editor.panels.study.make = Some(Arc::new(|of: &StudyRequest, observer: &dyn Observer| {
        assert!(of.text.contains("wavelet") && of.node.as_deref() == Some("picture"));
        for i in 0..2000 {
            observer.progress("", "settings", f64::from(i) / 2000.0);
            if observer.cancelled() {
                return Err(Error::cancelled());
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        Ok(Studied { rows: Vec::new(), notes: Vec::new(), folder: None })
    }));
    hand.command(Command::Study);
    hand.frames(2);
    let of = StudyRequest {
        text: hand.text(),
        path: hand.path(),
        node: hand.editor.scene().shown_node.map(str::to_string),
    };
    let ctx = hand.ctx.clone();
    hand.editor.panels.study.begin(of.clone(), &ctx);
    let begun = std::time::Instant::now();
    hand.frames(5);
    assert!(hand.editor.panels.study.found.as_ref().is_none());
    hand.editor.panels.study.stop();
    until(&mut hand, "it does not stop", |hand| hand.editor.panels.study.found.as_ref().is_some());
    assert!(begun.elapsed() < Duration::from_secs(15));
    let stopped = hand.editor.panels.study.found.as_ref().unwrap().as_ref().unwrap_err();
    assert_eq!(stopped.kind, voltet_core::error::ErrorKind::Cancelled);
    hand.frames(1);
    assert_eq!(hand.texts("stopped").len(), 1);
    hand.editor.panels.study.make = Some(Arc::new(|_: &StudyRequest, _: &dyn Observer| panic!("a mistake")));
    hand.editor.panels.study.begin(of, &ctx);
    until(&mut hand, "no end", |hand| hand.editor.panels.study.found.as_ref().is_some());
    assert!(
        hand.editor
            .panels
            .study
            .found
            .as_ref()
            .unwrap()
            .as_ref()
            .is_err_and(|error| error.what.contains("panicked"))
    );
    hand.frames(3);
}
