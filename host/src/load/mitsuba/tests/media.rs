//! Media: what they become, and what is refused.

use super::*;

/// A `.vol` of these numbers.
fn vol(size: [u32; 3], channels: u32, values: &[f32]) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    let [x, y, z] = size;
    for word in [1, x, y, z, channels] {
        bytes.extend(word.to_le_bytes());
    }
    for number in [0.0f32, 0.0, 0.0, 2.0, 4.0, 8.0].iter().chain(values) {
        bytes.extend(number.to_le_bytes());
    }
    bytes
}

/// A scene beside `gray.vol` (2 × 1 × 3 texels) and `rgb.vol` (one texel).
fn beside(body: &str) -> Result<Loaded, String> {
    let dir = folder(&[("scene.xml", &scene(body))]);
    let gray = vol([2, 1, 3], 1, &[0.0, 1.0, 2.0, 3.0, 4.0, 0.5]);
    let rgb = vol([1, 1, 1], 3, &[0.25, 0.5, 1.0]);
    for (name, bytes) in [("gray.vol", gray), ("rgb.vol", rgb)] {
        std::fs::write(dir.path().join(name), bytes).expect("a file");
    }
    try_in(&dir, &[])
}

/// A medium in a cube.
fn medium(text: &str) -> Result<Medium, String> {
    let body = format!("<shape type='cube'><bsdf type='null'/>{text}</shape>");
    let mut loaded = beside(&body.replacen("<medium", "<medium name='interior'", 1))?;
    assert_eq!(loaded.description.shapes[0].interior, Some(0));
    Ok(loaded.description.media.remove(0))
}

fn homogeneous(inner: &str) -> Result<Medium, String> {
    medium(&format!("<medium type='homogeneous'>{inner}</medium>"))
}

fn heterogeneous(inner: &str) -> Result<Medium, String> {
    medium(&format!("<medium type='heterogeneous'>{inner}</medium>"))
}

fn phase(text: &str) -> Vec<Lobe> {
    homogeneous(text).unwrap_or_else(|e| panic!("{e}")).phase
}

const GRAY: &str =
    "<volume name='sigma_t' type='gridvolume'><string name='filename' value='gray.vol'/></volume>";

#[test]
fn homogeneous_media() {
    let m = homogeneous("").expect("defaults");
    assert_eq!(
        (m.sigma_t, m.albedo, m.emission),
        ([1.0; 3], [0.75; 3], [0.0; 3])
    );
    assert_eq!(m.phase, [Lobe::from(Phase::Isotropic)]);
    assert!(m.grids.is_none());
    let m = homogeneous(
        "<rgb name='sigma_t' value='1, 2, 4'/><float name='scale' value='0.5'/><float name='albedo' value='0.25'/>
         <rgb name='emission' value='3, 0, 1'/><boolean name='sample_emitters' value='false'/>",
    )
    .expect("a medium");
    assert_eq!(
        (m.sigma_t, m.albedo, m.emission),
        ([0.5, 1.0, 2.0], [0.25; 3], [3.0, 0.0, 1.0])
    );
    let m = homogeneous(
        "<volume type='constvolume' name='albedo'><rgb name='value' value='0.1, 0.2, 0.3'/></volume>",
    );
    assert_eq!(m.expect("a medium").albedo, [0.1, 0.2, 0.3]);
}

#[test]
fn phase_functions() {
    let hg = |g| Phase::HenyeyGreenstein { g };
    assert_eq!(
        phase("<phase type='hg'><float name='g' value='-0.5'/></phase>"),
        [hg(-0.5).into()]
    );
    assert_eq!(phase("<phase type='hg'/>"), [hg(0.8).into()]);
    assert_eq!(phase("<phase type='rayleigh'/>"), [Phase::Rayleigh.into()]);
    assert_eq!(phase("<phase type='forward'/>"), [Phase::Forward.into()]);
    let lobe = |phase, weight| Lobe { phase, weight };
    let blend = "<phase type='blendphase'><float name='weight' value='0.25'/>
        <phase name='b' type='rayleigh'/><phase name='a' type='isotropic'/></phase>";
    let expected = [lobe(Phase::Isotropic, 0.75), lobe(Phase::Rayleigh, 0.25)];
    assert_eq!(phase(blend), expected, "by name");
    let nested = "<phase type='blendphase'><float name='weight' value='0.5'/><phase type='forward'/>
        <phase type='blendphase'><float name='weight' value='0.25'/><phase type='isotropic'/><phase type='rayleigh'/></phase></phase>";
    let expected = [
        lobe(Phase::Forward, 0.5),
        lobe(Phase::Isotropic, 0.375),
        lobe(Phase::Rayleigh, 0.125),
    ];
    assert_eq!(phase(nested), expected);
}

#[test]
fn grids() {
    let m = heterogeneous(&format!("{GRAY}<float name='scale' value='3'/>")).expect("a grid");
    assert_eq!((m.sigma_t, m.albedo), ([3.0; 3], [0.75; 3]));
    let g = m.grids.expect("grids");
    assert_eq!(
        (g.extinction.size, g.extinction.nearest),
        ([2, 1, 3], false)
    );
    assert!(
        matches!(&g.extinction.values, GridValues::Gray(v) if *v == [0.0, 1.0, 2.0, 3.0, 4.0, 0.5])
    );
    assert_eq!(
        g.to_grid,
        [
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0]
        ]
    );
    assert_eq!(g.tracking, Tracking::Woodcock);
    // All of it.
    let volume = |name: &str, file: &str| {
        format!(
            "<volume name='{name}' type='gridvolume'><string name='filename' value='{file}'/><string name='filter_type' value='nearest'/>
             <string name='wrap_mode' value='clamp'/><boolean name='raw' value='true'/><transform name='to_world'><scale value='2'/>
             <translate x='1'/></transform></volume>"
        )
    };
    let all = volume("sigma_t", "gray.vol")
        + &volume("albedo", "rgb.vol")
        + &volume("emission", "gray.vol");
    let m = heterogeneous(&(all + "<string name='tracking' value='residual'/>")).expect("grids");
    assert_eq!(
        (m.sigma_t, m.albedo, m.emission),
        ([1.0; 3], [1.0; 3], [1.0; 3])
    );
    let g = m.grids.expect("grids");
    assert!(g.extinction.nearest);
    assert!(
        matches!(&g.albedo.expect("a grid").values, GridValues::Rgb(v) if *v == [[0.25, 0.5, 1.0]])
    );
    assert_eq!(g.emission.expect("a grid").size, [2, 1, 3]);
    assert_eq!(
        g.to_grid,
        [
            [0.5, 0.0, 0.0, -0.5],
            [0.0, 0.5, 0.0, 0.0],
            [0.0, 0.0, 0.5, 0.0]
        ]
    );
    assert_eq!(g.tracking, Tracking::Residual);
    // The file's own box, [0, 2] × [0, 4] × [0, 8].
    let own = GRAY.replace(
        "</volume>",
        "<boolean name='use_grid_bbox' value='true'/></volume>",
    );
    let g = heterogeneous(&own).expect("a grid").grids.expect("grids");
    assert_eq!(
        g.to_grid,
        [
            [0.5, 0.0, 0.0, 0.0],
            [0.0, 0.25, 0.0, 0.0],
            [0.0, 0.0, 0.125, 0.0]
        ]
    );
    // A constant fills its box.
    let m = heterogeneous(
        "<volume name='sigma_t' type='constvolume'><float name='value' value='7'/></volume>",
    );
    let m = m.expect("a grid");
    assert_eq!(
        (m.sigma_t, m.grids.expect("grids").extinction.size),
        ([7.0; 3], [1; 3])
    );
}

#[test]
fn media_are_shared_and_stand_where_they_are_named() {
    let loaded = good(
        "<medium type='homogeneous' id='fog'/><medium type='homogeneous' id='milk'/>
         <shape type='cube'><bsdf type='null'/><ref name='interior' id='milk'/><ref name='exterior' id='fog'/></shape>
         <shape type='sphere'><ref name='exterior' id='fog'/></shape>
         <emitter type='point'><ref name='medium' id='fog'/></emitter>
         <emitter type='spot'><ref id='milk'/></emitter>
         <ref name='exterior' id='fog'/>",
    );
    let d = &loaded.description;
    assert_eq!(d.media.len(), 2);
    let [milk, fog] = [Some(0), Some(1)];
    assert_eq!((d.shapes[0].interior, d.shapes[0].exterior), (milk, fog));
    assert_eq!((d.shapes[1].interior, d.shapes[1].exterior), (None, fog));
    assert_eq!([d.emitters[0].medium, d.emitters[1].medium], [fog, milk]);
    assert_eq!(d.exterior, fog);
    assert_eq!(d.media[0].name, "milk");
    let s = sensor("type='perspective'><medium type='homogeneous'/>").expect("a sensor");
    assert_eq!(s.medium, Some(0));
    for kind in ["volpath", "volpathmis"] {
        good(&format!("<integrator type='{kind}'/>"));
    }
}

#[test]
fn turned_boxes_and_boxes_of_constants_are_warned_of() {
    let turned = GRAY.replace(
        "</volume>",
        "<transform name='to_world'><rotate z='1' angle='30'/></transform></volume>",
    );
    for (inner, part) in [
        (turned.as_str(), "the box of sigma_t is turned"),
        ("", "fills the unit cube"),
    ] {
        let body = format!(
            "<shape type='cube'><medium name='interior' type='heterogeneous'>{inner}</medium></shape><emitter type='constant'/>"
        );
        let warnings = beside(&body).expect("a scene").warnings;
        assert!(
            warnings.len() == 1 && warnings[0].contains(part),
            "{warnings:?}"
        );
    }
    let upright = GRAY.replace(
        "</volume>",
        "<transform name='to_world'><rotate z='1' angle='90'/></transform></volume>",
    );
    let body = format!(
        "<shape type='cube'><medium name='interior' type='heterogeneous'>{upright}</medium></shape><emitter type='constant'/>"
    );
    assert_eq!(
        beside(&body).expect("a scene").warnings,
        Vec::<String>::new()
    );
}

#[test]
fn a_bad_medium_is_one_error_with_its_line() {
    refused(
        "<medium type='homogeneous' id='m'>\n<rgb name='sigma_t' value='1, -2, 3'/></medium>",
        "scene.xml:4: homogeneous: sigma_t must be >= 0 and finite, found \"1, -2, 3\"",
    );
    refused(
        "<medium type='homogeneous' id='m'>\n\n<float name='albedo' value='1.5'/></medium>",
        "scene.xml:5: homogeneous: albedo must be at most 1 in each channel, found 1.5 1.5 1.5",
    );
    for (inner, part) in [
        (
            "<float name='sigma_t' value='inf'/>",
            "sigma_t must be a finite number",
        ),
        (
            "<float name='scale' value='-1'/>",
            "scale must be >= 0, found -1",
        ),
        ("<rgb name='emission' value='-1'/>", "emission must be >= 0"),
        (
            "<rgb name='emission' value='1'/><float name='albedo' value='1'/>",
            "emission must be 0 in channels where the medium doesn't absorb",
        ),
        (
            "<rgb name='emission' value='1'/><float name='sigma_t' value='0'/>",
            "emission must be 0 in channels where the medium doesn't absorb",
        ),
        (
            "<float name='sigma_a' value='1'/>",
            "unknown parameter \"sigma_a\"",
        ),
        (
            "<phase type='hg'><float name='g' value='1'/></phase>",
            "g must be between -1 and 1, found 1",
        ),
        (
            "<phase type='hg'><float name='g' value='-1'/></phase>",
            "g must be between -1 and 1",
        ),
        (
            "<phase type='sggx'/>",
            "phase sggx is not supported yet: choose isotropic",
        ),
        ("<phase type='mie'/>", "unknown plugin \"mie\""),
        (
            "<phase type='blendphase'><phase type='hg'/></phase>",
            "number of nested phase functions must be two, found 1",
        ),
        (
            "<phase type='blendphase'><float name='weight' value='2'/><phase type='hg'/><phase type='hg'/></phase>",
            "weight must be from 0 to 1",
        ),
        (
            "<phase type='hg'/><phase type='hg'/>",
            "<phase> was already given",
        ),
        (
            GRAY,
            "volume gridvolume as sigma_t of a homogeneous medium is not supported yet: choose heterogeneous",
        ),
    ] {
        let error = homogeneous(inner).expect_err(inner);
        assert!(error.contains(part), "{error}");
        assert!(error.starts_with("scene.xml:"), "{error}");
    }
    let with = |extra: &str| GRAY.replace("</volume>", &format!("{extra}</volume>"));
    for (inner, part) in [
        (
            with("<string name='wrap_mode' value='repeat'/>"),
            "wrap_mode repeat is not supported yet: choose clamp",
        ),
        (
            with("<string name='filter_type' value='cubic'/>"),
            "filter_type must be trilinear or nearest",
        ),
        (
            GRAY.replace("gray", "no"),
            "filename must be a file that exists",
        ),
        (
            GRAY.replace("gridvolume", "noise"),
            "unknown plugin \"noise\"",
        ),
        (
            GRAY.to_owned() + &GRAY.replace("sigma_t", "albedo"),
            "albedo must be at most 1 everywhere, found 2",
        ),
        (
            GRAY.to_owned()
                + &with("<transform name='to_world'><scale value='2'/></transform>")
                    .replace("sigma_t", "emission"),
            "emission must be over the box of sigma_t",
        ),
        (
            GRAY.replace("gray", "rgb") + "<string name='tracking' value='residual'/>",
            "tracking must be woodcock or regular where sigma_t has three channels",
        ),
        (
            "<string name='tracking' value='x'/>".to_owned(),
            "tracking must be woodcock, residual or regular",
        ),
    ] {
        let error = heterogeneous(&inner).expect_err(&inner);
        assert!(error.contains(part), "{error}");
    }
    for (body, part) in [
        (
            "<shape type='cube'><bsdf type='null' name='interior'/></shape>",
            "interior must be a <medium>, found <bsdf>",
        ),
        (
            "<shape type='cube'><medium type='homogeneous'/></shape>",
            "unknown parameter <medium>",
        ),
        (
            "<medium type='plasma' id='m'/>",
            "unknown plugin \"plasma\", expected homogeneous or heterogeneous",
        ),
        (
            "<emitter type='constant'><medium type='homogeneous'/></emitter>",
            "medium must be at point and spot emitters only",
        ),
        (
            "<bsdf type='null' id='b'/><ref name='exterior' id='b'/>",
            "exterior must be a <medium>",
        ),
        (
            "<phase type='blendphase' id='p'><ref id='p'/><ref id='p'/></phase><medium type='homogeneous' id='m'><ref id='p'/></medium>",
            "no cycle of references",
        ),
    ] {
        assert!(bad(body).contains(part), "{}", bad(body));
    }
    // Blends of blends of one another, 60 deep.
    let chain: String = (0..60)
        .map(|i| format!("<phase type='blendphase' id='p{i}'><float name='weight' value='0'/><ref id='p{0}'/><ref id='p{0}'/></phase>", i + 1))
        .collect();
    let body = format!(
        "{chain}<phase type='hg' id='p60'/><medium type='homogeneous' id='m'><ref id='p0'/></medium>"
    );
    assert_eq!(
        good(&body).description.media.len(),
        0,
        "nothing refers to it"
    );
}

/// Where the grid is asked for, and which file is at fault.
#[test]
fn what_is_wrong_with_a_grids_file_names_the_scenes_line_too() {
    let long = vol([2, 2, 1], 1, &[1.0, 2.0, -3.0, 4.0]);
    let mut other = long.clone();
    other[3] = 2;
    for (bytes, reason) in [
        (
            &long[..20],
            "file of 20 bytes ends too early, expected a header of 48 bytes",
        ),
        (&other, "version 2, expected 3"),
        (
            &long[..60],
            "12 bytes of data, expected 16: 2 x 2 x 1 texels of 1 x 4 bytes",
        ),
        (
            &long,
            "texel (0, 1, 0) is -3, expected a finite number >= 0",
        ),
    ] {
        for name in ["sigma_t", "albedo", "emission"] {
            let grid = format!(
                "\n<volume name='{name}' type='gridvolume'>\n<string name='filename' value='bad.vol'/></volume>"
            );
            let body = format!(
                "<shape type='cube'><bsdf type='null'/><medium name='interior' type='heterogeneous'>{grid}</medium></shape>"
            );
            let dir = folder(&[("scene.xml", &scene(&body))]);
            std::fs::write(dir.path().join("bad.vol"), bytes).expect("a file");
            let error = try_in(&dir, &[]).expect_err(reason);
            assert_eq!(error, format!("scene.xml:5: gridvolume: bad.vol: {reason}"));
        }
    }
}

#[test]
fn what_the_compiler_finds_names_file_and_line() {
    let compile = |body: &str| {
        let loaded = good(body);
        let error = crate::compile::compile(&loaded.description).expect_err(body);
        let file = error.place.file.file_name().expect("a file").to_owned();
        (file, error.place.line, error.name, error.reason)
    };
    let (file, line, name, reason) = compile(
        "<medium type='homogeneous' id='fog'/>\n<shape type='sphere' id='one'><bsdf type='null'/><ref name='interior' id='fog'/></shape>
         <shape type='sphere' id='other'><point name='center' x='1' y='0' z='0'/><bsdf type='null'/><ref name='interior' id='fog'/></shape>",
    );
    assert_eq!(file, "scene.xml");
    let (behind, next) = if line == 5 {
        ("one", "other")
    } else {
        ("other", "one")
    };
    assert_eq!(name, next);
    let expected =
        format!("overlaps with {behind}: medium fog is behind that, but {next} is met in vacuum");
    assert!(reason.starts_with(&expected), "{reason}");
    let (file, line, name, reason) = compile(
        "<medium type='homogeneous' id='fog'/><ref name='exterior' id='fog'/>\n<emitter type='directional' id='sun'/>",
    );
    assert_eq!(
        (file.to_str(), line, name.as_str()),
        (Some("scene.xml"), 4, "sun")
    );
    assert!(reason.starts_with("nothing would arrive"), "{reason}");
}
