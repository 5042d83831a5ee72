//! Local models by way of the compiler: what the kernel takes for those of a description.

use super::kernel::blob::format::{Material, section};
use super::kernel::spectrum::Rgb;
use super::kernel::surface::{Surface, TextureView};
use super::zoo::All;
use etendue_tests::media::records;
use etendue_tests::render::blob;
use etendue_tests::scenes::Builder;

/// Nothing is textured here.
pub const NONE: TextureView<'static> = TextureView {
    textures: &[],
    texels: &[],
};

/// The records of a description's local models, in its order.
pub fn materials(describe: impl FnOnce(&mut Builder)) -> Vec<Material> {
    let mut b = Builder::new();
    describe(&mut b);
    // A scene has something in it.
    b.sphere([0.0; 3], 1.0, Some(0));
    records(&blob(&b.description), section::MATERIALS)
}

/// What a record stands for.
pub fn surface(m: &Material) -> Surface<Rgb> {
    Surface::resolve::<All>(m, NONE, &(), 0, [0.5; 2])
}
