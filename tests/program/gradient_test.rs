//! `voltet gradient-test`: exit codes, files, and what is said of a wrong call.

use super::support::Folder;

const QUICK: [&str; 6] = ["--levels", "4,8", "--timed", "4", "--rounds", "1"];

fn call<'a>(rest: &[&'a str]) -> Vec<&'a str> {
    [&["gradient-test"], rest, &QUICK].concat()
}

#[test]
fn a_filter_is_measured_beside_others_and_written_everywhere() {
    let folder = Folder::new();
    let files = ["--html", "t.html", "--json", "t.json", "--plot", "t.svg"];
    let ran =
        folder.voltet(&call(&[&["quadratic-fit", "--beside", "least-squares"], &files[..]].concat())).ok();
    for part in ["quadratic-fit", "least-squares", "anisotropic", "numbering", "10⁶ points/s", "held"] {
        assert!(ran.stdout.contains(part), "{part}: {}", ran.stdout);
    }
    assert!(!ran.stdout.contains("BROKEN") && !ran.stdout.contains("cell-average"), "{}", ran.stdout);
    let found = folder.json("t.json");
    let names: Vec<&str> =
        found["filters"].as_array().unwrap().iter().map(|f| f["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["quadratic-fit", "least-squares"]);
    assert_eq!(found["requirements"].as_array().unwrap().len(), 4);
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let page = read("t.html");
    assert!(page.contains("<svg") && page.ends_with("</html>\n"), "{page:.300}");
    assert!(read("t.svg").contains("quadratic-fit"));
}

#[test]
fn a_filter_that_does_not_keep_what_is_asked_ends_with_1() {
    let folder = Folder::new();
    let asked = ["least-squares", "--beside", "", "--quiet"];
    let ran = folder
        .voltet(&call(&[&asked[..], &["--order", "1.9"]].concat()))
        .fails(1, &["order 1.9 or more: found 1."]);
    assert!(ran.stdout.is_empty(), "{}", ran.stdout);
    folder.voltet(&call(&[&asked[..], &["--order", "1.9", "--hold-to", "nothing"]].concat())).ok();
}

#[test]
fn a_grid_of_ones_own_is_measured_and_the_boundary_may_be_required() {
    let folder = Folder::new();
    let asked = ["least-squares", "--beside", "", "--data", "cube.vtu", "--json", "t.json"];
    let ran = folder.voltet(&call(&[&asked[..], &["--hold-to", "linear,boundary"]].concat())).ok();
    for text in
        ["The given grid has 64 points", "given        linear", "converges on the boundary of every family"]
    {
        assert!(ran.stdout.contains(text), "{text}: {}", ran.stdout);
    }
    assert_eq!(folder.json("t.json")["filters"][0]["data"]["points"], 64);
    let options = ["least-squares", "--beside", "", "--quiet", "--boundary-order"];
    let ran = folder.voltet(&call(&[&options[..], &["1.9"]].concat())).ok();
    assert!(
        ran.stderr.contains("warning: the gradient filter 'least-squares' does not hold"),
        "{}",
        ran.stderr
    );
    let strict = [&options[..], &["1.9", "--hold-to", "boundary"]].concat();
    folder.voltet(&call(&strict)).fails(1, &["order 1.9 or more: found 0."]);
    let gone = ["least-squares", "--beside", "", "--data", "gone.vtu"];
    folder.voltet(&call(&gone)).fails(1, &["there is no such file (gone.vtu)"]);
}

#[test]
fn wrong_calls_say_what_would_be_right() {
    let folder = Folder::new();
    for (arguments, said) in [
        (vec!["least-sqares"], "least-squares"),
        (vec!["array"], "'array' is missing"),
        (vec!["array", "--set", "array=grad"], "manufactured grids carry none: found 'grad'"),
        (vec!["least-squares", "--set", "power=1"], "unknown parameter 'power'"),
        (vec!["least-squares", "--beside", "least"], "unknown gradient filter 'least'"),
        (vec!["least-squares", "--levels", "8,4"], "rising numbers"),
        (vec!["least-squares", "--plot", "t.pdf"], "ends in .svg"),
    ] {
        let call = [vec!["gradient-test"], arguments].concat();
        folder.voltet(&call).fails(2, &[said]);
    }
}
