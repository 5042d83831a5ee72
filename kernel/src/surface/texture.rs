//! Colours over (u, v).

use crate::blob::format::{NONE, Texture, texture};
use crate::real::Real;
use crate::spectrum::Spectrum;

/// The textures of a scene and their texels.
#[derive(Clone, Copy, Debug)]
pub struct TextureView<'a> {
    /// Records.
    pub textures: &'a [Texture],
    /// Words.
    pub texels: &'a [u32],
}

impl TextureView<'_> {
    /// The colour of texture `id` at (u, v); white if there is none.
    #[inline(always)]
    pub fn color<S: Spectrum>(&self, id: u32, uv: [Real; 2]) -> S {
        if id == NONE {
            return S::WHITE;
        }
        match self.textures.get(id as usize) {
            Some(t) => S::from_rgb(self.look(t, uv)),
            None => S::WHITE,
        }
    }

    /// The first channel of texture `id`, as an opacity.
    #[inline(always)]
    pub fn opacity(&self, id: u32, uv: [Real; 2]) -> Real {
        self.textures
            .get(id as usize)
            .map_or(1.0, |t| Real::from(self.look(t, uv)[0]))
    }

    /// Textures are f32 in every precision, as the blob is.
    #[inline(never)]
    #[allow(clippy::unnecessary_cast)] // not unnecessary in the double-precision package
    fn look(&self, t: &Texture, uv: [Real; 2]) -> [f32; 3] {
        let [u, v] = t
            .to_uv
            .map(|[a, b, c]| finite(a * uv[0] as f32 + b * uv[1] as f32 + c));
        if t.kind == texture::CHECKERBOARD {
            let odd = |x: f32| floor(x) as i64 & 1;
            return t.color[if odd(u) == odd(v) { 0 } else { 1 }];
        }
        let (x, y) = (u * t.width as f32, v * t.height as f32);
        if t.flags & texture::NEAREST != 0 {
            return self.texel(t, floor(x), floor(y));
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (x0, y0) = (floor(x), floor(y));
        let (fx, fy) = (x - x0, y - y0);
        let [a, b] = [x0, x0 + 1.0].map(|c| self.texel(t, c, y0));
        let [c, d] = [x0, x0 + 1.0].map(|c| self.texel(t, c, y0 + 1.0));
        let mix = |a: f32, b: f32, f: f32| a * (1.0 - f) + b * f;
        core::array::from_fn(|i| {
            let at = |p: &[f32; 3]| p.get(i).copied().unwrap_or(0.0);
            mix(mix(at(&a), at(&b), fx), mix(at(&c), at(&d), fx), fy)
        })
    }

    /// One texel, of any column and row.
    #[inline(always)]
    fn texel(&self, t: &Texture, column: f32, row: f32) -> [f32; 3] {
        let x = wrap(column, t.width, t.flags) as usize;
        let y = wrap(row, t.height, t.flags) as usize;
        let at = t.texels as usize;
        let index = y * t.width as usize + x;
        let color = if t.kind == texture::FLOAT {
            match self.texels.get(at + 3 * index..at + 3 * index + 3) {
                Some(&[r, g, b]) => [f32::from_bits(r), f32::from_bits(g), f32::from_bits(b)],
                _ => [0.0; 3],
            }
        } else {
            let [r, g, b, a] = self
                .texels
                .get(at + index)
                .map_or([0; 4], |w| w.to_le_bytes());
            if t.flags & texture::ALPHA != 0 {
                [f32::from(a) / 255.0; 3]
            } else if t.kind == texture::SRGB8 {
                [r, g, b].map(|c| SRGB[c as usize])
            } else {
                [r, g, b].map(|c| f32::from(c) / 255.0)
            }
        };
        [
            color[0] * t.color[0][0],
            color[1] * t.color[0][1],
            color[2] * t.color[0][2],
        ]
    }
}

/// Within ±2²² texels' worth of coordinates, where single precision still tells neighbours apart; 0 for NaN.
#[inline(always)]
fn finite(x: f32) -> f32 {
    if x.is_nan() {
        0.0
    } else {
        x.clamp(-65536.0, 65536.0)
    }
}

/// ⌊x⌋ for |x| < 2³¹.
#[inline(always)]
fn floor(x: f32) -> f32 {
    let t = x as i64 as f32;
    if t > x { t - 1.0 } else { t }
}

/// The column (or row) that `i` means, below `size`.
#[inline(always)]
fn wrap(i: f32, size: u32, flags: u32) -> u32 {
    let (i, n) = (i as i64, i64::from(size.max(1)));
    let inside = if flags & texture::CLAMP != 0 {
        i.clamp(0, n - 1)
    } else if flags & texture::MIRROR != 0 {
        let m = i.rem_euclid(2 * n);
        if m < n { m } else { 2 * n - 1 - m }
    } else {
        i.rem_euclid(n)
    };
    inside as u32
}

/// The sRGB transfer function (IEC 61966-2-1) at n/255: a table, correctly
/// rounded, so that every target has the same bits.
#[rustfmt::skip]
static SRGB: [f32; 256] = [
    0.0, 0.000303527, 0.000607054, 0.000910581, 0.001214108, 0.001517635, 0.001821162, 0.0021246888,
    0.002428216, 0.0027317428, 0.00303527, 0.0033465358, 0.0036765074, 0.004024717, 0.004391442, 0.0047769533,
    0.0051815165, 0.0056053917, 0.006048833, 0.0065120906, 0.00699541, 0.007499032, 0.008023193, 0.008568126,
    0.009134059, 0.009721218, 0.010329823, 0.010960094, 0.011612245, 0.012286488, 0.0129830325, 0.013702083,
    0.014443844, 0.015208514, 0.015996294, 0.016807375, 0.017641954, 0.01850022, 0.019382361, 0.020288562,
    0.02121901, 0.022173885, 0.023153367, 0.024157632, 0.02518686, 0.026241222, 0.027320892, 0.02842604,
    0.029556835, 0.030713445, 0.031896032, 0.033104766, 0.034339808, 0.035601314, 0.03688945, 0.038204372,
    0.039546236, 0.0409152, 0.04231141, 0.04373503, 0.045186203, 0.046665087, 0.048171826, 0.049706567,
    0.051269457, 0.052860647, 0.054480277, 0.05612849, 0.05780543, 0.059511237, 0.061246052, 0.063010015,
    0.064803265, 0.06662594, 0.06847817, 0.070360094, 0.07227185, 0.07421357, 0.07618538, 0.07818742,
    0.08021982, 0.08228271, 0.08437621, 0.08650046, 0.08865558, 0.09084171, 0.093058966, 0.09530747,
    0.09758735, 0.099898726, 0.10224173, 0.104616486, 0.107023105, 0.10946171, 0.11193243, 0.114435375,
    0.116970666, 0.11953843, 0.122138776, 0.12477182, 0.12743768, 0.13013647, 0.13286832, 0.13563333,
    0.13843161, 0.14126329, 0.14412847, 0.14702727, 0.14995979, 0.15292615, 0.15592647, 0.15896083,
    0.16202937, 0.1651322, 0.1682694, 0.17144111, 0.1746474, 0.17788842, 0.18116425, 0.18447499,
    0.18782078, 0.19120169, 0.19461784, 0.19806932, 0.20155625, 0.20507874, 0.20863687, 0.21223076,
    0.2158605, 0.2195262, 0.22322796, 0.22696587, 0.23074006, 0.23455058, 0.23839757, 0.24228112,
    0.24620132, 0.25015828, 0.2541521, 0.25818285, 0.26225066, 0.2663556, 0.2704978, 0.2746773,
    0.27889428, 0.28314874, 0.28744084, 0.29177064, 0.29613826, 0.30054379, 0.3049873, 0.30946892,
    0.31398872, 0.31854677, 0.3231432, 0.3277781, 0.33245152, 0.33716363, 0.34191442, 0.34670407,
    0.3515326, 0.35640013, 0.3613068, 0.3662526, 0.3712377, 0.37626213, 0.38132602, 0.38642943,
    0.39157248, 0.39675522, 0.40197778, 0.4072402, 0.4125426, 0.41788507, 0.42326766, 0.4286905,
    0.43415365, 0.43965718, 0.4452012, 0.4507858, 0.45641103, 0.462077, 0.4677838, 0.47353148,
    0.47932017, 0.48514995, 0.49102086, 0.49693298, 0.5028865, 0.50888133, 0.5149177, 0.52099556,
    0.5271151, 0.5332764, 0.5394795, 0.54572445, 0.55201143, 0.5583404, 0.5647115, 0.57112485,
    0.57758045, 0.58407843, 0.59061885, 0.59720176, 0.60382736, 0.61049557, 0.6172066, 0.6239604,
    0.63075715, 0.63759685, 0.6444797, 0.65140563, 0.65837485, 0.6653873, 0.67244315, 0.6795425,
    0.6866853, 0.69387174, 0.7011019, 0.70837575, 0.7156935, 0.7230551, 0.73046076, 0.7379104,
    0.7454042, 0.7529422, 0.7605245, 0.76815116, 0.7758222, 0.7835378, 0.7912979, 0.7991027,
    0.80695224, 0.8148466, 0.82278574, 0.8307699, 0.838799, 0.8468732, 0.8549926, 0.8631572,
    0.8713671, 0.8796224, 0.8879231, 0.8962694, 0.9046612, 0.91309863, 0.92158186, 0.9301109,
    0.9386857, 0.9473065, 0.9559733, 0.9646863, 0.9734453, 0.9822506, 0.9911021, 1.0,
];
