//! ξ at 0 and just below 1: whatever an estimator draws, nothing may be non-finite, and nothing may hang.

macro_rules! ends {
    ($name:ident, $kernel:ident) => {
        mod $name {
            use $kernel::random::{Purpose, Sampler, Subpath};
            use $kernel::real::{ONE_MINUS, Real};
            use $kernel::sensor::Element;
            use $kernel::{Rgb, Scene, Scratch, Settings, estimate_with};

            /// The same numbers over and over.
            struct Fixed {
                numbers: [Real; 2],
                drawn: usize,
            }

            impl Sampler for Fixed {
                fn at(&mut self, _: Subpath, _: u32) {}
                fn one(&mut self, _: Purpose) -> Real {
                    self.drawn += 1;
                    self.numbers[self.drawn % 2]
                }
            }

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
                        let sampler = &mut Fixed { numbers, drawn: 0 };
                        let element = Element::Pixel(pixel);
                        let own = estimate_with(
                            scene,
                            &scene.tree(),
                            settings,
                            &element,
                            sampler,
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
