//! Other people's tools: found, run, or said to be missing.

use etendue_tests::place::root;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Whether `tool` is there. If not, the test says so and passes; in CI it fails, because CI installs all of them.
pub fn have(tool: &str) -> bool {
    let found = tool.starts_with('/') && Path::new(tool).exists()
        || std::env::var_os("PATH").is_some_and(|path| {
            std::env::split_paths(&path).any(|folder| folder.join(tool).is_file())
        });
    missing_in_ci(found, &format!("{tool} is not installed"))
}

/// Says why a test is skipped if something wasn't found.
fn missing_in_ci(found: bool, why: &str) -> bool {
    if !found {
        let ci = std::env::var_os("CI").is_some_and(|v| v == "true");
        assert!(!ci, "{why}: .ci/install should have installed it");
        println!("skipped: {why}");
    }
    found
}

/// Runs to the end; anything but success fails the test, with all that was said.
pub fn run(command: &mut Command) -> Output {
    let output = command
        .output()
        .unwrap_or_else(|e| panic!("{command:?}: {e}"));
    assert!(
        output.status.success(),
        "{command:?}: {}\n{}\n{}",
        output.status,
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr),
    );
    output
}

/// What it printed.
pub fn text(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// A folder for what tests build, kept between runs.
pub fn target(name: &str) -> PathBuf {
    let folder = root().join("target/embed").join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder.canonicalize().unwrap()
}

/// Cargo on a package that isn't a member of the workspace, into a target folder of its own.
pub fn cargo(package: &str, folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO"));
    command
        .current_dir(root().join(package))
        .args(["build", "--release", "--locked"])
        .env("CARGO_TARGET_DIR", folder)
        .env_remove("RUSTFLAGS");
    command
}

/// Whether there is a library for another target, by `kernel/cross`. As [`have`], a test that lacks it is skipped, but in CI.
pub fn have_library(triple: &str) -> bool {
    let asked = Command::new(root().join("kernel/cross"))
        .arg(triple)
        .output()
        .unwrap();
    missing_in_ci(
        asked.status.success(),
        String::from_utf8_lossy(&asked.stderr).trim(),
    )
}

/// Cargo for a package outside of the workspace and for another target, into a target folder of its own.
pub fn cross(package: &str, folder: &Path, triple: &str) -> Command {
    let mut command = Command::new(root().join("kernel/cross"));
    command
        .current_dir(root().join(package))
        .args([triple, "build", "--locked"])
        .env("CARGO_TARGET_DIR", folder)
        .env_remove("RUSTFLAGS");
    command
}
