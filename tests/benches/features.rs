//! What each feature costs, in instructions per sample: `cargo bench --bench features`. Needs valgrind; half an hour, because the kernel is built twice for each feature.
//!
//! Counts are differences of two numbers of samples, so that opening a scene isn't in them, and the same each time.
//!
//! Budget: a feature that a scene doesn't need costs it 1 % at most. Where one costs more, the bench fails. What the compiler inlines changes with anything, by some
//! percent either way and in code that a feature has nothing to do with. So each price is found twice, by code in as many units as the workspace's profile says and by code
//! in one, and the lesser counts.

use etendue::Scene;
use etendue::blob::format::needs;
use etendue_host::description::Carry;
use etendue_host::scene::{Changes, prepare};
use etendue_tests::place::root;
use std::collections::HashMap;
use std::path::PathBuf;
use std::process::{Command, ExitCode};

/// Columns of the images.
const SIZE: u32 = 16;
const FEW: u64 = 1;
const MANY: u64 = 5;
/// Percent.
const BUDGET: f64 = 1.0;

/// Estimators, and the features that each rests on.
const ESTIMATORS: [(&str, &[&str]); 3] = [
    ("path", &[]),
    ("light", &["light"]),
    ("bidirectional", &["light", "bidirectional"]),
];

/// Cargo features, and what is left out with each because it rests on it.
const FEATURES: [(&str, &[&str]); 12] = [
    ("light", &["light", "bidirectional", "metropolis"]),
    ("bidirectional", &["bidirectional", "metropolis"]),
    ("distributed", &["distributed"]),
    ("quadrature", &["quadrature"]),
    ("textures", &["textures"]),
    ("environment", &["environment"]),
    ("panorama", &["panorama"]),
    ("glossy", &["glossy", "spectral"]),
    ("media", &["media", "spectral"]),
    ("spectral", &["spectral"]),
    ("sobol", &["sobol"]),
    ("metropolis", &["metropolis"]),
];

/// A scene of `tests/data/scenes` with some of its text replaced, and a way to render it.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Variant {
    scene: &'static str,
    text: &'static [(&'static str, &'static str)],
    wavelengths: bool,
    sobol: bool,
}

const PLAIN: Variant = Variant {
    scene: "cornell_diffuse",
    text: &[],
    wavelengths: false,
    sobol: false,
};
const FOG: Variant = Variant {
    scene: "fog_cornell",
    ..PLAIN
};
const WAVELENGTHS: Variant = Variant {
    wavelengths: true,
    ..PLAIN
};

/// The end of the scene's last object, the large box: what is replaced so that the box is of something else.
const LARGE: &str = r#"<ref id="white"/>
  </shape>
</scene>"#;
const END: &str = "</scene>";

const GLOSSY: Variant = Variant {
    text: &[(
        LARGE,
        r#"<bsdf type="twosided"><bsdf type="roughconductor"><string name="material" value="none"/><string name="distribution" value="ggx"/><float name="alpha" value="0.15"/></bsdf></bsdf></shape></scene>"#,
    )],
    ..PLAIN
};
const GLOSSY_FOG: Variant = Variant {
    text: GLOSSY.text,
    ..FOG
};
const GLASS: Variant = Variant {
    text: &[(
        LARGE,
        r#"<bsdf type="dielectric"><float name="int_ior" value="1.5"/></bsdf></shape></scene>"#,
    )],
    ..PLAIN
};

/// What there is, what of [`needs`] comes with it, the scene with it, and the one without.
const HAVING: [(&str, u32, Variant, Variant); 19] = [
    (
        "mirror",
        needs::DIRAC,
        written(&[(
            LARGE,
            r#"<bsdf type="conductor"><string name="material" value="none"/></bsdf></shape></scene>"#,
        )]),
        PLAIN,
    ),
    ("glass", needs::DIRAC | needs::TRANSMISSION, GLASS, PLAIN),
    (
        "glass of three indices",
        needs::DISPERSION,
        written(&[(
            LARGE,
            r#"<bsdf type="dielectric"><string name="dispersion" value="bk7"/></bsdf></shape></scene>"#,
        )]),
        GLASS,
    ),
    (
        "diffuse transmission",
        needs::TRANSMISSION,
        written(&[(
            LARGE,
            r#"<bsdf type="diffusetransmitter"><rgb name="reflectance" value="0, 0, 0"/><rgb name="transmittance" value="0.7, 0.7, 0.7"/></bsdf></shape></scene>"#,
        )]),
        PLAIN,
    ),
    ("glossy", needs::GLOSSY, GLOSSY, PLAIN),
    (
        "mask",
        needs::MASKS,
        written(&[(
            LARGE,
            r#"<bsdf type="mask"><float name="opacity" value="0.5"/><ref id="white"/></bsdf></shape></scene>"#,
        )]),
        PLAIN,
    ),
    (
        "null boundary",
        needs::NULL,
        written(&[(
            END,
            r#"<shape type="sphere"><point name="center" x="186" y="400" z="169"/><float name="radius" value="60"/><bsdf type="null"/></shape></scene>"#,
        )]),
        PLAIN,
    ),
    (
        "sphere",
        needs::SPHERES,
        written(&[(
            END,
            r#"<shape type="sphere"><point name="center" x="186" y="400" z="169"/><float name="radius" value="60"/><ref id="white"/></shape></scene>"#,
        )]),
        PLAIN,
    ),
    (
        "interpolated normals",
        needs::SMOOTH_NORMALS,
        written(&[(
            r#"large.obj"/>
    <boolean name="face_normals" value="true"/>"#,
            r#"large.obj"/>"#,
        )]),
        PLAIN,
    ),
    (
        "textures",
        needs::TEXTURES,
        written(&[(
            r#"<rgb name="reflectance" value="0.725, 0.71, 0.68"/>"#,
            r#"<texture type="checkerboard" name="reflectance"><rgb name="color0" value="0.725, 0.71, 0.68"/><rgb name="color1" value="0.725, 0.71, 0.68"/></texture>"#,
        )]),
        PLAIN,
    ),
    (
        "constant background",
        needs::DISTANT,
        written(&[(END, r#"<emitter type="constant"/></scene>"#)]),
        PLAIN,
    ),
    (
        "environment",
        needs::DISTANT,
        written(&[(
            END,
            r#"<emitter type="envmap"><string name="filename" value="../../../host/scenes/thesis/studio.hdr"/></emitter></scene>"#,
        )]),
        PLAIN,
    ),
    (
        "panorama",
        0,
        written(&[
            (
                r#"<sensor type="perspective">
    <string name="fov_axis" value="x"/>
    <float name="fov" value="39.3077"/>
    <float name="near_clip" value="0.01"/>
    <float name="far_clip" value="10000"/>"#,
                r#"<sensor type="panorama">"#,
            ),
            ("-800", "279"),
            ("-799", "280"),
        ]),
        PLAIN,
    ),
    ("fog", needs::MEDIA, FOG, PLAIN),
    (
        "fog that glows",
        needs::GLOWING,
        Variant {
            text: &[(
                "<phase",
                r#"<rgb name="emission" value="0.001, 0.001, 0.001"/><phase"#,
            )],
            ..FOG
        },
        FOG,
    ),
    (
        "point light in fog",
        needs::SMALL_LIGHTS,
        Variant {
            text: &[(
                END,
                r#"<emitter type="point"><point name="position" x="278" y="400" z="150"/><rgb name="intensity" value="60000, 60000, 60000"/><ref name="medium" id="fog"/></emitter></scene>"#,
            )],
            ..FOG
        },
        FOG,
    ),
    (
        "smoke",
        needs::GRIDS,
        written(&[(
            END,
            r#"<medium type="heterogeneous" id="smoke">
  <volume name="sigma_t" type="gridvolume">
    <string name="filename" value="volumes/smoke32.vol"/>
    <transform name="to_world"><scale x="400" y="190" z="400"/><translate x="80" y="345" z="80"/></transform>
  </volume>
  <rgb name="albedo" value="0.8, 0.8, 0.8"/><float name="scale" value="0.1"/><phase type="isotropic"/>
</medium>
<shape type="cube">
  <transform name="to_world"><scale x="200" y="95" z="200"/><translate x="280" y="440" z="280"/></transform>
  <bsdf type="null"/><ref name="interior" id="smoke"/>
</shape></scene>"#,
        )]),
        PLAIN,
    ),
    ("wavelengths", needs::SPECTRAL, WAVELENGTHS, PLAIN),
    (
        "Sobol' points",
        0,
        Variant {
            sobol: true,
            ..PLAIN
        },
        PLAIN,
    ),
];

/// Scenes for what isn't needed, the features that they need: one for each instance of the estimators.
const LACKING: [(&str, &[&str], Variant); 5] = [
    ("diffuse", &[], PLAIN),
    ("glossy", &["glossy"], GLOSSY),
    ("fog", &["media"], FOG),
    ("glossy things in fog", &["glossy", "media"], GLOSSY_FOG),
    ("wavelengths", &["glossy", "media", "spectral"], WAVELENGTHS),
];

const fn written(text: &'static [(&'static str, &'static str)]) -> Variant {
    Variant { text, ..PLAIN }
}

fn main() -> ExitCode {
    if Command::new("valgrind").arg("--version").output().is_err() {
        println!("valgrind is not installed: nothing is counted");
        return ExitCode::FAILURE;
    }
    let mut bench = Bench {
        root: root(),
        work: tempfile::tempdir().expect("a temporary folder"),
        blobs: HashMap::new(),
        counts: HashMap::new(),
    };
    for (what, bits, with, without) in HAVING {
        let (more, less) = (bench.needs(with), bench.needs(without));
        assert!(more & bits == bits, "{what} isn't needed: {more:#x}");
        assert!(bits == 0 || less & bits != bits, "{what}: both need it");
    }
    let everything = bench.build(&[]);
    let [usual, _] = &everything;

    println!("instructions per sample of what a scene needs, and of the scene without");
    head();
    for (what, _, with, without) in HAVING {
        for (estimator, _) in ESTIMATORS {
            let with = bench.count(usual, with, estimator);
            let without = bench.count(usual, without, estimator);
            row(what, estimator, with, without);
        }
    }
    let step = bench.count(usual, PLAIN, "metropolis");
    let sample = bench.count(usual, PLAIN, "bidirectional");
    row("step of a chain", "metropolis", step, sample);

    println!(
        "\ninstructions per sample of a kernel with what a scene doesn't need, and of one without"
    );
    head();
    let mut most = 0.0f64;
    for (feature, out) in FEATURES {
        let less = bench.build(out);
        for (scene, needed, variant) in LACKING {
            for (estimator, own) in ESTIMATORS {
                if out.iter().any(|f| needed.contains(f) || own.contains(f)) {
                    continue;
                }
                let what = format!("{feature}: {scene}");
                let prices = [0, 1].map(|i| {
                    let with = bench.count(&everything[i], variant, estimator);
                    let without = bench.count(&less[i], variant, estimator);
                    row(
                        if i == 0 { &what } else { "  in one unit" },
                        estimator,
                        with,
                        without,
                    )
                });
                let price = prices[0].min(prices[1]);
                if price > BUDGET {
                    println!("  more than {BUDGET} %");
                }
                most = most.max(price);
            }
        }
    }
    println!("\nat most {most:.2} % for what a scene doesn't need, expected at most {BUDGET} %");
    if most > BUDGET {
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}

fn head() {
    println!(
        "{:<24} {:<14} {:>10} {:>10} {:>9}",
        "feature", "estimator", "with", "without", "price"
    );
}

/// Prints a line, and returns the price in percent.
fn row(what: &str, estimator: &str, with: f64, without: f64) -> f64 {
    let price = 100.0 * (with / without - 1.0);
    println!("{what:<24} {estimator:<14} {with:>10.0} {without:>10.0} {price:>7.2} %");
    price
}

struct Bench {
    root: PathBuf,
    work: tempfile::TempDir,
    /// The file, and what it needs.
    blobs: HashMap<Variant, (PathBuf, u32)>,
    /// By program.
    counts: HashMap<(PathBuf, Variant, String), f64>,
}

impl Bench {
    /// The kernel's example `mean` without these features: in as many units as usual, and in one.
    fn build(&self, out: &[&str]) -> [PathBuf; 2] {
        let kept = FEATURES.map(|(feature, _)| feature);
        let kept: Vec<&str> = kept.into_iter().filter(|f| !out.contains(f)).collect();
        ["usual", "one"].map(|units| {
            let target = self.root.join("target/features").join(units);
            let one = (units == "one").then_some(("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "1"));
            let status = Command::new(env!("CARGO"))
                .current_dir(&self.root)
                .args(["build", "--quiet", "--release", "-p", "etendue"])
                .args(["--example", "mean", "--no-default-features"])
                .args(["--features", &kept.join(",")])
                .arg("--target-dir")
                .arg(&target)
                .envs(one)
                .status()
                .expect("cargo runs");
            assert!(status.success(), "the kernel isn't built with {kept:?}");
            let name = format!("mean-{units}-{}", kept.join("-"));
            let program = self.work.path().join(name);
            std::fs::copy(target.join("release/examples/mean"), &program)
                .expect("the example is there");
            program
        })
    }

    /// A compiled scene, and what it needs.
    fn blob(&mut self, variant: Variant) -> (PathBuf, u32) {
        let number = self.blobs.len();
        if let Some(done) = self.blobs.get(&variant) {
            return done.clone();
        }
        let folder = self.root.join("tests/data/scenes");
        let file = folder.join(format!("{}.xml", variant.scene));
        let mut text = std::fs::read_to_string(&file).expect("the scene is there");
        for (from, to) in variant.text {
            assert!(text.contains(from), "{} lacks {from}", variant.scene);
            text = text.replace(from, to);
        }
        let files = r#"<string name="filename" value=""#;
        let text = text.replace(files, &format!("{files}{}/", folder.display()));
        let changed = self.work.path().join(format!("{number}.xml"));
        std::fs::write(&changed, text).expect("the scene is written");
        let changes = Changes {
            width: Some(SIZE),
            carry: if variant.wavelengths {
                Carry::Wavelengths
            } else {
                Carry::Rgb
            },
            ..Changes::default()
        };
        let prepared = prepare(&changed, &[], changes).unwrap_or_else(|e| panic!("{e}"));
        let path = changed.with_extension("etd");
        std::fs::write(&path, prepared.blob.bytes()).expect("the blob is written");
        let scene = Scene::open(prepared.blob.bytes()).expect("the compiler's blobs are scenes");
        let done = (path, scene.needs());
        self.blobs.insert(variant, done.clone());
        done
    }

    fn needs(&mut self, variant: Variant) -> u32 {
        self.blob(variant).1
    }

    /// Instructions per sample.
    fn count(&mut self, program: &PathBuf, variant: Variant, estimator: &str) -> f64 {
        let key = (program.clone(), variant, estimator.to_owned());
        if let Some(&done) = self.counts.get(&key) {
            return done;
        }
        let (blob, _) = self.blob(variant);
        let total = |samples: u64| -> f64 {
            let output = Command::new("valgrind")
                .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
                .arg(program)
                .arg(&blob)
                .args([estimator, &samples.to_string()])
                .args(variant.sobol.then_some("sobol"))
                .output()
                .expect("valgrind runs");
            let text = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(output.status.success(), "{estimator}: {text}");
            let line = text.lines().find_map(|l| l.split_once("Collected : "));
            let (_, number) = line.unwrap_or_else(|| panic!("no count: {text}"));
            number.trim().parse().expect("a number")
        };
        let pixels = f64::from(SIZE * SIZE);
        let count = (total(MANY) - total(FEW)) / ((MANY - FEW) as f64 * pixels);
        self.counts.insert(key, count);
        count
    }
}
