//! `etendue chart`: what its report and its numbers hold, and what it refuses.

use super::{bytes, etendue, folder, succeed, text};
use serde_json::Value;
use std::path::Path;

/// A chart of the scene at 8 × 6 pixels, on a budget of a fraction of a second, and its numbers.
pub fn chart(at: &Path, extra: &[&str]) -> (String, Value) {
    let mut arguments = vec![
        "chart",
        "scene.xml",
        "-o",
        "report.html",
        "--json",
        "out.json",
        "--quiet",
        "--width",
        "8",
        "--height",
        "6",
    ];
    arguments.extend(extra);
    if !extra.contains(&"--budget") {
        arguments.extend(["--budget", "300ms"]);
    }
    if !extra.iter().any(|a| a.starts_with("--reference")) {
        arguments.extend(["--reference-budget", "1s"]);
    }
    succeed(at, &arguments);
    let report = text(&bytes(at, "report.html"));
    (
        report,
        serde_json::from_slice(&bytes(at, "out.json")).unwrap(),
    )
}

pub fn names(numbers: &Value) -> Vec<&str> {
    let variants = numbers["variants"].as_array().unwrap();
    variants
        .iter()
        .map(|v| v["name"].as_str().unwrap())
        .collect()
}

/// A refusal in one line that has all of `parts` in it, and nothing left behind.
fn refused(at: &Path, code: i32, extra: &[&str], parts: &[&str]) {
    let before = std::fs::read_dir(at).unwrap().count();
    let mut arguments = vec!["chart", "scene.xml", "--quiet"];
    arguments.extend(extra);
    if !extra.contains(&"--budget") {
        arguments.extend(["--budget", "200ms"]);
    }
    if !extra.contains(&"-o") {
        arguments.extend(["-o", "refused.html"]);
    }
    let output = etendue(at, &arguments);
    let error = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{extra:?}: {error}");
    assert!(
        code == 2 || error.lines().count() == 1,
        "{extra:?}: {error}"
    );
    for part in parts {
        assert!(error.contains(part), "{extra:?} lacks {part}: {error}");
    }
    assert_eq!(std::fs::read_dir(at).unwrap().count(), before, "{extra:?}");
}

#[test]
fn a_chart_is_one_file_with_all_numbers_beside_it() {
    let (_keep, at) = folder();
    let (report, numbers) = chart(
        &at,
        &["--estimators", "path,bidirectional", "--plots", "plots"],
    );
    // Self-contained: whatever is loaded is in it. The names of SVG's and XML's spaces aren't loaded.
    for part in report.split("src=\"").skip(1) {
        assert!(part.starts_with("data:image/png;base64,"), "{:.40}", part);
    }
    for loads in [
        "<script src",
        "<link",
        "url(",
        "@import",
        "<iframe",
        "<object",
    ] {
        assert!(!report.contains(loads), "the report has {loads}");
    }
    assert!(!report.replace("http://www.w3.org/", "").contains("http"));
    assert!(report.contains("<svg") && report.contains("bidirectional"));
    assert!(numbers["version"].as_u64().unwrap() >= 1);
    assert_eq!(names(&numbers), ["path", "bidirectional"]);
    for variant in numbers["variants"].as_array().unwrap() {
        for field in ["efficiency_mse", "efficiency_rel_mse", "ratio_mse"] {
            let ends = variant[field]
                .as_array()
                .unwrap_or_else(|| panic!("{field}: {variant}"));
            let [value, low, high] = [0, 1, 2].map(|i| ends[i].as_f64().unwrap());
            assert!(
                0.0 < low && low <= value && value <= high && high.is_finite(),
                "{field}"
            );
        }
        let rungs = variant["rungs"].as_array().unwrap();
        for (i, rung) in rungs.iter().enumerate() {
            assert_eq!(rung["passes"], 1u64 << i);
            let trials = rung["trials"].as_array().unwrap();
            assert_eq!(trials.len(), 4, "seeds");
            // Seeds differ, and so do errors.
            assert!(trials.iter().skip(1).any(|t| t["mse"] != trials[0]["mse"]));
        }
        // Independent samples: from 1 to 2^n samples the error falls by about that factor. It varies by less than 4 between 48 pixels of 4 seeds.
        let error = |rung: &Value| {
            let trials = rung["trials"].as_array().unwrap();
            let sum: f64 = trials.iter().map(|t| t["mse"].as_f64().unwrap()).sum();
            sum / trials.len() as f64
        };
        let clear: Vec<_> = rungs
            .iter()
            .filter(|r| r["reference_is_the_limit"] == false)
            .collect();
        let (first, last) = (clear[0], clear[clear.len() - 1]);
        assert!(clear.len() >= 4, "{} rungs", clear.len());
        let fell = error(first) / error(last);
        let expected = last["passes"].as_f64().unwrap() / first["passes"].as_f64().unwrap();
        assert!(
            (0.25..4.0).contains(&(fell / expected)),
            "{fell} for {expected}"
        );
    }
    let plots: Vec<_> = std::fs::read_dir(at.join("plots")).unwrap().collect();
    assert!(plots.len() >= 6, "{plots:?}");
    for plot in plots {
        let path = plot.unwrap().path();
        let start = std::fs::read(&path).unwrap();
        let png = path.extension().is_some_and(|e| e == "png");
        assert!(
            start.starts_with(if png { b"\x89PNG" } else { b"<svg" }),
            "{}",
            path.display()
        );
    }
}

/// Images have as many samples as take the same time by the times of the variants' budgets, which are beside them.
#[test]
fn images_are_chosen_at_equal_time() {
    let (_keep, at) = folder();
    let (report, numbers) = chart(&at, &["--estimators", "path,bidirectional,distributed"]);
    let number = |v: &Value| v.as_f64().unwrap();
    let seconds = |rung: &Value| {
        let trials = rung["trials"].as_array().unwrap();
        let all: Vec<_> = trials.iter().map(|t| number(&t["cpu_seconds"])).collect();
        all.iter().sum::<f64>() / all.len() as f64
    };
    let variants = numbers["variants"].as_array().unwrap();
    let rungs = |v: &Value| v["rungs"].as_array().unwrap().clone();
    let last = variants.iter().map(|v| seconds(rungs(v).last().unwrap()));
    let time = number(&numbers["image_cpu_seconds"]);
    let least = last.fold(f64::INFINITY, f64::min);
    assert!((time / least - 1.0).abs() < 1e-9, "{time}, not {least}");
    for variant in variants {
        let (image, rungs) = (&variant["image"], rungs(variant));
        let passes = image["passes"].as_u64().unwrap();
        // Between the last budget that took less and the next, in proportion; of whole samples.
        let below = rungs.iter().rposition(|r| seconds(r) < time);
        let of = |i: usize| {
            (
                rungs[i]["passes"].as_u64().unwrap() as f64,
                seconds(&rungs[i]),
            )
        };
        let expected = below.map_or(1.0, |i| {
            let ((n, a), (m, b)) = (of(i), of(i + 1));
            n + (m - n) * (time - a) / (b - a)
        });
        assert!(
            (expected - passes as f64).abs() <= 0.5 + 1e-6 * expected,
            "{expected}: {variant}"
        );
        assert!(number(&image["mse"]) > 0.0 && number(&image["cpu_seconds"]) > 0.0);
        let name = variant["name"].as_str().unwrap();
        let caption = format!("{name}: {passes} samples per pixel in ");
        assert!(report.contains(&caption), "the report lacks {caption}");
    }
}

/// Each variant says what light it leaves out, as `inspect` does, and so does the reference.
#[test]
fn light_paths_that_are_left_out_are_named() {
    let (_keep, at) = folder();
    let estimators = "path,light,bidirectional";
    let lines = |v: &Value| -> Vec<String> {
        let all = v["unreachable"].as_array().unwrap().iter();
        all.map(|line| line.as_str().unwrap().to_owned()).collect()
    };
    let (report, numbers) = chart(&at, &["--estimators", estimators, "--budget", "50ms"]);
    for variant in numbers["variants"].as_array().unwrap() {
        assert!(lines(variant).is_empty(), "{variant}");
    }
    assert!(!report.contains("can't be made"));
    let glass = r#"<shape type="sphere"><point name="center" x="0" y="0.5" z="0"/><float name="radius" value="0.3"/><bsdf type="dielectric"/></shape>
        <emitter type="point"><point name="position" x="1" y="2" z="0"/></emitter></scene>"#;
    let scene = text(&bytes(&at, "scene.xml")).replace("</scene>", glass);
    std::fs::write(at.join("scene.xml"), scene).unwrap();
    let (report, numbers) = chart(&at, &["--estimators", estimators, "--budget", "50ms"]);
    let inspected = succeed(&at, &["inspect", "scene.xml"]);
    for (i, part) in [
        "(their caustics",
        "sensor sees in a mirror",
        "caustics seen",
    ]
    .into_iter()
    .enumerate()
    {
        let all = lines(&numbers["variants"][i]);
        assert!(all.len() == 1 && all[0].contains(part), "{part}: {all:?}");
        assert!(inspected.contains(&all[0]), "{inspected} lacks {}", all[0]);
        assert!(report.contains(&all[0]), "the report lacks {}", all[0]);
    }
    assert!(report.contains("can't be made by bidirectional, the reference: "));
    assert_eq!(lines(&numbers["reference"]), lines(&numbers["variants"][2]));
}

#[test]
fn sweeps_multiply_and_chains_have_no_tail() {
    let (_keep, at) = folder();
    let (_, numbers) = chart(
        &at,
        &[
            "--sweep",
            "mis=balance,power",
            "--sweep",
            "precision=single,double",
        ],
    );
    let all = names(&numbers);
    assert_eq!(all.len(), 4, "{all:?}");
    for value in ["balance", "power", "single", "double"] {
        assert_eq!(
            all.iter().filter(|n| n.contains(value)).count(),
            2,
            "{all:?}"
        );
    }
    let (_, numbers) = chart(&at, &["--estimators", "path,metropolis", "--seeds", "2"]);
    assert!(numbers["variants"][0]["tail"]["samples"].as_u64().unwrap() > 1000);
    assert!(numbers["variants"][1]["tail"].is_null());
}

#[test]
fn a_reference_that_is_the_limit_is_said_to_be() {
    let (_keep, at) = folder();
    // One that is worse than what is measured against it.
    let (report, numbers) = chart(&at, &["--reference-budget", "2ms"]);
    assert!(report.contains("reference is the limit"));
    let rungs = numbers["variants"][0]["rungs"].as_array().unwrap();
    assert_eq!(rungs[rungs.len() - 1]["reference_is_the_limit"], true);
    // One whose noise nobody knows.
    succeed(
        &at,
        &[
            "render",
            "scene.xml",
            "-o",
            "ref.exr",
            "--width",
            "8",
            "--height",
            "6",
            "--spp",
            "4096",
            "--quiet",
        ],
    );
    let (report, numbers) = chart(&at, &["--reference", "ref.exr"]);
    assert!(report.contains("noise is not known"));
    assert!(numbers["reference"]["mse"].is_null());
}

#[test]
fn what_an_estimator_refuses_stands_in_the_report() {
    let (_keep, at) = folder();
    let sky =
        "<emitter type=\"constant\"><rgb name=\"radiance\" value=\"1, 1, 1\"/></emitter></scene>";
    let scene = text(&bytes(&at, "scene.xml")).replace("</scene>", sky);
    std::fs::write(at.join("scene.xml"), scene).unwrap();
    let (report, numbers) = chart(&at, &["--estimators", "path,quadrature"]);
    assert!(numbers["variants"][0]["refused"].is_null());
    let reason = numbers["variants"][1]["refused"].as_str().unwrap();
    assert!(reason.contains("choose quadrature+path") && report.contains(reason));
    refused(
        &at,
        1,
        &["--estimators", "quadrature", "--reference-budget", "10ms"],
        &["scene.xml", "quadrature"],
    );
}

#[test]
fn bad_charts_are_refused_before_anything_is_rendered() {
    let (_keep, at) = folder();
    refused(
        &at,
        1,
        &["--sweep", "speed=1,2"],
        &["speed", "expected one of", "mis"],
    );
    refused(&at, 1, &["--sweep", "mis=balance,best"], &["best"]);
    refused(
        &at,
        1,
        &["--sweep", "shift=perhaps"],
        &["shift", "true or false"],
    );
    refused(&at, 1, &["--estimators", "path,luck"], &["luck"]);
    refused(&at, 2, &["--sweep", "mis"], &["KEY=V1,V2"]);
    refused(&at, 2, &["--budget", "soon"], &["30s"]);
    refused(
        &at,
        1,
        &["-o", "no/such/report.html"],
        &["no/such/report.html"],
    );
    refused(&at, 1, &["--reference", "missing.exr"], &["missing.exr"]);
    succeed(
        &at,
        &[
            "render",
            "scene.xml",
            "-o",
            "small.exr",
            "--width",
            "5",
            "--height",
            "5",
            "--spp",
            "1",
            "--quiet",
        ],
    );
    refused(&at, 1, &["--reference", "small.exr"], &["5 × 5", "16 × 12"]);
}
