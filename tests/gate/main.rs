//! The gate, rule by rule: for every rule of the format there is a blob that breaks just that one, and is refused with
//! that rule's own error, at the right place. (Thousands of blobs broken at random go through `golden` and `fuzz`.)

mod breaks;
mod draft;
mod media;

use breaks::{Break, breaks};
use draft::scene;
use etendue::Scene;
use etendue::blob::{BlobError, Rule};
use etendue_host::blob::AlignedBlob;
use std::collections::BTreeSet;

/// Rules that no blob here can break alone, and why.
const ELSEWHERE: [(Rule, &str); 7] = [
    (Rule::WorldPrimitives, "takes a blob of 150 GB"),
    (Rule::TextureLeftOut, "takes a kernel without textures"),
    (
        Rule::MaterialLeftOut,
        "takes a kernel without glossy materials",
    ),
    (Rule::EmitterLeftOut, "takes a kernel without environments"),
    (Rule::MediumLeftOut, "takes a kernel without media"),
    (Rule::SensorLeftOut, "takes a kernel without panoramas"),
    (Rule::SpectraLeftOut, "takes a kernel without spectra"),
];

#[test]
fn the_scene_itself_is_good() {
    let mut scene = scene();
    let opened = Scene::open(scene.0.bytes()).unwrap();
    assert!(opened.world().depth >= 2, "a tree of three levels");
    for section in etendue::blob::format::section::ALL {
        assert!(scene.toc(section).count > 0, "section {section} is empty");
    }
}

#[test]
fn every_rule_has_a_blob_that_breaks_it() {
    let good = scene();
    let mut broken = BTreeSet::new();
    for Break {
        rule,
        section,
        index,
        change,
    } in breaks()
    {
        let mut draft = draft::Draft(good.0.clone());
        change(&mut draft);
        let error = Scene::open(draft.0.bytes()).err();
        let expected = BlobError {
            rule,
            section,
            index,
        };
        assert_eq!(error, Some(expected));
        let said = expected.to_string();
        let words = !rule.text().is_empty() && !said.contains("unknown");
        assert!(words, "{said}");
        broken.insert(rule as u8);
    }
    // Its own test below.
    broken.insert(Rule::HeaderAddress as u8);
    for (rule, _) in ELSEWHERE {
        assert!(broken.insert(rule as u8), "{rule:?} can be broken");
    }
    let missing: Vec<_> = Rule::ALL
        .iter()
        .filter(|&&rule| !broken.contains(&(rule as u8)))
        .collect();
    assert!(missing.is_empty(), "nothing breaks {missing:?}");
}

#[test]
fn an_address_that_is_not_a_multiple_of_16_is_refused() {
    let good = scene();
    let padded = AlignedBlob::copy_of(&[&[0; 8], good.0.bytes()].concat());
    let error = Scene::open(&padded.bytes()[8..]).unwrap_err();
    assert_eq!((error.rule, error.section), (Rule::HeaderAddress, 0));
}
