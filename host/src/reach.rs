//! The light paths that an estimator can't make in a scene, in words: proved from the blob, not guessed.
//!
//! A path is a light L, vertices that are Dirac (D: mirrors, smooth glass) or not (N), and the sensor E. An estimator makes it if one of
//! its strategies can: a walk from the sensor that meets the light (not a point, spot or directional one); a light drawn for an N; a light
//! walk's N joined to the sensor; an N of either walk joined to one of the other's.
//!
//! ```text
//! path            L D … N …            where L is a point, spot or directional light: nobody meets it, and no N is next to it
//! light           … D E                no N is next to the sensor
//! bidirectional   L D … N D … E        where L is such a light and no two N are neighbours
//! ```

use etendue::Scene;
use etendue::blob::format::{Material, NONE, emitter, material, medium, sensor};
use etendue::estimate::{Estimator, LEVELS, Settings};

/// What of a scene decides which paths there are.
#[derive(Clone, Copy, Debug, Default)]
struct Facts {
    /// A light that no walk meets: point, spot, directional.
    dirac_light: bool,
    /// Any light.
    light: bool,
    /// A surface with a Dirac lobe.
    dirac: bool,
    /// A surface or medium that scatters otherwise.
    smooth: bool,
    /// A background, and a sensor that sees each direction at one point of the film at most.
    parallel: bool,
}

/// What a material's lobes are: Dirac ones, others.
fn lobes(scene: &Scene<'_>, m: &Material) -> [bool; 2] {
    let has = |role: usize| m.color[role] != [0.0; 3];
    match m.kind {
        material::DIFFUSE => [false, has(0) || has(1)],
        material::MIRROR | material::CONDUCTOR => [has(0), false],
        material::DIELECTRIC | material::DISPERSIVE => [has(0) || has(1), false],
        material::NULL => [false, false],
        material::SHEET => [has(0) || has(1), has(2) || has(3)],
        material::PLASTIC => [has(1), has(0)],
        material::BLEND => {
            // A blend's parts have lower levels: this ends.
            let parts = m.link.map(|id| {
                scene
                    .materials()
                    .get(id as usize)
                    .map(|part| lobes(scene, part))
            });
            let [a, b] = parts.map(Option::unwrap_or_default);
            [a[0] || b[0], a[1] || b[1]]
        }
        // Phong's lobes and microfacets.
        _ => [false, m.color.iter().any(|c| *c != [0.0; 3])],
    }
}

impl Facts {
    fn of(scene: &Scene<'_>) -> Self {
        let mut facts = Self::default();
        for e in scene.emitters() {
            facts.light = true;
            facts.dirac_light |= matches!(
                e.kind,
                emitter::POINT | emitter::SPOT | emitter::DIRECTIONAL
            );
        }
        for shape in scene.shapes() {
            for m in [shape.front, shape.back]
                .into_iter()
                .filter_map(|id| scene.materials().get(id as usize))
            {
                let [dirac, smooth] = lobes(scene, m);
                facts.dirac |= dirac;
                facts.smooth |= smooth;
            }
        }
        let scatters = |m: &etendue::blob::format::Medium| {
            m.albedo != [0.0; 3]
                && m.sigma_t != [0.0; 3]
                && m.phase
                    .iter()
                    .any(|l| l.kind != medium::FORWARD && l.weight > 0.0)
        };
        facts.smooth |= scene.media().iter().any(scatters);
        facts.parallel =
            scene.world().background != NONE && scene.sensor().kind == sensor::ORTHOGRAPHIC;
        facts
    }
}

const CAUSTICS: &str = "light of point, spot and directional lights that meets a mirror or smooth glass before anything else (their caustics, and all behind glass) is missing";
const SEEN_IN_MIRRORS: &str = "what the sensor sees in a mirror or through smooth glass is missing: choose path or bidirectional";

/// The light paths that `settings`' estimator can't make in `scene`, a sentence each with its cure; none if it makes all.
pub fn unreachable(scene: &Scene<'_>, settings: &Settings) -> Vec<String> {
    let facts = Facts::of(scene);
    let mut out = Vec::new();
    if !facts.light {
        return out;
    }
    let caustics = facts.dirac_light && facts.dirac && facts.smooth;
    match settings.estimator {
        Estimator::Path | Estimator::QuadratureAndPath if caustics => {
            out.push(format!(
                "{CAUSTICS}: choose light or bidirectional, or give the light a size"
            ));
        }
        Estimator::Light => {
            if facts.dirac {
                out.push(SEEN_IN_MIRRORS.into());
            }
            if facts.parallel {
                out.push("the background that the sensor sees directly is missing, as its rays are parallel: choose path or bidirectional".into());
            }
        }
        Estimator::Bidirectional | Estimator::Metropolis if caustics => {
            out.push("light of point, spot and directional lights that comes to a surface through a mirror or smooth glass, and from there to the sensor through one again, is missing (caustics seen in mirrors or through glass): give the light a size".into());
        }
        Estimator::Distributed => {
            if caustics {
                out.push(format!(
                    "{CAUSTICS}: choose light or bidirectional, or give the light a size"
                ));
            }
            let most = settings.tree.levels() + 1;
            if settings.max_edges.is_none_or(|n| n > most) {
                out.push(format!("paths of more than {most} edges are missing: choose path, or more levels by --branching"));
            }
        }
        Estimator::Quadrature => {
            if caustics {
                out.push(format!(
                    "{CAUSTICS}: choose light or bidirectional, or give the light a size"
                ));
            }
            if facts.smooth && settings.max_edges.is_none_or(|n| n > 2) {
                out.push("light that surfaces or media have scattered twice or more is missing, but by mirrors and smooth glass on the way to the sensor: choose quadrature+path".into());
            }
            // Nor has scratch room for more than levels.
            let most = u32::from(settings.rule.depth).min(LEVELS as u32);
            if facts.dirac && settings.max_edges.is_none_or(|n| n > most + 1) {
                out.push(format!(
                    "what is seen by more than {most} mirrors or faces of glass, one after the other, is missing: choose quadrature+path"
                ));
            }
        }
        _ => {}
    }
    out
}
