//! The program as a user meets it: its commands, its files, its refusals.

mod auto;
mod chart;
mod faults;
mod figures;
mod refusals;
mod signals;
mod sweeps;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Runs the program in `folder`.
fn etendue(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_etendue"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Runs the program, which must succeed, and returns its standard output.
fn succeed(folder: &Path, arguments: &[&str]) -> String {
    let output = etendue(folder, arguments);
    assert!(
        output.status.success(),
        "{arguments:?}: {}",
        text(&output.stderr)
    );
    text(&output.stdout)
}

fn json(folder: &Path, arguments: &[&str]) -> serde_json::Value {
    let out = succeed(folder, arguments);
    serde_json::from_str(out.lines().last().unwrap()).unwrap_or_else(|e| panic!("{e}: {out}"))
}

/// A floor under a lamp, 16 × 12 pixels; `$grey` is the floor's reflectance.
const SCENE: &str = r#"<scene version="3.0.0">
  <default name="grey" value="0.5"/>
  <integrator type="path"><integer name="max_depth" value="4"/></integrator>
  <sensor type="perspective">
    <float name="fov" value="50"/>
    <transform name="to_world"><lookat origin="0, 2, 5" target="0, 0.5, 0" up="0, 1, 0"/></transform>
    <sampler type="independent"><integer name="sample_count" value="4"/></sampler>
    <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="12"/><rfilter type="box"/></film>
  </sensor>
  <bsdf type="twosided" id="floor"><bsdf type="diffuse"><rgb name="reflectance" value="$grey"/></bsdf></bsdf>
  <shape type="rectangle">
    <transform name="to_world"><rotate x="1" angle="-90"/><scale value="2"/></transform>
    <ref id="floor"/>
  </shape>
  <shape type="sphere">
    <point name="center" x="0" y="1.5" z="0"/><float name="radius" value="0.4"/>
    <emitter type="area"><rgb name="radiance" value="4, 3, 2"/></emitter>
  </shape>
</scene>
"#;

/// A folder with the scene in it.
fn folder() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_owned();
    std::fs::write(path.join("scene.xml"), SCENE).unwrap();
    (folder, path)
}

fn bytes(path: &Path, file: &str) -> Vec<u8> {
    std::fs::read(path.join(file)).unwrap_or_else(|e| panic!("{file}: {e}"))
}

#[test]
fn help_names_every_flag() {
    let (_keep, at) = folder();
    let help = succeed(&at, &["--help"]);
    for part in [
        "render",
        "compile",
        "inspect",
        "bake",
        "compare",
        "chart",
        "figures",
        "Exit codes",
        "130",
    ] {
        assert!(help.contains(part), "--help lacks {part}:\n{help}");
    }
    let flags: [(&str, &[&str]); 7] = [
        (
            "render",
            &[
                "--output",
                "--estimator",
                "--mis",
                "--spp",
                "--time",
                "--seed",
                "--threads",
                "--max-depth",
                "-D",
                "--width",
                "--height",
                "--exposure",
                "--tonemap",
                "--json",
                "--quiet",
                "--branching",
                "--light-samples",
                "--quadrature",
                "--steps",
                "--shift",
            ],
        ),
        (
            "bake",
            &[
                "--shape",
                "--output",
                "--width",
                "--height",
                "--spp",
                "--dilate",
                "--estimator",
                "--threads",
                "-D",
            ],
        ),
        ("compile", &["--output", "-D"]),
        ("inspect", &["-D"]),
        ("compare", &["--json", "--output"]),
        (
            "chart",
            &[
                "--estimators",
                "--sweep",
                "--budget",
                "--reference",
                "--reference-budget",
                "--seeds",
                "--output",
                "--json",
                "--plots",
                "--precision",
                "--fresnel",
                "--tracking",
            ],
        ),
        (
            "figures",
            &["--output", "--keep", "--spp-scale", "--scale", "--threads"],
        ),
    ];
    for (command, flags) in flags {
        let help = succeed(&at, &[command, "--help"]);
        for flag in flags {
            assert!(
                help.contains(flag),
                "{command} --help lacks {flag}:\n{help}"
            );
        }
    }
}

#[test]
fn renders_every_format_and_reports() {
    let (_keep, at) = folder();
    let report = json(
        &at,
        &[
            "render",
            "scene.xml",
            "-o",
            "a.exr",
            "-o",
            "a.hdr",
            "-o",
            "a.png",
            "--json",
            "--spp",
            "8",
        ],
    );
    assert_eq!(
        (
            &report["width"],
            &report["height"],
            &report["passes"],
            &report["samples"]
        ),
        (&16.into(), &12.into(), &8.into(), &1536.into())
    );
    for field in ["seconds", "rays", "rays_per_second"] {
        assert!(report[field].as_f64().unwrap() > 0.0, "{field}");
    }
    assert_eq!(report["mean_rgb"].as_array().unwrap().len(), 3);
    for field in [
        "walks_cut_by_step_limit",
        "rejected_values",
        "film_saturated",
        "film_invalid",
    ] {
        assert_eq!(report["diagnostics"][field], 0, "{field}");
    }
    assert_eq!(&bytes(&at, "a.png")[..4], b"\x89PNG");
    assert_eq!(&bytes(&at, "a.hdr")[..2], b"#?");
    // HDR keeps eight bits of mantissa.
    let distance = json(&at, &["compare", "a.hdr", "a.exr", "--json"]);
    assert!(distance["rel_mse"].as_f64().unwrap() < 1e-4, "{distance}");
}

#[test]
fn the_same_bits_on_any_number_of_threads_and_from_a_blob() {
    let (_keep, at) = folder();
    // Many tiles, those at the right and the bottom smaller than the others.
    let film = SCENE
        .replace("value=\"16\"", "value=\"90\"")
        .replace("value=\"12\"", "value=\"70\"");
    std::fs::write(at.join("scene.xml"), film).unwrap();
    succeed(&at, &["compile", "scene.xml", "-o", "scene.etd"]);
    for estimator in ["path", "light", "bidirectional"] {
        let render = |scene: &str, out: &str, threads: &str| {
            succeed(
                &at,
                &[
                    "render",
                    scene,
                    "-o",
                    out,
                    "--spp",
                    "5",
                    "--max-depth",
                    "4",
                    "--estimator",
                    estimator,
                    "--threads",
                    threads,
                    "--quiet",
                ],
            );
            bytes(&at, out)
        };
        let first = render("scene.xml", "1.exr", "1");
        assert!(first == render("scene.xml", "2.exr", "2"), "{estimator}");
        assert!(first == render("scene.xml", "3.exr", "3"), "{estimator}");
        assert!(
            first == render("scene.etd", "4.exr", "2"),
            "{estimator} from the blob"
        );
    }
}

#[test]
fn time_ends_with_a_whole_pass() {
    let (_keep, at) = folder();
    let report = json(
        &at,
        &[
            "render",
            "scene.xml",
            "-o",
            "time.exr",
            "--time",
            "200ms",
            "--json",
        ],
    );
    let passes = report["passes"].as_u64().unwrap();
    assert!(passes > 1);
    // A pilot that ends by time may choose another estimator than one that doesn't.
    let chosen = report["pilot"]["chosen"].as_str().unwrap();
    let (passes, with) = (passes.to_string(), ["--estimator", chosen, "--quiet"]);
    let again = ["render", "scene.xml", "-o", "spp.exr", "--spp", &passes];
    succeed(&at, &[&again[..], &with].concat());
    assert!(bytes(&at, "time.exr") == bytes(&at, "spp.exr"));
}

/// Until the error is small enough, or the samples are spent; chains can't.
#[test]
fn errors_are_asked_for() {
    let (_keep, at) = folder();
    let with = |error: &str, spp: &str| {
        let more = ["--error", error, "--spp", spp, "--json"];
        let arguments = ["render", "scene.xml", "-o", "x.exr"];
        json(&at, &[&arguments[..], &more].concat())["accuracy"].clone()
    };
    let met = with("20%", "65536");
    assert_eq!(met["met"], true, "{met}");
    assert_eq!(met["confidence"], 0.95, "{met}");
    assert!(met["relative_error"].as_f64().unwrap() < 0.2, "{met}");
    let spent = with("0.00001", "20");
    assert_eq!(spent["met"], false, "{spent}");
    let arguments = ["render", "scene.xml", "-o", "y.exr", "--error", "0.1"];
    let refused = etendue(
        &at,
        &[&arguments[..], &["--estimator", "metropolis"]].concat(),
    );
    assert!(!refused.status.success());
    assert!(!at.join("y.exr").exists());
}

#[test]
fn values_sizes_and_depths_are_taken() {
    let (_keep, at) = folder();
    let mean = |extra: &[&str]| {
        let mut arguments = vec![
            "render",
            "scene.xml",
            "-o",
            "x.exr",
            "--json",
            "--spp",
            "64",
        ];
        arguments.extend(extra);
        let report = json(&at, &arguments);
        (
            report["mean_rgb"][0].as_f64().unwrap(),
            report["width"].as_u64().unwrap(),
            report["height"].as_u64().unwrap(),
        )
    };
    let (grey, ..) = mean(&[]);
    let (black, ..) = mean(&["-D", "grey=0"]);
    let (seen, ..) = mean(&["--max-depth", "1"]);
    assert!(
        grey > 1.1 * black,
        "the floor's reflectance isn't taken: {grey} against {black}"
    );
    assert!(
        (black - seen).abs() < 0.02 * seen,
        "depth 1 shows the lamp alone: {black} against {seen}"
    );
    assert_eq!(mean(&["--width", "32"]).1, 32);
    assert_eq!(mean(&["--width", "32"]).2, 24);
    assert_eq!(mean(&["--width", "10", "--height", "20"]).2, 20);
}

#[test]
fn one_pixel_is_an_image() {
    let (_keep, at) = folder();
    let report = json(
        &at,
        &[
            "render",
            "scene.xml",
            "-o",
            "x.png",
            "--width",
            "1",
            "--height",
            "1",
            "--json",
        ],
    );
    // The scene's own sample count.
    assert_eq!(
        (&report["samples"], &report["passes"]),
        (&4.into(), &4.into())
    );
    assert!(at.join("x.png").exists());
}

/// Writes an image whose pixels are all `value`.
fn flat(path: PathBuf, size: [usize; 2], value: [f32; 3]) {
    exr::prelude::write_rgb_file(path, size[0], size[1], |_, _| {
        (value[0], value[1], value[2])
    })
    .unwrap();
}

#[test]
fn compares_images() {
    let (_keep, at) = folder();
    succeed(&at, &["render", "scene.xml", "-o", "x.exr", "--quiet"]);
    let same = json(&at, &["compare", "x.exr", "x.exr", "--json"]);
    for field in ["mse", "rel_mse", "relative_bias", "largest_difference"] {
        assert_eq!(same[field], 0.0, "{field}");
    }
    assert_eq!(same["bias"], serde_json::json!([0.0, 0.0, 0.0]));

    flat(at.join("a.exr"), [5, 3], [1.5, 1.0, 0.0]);
    flat(at.join("b.exr"), [5, 3], [1.0, 1.0, 1.0]);
    let other = json(&at, &["compare", "a.exr", "b.exr", "--json"]);
    // (¼ + 0 + 1)/3, and the same over b² + 0.01·m² = 1.01.
    for (field, value) in [
        ("mse", 1.25 / 3.0),
        ("rel_mse", 1.25 / 3.03),
        ("relative_bias", -0.5 / 3.0),
        ("largest_difference", 1.0),
        ("difference_scale", 0.5 / 3.0),
    ] {
        let found = other[field].as_f64().unwrap();
        assert!(
            (found - value).abs() < 1e-12,
            "{field}: {found}, not {value}"
        );
    }
    let bias: Vec<f64> = serde_json::from_value(other["bias"].clone()).unwrap();
    for (found, value) in bias.iter().zip([0.5, 0.0, -1.0]) {
        assert!((found - value).abs() < 1e-12, "{bias:?}");
    }

    assert!(succeed(&at, &["compare", "a.exr", "b.exr", "-o", "d.png"]).contains("relMSE"));
    let difference = image::open(at.join("d.png")).unwrap().into_rgb8();
    // B is brighter, everywhere as much as anywhere: full blue.
    assert!(difference.pixels().all(|p| p.0 == [0, 0, 255]));
}

#[test]
fn a_png_is_compared_linear_and_takes_the_tone_curve() {
    let (_keep, at) = folder();
    flat(at.join("b.exr"), [4, 4], [0.214_041_14; 3]);
    let grey = image::RgbImage::from_pixel(4, 4, image::Rgb([128; 3]));
    grey.save(at.join("a.png")).unwrap();
    let d = json(&at, &["compare", "a.png", "b.exr", "--json"]);
    assert!(d["largest_difference"].as_f64().unwrap() < 2e-3, "{d}");

    // The lamp fills the picture: radiance 4, 3, 2.
    let lamp = SCENE.replace("value=\"0.4\"", "value=\"3.2\"");
    std::fs::write(at.join("lamp.xml"), lamp).unwrap();
    let pixel = |extra: &[&str]| {
        let mut arguments = vec!["render", "lamp.xml", "-o", "x.png", "--max-depth", "1"];
        arguments.extend(["--quiet", "--spp", "1"]);
        arguments.extend(extra);
        succeed(&at, &arguments);
        image::open(at.join("x.png"))
            .unwrap()
            .into_rgb8()
            .get_pixel(8, 6)
            .0
    };
    assert_eq!(pixel(&[]), [255; 3]);
    // 1, 3/4, 1/2 and 4/5, 3/4, 2/3, sRGB-coded.
    assert_eq!(pixel(&["--exposure", "-2"]), [255, 225, 188]);
    assert_eq!(pixel(&["--tonemap", "reinhard"]), [231, 225, 213]);
    // 0.1·(x + 1), and nothing after it.
    assert_eq!(pixel(&["--tonemap", "gamma:0.1,1,1"]), [128, 102, 77]);
}

#[test]
fn inspects_scenes_and_blobs() {
    let (_keep, at) = folder();
    succeed(&at, &["compile", "scene.xml", "-o", "scene.etd"]);
    for scene in ["scene.xml", "scene.etd"] {
        let out = succeed(&at, &["inspect", scene]);
        for part in [
            "2 triangles, 1 spheres",
            "packets",
            "bytes",
            "SAH",
            "left out",
            "no free flight",
            "paths carry RGB",
        ] {
            assert!(out.contains(part), "{scene}: no {part:?} in\n{out}");
        }
    }
}

/// A scene whose floor has a name.
fn with_floor(at: &Path) {
    let named = SCENE.replacen("type=\"rectangle\"", "type=\"rectangle\" id=\"ground\"", 1);
    std::fs::write(at.join("named.xml"), named).unwrap();
}

#[test]
fn bakes_light_maps_with_the_same_bits_on_any_threads() {
    let (_keep, at) = folder();
    with_floor(&at);
    let bake = |out: &str, more: &[&str]| {
        let flags = [
            "bake",
            "named.xml",
            "--shape",
            "ground",
            "-o",
            out,
            "--width",
            "8",
        ];
        let size = ["--height", "6", "--spp", "3", "--json"];
        json(&at, &[&flags, &size[..], more].concat())
    };
    let report = bake("a.exr", &["--threads", "1"]);
    assert_eq!(
        (&report["width"], &report["height"], &report["covered"]),
        (&8.into(), &6.into(), &48.into())
    );
    bake("b.exr", &["--threads", "3"]);
    assert_eq!(bytes(&at, "a.exr"), bytes(&at, "b.exr"));
    for estimator in [
        "light",
        "bidirectional",
        "distributed",
        "quadrature",
        "quadrature+path",
    ] {
        bake("c.exr", &["--estimator", estimator]);
    }
}

#[test]
fn every_estimator_renders() {
    let (_keep, at) = folder();
    for flags in [
        &[
            "--estimator",
            "distributed",
            "--branching",
            "3,2",
            "--light-samples",
            "2",
        ][..],
        &["--estimator", "quadrature", "--quadrature", "3"],
        &["--estimator", "quadrature+path", "--shift", "--steps", "9"],
    ] {
        let render = ["render", "scene.xml", "-o", "x.exr", "--spp", "2", "--json"];
        let report = json(&at, &[&render, flags].concat());
        assert!(report["mean_rgb"][0].as_f64().unwrap() > 0.0, "{flags:?}");
    }
}

#[test]
fn flags_replace_what_the_file_says_of_each_dielectric_and_grid() {
    let (_keep, at) = folder();
    let glass = |schlick: &str| {
        let model = format!("<bsdf type=\"dielectric\">{schlick}</bsdf>");
        let ball = "<shape type=\"sphere\"><point name=\"center\" x=\"0.3\" y=\"0.5\" z=\"1\"/><float name=\"radius\" value=\"0.5\"/>";
        SCENE.replace("</scene>", &format!("{ball}{model}</shape></scene>"))
    };
    std::fs::write(at.join("exact.xml"), glass("")).unwrap();
    let schlick = glass("<boolean name=\"schlick\" value=\"true\"/>");
    std::fs::write(at.join("schlick.xml"), schlick).unwrap();
    let render = |scene: &str, flags: &[&str]| {
        let mut arguments = vec![
            "render", scene, "-o", "x.exr", "--spp", "64", "--width", "24", "--height", "18",
            "--quiet",
        ];
        arguments.extend(flags);
        succeed(&at, &arguments);
        bytes(&at, "x.exr")
    };
    let (exact, schlick) = (render("exact.xml", &[]), render("schlick.xml", &[]));
    assert!(exact != schlick);
    assert!(render("exact.xml", &["--fresnel", "schlick"]) == schlick);
    assert!(render("schlick.xml", &["--fresnel", "exact"]) == exact);

    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/scenes");
    let smoke = data.join("smoke.xml");
    let smoke = smoke.to_str().unwrap();
    let [plain, woodcock, regular, residual] = [
        render(smoke, &[]),
        render(smoke, &["--tracking", "woodcock"]),
        render(smoke, &["--tracking", "regular"]),
        render(smoke, &["--tracking", "residual"]),
    ];
    assert!(plain == woodcock && regular != woodcock && residual != woodcock);
    succeed(&at, &["compile", "scene.xml", "-o", "scene.etd"]);
    let output = etendue(
        &at,
        &["render", "scene.etd", "-o", "y.exr", "--fresnel", "schlick"],
    );
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("--fresnel"));
}
