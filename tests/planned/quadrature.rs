//! What quadrature makes, and what path tracing adds: all paths, each once.

use super::{assert_agree, by, estimates, media, path, rule, scenes};
use etendue::Estimator::{Quadrature, QuadratureAndPath};
use etendue::estimate::Rule;
use etendue::{Scene, Settings};
use etendue_host::description::EmitterKind;
use etendue_tests::render::blob;
use etendue_tests::scenes::Builder;

/// With random shifts nothing is biased.
#[test]
fn shifted_rules_and_path_are_path() {
    let settings = rule(QuadratureAndPath, 2, 6, true);
    for (name, d, _) in scenes::objects().iter().chain(&scenes::lights()) {
        assert_agree(name, &path(d, None), &estimates(d, settings, 12), 0.0);
    }
}

#[test]
fn in_media_as_well() {
    let settings = rule(QuadratureAndPath, 2, 6, true);
    let all = [
        media::fogs(),
        media::grids(),
        media::boundaries(),
        media::lights(),
        media::flames(),
        media::sensors(),
    ];
    for (name, d, _) in all.iter().flatten() {
        assert_agree(name, &path(d, None), &estimates(d, settings, 16), 0.0);
    }
}

/// Whatever the number of Dirac lobes that are followed, and whatever the length of paths.
#[test]
fn the_border_between_both_does_not_matter() {
    let (name, d, _) = &scenes::objects()[5];
    for depth in [0, 1, 2] {
        let settings = Settings {
            rule: Rule {
                depth,
                order: 2,
                shift: true,
                ..Rule::default()
            },
            ..by(QuadratureAndPath)
        };
        let what = format!("{name}, {depth} Dirac lobes");
        assert_agree(&what, &path(d, None), &estimates(d, settings, 12), 0.0);
    }
    for edges in 1..=3 {
        let settings = Settings {
            max_edges: Some(edges),
            ..rule(QuadratureAndPath, 2, 6, true)
        };
        let what = format!("{name}, {edges} edges");
        assert_agree(
            &what,
            &path(d, Some(edges)),
            &estimates(d, settings, 12),
            0.0,
        );
    }
}

/// Where all surfaces are diffuse, quadrature alone is path tracing to two edges.
#[test]
fn alone_it_is_direct_light() {
    let d = scenes::plain();
    let settings = rule(Quadrature, 2, 6, true);
    assert_agree(
        "direct",
        &path(&d, Some(2)),
        &estimates(&d, settings, 12),
        0.0,
    );
}

/// Gauss's rules of order 6 miss less than 3 % of any block's light, shadows' edges included.
#[test]
fn gauss_and_path_are_path_but_for_a_bound() {
    let settings = rule(QuadratureAndPath, 6, 64, false);
    for (name, d, _) in &scenes::objects() {
        assert_agree(name, &path(d, None), &estimates(d, settings, 6), 0.03);
    }
}

/// The irradiance of a unit square lamp over the corner of its shadow (configuration factor B-4 of Howell's catalogue, times π), by orders: in double
/// precision the error shrinks at least by 5 with every order, down to 1e-6.
#[test]
fn the_error_of_gauss_shrinks_with_its_order() {
    let mut b = Builder::new();
    b.quad([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], None)
        .emission = Some([1.0; 3]);
    let bytes = blob(&b.description);
    let scene = etendue_f64::Scene::open(bytes.bytes()).unwrap();
    // Over a corner: ½·2·(a/√(1+a²))·atan(b/√(1+a²)) with a = b = 1.
    let half = 0.5f64.sqrt();
    let truth = half * half.atan();
    let mut before = f64::INFINITY;
    for order in 1..=8 {
        let settings = etendue_f64::Settings {
            estimator: etendue_f64::Estimator::Quadrature,
            rule: etendue_f64::estimate::Rule {
                order,
                ..etendue_f64::estimate::Rule::default()
            },
            ..etendue_f64::Settings::default()
        };
        let mut scratch = etendue_f64::Scratch::<8>::new();
        let (up, at) = (glam::DVec3::Z, glam::DVec3::ZERO);
        let e = scene.irradiance(&settings, at, up, 0, 0, &mut scratch).g;
        let again = scene.irradiance(&settings, at, up, 5, 9, &mut scratch).g;
        assert_eq!(e, again, "nothing is random");
        let error = (e / truth - 1.0).abs();
        eprintln!("order {order}: {error:e}");
        assert!(
            error < before / 5.0 || error < 1e-8,
            "order {order}: {error:e} after {before:e}"
        );
        before = error;
    }
    assert!(before < 1e-6, "{before:e}");
}

/// A light that quadrature makes nothing of is refused.
#[test]
fn backgrounds_are_refused() {
    let mut b = Builder::new();
    b.sphere([0.0; 3], 1.0, None);
    let open = blob(&b.description);
    b.light(EmitterKind::Constant { radiance: [1.0; 3] });
    let sky = blob(&b.description);
    let refused = |bytes: &[u8], e: etendue::Estimator| e.refuses(&Scene::open(bytes).unwrap());
    assert!(refused(sky.bytes(), Quadrature).is_some_and(|r| r.contains("quadrature+path")));
    assert_eq!(refused(sky.bytes(), QuadratureAndPath), None);
    assert_eq!(refused(open.bytes(), Quadrature), None);
}
