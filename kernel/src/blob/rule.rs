//! Every rule that a blob must keep, one by one: what the gate (`blob/check`) verifies and what it says where a blob
//! breaks one.

/// The kinds of what can be wrong with a blob.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Problem {
    /// The bytes don't start at a multiple of 16.
    Misaligned,
    /// Shorter than the header says, or than a header is.
    Truncated,
    /// Not a blob at all.
    Magic,
    /// A version that this kernel doesn't read.
    Version,
    /// A need that this kernel doesn't know, or was built without.
    Needs,
    /// A section is missing, double, unknown, overlapping, outside the blob or of another record size.
    Section,
    /// A reserved field isn't zero.
    Reserved,
    /// A number is not finite, or outside its range.
    Range,
    /// An id points to nothing, or to the wrong thing.
    Reference,
    /// A kind or flag that this kernel doesn't know.
    Kind,
    /// The nodes are not a tree of the stated depth.
    Tree,
    /// Two numbers that must agree don't.
    Mismatch,
}

/// Makes the enumeration, the list and the texts from one table.
macro_rules! rules {
    ($($name:ident $problem:ident $text:literal)*) => {
        /// A rule of the format. Its number is stable within a version of the format.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u8)]
        pub enum Rule {
            $(#[doc = concat!("One of `Problem::", stringify!($problem), "`; [`Rule::text`] says what must hold.")] $name,)*
        }

        impl Rule {
            /// All of them, by number.
            pub const ALL: &[Rule] = &[$(Rule::$name),*];

            /// Which kind of problem it is to break it.
            pub const fn problem(self) -> Problem {
                match self { $(Rule::$name => Problem::$problem),* }
            }

            /// What must hold, in words, for C.
            pub const fn c_text(self) -> &'static core::ffi::CStr {
                match self { $(Rule::$name => $text),* }
            }
        }
    };
}

impl Rule {
    /// What must hold, in words.
    pub fn text(self) -> &'static str {
        self.c_text().to_str().unwrap_or_default()
    }
}

rules! {
    // The header.
    HeaderAddress Misaligned c"the blob must lie at an address that is a multiple of 16"
    HeaderSize Truncated c"the blob is shorter than a header, 64 bytes"
    HeaderMagic Magic c"not an Étendue blob: the first bytes must be \"ETENDUE\" and a zero"
    HeaderVersion Version c"version must be 2, little-endian"
    HeaderLength Truncated c"the blob is shorter or longer than its header says"
    HeaderNeeds Needs c"needs must be bits that this kernel knows"
    HeaderFilm Range c"film_exponent must be in [-64, 64]"
    HeaderReserved Reserved c"the header's reserved words must be 0"
    HeaderSections Section c"section_count must be 17"
    // The table of contents.
    TocSize Truncated c"the blob is shorter than its table of contents"
    TocReserved Reserved c"an entry's reserved word must be 0"
    TocCount Section c"a section's count must be below 4294967295"
    TocAlign Section c"a section's offset must be a multiple of 64"
    TocStart Section c"a section must start behind the table of contents"
    TocEnd Section c"a section must end within the blob"
    TocTwice Section c"no two sections may be of the same kind"
    TocOverlap Section c"sections must not overlap"
    SectionMissing Section c"the section must be there"
    SectionStride Section c"a section's stride must be its record's size"
    SectionSingle Section c"the section must hold exactly one record"
    // World.
    WorldCenter Range c"center must be within 1e12"
    WorldRadius Range c"radius must be positive, not subnormal and at most 4e12"
    WorldDepth Tree c"depth must be at most 32"
    WorldSphereBase Mismatch c"sphere_base must be 4 times the number of packets"
    WorldSlots Mismatch c"there must be as many triangle records as packets have lanes"
    WorldPrimitives Reference c"the ids of triangles and spheres must be below 4294967295"
    WorldBackground Reference c"background must be an emitter's index, or none"
    WorldBackgroundKind Reference c"background must be a constant or an environment"
    WorldExterior Reference c"exterior must be a medium's index, or none"
    WorldExteriorDistant Mismatch c"where the exterior takes light away, there must be no emitters at infinity"
    WorldReserved Reserved c"reserved words must be 0"
    // Sensor.
    SensorKind Kind c"kind must be perspective, orthographic or panorama"
    SensorLeftOut Needs c"this kernel was built without panoramas"
    SensorFilter Kind c"filter must be box, tent or gaussian"
    SensorFilterRadius Range c"filter_radius must be in [0.001, 8]"
    SensorFilterSigma Range c"filter_sigma must be in [0, 8], for a gaussian at least 0.001"
    SensorResolution Range c"resolution must be at most 65536"
    SensorCrop Range c"the crop window must hold a pixel and lie within the resolution"
    SensorExtent Range c"half_extent must be in [1e-9, 1e12]"
    SensorAperture Range c"aperture must be in [0, 1e12]"
    SensorFocus Range c"focus must be in [1e-9, 1e12]"
    SensorClip Range c"clip must be finite and not negative"
    SensorClipOrder Range c"the near clip must be below the far one"
    SensorOrigin Range c"origin must be within 1e12"
    SensorPrincipal Range c"principal must be finite"
    SensorRight Range c"right must be a unit vector"
    SensorDown Range c"down must be a unit vector"
    SensorForward Range c"forward must be a unit vector"
    SensorAxes Range c"a panorama's right, down and forward must be perpendicular"
    SensorMedium Reference c"medium must be a medium's index, or none"
    SensorReserved Reserved c"reserved words must be 0"
    // Nodes.
    NodeRoot Tree c"there must be a root: node 0, at level 0, without a parent"
    NodeLevel Tree c"level must be at most world.depth"
    NodeReserved Reserved c"reserved words must be 0"
    NodeBox Range c"boxes must not be NaN"
    NodeChild Reference c"a child must be a node's index"
    NodeParent Tree c"a child node must name its parent"
    NodeBelow Tree c"a child node's level must be its parent's plus 1"
    NodeTwice Tree c"no two children of a node may be the same node"
    NodePackets Reference c"a leaf's packets must be within their section"
    NodeSpheres Reference c"a leaf's spheres must be within their section"
    // Geometry.
    PacketVertex Range c"vertices must be within 1e12"
    TriangleShape Reference c"shape must be a shape's index, or none"
    TriangleVertex Reference c"index must be below the shape's vertices"
    SphereCenter Range c"center must be within 1e12"
    SphereRadius Range c"radius must be positive, not subnormal and at most 1e12"
    SphereShape Reference c"shape must be a shape's index"
    SphereFlipped Kind c"flipped must be 0 or 1"
    SphereReserved Reserved c"reserved words must be 0"
    NormalLength Range c"a normal must be a unit vector"
    UvFinite Range c"texture coordinates must be finite"
    ShapeFront Reference c"front must be a material's index, or none"
    ShapeBack Reference c"back must be a material's index, or none"
    ShapeMedium Reference c"interior and exterior must be media's indices, or none"
    ShapeOpacity Reference c"opacity must be a texture's index, or none"
    ShapeEmitter Reference c"emitter must be an emitter's index, or none"
    ShapeEmitterOwn Reference c"a shape's emitter must be an area emitter that names the shape"
    ShapeNormals Reference c"a shape's normals must be within their section"
    ShapeUvs Reference c"a shape's texture coordinates must be within their section"
    ShapeReserved Reserved c"reserved words must be 0"
    // Surfaces.
    MaterialKind Kind c"kind must be a material's"
    MaterialFlags Kind c"flags must be those of the material's kind"
    MaterialColor Range c"color must be in [0, 1]"
    MaterialTexture Reference c"texture must be a texture's index, or none"
    MaterialIor Range c"ior must be in [0.001, 1000]"
    MaterialEta Range c"eta must be in [0, 1e6]"
    MaterialK Range c"k must be in [0, 1e6]"
    MaterialReserved Reserved c"reserved words must be 0, and so must what the material's kind doesn't use"
    MaterialLeftOut Needs c"this kernel was built without glossy materials"
    MaterialNeeds Mismatch c"needs must say that materials are glossy, blended or dispersive"
    SpectraLeftOut Needs c"this kernel was built without spectra"
    MaterialDispersion Range c"an index must be in [0.1, 100] from 380 to 780 nm; of a table, at most 256 rows by rising wavelength"
    MaterialExponent Range c"an exponent must be in [0, 100000]"
    MaterialNormalization Range c"a normalization must be positive and at most (exponent + 2)/2π"
    MaterialRoughness Range c"roughness must be in [0.0001, 10]"
    MaterialRoughIor Range c"a rough dielectric's ior must differ from 1 by at least 0.01"
    MaterialInternal Range c"internal must be in [0, 0.9999]"
    MaterialCurve Reference c"curves must be within the texels"
    MaterialPart Reference c"a blend's parts must be materials"
    MaterialLevel Range c"a blend's level must be from 1 to 8, above that of a blend within it"
    TextureLeftOut Needs c"this kernel was built without textures"
    TextureKind Kind c"kind must be a texture's"
    TextureFlags Kind c"flags must be a texture's"
    TextureToUv Range c"to_uv must be finite"
    TextureColor Range c"color must be in [0, 1]"
    TextureReserved Reserved c"reserved words must be 0"
    TextureSize Range c"width must be in [1, 65536], height in [1, 262144]"
    TextureTexels Reference c"texels must be within their section"
    TextureBudget Section c"images must not share texels"
    TextureFloat Range c"texels must be in [0, 1]"
    TextureRows Range c"a spectrum must have rows by rising wavelength, values in [0, 1]"
    // Light.
    EmitterKind Kind c"kind must be an emitter's"
    EmitterLeftOut Needs c"this kernel was built without environments"
    EmitterRadiance Range c"radiance must be in [0, 1e30]"
    EmitterDensity Range c"density must be finite and not negative"
    EmitterPosition Range c"position must be within 1e12"
    EmitterReserved Reserved c"reserved words must be 0"
    EmitterMedium Reference c"medium must be a medium's index, or none"
    EmitterRows Range c"an emitter's spectrum must have rows by rising wavelength, values in [0, 1e30]; environments have none"
    AreaShape Reference c"an area emitter's shape must be a shape's index"
    AreaShapeOwn Reference c"an area emitter's shape must name it"
    SpotDirection Range c"a spot's direction must be a unit vector"
    SpotCosines Range c"a spot's cosines must be in [-1, 1]"
    SpotOrder Range c"a spot's cos_outer must be below its cos_inner"
    DirectionalDirection Range c"a directional emitter's direction must be a unit vector"
    EnvironmentFrame Range c"the rows of to_local must be unit vectors"
    EnvironmentHeight Range c"an environment must have a row of cells"
    EnvironmentCube Mismatch c"a cube map must have six square faces"
    EnvironmentSize Range c"width must be in [1, 65536], height in [1, 262144]"
    EnvironmentTexels Reference c"texels must be within their section"
    EnvironmentBudget Section c"images must not share texels"
    EnvironmentRadiance Range c"texels must be in [0, 1e30]"
    EnvironmentCells Reference c"cells must be within their section"
    EnvironmentCellBudget Section c"environments must not share cells"
    EnvironmentAlias Reference c"a cell's alias must be a cell of its environment"
    VolumeMedium Reference c"a volume emitter's medium must be a medium's index"
    VolumeEdges Range c"the edges of a volume emitter's box must be within 1e12"
    VolumeSize Range c"a volume emitter's box must have a volume"
    ChoiceKeep Range c"keep must be in [0, 1]"
    ChoiceAlias Reference c"alias must be a choice's index"
    ChoiceEmitter Reference c"emitter must be an emitter's index"
    ChoiceWhole Reference c"an emitter without a shape must be chosen as a whole"
    ChoicePrimitive Reference c"primitive must be a triangle's or a sphere's id"
    ChoiceShape Reference c"a chosen primitive must be of its emitter's shape"
    CellKeep Range c"keep must be in [0, 1]"
    CellProbability Range c"probability must be in [0, 1]"
    // Media.
    MediumLeftOut Needs c"this kernel was built without media"
    MediumKind Kind c"kind must be a medium's"
    MediumFlags Kind c"flags must be those of the medium's kind"
    MediumSigma Range c"sigma_t must be 0 or in [1e-12, 1e12]"
    MediumAlbedo Range c"albedo must be in [0, 1]"
    MediumEmission Range c"emission must be in [0, 1e20]"
    MediumMean Range c"mean must be 0 or in [1e-12, 1e12], and positive where sigma_t is"
    MediumAbsorption Mismatch c"where a medium emits it must absorb: sigma_t above 0, albedo below 1"
    MediumEmitter Reference c"emitter must be a volume emitter that names the medium, or none"
    LobeKind Kind c"a lobe's kind must be a phase function's"
    LobeG Range c"g must be in (-1, 1)"
    LobeWeight Range c"a lobe's weight must be in [0, 1]"
    LobeReserved Reserved c"a lobe's reserved word must be 0"
    LobeSum Range c"the weights of a medium's lobes must add up to 1"
    MediumRows Range c"a medium's spectra must have rows by rising wavelength, values in the ranges of what they are spectra of; media of grids have none"
    MediumExtinctions Reference c"extinctions must be a grid's index"
    MediumAlbedos Reference c"albedos must be a grid's index, or none"
    MediumEmissions Reference c"emissions must be a grid's index, or none"
    MediumResidual Mismatch c"residual tracking takes an extinction that is the same for all channels"
    MediumToGrid Range c"to_grid must be invertible, its rows of lengths in [1e-12, 1e12], its offsets within 1e24"
    MediumCells Range c"cells must be in [1, the extinction's texels] along each axis"
    MediumMajorants Reference c"majorants must be within the texels"
    MediumBudget Section c"media must not read more than 16 times as many texels as there are"
    MediumAlbedoGrid Range c"albedo times its texels must be at most 1"
    MediumEmissionGrid Range c"emission times its texels must be at most 1e20"
    MediumMajorant Range c"a majorant must be 0 or in [1e-12, 1e12], and at least the extinction in its box"
    GridNearest Kind c"nearest must be 0 or 1"
    GridChannels Kind c"channels must be 1 or 3"
    GridSize Range c"size must be in [1, 4096] along each axis"
    GridTexels Reference c"texels must be within their section"
    GridBudget Section c"images and grids must not share texels"
    GridValue Range c"texels must be in [0, 1e12]"
    GridReserved Reserved c"reserved words must be 0"
}
