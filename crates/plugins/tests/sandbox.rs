//! WebAssembly modules: written out by hand, some of them hostile, and the C example compiled for the sandbox.
#![cfg(feature = "wasm")]
#![allow(clippy::unwrap_used)] // A test that cannot go on has failed.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};
use voltet_core::error::ErrorKind;
use voltet_core::field::{Gradient, GradientFilter, LeastSquares, Method};
use voltet_core::glam::DVec3;
use voltet_core::grid::Grid;
use voltet_core::grid::generate::{Random, box_of_tetrahedra, sample};
use voltet_core::progress::{NoProgress, Progress};
use voltet_core::{Error, Result};
use voltet_testing::compilers;

/// Text of a module; by default the smallest that is valid.
#[derive(Clone)]
struct Wat {
    imports: &'static str,
    /// True if the table may grow.
    grows: bool,
    entry: [u32; 7],
    plugin: [u32; 4],
    factory: [u32; 4],
    filter: [u32; 9],
    /// The body of the filter's function of `$call` and `$host`.
    body: &'static str,
}

/// (1, 2, 3) at every point.
const EVEN: &str = "(local $out i32) (local $end i32)
    (local.set $out (i32.load offset=60 (local.get $call)))
    (local.set $end (i32.add (local.get $out) (i32.mul (i32.const 24) (i32.load offset=8 (local.get $call)))))
    (loop $next
      (f64.store (local.get $out) (f64.const 1))
      (f64.store offset=8 (local.get $out) (f64.const 2))
      (f64.store offset=16 (local.get $out) (f64.const 3))
      (local.set $out (i32.add (local.get $out) (i32.const 24)))
      (br_if $next (i32.lt_u (local.get $out) (local.get $end))))
    (i32.const 0)";

impl Wat {
    fn new(body: &'static str) -> Wat {
        Wat {
            imports: "",
            grows: true,
            entry: [28, 1, 0, 0, 1, 0, 2],
            plugin: [16, 0, 1024, 1032],
            factory: [16, 0, 3, 4],
            filter: [36, 0, 1040, 1048, 0, 0, 0, 0, 5],
            body,
        }
    }

    fn text(&self) -> String {
        let data = |numbers: &[u32]| -> String {
            numbers.iter().flat_map(|n| n.to_le_bytes()).map(|byte| format!("\\{byte:02x}")).collect()
        };
        let most = if self.grows { "" } else { "6" };
        format!(
            "(module {}
  (memory (export \"memory\") 1)
  (table (export \"__indirect_function_table\") 6 {most} funcref)
  (elem (i32.const 1) $init $get_factory $filter_count $filter $gradient)
  (global (export \"voltet_plugin_entry\") i32 (i32.const 384))
  (data (i32.const 256) \"{}\") (data (i32.const 288) \"{}\")
  (data (i32.const 320) \"{}\") (data (i32.const 384) \"{}\")
  (data (i32.const 1024) \"even\\00\") (data (i32.const 1032) \"1.0\\00\")
  (data (i32.const 1040) \"even\\00\") (data (i32.const 1048) \"The same everywhere.\\00\")
  (func $init (param i32 i32) (result i32) (i32.const 256))
  (func $get_factory (param i32) (result i32) (i32.const 288))
  (func $filter_count (result i32) (i32.const 1))
  (func $filter (param i32) (result i32) (i32.const 320))
  (func $gradient (param $call i32) (param $host i32) (result i32) {}))",
            self.imports,
            data(&self.plugin),
            data(&self.factory),
            data(&self.filter),
            data(&self.entry),
            self.body
        )
    }

    fn loaded(&self) -> Result<Vec<Arc<dyn GradientFilter>>> {
        load(&voltet_testing::wat::parse_str(self.text()).unwrap())
    }

    /// Gradient of its filter on a small grid.
    fn gradient(&self, progress: &dyn Progress) -> Result<Gradient> {
        gradient(&self.loaded().unwrap()[0], progress)
    }
}

fn load(bytes: &[u8]) -> Result<Vec<Arc<dyn GradientFilter>>> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("filter.wasm");
    std::fs::write(&path, bytes).unwrap();
    voltet_plugins::load(&path).map(|contents| contents.filters)
}

fn grid() -> (Grid, Vec<f64>) {
    let grid = box_of_tetrahedra([4, 3, 5], [DVec3::ZERO, DVec3::ONE], 0.2);
    let scalar = sample(&grid, |p| (2.0 * p.x).sin() + p.y * p.z);
    (grid, scalar)
}

fn gradient(filter: &Arc<dyn GradientFilter>, progress: &dyn Progress) -> Result<Gradient> {
    let (grid, scalar) = grid();
    Method::with_defaults(filter.clone())?.gradient(&grid, &scalar, progress)
}

/// Asks to stop after a while.
struct Impatient(Instant, Duration);

impl Progress for Impatient {
    fn report(&self, _stage: &str, _fraction: f64) {}
    fn cancelled(&self) -> bool {
        self.0.elapsed() > self.1
    }
}

#[test]
fn a_module_is_a_filter_like_any_other() {
    let filters = Wat::new(EVEN).loaded().unwrap();
    let [filter] = &filters[..] else { panic!("{} filters", filters.len()) };
    assert_eq!((filter.declaration().name, filter.declaration().summary), ("even", "The same everywhere."));
    let plugin = filter.plugin().unwrap();
    assert_eq!((plugin.name.as_str(), plugin.version.as_str()), ("even", "1.0"));
    // Each call is a module anew.
    for _ in 0..2 {
        let found = gradient(filter, &NoProgress).unwrap();
        assert!(found.vectors.iter().all(|v| *v == DVec3::new(1.0, 2.0, 3.0)));
    }
}

#[test]
fn what_a_module_does_wrong_is_an_error_that_names_it() {
    let print =
        "(import \"wasi_snapshot_preview1\" \"fd_write\" (func $print (param i32 i32 i32 i32) (result i32)))";
    let cases: [(&str, &str, &str); 10] = [
        ("", "(i32.const 0)", "did not give every point a vector"),
        ("", "unreachable", "unreachable"),
        ("", "(i32.load (i32.const 0x7ffffff0))", "out of bounds"),
        ("", "(call $gradient (local.get $call) (local.get $host))", "stack"),
        ("", "(i32.const 7)", "code 7"),
        // The size of its call: 3 numbers of 64 bits and 13 pointers of 32, up to a multiple of 8, as compilers have it.
        ("", "(i32.load (local.get $call))", "code 80"),
        (
            "",
            "(f64.store offset=16 (i32.load offset=24 (local.get $call)) (f64.const 9)) (i32.const 0)",
            "it wrote into the points",
        ),
        (
            "",
            "(loop $more (br_if $more (i32.ne (memory.grow (i32.const 4096)) (i32.const -1)))) (i32.const 2)",
            "did not say why",
        ),
        (print, "(call $print (i32.const 1) (i32.const 0) (i32.const 0) (i32.const 0))", "fd_write"),
        (
            "",
            "(f64.store (i32.add (i32.load offset=60 (local.get $call)) (i32.mul (i32.const 24) (i32.load offset=8 (local.get $call)))) (f64.const 1)) (i32.const 0)",
            "beyond the end",
        ),
    ];
    for (imports, body, wanted) in cases {
        let module = Wat { imports, ..Wat::new(body) };
        let said = module.gradient(&NoProgress).unwrap_err().to_string();
        assert!(said.contains(wanted) && said.contains("'even'"), "{body}: {said}");
    }
}

#[test]
fn a_module_without_end_ends_where_the_user_says_so() {
    let begun = Instant::now();
    let endless = Wat::new("(loop $on (br $on)) (i32.const 0)");
    let error = endless.gradient(&Impatient(begun, Duration::from_millis(200))).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Cancelled, "{error}");
    // And the module serves again.
    assert!(Wat::new(EVEN).gradient(&NoProgress).is_ok());
}

#[test]
fn declarations_that_are_wrong_are_refused_with_a_reason() {
    let even = Wat::new(EVEN);
    let cases: [(Wat, &str); 9] = [
        (Wat { entry: [28, 2, 0, 0, 1, 0, 2], ..even.clone() }, "version 2.0.0"),
        (Wat { entry: [24, 1, 0, 0, 1, 0, 2], ..even.clone() }, "24 bytes"),
        (Wat { entry: [28, 1, 0, 0, 0, 0, 2], ..even.clone() }, "'init' is a null pointer"),
        (Wat { entry: [28, 1, 0, 0, 3, 0, 2], ..even.clone() }, "takes or gives something else"),
        (Wat { entry: [28, 1, 0, 0, 77, 0, 2], ..even.clone() }, "'init' is none"),
        (Wat { grows: false, ..even.clone() }, "--growable-table"),
        (Wat { plugin: [16, 0, 0xffff_ff00, 1032], ..even.clone() }, "memory that is not there"),
        (Wat { filter: [36, 0, 1040, 1048, 65, 0, 0, 0, 5], ..even.clone() }, "65 parameters"),
        (Wat { filter: [36, 0, 1040, 1048, 0, 0, 0, 0, 0], ..even.clone() }, "'gradient' is a null pointer"),
    ];
    for (module, wanted) in cases {
        let Err(error) = module.loaded() else { panic!("{wanted}: loaded") };
        let said = error.to_string();
        assert!(said.contains(wanted) && said.contains("filter.wasm"), "{wanted}: {said}");
    }
}

/// Any byte may be another: the module is refused, fails with a message, or gives vectors that are finite.
#[test]
fn damaged_modules_harm_nobody() {
    let whole = voltet_testing::wat::parse_str(Wat::new(EVEN).text()).unwrap();
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let mut counts = [0; 3];
    let rounds = std::env::var("VOLTET_DAMAGES").ok().and_then(|n| n.parse().ok()).unwrap_or(300);
    for _ in 0..rounds {
        let mut bytes = whole.clone();
        for _ in 0..1 + (3.0 * random.next()) as usize {
            let at = 4 + (random.next() * (bytes.len() - 4) as f64) as usize;
            bytes[at] = (256.0 * random.next()) as u8;
        }
        let outcome = load(&bytes)
            .map(|filters| gradient(&filters[0], &Impatient(Instant::now(), Duration::from_secs(1))));
        let place = match outcome {
            Err(error) => said(&error, 0),
            Ok(Err(error)) => said(&error, 1),
            Ok(Ok(found)) => {
                assert!(found.vectors.iter().all(|v| v.is_finite()));
                2
            }
        };
        counts[place] += 1;
    }
    println!("{} refused, {} failed, {} served", counts[0], counts[1], counts[2]);
    assert!(counts.iter().all(|count| *count > 0), "{counts:?}");
}

fn said(error: &Error, place: usize) -> usize {
    assert!(!error.to_string().is_empty());
    place
}

/// The source of the C example, compiled for the sandbox as docs/src/how-to/plugins.md says.
#[test]
fn the_c_example_runs_in_the_sandbox_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let path: PathBuf = folder.path().join("least_squares.wasm");
    let Some(()) = compilers::module(&compilers::source("examples/plugin_c/least_squares.c"), &path) else {
        return;
    };
    let filters = voltet_plugins::load(&path).unwrap().filters;
    let found = gradient(&filters[0], &NoProgress).unwrap();
    let own = gradient(&(Arc::new(LeastSquares) as Arc<dyn GradientFilter>), &NoProgress).unwrap();
    let largest = own.vectors.iter().map(|v| v.length()).fold(0.0, f64::max);
    let off =
        own.vectors.iter().zip(&found.vectors).map(|(a, b)| (*a - *b).length()).fold(0.0, f64::max) / largest;
    assert!(off < 1e-12, "{off:e}");
}

/// The commands of the page's section about the sandbox: the compiler's as it stands, the program's by what it names.
#[cfg(unix)]
#[test]
fn the_commands_of_the_page_make_a_module_that_runs() {
    use std::process::Command;
    let page = std::fs::read_to_string(compilers::source("docs/src/how-to/plugins.md")).unwrap();
    let section = page.split_once("## In a sandbox: WebAssembly").unwrap().1;
    let block = section.split_once("```text\n").unwrap().1.split_once("```").unwrap().0.replace("\\\n", " ");
    let commands: Vec<Vec<&str>> = block.lines().map(|line| line.split_whitespace().collect()).collect();
    let [compile, run] = &commands[..] else { panic!("two commands: {block}") };
    let folder = tempfile::tempdir().unwrap();
    for name in ["include", "examples"] {
        std::os::unix::fs::symlink(compilers::source(name), folder.path().join(name)).unwrap();
    }
    match Command::new(compile[0]).args(&compile[1..]).current_dir(folder.path()).output() {
        Ok(output) if output.status.success() => {}
        // Said loudly where there is no such compiler, once for all.
        _ => {
            let source = compilers::source("examples/plugin_c/least_squares.c");
            assert!(compilers::module(&source, &folder.path().join("other.wasm")).is_none(), "{compile:?}");
            return;
        }
    }
    let own = run.split(|word| *word == "--").nth(1).unwrap();
    let after = |option: &str| own[own.iter().position(|word| *word == option).unwrap() + 1];
    let filters = voltet_plugins::load(&folder.path().join(after("--plugin"))).unwrap().filters;
    let (parameter, method) = after("--set").split_once('=').unwrap();
    assert_eq!((parameter, filters[0].declaration().name), ("gradient.method", method));
    assert!(compilers::source(after("run")).is_file(), "{run:?}");
    assert!(gradient(&filters[0], &NoProgress).is_ok());
}

/// A filter that calls no library, by the header's macro and the page's command without a run-time library.
#[cfg(unix)]
const PLAIN: &str = "#include \"voltet_plugin.h\"
static int32_t even(const voltet_call *call, const voltet_host *host) {
    for (uint64_t i = 0; i < 3 * call->point_count; i++) call->gradient[i] = (double)(1 + i % 3);
    return host->cancelled(host) ? VOLTET_CANCELLED : VOLTET_OK;
}
static const voltet_gradient_filter filter = {
    .size = sizeof filter, .name = \"even\", .summary = \"The same everywhere.\", .gradient = even};
VOLTET_GRADIENT_PLUGIN(\"plain\", \"1.0\", &filter)
";

#[cfg(unix)]
#[test]
fn the_command_without_a_run_time_library_makes_a_module_that_runs() {
    let page = std::fs::read_to_string(compilers::source("docs/src/how-to/plugins.md")).unwrap();
    let section = page.split_once("## In a sandbox: WebAssembly").unwrap().1;
    let block = section.split("```text\n").nth(2).unwrap().split_once("```").unwrap().0.replace("\\\n", " ");
    let words: Vec<&str> = block.split_whitespace().collect();
    let folder = tempfile::tempdir().unwrap();
    std::os::unix::fs::symlink(compilers::source("include"), folder.path().join("include")).unwrap();
    std::fs::write(folder.path().join("filter.c"), PLAIN).unwrap();
    let compiled = std::process::Command::new(words[0]).args(&words[1..]).current_dir(folder.path()).output();
    if !compiled.is_ok_and(|output| output.status.success()) {
        let source = compilers::source("examples/plugin_c/least_squares.c");
        assert!(compilers::module(&source, &folder.path().join("other.wasm")).is_none(), "{words:?}");
        return;
    }
    let filters = voltet_plugins::load(&folder.path().join("filter.wasm")).unwrap().filters;
    let found = gradient(&filters[0], &NoProgress).unwrap();
    assert!(found.vectors.iter().all(|v| *v == DVec3::new(1.0, 2.0, 3.0)));
}

/// A sandbox says what it runs, and what it does not.
#[test]
fn a_module_without_gradient_filters_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path: PathBuf = folder.path().join("filters.wasm");
    let Some(()) = compilers::module(&compilers::source("examples/plugin_c/filters.c"), &path) else {
        return;
    };
    let refused = voltet_plugins::load(&path).map(drop).unwrap_err().to_string();
    for text in
        ["a sandbox runs these alone", "readers, grid filters and image filters need a shared library"]
    {
        assert!(refused.contains(text), "{refused}");
    }
}
