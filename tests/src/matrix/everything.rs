//! All matter in one scene: what else stands alone meets here.

use super::Complete::FromSensor;
use super::Named;
use crate::scenes::room;
use etendue_host::description::{
    ColorSource, Distribution, EmitterKind, Facets, Grid, GridValues, Index, Masking, Medium,
    Model, Phase,
};

/// Fog with a shaft of light in it, smoke, a flame, wax in glass, jade in ground glass, a cloth, a tinted film and a prism: by wavelengths.
pub fn everything() -> Named {
    let constant = |c: f32| ColorSource::Constant([c; 3]);
    let d = room(|b| {
        let fog = b.medium([0.3, 0.25, 0.2], [0.9; 3], Phase::Isotropic);
        b.fog([-1.1, -1.2, -0.1], [1.1, 1.1, 2.1], fog);
        b.light(EmitterKind::Spot {
            position: [-0.7, -0.6, 1.7],
            direction: [0.6, 0.0, -0.8],
            intensity: [3.0, 2.5, 2.0],
            cutoff: 0.4,
            beam_width: 0.3,
        });
        // Large: a path tracer has to find it through glass.
        let white = Some(b.diffuse([0.8; 3]));
        b.quad([-0.9, -0.9, 1.9], [0.0, 1.8, 0.0], [1.8, 0.0, 0.0], white)
            .emission = Some([1.0; 3]);
        let texels = (0..27u8).map(|i| f32::from(i % 4));
        let smoke = Medium {
            sigma_t: [1.5; 3],
            albedo: [0.8, 0.7, 0.6],
            phase: vec![Phase::HenyeyGreenstein { g: 0.5 }.into()],
            ..Medium::default()
        };
        let grid = Grid {
            size: [3; 3],
            values: GridValues::Gray(texels.collect()),
            nearest: false,
        };
        let (low, high) = ([-0.9, 0.3, 0.1], [-0.3, 0.9, 0.8]);
        let smoke = b.smoke(low, high, grid, smoke);
        b.fog(low, high, smoke).exterior = Some(fog);
        let flame = b.matter(Medium {
            sigma_t: [2.0, 1.0, 0.5],
            albedo: [0.3, 0.5, 0.2],
            emission: [3.0, 1.5, 0.5],
            ..Medium::default()
        });
        let null = b.null();
        b.ball([0.6, 0.6, 0.4], 0.25, null, flame).exterior = Some(fog);
        let glass = b.glass(1.4);
        let wax = b.medium([2.0, 3.0, 4.0], [0.95, 0.9, 0.7], Phase::Rayleigh);
        b.ball([-0.55, -0.4, 0.3], 0.25, glass, wax).exterior = Some(fog);
        let ground = b.material(Model::RoughDielectric {
            ior: 1.5,
            reflectance: constant(1.0),
            transmittance: constant(1.0),
            facets: Facets {
                alpha: [0.4; 2],
                distribution: Distribution::Ggx,
                masking: Masking::Correlated,
                compensated: false,
            },
        });
        let jade = b.medium([3.0, 1.5, 3.5], [0.7, 0.95, 0.8], Phase::Isotropic);
        b.ball([0.1, -0.5, 0.3], 0.25, ground, jade).exterior = Some(fog);
        let cloth = b.material(Model::Diffuse {
            reflectance: ColorSource::Constant([0.4, 0.2, 0.2]),
            transmittance: ColorSource::Constant([0.4, 0.1, 0.1]),
        });
        b.quad(
            [-0.2, 0.5, 0.9],
            [0.5, 0.0, 0.0],
            [0.0, 0.2, 0.6],
            Some(cloth),
        );
        let film = b.material(Model::Sheet {
            specular_reflectance: constant(0.1),
            specular_transmittance: ColorSource::Constant([0.2, 0.7, 0.3]),
            diffuse_reflectance: constant(0.0),
            diffuse_transmittance: constant(0.1),
        });
        b.quad(
            [0.4, -0.3, 0.7],
            [0.5, 0.0, 0.0],
            [0.0, 0.3, 0.5],
            Some(film),
        );
        let prism = b.material(Model::Dispersive {
            index: Index::Sellmeier {
                b: [1.737_597, 0.313_747_35, 1.898_781],
                c: [0.013_188_707, 0.062_306_814, 155.236_3],
            },
            outside: 1.0,
            reflectance: constant(1.0),
            transmittance: constant(1.0),
            schlick: false,
        });
        let prism = b.cuboid([0.4, -0.7, 0.05], [0.75, -0.4, 0.5], false, Some(prism));
        // Nothing fills it.
        (prism.interior, prism.exterior) = (None, Some(fog));
    })
    .description;
    ("all matter", d, FromSensor)
}
