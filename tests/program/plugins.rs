//! Gradient filters from shared libraries, as their users meet them.

use crate::support::{Folder, SLAB};
use voltet_testing::compilers;

/// The slab lit, so that its gradient is looked at, with a filter of a plug-in.
fn slab(method: &str) -> String {
    let own = "method = \"least-squares\"";
    let scene = "transfer_function = \"look\", camera = \"view\" }";
    assert!(SLAB.contains(own) && SLAB.contains(scene));
    SLAB.replace(own, method).replace(scene, &format!("{scene}\nlight = {{ direction = [-1.0, 0.0, 0.0] }}"))
}

/// A folder with the example in C, compiled; `None` where there is no compiler.
fn folder() -> Option<Folder> {
    let folder = Folder::new();
    let source = compilers::source("examples/plugin_c/least_squares.c");
    compilers::library(folder.path(), "filter.so", &[source], &[])?;
    folder.write("slab.toml", slab("method = \"c-least-squares\"\npower = 1.0"));
    Some(folder)
}

#[test]
fn a_plugin_is_listed_checked_explained_and_run_as_what_ships() {
    let Some(folder) = folder() else { return };
    let with = ["--plugin", "./filter.so"];
    let help = folder.voltet(&["nodes", with[0], with[1]]).ok();
    assert!(help.stdout.contains("c-least-squares     Linear fit"), "{}", help.stdout);
    let one = folder.voltet(&["nodes", "c-least-squares", with[0], with[1]]).ok();
    assert!(one.stdout.contains("power (number from 0 to 4; default: 1.0)"), "{}", one.stdout);
    folder.voltet(&["check", "slab.toml", with[0], with[1]]).ok();
    let explained = folder.voltet(&["explain", "slab.toml", with[0], with[1]]).ok();
    assert!(explained.stdout.contains("method = \"c-least-squares\"; power = 1.0"), "{}", explained.stdout);
    folder.voltet(&["run", "slab.toml", with[0], with[1], "--report", "r.json"]).ok();
    let own = folder.floats("slab.exr").1;
    let plugins = &folder.report("r.json")["provenance"]["plugins"];
    let bytes = std::fs::metadata(folder.join("filter.so")).unwrap().len();
    assert_eq!(plugins[0]["name"], "least squares in C");
    assert_eq!((&plugins[0]["path"], &plugins[0]["bytes"]), (&"./filter.so".into(), &bytes.into()));
    assert!(
        folder
            .voltet(&["info", "slab.exr"])
            .ok()
            .stdout
            .contains("plug-in (gradient): least squares in C 1.0.0")
    );
    folder.voltet(&["run", "slab.toml", "--set", "gradient.method=least-squares", with[0], with[1]]).fails(
        2,
        &[
            "the method \"least-squares\" has no parameter 'power'",
            "power goes with method = \"c-least-squares\"",
        ],
    );
    folder.write("slab.toml", slab("method = \"least-squares\""));
    folder.voltet(&["run", "slab.toml"]).ok();
    let built_in = folder.floats("slab.exr").1;
    let difference =
        own.iter().flatten().zip(built_in.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(difference < 1e-6, "{difference:e}");
}

#[test]
fn a_filter_that_is_not_loaded_is_unknown_and_the_plugins_are_named() {
    let Some(folder) = folder() else { return };
    let unknown = "unknown gradient filter 'c-least-squares'";
    folder
        .voltet(&["run", "slab.toml"])
        .fails(2, &[unknown, "no plug-in is loaded: --plugin PATH does", "slab.toml:12:10"]);
    folder.voltet(&["check", "slab.toml", "--set", "gradient.method=other", "--plugin", "filter.so"]).fails(
        2,
        &["unknown gradient filter 'other'", "plug-in 'least squares in C' (filter.so) with c-least-squares"],
    );
    // Only the user loads anything: not the pipeline, whatever it says.
    folder
        .write("slab.toml", format!("plugins = [\"./filter.so\"]\n{}", slab("method = \"c-least-squares\"")));
    assert_ne!(folder.voltet(&["run", "slab.toml"]).code, 0);
}

#[test]
fn a_filter_is_given_what_the_header_promises() {
    let Some(folder) = folder() else { return };
    compilers::library(folder.path(), "filter.so", &[compilers::source("tests/plugins/examine.c")], &[]);
    let values = "method = \"examine\"\nflag = true\nwhole = -9007199254740993\nnumber = 0.5\nchoice = \"third\"\n\
                  text = \"été\"\nlist = [-1, 1e300]\none = \"y\"\nthree = \"gradient\"";
    folder.write("slab.toml", slab(values));
    for own_process in [&[][..], &["--plugin-process"]] {
        let ran = folder.voltet(&[&["run", "slab.toml", "--plugin", "filter.so"], own_process].concat()).ok();
        assert!(
            ran.stderr.contains("two and three at 5 points") && !ran.stderr.contains("never"),
            "{}",
            ran.stderr
        );
        let noted = std::fs::read_to_string(folder.join("filter.so.log")).unwrap();
        let (begun, ended) = noted.lines().fold((0, 0), |(begun, ended), line| match line {
            "init" => (begun + 1, ended),
            _ => (begun, ended + 1),
        });
        assert!(begun == ended && begun > 0, "{noted}");
        std::fs::remove_file(folder.join("filter.so.log")).unwrap();
        let shown =
            folder.voltet(&[&["nodes", "examine", "--plugin", "filter.so"], own_process].concat()).ok();
        for text in [
            "flag (true | false; default: false)",
            "whole (whole number, m; required)",
            "number (number between 0 and 10; default: 5.0)",
            "choice (first | second | third; default: \"first\")",
            "nothing (text; default: none)",
            "vector (3 numbers; default: [1.0, 2.0, 3.0])",
            "list (list of numbers -1 or more; default: none)",
        ] {
            assert!(shown.stdout.contains(text), "'{text}' is not in\n{}", shown.stdout);
        }
        std::fs::remove_file(folder.join("filter.so.log")).unwrap();
    }
    // Checked by its declarations, and an array that is not there is named.
    let wrong = |option: &str, wanted: &[&str]| {
        folder.voltet(&["run", "slab.toml", "--plugin", "filter.so", "--set", option]).fails(2, wanted);
    };
    wrong("gradient.number=10", &["'number' is out of range", "between 0 and 10"]);
    wrong("gradient.vector=[1,2]", &["'vector' is of the wrong type", "3 numbers"]);
    wrong("gradient.text=other", &["says: found line", "plug-in 'examine' (filter.so)"]);
    for (option, wanted) in [("gradient.one=gone", "gone"), ("gradient.three=y", "'y' of 1 component (")] {
        let options = ["--plugin", "filter.so", "--set", "gradient.flag=false", "--set", option];
        let ran = folder.voltet(&[&["run", "slab.toml"], &options[..]].concat());
        assert!(ran.code > 0 && ran.stderr.contains(wanted), "{}", ran.stderr);
    }
}

#[test]
fn a_picture_says_which_plugin_drew_it_and_when_another_would() {
    let Some(folder) = folder() else { return };
    let with = ["--plugin", "filter.so"];
    folder.voltet(&["run", "slab.toml", with[0], with[1]]).ok();
    let again = ["run", "slab.exr", "--set", "file.path=again.exr", with[0], with[1]];
    assert_eq!(folder.voltet(&again).ok().stderr, "");
    folder
        .voltet(&again[..4])
        .fails(2, &["unknown gradient filter", "drawn with the plug-in 'least squares in C' (filter.so)"]);
    // Damage that changes neither size nor result.
    let mut bytes = std::fs::read(folder.join("filter.so")).unwrap();
    let at = bytes.windows(7).position(|text| text == b"GCC: (D" || text == b"GCC: (U");
    if let Some(at) = at {
        bytes[at] = b'X';
        folder.write("damaged.so", bytes);
        let damaged = [&again[..5], &["damaged.so"]].concat();
        let said = folder.voltet(&damaged).ok().stderr;
        assert!(said.contains("warning: the picture was drawn with another plug-in"), "{said}");
    }
    let source = std::fs::read_to_string(compilers::source("examples/plugin_c/least_squares.c")).unwrap();
    assert!(source.contains("\"1.0.0\""));
    folder.write("other.c", source.replace("\"1.0.0\"", "\"2.0\""));
    compilers::library(folder.path(), "filter.so", &[folder.join("other.c")], &[]);
    let said = folder.voltet(&again).ok().stderr;
    for text in [
        "warning: the picture was drawn with another plug-in",
        "version 2.0",
        "version 1.0.0",
        "node 'gradient'",
    ] {
        assert!(said.contains(text), "{said}");
    }
}

#[cfg(unix)]
#[test]
fn the_commands_of_the_page_do_what_it_says() {
    let Some(folder) = folder() else { return };
    let page = std::fs::read_to_string(compilers::source("docs/src/how-to/plugins.md")).unwrap();
    let commands = page.split("```sh\n").skip(1).flat_map(|block| block.split("```").next().unwrap().lines());
    for name in ["pipelines", "include", "examples", "data"] {
        std::os::unix::fs::symlink(compilers::source(name), folder.join(name)).unwrap();
    }
    let mut count = 0;
    for command in commands.map(|line| line.split(" #").next().unwrap().trim()) {
        let words: Vec<&str> = command.split_whitespace().collect();
        match words[0] {
            // Pictures go beside, and small ones are enough.
            "voltet" => {
                let small = [
                    "--set",
                    "view.size=[8,6]",
                    "--set",
                    "file.path=/dev/null",
                    "--set",
                    "picture.engine=cpu",
                ];
                let rest = if words[1] == "run" { &small[..] } else { &[] };
                for library in ["reader.so", "filters.so"].iter().filter(|name| command.contains(**name)) {
                    let source = format!("examples/plugin_c/{}", library.replace(".so", ".c"));
                    compilers::library(folder.path(), library, &[compilers::source(&source)], &[]).unwrap();
                }
                folder.voltet(&[&words[1..], rest].concat()).ok();
                count += 1;
            }
            compiler => {
                let sources =
                    words.iter().filter(|word| [".c", ".cpp", ".f90"].iter().any(|end| word.ends_with(end)));
                let sources: Vec<_> = sources.map(|path| compilers::source(path)).collect();
                assert!(["cc", "c++", "gfortran"].contains(&compiler), "{command}");
                if compilers::library(folder.path(), "compiled.so", &sources, &[]).is_some() {
                    folder.voltet(&["nodes", "--plugin", "compiled.so"]).ok();
                }
                count += 1;
            }
        }
    }
    assert_eq!(count, 14);
}

#[test]
fn the_users_own_file_names_plugins() {
    let Some(folder) = folder() else { return };
    let configuration = folder.join("configuration");
    std::fs::create_dir_all(configuration.join("voltet")).unwrap();
    let file = configuration.join("voltet/plugins.toml");
    let home = ("XDG_CONFIG_HOME", configuration.to_str().unwrap());
    let path = folder.join("filter.so");
    std::fs::write(&file, format!("plugins = ['{}']\n", path.display())).unwrap();
    folder.voltet_where(home, &["run", "slab.toml"]).ok();
    // The same library by an option: once is enough.
    folder.voltet_where(home, &["check", "slab.toml", "--plugin", "filter.so"]).ok();
    // One that is gone is warned of; what lists all looks for it, and what does without does not.
    std::fs::write(&file, "plugins = ['gone.so']\n").unwrap();
    let ran = folder.voltet_where(home, &["check", "slab.toml", "--plugin", "filter.so"]).ok();
    assert_eq!(ran.stderr, "");
    let ran = folder.voltet_where(home, &["nodes", "--plugin", "filter.so"]).ok();
    assert!(
        ran.stderr.contains("warning: the plug-in cannot be read") && ran.stderr.contains("gone.so"),
        "{}",
        ran.stderr
    );
    folder
        .voltet_where(home, &["check", "slab.toml", "--plugin", "gone.so"])
        .fails(2, &["the plug-in cannot be read"]);
    // The file to the byte, and no other.
    let wanted = |fingerprint: &str| {
        let text =
            format!("plugins = [{{ path = '{}', fingerprint = \"{fingerprint}\" }}]\n", path.display());
        std::fs::write(&file, text).unwrap();
        folder.voltet_where(home, &["check", "slab.toml"])
    };
    let found = voltet_plugins::PluginFile::read(&path).unwrap().fingerprint();
    wanted(&found).ok();
    let refused = wanted("0123456789abcdef");
    assert!(refused.stderr.contains(&format!("its file has changed: found {found}")), "{}", refused.stderr);
    assert_eq!(refused.code, 2);
    for (text, wanted) in [
        ("plugins = 3\n", &["'plugins' is no list of paths", "plugins.toml"][..]),
        ("plugins = [{ path = 'a', fingerprint = 3 }]\n", &["'plugins' is no list of paths"]),
        ("plugins = [{ fingerprint = '3' }]\n", &["'plugins' is no list of paths"]),
        ("plug = []\n", &["unknown key 'plug'"]),
        ("plugins = [\n", &["plugins.toml:"]),
    ] {
        std::fs::write(&file, text).unwrap();
        folder.voltet_where(home, &["check", "slab.toml"]).fails(2, wanted);
    }
    // A command that needs none does not read it.
    folder.write("plain.toml", slab("method = \"least-squares\""));
    folder.voltet_where(home, &["run", "plain.toml"]).ok();
    folder.voltet_where(home, &["info", "cube.vtu"]).ok();
}
