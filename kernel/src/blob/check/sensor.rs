//! The sensor.

use super::rules::{
    Checked, MAX_COORDINATE, coordinates, ensure, finite, optional, unit, within, zeros,
};
use crate::blob::format::{Sensor, sensor};
use crate::blob::rule::Rule;
use crate::blob::scene::Scene;
use crate::real::vec3;

pub(super) fn sensor(scene: &Scene<'_>, s: &Sensor) -> Checked {
    ensure(s.kind <= sensor::PANORAMA, Rule::SensorKind)?;
    let panorama = s.kind == sensor::PANORAMA;
    ensure(cfg!(feature = "panorama") || !panorama, Rule::SensorLeftOut)?;
    ensure(s.filter <= sensor::GAUSSIAN, Rule::SensorFilter)?;
    within(&[s.filter_radius], 1e-3, 8.0, Rule::SensorFilterRadius)?;
    let gaussian = s.filter == sensor::GAUSSIAN;
    let least = if gaussian { 1e-3 } else { 0.0 };
    within(&[s.filter_sigma], least, 8.0, Rule::SensorFilterSigma)?;
    let fits = s.resolution.iter().all(|&n| n <= 1 << 16);
    ensure(fits, Rule::SensorResolution)?;
    for ((&offset, &size), &all) in s.crop_offset.iter().zip(&s.crop_size).zip(&s.resolution) {
        let end = offset.checked_add(size);
        let inside = size >= 1 && end.is_some_and(|end| end <= all);
        ensure(inside, Rule::SensorCrop)?;
    }
    within(&s.half_extent, 1e-9, MAX_COORDINATE, Rule::SensorExtent)?;
    within(&[s.aperture], 0.0, MAX_COORDINATE, Rule::SensorAperture)?;
    within(&[s.focus], 1e-9, MAX_COORDINATE, Rule::SensorFocus)?;
    within(&s.clip, 0.0, f32::MAX, Rule::SensorClip)?;
    ensure(s.clip[0] < s.clip[1], Rule::SensorClipOrder)?;
    coordinates(&s.origin, Rule::SensorOrigin)?;
    finite(&s.principal, Rule::SensorPrincipal)?;
    unit(&s.right, Rule::SensorRight)?;
    unit(&s.down, Rule::SensorDown)?;
    unit(&s.forward, Rule::SensorForward)?;
    let axes = [(s.right, s.down), (s.down, s.forward), (s.forward, s.right)];
    let perpendicular = |(a, b): ([f32; 3], [f32; 3])| vec3(a).dot(vec3(b)).abs() <= 1e-3;
    let whole = !panorama || axes.into_iter().all(perpendicular);
    ensure(whole, Rule::SensorAxes)?;
    optional(s.medium, scene.media.len(), Rule::SensorMedium)?;
    zeros(&s.reserved, Rule::SensorReserved)
}
