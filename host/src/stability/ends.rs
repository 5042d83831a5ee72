//! ξ at 0 and just below 1: whatever an estimator draws, nothing may be non-finite, and nothing may hang. Chains are asked for samples, which are those
//! of bidirectional: their own numbers come from within the kernel.

macro_rules! ends {
    ($name:ident, $kernel:ident) => {
        mod $name {
            use $kernel::random::{Ends, Numbers};
            use $kernel::real::ONE_MINUS;
            use $kernel::sensor::Element;
            use $kernel::{Rgb, Scene, Scratch, Settings};

            /// Values that aren't finite, or that the kernel had to reject.
            pub fn violations(scene: &Scene<'_>, settings: &Settings) -> u64 {
                let [w, h] = scene.size();
                let mut scratch = Box::new(Scratch::<32>::new());
                let mut bad = 0;
                for numbers in [[0.0; 2], [ONE_MINUS; 2], [0.0, ONE_MINUS], [ONE_MINUS, 0.0]] {
                    for pixel in [[0, 0], [w / 2, h / 2]] {
                        let mut check = |v: Rgb| {
                            bad += u64::from(v.to_array().iter().any(|x| !x.is_finite()));
                        };
                        let own = scene.estimate_element(
                            settings,
                            &Element::Pixel(pixel),
                            &mut Numbers::Ends(Ends::new(numbers)),
                            &mut scratch.view(scene),
                            &mut |_, v| check(v),
                        );
                        check(own);
                    }
                }
                bad + scratch.counters.rejected
            }
        }
    };
}

ends!(single, etendue);
ends!(double, etendue_f64);

/// Violations in single and in double precision.
pub(super) fn violations(
    scene: &etendue::Scene<'_>,
    wide: &etendue_f64::Scene<'_>,
    settings: &etendue::Settings,
    wide_settings: &etendue_f64::Settings,
) -> [u64; 2] {
    [
        single::violations(scene, settings),
        double::violations(wide, wide_settings),
    ]
}
