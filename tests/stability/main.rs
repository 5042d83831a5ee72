//! The atlas of scenes at which methods break, at a small budget: everything has to come out as it is written down
//! (`host/scenes/stability/manifest.json`), with the seed that the program has by default.

use etendue_host::reach::unreachable;
use etendue_host::stability::{Budget, Expectation, Method, manifest, prepare, run};

/// Nothing is compared with a truth that nobody can have been told.
#[test]
fn the_manifest_says_why() {
    let cases = manifest().unwrap();
    for case in &cases {
        assert!(
            !case.about.is_empty() && !case.truth.source.is_empty(),
            "{}",
            case.name
        );
        assert!(!case.expected.is_empty(), "{}", case.name);
        for e in &case.expected {
            assert!(!e.why.is_empty(), "{}, {}", case.name, e.method.name());
        }
        let same = cases.iter().filter(|c| c.name == case.name).count();
        assert_eq!(same, 1, "{}", case.name);
    }
}

#[test]
fn everything_comes_out_as_written_down() {
    let ready = prepare(manifest().unwrap()).unwrap();
    let budget = Budget {
        scale: 0.5,
        seed: 0,
    };
    let rows = run(&ready, &budget, &|_, _| ()).unwrap();
    let differ: Vec<_> = rows
        .iter()
        .filter(|r| !r.is_met())
        .map(|r| {
            format!(
                "{}, {}: {}",
                r.case.name,
                r.method().name(),
                r.differs.join("; ")
            )
        })
        .collect();
    assert!(differ.is_empty(), "{}", differ.join("\n"));
}

/// Where light paths are missing the program names them, and where an estimator makes all there are it names none.
#[test]
fn what_is_missing_is_named() {
    for ready in prepare(manifest().unwrap()).unwrap() {
        let scene = etendue::Scene::open(ready.blob.bytes()).unwrap();
        for e in &ready.case.expected {
            let named = unreachable(&scene, &e.method.settings(None, 0));
            let place = format!("{}, {}: {named:?}", ready.case.name, e.method.name());
            if e.what == Expectation::Misses {
                assert!(!named.is_empty(), "{place}");
            }
            // A walk from the sensor meets every light that has a size.
            if e.method == Method::Path && e.what == Expectation::Right {
                assert!(named.is_empty(), "{place}");
            }
        }
    }
}
