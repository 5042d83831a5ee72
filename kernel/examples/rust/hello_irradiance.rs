//! How much light falls on a point: hello_irradiance SCENE.etd x y z nx ny nz
use etendue::{Scene, Scratch, Settings, blob::BlobError, real::Vec3};
use etendue_host::blob::AlignedBlob;

fn irradiance(blob: &[u8], position: Vec3, normal: Vec3) -> Result<[f32; 3], BlobError> {
    let scene = Scene::open(blob)?; // any bytes, checked once
    let settings = Settings::default(); // path tracing, paths of any length
    let mut scratch = Scratch::<8>::new(); // all the memory there is, yours
    let mut sum = [0.0; 3];
    for index in 0..4096 {
        let e = scene.irradiance(&settings, position, normal, 0, index, &mut scratch);
        for (sum, e) in sum.iter_mut().zip(e.to_array()) {
            *sum += f64::from(e);
        }
    }
    Ok(sum.map(|s| (s / 4096.0) as f32))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let file = arguments.get(1).ok_or("which scene?")?;
    let numbers = arguments[2..].iter().map(|n| n.parse());
    let [x, y, z, nx, ny, nz] = numbers.collect::<Result<Vec<f32>, _>>()?[..] else {
        return Err("expected a position and a normal".into());
    };
    let blob = AlignedBlob::read(file.as_ref())?; // blobs lie at multiples of 16
    let [r, g, b] = irradiance(blob.bytes(), Vec3::new(x, y, z), Vec3::new(nx, ny, nz))?;
    println!("{r} {g} {b} W/m2");
    Ok(())
}
