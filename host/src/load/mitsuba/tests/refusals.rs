//! What is refused, and in which words.

use super::*;

#[test]
fn transforms_that_make_no_sense() {
    for (steps, part) in [
        ("<scale x='0'/>", "a transform that can be undone"),
        (
            "<lookat origin='1 1 1' target='1 1 1' up='0 1 0'/>",
            "apart from origin",
        ),
        (
            "<lookat origin='0 0 0' target='0 1 0' up='0 1 0'/>",
            "not along the view",
        ),
        (
            "<lookat origin='0 0 0' target='0 1 0'/>",
            "attribute \"up\" is missing",
        ),
        ("<rotate angle='3' x='0'/>", "axis must be not zero"),
        ("<rotate x='1'/>", "attribute \"angle\" is missing"),
        ("<matrix value='1 2 3'/>", "16 or 9 finite numbers"),
        (
            "<matrix value='1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1'/>",
            "last row must be 0 0 0 1",
        ),
        ("<shear x='1'/>", "unknown step <shear>"),
        ("<translate x='nan'/>", "finite number"),
        ("<translate x='1' value='1 2 3'/>", "not both"),
        ("<translate q='1'/>", "unknown attribute \"q\""),
    ] {
        let error = try_matrix(steps).expect_err(steps);
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn sensors_of_all_kinds() {
    let s = sensor("type='perspective'><transform name='to_world'><scale x='-1'/></transform>")
        .expect("mirrored");
    assert_eq!(
        (s.right, s.down, s.forward),
        ([1.0, -0.0, -0.0], [-0.0, -1.0, -0.0], [0.0, 0.0, 1.0])
    );
    assert_eq!(
        s.filter,
        Filter::Gaussian {
            sigma: 0.5,
            radius: 2.0
        }
    );
    let Projection::Perspective { half_tangent, .. } = s.projection else {
        panic!()
    };
    let diagonal = (half_tangent[0].powi(2) + half_tangent[1].powi(2)).sqrt();
    assert!(
        (diagonal - 1872.0f32.sqrt() / 100.0).abs() < 1e-6,
        "50 mm of a 36 x 24 film"
    );
    let s = sensor(
        "type='orthographic'><transform name='to_world'><scale x='10' y='10'/></transform>
         <film type='hdrfilm'><integer name='width' value='40'/><integer name='height' value='20'/></film>",
    )
    .expect("orthographic");
    assert_eq!(
        s.projection,
        Projection::Orthographic {
            half_extent: [10.0, 5.0]
        }
    );
    let s = sensor("type='panorama'><float name='near_clip' value='.5'/>").expect("panorama");
    assert_eq!((s.projection, s.clip), (Projection::Panorama, [0.5, 1e4]));
    let s = sensor(
        "type='thinlens'><float name='aperture_radius' value='.1'/><float name='focus_distance' value='3'/>
         <float name='fov' value='90'/>",
    )
    .expect("thin lens");
    assert!(matches!(
        s.projection,
        Projection::Perspective {
            aperture: 0.1,
            focus: 3.0,
            ..
        }
    ));
    for (inner, part) in [
        (
            "type='fisheye'>",
            "unknown plugin \"fisheye\", expected perspective, thinlens, orthographic or panorama",
        ),
        ("type='thinlens'>", "aperture_radius is missing"),
        (
            "type='panorama'><transform name='to_world'><scale value='2'/></transform>",
            "free of scale",
        ),
        ("type='panorama'><float name='fov' value='90'/>", "fov"),
        (
            "type='perspective'><float name='fov' value='180'/>",
            "between 0 and 180 degrees, found 180",
        ),
        (
            "type='perspective'><float name='near_clip' value='0'/>",
            "near_clip must be > 0",
        ),
        (
            "type='perspective'><float name='far_clip' value='0.001'/>",
            "near_clip must be less than far_clip",
        ),
        (
            "type='perspective'><string name='fov_axis' value='z'/>",
            "fov_axis must be x, y, diagonal",
        ),
        (
            "type='perspective'><string name='focal_length' value='long'/>",
            "like 50mm",
        ),
        (
            "type='perspective'><transform name='to_world'><scale value='2'/></transform>",
            "free of scale",
        ),
        (
            "type='perspective'><film type='hdrfilm'><rfilter type='lanczos'/></film>",
            "choose box, tent or gaussian",
        ),
        (
            "type='perspective'><film type='hdrfilm'><integer name='width' value='0'/></film>",
            "width must be from 1",
        ),
        (
            "type='perspective'><sampler type='sobol'/>",
            "unknown plugin \"sobol\"",
        ),
    ] {
        let error = sensor(inner).expect_err(inner);
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn refusals_say_where_what_and_what_instead() {
    refused(
        "<shape type='sphere'>\n<float name='radius' value='-1'/></shape>",
        "scene.xml:4: sphere: radius must be > 0, found -1",
    );
    refused(
        "<shape type='sphere'><float name='radios' value='1'/></shape>",
        "scene.xml:3: sphere: unknown parameter \"radios\", expected interior, exterior, <bsdf>, <emitter>, center, radius, flip_normals, \
         to_world, silhouette_sampling_weight",
    );
    refused(
        "<shape type='sphere'><string name='radius' value='1'/></shape>",
        "scene.xml:3: sphere: radius must be <float> or <integer>, found <string>",
    );
    refused(
        "<shape type='blob'/>",
        "scene.xml:3: <shape>: unknown plugin \"blob\", expected obj, ply, serialized, sphere, cube, rectangle or disk",
    );
    refused(
        "<shape type='ply'/>",
        "scene.xml:3: ply: filename is missing, expected <string name=\"filename\" …/>",
    );
    refused(
        "<bsdf type='diffuse' id='a'/>\n<bsdf type='diffuse' id='a'/>",
        "scene.xml:4: <bsdf>: id \"a\" was already given at line 3, expected it once",
    );
    refused(
        "<shape type='cube'><ref id='nobody'/></shape>",
        "scene.xml:3: <ref>: id refers to \"nobody\", which does not exist",
    );
    refused(
        "<shape type='cube'><bsdf type='hair'/></shape>",
        "scene.xml:3: hair: bsdf hair is not supported yet: choose diffuse, twosided, conductor, roughconductor, dielectric, roughdielectric, plastic, roughplastic, phong, phongdielectric, blendbsdf, null, mask, diffusetransmitter or sheet",
    );
    refused(
        "<shape type='ply'><string name='filename' value='none.ply'/></shape>",
        "scene.xml:3: ply: filename must be a file that exists, found none.ply",
    );
    refused(
        "<shape type='cube'><float name='radius' value='$r'/></shape>",
        "scene.xml:3: <float>: attribute \"value\" refers to $r, which does not exist",
    );
    for (body, part) in [
        ("<shape type='cube'>", "expected well-formed XML"),
        (
            "<shape type='cube'>word</shape>",
            "text \"word\", expected only elements",
        ),
        ("<shape/>", "attribute \"type\" is missing"),
        (
            "<shape type='cube' colour='red'/>",
            "unknown attribute \"colour\"",
        ),
        (
            "<shape type='cylinder'/>",
            "shape cylinder is not supported yet",
        ),
        ("<thing/>", "unknown element <thing>"),
        (
            "<integrator type='direct'/>",
            "integrator direct is not supported yet: choose path",
        ),
        (
            "<integrator type='path'/><integrator type='path'/>",
            "was already given",
        ),
        (
            "<integrator type='path'><integer name='max_depth' value='-2'/></integrator>",
            "found -2",
        ),
        (
            "<integrator type='path'><integer name='max_depth' value='1.5'/></integrator>",
            "a whole number",
        ),
        (
            "<integrator type='path'><boolean name='hide_emitters' value='true'/></integrator>",
            "not supported yet",
        ),
        (
            "<integrator type='path'><boolean name='hide_emitters' value='yes'/></integrator>",
            "true or false",
        ),
        (
            "<shape type='sphere'><float name='radius' value='1'/><float name='radius' value='2'/></shape>",
            "already",
        ),
        (
            "<shape type='sphere'><float name='radius' value='inf'/></shape>",
            "a finite number",
        ),
        (
            "<shape type='sphere'><transform name='to_world'><scale x='2'/></transform></shape>",
            "of one scale",
        ),
        (
            "<shape type='sphere'><point name='center' x='a'/></shape>",
            "center x must be a finite number",
        ),
        (
            "<shape type='sphere'><emitter type='point'/></shape>",
            "unknown plugin \"point\", expected area",
        ),
        (
            "<shape type='cube'><bsdf type='diffuse'/><bsdf type='diffuse'/></shape>",
            "<bsdf> was already given",
        ),
        ("<include filename='no.xml'/>", "one that exists"),
        ("<path value='no'/>", "value must be a folder"),
        ("<emitter type='area'/>", "expected it within one"),
        ("<emitter type='sun'/>", "emitter sun is not supported yet"),
        (
            "<emitter type='constant'/><emitter type='constant'/>",
            "the environment was already given",
        ),
        (
            "<emitter type='point'><rgb name='intensity' value='-1'/></emitter>",
            "intensity must be >= 0 and finite",
        ),
        (
            "<emitter type='point'><point name='position' x='1'/><transform name='to_world'/></emitter>",
            "both given",
        ),
        (
            "<emitter type='spot'><float name='beam_width' value='30'/></emitter>",
            "less than cutoff_angle, 20",
        ),
        (
            "<emitter type='directional'><vector name='direction' value='0 0 0'/></emitter>",
            "not zero",
        ),
        (
            "<emitter type='constant'><spectrum name='radiance' value='400:1, 300:2'/></emitter>",
            "pairs nm:value by rising wavelength",
        ),
        (
            "<medium type='heterogeneous' id='m'><spectrum name='sigma_t' value='400:1, 700:2'/></medium><shape type='cube'><ref name='interior' id='m'/></shape>",
            "a list of wavelengths as sigma_t is not supported yet",
        ),
        (
            "<medium type='homogeneous' id='m'><spectrum name='albedo' value='400:1, 700:1.5'/></medium><shape type='cube'><ref name='interior' id='m'/></shape>",
            "albedo must be at most 1 at every wavelength, found 1.5",
        ),
        (
            "<shape type='cube'><bsdf type='conductor'><spectrum name='eta' value='400:1, 700:2'/></bsdf></shape>",
            "k",
        ),
        (
            "<shape type='cube'><bsdf type='conductor'><spectrum name='eta' value='400:0, 700:2'/><float name='k' value='1'/></bsdf></shape>",
            "> 0",
        ),
        (
            "<shape type='cube'><bsdf type='conductor'><spectrum name='eta' value='400:1, 700:2'/><rgb name='k' value='1 2 3'/></bsdf></shape>",
            "one number or a spectrum where the other is one",
        ),
        (
            "<shape type='cube'><bsdf type='dielectric'><string name='dispersion' value='cauchy 0'/></bsdf></shape>",
            "cauchy A B [C], sellmeier B1 B2 B3 C1 C2 C3",
        ),
        (
            "<shape type='cube'><bsdf type='dielectric'><string name='dispersion' value='cauchy 0.05 0'/></bsdf></shape>",
            "an index from 0.1 to 100 at 380 to 780 nm",
        ),
        (
            "<shape type='cube'><bsdf type='dielectric'><string name='dispersion' value='bk7'/><float name='int_ior' value='1.5'/></bsdf></shape>",
            "expected one of the two",
        ),
        (
            "<shape type='cube'><bsdf type='diffuse'><spectrum name='reflectance' value='400:0.5, 500:1.5'/></bsdf></shape>",
            "from 0 to 1",
        ),
        (
            "<emitter type='constant'><rgb name='radiance' value='1 2'/></emitter>",
            "1 or 3 finite numbers, or #RRGGBB",
        ),
        (
            "<shape type='cube'><emitter type='area'><texture name='radiance' type='checkerboard'/></emitter></shape>",
            "a texture as radiance is not supported yet",
        ),
    ] {
        let error = bad(body);
        assert!(error.contains(part), "{error}\n{body}");
        assert!(error.starts_with("scene.xml:"), "{error}");
    }
}

#[test]
fn materials_that_make_energy_or_no_sense() {
    for (bsdf, part) in [
        (
            "<bsdf type='diffuse'><rgb name='reflectance' value='0.5 1.5 0'/></bsdf>",
            "reflectance must be from 0 to 1",
        ),
        (
            "<bsdf type='diffuse'><rgb name='reflectance' value='-1'/></bsdf>",
            ">= 0",
        ),
        (
            "<bsdf type='sheet'><rgb name='specular_reflectance' value='.6'/>
              <rgb name='diffuse_transmittance' value='.1 .5 .1'/></bsdf>",
            "at most 1 in each channel",
        ),
        (
            "<bsdf type='diffusetransmitter'><float name='transmittance' value='.6'/></bsdf>",
            "at most 1",
        ),
        (
            "<bsdf type='twosided'><bsdf type='null'/></bsdf>",
            "neither transmits nor is two-sided",
        ),
        (
            "<bsdf type='twosided'/>",
            "number of nested BSDFs must be one or two, found 0",
        ),
        ("<bsdf type='mask'/>", "a nested BSDF is missing"),
        (
            "<bsdf type='mask' id='m'><ref id='m'/></bsdf>",
            "BSDF within itself",
        ),
        (
            "<bsdf type='conductor'><string name='material' value='Xx'/></bsdf>",
            "none, Ag, Al, Au, Cr, Cu",
        ),
        (
            "<bsdf type='conductor'><rgb name='eta' value='1'/></bsdf>",
            "k is missing",
        ),
        (
            "<bsdf type='dielectric'><string name='int_ior' value='jelly'/></bsdf>",
            "a number > 0 or one of vacuum",
        ),
        (
            "<bsdf type='dielectric'><float name='int_ior' value='0'/></bsdf>",
            "int_ior must be > 0",
        ),
        (
            "<bsdf type='roughconductor'><float name='alpha' value='0'/></bsdf>",
            "alpha must be from 0.0001 to 10, found 0",
        ),
        (
            "<bsdf type='roughplastic'><float name='alpha' value='-0.1'/></bsdf>",
            "alpha must be from 0.0001 to 10, found -0.1",
        ),
        (
            "<bsdf type='roughconductor'><float name='alpha_u' value='.1'/></bsdf>",
            "alpha_v is missing",
        ),
        (
            "<bsdf type='roughconductor'><float name='alpha_u' value='.1'/>
              <float name='alpha_v' value='.2'/></bsdf>",
            "a roughness that differs along u and v is not supported yet",
        ),
        (
            "<bsdf type='roughconductor'><string name='distribution' value='phong'/></bsdf>",
            "distribution must be beckmann or ggx",
        ),
        (
            "<bsdf type='roughconductor'><rgb name='eta' value='0'/><rgb name='k' value='1'/></bsdf>",
            "eta must be > 0",
        ),
        (
            "<bsdf type='roughdielectric'><float name='int_ior' value='1'/></bsdf>",
            "int_ior / ext_ior must be 1 % from 1 at least",
        ),
        (
            "<bsdf type='roughdielectric'><string name='masking' value='cavities'/></bsdf>",
            "masking must be separable or correlated",
        ),
        (
            "<bsdf type='plastic'><float name='int_ior' value='-1.5'/></bsdf>",
            "int_ior must be > 0",
        ),
        (
            "<bsdf type='plastic'><float name='alpha' value='.1'/></bsdf>",
            "unknown parameter \"alpha\"",
        ),
        (
            "<bsdf type='phong'><float name='exponent' value='-1'/></bsdf>",
            "exponent must be from 0 to 100000, found -1",
        ),
        (
            "<bsdf type='phong'><rgb name='diffuse_reflectance' value='.5'/>
              <rgb name='specular_reflectance' value='.6'/></bsdf>",
            "diffuse_reflectance + specular_reflectance must be at most 1",
        ),
        (
            "<bsdf type='blendbsdf'><float name='weight' value='.5'/><bsdf type='diffuse'/></bsdf>",
            "number of nested BSDFs must be two, found 1",
        ),
        (
            "<bsdf type='blendbsdf'><bsdf type='diffuse'/><bsdf type='diffuse'/></bsdf>",
            "weight is missing",
        ),
        (
            "<bsdf type='blendbsdf'><float name='weight' value='1.5'/><bsdf type='diffuse'/>
              <bsdf type='diffuse'/></bsdf>",
            "weight must be from 0 to 1",
        ),
        (
            "<bsdf type='thindielectric'/>",
            "bsdf thindielectric is not supported yet",
        ),
        (
            "<bsdf type='diffuse'><texture name='reflectance' type='checkerboard'>
              <rgb name='color0' value='2'/></texture></bsdf>",
            "from 0 to 1 in all of its texture, found 2",
        ),
        (
            "<bsdf type='diffuse'><texture name='reflectance' type='wood'/></bsdf>",
            "expected bitmap or checkerboard",
        ),
    ] {
        let error = material(bsdf).expect_err(bsdf);
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn unsupported_and_unused_is_a_warning() {
    let loaded = good(
        "<bsdf type='principled' id='glossy'/><medium type='specmedium' id='fog'/><emitter type='constant'/>",
    );
    let [glossy, fog] = loaded.warnings.as_slice() else {
        panic!("{:?}", loaded.warnings)
    };
    assert!(
        glossy.contains("principled is not supported yet") && glossy.contains("left out"),
        "{glossy}"
    );
    assert!(
        fog.contains("medium specmedium is not supported yet"),
        "{fog}"
    );
    assert!(loaded.description.materials.is_empty());
    assert!(bad("<bsdf type='roughconducter'/>").contains("unknown plugin"));
    assert!(good("").warnings[0].ends_with("nothing in the scene emits light"));
    assert!(
        good("<integrator type='bdpt'/>").warnings[0]
            .contains("the command line picks the estimator")
    );
}

#[test]
fn deep_nesting_and_entities_are_refused() {
    let deep = format!(
        "{}{}",
        "<bsdf type='twosided'>".repeat(10_000),
        "</bsdf>".repeat(10_000)
    );
    assert!(bad(&deep).contains("expected at most 64"));
    let bomb = "<?xml version='1.0'?><!DOCTYPE l [<!ENTITY a 'ha'><!ENTITY b '&a;&a;'>]><scene>&b;</scene>";
    let error = try_in(&folder(&[("scene.xml", bomb)]), &[]).expect_err("entities");
    assert!(error.contains("expected well-formed XML"), "{error}");
    let error = load(Path::new("no/such.xml"), &[])
        .expect_err("no file")
        .to_string();
    assert!(error.starts_with("no/such.xml: cannot be read"), "{error}");
    assert!(load(Path::new("a.blend"), &[]).is_err());
    let error =
        try_in(&folder(&[("scene.xml", "<scene version='3.0.0'/>")]), &[]).expect_err("no sensor");
    assert!(error.contains("sensor is missing"), "{error}");
}
