//! Light that comes through glass, seen through glass: nothing but a walk from the sensor that runs into the light makes such a path.

use super::Complete::FromSensor;
use super::Named;
use crate::scenes::Builder;
use etendue_host::description::{Description, EmitterKind, Medium, Phase};

/// Things under one pane, which is the floor's only sky, seen through another; what shines is above.
fn under_glass(shines: impl FnOnce(&mut Builder)) -> Description {
    let mut b = Builder::new().camera(
        [0.0, -3.0, 1.2],
        [0.0, 0.0, 0.4],
        [0.0, 0.0, 1.0],
        36.0,
        [16, 16],
    );
    let glass = Some(b.glass(1.5));
    let grey = Some(b.diffuse([0.5, 0.6, 0.7]));
    b.quad([-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], grey);
    b.cuboid([-0.6, 0.0, 0.0], [-0.1, 0.5, 0.5], false, grey);
    let mirror = Some(b.mirror(0.9));
    b.sphere([0.45, -0.1, 0.3], 0.25, mirror);
    b.cuboid([-1.5, -1.5, 1.3], [1.5, 1.5, 1.4], false, glass);
    b.cuboid([-1.5, -1.8, -0.5], [1.5, -1.7, 2.5], false, glass);
    shines(&mut b);
    b.description
}

/// A lamp, the sky and a flame.
pub fn panes() -> Vec<Named> {
    let lamp = under_glass(|b| {
        let black = Some(b.diffuse([0.0; 3]));
        b.sphere([0.2, 0.3, 2.6], 0.9, black).emission = Some([3.0, 2.0, 1.0]);
    });
    let sky = under_glass(|b| {
        b.light(EmitterKind::Constant {
            radiance: [0.4, 0.5, 0.6],
        });
    });
    let flame = under_glass(|b| {
        let fog = b.medium([0.5, 0.4, 0.3], [0.9, 0.8, 0.7], Phase::Isotropic);
        b.fog([-1.2, -1.2, -0.2], [1.2, 1.2, 1.2], fog);
        let null = b.null();
        let flame = b.matter(Medium {
            sigma_t: [2.0, 1.0, 0.5],
            albedo: [0.3, 0.5, 0.2],
            emission: [9.0, 5.0, 2.0],
            phase: vec![Phase::Isotropic.into()],
            ..Medium::default()
        });
        b.ball([0.2, 0.3, 2.6], 0.9, null, flame);
    });
    vec![
        ("a lamp behind panes", lamp, FromSensor),
        ("the sky behind panes", sky, FromSensor),
        ("a flame behind panes, and fog", flame, FromSensor),
    ]
}
