/* Étendue: light transport to embed. Generated from kernel/src/capi; don't edit.
 *
 * Call order: etd_scene_open, etd_scratch_init (one scratch per thread), then estimates, in any order and from any
 * number of threads. Nothing is allocated: handles live in your memory, and there is nothing to close.
 *
 * Conventions
 *   World     right-handed; which axis is up is the scene's business. Lengths are in the scene's unit.
 *   Triangles the front is where the vertices run counter-clockwise.
 *   Images    row 0 is the top row; x counts columns from the left, y rows from the top, both within the crop window.
 *   Colour    linear RGB with the primaries and white of sRGB (ITU-R BT.709), red first.
 *   Units     radiance W/(m² sr), irradiance W/m², per channel, in the units that the scene's lights were given in.
 *   Arrays    of vectors are x, y, z, x, y, z, … without padding.
 *
 * Every function that returns EtdStatus returns ETD_OK (0) or one of ETD_E_…; then its outputs are unchanged unless it
 * says otherwise. Null and misaligned pointers, wrong sizes and foreign handles are found out. Every struct begins with
 * struct_size: set it to the struct's sizeof. Functions of yours that the library calls must return normally.
 * The floating-point control word is saved, set to IEEE 754's defaults and restored by each call that computes.
 *
 * The same inputs give the same bits on every machine and thread count.
 */


#ifndef ETENDUE_H
#define ETENDUE_H

#include <stddef.h>
#include <stdint.h>

// All is well.
#define ETD_OK 0

// A pointer that must not be null is null.
#define ETD_E_NULL 1

// A pointer is not aligned for what it points to.
#define ETD_E_MISALIGNED 2

// A `struct_size` is not that of this version's struct, or memory is too small.
#define ETD_E_SIZE 3

// The header that the caller was compiled with is another version's.
#define ETD_E_ABI 4

// A number is outside its range.
#define ETD_E_ARGUMENT 5

// The caller's `cancelled` said so.
#define ETD_E_CANCELLED 6

// This build of the library, or this estimator, doesn't have it.
#define ETD_E_UNSUPPORTED 7

// A handle was not made by this library, or its memory has been overwritten.
#define ETD_E_HANDLE 8

// The estimator reports splats, and there is no `splat` to take them.
#define ETD_E_SPLAT 9

// The blob's address is not a multiple of 16.
#define ETD_E_BLOB_MISALIGNED 100

// The blob is shorter or longer than its header says.
#define ETD_E_BLOB_TRUNCATED 101

// Not an Étendue blob.
#define ETD_E_BLOB_MAGIC 102

// A blob of another version.
#define ETD_E_BLOB_VERSION 103

// The scene needs something that this build doesn't have.
#define ETD_E_BLOB_NEEDS 104

// The table of contents is damaged.
#define ETD_E_BLOB_SECTION 105

// A reserved field is not zero.
#define ETD_E_BLOB_RESERVED 106

// A number is not finite or out of range.
#define ETD_E_BLOB_RANGE 107

// An id points to nothing, or to the wrong thing.
#define ETD_E_BLOB_REFERENCE 108

// An unknown kind or flag.
#define ETD_E_BLOB_KIND 109

// The nodes are not a tree of the stated depth.
#define ETD_E_BLOB_TREE 110

// Two numbers that must agree don't.
#define ETD_E_BLOB_MISMATCH 111

// A file can't be read.
#define ETD_E_IO 200

// A file is not a scene: it says something that isn't known, or makes no sense.
#define ETD_E_PARSE 201

// The scene can't be built from what was given.
#define ETD_E_SCENE 202

// Not enough memory, or the caller's `allocate` said so.
#define ETD_E_MEMORY 203

// The library has a bug: it panicked, and stopped at its boundary. Free the handles that the call used.
#define ETD_E_PANIC 204

// The operating system gives no threads.
#define ETD_E_THREADS 205

// The caller's `run` returned before it had run every job.
#define ETD_E_JOBS 206

// The version of the functions and structs in this header.
#define ETD_ABI_VERSION 1

// Bytes of memory that a scene's handle needs, on every target.
#define ETD_SCENE_SIZE 384

// What that memory must be aligned to.
#define ETD_SCENE_ALIGN 16

// What a blob's first byte must be aligned to.
#define ETD_BLOB_ALIGN 16

// A walk from the sensor, with a light sampled at each vertex.
#define ETD_PATH 0

// A walk from a light, each vertex joined to the sensor. Reports splats.
#define ETD_LIGHT 1

// Both walks and all connections between them. Reports splats.
#define ETD_BIDIRECTIONAL 2

// Ray trees to a stated depth (`branching`); longer paths are left out.
#define ETD_DISTRIBUTED 3

// Direct light and single scattering by quadrature (`quadrature`, `steps`); all other light is left out. Scenes with
// environments, constant backgrounds or glowing media: `ETD_E_UNSUPPORTED`.
#define ETD_QUADRATURE 4

// The same, and what it leaves out by path tracing.
#define ETD_QUADRATURE_AND_PATH 5

// Chains of paths over `ETD_BIDIRECTIONAL` (`etd_chain_advance`). Where samples of pixels, rays or points are asked for, they are those of
// `ETD_BIDIRECTIONAL`.
#define ETD_METROPOLIS 6

// Weights in proportion to densities.
#define ETD_BALANCE 0

// Weights in proportion to squared densities.
#define ETD_POWER 1

// Balance, without strategies of less than a tenth of the best one's density.
#define ETD_CUTOFF 2

// The densest strategy alone.
#define ETD_MAXIMUM 3

// Independent numbers.
#define ETD_INDEPENDENT 0

// Owen-scrambled Sobol' points: the samples of a pixel spread evenly. Best for a power of two of samples.
#define ETD_SOBOL 1

// What scratch memory must be aligned to.
#define ETD_SCRATCH_ALIGN 16

// What chain memory must be aligned to.
#define ETD_CHAIN_ALIGN 16

// A chain of paths, made by `etd_chain_start` in memory of the caller. One thread at a time.
typedef struct EtdChain EtdChain;

// A scene that has been opened: lives in the caller's memory, needs no closing. It doesn't change: any number of
// threads may use one at once. It refers to its blob, which must stay where it is, unchanged, as long as the scene is used.
typedef struct EtdScene EtdScene;

// The memory that estimates work in, made by `etd_scratch_init` in memory of the caller. One thread at a time; one for each thread.
typedef struct EtdScratch EtdScratch;

// What a function returns: `ETD_OK`, or one of `ETD_E_…`.
typedef int32_t EtdStatus;

// Where a blob is damaged.
typedef struct EtdBlobError {
    // sizeof(EtdBlobError), set by the caller.
    uint32_t struct_size;
    // The section (0: header or table of contents), numbered as in the blob's format.
    uint32_t section;
    // The record in it.
    uint32_t index;
    // The rule of the format that it breaks (`etd_rule_string`).
    uint32_t rule;
} EtdBlobError;

// What a scene is and holds.
typedef struct EtdSceneInfo {
    // sizeof(EtdSceneInfo), set by the caller.
    uint32_t struct_size;
    // Columns of the image.
    uint32_t width;
    // Rows of the image.
    uint32_t height;
    // What the scene holds: bits as the blob's format numbers them.
    uint32_t needs;
    // Triangles.
    uint32_t triangles;
    // Spheres.
    uint32_t spheres;
    // Objects.
    uint32_t shapes;
    // Local models.
    uint32_t materials;
    // Textures.
    uint32_t textures;
    // Lights.
    uint32_t emitters;
    // Levels of the tree below its root.
    uint32_t depth;
    // The instructions that rays are traced with: 0 scalar, 1 SSE2, 2 AVX2. All give the same bits.
    uint32_t instructions;
    // Centre of a sphere around the scene, world units.
    float center[3];
    // Its radius.
    float radius;
} EtdSceneInfo;

// How to estimate. `etd_settings_default` fills it in.
typedef struct EtdSettings {
    // sizeof(EtdSettings).
    uint32_t struct_size;
    // `ETD_PATH`, `ETD_LIGHT`, `ETD_BIDIRECTIONAL`, `ETD_DISTRIBUTED`, `ETD_QUADRATURE`, `ETD_QUADRATURE_AND_PATH` or
    // `ETD_METROPOLIS`.
    uint32_t estimator;
    // `ETD_BALANCE`, `ETD_POWER`, `ETD_CUTOFF` or `ETD_MAXIMUM`.
    uint32_t heuristic;
    // The most edges of a path (1: emitters seen directly, 2: direct light, …); −1: no limit.
    int32_t max_edges;
    // Selects the random numbers.
    uint64_t seed;
    // `ETD_DISTRIBUTED`: rays that go on from a vertex, by level, up to the first 0; paths have at most an edge more than there are
    // levels. The scratch's capacity bounds the levels as well.
    uint8_t branching[8];
    // `ETD_DISTRIBUTED`: samples of lights at each vertex, 1 to 255.
    uint32_t light_samples;
    // Quadrature: nodes of the Gauss–Legendre rule in each direction across an emitting triangle or sphere, 1 to 8.
    uint32_t quadrature;
    // Quadrature: steps of the trapezoid rule along a way through a medium, 1 to 65535.
    uint32_t steps;
    // Quadrature: not 0: equal steps shifted at random in place of these rules, without bias.
    uint32_t shift;
    // `ETD_INDEPENDENT` or `ETD_SOBOL`.
    uint32_t sequence;
    // Walks that carry less than this share of what they began with go on by Russian roulette, 0 to 1. So are connections of
    // `bidirectional` looked at that carry less than a tenth of this share of what their sample has so far. 0: no roulette.
    float roulette;
    // `ETD_METROPOLIS`: how often a step of a chain is a path drawn anew, 0 to 1.
    float large_steps;
    // `ETD_METROPOLIS`: the largest change of a random number in what steps are left, above 0, at most 0.5.
    float step_size;
    // `ETD_METROPOLIS`: the share of the other steps that move the path's place in the image and nothing else, 0 to 1.
    float view_steps;
    // `ETD_METROPOLIS`: what chains leave to the samples of the bootstrap: what a contribution carries up to so much, a radiance, at least 0. 0: nothing.
    float above;
} EtdSettings;

// What happened since the scratch was made or its counters were last cleared.
typedef struct EtdCounters {
    // sizeof(EtdCounters), set by the caller.
    uint32_t struct_size;
    // Zero.
    uint32_t reserved;
    // Rays for which the closest hit was asked.
    uint64_t closest_rays;
    // Segments that were asked to be free.
    uint64_t shadow_rays;
    // Walks from a light.
    uint64_t light_walks;
    // Walks cut by the limit of steps.
    uint64_t cut_walks;
    // Light walks that ended because the scratch's capacity was reached.
    uint64_t full_walks;
    // Contributions refused because they were NaN, infinite or negative, or too large for a film.
    uint64_t rejected;
} EtdCounters;

// A ray: origin + t·direction with t_min < t < t_max. In world space, world units.
typedef struct EtdRay {
    // sizeof(EtdRay); set by the library.
    uint32_t struct_size;
    // Zero.
    uint32_t reserved;
    // Where it starts.
    float origin[3];
    // Where it goes; unit length.
    float direction[3];
    // Nearest t, exclusive.
    float t_min;
    // Farthest t, exclusive; may be infinite.
    float t_max;
} EtdRay;

// Where a ray met a primitive. `struct_size` is set by the library before it asks.
typedef struct EtdHit {
    // sizeof(EtdHit).
    uint32_t struct_size;
    // The primitive, as `etd_scene_triangles` and `etd_scene_spheres` number them.
    uint32_t primitive;
    // Distance along the ray.
    float t;
    // Barycentric weight of the triangle's second vertex; unused on spheres.
    float u;
    // Barycentric weight of the triangle's third vertex; unused on spheres.
    float v;
} EtdHit;

// Functions of the caller; each may be null. They get `user`, run on the calling thread with the library's
// floating-point control word, and must return: no longjmp, no C++ exception may leave them.
typedef struct EtdHooks {
    // sizeof(EtdHooks).
    uint32_t struct_size;
    // Zero.
    uint32_t reserved;
    // Handed to every function.
    void *user;
    // What a sample adds to pixel (x, y) of the image, to be divided by the samples per pixel like the samples themselves.
    // Needed for pixels and tiles by the estimators `light` and `bidirectional`.
    void (*splat)(void *user,
                  uint32_t x,
                  uint32_t y,
                  const float *rgb);
    // Asked between samples; anything but 0 stops the call with `ETD_E_CANCELLED`.
    int32_t (*cancelled)(void *user);
    // The caller's own ray tracer: the closest hit; 0 for none. Triangles are two-sided. Given together with `occluded`, or
    // not at all. A hit outside (t_min, t_max) or on a primitive that doesn't exist counts as none.
    int32_t (*closest)(void *user,
                       const struct EtdRay *ray,
                       struct EtdHit *hit);
    // Whether anything is hit at t_min < t < t_max; 0 for no.
    int32_t (*occluded)(void *user,
                        const struct EtdRay *ray);
    // The caller's own random numbers in [0, 1), uniform. `subpath` 0 is the walk from the sensor, 1 from a light, 2 any of those that the sensor's
    // is split into; `vertex` counts along it; `purpose` says what for (0 filter, 1 lens, 2 choice of light, 3 point on it, 4 its direction,
    // 5 lobe, 6 direction, 7 opacity, 8 roulette, 9 leading channel, 10 flight, 11 part of a blend). A value outside [0, 1) is taken to the nearer end.
    float (*random)(void *user,
                    uint32_t subpath,
                    uint32_t vertex,
                    uint32_t purpose);
} EtdHooks;

// Which samples of a batch.
typedef struct EtdSamples {
    // sizeof(EtdSamples).
    uint32_t struct_size;
    // Samples of each element, at least 1.
    uint32_t samples;
    // Index of the first of them.
    uint64_t first_sample;
    // Number of the first element: with the sample's index it selects the random numbers. Element i has `first_id` + i.
    uint64_t first_id;
} EtdSamples;

// A rectangle of the image, and which samples of its pixels.
typedef struct EtdTile {
    // sizeof(EtdTile).
    uint32_t struct_size;
    // First column.
    uint32_t x;
    // First row, from the top.
    uint32_t y;
    // Columns.
    uint32_t width;
    // Rows.
    uint32_t height;
    // Samples of each pixel, at least 1.
    uint32_t samples;
    // Index of the first of them: the next call for more goes on where this one ended.
    uint64_t first_sample;
} EtdTile;

// Exact sums of red, green and blue: integers of 128 bits (two's complement), low word first. All zero at the beginning. The same bits on
// every machine; may be stored and sent.
typedef struct EtdSum {
    // Low and high words of red, green and blue.
    uint64_t words[6];
} EtdSum;

// What a pilot found of an estimator. All 0 but `struct_size` before the first call.
typedef struct EtdPilot {
    // sizeof(EtdPilot).
    uint32_t struct_size;
    // Whether a sample met light: 0 or 1. Where another estimator's did, one without any has missed it.
    uint32_t bright;
    // Squared error of all samples together, mean over channels, radiance².
    double squared_error;
    // Samples taken.
    uint64_t samples;
    // Their rays.
    uint64_t rays;
} EtdPilot;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// What a status means, in English, in UTF-8; never null, valid forever. Any thread may call it.
const char *etd_error_string(EtdStatus status);

// What a rule of the blob's format demands (`EtdBlobError.rule`), in English, in UTF-8; never null, valid forever. Any thread may call it.
const char *etd_rule_string(uint32_t rule);

// The version of this library's functions and structs: what `etd_scene_open` compares with the caller's
// `ETD_ABI_VERSION`. Any thread may call it.
uint32_t etd_abi_version(void);

// Checks a blob and makes a scene of it in `memory`, in time linear in `blob_size`. Any bytes are safe to open.
//
// `abi_version` is `ETD_ABI_VERSION`. `blob` is `blob_size` bytes, aligned to `ETD_BLOB_ALIGN`, and stays the caller's; it must
// not change or move while the scene is used. `memory` is `memory_size` ≥ `ETD_SCENE_SIZE` bytes, aligned to `ETD_SCENE_ALIGN`; `*out` will
// point into it. `error`, if not null, is filled in where the blob is refused (`ETD_E_BLOB_…`).
EtdStatus etd_scene_open(uint32_t abi_version,
                         const uint8_t *blob,
                         size_t blob_size,
                         void *memory,
                         size_t memory_size,
                         const struct EtdScene **out,
                         struct EtdBlobError *error);

// What a scene is and holds. Set `info->struct_size` before.
EtdStatus etd_scene_inspect(const struct EtdScene *handle,
                            struct EtdSceneInfo *info);

// Lists triangles, for a ray tracer of the caller's own: 9 floats each (x, y, z of three vertices, world units; counter-clockwise seen
// from the front) into `positions`, and the number by which `EtdHit` names it into `primitives`. Writes at most `capacity` of them and
// the number there are into `*count`; both arrays may be null if `capacity` is 0.
EtdStatus etd_scene_triangles(const struct EtdScene *handle,
                              float *positions,
                              uint32_t *primitives,
                              size_t capacity,
                              size_t *count);

// Lists spheres: 4 floats each (centre, radius) and the number by which `EtdHit` names it; otherwise like `etd_scene_triangles`.
EtdStatus etd_scene_spheres(const struct EtdScene *handle,
                            float *spheres,
                            uint32_t *primitives,
                            size_t capacity,
                            size_t *count);

// Path tracing with the power heuristic, paths of any length, seed 0.
EtdStatus etd_settings_default(struct EtdSettings *settings);

// Bytes of memory that a scratch of `capacity` needs: 8, 32 or 128 vertices of a stored light walk (it bounds which
// bidirectional strategies exist, not the length of paths; `ETD_PATH` needs none). 0 for another capacity.
size_t etd_scratch_size(uint32_t capacity);

// Makes a scratch of `capacity` in `memory`: `memory_size` ≥ `etd_scratch_size(capacity)` bytes, aligned to `ETD_SCRATCH_ALIGN`, the
// caller's to free when no longer used. `*out` will point into it.
EtdStatus etd_scratch_init(void *memory,
                           size_t memory_size,
                           uint32_t capacity,
                           struct EtdScratch **out);

// What happened; `clear` other than 0 begins anew. Set `counters->struct_size` before.
EtdStatus etd_scratch_counters(struct EtdScratch *handle,
                               struct EtdCounters *counters,
                               int32_t clear);

// One sample of the pixel in column `x` and row `y` (from the top) into `rgb[3]`, linear RGB radiance. With n samples of each pixel,
// pixel = (sum of what is returned + sum of splats to it)/n. The same (scene, settings, x, y, `sample`) always gives the same bits.
// `hooks` may be null. Where paths carry wavelengths (bit 14 of `needs`), a channel of one sample may be negative, here and in the functions
// below: one wavelength is beyond the gamut of any red, green and blue.
EtdStatus etd_estimate_pixel(const struct EtdScene *scene,
                             const struct EtdSettings *with,
                             const struct EtdHooks *hooks,
                             struct EtdScratch *memory,
                             uint32_t x,
                             uint32_t y,
                             uint64_t sample,
                             float *rgb);

// The radiance that arrives along `count` rays: 3 floats each of `origins` (world units) and `directions` (from the origin outwards; any length but 0)
// into 3 floats each of `rgb`, the mean of the samples. `ETD_LIGHT` is answered by `ETD_PATH`: no light walk meets a ray.
// Cancelled: elements not yet done are left as they were. Wrong input: nothing is written.
EtdStatus etd_estimate_rays(const struct EtdScene *scene,
                            const struct EtdSettings *with,
                            const struct EtdHooks *hooks,
                            struct EtdScratch *memory,
                            const float *origins,
                            const float *directions,
                            size_t count,
                            const struct EtdSamples *samples,
                            float *rgb);

// The irradiance at `count` points: 3 floats each of `positions` (world units; they may lie on the scene's geometry) and `normals` (any length but 0),
// on the side of the normal, into 3 floats each of `rgb`, the mean of the samples. Otherwise like `etd_estimate_rays`.
EtdStatus etd_estimate_irradiance(const struct EtdScene *scene,
                                  const struct EtdSettings *with,
                                  const struct EtdHooks *hooks,
                                  struct EtdScratch *memory,
                                  const float *positions,
                                  const float *normals,
                                  size_t count,
                                  const struct EtdSamples *samples,
                                  float *rgb);

// Renders a tile: the mean of each pixel's samples into `rgb`, 3 floats a pixel, row by row, `floats` = 3 · width · height of the tile.
// Splats, which may fall anywhere in the image, go to `hooks->splat`, undivided: add them up and divide by the samples per pixel.
EtdStatus etd_render_tile(const struct EtdScene *scene,
                          const struct EtdSettings *with,
                          const struct EtdHooks *hooks,
                          struct EtdScratch *memory,
                          const struct EtdTile *tile,
                          float *rgb,
                          size_t floats);

// Renders a tile into exact sums of the whole image: `samples` for the pixels themselves, `splats` for what they add to others (may be null for
// `ETD_PATH`, and may be the same array as no other). `pixels` is the image's width times its height. Give each thread its own sums, or its own
// rows of `samples`; merge with `etd_film_merge`: any split of the work gives the same bits.
EtdStatus etd_render_film(const struct EtdScene *scene,
                          const struct EtdSettings *with,
                          const struct EtdHooks *hooks,
                          struct EtdScratch *memory,
                          const struct EtdTile *tile,
                          struct EtdSum *samples,
                          struct EtdSum *splats,
                          size_t pixels);

// Adds to `*sum` what pixels number `first` to `first + count` of a pilot say of `with->estimator`: two samples each of pixels all over the image, with numbers that no
// render has. An image of as many samples per pixel has `squared_error`/`samples` as its mean squared error after one pass, and a sample costs
// `rays`/`samples`: choose the estimator whose product of both is least; a few thousand pixels tell. No splats are reported; `hooks` may be null.
// Cancelled: what has been done is in `*sum`.
EtdStatus etd_pilot(const struct EtdScene *scene,
                    const struct EtdSettings *with,
                    const struct EtdHooks *hooks,
                    struct EtdScratch *memory,
                    uint64_t first,
                    uint32_t count,
                    struct EtdPilot *sum);

// Bytes of memory that a chain needs.
size_t etd_chain_size(void);

// Estimates of the mean (over pixels and channels, radiance) of what chains are to give, by samples number `first` to `first + count`, one each, into
// `estimates[count]`. Their mean is what `etd_chain_advance` scales by; each chain should start from one of these samples, drawn in proportion to its
// estimate: tens of thousands are a good number, and a few of each pixel; as many in a row as the image has pixels begin in each once. What
// `with->above` leaves to the samples goes to `hooks->splat`, which must be there if that isn't 0: with n samples per pixel, the image is the sum of
// these splats/n, and what chains give. `with->estimator` is `ETD_METROPOLIS`; `hooks` may be null, `closest` and `random` have to be.
EtdStatus etd_chain_bootstrap(const struct EtdScene *scene,
                              const struct EtdSettings *with,
                              const struct EtdHooks *hooks,
                              struct EtdScratch *memory,
                              uint64_t first,
                              size_t count,
                              float *estimates);

// Makes chain number `id` in `memory` (`memory_size` ≥ `etd_chain_size()` bytes, aligned to `ETD_CHAIN_ALIGN`, the caller's to free) at sample `sample` of
// `etd_chain_bootstrap`, whose scene and settings are the same. The number selects the random numbers. `*out` will point into the memory.
EtdStatus etd_chain_start(const struct EtdScene *scene,
                          const struct EtdSettings *with,
                          struct EtdScratch *scratch,
                          uint64_t id,
                          uint64_t sample,
                          void *memory,
                          size_t memory_size,
                          struct EtdChain **out);

// Takes `steps` steps of a chain. `scale` is the image's mean, from bootstrap estimates; 0 ≤ `scale` × `steps` ≤ 1e28. Splats go to
// `hooks->splat`, which must be there: with n steps per pixel of the image by all chains together, pixel = sum of splats to it/n. `closest` and
// `random` have to be null; `cancelled` is asked before the first step, and a call that has begun takes all of them.
EtdStatus etd_chain_advance(const struct EtdScene *scene,
                            const struct EtdSettings *with,
                            const struct EtdHooks *hooks,
                            struct EtdScratch *memory,
                            struct EtdChain *handle,
                            float scale,
                            uint32_t steps);

// The share of small steps that a chain has accepted since it started, 0 to 1: `step_size` is good where it is about a half. Tune it with chains
// that are thrown away.
EtdStatus etd_chain_accepted(struct EtdChain *handle,
                             float *share);

// Adds the `pixels` sums of `from` to those of `to`, exactly: the order of merging doesn't matter. The two must not overlap.
EtdStatus etd_film_merge(struct EtdSum *to,
                         const struct EtdSum *from,
                         size_t pixels);

// Turns the sums of a whole image into linear RGB, 3 floats a pixel, row by row from the top: (samples + splats)/`samples_per_pixel`.
// `splats` may be null if there are none. `pixels` is the image's width times its height.
EtdStatus etd_film_resolve(const struct EtdScene *handle,
                           const struct EtdSum *samples,
                           const struct EtdSum *splats,
                           size_t pixels,
                           uint64_t samples_per_pixel,
                           float *rgb);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* ETENDUE_H */

/* The layout that both sides rely on. */
#ifndef ETENDUE_H_CHECKED
#define ETENDUE_H_CHECKED
#if defined(__cplusplus) && __cplusplus >= 201103L
#define ETD_ASSERT(holds) static_assert(holds, #holds)
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
#define ETD_ASSERT(holds) _Static_assert(holds, #holds)
#else
#define ETD_ASSERT(holds) typedef char EtdAssert[(holds) ? 1 : -1]
#endif
ETD_ASSERT(sizeof(EtdSettings) == 72 && sizeof(EtdTile) == 32 && sizeof(EtdSamples) == 24 && sizeof(EtdCounters) == 56 &&
           sizeof(EtdRay) == 40 && sizeof(EtdHit) == 20 && sizeof(EtdSum) == 48 && sizeof(EtdPilot) == 32 &&
           sizeof(EtdBlobError) == 16 && sizeof(EtdSceneInfo) == 64 && sizeof(EtdHooks) == 8 + 6 * sizeof(void *) &&
           ETD_SCENE_SIZE % ETD_SCENE_ALIGN == 0);
#undef ETD_ASSERT
#endif
