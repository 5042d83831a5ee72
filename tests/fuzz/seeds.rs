//! Where the seeds in `data/fuzz` come from: small well-formed inputs of every kind, and the well-known ways to be
//! hostile. `cargo test --release -p etendue-tests --test fuzz -- --ignored` writes them anew; what fuzzing added
//! (`found_…`, and inputs named after a bug) stays.

use etendue::blob::format::{Header, Toc};
use etendue_tests::bits::scenes;
use etendue_tests::render::blob;
use std::collections::BTreeMap;
use std::io::Write;

/// Name → bytes.
type Seeds = BTreeMap<String, Vec<u8>>;

#[test]
#[ignore = "writes the seeds anew"]
fn write_seeds() {
    for (target, seeds) in [
        ("blob", blobs()),
        ("capi", streams(16, 1200)),
        ("mesh", meshes()),
        ("scene", streams(16, 700)),
        ("xml", xmls()),
    ] {
        let folder = super::folder(target);
        std::fs::create_dir_all(&folder).unwrap();
        for (name, bytes) in seeds {
            std::fs::write(folder.join(name), bytes).unwrap();
        }
    }
}

/// Numbers without meaning, the same each time (SplitMix64).
fn streams(count: u64, length: usize) -> Seeds {
    let mut state = 0u64;
    let mut next = move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as u8
    };
    let stream = |i| {
        let bytes = (0..length).map(|_| next()).collect();
        (format!("choices_{i:02}"), bytes)
    };
    (0..count).map(stream).collect()
}

fn blobs() -> Seeds {
    let mut seeds = Seeds::new();
    let mut whole = Vec::new();
    for (name, description) in scenes() {
        let bytes = blob(&description).bytes().to_vec();
        whole.clone_from(&bytes);
        seeds.insert(name.into(), bytes);
    }
    let toc = size_of::<Header>();
    let entry = size_of::<Toc>();
    let mut change = |name: &str, at: usize, with: &[u8]| {
        let mut bytes = whole.clone();
        bytes[at..at + with.len()].copy_from_slice(with);
        seeds.insert(name.into(), bytes);
    };
    change("not_a_number", whole.len() - 4, &f32::NAN.to_le_bytes());
    change("huge_count", toc + 2 * entry + 16, &u64::MAX.to_le_bytes());
    change(
        "huge_offset",
        toc + 2 * entry + 8,
        &(u64::MAX - 63).to_le_bytes(),
    );
    change("long_length", 16, &u64::MAX.to_le_bytes());
    change("two_sections_of_a_kind", toc, &2u32.to_le_bytes());
    seeds.insert("cut".into(), whole[..whole.len() - 64].to_vec());
    seeds.insert("header_alone".into(), whole[..toc].to_vec());
    seeds
}

/// The body takes the format from the first byte.
const OBJ: u8 = 0;
const OBJ_FLIPPED: u8 = 4;
const PLY: u8 = 1;
const SERIALIZED: u8 = 2;
const VOLUME: u8 = 15;

fn meshes() -> Seeds {
    let mut seeds = Seeds::new();
    let mut add = |name: &str, format: u8, file: &[u8]| {
        seeds.insert(name.into(), [&[format], file].concat());
    };
    let quad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\n";
    let obj = |faces: &str| format!("# a quad\no q\n{quad}{faces}").into_bytes();
    add("obj_quad", OBJ, &obj("f 1/1/1 2/1/1 3/2/1 4/2/1\n"));
    add(
        "obj_from_the_end",
        OBJ_FLIPPED,
        &obj("s off\nusemtl m\nf -4//-1 -3//-1 -2//-1\n"),
    );
    add(
        "obj_index_out_of_range",
        OBJ,
        &obj("f 1 2 99999999999999999999\nf 0 0 0\n"),
    );
    add(
        "obj_not_a_number",
        OBJ,
        b"v nan inf -1e999\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    );
    add(
        "obj_many_chains",
        OBJ,
        (quad.to_string() + &"f 1/1 2/2 3\nf 1 2/1 3/2\n".repeat(40)).as_bytes(),
    );

    let header = |format: &str, vertices: &str, faces: &str, kind: &str| {
        format!(
            "ply\nformat {format} 1.0\ncomment c\nelement vertex {vertices}\nproperty {kind} x\nproperty {kind} y\nproperty {kind} z\n\
             element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
        )
    };
    let text = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let ascii = |v: &str, f: &str| (header("ascii", v, f, "float") + text).into_bytes();
    add("ply_ascii", PLY, &ascii("3", "1"));
    add(
        "ply_huge_counts",
        PLY,
        &ascii("18446744073709551615", "4294967296"),
    );
    add("ply_many_vertices", PLY, &ascii("4000000000", "1"));
    add("ply_negative_count", PLY, &ascii("-1", "1"));
    let positions = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut little = header("binary_little_endian", "3", "1", "float").into_bytes();
    let mut big = header("binary_big_endian", "3", "1", "double").into_bytes();
    for p in positions {
        little.extend(p.to_le_bytes());
        big.extend(f64::from(p).to_be_bytes());
    }
    little.push(3);
    big.push(3);
    for i in 0..3u32 {
        little.extend(i.to_le_bytes());
        big.extend(i.to_be_bytes());
    }
    add("ply_little_endian", PLY, &little);
    add("ply_big_endian", PLY, &big);
    add("ply_cut", PLY, &little[..little.len() - 7]);
    add(
        "ply_records_of_nothing",
        PLY,
        b"ply\nformat ascii 1.0\nelement thing 99999999999999\nelement vertex 0\nproperty float x\nproperty float y\n\
          property float z\nend_header\n",
    );
    add(
        "ply_normals_and_uvs",
        PLY,
        b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n\
          property float ny\nproperty float nz\nproperty float u\nproperty float v\nelement face 1\nproperty uchar flags\n\
          property list uint8 uint32 vertex_index\nend_header\n0 0 0 0 0 1 0 0\n1 0 0 0 0 1 1 0\n0 1 0 0 0 1 0 1\n7 3 0 1 2\n",
    );
    serialized(&mut add);
    volumes(&mut add);
    seeds
}

fn volumes(add: &mut impl FnMut(&str, u8, &[u8])) {
    let file = |words: [u32; 5], data: &[f32]| {
        let mut bytes = b"VOL\x03".to_vec();
        bytes.extend(words.iter().flat_map(|w| w.to_le_bytes()));
        let numbers = [0.0f32, 0.0, 0.0, 1.0, 1.0, 1.0].iter().chain(data);
        bytes.extend(numbers.flat_map(|x| x.to_le_bytes()));
        bytes
    };
    let data: Vec<f32> = (0u8..24).map(|i| f32::from(i) * 0.125).collect();
    let gray = file([1, 2, 3, 4, 1], &data);
    add("volume_gray", VOLUME, &gray);
    add("volume_gray_residual", VOLUME | 16, &gray);
    add(
        "volume_rgb_woodcock",
        VOLUME | 32,
        &file([1, 2, 2, 2, 3], &data),
    );
    add("volume_cut", VOLUME, &gray[..gray.len() - 3]);
    add(
        "volume_not_a_number",
        VOLUME,
        &file([1, 1, 1, 2, 1], &[0.5, f32::NAN]),
    );
    add(
        "volume_huge",
        VOLUME,
        &file([1, u32::MAX, u32::MAX, u32::MAX, 3], &data),
    );
    add("volume_nothing", VOLUME, b"VOL\x03");
}

fn serialized(add: &mut impl FnMut(&str, u8, &[u8])) {
    let file = |version: u16, content: &[u8], table: &[u8]| {
        let mut bytes = vec![0x1c, 0x04];
        bytes.extend(version.to_le_bytes());
        let fast = flate2::Compression::fast();
        let mut zlib = flate2::write::ZlibEncoder::new(bytes, fast);
        zlib.write_all(content).unwrap();
        let mut bytes = zlib.finish().unwrap();
        bytes.extend(table);
        bytes
    };
    let content = |flags: u32, name: &[u8], vertices: u64, triangles: u64, floats: &[f32]| {
        let mut c = flags.to_le_bytes().to_vec();
        c.extend(name);
        c.extend(vertices.to_le_bytes());
        c.extend(triangles.to_le_bytes());
        floats.iter().for_each(|f| c.extend(f.to_le_bytes()));
        (0..3u32).for_each(|i| c.extend(i.to_le_bytes()));
        c
    };
    let flat = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let table: &[u8] = &[0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0];
    let plain = file(4, &content(0x1000, b"mesh\0", 3, 1, &flat), table);
    let normals = [flat.as_slice(), &[0.0, 0.0, 1.0].repeat(3), &[0.5; 6]].concat();
    let rich = file(3, &content(0x1003, b"", 3, 1, &normals), &table[4..]);
    add("serialized_4", SERIALIZED, &plain);
    add("serialized_3_normals_and_uvs", SERIALIZED, &rich);
    add("serialized_cut", SERIALIZED, &plain[..plain.len() * 2 / 3]);
    let huge = content(0x1000, b"\0", u64::MAX, u64::MAX / 12, &flat);
    add("serialized_huge_counts", SERIALIZED, &file(4, &huge, table));
    let many = content(0x1000, b"\0", u64::from(u32::MAX), 1 << 31, &flat);
    add("serialized_4g_vertices", SERIALIZED, &file(4, &many, table));
    let bomb = vec![0; 1 << 14];
    add("serialized_zeros", SERIALIZED, &file(4, &bomb, table));
    let name = vec![b'n'; 1 << 14];
    add(
        "serialized_endless_name",
        SERIALIZED,
        &file(4, &[&[0; 4], &*name].concat(), table),
    );
    // The second mesh, of a table whose entries point anywhere.
    let wild = [&[0xff; 16], [2, 0, 0, 0].as_slice()].concat();
    let flags = SERIALIZED | 1 << 4;
    let body = content(0x1000, b"\0", 3, 1, &flat);
    add("serialized_wild_table", flags, &file(4, &body, &wild));
}

fn xmls() -> Seeds {
    let mut seeds = Seeds::new();
    let mut add = |name: &str, text: String| {
        seeds.insert(name.into(), text.into_bytes());
    };
    let around = |inside: &str| format!("<scene version=\"3.0.0\">{inside}</scene>");
    let film = r#"<film type="hdrfilm"><integer name="width" value="4"/><integer name="height" value="3"/><rfilter type="box"/></film>"#;
    let sensor = format!(
        r#"<sensor type="perspective"><float name="fov" value="45"/><transform name="to_world"><lookat origin="0, -4, 0" target="0, 0, 0" up="0, 0, 1"/></transform>{film}</sensor>"#
    );
    let lamp = r#"<emitter type="constant"><rgb name="radiance" value="1, 0.5, 0.25"/></emitter>"#;
    for (name, shape) in [
        (
            "sphere",
            r#"<shape type="sphere"><point name="center" x="0" y="1" z="0"/><float name="radius" value="0.5"/><bsdf type="dielectric"><float name="int_ior" value="1.6"/></bsdf></shape>"#,
        ),
        (
            "mesh_files",
            r#"<shape type="obj"><string name="filename" value="m.obj"/><bsdf type="conductor"><string name="material" value="none"/></bsdf></shape><shape type="ply"><string name="filename" value="m.ply"/><bsdf type="twosided"><bsdf type="diffuse"><texture type="bitmap" name="reflectance"><string name="filename" value="t.png"/></texture></bsdf></bsdf></shape>"#,
        ),
        (
            "rectangle",
            r#"<default name="k" value="2"/><bsdf type="diffuse" id="w"><texture type="checkerboard" name="reflectance"><rgb name="color0" value="0.1"/></texture></bsdf><shape type="rectangle"><transform name="to_world"><scale value="$k"/><rotate x="1" angle="90"/><translate z="-1"/></transform><ref id="w"/><emitter type="area"><rgb name="radiance" value="3"/></emitter></shape>"#,
        ),
        (
            "lights",
            r#"<emitter type="point"><point name="position" x="1" y="0" z="0"/><rgb name="intensity" value="1"/></emitter><emitter type="spot"><float name="cutoff_angle" value="30"/><rgb name="intensity" value="2"/></emitter><emitter type="directional"><vector name="direction" x="0" y="0" z="-1"/><rgb name="irradiance" value="1"/></emitter><shape type="cube"><bsdf type="mask"><float name="opacity" value="0.5"/><bsdf type="sheet"/></bsdf></shape>"#,
        ),
        (
            "fog",
            r#"<medium type="homogeneous" id="fog"><rgb name="sigma_t" value="0.1, 0.5, 1"/><float name="albedo" value="0.9"/><rgb name="emission" value="0.5"/><phase type="blendphase"><float name="weight" value="0.25"/><phase type="hg"><float name="g" value="0.6"/></phase><phase type="rayleigh"/></phase></medium><shape type="cube"><transform name="to_world"><scale value="6"/></transform><bsdf type="null"/><ref name="interior" id="fog"/></shape><shape type="sphere"><bsdf type="dielectric"/><ref name="exterior" id="fog"/></shape><emitter type="point"><ref name="medium" id="fog"/></emitter>"#,
        ),
        (
            "smoke",
            r#"<shape type="cube"><bsdf type="null"/><medium name="interior" type="heterogeneous"><volume name="sigma_t" type="gridvolume"><string name="filename" value="v.vol"/><transform name="to_world"><scale value="2"/><translate x="-1" y="-1" z="-1"/></transform></volume><volume name="albedo" type="constvolume"><rgb name="value" value="0.5"/></volume><float name="scale" value="3"/><rgb name="emission" value="1"/></medium></shape>"#,
        ),
        (
            "dispersion",
            r#"<shape type="sphere"><bsdf type="dielectric"><string name="dispersion" value="sellmeier 1.7 0.3 1.9 0.013 0.06 155"/></bsdf><emitter type="area"><spectrum name="radiance" value="450:1 600:3"/></emitter></shape><shape type="cube"><bsdf type="diffuse"><spectrum name="reflectance" value="400:0.1, 500:0.9"/></bsdf></shape><shape type="cube"><bsdf type="dielectric"><string name="dispersion" value="table 400:1.6 700:1.5"/></bsdf></shape><emitter type="point"><spectrum name="intensity" value="550:1"/></emitter>"#,
        ),
        (
            "media_that_overlap",
            r#"<medium type="homogeneous" id="a"/><medium type="homogeneous" id="b"><phase type="forward"/></medium><shape type="sphere"><bsdf type="null"/><ref name="interior" id="a"/></shape><shape type="sphere"><point name="center" x="1" y="0" z="0"/><bsdf type="null"/><ref name="interior" id="b"/></shape>"#,
        ),
    ] {
        add(name, around(&format!("{sensor}{shape}{lamp}")));
    }
    add(
        "orthographic",
        around(&format!(
            r#"<sensor type="orthographic"><float name="near_clip" value="0.1"/><float name="far_clip" value="100"/>{film}</sensor>{lamp}<shape type="disk"/>"#
        )),
    );
    add(
        "environment",
        around(&format!(
            r#"{sensor}<emitter type="envmap"><string name="filename" value="t.png"/></emitter><shape type="cylinder"/>"#
        )),
    );
    add("nothing", around(""));
    add("not_xml", "scene version 3".into());
    add(
        "not_numbers",
        around(&format!(
            r#"{sensor}<shape type="sphere"><point name="center" x="nan" y="inf" z="-1e999"/><float name="radius" value="1e-50"/></shape>"#
        )),
    );
    let nested =
        |tag: &str, depth| format!("<{tag}>").repeat(depth) + &format!("</{tag}>").repeat(depth);
    add("nested_10000_deep", around(&nested("x", 10_000)));
    add("known_nested_900_deep", around(&nested("bsdf", 900)));
    add("opened_10000_deep", "<s>".repeat(10_000));
    let mut bomb = String::from("<!DOCTYPE scene [<!ENTITY a0 \"lol\">");
    for i in 1..=30 {
        let before = format!("&a{};", i - 1).repeat(10);
        bomb += &format!("<!ENTITY a{i} \"{before}\">");
    }
    add("entity_bomb", format!("{bomb}]>{}", around("&a30;")));
    add(
        "entity_loop",
        format!(
            "<!DOCTYPE s [<!ENTITY a \"&b;\"><!ENTITY b \"&a;\">]>{}",
            around("&a;")
        ),
    );
    add(
        "entity_of_a_file",
        format!(
            "<!DOCTYPE s [<!ENTITY a SYSTEM \"file:///etc/passwd\">]>{}",
            around("&a;")
        ),
    );
    let chain: String = (0..200)
        .map(|i| format!("<default name=\"d{i}\" value=\"$d{}\"/>", i + 1))
        .collect();
    add(
        "defaults_in_a_chain",
        around(&(chain + "<integer name=\"n\" value=\"$d0\"/>")),
    );
    let doubling: String = (0..40)
        .map(|i| format!("<default name=\"e{}\" value=\"$e{i}$e{i}\"/>", i + 1))
        .collect();
    add(
        "defaults_that_double",
        around(&format!("<default name=\"e0\" value=\"xx\"/>{doubling}")),
    );
    add(
        "includes_itself",
        around("<include filename=\"scene.xml\"/>"),
    );
    add(
        "ref_to_itself",
        around(
            "<bsdf type=\"twosided\" id=\"a\"><ref id=\"a\"/></bsdf><shape type=\"sphere\"><ref id=\"a\"/></shape>",
        ),
    );
    add(
        "huge_film",
        around(&sensor.replace("value=\"4\"", "value=\"4294967295\"")),
    );
    seeds
}
