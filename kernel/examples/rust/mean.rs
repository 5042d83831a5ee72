//! The kernel alone, with whatever features it is built with: mean SCENE.etd path|light|bidirectional|metropolis SAMPLES [sobol]
//! renders the scene so often and prints the image's mean. Of metropolis, that of as many steps of some chains, which isn't the image's: they count for what they
//! cost.
use etendue::random::Sequence;
use etendue::{Estimator, Scene, Scratch, Settings};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, estimator, samples, sequence @ ..] = &arguments[..] else {
        return Err("expected a blob, an estimator and a number of samples".into());
    };
    let file = std::fs::read(file)?;
    // Blobs lie at multiples of 16.
    let mut blob = vec![0u128; file.len().div_ceil(16)];
    bytemuck::cast_slice_mut(&mut blob)[..file.len()].copy_from_slice(&file);
    let scene = Scene::open(&bytemuck::cast_slice(&blob)[..file.len()])?;
    let settings = Settings {
        estimator: match estimator.as_str() {
            "path" => Estimator::Path,
            #[cfg(feature = "light")]
            "light" => Estimator::Light,
            #[cfg(feature = "bidirectional")]
            "bidirectional" => Estimator::Bidirectional,
            #[cfg(feature = "metropolis")]
            "metropolis" => Estimator::Metropolis,
            other => return Err(format!("no such estimator in this build: {other}").into()),
        },
        sequence: match sequence {
            [] => Sequence::Independent,
            #[cfg(feature = "sobol")]
            [name] if name == "sobol" => Sequence::Sobol,
            other => return Err(format!("no such numbers in this build: {other:?}").into()),
        },
        ..Settings::default()
    };
    let ([width, height], samples) = (scene.size(), samples.parse()?);
    let mut scratch = Box::new(Scratch::<32>::new());
    let mut sum = [0.0; 3];
    let mut add = |_: [u32; 2], value: etendue::Rgb| {
        for (sum, x) in sum.iter_mut().zip(value.to_array()) {
            *sum += f64::from(x);
        }
    };
    #[cfg(feature = "metropolis")]
    let rows = if settings.estimator == Estimator::Metropolis {
        // A chain for each row, from a sample that meets light.
        let mut view = scratch.view(&scene);
        let starts = (0..1 << 20)
            .filter(|&i| scene.bootstrap(&settings, i, &mut view, &mut |_, _| ()) > 0.0);
        let starts: Vec<u64> = starts.take(height as usize).collect();
        for (id, index) in (0..).zip(starts) {
            let mut chain = etendue::estimate::Chain::<16>::new();
            chain.start(&scene, &settings, id, index, &mut view);
            let steps = u64::from(width) * samples;
            chain.advance(&scene, &settings, 1.0, steps, &mut view, &mut add);
        }
        0
    } else {
        height
    };
    #[cfg(not(feature = "metropolis"))]
    let rows = height;
    for y in 0..rows {
        for x in 0..width {
            for index in 0..samples {
                let own = scene.estimate(&settings, [x, y], index, &mut scratch, &mut add);
                add([x, y], own);
            }
        }
    }
    let count = f64::from(width * height) * samples as f64;
    let [r, g, b] = sum.map(|s| s / count);
    println!("{r} {g} {b} W/(m2 sr)");
    Ok(())
}
