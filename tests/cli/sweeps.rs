//! Everything that a chart can sweep makes variants that are named and that differ.

use super::chart::{chart, names};
use super::{etendue, folder, succeed, text};
use std::collections::BTreeSet;
use std::path::Path;

/// A floor under a lamp, a point light, a glass ball and smoke, in a room's corner: something for every flag.
fn scene() -> String {
    let smoke =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/scenes/volumes/smoke32.vol");
    let quad = |transform: &str| {
        format!(
            "<shape type=\"rectangle\"><transform name=\"to_world\">{transform}</transform><ref id=\"white\"/></shape>"
        )
    };
    let floor = quad("<rotate x=\"1\" angle=\"-90\"/><scale value=\"2\"/>");
    let wall = quad("<scale value=\"2\"/><translate x=\"0\" y=\"2\" z=\"-2\"/>");
    format!(
        r#"<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="-1"/></integrator>
  <sensor type="perspective">
    <float name="fov" value="50"/>
    <transform name="to_world"><lookat origin="0, 2, 5" target="0, 0.8, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="6"/><rfilter type="box"/></film>
  </sensor>
  <bsdf type="twosided" id="white"><bsdf type="diffuse"><rgb name="reflectance" value="0.6, 0.5, 0.4"/></bsdf></bsdf>
  {floor}{wall}
  <shape type="rectangle">
    <transform name="to_world"><rotate x="1" angle="90"/><scale value="0.5"/><translate x="0" y="3" z="0"/></transform>
    <emitter type="area"><rgb name="radiance" value="9, 8, 7"/></emitter>
  </shape>
  <emitter type="point"><point name="position" x="1.5" y="2.5" z="1"/><rgb name="intensity" value="3, 3, 3"/></emitter>
  <shape type="sphere">
    <point name="center" x="-0.9" y="0.9" z="0.8"/><float name="radius" value="0.9"/>
    <bsdf type="dielectric"><float name="int_ior" value="1.5"/></bsdf>
  </shape>
  <medium type="heterogeneous" id="smoke">
    <volume name="sigma_t" type="gridvolume">
      <string name="filename" value="{}"/>
      <transform name="to_world"><scale value="1.4"/><translate x="0" y="0.1" z="-0.7"/></transform>
    </volume>
    <rgb name="albedo" value="0.8, 0.8, 0.8"/><float name="scale" value="10"/><phase type="isotropic"/>
  </medium>
  <shape type="cube">
    <transform name="to_world"><scale value="0.7"/><translate x="0.7" y="0.8" z="0"/></transform>
    <bsdf type="null"/><ref name="interior" id="smoke"/>
  </shape>
</scene>"#,
        smoke.display()
    )
}

/// The flag, its values, and whose it is.
const SWEPT: [(&str, &str, &str); 17] = [
    (
        "estimator",
        "path,light,bidirectional,metropolis,distributed,quadrature,quadrature+path",
        "path",
    ),
    ("mis", "balance,power,cutoff,maximum", "bidirectional"),
    ("sampler", "independent,sobol", "path"),
    ("roulette", "0,0.5,1", "path"),
    ("max-depth", "2,4,-1", "path"),
    ("fresnel", "exact,schlick", "path"),
    ("color", "rgb,spectral", "path"),
    ("tracking", "woodcock,residual,regular", "path"),
    ("steps", "2,9", "quadrature"),
    ("quadrature", "1,4", "quadrature"),
    ("shift", "false,true", "quadrature"),
    ("precision", "single,double", "path"),
    ("branching", "2,2;4,4", "distributed"),
    ("light-samples", "1,2", "distributed"),
    ("large-steps", "0.2,0.9", "metropolis"),
    ("view-steps", "0,0.5", "metropolis"),
    ("seed", "0,1", "path"),
];

#[test]
fn every_sweep_makes_variants_that_differ() {
    let (_keep, at) = folder();
    std::fs::write(at.join("scene.xml"), scene()).unwrap();
    let reference = [
        "render",
        "scene.xml",
        "-o",
        "ref.exr",
        "--spp",
        "64",
        "--quiet",
    ];
    succeed(&at, &[&reference[..], &["--estimator", "path"]].concat());
    let tiny = ["--reference", "ref.exr", "--seeds", "2", "--budget"];
    // Errors by budget and seed: the same for the same numbers.
    let errors = |numbers: &serde_json::Value, i: usize| -> Vec<f64> {
        let variant = &numbers["variants"][i];
        let rungs = variant["rungs"].as_array().unwrap().iter();
        let trials = rungs.flat_map(|r| r["trials"].as_array().unwrap());
        let all: Vec<_> = trials.map(|t| t["mse"].as_f64().unwrap()).collect();
        assert!(all.len() >= 2, "{variant}");
        all
    };
    // Of two variants, those of the budgets that both had.
    let common = |numbers: &serde_json::Value, i: usize, j: usize| {
        let [mut a, mut b] = [i, j].map(|i| errors(numbers, i));
        let n = a.len().min(b.len());
        a.truncate(n);
        b.truncate(n);
        [a, b]
    };
    for (key, values, estimator) in SWEPT {
        let sweep = format!("{key}={values}");
        let of = ["--estimator", estimator, "--sweep", &sweep];
        let how = if key == "estimator" { &of[2..] } else { &of };
        // A chain starts when samples have left it enough.
        let budget = if estimator == "metropolis" {
            "8s"
        } else {
            "100ms"
        };
        let (report, numbers) = chart(&at, &[&tiny[..], &[budget], how].concat());
        let separator = if values.contains(';') { ';' } else { ',' };
        let expected: Vec<String> = values
            .split(separator)
            .map(|value| {
                if key == "estimator" {
                    value.into()
                } else {
                    format!("{key} {value}")
                }
            })
            .collect();
        assert_eq!(names(&numbers), expected);
        for (i, name) in expected.iter().enumerate() {
            assert!(report.contains(name.as_str()), "the report lacks {name}");
            for (j, other) in expected.iter().enumerate().skip(i + 1) {
                let [mine, others] = common(&numbers, i, j);
                assert_ne!(mine, others, "{name}, {other}");
            }
        }
    }
    // What is the same makes the same errors.
    let (_, same) = chart(
        &at,
        &[
            &tiny[..],
            &["100ms", "--estimator", "path", "--sweep", "mis=power,power"],
        ]
        .concat(),
    );
    let [a, b] = common(&same, 0, 1);
    assert_eq!(a, b);
    // These are all flags that there are.
    let unknown = etendue(
        &at,
        &["chart", "scene.xml", "--sweep", "luck=1", "-o", "x.html"],
    );
    let said = text(&unknown.stderr);
    let (_, known) = said.split_once("expected one of ").unwrap();
    let known: BTreeSet<&str> = known.trim().split(", ").collect();
    assert_eq!(known, SWEPT.iter().map(|(key, ..)| *key).collect());
}
