/* Étendue, hosted: scenes from arrays and files, images on all cores. Generated from host/capi/src; don't edit.
 *
 * Link libetendue_host.a, which holds all of etendue.h too, instead of libetendue.a.
 *
 * Call order: etd_builder_create; add textures, materials, media, objects, lights, the camera; etd_builder_build; or
 * etd_load_file instead of all that. Then etd_scene_open on the blob, and etd_host_render, or any function of etendue.h.
 *
 * etendue.h's conventions hold: units, axes, statuses, struct_size; besides:
 *   Angles    radians.
 *   Space     an object's numbers are in its own space, which etd_builder_set_transform puts into the world; lights and
 *             the camera are in world space.
 *   Arrays    are the caller's, and are copied by the call that takes them. Nulls are ETD_E_NULL, wrong alignments
 *             ETD_E_MISALIGNED, numbers out of range ETD_E_ARGUMENT; etd_builder_message says which.
 *   Memory    what etd_…_create makes, etd_…_free frees; blobs belong to the caller and are freed by etd_blob_free.
 *             Arrays, films and blobs that don't fit into memory are ETD_E_MEMORY; lesser shortages end the process.
 *   Threads   a builder is used by one thread at a time. All else may be called by any number at once. Threads that the
 *             library starts are that call's own and end with it; there is no global pool.
 *   Panics    are bugs of the library. They end at its boundary, as ETD_E_PANIC, and never unwind into C; a line
 *             about them goes to the standard error stream.
 */


#ifndef ETENDUE_HOST_H
#define ETENDUE_HOST_H

#include <stddef.h>
#include <stdint.h>
#include "etendue.h"

// Something went wrong; the call returns an error.
#define ETD_LOG_ERROR 0

// The result may differ from what was meant.
#define ETD_LOG_WARNING 1

// What was done.
#define ETD_LOG_INFO 2

// What a blob of this library is aligned to: a cache line.
#define ETD_BLOB_LINE 64

// "No such thing", wherever an id is optional.
#define ETD_NONE UINT32_MAX

// A pinhole, or a thin lens where `aperture` is not 0.
#define ETD_PERSPECTIVE 0

// Parallel rays.
#define ETD_ORTHOGRAPHIC 1

// All directions around a point, lat-long: `direction` in the middle, `up` at the top.
#define ETD_PANORAMA 2

// Constant within the radius.
#define ETD_FILTER_BOX 0

// Falls linearly to 0 at the radius.
#define ETD_FILTER_TENT 1

// A Gaussian, shifted to be 0 at the radius.
#define ETD_FILTER_GAUSSIAN 2

// Diffuse: `color[0]` reflected, `color[1]` transmitted.
#define ETD_DIFFUSE 0

// A perfect mirror: `color[0]`.
#define ETD_MIRROR 1

// A smooth conductor: `eta` + i·`k` relative to outside, scaled by `color[0]`.
#define ETD_CONDUCTOR 2

// A smooth dielectric: `ior`; `color[0]` scales reflection, `color[1]` transmission.
#define ETD_DIELECTRIC 3

// Light passes.
#define ETD_BOUNDARY 4

// A thin sheet: `color[0]` mirror-like, `color[1]` straight through, `color[2]` diffusely reflected, `color[3]` diffusely transmitted.
#define ETD_SHEET 5

// Phong lobes of `exponent`: `color[0]` diffusely reflected, `color[1]` about the mirror direction, `color[2]` about the refracted
// direction (`ior`; 1 is a thin sheet), `color[3]` diffusely transmitted.
#define ETD_PHONG 6

// A rough conductor: as `ETD_CONDUCTOR`, with microfacets of roughness `alpha`.
#define ETD_ROUGH_CONDUCTOR 7

// A rough dielectric: as `ETD_DIELECTRIC`, with microfacets of roughness `alpha`; `ior` at least 1 % from 1.
#define ETD_ROUGH_DIELECTRIC 8

// Diffuse `color[0]` under a smooth coat of index `ior`; `color[1]` scales the coat's reflection.
#define ETD_PLASTIC 9

// The same under a coat with microfacets of roughness `alpha`.
#define ETD_ROUGH_PLASTIC 10

// At each point one of the two materials `parts`: the second with probability `color[0]`, its first channel.
#define ETD_BLEND 11

// A smooth dielectric whose index depends on wavelength λ (µm): over `ior`, which is the index outside, n² = 1 + Σ `eta[i]`·λ²/(λ² − `k[i]`)
// (Sellmeier); with `ETD_CAUCHY` n = `eta[0]` + `eta[1]`/λ² + `eta[2]`/λ⁴. Colours as `ETD_DIELECTRIC`.
#define ETD_DISPERSIVE 12

// Flag of `ETD_DIELECTRIC` and `ETD_DISPERSIVE`: Schlick's approximation in place of Fresnel's equations.
#define ETD_SCHLICK 1

// Flag of `ETD_PHONG`: the lobes have Fresnel's shares of the light, by `ior`.
#define ETD_FRESNEL 2

// Flag of the rough kinds: Beckmann's distribution of facets rather than GGX.
#define ETD_BECKMANN 4

// Flag of the rough kinds: masking of each direction for itself rather than correlated by height.
#define ETD_SEPARABLE 8

// Flag of `ETD_ROUGH_CONDUCTOR` and `ETD_ROUGH_PLASTIC`: masking by V-shaped cavities.
#define ETD_CAVITIES 16

// Flag of the rough kinds: the light that scattering by single facets loses is given back.
#define ETD_COMPENSATED 32

// Flag of `ETD_DISPERSIVE`: Cauchy's formula.
#define ETD_CAUCHY 128

// Flag of the plastics: light that the coat sends back takes the base's colour each time.
#define ETD_NONLINEAR 64

// Squares of the colours `color[0]` (where ⌊u⌋ + ⌊v⌋ is even) and `color[1]`.
#define ETD_CHECKERBOARD 0

// Texels of 4 bytes, RGBA, coded as sRGB (alpha linear).
#define ETD_SRGB8 1

// Texels of 4 bytes, RGBA, linear.
#define ETD_LINEAR8 2

// Texels of 3 floats, linear RGB, 0 to 1.
#define ETD_FLOAT 3

// The same everywhere, by wavelength: `width` rows of two floats, nm and value (0 to 1), by rising wavelength; linear between. `height` is 1.
#define ETD_SPECTRUM 4

// Flag: the nearest texel rather than a bilinear mixture.
#define ETD_NEAREST 1

// Flag: outside [0, 1]² the border goes on, rather than the image starting over.
#define ETD_CLAMP 2

// Flag: outside [0, 1]² the image goes back and forth.
#define ETD_MIRRORED 4

// Flag: the value is the alpha channel.
#define ETD_ALPHA 8

// Paths carry wavelengths where a material disperses or a texture is a spectrum; otherwise red, green and blue. As at first.
#define ETD_COLOR_AUTO 0

// Paths carry red, green and blue; an index that disperses has three values.
#define ETD_COLOR_RGB 1

// Paths carry four wavelengths.
#define ETD_COLOR_SPECTRAL 2

// Scatters alike in all directions.
#define ETD_PHASE_ISOTROPIC 0

// Henyey and Greenstein's, with the asymmetry `g`.
#define ETD_PHASE_HG 1

// Rayleigh's, of particles much smaller than wavelengths.
#define ETD_PHASE_RAYLEIGH 2

// Straight on.
#define ETD_PHASE_FORWARD 3

// Grids are tracked by Woodcock's method, transmittance by ratio tracking.
#define ETD_TRACK_WOODCOCK 0

// Transmittance by residual ratio tracking; `extinction` has one channel, and those of `sigma_t` are the same.
#define ETD_TRACK_RESIDUAL 1

// Cell by cell, exactly.
#define ETD_TRACK_REGULAR 2

// A point: `color` is its radiant intensity, W/sr.
#define ETD_LIGHT_POINT 0

// A point with a cone around `direction`: `color` is the intensity inside `beam_width`, W/sr; it falls to 0 at `cutoff`.
#define ETD_LIGHT_SPOT 1

// From infinity along `direction`: `color` is the irradiance on a plane across it, W/m².
#define ETD_LIGHT_DIRECTIONAL 2

// The radiance `color`, W/(m² sr), from all directions. One such, or one image, to a scene.
#define ETD_LIGHT_CONSTANT 3

// A lat-long image around the scene: its top row is the image's +y, column 0 its −z, the middle its +z; radiance is texel · `scale`.
#define ETD_LIGHT_LATLONG 4

// Six square images around the scene, below each other: +x −x +y −y +z −z; `height` is 6 · `width`.
#define ETD_LIGHT_CUBEMAP 5

// A scene that is being described: made by `etd_builder_create`, freed by `etd_builder_free`. It copies what it is given; arrays stay the
// caller's and may go when the call returns. One thread at a time; different builders are independent.
typedef struct EtdBuilder EtdBuilder;

// A compiled scene: `etd_scene_open(ETD_ABI_VERSION, blob.data, blob.size, …)` opens it. It belongs to the caller and knows nothing of
// the builder it came from; it may be stored and read back. Free it with `etd_blob_free`, after the last use of scenes opened on it.
typedef struct EtdBlob {
    // sizeof(EtdBlob), set by the caller. What else is in a struct that is handed in to be filled is not looked at, nor freed.
    uint32_t struct_size;
    // Zero.
    uint32_t reserved;
    // Its bytes, aligned to `ETD_BLOB_LINE`; null after `etd_blob_free`.
    uint8_t *data;
    // How many.
    size_t size;
    // For the library.
    void *user;
    // For the library: the caller's `release`, or null for its own.
    void (*release)(void *user,
                    void *memory,
                    size_t size,
                    size_t alignment);
} EtdBlob;

// What the library may use of the caller's. All zero but the size: the library's own means. Functions run on the thread that called the
// library and must return.
typedef struct EtdHost {
    // sizeof(EtdHost).
    uint32_t struct_size;
    // Threads that building and loading may use besides the calling one; 0: one per core. They end before the call returns.
    uint32_t threads;
    // Handed to every function.
    void *user;
    // Memory for a blob: `size` bytes at a multiple of `alignment` (a power of two), or null if there is none. Working memory that the library frees before
    // it returns, and a builder's own, doesn't come from here. Given together with `release`, or not at all.
    void *(*allocate)(void *user,
                      size_t size,
                      size_t alignment);
    // Takes back what `allocate` gave, on the thread that calls `etd_blob_free`.
    void (*release)(void *user,
                    void *memory,
                    size_t size,
                    size_t alignment);
    // One message, UTF-8, without a line's end, valid during the call; `severity` is `ETD_LOG_…`.
    void (*log)(void *user,
                uint32_t severity,
                const char *message);
} EtdHost;

// What a build made.
typedef struct EtdBuilt {
    // sizeof(EtdBuilt), set by the caller.
    uint32_t struct_size;
    // 1 if the last tree was refitted, 0 if one was built.
    uint32_t refitted;
    // Nodes of the tree.
    uint32_t nodes;
    // Levels below its root.
    uint32_t depth;
    // What a ray that meets the scene's box is expected to cost, in visits of nodes (surface area heuristic): when refitting has made it
    // much larger than building did, build again.
    double cost;
} EtdBuilt;

// A camera and its image. `etd_camera_default` fills it in.
typedef struct EtdCamera {
    // sizeof(EtdCamera).
    uint32_t struct_size;
    // `ETD_PERSPECTIVE`, `ETD_ORTHOGRAPHIC` or `ETD_PANORAMA`.
    uint32_t projection;
    // Where it is, world units.
    float origin[3];
    // Where it looks; any length but 0.
    float direction[3];
    // What is up in the image; any length but 0, not along `direction`.
    float up[3];
    // `ETD_PERSPECTIVE`: the angle that the image's width spans, radians, in (0, π). `ETD_ORTHOGRAPHIC`: the image's width, world units.
    // Pixels are square. `ETD_PANORAMA`: not read; the image spans everything.
    float field;
    // Radius of the lens, world units; 0: a pinhole.
    float aperture;
    // Distance to the plane in focus, along the axis, world units.
    float focus;
    // Nearest and farthest depth that is seen, along the axis (`ETD_PANORAMA`: distance), world units.
    float clip[2];
    // Offset of the principal point, in widths and heights of the image.
    float principal[2];
    // Columns of the whole image, 1 to 65536.
    uint32_t width;
    // Its rows, 1 to 65536.
    uint32_t height;
    // The part of it that is rendered: first column, first row, columns, rows. All 0: everything.
    uint32_t crop[4];
    // `ETD_FILTER_…`.
    uint32_t filter;
    // Its half-width in pixels, 0.001 to 8.
    float filter_radius;
    // σ in pixels; of `ETD_FILTER_GAUSSIAN` alone.
    float filter_sigma;
} EtdCamera;

// A local model. `etd_material_default` fills it in.
typedef struct EtdMaterial {
    // sizeof(EtdMaterial).
    uint32_t struct_size;
    // `ETD_DIFFUSE` to `ETD_DISPERSIVE`.
    uint32_t kind;
    // `ETD_SCHLICK` to `ETD_CAUCHY`, added up.
    uint32_t flags;
    // Index of refraction inside (behind the front) over that outside, 0.001 to 1000.
    float ior;
    // Shares of the light, 0 to 1; what a kind scatters may not exceed 1 in sum. Not looked at where there is a texture.
    float color[4][3];
    // Textures in their place, or `ETD_NONE`.
    uint32_t texture[4];
    // Real part of the index of refraction, per channel, > 0. `ETD_DISPERSIVE`: coefficients.
    float eta[3];
    // Imaginary part, per channel, ≥ 0. `ETD_DISPERSIVE`: Sellmeier's second three, µm².
    float k[3];
    // Roughness of microfacets, 0.0001 to 10.
    float alpha;
    // Phong's exponent, 0 to 100000. The lobes are normalised such that along the normal a colour is an albedo.
    float exponent;
    // A blend's two materials.
    uint32_t parts[2];
} EtdMaterial;

// A colour over texture coordinates. `etd_texture_default` fills it in.
typedef struct EtdTexture {
    // sizeof(EtdTexture).
    uint32_t struct_size;
    // `ETD_CHECKERBOARD` to `ETD_SPECTRUM`.
    uint32_t kind;
    // `ETD_NEAREST` and so on, added up.
    uint32_t flags;
    // Columns of an image, 1 to 65536.
    uint32_t width;
    // Rows of an image, 1 to 65536; the first is the top, at v = 0.
    uint32_t height;
    // Zero.
    uint32_t reserved;
    // Colours of a checkerboard, 0 to 1.
    float color[2][3];
    // Texture coordinates are this matrix of two rows times (u, v, 1).
    float to_uv[2][3];
    // An image's texels, row by row; floats aligned as such.
    const void *texels;
    // How many bytes they are: `width` · `height` · 4, · 12 for `ETD_FLOAT`, · 8 for `ETD_SPECTRUM`.
    size_t bytes;
} EtdTexture;

// Triangles over shared vertices. `etd_mesh_default` fills it in.
typedef struct EtdMesh {
    // sizeof(EtdMesh).
    uint32_t struct_size;
    // Vertices, at least 1.
    uint32_t vertices;
    // Triangles, at least 1.
    uint32_t triangles;
    // Material on the front, where the vertices run counter-clockwise; `ETD_NONE` is black.
    uint32_t front;
    // Material on the back; `ETD_NONE` is black.
    uint32_t back;
    // Texture whose first channel is the opacity; `ETD_NONE`: opaque.
    uint32_t opacity;
    // Radiance that the front emits, W/(m² sr).
    float emission[3];
    // Zero.
    uint32_t reserved;
    // 3 · `vertices` numbers, in the object's own space.
    const float *positions;
    // 3 · `vertices` numbers, of any length but 0; null: flat triangles.
    const float *normals;
    // 2 · `vertices` numbers, texture coordinates; null: none.
    const float *uvs;
    // 3 · `triangles` numbers below `vertices`.
    const uint32_t *indices;
} EtdMesh;

// An exact sphere. `etd_sphere_default` fills it in.
typedef struct EtdSphere {
    // sizeof(EtdSphere).
    uint32_t struct_size;
    // Material outside; `ETD_NONE` is black.
    uint32_t front;
    // Material inside; `ETD_NONE` is black.
    uint32_t back;
    // Texture whose first channel is the opacity; `ETD_NONE`: opaque.
    uint32_t opacity;
    // Its centre, in the object's own space.
    float center[3];
    // Its radius, > 0.
    float radius;
    // Radiance that the front emits, W/(m² sr).
    float emission[3];
    // 1: the front is inside; else 0.
    uint32_t flipped;
} EtdSphere;

// A part of a phase function.
typedef struct EtdLobe {
    // `ETD_PHASE_…`.
    uint32_t kind;
    // `ETD_PHASE_HG`: mean cosine between the directions in which light travels, in (−1, 1); > 0 is forwards.
    float g;
    // Its share relative to the others', ≥ 0.
    float weight;
} EtdLobe;

// Numbers over a box, each of them for the middle of its texel.
typedef struct EtdGrid {
    // Texels in x, y and z, each 1 to 4096.
    uint32_t size[3];
    // Numbers to a texel: 1, or 3 for RGB.
    uint32_t channels;
    // 1: those of the nearest texel; 0: trilinear between them.
    uint32_t nearest;
    // Zero.
    uint32_t reserved;
    // The numbers, ≥ 0: channels fastest, then x, y, z. Null: no grid, 1 everywhere.
    const float *values;
    // How many they are.
    size_t floats;
} EtdGrid;

// A medium. `etd_medium_default` fills it in.
typedef struct EtdMedium {
    // sizeof(EtdMedium).
    uint32_t struct_size;
    // `ETD_TRACK_…`, of a medium with grids.
    uint32_t tracking;
    // Extinction, 1 over world units, 0 or 1e-12 to 1e12; times `extinction` if that is a grid.
    float sigma_t[3];
    // Scattering as a part of extinction, 0 to 1; times `albedos` if that is a grid.
    float albedo[3];
    // What it emits, W/(m³ sr), 0 to 1e20, times `emissions` if that is a grid; 0 where it doesn't absorb.
    float emission[3];
    // The phase function: its parts.
    struct EtdLobe phase[4];
    // World space to the grids' box, the unit cube: 12 numbers, three rows of four. Outside of the cube there is nothing.
    float to_grid[3][4];
    // Zero.
    uint32_t reserved;
    // Without it the medium is the same everywhere.
    struct EtdGrid extinction;
    // Only beside `extinction`.
    struct EtdGrid albedos;
    // Only beside `extinction`.
    struct EtdGrid emissions;
} EtdMedium;

// A light. `etd_light_default` fills it in.
typedef struct EtdLight {
    // sizeof(EtdLight).
    uint32_t struct_size;
    // `ETD_LIGHT_…`.
    uint32_t kind;
    // What it emits, in the kind's unit.
    float color[3];
    // Where a point or spot is, world units.
    float position[3];
    // Where light goes: a spot's axis, or along which directional light travels; any length but 0.
    float direction[3];
    // A spot's: angle to the axis beyond which there is no light, radians, in (0, π).
    float cutoff;
    // A spot's: angle up to which there is all of it, radians, 0 to `cutoff`.
    float beam_width;
    // Factor of an image, ≥ 0.
    float scale;
    // The x, y and z axis of an image in world space, unit and at right angles: its rows.
    float axes[3][3];
    // Columns of an image, 1 to 65536.
    uint32_t width;
    // Rows of an image: at least 2 of a lat-long one, 6 · `width` of a cube.
    uint32_t height;
    // Zero.
    uint32_t reserved;
    // An image's texels: `width` · `height` times linear RGB, ≥ 0.
    const float *texels;
    // How many numbers they are: 3 · `width` · `height`.
    size_t floats;
} EtdLight;

// What a scene file says about how to render it.
typedef struct EtdAdvice {
    // sizeof(EtdAdvice), set by the caller.
    uint32_t struct_size;
    // For `EtdSettings`; −1: no limit.
    int32_t max_edges;
    // Samples per pixel; 0: it doesn't say.
    uint32_t samples;
} EtdAdvice;

// How much to render, on what.
typedef struct EtdRender {
    // sizeof(EtdRender).
    uint32_t struct_size;
    // Threads of the library, 0: one per core. They end before the call returns. Not looked at where there is a `run`.
    uint32_t threads;
    // Samples of each pixel; 0: `seconds` decides. With `error`, their mean is at most this (0: 65,536).
    uint64_t samples;
    // How long, if `samples` is 0; > 0: ends with the first whole pass over the image that reaches it. With `error`, at most this long (0: any time).
    double seconds;
    // 0, or the relative error at which to stop: the root of the squared error's mean over that of the image's square is not above it with 95 %
    // confidence. Pixels have more samples where there is more noise. Not for `ETD_METROPOLIS` (`ETD_E_UNSUPPORTED`).
    double error;
    // Handed to both functions.
    void *user;
    // The caller's threads, or null: calls `job(context, i)` once for each i < `jobs`, in any order and on as many threads at once as it likes, and
    // returns when all calls have. Called several times, on the thread that called the library.
    void (*run)(void *user,
                uint32_t jobs,
                void (*job)(void *context,
                            uint32_t index),
                void *context);
    // Told now and then how many samples of each pixel are done and which share of all (0 to 1), or null. Called from any of the threads, one at a time.
    // Anything but 0 cancels: the passes that have begun end (half a second, or one pass), and the image so far is the result.
    int32_t (*progress)(void *user,
                        uint64_t samples,
                        double share);
} EtdRender;

// What was rendered.
typedef struct EtdRendered {
    // sizeof(EtdRendered), set by the caller.
    uint32_t struct_size;
    // Columns.
    uint32_t width;
    // Rows.
    uint32_t height;
    // 1 if there was an `error` to reach and it was reached, else 0.
    uint32_t met;
    // Samples of each pixel; with `error`, their mean.
    uint64_t samples;
    // How long it took.
    double seconds;
    // Rays for which the closest hit was asked.
    uint64_t closest_rays;
    // Segments that were asked to be free.
    uint64_t shadow_rays;
    // Walks from a light.
    uint64_t light_walks;
    // Contributions refused because they were NaN, infinite or negative, or too large for the film.
    uint64_t rejected;
    // Contributions too small for the film.
    uint64_t underflowed;
    // An estimate of the relative error, if there was an `error` to reach: infinite where too little was rendered to say. Else 0.
    double error;
} EtdRendered;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Frees a blob's memory and clears the struct, so that freeing it again does nothing. Scenes opened on it are no longer used.
EtdStatus etd_blob_free(struct EtdBlob *blob);

// Makes a builder of an empty scene. `abi_version` is `ETD_ABI_VERSION`. `host` may be null; it is copied, its functions must stay until
// the builder and its blobs are freed.
EtdStatus etd_builder_create(uint32_t abi_version,
                             const struct EtdHost *host,
                             struct EtdBuilder **out);

// Frees a builder; null is fine. Its blobs stay.
EtdStatus etd_builder_free(struct EtdBuilder *builder);

// Writes what was wrong in the builder's last call into `buffer`, UTF-8 with a 0 at its end, cut to `size` bytes; empty if nothing was.
EtdStatus etd_builder_message(const struct EtdBuilder *builder,
                              char *buffer,
                              size_t size);

// Moves an object: `matrix` is 12 numbers, three rows of four, applied to its vertices as they were given (not to where it was before): the
// fourth column is the translation, world units. It must be invertible, for a sphere a similarity. A mirroring one leaves the front outside.
EtdStatus etd_builder_set_transform(struct EtdBuilder *builder,
                                    uint32_t object,
                                    const float *matrix);

// Reserved: another copy of an object. `ETD_E_UNSUPPORTED`.
EtdStatus etd_builder_add_instance(struct EtdBuilder *builder,
                                   uint32_t object,
                                   const float *matrix,
                                   uint32_t *id);

// Builds the scene into `*blob`, a new blob of the caller's. The builder stays as it is and may be changed and built again. `built` may be null.
// The same calls give the same bytes.
EtdStatus etd_builder_build(struct EtdBuilder *builder,
                            struct EtdBlob *blob,
                            struct EtdBuilt *built);

// The same, much faster, after objects were moved or materials, lights or the camera changed: the last build's tree keeps its shape and gets new
// boxes. Images show the same scene; rays get slower the more objects have changed places (`built->cost`). Where that can't be done (nothing was built yet,
// objects were added, or a triangle got or lost its area) it builds, and says so in `built->refitted`.
EtdStatus etd_builder_refit(struct EtdBuilder *builder,
                            struct EtdBlob *blob,
                            struct EtdBuilt *built);

// At the origin, looking along +z, y up; a pinhole with an angle of 90°, 768 by 576 pixels, a box filter of one pixel.
EtdStatus etd_camera_default(struct EtdCamera *camera);

// Sets the camera; the last one counts. Without one, the scene has that of `etd_camera_default`.
EtdStatus etd_builder_set_camera(struct EtdBuilder *builder,
                                 const struct EtdCamera *camera);

// White and diffuse, without textures; an index of refraction of 1.5; eta 1, k 0; a roughness of 0.1, an exponent of 30, no parts.
EtdStatus etd_material_default(struct EtdMaterial *material);

// A checkerboard of black and white squares, one to a unit of texture coordinates.
EtdStatus etd_texture_default(struct EtdTexture *texture);

// Adds a material and writes its id, counted from 0.
EtdStatus etd_builder_add_material(struct EtdBuilder *builder,
                                   const struct EtdMaterial *material,
                                   uint32_t *id);

// Puts another material in the place of `id`.
EtdStatus etd_builder_set_material(struct EtdBuilder *builder,
                                   uint32_t id,
                                   const struct EtdMaterial *material);

// Says what paths carry: `ETD_COLOR_AUTO` to `ETD_COLOR_SPECTRAL`.
EtdStatus etd_builder_set_color(struct EtdBuilder *builder,
                                uint32_t color);

// Adds a texture and writes its id, counted from 0. Its texels are copied.
EtdStatus etd_builder_add_texture(struct EtdBuilder *builder,
                                  const struct EtdTexture *texture,
                                  uint32_t *id);

// No vertices yet; black, opaque, no light.
EtdStatus etd_mesh_default(struct EtdMesh *mesh);

// The unit sphere around the origin; black, opaque, no light.
EtdStatus etd_sphere_default(struct EtdSphere *sphere);

// Adds a mesh and writes its id: objects are numbered from 0, meshes and spheres together. Its arrays are copied.
EtdStatus etd_builder_add_mesh(struct EtdBuilder *builder,
                               const struct EtdMesh *mesh,
                               uint32_t *id);

// Adds a sphere and writes its id: objects are numbered from 0, meshes and spheres together.
EtdStatus etd_builder_add_sphere(struct EtdBuilder *builder,
                                 const struct EtdSphere *sphere,
                                 uint32_t *id);

// The same everywhere, with an extinction of 1 and an albedo of 0.75; scatters alike in all directions.
EtdStatus etd_medium_default(struct EtdMedium *medium);

// Adds a medium and writes its id, counted from 0. Its numbers are copied.
EtdStatus etd_builder_add_medium(struct EtdBuilder *builder,
                                 const struct EtdMedium *medium,
                                 uint32_t *id);

// Says what is behind the front of an object, `interior`, and before it, `exterior`; `ETD_NONE` is vacuum. Where both are, as at first, the
// object doesn't part media: it stands in whichever is there. Objects touch, nest or stand apart: those that overlap are refused
// by the build. The media at the camera and at lights are found from the objects around them.
EtdStatus etd_builder_set_media(struct EtdBuilder *builder,
                                uint32_t object,
                                uint32_t interior,
                                uint32_t exterior);

// Says what fills the space outside all objects; `ETD_NONE`, as at first: what they are met from. Through a medium that fills all space
// no light comes from infinity.
EtdStatus etd_builder_set_exterior(struct EtdBuilder *builder,
                                   uint32_t medium);

// A constant background of radiance 1.
EtdStatus etd_light_default(struct EtdLight *light);

// Adds a light and writes its id, counted from 0. Its texels are copied. (Objects with an emission are lights too, without an id here.)
EtdStatus etd_builder_add_light(struct EtdBuilder *builder,
                                const struct EtdLight *light,
                                uint32_t *id);

// Puts another light in the place of `id`: how lights move.
EtdStatus etd_builder_set_light(struct EtdBuilder *builder,
                                uint32_t id,
                                const struct EtdLight *light);

// Loads a scene file (Mitsuba 3, named *.xml) and the files that it names, and builds it into `*blob`; or reads a blob (*.etd) and checks it.
//
// `abi_version` is `ETD_ABI_VERSION`. `path` is UTF-8 with a 0 at its end. `defines` are `define_count` texts NAME=VALUE: values for `$NAME` in the file. `host`
// (allocator, log) may be null, and so may `advice`. What is wrong, with file and line, goes to the log and into `message`, UTF-8 with a 0 at its end, cut to
// `message_size` bytes; it may be null if that is 0. `ETD_E_IO`: a file can't be read; `ETD_E_PARSE`: one isn't understood; `ETD_E_UNSUPPORTED`: it asks for
// something that isn't there yet; `ETD_E_SCENE`: what it describes can't be built. Any thread may call it, any number at once.
EtdStatus etd_load_file(uint32_t abi_version,
                        const char *path,
                        const char *const *defines,
                        size_t define_count,
                        const struct EtdHost *host,
                        struct EtdBlob *blob,
                        struct EtdAdvice *advice,
                        char *message,
                        size_t message_size);

// Renders the whole image into `rgb`, linear RGB radiance, row by row from the top, `floats` = 3 · width · height of the scene's crop window
// (`etd_scene_inspect`). `rendered` may be null. The same scene, settings and samples give the same bits on any number of threads, the library's or the caller's.
//
// `ETD_E_CANCELLED`: `progress` said so; `rgb` and `rendered` hold the whole passes that were done. Takes 48 bytes a pixel, and as much again per thread for
// estimators with splats. Any thread may call it, any number at once.
EtdStatus etd_host_render(const EtdScene *scene,
                          const EtdSettings *with,
                          const struct EtdRender *how,
                          float *rgb,
                          size_t floats,
                          struct EtdRendered *rendered);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* ETENDUE_HOST_H */

/* The layout that both sides rely on. */
#ifndef ETENDUE_HOST_H_CHECKED
#define ETENDUE_HOST_H_CHECKED
#if defined(__cplusplus) && __cplusplus >= 201103L
#define ETD_ASSERT(holds) static_assert(holds, #holds)
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
#define ETD_ASSERT(holds) _Static_assert(holds, #holds)
#else
#define ETD_ASSERT(holds) typedef char EtdHostAssert[(holds) ? 1 : -1]
#endif
ETD_ASSERT(sizeof(void *) != 8 ||
           (sizeof(EtdHost) == 40 && sizeof(EtdBlob) == 40 && sizeof(EtdBuilt) == 24 && sizeof(EtdCamera) == 108 &&
            sizeof(EtdMaterial) == 120 && sizeof(EtdTexture) == 88 && sizeof(EtdMesh) == 72 && sizeof(EtdSphere) == 48 &&
            sizeof(EtdLight) == 120 && sizeof(EtdMedium) == 264 && sizeof(EtdAdvice) == 12 && sizeof(EtdRender) == 56 && sizeof(EtdRendered) == 80));
#undef ETD_ASSERT
#endif
