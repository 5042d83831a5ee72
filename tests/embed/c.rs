//! Programs in C and C++ over the freestanding library: strictly compiled, run, run under valgrind and sanitizers.

use crate::tools::{cargo, have, run, target, text};
use etendue::estimate::{Chain, Pilot};
use etendue::random::Sequence;
use etendue::real::Vec3;
use etendue::{Estimator, Scene, Scratch, Settings};
use etendue_host::blob::AlignedBlob;
use etendue_host::scene::{Changes, prepare};
use etendue_tests::place::root;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

/// `libetendue.a` as users build it.
static LIBRARY: LazyLock<PathBuf> = LazyLock::new(|| {
    // Where README's line builds it too.
    let folder = root().canonicalize().unwrap().join("target/capi");
    run(&mut cargo("kernel/capi", &folder));
    folder.join("release/libetendue.a")
});

/// The Cornell box as a blob, `size` pixels wide.
pub fn cornell(folder: &Path, size: u32) -> (PathBuf, AlignedBlob) {
    let size = Changes {
        width: Some(size),
        ..Changes::default()
    };
    let blob = prepare(&root().join("host/scenes/cornell-box.xml"), &[], size)
        .unwrap()
        .blob;
    let file = folder.join("cornell.etd");
    std::fs::write(&file, blob.bytes()).unwrap();
    (file, blob)
}

/// Compiles one example.
fn compile(compiler: &[&str], source: &Path, flags: &[&str], out: &Path) {
    run(Command::new(compiler[0])
        .args(&compiler[1..])
        .args(["-O2", "-Wall", "-Wextra", "-Werror", "-pedantic"])
        .arg("-I")
        .arg(root().join("kernel/include"))
        .arg("-o")
        .arg(out)
        .arg(source)
        .arg(&*LIBRARY)
        .args(["-lm", "-lpthread"])
        .args(flags));
}

/// `hello_irradiance`, compiled.
pub fn hello(folder: &Path) -> PathBuf {
    let program = folder.join("hello");
    let source = example("hello_irradiance.c");
    compile(&["gcc", "-std=c99"], &source, &[], &program);
    program
}

fn example(name: &str) -> PathBuf {
    root().join("kernel/examples/c").join(name)
}

const SANITIZERS: [&str; 2] = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"];

/// A program's command lines: as it is, under valgrind, with sanitizers.
fn ways(compiler: &[&str], source: &Path, folder: &Path, flags: &[&str]) -> Vec<Command> {
    let plain = folder.join("plain");
    compile(compiler, source, flags, &plain);
    let sanitized = folder.join("sanitized");
    compile(compiler, source, &[flags, &SANITIZERS].concat(), &sanitized);
    let mut ways = vec![Command::new(&plain), Command::new(sanitized)];
    if have("valgrind") {
        let mut command = Command::new("valgrind");
        command
            // What Embree's threads keep to the end isn't lost.
            .args([
                "-q",
                "--error-exitcode=9",
                "--leak-check=full",
                "--errors-for-leak-kinds=definite,indirect",
            ])
            .arg(plain);
        ways.push(command);
    }
    ways
}

#[test]
fn hello_irradiance_prints_what_the_kernel_says() {
    if !have("gcc") {
        return;
    }
    let folder = target("hello");
    let (file, blob) = cornell(&folder, 64);
    let scene = Scene::open(blob.bytes()).unwrap();
    let settings = Settings::default();
    let mut scratch = Scratch::<8>::new();
    let mut sum = [0.0f64; 3];
    for index in 0..4096 {
        let point = Vec3::new(278.0, 0.0, 279.0);
        let e = scene.irradiance(&settings, point, Vec3::Y, 0, index, &mut scratch);
        for (s, v) in sum.iter_mut().zip(e.to_array()) {
            *s += f64::from(v);
        }
    }
    for mut way in ways(
        &["gcc", "-std=c99"],
        &example("hello_irradiance.c"),
        &folder,
        &[],
    ) {
        let printed = text(&run(way
            .arg(&file)
            .args(["278", "0", "279", "0", "1", "0"])));
        let values: Vec<f64> = printed
            .split_whitespace()
            .filter_map(|w| w.parse().ok())
            .collect();
        assert_eq!(values.len(), 3, "{printed}");
        for (value, s) in values.iter().zip(sum) {
            assert!(
                (value / (s / 4096.0) - 1.0).abs() < 1e-5,
                "{printed}, {sum:?}"
            );
        }
    }
    // A blob that isn't one.
    let broken = Command::new(folder.join("plain"))
        .arg(root().join("Cargo.toml"))
        .args(["0", "0", "0", "0", "1", "0"])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&broken.stderr).into_owned();
    assert!(
        !broken.status.success() && said.contains("not an Étendue blob"),
        "{said}"
    );
}

#[test]
fn a_baker_with_threads_gives_the_kernels_bits() {
    if !have("gcc") {
        return;
    }
    let folder = target("bake");
    let (file, blob) = cornell(&folder, 64);
    let scene = Scene::open(blob.bytes()).unwrap();
    let settings = Settings {
        estimator: Estimator::Bidirectional,
        ..Settings::default()
    };
    let mut scratch = Scratch::<32>::new();
    let mut expected = b"PF\n32 32\n-1.0\n".to_vec();
    for texel in 0..1024u16 {
        let along = |i: u16| (f32::from(i) + 0.5) / 32.0;
        let (s, t) = (along(texel % 32), along(texel / 32));
        let point = Vec3::new(0.0 + s * 550.0 + t * 0.0, 0.0, 0.0 + s * 0.0 + t * 559.0);
        let mut sum = [0.0f64; 3];
        for index in 0..64 {
            let id = u64::from(texel);
            let e = scene.irradiance(&settings, point, Vec3::Y, id, index, &mut scratch);
            for (s, v) in sum.iter_mut().zip(e.to_array()) {
                *s += f64::from(v);
            }
        }
        expected.extend(sum.iter().flat_map(|s| ((s / 64.0) as f32).to_le_bytes()));
    }
    for mut way in ways(&["gcc", "-std=c11"], &example("bake.c"), &folder, &[]) {
        let out = folder.join("floor.pfm");
        run(way.arg(&file).arg(&out));
        assert!(std::fs::read(&out).unwrap() == expected, "{way:?}");
    }
}

/// The same chains as the kernel's, from the same starts: the same bits. That they are right is `tests/agreement`'s business.
#[test]
fn chains_give_the_kernels_bits() {
    if !have("gcc") {
        return;
    }
    const SAMPLES: u64 = 1 << 14;
    const CHAINS: u64 = 64;
    const STEPS: u64 = 1024;
    const SIZE: u32 = 32;
    let folder = target("chains");
    let (file, blob) = cornell(&folder, SIZE);
    let scene = Scene::open(blob.bytes()).unwrap();
    let mut settings = Settings {
        estimator: Estimator::Metropolis,
        ..Settings::default()
    };
    let mut scratch = Scratch::<32>::new();
    let view = &mut scratch.view(&scene);
    let [width, height] = scene.size();
    let mut image = vec![[0.0f32; 3]; (width * height) as usize];
    let add = |image: &mut Vec<[f32; 3]>, [x, y]: [u32; 2], value: etendue::Rgb| {
        let pixel = &mut image[(y * width + x) as usize];
        for (sum, v) in pixel.iter_mut().zip(value.to_array()) {
            *sum += v;
        }
    };
    let mean: f64 = (0..SAMPLES)
        .map(|i| f64::from(scene.bootstrap(&settings, i, view, &mut |_, _| ()) / SAMPLES as f32))
        .sum();
    settings.mutations.above = (mean / 2.0) as f32;
    let estimates: Vec<f32> = (0..SAMPLES)
        .map(|i| scene.bootstrap(&settings, i, view, &mut |p, v| add(&mut image, p, v)))
        .collect();
    let sum: f64 = estimates.iter().map(|&e| f64::from(e)).sum();
    for id in 0..CHAINS {
        let mut place = (id as f64 + 0.5) / CHAINS as f64 * sum;
        let beyond = estimates.iter().position(|&e| {
            place -= f64::from(e);
            place < 0.0
        });
        let from = beyond.map_or(SAMPLES - 1, |sample| sample as u64);
        let mut chain = Chain::<16>::new();
        chain.start(&scene, &settings, id, from, view);
        let scale = (sum / (CHAINS * STEPS) as f64) as f32;
        let splat = &mut |p, v| add(&mut image, p, v);
        chain.advance(&scene, &settings, scale, STEPS, view, splat);
    }
    let mut expected = format!("PF\n{width} {height}\n-1.0\n").into_bytes();
    let share = width as f32 * height as f32 / SAMPLES as f32;
    for row in image.chunks(width as usize).rev() {
        let values = row.as_flattened().iter();
        expected.extend(values.flat_map(|v| (v * share).to_le_bytes()));
    }
    assert!(image.as_flattened().iter().sum::<f32>() > 0.0);
    for mut way in ways(&["gcc", "-std=c11"], &example("chains.c"), &folder, &[]) {
        let out = folder.join("chains.pfm");
        run(way.arg(&file).arg(&out));
        assert!(std::fs::read(&out).unwrap() == expected, "{way:?}");
    }
}

/// The same numbers as the kernel's own pilot, digit by digit. That they predict efficiency is `cargo bench --bench choices`' business.
#[test]
fn pilots_give_the_kernels_numbers() {
    if !have("gcc") {
        return;
    }
    let folder = target("choose");
    let (file, blob) = cornell(&folder, 32);
    let scene = Scene::open(blob.bytes()).unwrap();
    let mut scratch = Scratch::<32>::new();
    let mut lines = Vec::new();
    let mut best = (f64::INFINITY, "");
    for (estimator, name) in [
        (Estimator::Path, "path"),
        (Estimator::Light, "light"),
        (Estimator::Bidirectional, "bidirectional"),
    ] {
        let settings = Settings {
            estimator,
            sequence: Sequence::Sobol,
            ..Settings::default()
        };
        let mut pilot = Pilot::default();
        for i in 0..1 << 11 {
            scene.pilot(&settings, i, &mut scratch.view(&scene), &mut pilot);
        }
        assert!(pilot.bright && pilot.samples == 1 << 12, "{pilot:?}");
        // As C writes it: two digits of the exponent at least.
        let number = |x: f64| {
            let text = format!("{x:.9e}");
            let (digits, exponent) = text.split_once('e').unwrap();
            format!("{digits}e{:+03}", exponent.parse::<i32>().unwrap())
        };
        let (mse, cost) = (pilot.mse(), pilot.cost());
        lines.push(format!(
            "{name}: error {} at {} rays a sample\n",
            number(mse),
            number(cost)
        ));
        best = if mse * cost < best.0 {
            (mse * cost, name)
        } else {
            best
        };
    }
    lines.push(format!("{}\n", best.1));
    for mut way in ways(&["gcc", "-std=c11"], &example("choose.c"), &folder, &[]) {
        assert_eq!(text(&run(way.arg(&file))), lines.concat(), "{way:?}");
    }
}

#[test]
fn an_engines_own_ray_tracer_gives_the_same_image() {
    if !have("g++")
        || !(have("/usr/include/embree3/rtcore.h") || have("/usr/include/embree4/rtcore.h"))
    {
        return;
    }
    let folder = target("embree");
    let (file, _) = cornell(&folder, 48);
    let embree = if Path::new("/usr/include/embree4/rtcore.h").exists() {
        "-lembree4"
    } else {
        "-lembree3"
    };
    let source = example("embree.cpp");
    for mut way in ways(&["g++", "-std=c++17"], &source, &folder, &[embree]) {
        let printed = text(&run(way.arg(&file)));
        let values: Vec<f64> = printed
            .split_whitespace()
            .map(|w| w.parse().unwrap())
            .collect();
        let &[ours, theirs, error, different] = values.as_slice() else {
            panic!("{way:?}: {printed}");
        };
        // The same random numbers: what differs is a ray here and there. Seven standard errors of the difference, and a share of
        // pixels that a wrong answer to one kind of ray would exceed by far.
        assert!(
            (ours - theirs).abs() <= 7.0 * error && ours > 0.0,
            "{way:?}: {printed}"
        );
        assert!(different < 0.02, "{way:?}: {printed}");
        println!("{printed}");
    }
}

fn beside(name: &str) -> PathBuf {
    root().join("tests/embed").join(name)
}

#[test]
fn misuse_is_found_out() {
    if !have("gcc") {
        return;
    }
    let folder = target("misuse");
    for scene in ["matter", "gloss", "fog", "prism", "open_air"] {
        let blob = crate::bits::data(&format!("bits/{scene}.etd"));
        for mut way in ways(&["gcc", "-std=c11"], &beside("misuse.c"), &folder, &[]) {
            run(way.arg(&blob));
        }
    }
}

#[test]
fn the_callers_control_word_is_kept_and_does_not_matter() {
    if !have("gcc") || !cfg!(target_arch = "x86_64") {
        return;
    }
    let folder = target("control");
    compile(
        &["gcc", "-std=c11"],
        &beside("control.c"),
        &[],
        &folder.join("control"),
    );
    for scene in ["matter", "gloss", "fog", "prism", "open_air", "plan"] {
        let blob = crate::bits::data(&format!("bits/{scene}.etd"));
        run(Command::new(folder.join("control")).arg(blob));
    }
}

/// Stack is what an engine's job threads have little of. The most that any estimator may use on x86-64, whatever the capacity:
/// scratch is the caller's, not on the stack.
const STACK: usize = 12 * 1024;

#[test]
fn little_stack_is_used_whatever_the_capacity() {
    if !have("gcc") || !cfg!(all(target_arch = "x86_64", target_os = "linux")) {
        return;
    }
    let folder = target("stack");
    let program = folder.join("stack");
    compile(&["gcc", "-std=c11"], &beside("stack.c"), &[], &program);
    for scene in ["matter", "gloss", "fog", "prism", "open_air", "plan"] {
        let blob = crate::bits::data(&format!("bits/{scene}.etd"));
        let printed = text(&run(Command::new(&program).arg(blob)));
        print!("{printed}");
        let used: Vec<usize> = printed
            .lines()
            .map(|line| line.rsplit(' ').next().unwrap().parse().unwrap())
            .collect();
        assert_eq!(used.len(), 9);
        assert!(
            used.iter().all(|bytes| (500..=STACK).contains(bytes)),
            "{printed}"
        );
    }
}
