//! `voltet papers`: the papers' tables and figures.

use super::support::Folder;

const PIPELINES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/lab/pipelines/papers");

#[test]
fn a_paper_is_made_anew_with_its_figures() {
    let folder = Folder::new();
    let small =
        ["--only", "moreland", "--size", "32x24", "--frames", "1", "--output", "made", "--cache", "cache"];
    folder.voltet(&[&["papers", "--pipelines", PIPELINES], &small[..]].concat()).ok();
    let page = std::fs::read_to_string(folder.join("made/papers.md")).unwrap();
    let figure = "papers/moreland_figure_1_1.png";
    assert!(page.contains(&format!("]({figure})")) && !page.contains("kniss"), "{page}");
    let picture = image::open(folder.join("made").join(figure)).unwrap().to_rgb8();
    // Two, and what lies between them.
    assert_eq!(picture.dimensions(), (70, 24));
    // The transfer function at the vertices is wrong by a tenth of full scale and more, clipped it is right.
    let largest = |row: &str| -> f64 {
        let line = page.lines().find(|line| line.starts_with(&format!("| {row}"))).unwrap();
        line.split('|').nth(4).unwrap().trim().parse().unwrap()
    };
    assert!(largest("(a)") > 0.1 && largest("(b)") < 2e-4, "{page}");
}

#[test]
fn papers_without_their_pipelines_are_refused() {
    let folder = Folder::new();
    let run = ["papers", "--only", "moreland", "--output", "made", "--pipelines", "nowhere"];
    folder.voltet(&run).fails(2, &["the pipelines of the papers are not there", "nowhere", "--pipelines"]);
    folder.voltet(&["papers", "--only", "levoy", "--output", "made"]).fails(2, &["levoy", "roettger-ertl"]);
}
