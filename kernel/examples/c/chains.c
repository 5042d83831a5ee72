/* Metropolis light transport: chains SCENE.etd OUT.pfm
 *
 * Samples drawn independently give what is easily found, up to half the image's mean for each contribution; they say how much there is beyond, and
 * where chains start, which give that. They depend on their numbers alone, so that threads could share them out in any way. */
#include "etendue.h"
#include <stdio.h>
#include <stdlib.h>

enum { SAMPLES = 1 << 14, CHAINS = 64, STEPS = 1024 };

typedef struct Film {
    uint32_t width, height;
    float *sums;
} Film;

static void splat(void *user, uint32_t x, uint32_t y, const float *rgb)
{
    Film *film = user;
    for (int c = 0; c < 3; c++)
        film->sums[3 * ((size_t)y * film->width + x) + (size_t)c] += rgb[c];
}

/* Stratified: start number `i` of CHAINS, in proportion to the estimates. */
static uint64_t draw(const float *estimates, double sum, int i)
{
    double place = (i + 0.5) / CHAINS * sum;
    uint64_t sample = 0;
    while (sample + 1 < SAMPLES && (place -= estimates[sample]) >= 0)
        sample++;
    return sample;
}

static EtdStatus render(const EtdScene *scene, EtdScratch *scratch, Film *film, float *estimates, void *memory)
{
    EtdHooks hooks = {sizeof hooks, 0, film, splat, NULL, NULL, NULL, NULL};
    EtdSettings settings;
    double mean = 0, sum = 0, kept = 0;
    etd_settings_default(&settings);
    settings.estimator = ETD_METROPOLIS;
    EtdStatus status = etd_chain_bootstrap(scene, &settings, NULL, scratch, 0, SAMPLES, estimates);
    for (int i = 0; status == ETD_OK && i < SAMPLES; i++)
        mean += estimates[i] / SAMPLES;
    settings.above = (float)(mean / 2);
    if (status == ETD_OK)
        status = etd_chain_bootstrap(scene, &settings, &hooks, scratch, 0, SAMPLES, estimates);
    for (int i = 0; status == ETD_OK && i < SAMPLES; i++)
        sum += estimates[i];
    for (int i = 0; status == ETD_OK && i < CHAINS; i++) {
        EtdChain *chain = NULL;
        float share = 0;
        status = etd_chain_start(scene, &settings, scratch, (uint64_t)i, draw(estimates, sum, i), memory,
                                 etd_chain_size(), &chain);
        if (status == ETD_OK)
            status = etd_chain_advance(scene, &settings, &hooks, scratch, chain, (float)(sum / ((double)CHAINS * STEPS)), STEPS);
        if (status == ETD_OK)
            status = etd_chain_accepted(chain, &share);
        kept += share;
    }
    for (size_t i = 0; i < 3 * (size_t)film->width * film->height; i++)
        film->sums[i] *= (float)film->width * (float)film->height / SAMPLES;
    if (status == ETD_OK)
        printf("mean %g W/(m2 sr), %.0f %% by chains, %.0f %% of small steps accepted\n", mean, 100 * sum / SAMPLES / mean,
               100 * kept / CHAINS);
    return status;
}

int main(int argc, char **argv)
{
    unsigned char *blob = malloc(1 << 20); /* malloc's alignment is enough */
    void *scene_memory = malloc(ETD_SCENE_SIZE), *scratch_memory = malloc(etd_scratch_size(32));
    void *chain_memory = malloc(etd_chain_size());
    float *estimates = malloc(SAMPLES * sizeof *estimates);
    const EtdScene *scene = NULL;
    EtdScratch *scratch = NULL;
    EtdSceneInfo info = {.struct_size = sizeof info};
    Film film = {0, 0, NULL};
    FILE *file = argc == 3 ? fopen(argv[1], "rb") : NULL;
    size_t size = file != NULL ? fread(blob, 1, 1 << 20, file) : 0, written = 0;
    if (file != NULL)
        fclose(file);

    EtdStatus status = etd_scene_open(ETD_ABI_VERSION, blob, size, scene_memory, ETD_SCENE_SIZE, &scene, NULL);
    etd_scratch_init(scratch_memory, etd_scratch_size(32), 32, &scratch);
    if (status == ETD_OK)
        status = etd_scene_inspect(scene, &info);
    if (status == ETD_OK) {
        film = (Film){info.width, info.height, calloc((size_t)info.width * info.height, 3 * sizeof(float))};
        status = render(scene, scratch, &film, estimates, chain_memory);
    }
    if (status != ETD_OK)
        fprintf(stderr, "%s\n", etd_error_string(status));
    else if ((file = fopen(argv[2], "wb")) != NULL) {
        fprintf(file, "PF\n%u %u\n-1.0\n", (unsigned)film.width, (unsigned)film.height);
        /* A PFM begins at the bottom. */
        for (uint32_t y = film.height; y-- > 0;)
            written += fwrite(film.sums + 3 * (size_t)y * film.width, 3 * sizeof(float), film.width, file);
        written = fclose(file) == 0 ? written : 0;
    }
    free(blob), free(scene_memory), free(scratch_memory), free(chain_memory), free(estimates), free(film.sums);
    return status == ETD_OK && written == (size_t)film.width * film.height ? 0 : 1;
}
