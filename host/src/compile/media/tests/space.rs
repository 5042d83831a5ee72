//! Which medium is where.

use super::ball;
use crate::compile::{Compiled, compile};
use crate::description::{
    ColorSource, Description, Emitter, EmitterKind, Geometry, Material, Medium, Mesh, Model, Place,
    Shape,
};
use etendue::Scene;
use etendue::blob::format::NONE;

/// Media 0 and 1, materials 0 (null) and 1 (opaque), nothing else; the camera at the origin.
fn nothing() -> Description {
    let mut d = ball(Medium {
        sigma_t: [1.0; 3],
        ..Medium::default()
    });
    d.shapes.clear();
    let milk = Medium {
        name: "milk".into(),
        ..d.media[0].clone()
    };
    d.media.push(milk);
    d.materials.push(Material {
        name: "wall".into(),
        model: Model::Diffuse {
            reflectance: ColorSource::Constant([0.5; 3]),
            transmittance: ColorSource::Constant([0.0; 3]),
        },
    });
    d
}

fn add(d: &mut Description, name: &str, geometry: Geometry, sides: [Option<usize>; 2]) {
    d.shapes.push(Shape {
        name: name.into(),
        place: Place::default(),
        geometry,
        front: Some(0),
        back: Some(0),
        emission: None,
        spectrum: None,
        opacity: None,
        interior: sides[0],
        exterior: sides[1],
    });
}

fn sphere(center: [f32; 3], radius: f32) -> Geometry {
    Geometry::Sphere {
        center,
        radius,
        flipped: false,
    }
}

/// A box; its first `faces` faces of six.
fn cuboid(low: [f32; 3], high: [f32; 3], faces: usize) -> Geometry {
    let positions =
        (0..8).map(|i| std::array::from_fn(|a| if i >> a & 1 == 0 { low[a] } else { high[a] }));
    let all = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    Geometry::Mesh(Mesh {
        positions: positions.collect(),
        normals: None,
        uvs: None,
        triangles: all[..faces]
            .iter()
            .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]])
            .collect(),
    })
}

fn lamp(d: &mut Description, position: [f32; 3], medium: Option<usize>) {
    d.emitters.push(Emitter {
        spectrum: None,
        name: "lamp".into(),
        place: Place::default(),
        kind: EmitterKind::Point {
            position,
            intensity: [1.0; 3],
        },
        medium,
    });
}

fn sky(d: &mut Description) {
    d.emitters.push(Emitter {
        spectrum: None,
        name: "sky".into(),
        place: Place {
            file: "s.xml".into(),
            line: 7,
        },
        kind: EmitterKind::Constant { radiance: [1.0; 3] },
        medium: None,
    });
}

/// Media of the exterior, the sensor and the emitters.
fn found(d: &Description) -> (Vec<u32>, Vec<String>) {
    let Compiled { blob, warnings, .. } = compile(d).unwrap_or_else(|e| panic!("{e}"));
    let scene = Scene::open(blob.bytes()).unwrap();
    let mut media = vec![scene.world().exterior, scene.sensor().medium];
    media.extend(scene.emitters().iter().map(|e| e.medium));
    (media, warnings)
}

fn refusal(d: &Description) -> String {
    compile(d).expect_err("a refusal").to_string()
}

#[test]
fn the_medium_at_camera_and_lights_is_that_of_the_objects_around_them() {
    let mut d = nothing();
    add(
        &mut d,
        "fog",
        cuboid([-2.0; 3], [2.0; 3], 6),
        [Some(0), None],
    );
    add(
        &mut d,
        "ball",
        sphere([0.0, 0.0, 1.0], 0.5),
        [Some(1), Some(0)],
    );
    lamp(&mut d, [0.0, 0.0, 1.0], None);
    lamp(&mut d, [0.0, 0.0, 9.0], None);
    lamp(&mut d, [1.5, 1.5, 1.5], None);
    assert_eq!(found(&d), (vec![NONE, 0, 1, NONE, 0], vec![]));
    // What is right may be said.
    (d.sensor.medium, d.emitters[0].medium) = (Some(0), Some(1));
    assert_eq!(found(&d), (vec![NONE, 0, 1, NONE, 0], vec![]));
}

/// On a face, on an edge of its triangles, on a corner, on a sphere; and not a little off them.
#[test]
fn what_stands_in_a_boundary_is_warned_of() {
    let mut d = nothing();
    add(
        &mut d,
        "fog",
        cuboid([-2.0; 3], [2.0; 3], 6),
        [Some(0), None],
    );
    add(&mut d, "ball", sphere([0.0; 3], 1.0), [Some(1), Some(0)]);
    let warned = |d: &Description| {
        let (_, warnings) = found(d);
        warnings
            .iter()
            .map(|w| w.split(':').next().unwrap().to_owned())
            .collect::<Vec<_>>()
    };
    for (at, on) in [
        ([2.0, 0.3, 0.7], "fog"),
        ([0.0, 0.0, -2.0], "fog"),
        ([2.0; 3], "fog"),
        ([0.0, 1.0, 0.0], "ball"),
    ] {
        d.sensor.origin = at;
        let text = format!("the sensor stands in the boundary {on}");
        assert_eq!(warned(&d), [text], "{at:?}");
        d.sensor.origin = at.map(|x| 1.001 * x);
        assert_eq!(warned(&d), [""; 0], "{at:?}");
    }
    lamp(&mut d, [0.0, 0.0, 2.0], None);
    assert_eq!(warned(&d), ["lamp stands in the boundary fog"]);
}

#[test]
fn opaque_things_without_media_stand_in_any() {
    let mut d = nothing();
    add(
        &mut d,
        "fog",
        cuboid([-2.0; 3], [2.0; 3], 6),
        [Some(0), None],
    );
    // A closed room in the fog, the camera in it; a table that sticks out of the fog.
    for (name, g) in [
        ("room", cuboid([-1.0; 3], [1.0; 3], 6)),
        ("table", cuboid([1.5, -1.0, -1.0], [3.0, 1.0, 1.0], 6)),
    ] {
        add(&mut d, name, g, [None, None]);
        let shape = d.shapes.last_mut().unwrap();
        (shape.front, shape.back) = (Some(1), Some(1));
    }
    lamp(&mut d, [0.5, 0.5, 0.5], None);
    assert_eq!(found(&d), (vec![NONE, 0, 0], vec![]));
}

#[test]
fn the_exterior_is_what_the_outermost_objects_are_met_from() {
    let mut d = nothing();
    add(
        &mut d,
        "bubble",
        sphere([0.0, 0.0, 5.0], 1.0),
        [None, Some(0)],
    );
    lamp(&mut d, [0.0, 0.0, 5.0], None);
    assert_eq!(found(&d), (vec![0, 0, NONE], vec![]));
    sky(&mut d);
    let text = refusal(&d);
    assert!(
        text.starts_with("s.xml:7: sky: nothing would arrive"),
        "{text}"
    );
    assert!(text.contains("medium wax"), "{text}");
    // A vacuum fills no space: what it takes away is nothing.
    d.media[0].sigma_t = [0.0; 3];
    assert_eq!(found(&d).0[0], 0);
}

#[test]
fn where_nothing_parts_media_the_same_is_everywhere() {
    let mut d = nothing();
    d.sensor.medium = Some(1);
    lamp(&mut d, [0.0; 3], None);
    assert_eq!(found(&d), (vec![1, 1, 1], vec![]));
    d.emitters[0].medium = Some(0);
    let (media, warnings) = found(&d);
    assert_eq!(media, [1, 1, 0]);
    assert_eq!(
        warnings,
        [
            "lamp stands in medium wax, but nothing parts it from the sensor, which holds medium milk"
        ]
    );
    d.media[1].emission = [1.0; 3];
    assert!(refusal(&d).contains("milk: emits and fills the space outside"));
}

#[test]
fn a_medium_said_against_the_objects_is_warned_of() {
    let mut d = nothing();
    add(&mut d, "fog", sphere([0.0; 3], 2.0), [Some(0), None]);
    d.sensor.medium = Some(1);
    let (media, warnings) = found(&d);
    assert_eq!(media, [NONE, 1]);
    assert_eq!(
        warnings,
        ["the sensor is said to stand in medium milk, but fog around it says medium wax"]
    );
}

#[test]
fn objects_may_nest_touch_and_stand_apart() {
    let mut d = nothing();
    add(
        &mut d,
        "glass",
        cuboid([-2.0; 3], [2.0; 3], 6),
        [Some(0), None],
    );
    // Its six faces lie in the glass' wall, split another way; its sides touch its neighbour's.
    add(
        &mut d,
        "left",
        cuboid([2.0, -2.0, -2.0], [3.0, 2.0, 2.0], 6),
        [Some(1), None],
    );
    add(
        &mut d,
        "on top",
        sphere([0.0, 0.0, 4.0], 2.0),
        [Some(1), None],
    );
    add(&mut d, "inside", sphere([0.0; 3], 1.0), [Some(1), Some(0)]);
    add(
        &mut d,
        "within",
        sphere([0.3, 0.0, 0.0], 0.5),
        [Some(0), Some(1)],
    );
    assert_eq!(found(&d).1, Vec::<String>::new());
}

/// Glass that touches glass, and a box made of two that touch.
#[test]
fn boundaries_in_one_place_that_cannot_be_set_apart_are_named() {
    let mut d = nothing();
    let sides = [Some(0), None];
    add(&mut d, "left", cuboid([-2.0; 3], [2.0; 3], 6), sides);
    let next = ([2.0, -1.0, -1.0], [3.0, 1.0, 1.0]);
    add(&mut d, "right", cuboid(next.0, next.1, 6), [Some(1), None]);
    d.materials.push(Material {
        name: "glass".into(),
        model: Model::Dielectric {
            ior: 1.5,
            reflectance: ColorSource::Constant([1.0; 3]),
            transmittance: ColorSource::Constant([1.0; 3]),
            schlick: false,
        },
    });
    for s in &mut d.shapes {
        (s.front, s.back) = (Some(2), Some(2));
    }
    let said = "left and right part media in one place: a ray meets one of the two boundaries, and may go on in the wrong medium; give the one that is to be met both media, or leave a gap";
    assert_eq!(found(&d).1, [said]);
    // Where one of them is nothing but a boundary, that one makes way.
    for i in 0..2 {
        (d.shapes[i].front, d.shapes[i].back) = (Some(0), Some(0));
        assert_eq!(found(&d).1, Vec::<String>::new());
        (d.shapes[i].front, d.shapes[i].back) = (Some(2), Some(2));
    }
    let mut d = nothing();
    let Geometry::Mesh(mut both) = cuboid([-2.0; 3], [2.0; 3], 6) else {
        return;
    };
    if let Geometry::Mesh(other) = cuboid(next.0, next.1, 6) {
        both.triangles
            .extend(other.triangles.iter().map(|t| t.map(|v| v + 8)));
        both.positions.extend(other.positions);
    }
    add(&mut d, "both", Geometry::Mesh(both), sides);
    let [one] = &found(&d).1[..] else {
        panic!("one warning");
    };
    assert!(
        one.starts_with("two parts of both part media in one place"),
        "{one}"
    );
}

#[test]
fn objects_that_overlap_are_refused_with_both_their_names() {
    let mut d = nothing();
    add(
        &mut d,
        "cup",
        cuboid([-2.0; 3], [2.0; 3], 6),
        [Some(0), None],
    );
    add(
        &mut d,
        "spoon",
        sphere([2.0, 0.0, 0.0], 0.3),
        [Some(1), None],
    );
    let text = refusal(&d);
    assert!(
        text.contains("cup") && text.contains("spoon") && text.contains("overlaps"),
        "{text}"
    );
    // Of the same medium they may not either: light would leave it at the first boundary.
    d.shapes[1].interior = Some(0);
    assert!(refusal(&d).contains("overlaps"));
    // Nested without saying so.
    d.shapes[1].geometry = sphere([0.0; 3], 0.3);
    assert!(
        refusal(&d).contains("spoon is met in vacuum"),
        "{}",
        refusal(&d)
    );
    d.shapes[1].exterior = Some(0);
    assert_eq!(found(&d).1, Vec::<String>::new());
}

#[test]
fn a_small_overlap_far_from_everything_is_found() {
    let mut d = nothing();
    add(
        &mut d,
        "fog",
        cuboid([-100.0; 3], [100.0; 3], 6),
        [Some(0), None],
    );
    add(
        &mut d,
        "pill",
        sphere([30.0, 50.0, 0.0], 0.5),
        [Some(1), Some(0)],
    );
    add(
        &mut d,
        "grain",
        sphere([30.5, 50.0, 0.0], 0.2),
        [Some(0), Some(1)],
    );
    let text = refusal(&d);
    assert!(text.contains("pill") && text.contains("grain"), "{text}");
}

#[test]
fn a_boundary_with_a_hole_is_warned_of() {
    let mut d = nothing();
    add(
        &mut d,
        "tub",
        cuboid([-2.0; 3], [2.0; 3], 5),
        [Some(0), None],
    );
    let (_, warnings) = found(&d);
    assert!(!warnings.is_empty());
    for w in warnings {
        assert!(w.starts_with("tub parts media but isn't closed: "), "{w}");
    }
    // With a lid it is one surface, of two objects.
    let Geometry::Mesh(whole) = cuboid([-2.0; 3], [2.0; 3], 6) else {
        panic!()
    };
    let lid = Mesh {
        triangles: whole.triangles[10..].to_vec(),
        ..whole
    };
    add(&mut d, "lid", Geometry::Mesh(lid), [Some(0), None]);
    assert_eq!(found(&d).1, Vec::<String>::new());
}

#[test]
fn light_is_parted_where_it_is_on_any_scale_and_anywhere() {
    for (scale, shift) in [(1e-4, 0.0), (1e6, 0.0), (1.0, 1e4)] {
        let mut d = nothing();
        let at = |x: f32| x * scale + shift;
        let low = [at(-2.0); 3];
        add(&mut d, "fog", cuboid(low, [at(2.0); 3], 6), [Some(0), None]);
        add(
            &mut d,
            "next",
            cuboid([at(2.0), low[1], low[2]], [at(3.0), at(2.0), at(2.0)], 6),
            [Some(1), None],
        );
        add(
            &mut d,
            "ball",
            sphere([at(0.0); 3], scale),
            [Some(1), Some(0)],
        );
        d.sensor.origin = [at(1.5); 3];
        let (media, warnings) = found(&d);
        assert_eq!(media, vec![NONE, 0], "{scale} {shift}");
        assert_eq!(warnings, Vec::<String>::new());
        d.shapes[1].exterior = Some(1);
        refusal(&d);
    }
}
