//! Optical constants that scenes call by name.

use crate::description::Color;

/// Indices of refraction of Mitsuba's names.
pub const INDICES: [(&str, f32); 22] = [
    ("vacuum", 1.0),
    ("helium", 1.000_036),
    ("hydrogen", 1.000_132),
    ("air", 1.000_277),
    ("carbon dioxide", 1.00045),
    ("water", 1.333),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.52045),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.47),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.5046),
    ("sodium chloride", 1.544),
    ("pet", 1.575),
    ("diamond", 2.419),
];

/// Glasses that disperse by Sellmeier's formula: name, B, C in µm² (Schott's data sheets; Malitson 1965 for fused silica).
pub const GLASSES: [(&str, [f32; 3], [f32; 3]); 3] = [
    (
        "bk7",
        [1.039_612, 0.231_792_35, 1.010_469_4],
        [0.006_000_698_7, 0.020_017_914, 103.560_65],
    ),
    (
        "sf11",
        [1.737_597, 0.313_747_35, 1.898_781],
        [0.013_188_707, 0.062_306_814, 155.236_3],
    ),
    (
        "fused silica",
        [0.696_166_3, 0.407_942_6, 0.897_479_4],
        [0.004_679_148, 0.013_512_063, 97.934],
    ),
];

/// Complex indices of refraction of metals as seen in linear sRGB: name, η, k (published averages of
/// measured spectra over the colour matching functions).
pub const METALS: [(&str, Color, Color); 9] = [
    (
        "Ag",
        [0.155_265, 0.116_723, 0.138_381],
        [4.828_343, 3.122_246, 2.146_95],
    ),
    (
        "Al",
        [1.657_46, 0.880_369, 0.521_229],
        [9.223_869, 6.269_523, 4.837_001],
    ),
    (
        "Au",
        [0.143_119, 0.374_957, 1.442_479],
        [3.983_16, 2.385_721, 1.603_215],
    ),
    (
        "Cr",
        [4.369_683, 2.916_702, 1.654_701],
        [5.206_434, 4.231_365, 3.754_947],
    ),
    (
        "Cu",
        [0.200_438, 0.924_033, 1.102_212],
        [3.912_949, 2.452_848, 2.142_188],
    ),
    (
        "Hg",
        [2.398_931, 1.440_025, 0.909_551],
        [6.327_627, 4.371_941, 3.421_79],
    ),
    (
        "Ir",
        [3.086_41, 2.082_194, 1.617_887],
        [5.592_151, 4.067_176, 3.267_261],
    ),
    (
        "W",
        [4.370_703, 3.300_297, 2.998_267],
        [3.500_678, 2.604_865, 2.273_193],
    ),
    (
        "Rh",
        [2.585_795, 1.860_187, 1.554_428],
        [6.782_293, 4.702_95, 3.976_089],
    ),
];
