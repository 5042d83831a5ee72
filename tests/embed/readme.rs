//! README's section "Embed", word for word: what it shows is what the tests run, and its commands work.

use crate::tools::{have, run, text};
use etendue_tests::place::root;
use std::process::Command;

/// The code blocks of a language in the section.
fn blocks(language: &str) -> Vec<String> {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    let start = readme.find("\n## Embed\n").expect("a section");
    let section = &readme[start + 4..];
    let section = section.split("\n## ").next().unwrap();
    let first_line = format!("{language}\n");
    let blocks = section.split("\n```");
    blocks
        .filter_map(|block| Some(format!("{}\n", block.strip_prefix(&first_line)?)))
        .collect()
}

/// The snippets are the examples, which other tests compile and run.
#[test]
fn its_snippets_are_the_examples() {
    for (language, example) in [
        ("c", "c/hello_irradiance.c"),
        ("rust", "rust/hello_irradiance.rs"),
        ("js", "web/hello_irradiance.mjs"),
    ] {
        let source = root().join("kernel/examples").join(example);
        let source = std::fs::read_to_string(source).unwrap();
        assert!(blocks(language) == [source], "{example} isn't in README");
    }
}

/// From a fresh clone to a float, in C, Rust and JavaScript: each prints the same.
#[test]
fn its_commands_print_the_irradiance() {
    let tools = [
        "cc",
        "pkg-config",
        "node",
        "/usr/lib/rustlib/src/rust/library/core/Cargo.toml",
    ];
    if !tools.into_iter().all(have) {
        return;
    }
    let [in_c, in_rust, in_js] = &blocks("sh")[..] else {
        panic!("expected three blocks of commands")
    };
    let shell = |commands: &str| {
        let line = format!("set -e\n{commands}");
        let output = run(Command::new("sh").args(["-c", &line]).current_dir(root()));
        let numbers = text(&output);
        let last = numbers.lines().last().unwrap().to_owned();
        let numbers = last
            .strip_suffix(" W/m2")
            .unwrap_or_else(|| panic!("{last}"));
        let numbers = numbers.split(' ').map(|n| n.parse::<f32>().unwrap());
        numbers.collect::<Vec<_>>()
    };
    let (c, rust, js) = (shell(in_c), shell(in_rust), shell(in_js));
    assert_eq!((c.len(), rust.len(), js.len()), (3, 3, 3));
    for i in 0..3 {
        // C prints six digits.
        let near = |other: f32| (c[i] / other - 1.0).abs() < 1e-5;
        assert!(
            c[i] > 0.0 && near(rust[i]) && near(js[i]),
            "{c:?} {rust:?} {js:?}"
        );
    }
}
