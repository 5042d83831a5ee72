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
    if !found {
        let ci = std::env::var_os("CI").is_some_and(|v| v == "true");
        assert!(
            !ci,
            "{tool} is missing: .ci/install should have installed it"
        );
        println!("skipped: {tool} is not installed");
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

/// The compiler that Debian ships with its library's source, to build `core` for targets whose own can't be had.
const RUSTC: &str = "/usr/bin/rustc";

/// Whether `core` can be built for other targets (packages rustc-web and rust-web-src).
pub fn have_core() -> bool {
    have(RUSTC) && have("/usr/lib/rustlib/src/rust/library/core/Cargo.toml")
}

/// Cargo for a package outside of the workspace, with `core` built for `triple`.
pub fn build_core(package: &str, folder: &Path, triple: &str) -> Command {
    let sysroot = text(&run(Command::new("rustc").args(["--print", "sysroot"])));
    let linkers = Path::new(sysroot.trim()).join("lib/rustlib/x86_64-unknown-linux-gnu/bin");
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths(std::env::split_paths(&path).chain([linkers.clone()])).unwrap();
    let mut command = Command::new(env!("CARGO"));
    command
        .current_dir(root().join(package))
        .args(["build", "--locked", "-Zbuild-std=core", "--target", triple])
        .env("CARGO_TARGET_DIR", folder)
        .env(
            "CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER",
            linkers.join("rust-lld"),
        )
        .env("RUSTC", RUSTC)
        .env("RUSTC_BOOTSTRAP", "1")
        .env("PATH", path)
        .env_remove("RUSTFLAGS");
    command
}
