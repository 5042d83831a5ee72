//! What media, their phase functions and their grids must not be.

use crate::breaks::{Break, broken, record};
use crate::draft::{CLOUD, Draft, FOG, GLOW, IMAGES, WORDS};
use etendue::blob::Rule;
use etendue::blob::format::{Grid, Lobe, Medium, NONE, Texture, medium, section};
use etendue_tests::media::replaced;

/// The `index`th word that the media's part `part` has among the texels.
fn word(d: &mut Draft, part: usize, index: usize) -> &mut u32 {
    let all = d.all::<u32>(section::TEXELS);
    let behind: usize = WORDS[part..].iter().sum();
    let first = all.len() - behind;
    &mut all[first + index]
}

pub fn media() -> Vec<Break> {
    let fog = |rule, change: fn(&mut Medium)| record(rule, section::MEDIA, FOG, change);
    let cloud = |rule, change: fn(&mut Medium)| record(rule, section::MEDIA, CLOUD, change);
    let lobe = |rule, change: fn(&mut Lobe)| {
        record(rule, section::MEDIA, FOG, move |m: &mut Medium| {
            change(&mut m.phase[1]);
        })
    };
    let texel = |rule, part, index, value: f32| {
        broken(rule, section::MEDIA, CLOUD, move |d| {
            *word(d, part, index) = value.to_bits();
        })
    };
    // A spectrum of one row.
    let row = |rule, value: f32, change: fn(&mut Medium)| {
        broken(rule, section::MEDIA, FOG, move |d| {
            let texels = d.all::<u32>(section::TEXELS);
            (texels[0], texels[1]) = (500.0f32.to_bits(), value.to_bits());
            change(&mut d.all::<Medium>(section::MEDIA)[FOG]);
        })
    };
    // The media read all of their words each, and as many times as that is allowed.
    let words: usize = WORDS.iter().sum();
    let most = 16 * crate::scene().all::<u32>(section::TEXELS).len() / words;
    vec![
        fog(Rule::MediumKind, |m| m.kind = 2),
        fog(Rule::MediumFlags, |m| m.flags = medium::REGULAR),
        cloud(Rule::MediumFlags, |m| m.flags = 4),
        fog(Rule::MediumSigma, |m| m.sigma_t[2] = -1.0),
        fog(Rule::MediumSigma, |m| m.sigma_t[2] = 1e-13),
        fog(Rule::MediumSigma, |m| m.sigma_t[2] = 1.1e12),
        fog(Rule::MediumSigma, |m| m.sigma_t[2] = f32::NAN),
        fog(Rule::MediumAlbedo, |m| m.albedo[1] = 1.1),
        fog(Rule::MediumEmission, |m| m.emission[0] = 1.1e20),
        fog(Rule::MediumEmission, |m| m.emission[0] = -1.0),
        fog(Rule::MediumMean, |m| m.mean[0] = 0.0),
        fog(Rule::MediumMean, |m| m.mean[2] = f32::INFINITY),
        fog(Rule::MediumAbsorption, |m| m.emission[2] = 1.0),
        fog(Rule::MediumAbsorption, |m| m.albedo[0] = 1.0),
        cloud(Rule::MediumAbsorption, |m| m.albedos = NONE),
        fog(Rule::MediumEmitter, |m| m.emitter = 99),
        // A lamp, and the cloud's.
        fog(Rule::MediumEmitter, |m| m.emitter = 0),
        fog(Rule::MediumEmitter, |m| m.emitter = GLOW as u32),
        lobe(Rule::LobeKind, |l| l.kind = 4),
        lobe(Rule::LobeG, |l| l.g = 1.0),
        lobe(Rule::LobeG, |l| l.g = -1.0),
        lobe(Rule::LobeG, |l| l.g = f32::NAN),
        lobe(Rule::LobeWeight, |l| l.weight = 1.1),
        lobe(Rule::LobeWeight, |l| l.weight = -0.1),
        lobe(Rule::LobeReserved, |l| l.reserved = 1),
        lobe(Rule::LobeSum, |l| l.weight = 0.2502),
        fog(Rule::MediumRows, |m| m.albedo_spectrum = [1, 0]),
        fog(Rule::MediumRows, |m| m.sigma_t_spectrum = [u32::MAX, 2]),
        cloud(Rule::MediumRows, |m| m.sigma_t_spectrum = [0, 1]),
        row(Rule::MediumRows, 1.5, |m| m.albedo_spectrum = [0, 1]),
        row(Rule::MediumRows, 1.1e20, |m| m.emission_spectrum = [0, 1]),
        row(Rule::MediumSigma, 1e-13, |m| m.sigma_t_spectrum = [0, 1]),
        row(Rule::MediumAbsorption, 0.5, |m| m.albedo_spectrum = [0, 1]),
        row(Rule::MediumEmission, 1.0, |m| {
            (m.emission, m.emission_spectrum) = ([0.0; 3], [0, 1]);
        }),
        row(Rule::MediumBudget, 0.5, |m| {
            m.albedo_spectrum = [0, u32::MAX]
        }),
        cloud(Rule::MediumExtinctions, |m| m.extinctions = NONE),
        cloud(Rule::MediumAlbedos, |m| m.albedos = 3),
        cloud(Rule::MediumEmissions, |m| m.emissions = 3),
        cloud(Rule::MediumResidual, |m| {
            (m.flags, m.sigma_t[1]) = (medium::RESIDUAL, 0.25);
        }),
        cloud(Rule::MediumToGrid, |m| m.to_grid[1] = m.to_grid[0]),
        cloud(Rule::MediumToGrid, |m| m.to_grid[1][1] = 1.1e12),
        cloud(Rule::MediumToGrid, |m| m.to_grid[1][3] = f32::NAN),
        cloud(Rule::MediumCells, |m| m.cells[1] = 0),
        cloud(Rule::MediumCells, |m| m.cells[1] = 3),
        cloud(Rule::MediumMajorants, |m| m.majorants += 1),
        texel(Rule::MediumAlbedoGrid, 1, 5, 1.1),
        cloud(Rule::MediumEmissionGrid, |m| m.emission[1] = 0.5e20),
        // The left box has the right texels' values at its right end; the right one has them everywhere.
        texel(Rule::MediumMajorant, 3, 0, 0.9),
        texel(Rule::MediumMajorant, 3, 1, 0.9),
        texel(Rule::MediumMajorant, 3, 0, f32::NAN),
        texel(Rule::MediumMajorant, 3, 0, 1.1e12),
        texel(Rule::MediumMajorant, 0, 7, 2.1),
        broken(Rule::MediumBudget, section::MEDIA, most, |d| {
            let cloud = Medium {
                emitter: NONE,
                ..*d.record::<Medium>(section::MEDIA, CLOUD)
            };
            d.0 = replaced(&d.0, section::MEDIA, &[cloud; 1000]);
        }),
    ]
}

pub fn grids() -> Vec<Break> {
    let g = |rule, change: fn(&mut Grid)| record(rule, section::GRIDS, 1, change);
    let texel = |value: f32| {
        broken(Rule::GridValue, section::GRIDS, 0, move |d| {
            *word(d, 0, 7) = value.to_bits();
        })
    };
    vec![
        g(Rule::GridNearest, |g| g.nearest = 2),
        g(Rule::GridChannels, |g| g.channels = 2),
        g(Rule::GridSize, |g| g.size[2] = 0),
        g(Rule::GridSize, |g| g.size[2] = 4097),
        g(Rule::GridTexels, |g| g.size[2] = 4096),
        g(Rule::GridTexels, |g| g.texels = NONE),
        g(Rule::GridReserved, |g| g.reserved[1] = 1),
        texel(-1.0),
        texel(f32::INFINITY),
        texel(1.1e12),
        // An image takes what is left for the grids.
        broken(Rule::GridBudget, section::GRIDS, 0, |d| {
            let mut too_little = |rows| {
                d.record::<Texture>(section::TEXTURES, IMAGES[0]).height = rows;
                let error = etendue::Scene::open(d.0.bytes()).err();
                error.is_some_and(|e| e.rule == Rule::GridBudget && e.index == 0)
            };
            let _ = (1..100).find(|&rows| too_little(rows));
        }),
    ]
}
