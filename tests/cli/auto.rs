//! `--estimator auto`: what it chooses, what it says, and what it may take.

use super::chart::{chart, names};
use super::{bytes, etendue, folder, json, text};
use etendue::{Scene, Settings};
use etendue_host::render::{Crew, Found, MOST_TIME, pilot};
use etendue_host::scene::{Changes, prepare};
use std::path::Path;
use std::time::Duration;

/// `auto` is what its pilot chooses, here as in `render`.
#[test]
fn auto_is_charted_as_what_it_chooses() {
    let (_keep, at) = folder();
    let (_, numbers) = chart(&at, &["--estimators", "auto,path,bidirectional"]);
    let names = names(&numbers);
    let chosen = names[0]
        .strip_prefix("auto (")
        .and_then(|name| name.strip_suffix(')'))
        .unwrap();
    let i = names.iter().position(|name| *name == chosen).unwrap();
    let errors = |i: usize| numbers["variants"][i]["rungs"][0]["trials"].clone();
    let mse = |i: usize| errors(i)[0]["mse"].clone();
    assert_eq!(mse(0), mse(i));
    assert_ne!(mse(0), mse(3 - i));
    // The same estimator, said aloud and named outright, makes the same image.
    let render = |estimator: &str, file: &str, threads: &str| {
        let how = ["--estimator", estimator, "--threads", threads, "--spp", "2"];
        let all = [&["render", "scene.xml", "-o", file][..], &how].concat();
        let output = etendue(&at, &all);
        assert!(output.status.success());
        (bytes(&at, file), text(&output.stderr))
    };
    let (auto, said) = render("auto", "a.exr", "1");
    assert!(said.starts_with(&format!("{chosen}: ")), "{said}");
    assert_eq!(auto, render("auto", "b.exr", "3").0);
    assert_eq!(auto, render(chosen, "c.exr", "2").0);
    let other = ["path", "bidirectional"].map(|name| render(name, "d.exr", "1").0);
    assert_ne!(other[0], other[1]);
}

/// Candidates in a scene of `host/scenes/stability` at 64 × 64 pixels.
fn candidates(scene: &str, time: Option<Duration>) -> Vec<Found> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/stability");
    let small = Changes {
        width: Some(64),
        height: Some(64),
        ..Changes::default()
    };
    let file = folder.join(format!("{scene}.xml"));
    let prepared = prepare(&file, &[], small).unwrap();
    let scene = Scene::open(prepared.blob.bytes()).unwrap();
    pilot(&scene, &Settings::default(), Crew::Own(0), time).unwrap()
}

/// By counted rays, a pilot takes no more than its share of a render of 30 s, at the 2.8 million rays a second that a core makes: even where a sample has thousands.
#[test]
fn pilots_are_short_beside_a_render_of_30_seconds() {
    const RAYS: f64 = 30.0 * 2.8e6;
    let mut longest = 0.0f64;
    for scene in ["room", "slab-thick", "mirror-hall"] {
        let found = candidates(scene, None);
        // A pair of samples may begin just before the end.
        let whole = |f: &Found| f.pilot.rays as f64 - 2.0 * f.pilot.cost().max(1e5);
        let rays: f64 = found.iter().map(whole).sum();
        for f in &found {
            println!("{scene}: {f:?}");
            longest = longest.max(f.pilot.cost());
            assert!(f.pilot.samples >= 64, "{scene}: {f:?}");
        }
        assert!(rays <= MOST_TIME * RAYS, "{scene}: {rays}");
    }
    // Where samples are so long, the number of pixels isn't what ends a pilot.
    assert!(longest > 1500.0, "{longest}");
}

/// A render that ends by time has a pilot that does: where there is no time at all, of a pair of samples.
#[test]
fn pilots_of_timed_renders_end_by_time() {
    for scene in ["room", "slab-thick"] {
        for f in candidates(scene, Some(Duration::ZERO)) {
            assert_eq!(f.pilot.samples, 2, "{scene}: {f:?}");
        }
        for f in candidates(scene, Some(Duration::from_secs(1 << 20))) {
            assert!(f.pilot.samples > 2, "{scene}: {f:?}");
        }
    }
}

/// What the pilot took is said, and in what relation to the render.
#[test]
fn the_pilots_share_is_printed() {
    let (_keep, at) = folder();
    let line = |how: &[&str]| {
        let all = [&["render", "scene.xml", "-o", "x.exr"][..], how].concat();
        let output = etendue(&at, &all);
        assert!(output.status.success());
        let said = text(&output.stderr);
        said.lines().next().unwrap().to_owned()
    };
    let said = line(&["--spp", "100"]);
    let how = ["render", "scene.xml", "-o", "x.exr", "--json", "--spp"];
    let report = |passes: &str| json(&at, &[&how[..], &[passes]].concat());
    let (hundred, fifty) = (report("100"), report("50"));
    let share = |r: &serde_json::Value| r["pilot"]["share"].as_f64().unwrap();
    let rays = hundred["pilot"]["rays"].as_u64().unwrap();
    let expected = format!(
        "the pilot took {:.2} M rays, {:.1} % of what the render takes",
        1e-6 * rays as f64,
        100.0 * share(&hundred)
    );
    assert!(said.ends_with(&expected), "{said}, not {expected}");
    assert!((share(&fifty) / share(&hundred) - 2.0).abs() < 1e-9);
    // It is what was counted: rays of the pilot over those of the render, which has as many a sample, but for chance.
    let found = rays as f64 / hundred["rays"].as_f64().unwrap();
    assert!((found / share(&hundred) - 1.0).abs() < 0.1, "{found}");
    let timed = line(&["--time", "100ms"]);
    assert!(timed.ends_with(" % of the render's time"), "{timed}");
    // The same each time, but for times.
    assert_eq!(said, line(&["--spp", "100"]));
    assert!(report("1")["pilot"]["chosen"].is_string());
    let named = ["--estimator", "path", "1"];
    assert!(json(&at, &[&how[..5], &named[..2], &["--spp", "1"]].concat())["pilot"].is_null());
}

/// A lamp of a hundredth of a thousandth of the room in a globe of glass: `path` runs into it in one sample of millions, and what it hasn't met isn't an image without noise.
#[test]
fn who_meets_no_light_is_not_chosen() {
    let (_keep, at) = folder();
    let lamp = r#"<emitter type="area">"#;
    let globe = r#"<bsdf type="dielectric"/></shape>
  <shape type="sphere">
    <point name="center" x="0" y="1.5" z="0"/><float name="radius" value="0.0001"/>
    <emitter type="area">"#;
    let scene = text(&bytes(&at, "scene.xml"));
    assert!(scene.contains(lamp));
    std::fs::write(at.join("scene.xml"), scene.replace(lamp, globe)).unwrap();
    let output = etendue(&at, &["render", "scene.xml", "-o", "x.exr", "--spp", "1"]);
    let said = text(&output.stderr);
    let expected = "bidirectional: by a pilot in which path met no light";
    assert!(said.starts_with(expected), "{said}");
}
