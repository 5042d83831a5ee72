//! What is loaded, and to which values.

use super::*;

#[test]
fn transforms_act_in_the_order_listed() {
    let p = glam::DVec3::new(1.0, 2.0, 3.0);
    let m =
        matrix("<rotate z='1' angle='90'/><matrix value='1 0 0 10 0 1 0 20 0 0 1 30 0 0 0 1'/>");
    assert!(close(m.transform_point3(p), [8.0, 21.0, 33.0]));
    let m =
        matrix("<matrix value='1 0 0 10 0 1 0 20 0 0 1 30 0 0 0 1'/><rotate z='1' angle='90'/>");
    assert!(close(m.transform_point3(p), [-22.0, 11.0, 33.0]));
    let m = matrix("<scale value='2'/><translate value='1, 0 0'/><scale x='-1'/>");
    assert!(close(m.transform_point3(p), [-3.0, 4.0, 6.0]));
    let m = matrix("<matrix value='0 1 0 0 0 1 1 0 0'/>");
    assert!(close(m.transform_point3(p), [2.0, 3.0, 1.0]));
}

#[test]
fn lookat_puts_x_left_y_up_z_forward() {
    for name in ["lookat", "lookAt"] {
        let m = matrix(&format!(
            "<{name} origin='0, 0, 5' target='0, 0, 0' up='0, 2, 0'/>"
        ));
        assert!(close(
            m.transform_point3(glam::DVec3::ZERO),
            [0.0, 0.0, 5.0]
        ));
        assert!(close(m.transform_vector3(glam::DVec3::Z), [0.0, 0.0, -1.0]));
        assert!(close(m.transform_vector3(glam::DVec3::X), [-1.0, 0.0, 0.0]));
        assert!(close(m.transform_vector3(glam::DVec3::Y), [0.0, 1.0, 0.0]));
    }
}

#[test]
fn the_sensor_faces_local_z() {
    let text = "<scene version='3.0.0'><sensor type='perspective'>
        <float name='fov' value='90'/><string name='fov_axis' value='smaller'/>
        <float name='principal_point_offset_x' value='0.25'/>
        <transform name='to_world'><lookat origin='0 0 5' target='0 0 0' up='0 1 0'/></transform>
        <film type='hdrfilm'><integer name='width' value='200'/><integer name='height' value='100'/>
        <integer name='crop_offset_x' value='20'/><integer name='crop_height' value='50'/>
        <rfilter type='tent'/></film>
        <sampler type='independent'><integer name='sample_count' value='16'/></sampler>
        </sensor><integrator type='path'><integer name='max_depth' value='7'/></integrator></scene>";
    let loaded = try_in(&folder(&[("scene.xml", text)]), &[]).expect("a scene");
    let sensor = &loaded.description.sensor;
    assert_eq!(
        (sensor.right, sensor.down),
        ([1.0, -0.0, -0.0], [-0.0, -1.0, -0.0])
    );
    assert_eq!(
        (sensor.forward, sensor.origin),
        ([0.0, 0.0, -1.0], [0.0, 0.0, 5.0])
    );
    let Projection::Perspective {
        half_tangent,
        aperture,
        ..
    } = sensor.projection
    else {
        panic!()
    };
    assert!((half_tangent[0] - 2.0).abs() < 1e-6 && (half_tangent[1] - 1.0).abs() < 1e-6);
    assert_eq!((aperture, sensor.principal), (0.0, [0.25, 0.0]));
    assert_eq!(sensor.crop, Some([20, 0, 180, 50]));
    assert_eq!(sensor.filter, Filter::Tent { radius: 1.0 });
    let advice = loaded.description.advice;
    assert_eq!((advice.max_depth, advice.samples), (Some(7), Some(16)));
}

#[test]
fn materials_stand_on_their_sides() {
    let sides = |bsdf: &str| {
        let loaded = material(bsdf).unwrap_or_else(|e| panic!("{e}"));
        let shape = &loaded.description.shapes[0];
        (shape.front, shape.back, loaded.description.materials)
    };
    let (front, back, materials) = sides("");
    assert_eq!((front, back), (Some(0), None));
    let grey = |g: f32| ColorSource::Constant([g; 3]);
    assert!(
        matches!(materials[0].model, Model::Diffuse { reflectance, .. } if reflectance == grey(0.5))
    );
    let (front, back, _) = sides("<bsdf type='twosided'><bsdf type='diffuse'/></bsdf>");
    assert_eq!((front, back), (Some(0), Some(0)));
    let (front, back, _) =
        sides("<bsdf type='twosided'><bsdf type='diffuse'/><bsdf type='conductor'/></bsdf>");
    assert_eq!((front, back), (Some(0), Some(1)));
    let (front, back, materials) = sides(
        "<bsdf type='dielectric'><string name='int_ior' value='diamond'/><float name='ext_ior' value='1'/></bsdf>",
    );
    assert_eq!((front, back), (Some(0), Some(0)));
    assert!(matches!(
        materials[0].model,
        Model::Dielectric {
            ior: 2.419,
            schlick: false,
            ..
        }
    ));
    let (_, back, materials) =
        sides("<bsdf type='conductor'><string name='material' value='none'/></bsdf>");
    assert_eq!(back, None);
    assert!(matches!(materials[0].model, Model::Mirror { .. }));
    let (.., materials) = sides(
        "<bsdf type='conductor'><string name='material' value='Au'/><float name='ext_eta' value='2'/></bsdf>",
    );
    assert!(
        matches!(materials[0].model, Model::Conductor { eta, .. } if (eta[0] - 0.143119 / 2.0).abs() < 1e-6)
    );
    let (.., materials) = sides(
        "<bsdf type='conductor'><spectrum name='eta' value='400:1, 600:3'/><float name='k' value='4'/><float name='ext_eta' value='2'/></bsdf>",
    );
    let Model::Conductor {
        eta, k, spectra, ..
    } = &materials[0].model
    else {
        panic!()
    };
    let tables = [vec![[400.0, 0.5], [600.0, 1.5]], vec![[550.0, 2.0]]];
    assert_eq!(spectra.as_ref(), Some(&tables));
    // More of it at long wavelengths; the same everywhere is the same to all channels.
    assert!(
        eta[0] > eta[1] && eta[1] > eta[2] && eta[2] > 0.5,
        "{eta:?}"
    );
    assert!(k.iter().all(|k| (k / 2.0 - 1.0).abs() < 1e-3));
    // A step at which what is seen of it is beyond the gamut: still an index.
    let (.., materials) = sides(
        "<bsdf type='conductor'><spectrum name='eta' value='590:0.1, 600:3'/><float name='k' value='4'/></bsdf>",
    );
    let Model::Conductor { eta, .. } = &materials[0].model else {
        panic!()
    };
    assert!(
        eta.iter().all(|e| (0.1..=3.0).contains(e)) && eta[2] == 0.1,
        "{eta:?}"
    );
    let (front, back, materials) = sides("<bsdf type='null'/>");
    assert_eq!((front, back), (Some(0), Some(0)));
    assert!(matches!(materials[0].model, Model::Null));
    let (.., materials) =
        sides("<bsdf type='diffuse'><rgb name='reflectance' value='#ff8000'/></bsdf>");
    let Model::Diffuse {
        reflectance: ColorSource::Constant(c),
        ..
    } = materials[0].model
    else {
        panic!()
    };
    assert!(c[0] == 1.0 && (c[1] - 0.215_861).abs() < 1e-5 && c[2] == 0.0);
    let (.., materials) =
        sides("<bsdf type='diffuse'><spectrum name='reflectance' value='0.25'/></bsdf>");
    assert!(
        matches!(materials[0].model, Model::Diffuse { reflectance, .. } if reflectance == grey(0.25))
    );
    let masked =
        material("<bsdf type='mask'><float name='opacity' value='.25'/><bsdf type='null'/></bsdf>");
    assert_eq!(
        masked.expect("mask").description.shapes[0].opacity,
        Some(grey(0.25))
    );
}

#[test]
fn defaults_defines_and_includes() {
    let files = [
        (
            "scene.xml",
            "<scene version='3.0.0'><default name='r' value='2'/><default name='ra' value='5'/>
             <include filename='part.xml'/><shape type='sphere'><float name='radius' value='$ra'/></shape></scene>",
        ),
        (
            "part.xml",
            "<scene version='3.0.0'><sensor type='perspective'/><bsdf type='null' id='n'/>
             <alias id='n' as='m'/><shape type='sphere'><float name='radius' value='$r'/><ref id='m'/></shape></scene>",
        ),
        ("loop.xml", "<scene version='3.0.0'><include filename='loop.xml'/></scene>"),
    ];
    let dir = folder(&files);
    let radii = |defines: &[(&str, &str)]| -> Vec<f32> {
        let loaded = try_in(&dir, defines).unwrap_or_else(|e| panic!("{e}"));
        let radius = |s: &Shape| match s.geometry {
            Geometry::Sphere { radius, .. } => radius,
            _ => 0.0,
        };
        loaded.description.shapes.iter().map(radius).collect()
    };
    assert_eq!(radii(&[]), [2.0, 5.0]);
    assert_eq!(radii(&[("r", "7")]), [7.0, 5.0]);
    let unused = try_in(&dir, &[("q", "1")]).expect_err("unused");
    assert!(
        unused.contains("a use for the value given for $q is missing"),
        "{unused}"
    );
    let cycle = load(&dir.path().join("loop.xml"), &[])
        .expect_err("cycle")
        .to_string();
    assert!(
        cycle.contains("one that isn't including this one"),
        "{cycle}"
    );
}

#[test]
fn mirrored_shapes_keep_their_outside() {
    for (kind, steps) in [
        ("cube", "<scale x='-2'/>"),
        ("cube", "<scale y='3'/>"),
        ("rectangle", "<scale x='-1'/>"),
    ] {
        let body =
            format!("<shape type='{kind}'><transform name='to_world'>{steps}</transform></shape>");
        let loaded = good(&body);
        let mesh = first_mesh(&loaded);
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| glam::Vec3::from(mesh.positions[i as usize]));
            let normal = (b - a).cross(c - a);
            let outside = if kind == "cube" {
                a + b + c
            } else {
                glam::Vec3::Z
            };
            assert!(normal.dot(outside) > 0.0, "{kind} {steps} {t:?}");
        }
    }
    let flipped =
        good("<shape type='rectangle'><boolean name='flip_normals' value='true'/></shape>");
    let mesh = first_mesh(&flipped);
    let [a, b, c] = mesh.triangles[0].map(|i| glam::Vec3::from(mesh.positions[i as usize]));
    assert!((b - a).cross(c - a).z < 0.0);
    let sphere = |steps: &str| {
        let body =
            format!("<shape type='sphere'><transform name='to_world'>{steps}</transform></shape>");
        match good(&body).description.shapes[0].geometry {
            Geometry::Sphere {
                center,
                radius,
                flipped,
            } => (center, radius, flipped),
            _ => panic!(),
        }
    };
    assert_eq!(
        sphere("<translate x='1'/><scale value='2'/>"),
        ([2.0, 0.0, 0.0], 2.0, false)
    );
    assert!(sphere("<scale x='-1'/>").2);
    let disc = good("<shape type='disk'><emitter type='area'/></shape>");
    assert!(disc.warnings[0].contains("drawn as 256 triangles"));
    let mesh = first_mesh(&disc);
    let area: f32 = mesh
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| glam::Vec3::from(mesh.positions[i as usize]));
            (b - a).cross(c - a).z / 2.0
        })
        .sum();
    assert!((area - std::f32::consts::PI).abs() < 1e-4, "{area}");
}

#[test]
fn meshes_take_their_normals_and_sides_from_files() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/3/1\n";
    let load_obj = |obj: &str, inner: &str| {
        let body =
            format!("<shape type='obj'><string name='filename' value='m.obj'/>{inner}</shape>");
        let dir = folder(&[("scene.xml", &scene(&body)), ("m.obj", obj)]);
        try_in(&dir, &[]).map(|l| (first_mesh(&l).clone(), l.warnings))
    };
    let (mesh, _) = load_obj(obj, "").expect("obj");
    assert_eq!(mesh.uvs, Some(vec![[0.0, 1.0], [1.0, 1.0], [0.0, 0.0]]));
    assert_eq!(mesh.normals, Some(vec![[0.0, 0.0, 1.0]; 3]));
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    let mirror = "<transform name='to_world'><scale x='-1' z='.5'/></transform>";
    let (mesh, _) = load_obj(obj, mirror).expect("mirrored");
    assert_eq!(
        (mesh.triangles[0], mesh.normals.expect("normals")[0]),
        ([0, 2, 1], [0.0, 0.0, 1.0])
    );
    let flat = "<boolean name='face_normals' value='true'/>";
    let (mesh, _) = load_obj(obj, &format!("{flat}{mirror}")).expect("flat");
    assert_eq!((mesh.triangles[0], mesh.normals), ([0, 1, 2], None));
    let (mesh, _) =
        load_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4", "").expect("bare");
    let s = std::f32::consts::FRAC_1_SQRT_2;
    let normals = mesh.normals.expect("computed");
    assert!(
        (normals[0][0] - s).abs() < 1e-6
            && (normals[0][2] - s).abs() < 1e-6
            && normals[1] == [0.0, 0.0, 1.0]
    );
    let light = "<emitter type='area'/>";
    let error = load_obj("v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3", light).expect_err("no area");
    assert!(error.contains("triangles of no area"), "{error}");
    let error = load_obj("v 0 0 0\n", "").expect_err("no triangle");
    assert_eq!(error, "m.obj: mesh has 0 triangles, expected at least 1");
}

#[test]
fn lights_and_their_frames() {
    let loaded = good(
        "<emitter type='spot'><transform name='to_world'><lookat origin='0 5 0' target='0 0 0' up='1 0 0'/></transform>
         </emitter><emitter type='directional'><vector name='direction' x='0' y='-2'/></emitter>
         <emitter type='point'><transform name='to_world'><translate y='3'/></transform></emitter>",
    );
    let kinds: Vec<_> = loaded
        .description
        .emitters
        .iter()
        .map(|e| &e.kind)
        .collect();
    let EmitterKind::Spot {
        position,
        direction,
        cutoff,
        beam_width,
        ..
    } = kinds[0]
    else {
        panic!()
    };
    assert_eq!((*position, *direction), ([0.0, 5.0, 0.0], [0.0, -1.0, 0.0]));
    assert!(
        (cutoff.to_degrees() - 20.0).abs() < 1e-4 && (beam_width.to_degrees() - 15.0).abs() < 1e-4
    );
    assert!(matches!(
        kinds[1],
        EmitterKind::Directional {
            direction: [0.0, -1.0, 0.0],
            ..
        }
    ));
    assert!(matches!(
        kinds[2],
        EmitterKind::Point {
            position: [0.0, 3.0, 0.0],
            ..
        }
    ));
}

#[test]
fn images_keep_their_meaning() {
    let env = "<emitter type='envmap'><string name='filename' value='e.png'/><float name='scale' value='2'/>
        <transform name='to_world'><rotate y='1' angle='90'/></transform></emitter>
        <shape type='rectangle'><bsdf type='diffuse'><texture name='reflectance' type='bitmap'>
        <string name='filename' value='e.png'/><string name='wrap_mode' value='mirror'/>
        <transform name='to_uv'><scale x='2' y='3'/><translate x='.5'/></transform></texture></bsdf></shape>
        <shape type='rectangle'><bsdf type='mask'><texture name='opacity' type='bitmap'>
        <string name='filename' value='e.png'/><boolean name='raw' value='true'/></texture><bsdf type='null'/></bsdf></shape>";
    let dir = folder(&[("scene.xml", &scene(env))]);
    png(
        &dir.path().join("e.png"),
        2,
        &[[255, 0, 0], [0, 255, 0], [128, 128, 128], [0, 0, 0]],
    );
    let loaded = try_in(&dir, &[]).unwrap_or_else(|e| panic!("{e}"));
    let EmitterKind::LatLong {
        texels,
        scale,
        to_local,
        ..
    } = &loaded.description.emitters[0].kind
    else {
        panic!()
    };
    assert!(
        texels[0] == [1.0, 0.0, 0.0] && (texels[2][0] - 0.215_861).abs() < 1e-5 && *scale == 2.0
    );
    // Turned by 90° about y, the image's x axis lies along −z.
    assert!(
        (to_local[0][2] + 1.0).abs() < 1e-6 && (to_local[2][0] - 1.0).abs() < 1e-6,
        "{to_local:?}"
    );
    let texture = &loaded.description.textures[0];
    assert_eq!(texture.to_uv, [[2.0, 0.0, 0.5], [0.0, 3.0, 0.0]]);
    let Pattern::Bitmap {
        image,
        wrap: Wrap::Mirror,
        nearest: false,
        ..
    } = &texture.pattern
    else {
        panic!()
    };
    assert!(matches!(&image.texels, Texels::Srgb8(t) if t[0] == [255, 0, 0, 255]));
    let Pattern::Bitmap { image, .. } = &loaded.description.textures[1].pattern else {
        panic!()
    };
    assert!(
        matches!(&image.texels, Texels::Float(t) if (t[0][0] - 0.212_671).abs() < 1e-6),
        "opacity is luminance"
    );
    std::fs::write(dir.path().join("e.png"), b"not an image").expect("a file");
    let error = try_in(&dir, &[]).expect_err("no image");
    assert!(
        error.starts_with("e.png: ") && error.contains("expected a PNG"),
        "{error}"
    );
}

#[test]
fn checkerboards_are_of_unit_squares() {
    let loaded = good(
        "<texture type='checkerboard' id='t'><transform name='to_uv'><scale x='8' y='8'/></transform></texture>
         <shape type='rectangle'><bsdf type='diffuse'><ref name='reflectance' id='t'/></bsdf></shape>",
    );
    let texture = &loaded.description.textures[0];
    assert_eq!(texture.to_uv, [[16.0, 0.0, 0.0], [0.0, 16.0, 0.0]]);
    assert!(matches!(
        texture.pattern,
        Pattern::Checkerboard {
            colors: [[0.4, ..], [0.2, ..]]
        }
    ));
}

#[test]
fn six_faces_make_a_cube_map() {
    let names = ["px", "nx", "py", "ny", "pz", "nz"];
    let files: String = names
        .iter()
        .map(|n| format!("<string name='{n}' value='{n}.png'/>"))
        .collect();
    let dir = folder(&[(
        "scene.xml",
        &scene(&format!("<emitter type='cubemap'>{files}</emitter>")),
    )]);
    for (i, name) in names.iter().enumerate() {
        png(
            &dir.path().join(format!("{name}.png")),
            1,
            &[[if i == 2 { 255 } else { 0 }; 3]],
        );
    }
    let loaded = try_in(&dir, &[]).unwrap_or_else(|e| panic!("{e}"));
    let EmitterKind::CubeMap {
        width: 1, texels, ..
    } = &loaded.description.emitters[0].kind
    else {
        panic!()
    };
    assert_eq!(
        texels.iter().map(|t| t[0]).collect::<Vec<_>>(),
        [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
    );
    png(&dir.path().join("nz.png"), 2, &[[0; 3]; 4]);
    let error = try_in(&dir, &[]).expect_err("sizes");
    assert!(
        error.contains("nz must be 1 x 1 as the others, found 2 x 2"),
        "{error}"
    );
}

/// Every scene of a folder loads.
#[test]
fn scenes_of_the_suite() {
    let Some(root) = std::env::var_os("ETENDUE_SCENES") else {
        return;
    };
    let mut seen = 0;
    for folder in [Path::new(&root)] {
        let Ok(entries) = std::fs::read_dir(folder) else {
            continue;
        };
        for path in entries
            .flatten()
            .map(|e| e.path())
            .filter(|p| p.extension().is_some_and(|e| e == "xml"))
        {
            let name = path
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            seen += 1;
            let loaded = load(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
            println!(
                "{name}: {} shapes, {:?}",
                loaded.description.shapes.len(),
                loaded.warnings
            );
        }
    }
    assert!(seen > 0, "no scenes in the folder");
}

#[test]
fn glossy_materials_have_mitsubas_defaults() {
    let model = |bsdf: &str| {
        let loaded = material(bsdf).unwrap_or_else(|e| panic!("{e}"));
        loaded.description.materials[0].model.clone()
    };
    let grey = |g: f32| ColorSource::Constant([g; 3]);
    let default = Facets {
        alpha: [0.1; 2],
        distribution: Distribution::Beckmann,
        masking: Masking::Separable,
        compensated: false,
    };
    let Model::RoughConductor { eta, k, facets, .. } = model("<bsdf type='roughconductor'/>")
    else {
        panic!()
    };
    assert_eq!((eta, k, facets), ([0.0; 3], [1.0; 3], default));
    let Model::RoughConductor { eta, facets, .. } = model(
        "<bsdf type='roughconductor'><string name='material' value='Au'/><string name='distribution' value='ggx'/>
         <string name='masking' value='correlated'/><boolean name='compensated' value='true'/>
         <float name='alpha_u' value='.3'/><float name='alpha_v' value='.3'/><rgb name='specular_reflectance' value='.5'/></bsdf>",
    ) else {
        panic!()
    };
    assert_eq!(eta, [0.143_119, 0.374_957, 1.442_479]);
    let expected = Facets {
        alpha: [0.3; 2],
        distribution: Distribution::Ggx,
        masking: Masking::Correlated,
        compensated: true,
    };
    assert_eq!(facets, expected);
    let Model::RoughDielectric { ior, facets, .. } = model(
        "<bsdf type='roughdielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1.2'/></bsdf>",
    ) else {
        panic!()
    };
    assert_eq!((ior, facets), (1.25, default));
    let Model::Plastic {
        ior,
        diffuse_reflectance,
        reflectance,
        nonlinear: false,
        facets: None,
    } = model("<bsdf type='plastic'/>")
    else {
        panic!()
    };
    assert!((ior - 1.49 / 1.000_277).abs() < 1e-6);
    assert_eq!((diffuse_reflectance, reflectance), (grey(0.5), grey(1.0)));
    assert!(matches!(
        model("<bsdf type='roughplastic'><boolean name='nonlinear' value='true'/></bsdf>"),
        Model::Plastic { nonlinear: true, facets: Some(f), .. } if f == default
    ));
    assert!(matches!(
        model("<bsdf type='phong'/>"),
        Model::Phong { exponent: 30.0, modified: true, ior: 1.0, fresnel: false, reflectance, .. }
            if reflectance == grey(0.2)
    ));
    assert!(matches!(
        model("<bsdf type='phongdielectric'><float name='exponent' value='9'/></bsdf>"),
        Model::Phong {
            exponent: 9.0,
            fresnel: true,
            ..
        }
    ));
    assert!(matches!(
        model(
            "<bsdf type='sheet'><float name='specular_reflectance' value='.2'/><float name='exponent' value='50'/></bsdf>"
        ),
        Model::Phong { exponent: 50.0, ior: 1.0, reflectance, .. } if reflectance == grey(0.2)
    ));
}

#[test]
fn blends_are_of_both_sides() {
    let sides = |bsdf: &str| {
        let loaded = material(bsdf).unwrap_or_else(|e| panic!("{e}"));
        let shape = &loaded.description.shapes[0];
        let parts = |side: Option<usize>| {
            side.map(|m| match loaded.description.materials[m].model {
                Model::Blend { parts, weight } => {
                    assert_eq!(weight, ColorSource::Constant([0.25; 3]));
                    parts
                }
                _ => panic!("no blend"),
            })
        };
        (parts(shape.front), parts(shape.back))
    };
    let weight = "<float name='weight' value='.25'/>";
    // One-sided parts make a one-sided blend, which can be made two-sided.
    let one = format!(
        "<bsdf type='blendbsdf'>{weight}<bsdf type='diffuse'/><bsdf type='plastic'/></bsdf>"
    );
    assert_eq!(sides(&one), (Some([0, 1]), None));
    let two = format!("<bsdf type='twosided'>{one}</bsdf>");
    assert_eq!(sides(&two), (Some([0, 1]), Some([0, 1])));
    // With glass there is something behind: black where the diffuse part has nothing.
    let glass = format!(
        "<bsdf type='blendbsdf'>{weight}<bsdf type='diffuse'/><bsdf type='dielectric'/></bsdf>"
    );
    let (front, back) = sides(&glass);
    assert_eq!(front, Some([0, 1]));
    assert_eq!(back.map(|b| b[1]), Some(1));
}
