//! The hosted library as C sees it: installed, found, linked, run; the same bits as from Rust.

use crate::cornell;
use crate::tools::{have, run, target, text};
use etendue_tests::place::root;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// Where both libraries are installed, by README's line.
fn prefix() -> &'static Path {
    static PREFIX: OnceLock<PathBuf> = OnceLock::new();
    PREFIX.get_or_init(|| {
        let folder = target("installed");
        let prefix = folder.join("a prefix");
        let _ = std::fs::remove_dir_all(&prefix);
        // The script finds its own files from anywhere.
        let script = std::fs::canonicalize(root().join("host/capi/install")).unwrap();
        run(Command::new("sh")
            .arg(script)
            .arg(&prefix)
            .current_dir(&folder));
        prefix
    })
}

/// The program's source.
fn source() -> PathBuf {
    root().join("kernel/examples/c/build_scene.c")
}

/// The same for C++.
fn sky() -> PathBuf {
    root().join("kernel/examples/cmake/sky.cpp")
}

/// Compiles with everything said out loud; returns the program.
fn compile(folder: &Path, compiler: &str, source: &Path, flags: &[&str]) -> PathBuf {
    let program = folder.join("program");
    let flags_of_package = text(&run(Command::new("pkg-config")
        .args(["--cflags", "--libs", "etendue_host"])
        .env("PKG_CONFIG_PATH", prefix().join("lib/pkgconfig"))));
    // A shell takes pkg-config's quoting apart.
    let line = format!(
        "{compiler} -Wall -Wextra -Werror -pedantic {} \"$1\" {} -o \"$2\"",
        flags.join(" "),
        flags_of_package.trim()
    );
    run(Command::new("sh")
        .args(["-c", &line, "sh"])
        .arg(source)
        .arg(&program));
    program
}

fn render(folder: &Path, mut command: Command, samples: &str) -> String {
    let picture = folder.join("cornell.ppm");
    let printed = text(&run(command.arg(&picture).arg(samples)));
    let bytes = std::fs::read(picture).unwrap();
    assert_eq!(&bytes[..15], b"P6\n128 128\n255\n");
    assert_eq!(bytes.len(), 15 + 3 * 128 * 128);
    printed
}

#[test]
fn a_c_program_renders_the_same_bits_as_rust() {
    if !have("cc") || !have("pkg-config") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let program = compile(folder.path(), "cc", &source(), &["-std=c99"]);
    let printed = render(folder.path(), Command::new(program), "4");
    assert_eq!(printed, cornell::printed(4));
}

#[test]
fn the_sanitizers_have_nothing_to_say() {
    if !have("cc") || !have("pkg-config") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let flags = [
        "-g",
        "-fsanitize=address,undefined",
        "-fno-sanitize-recover=all",
    ];
    let strictly = |standard| [&[standard], &flags[..]].concat();
    let program = compile(folder.path(), "cc", &source(), &strictly("-std=c99"));
    let printed = render(folder.path(), Command::new(program), "1");
    assert_eq!(printed, cornell::printed(1));
    if have("c++") {
        let program = compile(folder.path(), "c++", &sky(), &strictly("-std=c++11"));
        assert_eq!(text(&run(&mut Command::new(program))), "1.000\n");
    }
}

#[test]
fn valgrind_has_nothing_to_say() {
    if !have("cc") || !have("pkg-config") || !have("valgrind") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let valgrind = |program| {
        let mut valgrind = Command::new("valgrind");
        // What the Rust runtime keeps for a thread until the process ends is pointed into, which counts as "possibly lost".
        valgrind
            .args(["--quiet", "--error-exitcode=1", "--leak-check=full"])
            .args([
                "--errors-for-leak-kinds=definite",
                "--show-leak-kinds=definite",
            ])
            .arg(program);
        valgrind
    };
    let program = compile(folder.path(), "cc", &source(), &["-std=c99"]);
    let printed = render(folder.path(), valgrind(program), "1");
    assert_eq!(printed, cornell::printed(1));
    if have("c++") {
        let program = compile(folder.path(), "c++", &sky(), &["-std=c++11"]);
        assert_eq!(text(&run(&mut valgrind(program))), "1.000\n");
    }
}

#[test]
fn the_headers_are_cxx_too_and_c_of_every_year() {
    if !have("cc") || !have("c++") || !have("pkg-config") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for standard in ["-std=c99", "-std=c11", "-std=c17"] {
        let file = folder.path().join("twice.c");
        let twice =
            "#include <etendue_host.h>\n#include <etendue_host.h>\nint main(void) { return 0; }\n";
        std::fs::write(&file, twice).unwrap();
        compile(folder.path(), "cc", &file, &[standard]);
    }
    for standard in ["-std=c++11", "-std=c++20"] {
        let program = compile(folder.path(), "c++", &sky(), &[standard]);
        assert_eq!(text(&run(&mut Command::new(program))), "1.000\n");
    }
}

#[test]
fn cmake_finds_the_package() {
    if !have("cmake") || !have("cc") || !have("c++") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    run(Command::new("cmake")
        .arg("-S")
        .arg(root().join("kernel/examples/cmake"))
        .arg("-B")
        .arg(folder.path())
        .arg(format!("-DCMAKE_PREFIX_PATH={}", prefix().display())));
    run(Command::new("cmake").arg("--build").arg(folder.path()));
    for program in ["sky", "version"] {
        run(&mut Command::new(folder.path().join(program)));
    }
    let program = Command::new(folder.path().join("build_scene"));
    assert_eq!(render(folder.path(), program, "1"), cornell::printed(1));
}
