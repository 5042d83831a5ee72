/* The kernel with no operating system to speak of: no C library, no allocation, memory that is fixed when the program
 * is built. Prints the hashes that every target must print (tests/data/bits.txt), then renders the Cornell box.
 *
 *   gcc -O2 -ffreestanding -fno-builtin -fno-stack-protector -nostdlib -static -no-pie -I kernel/include main.c libetendue.a
 */
#include "etendue.h"
#include "start.h"

INCLUDE_BLOB(matter, BLOBS "/matter.etd");
INCLUDE_BLOB(gloss, BLOBS "/gloss.etd");
INCLUDE_BLOB(fog, BLOBS "/fog.etd");
INCLUDE_BLOB(prism, BLOBS "/prism.etd");
INCLUDE_BLOB(round, BLOBS "/round.etd");
INCLUDE_BLOB(open_air, BLOBS "/open_air.etd");
INCLUDE_BLOB(plan, BLOBS "/plan.etd");
INCLUDE_BLOB(cornell, CORNELL);

#define PIXELS (64 * 64)

static _Alignas(ETD_SCENE_ALIGN) unsigned char scene_memory[ETD_SCENE_SIZE];
static _Alignas(ETD_SCRATCH_ALIGN) unsigned char scratch_memory[32 * 1024];
static EtdSum samples[PIXELS], splats[PIXELS];
static float rgb[3 * PIXELS];

static const EtdScene *scene;
static EtdScratch *scratch;

static const char digits[] = "0123456789abcdef";

static void put_text(const char *text)
{
    size_t length = 0;
    while (text[length] != 0) {
        length++;
    }
    put(1, text, length);
}

static void put_hash(uint64_t hash)
{
    char text[17];
    for (int i = 0; i < 16; i++) {
        text[i + 1] = digits[hash >> (60 - 4 * i) & 15];
    }
    text[0] = ' ';
    put(1, text, 17);
}

/* FNV-1a over the bits of numbers, lowest byte first. */
static uint64_t hash_of(const float *values, size_t count)
{
    uint64_t hash = 0xcbf29ce484222325u;
    const unsigned char *bytes = (const unsigned char *)values;
    for (size_t i = 0; i < count * sizeof(float); i++) {
        hash = (hash ^ bytes[i]) * 0x100000001b3u;
    }
    return hash;
}

static EtdStatus open(const unsigned char *blob, const unsigned char *end)
{
    return etd_scene_open(ETD_ABI_VERSION, blob, (size_t)(end - blob), scene_memory, sizeof scene_memory, &scene, NULL);
}

/* Renders the whole image into `rgb`; returns its pixels, 0 if something is wrong. */
static size_t render(const EtdSettings *settings, uint32_t passes)
{
    EtdSceneInfo info = {.struct_size = sizeof info};
    if (etd_scene_inspect(scene, &info) != ETD_OK) {
        return 0;
    }
    size_t pixels = (size_t)info.width * info.height;
    if (pixels > PIXELS) {
        return 0;
    }
    for (size_t i = 0; i < pixels; i++) {
        for (int j = 0; j < 6; j++) {
            samples[i].words[j] = splats[i].words[j] = 0;
        }
    }
    EtdTile tile = {sizeof tile, 0, 0, info.width, info.height, passes, 0};
    if (etd_render_film(scene, settings, NULL, scratch, &tile, samples, splats, pixels) != ETD_OK ||
        etd_film_resolve(scene, samples, splats, pixels, passes, rgb) != ETD_OK) {
        return 0;
    }
    return pixels;
}

/* Irradiance at the middle of the scene and radiance along a ray from there, sample by sample. */
static int probe(const EtdSettings *settings, float values[48])
{
    static const float up[3] = {0, 0, 1}, down[3] = {0, 0, -1};
    EtdSceneInfo info = {.struct_size = sizeof info};
    int ok = etd_scene_inspect(scene, &info) == ETD_OK;
    for (uint64_t i = 0; i < 8; i++) {
        EtdSamples one = {sizeof one, 1, i, 1}, other = {sizeof other, 1, i, 2};
        float *to = values + 6 * i;
        ok &= etd_estimate_irradiance(scene, settings, NULL, scratch, info.center, up, 1, &one, to) == ETD_OK;
        ok &= etd_estimate_rays(scene, settings, NULL, scratch, info.center, down, 1, &other, to + 3) == ETD_OK;
    }
    return ok;
}

/* Whether this estimator can answer for the scene at all. */
static int supported(const EtdSettings *settings)
{
    static const float up[3] = {0, 0, 1};
    float value[3];
    EtdSamples one = {sizeof one, 1, 0, 0};
    return etd_estimate_rays(scene, settings, NULL, scratch, up, up, 1, &one, value) != ETD_E_UNSUPPORTED;
}

static const struct {
    const char *name;
    uint32_t estimator, heuristic, sequence;
} suite[] = {
    {" path balance", ETD_PATH, ETD_BALANCE, ETD_INDEPENDENT},
    {" path maximum", ETD_PATH, ETD_MAXIMUM, ETD_INDEPENDENT},
    {" path sobol", ETD_PATH, ETD_POWER, ETD_SOBOL},
    {" light power", ETD_LIGHT, ETD_POWER, ETD_INDEPENDENT},
    {" bidirectional balance", ETD_BIDIRECTIONAL, ETD_BALANCE, ETD_INDEPENDENT},
    {" bidirectional power", ETD_BIDIRECTIONAL, ETD_POWER, ETD_INDEPENDENT},
    {" bidirectional cutoff", ETD_BIDIRECTIONAL, ETD_CUTOFF, ETD_INDEPENDENT},
    {" bidirectional maximum", ETD_BIDIRECTIONAL, ETD_MAXIMUM, ETD_INDEPENDENT},
    {" bidirectional sobol", ETD_BIDIRECTIONAL, ETD_POWER, ETD_SOBOL},
    {" distributed power", ETD_DISTRIBUTED, ETD_POWER, ETD_INDEPENDENT},
    {" quadrature power", ETD_QUADRATURE, ETD_POWER, ETD_INDEPENDENT},
    {" quadrature+path power", ETD_QUADRATURE_AND_PATH, ETD_POWER, ETD_INDEPENDENT},
};

static int run_suite(const char *name, const unsigned char *blob, const unsigned char *end)
{
    if (open(blob, end) != ETD_OK) {
        return 0;
    }
    for (size_t i = 0; i < sizeof suite / sizeof *suite; i++) {
        EtdSettings settings;
        float values[48];
        etd_settings_default(&settings);
        settings.estimator = suite[i].estimator;
        settings.heuristic = suite[i].heuristic;
        settings.sequence = suite[i].sequence;
        settings.seed = 3;
        /* Small trees, coarse rules: there are microcontrollers among the targets. */
        for (size_t level = 0; level < sizeof settings.branching; level++) {
            settings.branching[level] = level < 2 ? 2 : level < 3 ? 1 : 0;
        }
        settings.light_samples = 2;
        settings.quadrature = 2;
        settings.steps = 4;
        /* Lights that quadrature makes nothing of. */
        if (!supported(&settings)) {
            continue;
        }
        size_t pixels = render(&settings, 2);
        if (pixels == 0 || !probe(&settings, values)) {
            return 0;
        }
        put_text(name);
        put_text(suite[i].name);
        put_hash(hash_of(rgb, 3 * pixels));
        put_hash(hash_of(values, 48));
        put_text("\n");
    }
    return 1;
}

/* The Cornell box, with a square root for a tone curve. */
static int picture(void)
{
    EtdSettings settings;
    static unsigned char image[3 * PIXELS];
    if (open(cornell, cornell_end) != ETD_OK) {
        return 0;
    }
    etd_settings_default(&settings);
    settings.estimator = ETD_BIDIRECTIONAL;
    if (etd_scratch_init(scratch_memory, sizeof scratch_memory, 32, &scratch) != ETD_OK) {
        return 0;
    }
    size_t pixels = render(&settings, 16);
    if (pixels != PIXELS) {
        return 0;
    }
    put_text("cornell");
    put_hash(hash_of(rgb, 3 * pixels));
    put_text("\n");
    for (size_t i = 0; i < 3 * pixels; i++) {
        unsigned level = 0;
        while (level < 255 && (float)((level + 1) * (level + 1)) <= rgb[i] * 65025.0f) {
            level++;
        }
        image[i] = (unsigned char)level;
    }
    int file = create("cornell.ppm");
    return file >= 0 && put(file, "P6 64 64 255\n", 13) && put(file, image, sizeof image);
}

int run(void);
int run(void)
{
    if (etd_scratch_init(scratch_memory, sizeof scratch_memory, 8, &scratch) != ETD_OK) {
        return 1;
    }
    int ok = run_suite("matter", matter, matter_end) && run_suite("gloss", gloss, gloss_end) && run_suite("fog", fog, fog_end) &&
             run_suite("prism", prism, prism_end) && run_suite("round", round, round_end) && run_suite("open_air", open_air, open_air_end) &&
             run_suite("plan", plan, plan_end) && picture();
    return ok ? 0 : 1;
}
