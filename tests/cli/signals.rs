//! Ctrl-C, full disks, closed pipes.
#![cfg(unix)]

use super::{bytes, etendue, folder, json, succeed, text};
use std::fs::File;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The program, running in `folder`.
fn start(folder: &Path, arguments: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_etendue"))
        .args(arguments)
        .current_dir(folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn interrupt(child: &Child) {
    let kill = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(kill.unwrap().success());
}

fn names(at: &Path) -> Vec<String> {
    std::fs::read_dir(at)
        .unwrap()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .collect()
}

#[test]
fn the_first_interrupt_writes_the_passes_so_far() {
    let (_keep, at) = folder();
    let child = start(
        &at,
        &[
            "render",
            "scene.xml",
            "-o",
            "x.exr",
            "--time",
            "1h",
            "--json",
        ],
    );
    std::thread::sleep(Duration::from_millis(1500));
    interrupt(&child);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["interrupted"], true);
    let passes = report["passes"].to_string();
    let again = [
        "render",
        "scene.xml",
        "-o",
        "y.exr",
        "--spp",
        &passes,
        "--json",
    ];
    assert_eq!(json(&at, &again)["interrupted"], false);
    assert!(
        bytes(&at, "x.exr") == bytes(&at, "y.exr"),
        "{passes} passes"
    );
}

/// A pass of this image takes longer than the test waits.
#[test]
fn the_second_interrupt_ends_at_once_and_leaves_nothing() {
    let (_keep, at) = folder();
    let size = ["--width", "6000", "--height", "6000"];
    let mut arguments = vec!["render", "scene.xml", "-o", "x.exr", "--threads", "1"];
    arguments.extend(size);
    let mut child = start(&at, &arguments);
    std::thread::sleep(Duration::from_millis(1500));
    interrupt(&child);
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(child.try_wait().unwrap(), None, "one is for after the pass");
    let asked = Instant::now();
    interrupt(&child);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(asked.elapsed() < Duration::from_secs(5));
    assert_eq!(names(&at), ["scene.xml"]);
}

#[test]
fn nobody_reads_on() {
    let (_keep, at) = folder();
    let mut child = start(&at, &["inspect", "scene.xml"]);
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(text(&output.stderr), "");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_and_a_folder_nobody_can_write() {
    let (_keep, at) = folder();
    let output = Command::new(env!("CARGO_BIN_EXE_etendue"))
        .args(["inspect", "scene.xml"])
        .current_dir(&at)
        .stdout(File::options().write(true).open("/dev/full").unwrap())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).starts_with("error: standard output"));
    // Not even root makes files here.
    let output = etendue(&at, &["render", "scene.xml", "-o", "/proc/x.png"]);
    assert_eq!(output.status.code(), Some(1));
    let error = text(&output.stderr);
    assert!(
        error.starts_with("error: /proc/x.png: can't be written"),
        "{error}"
    );
    assert!(!error.contains(".etendue-"), "{error}");
}

/// As other programs' files, not the owner's alone as temporary files are.
#[test]
fn images_have_the_rights_of_any_new_file() {
    use std::os::unix::fs::PermissionsExt;
    let (_keep, at) = folder();
    succeed(&at, &["render", "scene.xml", "-o", "x.png", "--quiet"]);
    let page = [
        "stability",
        "--only",
        "close-light",
        "--spp-scale",
        "0.01",
        "-o",
        "x.html",
        "--quiet",
    ];
    let _ = super::etendue(&at, &page);
    let mode = |name: &str| at.join(name).metadata().unwrap().permissions().mode();
    assert_eq!(mode("x.png"), mode("scene.xml"));
    assert_eq!(mode("x.html"), mode("scene.xml"));
}
