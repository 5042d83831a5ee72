//! first run
use etendue::{Estimator, Heuristic, Scene, Settings};
use etendue_tests::{
    render::{blob, single},
    scenes::room,
};
#[test]
fn first() {
    for what in 0..3 {
        let b = room(|b| {
            if what == 1 {
                let m = b.mirror(1.0);
                b.sphere([-0.4, 0.2, 0.4], 0.35, Some(m));
                let g = b.glass(1.5);
                b.sphere([0.45, -0.2, 0.36], 0.35, Some(g));
            }
            if what == 2 {
                let w = b.diffuse([0.8; 3]);
                b.cuboid([-0.6, -0.1, 0.0], [0.0, 0.5, 0.8], false, Some(w));
                b.sphere([0.4, 0.0, 0.4], 0.2, Some(w)).emission = Some([3.0; 3]);
            }
        });
        let bytes = blob(&b.description);
        let scene = Scene::open(bytes.bytes()).unwrap();
        for (e, h, x) in [
            (Estimator::Path, Heuristic::Power, false),
            (Estimator::Path, Heuristic::Maximum, false),
            (Estimator::Light, Heuristic::Power, false),
            (Estimator::Bidirectional, Heuristic::Power, false),
            (Estimator::Bidirectional, Heuristic::Power, true),
            (Estimator::Bidirectional, Heuristic::Balance, false),
            (Estimator::Bidirectional, Heuristic::Balance, true),
            (Estimator::Bidirectional, Heuristic::Maximum, false),
            (Estimator::Bidirectional, Heuristic::Cutoff, false),
        ] {
            let t = std::time::Instant::now();
            let r = single::blocks::<32>(
                &scene,
                &Settings {
                    estimator: e,
                    heuristic: h,
                    explicit_weights: x,
                    ..Default::default()
                },
                1,
                128,
                16,
            );
            println!(
                "{what} {e:?} {h:?} {x} {:.3}us {:?}",
                t.elapsed().as_secs_f64() * 1e6 / (128.0 * 16.0 * 256.0),
                r.iter()
                    .map(|e| format!("{:.4}±{:.4}", e.mean, e.error))
                    .collect::<Vec<_>>()
            );
        }
    }
}
