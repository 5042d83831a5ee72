/* Every function of etendue.h, called wrongly in every way that it promises to find out: prints nothing and returns 0 if all
 * statuses are the documented ones and no output was touched. */
#include "etendue.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures;

static void expect(int line, const char *call, EtdStatus found, EtdStatus expected)
{
    if (found != expected) {
        printf("line %d: %s gave %d (%s), expected %d\n", line, call, (int)found, etd_error_string(found), (int)expected);
        failures++;
    }
}
#define EXPECT(call, status) expect(__LINE__, #call, call, status)

/* A pointer that no type of more than one byte is aligned at. */
#define ODD(pointer) ((void *)((char *)(pointer) + 1))

static unsigned char blob[1 << 20];

static int never(void *user)
{
    (void)user;
    return 0;
}

static int at_once(void *user)
{
    (void)user;
    return 1;
}

/* A splat that isn't finite or beside the image counts as a failure. */
static void sane(void *user, uint32_t x, uint32_t y, const float *rgb)
{
    const EtdSceneInfo *info = user;
    if (x >= info->width || y >= info->height || !isfinite(rgb[0]) || !isfinite(rgb[1]) || !isfinite(rgb[2])) {
        printf("a splat of %g, %g, %g to %u, %u\n", rgb[0], rgb[1], rgb[2], x, y);
        failures++;
    }
}

static void ignore(void *user, uint32_t x, uint32_t y, const float *rgb)
{
    (void)user, (void)x, (void)y, (void)rgb;
}

/* Hits that don't exist: nothing, NaN, behind, primitives from nowhere. */
static int32_t nonsense(void *user, const EtdRay *ray, EtdHit *hit)
{
    int *calls = user;
    hit->primitive = (uint32_t)*calls * 2654435761u;
    hit->t = *calls % 3 == 0 ? NAN : *calls % 3 == 1 ? -1.0f : ray->t_min + 1.0f;
    hit->u = *calls % 2 ? NAN : 7.0f;
    hit->v = -INFINITY;
    return ++*calls % 5 != 0;
}

static int32_t unlit(void *user, const EtdRay *ray)
{
    (void)user, (void)ray;
    return -1;
}

static float mad(void *user, uint32_t subpath, uint32_t vertex, uint32_t purpose)
{
    static const float values[] = {NAN, -INFINITY, INFINITY, 1.0f, -0.0f, 0.9999999f, 1e-38f, 0.5f};
    int *calls = user;
    (void)subpath, (void)vertex, (void)purpose;
    return values[++*calls % 8];
}

int main(int argc, char **argv)
{
    FILE *file = argc == 2 ? fopen(argv[1], "rb") : NULL;
    if (file == NULL) {
        return 2;
    }
    size_t size = fread(blob, 1, sizeof blob, file);
    fclose(file);
    if (((uintptr_t)blob & 15) != 0) {
        return 2;
    }

    /* Scenes. */
    void *memory = malloc(ETD_SCENE_SIZE);
    const EtdScene *scene = NULL;
    EtdBlobError where = {sizeof where, 0, 0, 0};
    EXPECT(etd_scene_open(ETD_ABI_VERSION + 1, blob, size, memory, ETD_SCENE_SIZE, &scene, NULL), ETD_E_ABI);
    EXPECT(etd_scene_open(ETD_ABI_VERSION, NULL, size, memory, ETD_SCENE_SIZE, &scene, NULL), ETD_E_NULL);
    EXPECT(etd_scene_open(ETD_ABI_VERSION, blob, size, NULL, ETD_SCENE_SIZE, &scene, NULL), ETD_E_NULL);
    EXPECT(etd_scene_open(ETD_ABI_VERSION, blob, size, memory, ETD_SCENE_SIZE, NULL, NULL), ETD_E_NULL);
    EXPECT(etd_scene_open(ETD_ABI_VERSION, blob, size, ODD(memory), ETD_SCENE_SIZE, &scene, NULL), ETD_E_MISALIGNED);
    EXPECT(etd_scene_open(ETD_ABI_VERSION, blob, size, memory, ETD_SCENE_SIZE, ODD(&scene), NULL), ETD_E_MISALIGNED);
    EXPECT(etd_scene_open(ETD_ABI_VERSION, blob, size, memory, ETD_SCENE_SIZE - 1, &scene, NULL), ETD_E_SIZE);
    EXPECT(etd_scene_open(ETD_ABI_VERSION, blob, (size_t)-1, memory, ETD_SCENE_SIZE, &scene, NULL), ETD_E_SIZE);
    EXPECT(etd_scene_open(ETD_ABI_VERSION, blob, 0, memory, ETD_SCENE_SIZE, &scene, NULL), ETD_E_BLOB_TRUNCATED);
    EXPECT(etd_scene_open(ETD_ABI_VERSION, blob + 1, size - 1, memory, ETD_SCENE_SIZE, &scene, NULL),
           ETD_E_BLOB_MISALIGNED);
    EXPECT(etd_scene_open(ETD_ABI_VERSION, blob, size - 64, memory, ETD_SCENE_SIZE, &scene, &where),
           ETD_E_BLOB_TRUNCATED);
    where.struct_size = 8;
    EXPECT(etd_scene_open(ETD_ABI_VERSION, blob, size, memory, ETD_SCENE_SIZE, &scene, &where), ETD_E_SIZE);
    blob[0] ^= 1;
    where.struct_size = sizeof where;
    EXPECT(etd_scene_open(ETD_ABI_VERSION, blob, size, memory, ETD_SCENE_SIZE, &scene, &where), ETD_E_BLOB_MAGIC);
    blob[0] ^= 1;
    if (scene != NULL) {
        printf("a handle was made of nothing\n");
        failures++;
    }
    EXPECT(etd_scene_open(ETD_ABI_VERSION, blob, size, memory, ETD_SCENE_SIZE, &scene, NULL), ETD_OK);

    EtdSceneInfo info = {0};
    EXPECT(etd_scene_inspect(scene, &info), ETD_E_SIZE);
    info.struct_size = sizeof info;
    EXPECT(etd_scene_inspect(NULL, &info), ETD_E_NULL);
    EXPECT(etd_scene_inspect(ODD(scene), &info), ETD_E_MISALIGNED);
    EXPECT(etd_scene_inspect((const EtdScene *)(const void *)blob, &info), ETD_E_HANDLE);
    EXPECT(etd_scene_inspect(scene, NULL), ETD_E_NULL);
    EXPECT(etd_scene_inspect(scene, ODD(&info)), ETD_E_MISALIGNED);
    EXPECT(etd_scene_inspect(scene, &info), ETD_OK);

    size_t count = 0;
    float nine[9];
    uint32_t one;
    EXPECT(etd_scene_triangles(NULL, NULL, NULL, 0, &count), ETD_E_NULL);
    EXPECT(etd_scene_triangles(scene, NULL, &one, 1, &count), ETD_E_NULL);
    EXPECT(etd_scene_triangles(scene, ODD(nine), &one, 1, &count), ETD_E_MISALIGNED);
    EXPECT(etd_scene_triangles(scene, nine, &one, SIZE_MAX, &count), ETD_E_SIZE);
    EXPECT(etd_scene_triangles(scene, nine, &one, SIZE_MAX / 9, &count), ETD_E_SIZE);
    EXPECT(etd_scene_triangles(scene, nine, &one, 1, NULL), ETD_E_NULL);
    EXPECT(etd_scene_triangles(scene, nine, &one, 1, &count), ETD_OK);
    EXPECT(etd_scene_spheres(scene, NULL, NULL, 1, &count), ETD_E_NULL);
    EXPECT(etd_scene_spheres(scene, NULL, NULL, 0, ODD(&count)), ETD_E_MISALIGNED);
    EXPECT(etd_scene_spheres(scene, NULL, NULL, 0, &count), ETD_OK);

    /* Scratch and settings. */
    EtdScratch *scratch = NULL;
    size_t need = etd_scratch_size(32);
    void *room = malloc(need);
    if (etd_scratch_size(0) != 0 || etd_scratch_size(9) != 0 || etd_scratch_size(8) >= need ||
        etd_scratch_size(128) <= need) {
        printf("wrong sizes of scratch\n");
        failures++;
    }
    EXPECT(etd_scratch_init(NULL, need, 32, &scratch), ETD_E_NULL);
    EXPECT(etd_scratch_init(room, need, 32, NULL), ETD_E_NULL);
    EXPECT(etd_scratch_init(ODD(room), need, 32, &scratch), ETD_E_MISALIGNED);
    EXPECT(etd_scratch_init(room, need - 1, 32, &scratch), ETD_E_SIZE);
    EXPECT(etd_scratch_init(room, need, 33, &scratch), ETD_E_ARGUMENT);
    EXPECT(etd_scratch_init(room, need, 32, &scratch), ETD_OK);
    EtdCounters counters = {0};
    EXPECT(etd_scratch_counters(scratch, &counters, 0), ETD_E_SIZE);
    counters.struct_size = sizeof counters;
    EXPECT(etd_scratch_counters(NULL, &counters, 0), ETD_E_NULL);
    EXPECT(etd_scratch_counters((EtdScratch *)memory, &counters, 0), ETD_E_HANDLE);
    EXPECT(etd_scratch_counters(scratch, &counters, 1), ETD_OK);
    EtdSettings settings;
    EXPECT(etd_settings_default(NULL), ETD_E_NULL);
    EXPECT(etd_settings_default(ODD(&settings)), ETD_E_MISALIGNED);
    EXPECT(etd_settings_default(&settings), ETD_OK);

    /* Estimates. */
    float rgb[3] = {-1, -1, -1};
    EtdSettings wrong = settings;
    EtdHooks hooks = {0};
#define PIXEL(scene, settings, hooks, scratch, x, y, rgb)                                                             \
    etd_estimate_pixel(scene, settings, hooks, scratch, x, y, 0, rgb)
    EXPECT(PIXEL(NULL, &settings, NULL, scratch, 0, 0, rgb), ETD_E_NULL);
    EXPECT(PIXEL(scene, NULL, NULL, scratch, 0, 0, rgb), ETD_E_NULL);
    EXPECT(PIXEL(scene, &settings, NULL, NULL, 0, 0, rgb), ETD_E_NULL);
    EXPECT(PIXEL(scene, &settings, NULL, scratch, 0, 0, NULL), ETD_E_NULL);
    EXPECT(PIXEL(scene, &settings, NULL, scratch, 0, 0, ODD(rgb)), ETD_E_MISALIGNED);
    EXPECT(PIXEL(scene, &settings, NULL, scratch, info.width, 0, rgb), ETD_E_ARGUMENT);
    EXPECT(PIXEL(scene, &settings, NULL, scratch, 0, UINT32_MAX, rgb), ETD_E_ARGUMENT);
    wrong.struct_size--;
    EXPECT(PIXEL(scene, &wrong, NULL, scratch, 0, 0, rgb), ETD_E_SIZE);
    wrong = settings;
    wrong.estimator = 7;
    EXPECT(PIXEL(scene, &wrong, NULL, scratch, 0, 0, rgb), ETD_E_ARGUMENT);
    wrong = settings;
    wrong.heuristic = 4;
    EXPECT(PIXEL(scene, &wrong, NULL, scratch, 0, 0, rgb), ETD_E_ARGUMENT);
    wrong = settings;
    wrong.max_edges = -2;
    EXPECT(PIXEL(scene, &wrong, NULL, scratch, 0, 0, rgb), ETD_E_ARGUMENT);
    wrong = settings;
    wrong.large_steps = NAN;
    EXPECT(PIXEL(scene, &wrong, NULL, scratch, 0, 0, rgb), ETD_E_ARGUMENT);
    wrong = settings;
    wrong.view_steps = 1.5f;
    EXPECT(PIXEL(scene, &wrong, NULL, scratch, 0, 0, rgb), ETD_E_ARGUMENT);
    wrong = settings;
    wrong.above = -1;
    EXPECT(PIXEL(scene, &wrong, NULL, scratch, 0, 0, rgb), ETD_E_ARGUMENT);
    wrong.estimator = ETD_METROPOLIS;
    wrong.above = 1;
    EXPECT(etd_chain_bootstrap(scene, &wrong, NULL, scratch, 0, 1, rgb), ETD_E_SPLAT);
    wrong = settings;
    wrong.estimator = ETD_BIDIRECTIONAL;
    EXPECT(PIXEL(scene, &wrong, NULL, scratch, 0, 0, rgb), ETD_E_SPLAT);
    EXPECT(PIXEL(scene, &settings, &hooks, scratch, 0, 0, rgb), ETD_E_SIZE);
    hooks.struct_size = sizeof hooks;
    hooks.closest = nonsense;
    EXPECT(PIXEL(scene, &settings, &hooks, scratch, 0, 0, rgb), ETD_E_ARGUMENT);
    hooks.closest = NULL;

    EtdSamples samples = {sizeof samples, 1, 0, 0}, none = {sizeof none, 0, 0, 0};
    float up[3] = {0, 0, 1}, zero[3] = {0, 0, 0}, nan[3] = {0, NAN, 0}, far[3] = {0, 0, 1e30f};
#define RAYS(from, to, count, samples) etd_estimate_rays(scene, &settings, NULL, scratch, from, to, count, samples, rgb)
    EXPECT(RAYS(NULL, up, 1, &samples), ETD_E_NULL);
    EXPECT(RAYS(zero, ODD(up), 1, &samples), ETD_E_MISALIGNED);
    EXPECT(RAYS(zero, zero, 1, &samples), ETD_E_ARGUMENT);
    EXPECT(RAYS(nan, up, 1, &samples), ETD_E_ARGUMENT);
    EXPECT(RAYS(zero, nan, 1, &samples), ETD_E_ARGUMENT);
    EXPECT(RAYS(far, up, 1, &samples), ETD_E_ARGUMENT);
    EXPECT(RAYS(zero, up, 1, NULL), ETD_E_NULL);
    EXPECT(RAYS(zero, up, 1, &none), ETD_E_ARGUMENT);
    EXPECT(RAYS(zero, up, SIZE_MAX, &samples), ETD_E_SIZE);
    EXPECT(RAYS(zero, up, SIZE_MAX / 12 + 1, &samples), ETD_E_SIZE);
#define POINTS(at, normal, count)                                                                                     \
    etd_estimate_irradiance(scene, &settings, NULL, scratch, at, normal, count, &samples, rgb)
    EXPECT(POINTS(zero, NULL, 1), ETD_E_NULL);
    EXPECT(POINTS(nan, up, 1), ETD_E_ARGUMENT);
    EXPECT(POINTS(zero, zero, 1), ETD_E_ARGUMENT);
    if (rgb[0] != -1 || rgb[1] != -1 || rgb[2] != -1) {
        printf("something was written in spite of an error\n");
        failures++;
    }
    EXPECT(POINTS(NULL, NULL, 0), ETD_OK);

    /* Tiles and films. */
    size_t pixels = (size_t)info.width * info.height;
    float *image = calloc(pixels, 3 * sizeof(float));
    EtdSum *own = calloc(pixels, sizeof *own), *others = calloc(pixels, sizeof *others);
    EtdTile tile = {sizeof tile, 0, 0, info.width, info.height, 1, 0}, outside = tile;
#define TILE(tile, image, floats) etd_render_tile(scene, &settings, &hooks, scratch, tile, image, floats)
    EXPECT(TILE(NULL, image, 3 * pixels), ETD_E_NULL);
    EXPECT(TILE(&tile, NULL, 3 * pixels), ETD_E_NULL);
    EXPECT(TILE(&tile, image, 3 * pixels - 1), ETD_E_SIZE);
    outside.x = 1;
    EXPECT(TILE(&outside, image, 3 * pixels), ETD_E_ARGUMENT);
    outside.x = UINT32_MAX;
    EXPECT(TILE(&outside, image, 3 * pixels), ETD_E_ARGUMENT);
    outside = tile;
    outside.samples = 0;
    EXPECT(TILE(&outside, image, 3 * pixels), ETD_E_ARGUMENT);
    hooks.cancelled = at_once;
    EXPECT(TILE(&tile, image, 3 * pixels), ETD_E_CANCELLED);
    hooks.cancelled = never;
    EXPECT(TILE(&tile, image, 3 * pixels), ETD_OK);
#define FILM(settings, own, others, pixels)                                                                           \
    etd_render_film(scene, settings, NULL, scratch, &tile, own, others, pixels)
    EXPECT(FILM(&settings, NULL, others, pixels), ETD_E_NULL);
    EXPECT(FILM(&settings, own, own, pixels), ETD_E_ARGUMENT);
    EXPECT(FILM(&settings, own, others, pixels - 1), ETD_E_SIZE);
    EXPECT(FILM(&wrong, own, NULL, pixels), ETD_E_SPLAT);
    EXPECT(FILM(&settings, ODD(own), others, pixels), ETD_E_MISALIGNED);
    EXPECT(FILM(&wrong, own, others, pixels), ETD_OK);
    EXPECT(etd_film_merge(NULL, others, pixels), ETD_E_NULL);
    EXPECT(etd_film_merge(own, ODD(others), pixels), ETD_E_MISALIGNED);
    EXPECT(etd_film_merge(own, others, SIZE_MAX), ETD_E_SIZE);
    EXPECT(etd_film_merge(own, others, pixels), ETD_OK);
    EXPECT(etd_film_resolve(scene, own, others, pixels, 0, image), ETD_E_ARGUMENT);
    EXPECT(etd_film_resolve(scene, own, others, pixels + 1, 1, image), ETD_E_SIZE);
    EXPECT(etd_film_resolve(scene, NULL, NULL, pixels, 1, image), ETD_E_NULL);
    EXPECT(etd_film_resolve(scene, own, NULL, pixels, 1, image), ETD_OK);

    /* Chains: what one step or many hand out stays finite, to the largest scale. */
    EtdChain *chain = NULL;
    EtdHooks splats = {0};
    splats.struct_size = sizeof splats;
    splats.user = &info;
    splats.splat = sane;
    void *place = aligned_alloc(ETD_CHAIN_ALIGN, (etd_chain_size() / ETD_CHAIN_ALIGN + 1) * ETD_CHAIN_ALIGN);
    wrong = settings;
    wrong.estimator = ETD_METROPOLIS;
#define START(with, memory, size, out) etd_chain_start(scene, with, scratch, 1, at, memory, size, out)
#define ADVANCE(hooks, handle, scale, steps) etd_chain_advance(scene, &wrong, hooks, scratch, handle, scale, steps)
    uint64_t at = 0;
    for (float found = 0; at < 1000 && found == 0; at += found == 0) {
        EXPECT(etd_chain_bootstrap(scene, &wrong, NULL, scratch, at, 1, &found), ETD_OK);
    }
    EXPECT(START(&settings, place, etd_chain_size(), &chain), ETD_E_ARGUMENT);
    EXPECT(START(&wrong, NULL, etd_chain_size(), &chain), ETD_E_NULL);
    EXPECT(START(&wrong, place, etd_chain_size(), NULL), ETD_E_NULL);
    EXPECT(START(&wrong, ODD(place), etd_chain_size(), &chain), ETD_E_MISALIGNED);
    EXPECT(START(&wrong, place, etd_chain_size() - 1, &chain), ETD_E_SIZE);
    EXPECT(START(&wrong, place, etd_chain_size(), &chain), ETD_OK);
    EXPECT(ADVANCE(&splats, NULL, 1, 1), ETD_E_NULL);
    EXPECT(ADVANCE(&splats, ODD(chain), 1, 1), ETD_E_MISALIGNED);
    EXPECT(ADVANCE(NULL, chain, 1, 1), ETD_E_SPLAT);
    EXPECT(ADVANCE(&splats, chain, NAN, 1), ETD_E_ARGUMENT);
    EXPECT(ADVANCE(&splats, chain, -1, 1), ETD_E_ARGUMENT);
    EXPECT(ADVANCE(&splats, chain, INFINITY, 0), ETD_E_ARGUMENT);
    EXPECT(ADVANCE(&splats, chain, 2e28f, 1), ETD_E_ARGUMENT);
    EXPECT(ADVANCE(&splats, chain, 1e27f, 11), ETD_E_ARGUMENT);
    EXPECT(ADVANCE(&splats, chain, 1e28f, 1), ETD_OK);
    EXPECT(ADVANCE(&splats, chain, 1e25f, 1000), ETD_OK);
    EXPECT(ADVANCE(&splats, chain, 0, UINT32_MAX >> 20), ETD_OK);
    EXPECT(etd_chain_accepted(chain, NULL), ETD_E_NULL);
    EXPECT(etd_chain_accepted(NULL, rgb), ETD_E_NULL);
    free(place);
    wrong = settings;
    wrong.estimator = ETD_BIDIRECTIONAL;

    /* Functions of the caller that lie: light may be wrong, but it is finite and nothing breaks. */
    int calls = 0;
    hooks.user = &calls;
    hooks.splat = ignore;
    hooks.random = mad;
    EXPECT(etd_render_tile(scene, &wrong, &hooks, scratch, &tile, image, 3 * pixels), ETD_OK);
    hooks.closest = nonsense;
    hooks.occluded = unlit;
    EXPECT(etd_render_tile(scene, &wrong, &hooks, scratch, &tile, image, 3 * pixels), ETD_OK);
    hooks.random = NULL;
    EXPECT(etd_render_tile(scene, &wrong, &hooks, scratch, &tile, image, 3 * pixels), ETD_OK);
    for (size_t i = 0; i < 3 * pixels; i++) {
        /* Where paths carry wavelengths (1 << 14), one is beyond sRGB's gamut. */
        if (!isfinite(image[i]) || (image[i] < 0 && (info.needs & 1u << 14) == 0)) {
            printf("a pixel is %g\n", image[i]);
            failures++;
        }
    }
    if (etd_abi_version() != ETD_ABI_VERSION || strcmp(etd_error_string(12345), "an unknown status") != 0) {
        failures++;
    }
    free(others);
    free(own);
    free(image);
    free(room);
    free(memory);
    return failures != 0;
}
