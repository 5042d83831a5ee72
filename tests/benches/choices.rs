//! Whether `--estimator auto` chooses well: `cargo bench --bench choices`. For every scene of `host/scenes`, `tests/data/scenes` and the folder that ETENDUE_SCENES names, what
//! its pilot chooses beside the efficiencies that a chart measures. About 20 s of two cores a scene.
//!
//! Budget: on 9 scenes of 10 what is chosen has at least 0.9 of the best one's efficiency.

use etendue_tests::place::root;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// CPU time of a chart, of its reference.
const TIMES: [&str; 2] = ["16s", "24s"];
const CANDIDATES: &str = "path,bidirectional";

fn main() {
    let root = root();
    let built = Command::new(env!("CARGO"))
        .current_dir(&root)
        .args(["build", "--quiet", "--release", "--bin", "etendue"])
        .status()
        .expect("cargo runs");
    assert!(built.success(), "the program isn't built");
    let program = root.join("target/release/etendue");
    let work = tempfile::tempdir().expect("a temporary folder");

    let mut folders = vec![root.join("host/scenes"), root.join("tests/data/scenes")];
    folders.extend(std::env::var_os("ETENDUE_SCENES").map(PathBuf::from));
    let (mut good, mut all) = (0, 0);
    println!(
        "scene: chosen, its efficiency over the best one's (bidirectional's over path's, 95 %)"
    );
    for scene in folders.iter().flat_map(|folder| scenes(folder)) {
        let name = scene.file_stem().unwrap_or_default().to_string_lossy();
        let Some(chosen) = chosen(&program, &scene, work.path()) else {
            println!("{name}: refused, or there is no choice");
            continue;
        };
        let [path, bidirectional, ratio, low, high] = measured(&program, &scene, work.path());
        let of_chosen = if chosen == "path" {
            path
        } else {
            bidirectional
        };
        let share = of_chosen / path.max(bidirectional);
        println!("{name}: {chosen} {share:.2} ({ratio:.2}, {low:.2} to {high:.2})");
        all += 1;
        good += u32::from(share >= 0.9);
    }
    println!("{good} of {all} within a tenth of the best");
}

fn scenes(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut all: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|e| e == "xml"))
        .collect();
    all.sort();
    all
}

fn small(program: &Path, command: &str, scene: &Path) -> Command {
    let mut small = Command::new(program);
    small
        .arg(command)
        .arg(scene)
        .args(["--width", "64", "--height", "64"]);
    small
}

/// What the pilot chooses; `None` if the scene is refused or there is one candidate only.
fn chosen(program: &Path, scene: &Path, work: &Path) -> Option<String> {
    let output = small(program, "render", scene)
        .args(["--spp", "1", "--estimator", "auto", "-o"])
        .arg(work.join("one.png"))
        .output()
        .expect("the program runs");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let line = said.lines().find_map(|l| l.split_once(": by a pilot"))?;
    Some(line.0.into())
}

/// Efficiency of path, of bidirectional, their ratio and its interval.
fn measured(program: &Path, scene: &Path, work: &Path) -> [f64; 5] {
    let json = work.join("chart.json");
    let status = small(program, "chart", scene)
        .args(["--estimators", CANDIDATES, "--budget", TIMES[0]])
        .args(["--reference-budget", TIMES[1], "-o"])
        .arg(work.join("chart.html"))
        .arg("--json")
        .arg(&json)
        .stderr(std::process::Stdio::null())
        .status()
        .expect("the program runs");
    assert!(status.success(), "no chart of {}", scene.display());
    let text = std::fs::read_to_string(json).expect("the chart's numbers");
    let chart: Value = serde_json::from_str(&text).expect("numbers");
    let of = |variant: usize, key: &str, i: usize| {
        chart["variants"][variant][key][i]
            .as_f64()
            .unwrap_or(f64::NAN)
    };
    [
        of(0, "efficiency_mse", 0),
        of(1, "efficiency_mse", 0),
        of(1, "ratio_mse", 0),
        of(1, "ratio_mse", 1),
        of(1, "ratio_mse", 2),
    ]
}
