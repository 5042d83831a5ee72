//! README's section "Embed", word for word: what it shows is what the tests run, and its commands work.

use crate::tools::{have, run, text};
use etendue_tests::header::root;
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
    ] {
        let source = root().join("kernel/examples").join(example);
        let source = std::fs::read_to_string(source).unwrap();
        assert!(blocks(language) == [source], "{example} isn't in README");
    }
}

/// From a fresh clone to a float, in C and in Rust: each prints the same.
#[test]
fn its_commands_print_the_irradiance() {
    if !have("cc") || !have("pkg-config") {
        return;
    }
    let [in_c, in_rust] = &blocks("sh")[..2] else {
        panic!("README has no commands")
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
    let (c, rust) = (shell(in_c), shell(in_rust));
    assert_eq!(c.len(), 3);
    for (c, rust) in c.iter().zip(&rust) {
        // C prints six digits.
        assert!(*c > 0.0 && (c / rust - 1.0).abs() < 1e-5, "{c} {rust}");
    }
}
