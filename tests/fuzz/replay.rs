//! Fuzzing without a fuzzer: every seed, and every input that once broke something, through the body of its target.
//! New ones go into `data/fuzz/TARGET`, named after what they show.

mod found;
mod seeds;

use etendue_tests::fuzz::TARGETS;
use std::path::{Path, PathBuf};

fn folder(target: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("data/fuzz")
        .join(target)
}

#[test]
fn seeds_and_regressions() {
    for (target, body) in TARGETS {
        let folder = folder(target);
        let mut inputs: Vec<PathBuf> = std::fs::read_dir(&folder)
            .unwrap_or_else(|e| panic!("{}: {e}", folder.display()))
            .map(|entry| entry.unwrap().path())
            .collect();
        inputs.sort();
        assert!(inputs.len() >= 5, "{target}: only {} inputs", inputs.len());
        for input in inputs {
            println!("{}", input.display());
            body(&std::fs::read(&input).unwrap());
        }
    }
}
