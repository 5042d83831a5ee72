//! Bad input: one line that names file and place, exit code ≠ 0, nothing written.

use super::{SCENE, etendue, folder, succeed, text, with_floor};
use std::path::Path;

/// Everything in a folder.
fn listing(at: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(at)
        .unwrap()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// The program must refuse: one line beginning with `error:` that contains all of `parts`, and no file more than before.
pub fn refused(at: &Path, arguments: &[&str], parts: &[&str]) {
    let before = listing(at);
    let output = etendue(at, arguments);
    let error = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {error}");
    let lines: Vec<&str> = error
        .lines()
        .filter(|l| !l.starts_with("warning:"))
        .collect();
    assert!(
        lines.len() == 1 && lines[0].starts_with("error: "),
        "{arguments:?}: expected one line, found:\n{error}"
    );
    for part in parts {
        assert!(
            lines[0].contains(part),
            "{arguments:?}: no {part:?} in {}",
            lines[0]
        );
    }
    assert_eq!(before, listing(at), "{arguments:?} left something behind");
}

/// Rendering `scene`, a changed copy of the good one, must be refused.
fn scene_refused(from: &str, to: &str, parts: &[&str]) {
    let (_keep, at) = folder();
    assert!(SCENE.contains(from), "{from} isn't in the scene");
    std::fs::write(at.join("bad.xml"), SCENE.replacen(from, to, 1)).unwrap();
    refused(
        &at,
        &["render", "bad.xml", "-o", "x.exr"],
        &[&["bad.xml"], parts].concat(),
    );
}

#[test]
fn scenes() {
    scene_refused("</scene>", "", &["bad.xml:"]);
    scene_refused(
        "<float name=\"fov\" value=\"50\"/>",
        "<float name=\"fov\" value=\"wide\"/>",
        &["bad.xml:5", "wide"],
    );
    scene_refused(
        "<float name=\"fov\" value=\"50\"/>",
        "<string name=\"fov\" value=\"50\"/>",
        &["bad.xml:5"],
    );
    scene_refused(
        "type=\"rectangle\"",
        "type=\"teapot\"",
        &["bad.xml:11", "teapot"],
    );
    scene_refused(
        "name=\"radius\" value=\"0.4\"",
        "name=\"radios\" value=\"0.4\"",
        &["bad.xml:16", "radios"],
    );
    scene_refused("value=\"0.4\"", "value=\"-1\"", &["bad.xml:16", "-1"]);
    scene_refused("value=\"$grey\"", "value=\"1.5\"", &["bad.xml:10"]);
    scene_refused(
        "value=\"$grey\"",
        "value=\"$colour\"",
        &["bad.xml:10", "colour"],
    );
    scene_refused(
        "<ref id=\"floor\"/>",
        "<ref id=\"flour\"/>",
        &["bad.xml:13", "flour"],
    );
    scene_refused(
        "<integrator",
        "<bsdf type=\"diffuse\" id=\"floor\"/><integrator",
        &["bad.xml", "floor"],
    );
    scene_refused("<scale value=\"2\"/>", "<scale value=\"0\"/>", &["bad.xml"]);
    scene_refused(
        "type=\"diffuse\"",
        "type=\"principled\"",
        &["bad.xml:10", "not supported yet"],
    );
}

#[test]
fn matter() {
    let medium = |from: &str, to: &str, parts: &[&str]| {
        let fog = "<medium type=\"homogeneous\" name=\"interior\">\n<rgb name=\"sigma_t\" value=\"1, 2, 3\"/>\n<rgb name=\"albedo\" value=\"0.5\"/>\n<phase type=\"hg\">\n<float name=\"g\" value=\"0.5\"/></phase></medium>";
        assert!(fog.contains(from), "{from} isn't in the medium");
        let ball = format!(
            "<shape type=\"sphere\"><bsdf type=\"dielectric\">\n<float name=\"int_ior\" value=\"1.5\"/></bsdf>{fog}</shape></scene>"
        );
        scene_refused("</scene>", &ball.replacen(from, to, 1), parts);
    };
    medium("1, 2, 3", "1, -2, 3", &["bad.xml:21", "sigma_t", "-2"]);
    medium("1, 2, 3", "1, inf, 3", &["bad.xml:21", "sigma_t", "inf"]);
    medium("1, 2, 3", "1, nan, 3", &["bad.xml:21", "sigma_t", "nan"]);
    medium(
        "value=\"0.5\"/>\n<phase",
        "value=\"1.5\"/>\n<phase",
        &["bad.xml:2", "albedo", "1.5"],
    );
    medium(
        "value=\"0.5\"/></phase",
        "value=\"1\"/></phase",
        &["bad.xml:24", "g must be between -1 and 1"],
    );
    scene_refused(
        "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"$grey\"/></bsdf>",
        "<bsdf type=\"dielectric\"><float name=\"int_ior\" value=\"0\"/></bsdf>",
        &["bad.xml:10", "int_ior"],
    );
}

#[test]
fn volumes() {
    let (_keep, at) = folder();
    let smoke = "<shape type=\"cube\"><bsdf type=\"null\"/><medium type=\"heterogeneous\" name=\"interior\"><volume type=\"gridvolume\" name=\"sigma_t\"><string name=\"filename\" value=\"m.vol\"/></volume></medium></shape></scene>";
    std::fs::write(at.join("smoke.xml"), SCENE.replace("</scene>", smoke)).unwrap();
    // VOL, version 3, f32, 2 × 2 × 2 texels of one channel, a box, and one number too few.
    let mut bytes = b"VOL\x03".to_vec();
    bytes.extend([1i32, 2, 2, 2, 1].iter().flat_map(|i| i.to_le_bytes()));
    let numbers = |n: usize| vec![1.0f32.to_le_bytes(); n].concat();
    bytes.extend(numbers(6));
    for (count, last, part) in [
        (7, 1.0, "28 bytes of data, expected 32"),
        (8, -1.0, "-1"),
        (8, f32::NAN, "NaN"),
    ] {
        let mut file = [bytes.clone(), numbers(count)].concat();
        let end = file.len() - 4;
        file[end..].copy_from_slice(&f32::to_le_bytes(last));
        std::fs::write(at.join("m.vol"), file).unwrap();
        refused(
            &at,
            &["render", "smoke.xml", "-o", "x.exr"],
            &["m.vol", part],
        );
    }
}

#[test]
fn meshes() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let shape = "<shape type=\"obj\"><string name=\"filename\" value=\"m.obj\"/><emitter type=\"area\"><rgb name=\"radiance\" value=\"1\"/></emitter></shape></scene>";
    let (_keep, at) = folder();
    std::fs::write(at.join("mesh.xml"), SCENE.replace("</scene>", shape)).unwrap();
    let mesh = |content: &str, parts: &[&str]| {
        std::fs::write(at.join("m.obj"), content).unwrap();
        refused(&at, &["render", "mesh.xml", "-o", "x.exr"], parts);
    };
    mesh(&obj.replace("v 1 0 0", "v nan 0 0"), &["m.obj:2"]);
    mesh(&obj.replace("f 1 2 3", "f 1 2 7"), &["m.obj:4", "7"]);
    mesh(
        &obj.replace("v 0 1 0", "v 2 0 0"),
        &["mesh.xml:19", "no area"],
    );
    mesh("", &["m.obj"]);
    std::fs::remove_file(at.join("m.obj")).unwrap();
    refused(&at, &["render", "mesh.xml", "-o", "x.exr"], &["m.obj"]);
}

#[test]
fn blobs() {
    let (_keep, at) = folder();
    succeed(&at, &["compile", "scene.xml", "-o", "good.etd"]);
    let good = std::fs::read(at.join("good.etd")).unwrap();
    std::fs::write(at.join("short.etd"), &good[..good.len() / 2]).unwrap();
    std::fs::write(at.join("foreign.etd"), vec![0x5a; 4096]).unwrap();
    std::fs::write(at.join("empty.etd"), []).unwrap();
    for command in ["render", "inspect"] {
        for (file, part) in [
            ("short.etd", "shorter"),
            ("foreign.etd", "not an Étendue blob"),
            ("empty.etd", "shorter"),
            ("none.etd", "none.etd"),
        ] {
            let mut arguments = vec![command, file];
            if command == "render" {
                arguments.extend(["-o", "x.exr"]);
            }
            refused(&at, &arguments, &[file, part]);
        }
    }
    refused(
        &at,
        &["render", "good.etd", "-o", "x.exr", "--width", "8"],
        &["good.etd", "--width"],
    );
}

#[test]
fn files_and_outputs() {
    let (_keep, at) = folder();
    std::fs::create_dir(at.join("folder.exr")).unwrap();
    refused(&at, &["render", "none.xml", "-o", "x.exr"], &["none.xml"]);
    refused(
        &at,
        &["render", "scene.xml", "-o", "x.gif"],
        &["x.gif", ".png"],
    );
    refused(
        &at,
        &["render", "scene.xml", "-o", "folder.exr"],
        &["folder.exr"],
    );
    refused(
        &at,
        &["render", "scene.xml", "-o", "no/such/x.exr"],
        &["no/such/x.exr"],
    );
    refused(
        &at,
        &["render", "scene.xml", "-o", "x.png", "-o", "no/y.png"],
        &["no/y.png"],
    );
    refused(
        &at,
        &["render", "scene.xml", "-o", "x.exr", "-D", "unheard=1"],
        &["unheard"],
    );
    refused(
        &at,
        &["compile", "scene.xml", "-o", "x.bin"],
        &["x.bin", ".etd"],
    );
    refused(
        &at,
        &["compile", "scene.xml", "-o", "no/x.etd"],
        &["no/x.etd"],
    );
    succeed(&at, &["render", "scene.xml", "-o", "a.exr", "--quiet"]);
    succeed(
        &at,
        &[
            "render",
            "scene.xml",
            "-o",
            "b.exr",
            "--quiet",
            "--width",
            "8",
        ],
    );
    refused(&at, &["compare", "a.exr", "b.exr"], &["16 × 12", "8 × 6"]);
    refused(&at, &["compare", "a.exr", "none.exr"], &["none.exr"]);
    refused(
        &at,
        &["compare", "a.exr", "scene.xml"],
        &["scene.xml", ".exr"],
    );
    refused(
        &at,
        &["compare", "a.exr", "a.exr", "-o", "d.gif"],
        &["d.gif"],
    );
    refused(
        &at,
        &["compare", "a.exr", "a.exr", "-o", "no/d.png"],
        &["no/d.png"],
    );
}

#[test]
fn damaged_images() {
    let (_keep, at) = folder();
    let outputs = ["-o", "a.exr", "-o", "a.hdr", "-o", "a.png"];
    succeed(
        &at,
        &[&["render", "scene.xml", "--quiet"], &outputs[..]].concat(),
    );
    for extension in ["exr", "hdr", "png"] {
        let good = std::fs::read(at.join(format!("a.{extension}"))).unwrap();
        let bad = format!("bad.{extension}");
        for length in [0, 20, good.len() / 2, good.len() - 16] {
            std::fs::write(at.join(&bad), &good[..length]).unwrap();
            refused(&at, &["compare", "a.exr", &bad], &[&bad]);
        }
        std::fs::write(at.join(&bad), [0x5a; 512]).unwrap();
        refused(&at, &["compare", &bad, "a.exr"], &[&bad]);
    }
    exr::prelude::write_rgb_file(at.join("nan.exr"), 16, 12, |x, y| {
        let x = if (x, y) == (3, 7) { f32::NAN } else { 1.0 };
        (1.0, x, 1.0)
    })
    .unwrap();
    refused(
        &at,
        &["compare", "nan.exr", "a.exr"],
        &["nan.exr", "column 3, row 7"],
    );
}

/// An older image stays as it is when its successor is refused, and so does everything if one of several outputs is.
#[test]
fn what_was_there_stays() {
    let (_keep, at) = folder();
    std::fs::write(at.join("x.png"), "old").unwrap();
    refused(&at, &["render", "none.xml", "-o", "x.png"], &["none.xml"]);
    refused(
        &at,
        &["render", "scene.xml", "-o", "x.png", "-o", "x.tiff"],
        &["x.tiff"],
    );
    assert_eq!(std::fs::read(at.join("x.png")).unwrap(), b"old");
}

/// A size that films do not have.
#[test]
fn an_image_too_large() {
    let (_keep, at) = folder();
    let size = ["--width", "65537", "--height", "4"];
    refused(
        &at,
        &[&["render", "scene.xml", "-o", "x.exr"], &size[..]].concat(),
        &["65536"],
    );
}

/// Usage errors are clap's: exit code 2.
#[test]
fn usage() {
    let (_keep, at) = folder();
    let bad: [&[&str]; 14] = [
        &["render", "scene.xml"],
        &["render", "scene.xml", "-o", "x.exr", "--spp", "0"],
        &[
            "render",
            "scene.xml",
            "-o",
            "x.exr",
            "--spp",
            "1",
            "--time",
            "1s",
        ],
        &["render", "scene.xml", "-o", "x.exr", "--time", "soon"],
        &["render", "scene.xml", "-o", "x.exr", "--error", "0"],
        &["render", "scene.xml", "-o", "x.exr", "--error", "120%"],
        &["render", "scene.xml", "-o", "x.exr", "--estimator", "magic"],
        &["render", "scene.xml", "-o", "x.exr", "--tonemap", "gamma:1"],
        &["render", "scene.xml", "-o", "x.exr", "--max-depth", "-2"],
        &["render", "scene.xml", "-o", "x.exr", "--max-depth", "2.5"],
        &["render", "scene.xml", "-o", "x.exr", "--threads", "0"],
        &["render", "scene.xml", "-o", "x.png", "--exposure", "nan"],
        &[
            "render",
            "scene.xml",
            "-o",
            "x.png",
            "--tonemap",
            "gamma:1,0,0",
        ],
        &["render", "scene.xml", "-o", "x.exr", "-D", "grey"],
    ];
    for arguments in bad {
        let output = etendue(&at, arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(text(&output.stderr).starts_with("error: "), "{arguments:?}");
    }
    assert_eq!(listing(&at), ["scene.xml"]);
}

#[test]
fn light_maps() {
    let (_keep, at) = folder();
    with_floor(&at);
    let bake = |scene: &'static str, shape: &'static str| {
        [
            "bake", scene, "--shape", shape, "-o", "x.exr", "--width", "8", "--height", "8",
        ]
    };
    refused(
        &at,
        &bake("named.xml", "roof"),
        &["named.xml", "\"roof\"", "\"ground\""],
    );
    succeed(&at, &["compile", "named.xml", "-o", "named.etd"]);
    refused(
        &at,
        &bake("named.etd", "ground"),
        &["named.etd", "no names"],
    );
    let round = SCENE.replacen("type=\"sphere\"", "type=\"sphere\" id=\"lamp\"", 1);
    std::fs::write(at.join("round.xml"), round).unwrap();
    refused(
        &at,
        &bake("round.xml", "lamp"),
        &["round.xml:15", "lamp", "no texture coordinates"],
    );
    let mesh = |file: &str, uvs: &str, faces: &str| {
        let obj = format!("v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\n{uvs}{faces}");
        std::fs::write(at.join(format!("{file}.obj")), obj).unwrap();
        let shape = format!(
            "<shape type=\"obj\" id=\"card\"><string name=\"filename\" value=\"{file}.obj\"/></shape></scene>"
        );
        let scene = SCENE.replacen("</scene>", &shape, 1);
        std::fs::write(at.join(format!("{file}.xml")), scene).unwrap();
    };
    mesh("bare", "", "f 1 3 2\nf 1 4 3\n");
    refused(
        &at,
        &bake("bare.xml", "card"),
        &["bare.xml:19", "card", "no texture coordinates"],
    );
    mesh(
        "twice",
        "vt 0 0\nvt 1 0\nvt 1 1\n",
        "f 1/1 3/3 2/2\nf 1/1 4/2 3/3\n",
    );
    refused(
        &at,
        &bake("twice.xml", "card"),
        &["twice.xml:19", "card", "triangles 0 and 1 overlap"],
    );
    mesh("far", "vt 0 0\nvt 1 0\nvt 1 2\n", "f 1/1 3/3 2/2\n");
    refused(
        &at,
        &bake("far.xml", "card"),
        &["far.xml:19", "card", "[0, 1]"],
    );
}

#[test]
fn estimators_that_cannot_answer() {
    let sky = "<emitter type=\"constant\"/></scene>";
    let (_keep, at) = folder();
    std::fs::write(at.join("sky.xml"), SCENE.replacen("</scene>", sky, 1)).unwrap();
    refused(
        &at,
        &[
            "render",
            "sky.xml",
            "-o",
            "x.exr",
            "--estimator",
            "quadrature",
        ],
        &["sky.xml", "quadrature+path"],
    );
    for branching in ["0", "8,,2", "1,1,1,1,1,1,1,1,1", "255,255", "256", ""] {
        let flag = format!("--branching={branching}");
        let output = etendue(&at, &["render", "sky.xml", "-o", "x.exr", &flag]);
        let error = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{branching:?}: {error}");
        assert!(error.contains("8,4,2"), "{error}");
    }
}
