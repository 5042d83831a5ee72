//! Ray trees have the paths of their depth, all of them and each once.

use super::{assert_agree, estimates, media, path, scenes, tree};
use etendue::{Estimator, Scene, Scratch, Settings};
use etendue_tests::render::blob;

/// A tree of n levels is path tracing to n + 1 edges.
#[test]
fn a_tree_agrees_with_path_tracing_to_its_depth() {
    let settings = tree([3, 2, 1, 0, 0, 0, 0, 0], 2);
    for (name, d, _) in scenes::objects().iter().chain(&scenes::lights()) {
        let truth = path(d, Some(4));
        assert_agree(name, &truth, &estimates(d, settings, 12), 0.0);
    }
}

#[test]
fn in_media_as_well() {
    let settings = tree([3, 2, 1, 0, 0, 0, 0, 0], 2);
    let all = [
        media::fogs(),
        media::grids(),
        media::boundaries(),
        media::lights(),
        media::flames(),
        media::sensors(),
    ];
    // Next to a point in fog light goes as 1/d⁴ along a ray: only equiangular sampling has a variance there.
    let tame = |(name, ..): &&(&str, _, _)| *name != "a point in fog";
    for (name, d, _) in all.iter().flatten().filter(tame) {
        let truth = path(d, Some(4));
        assert_agree(name, &truth, &estimates(d, settings, 16), 0.0);
    }
}

/// Neither how many rays there are nor how many samples of lights changes the mean; a limit below the depth counts.
#[test]
fn branching_and_light_samples_do_not_matter() {
    let d = scenes::plain();
    let truth = path(&d, Some(3));
    for (branching, lights) in [
        ([1, 1, 0, 0, 0, 0, 0, 0], 1),
        ([5, 1, 0, 0, 0, 0, 0, 0], 3),
        ([1, 6, 0, 0, 0, 0, 0, 0], 0),
    ] {
        let by_tree = estimates(&d, tree(branching, lights), 12);
        assert_agree(&format!("{branching:?}"), &truth, &by_tree, 0.0);
    }
    let deeper = Settings {
        max_edges: Some(3),
        ..tree([2, 2, 2, 2, 0, 0, 0, 0], 1)
    };
    assert_agree("limited", &truth, &estimates(&d, deeper, 12), 0.0);
}

/// The scratch's capacity bounds the depth, and that is counted.
#[test]
fn a_small_scratch_bounds_the_depth() {
    let bytes = blob(&scenes::plain());
    let scene = Scene::open(bytes.bytes()).unwrap();
    let settings = tree([1, 1, 1, 1, 0, 0, 0, 0], 1);
    let mut scratch = Scratch::<2>::new();
    scene.estimate(&settings, [8, 8], 0, &mut scratch, &mut |_, _| ());
    assert_eq!(scratch.counters.full_walks, 1);
    let mut scratch = Scratch::<4>::new();
    scene.estimate(&settings, [8, 8], 0, &mut scratch, &mut |_, _| ());
    assert_eq!(scratch.counters.full_walks, 0);
    // More rays than there is time for end.
    let wild = Settings {
        estimator: Estimator::Distributed,
        ..tree([255; 8], 1)
    };
    scene.estimate(&wild, [8, 8], 0, &mut Scratch::<8>::new(), &mut |_, _| ());
}
