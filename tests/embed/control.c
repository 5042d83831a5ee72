/* An engine with flush-to-zero, denormals-are-zero and another rounding: the same bits, and its control word as it was. */
#include "etendue.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xmmintrin.h>

enum { SIZE = 16 * 12 };

static unsigned char blob[1 << 20];

static EtdStatus render(const EtdScene *scene, EtdScratch *scratch, uint32_t estimator, float image[3 * SIZE])
{
    static EtdSum own[SIZE], others[SIZE];
    static const EtdTile tile = {sizeof tile, 0, 0, 16, 12, 4, 0};
    EtdSettings settings;
    memset(own, 0, sizeof own);
    memset(others, 0, sizeof others);
    etd_settings_default(&settings);
    settings.estimator = estimator;
    EtdStatus status = etd_render_film(scene, &settings, NULL, scratch, &tile, own, others, SIZE);
    return status != ETD_OK ? status : etd_film_resolve(scene, own, others, SIZE, 4, image);
}

int main(int argc, char **argv)
{
    static float expected[3 * SIZE], found[3 * SIZE];
    FILE *file = argc == 2 ? fopen(argv[1], "rb") : NULL;
    if (file == NULL) {
        return 2;
    }
    size_t size = fread(blob, 1, sizeof blob, file);
    fclose(file);
    void *memory = malloc(ETD_SCENE_SIZE), *room = malloc(etd_scratch_size(8));
    const EtdScene *scene;
    EtdScratch *scratch;
    if (etd_scene_open(ETD_ABI_VERSION, blob, size, memory, ETD_SCENE_SIZE, &scene, NULL) != ETD_OK ||
        etd_scratch_init(room, etd_scratch_size(8), 8, &scratch) != ETD_OK) {
        return 2;
    }
    /* Flush to zero, denormals are zero; rounding down, up, to zero; and exceptions that trap. */
    static const unsigned words[] = {0x1f80 | 0x8040, 0x1f80 | 0x2000, 0x1f80 | 0x4000, 0x1f80 | 0xe040, 0x8040};
    int failures = 0;
    for (uint32_t estimator = ETD_PATH; estimator <= ETD_BIDIRECTIONAL; estimator++) {
        failures += render(scene, scratch, estimator, expected) != ETD_OK;
        for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
            unsigned before = _mm_getcsr();
            _mm_setcsr(words[i]);
            EtdStatus status = render(scene, scratch, estimator, found);
            unsigned after = _mm_getcsr();
            _mm_setcsr(before);
            if (status != ETD_OK || after != words[i] || memcmp(expected, found, sizeof found) != 0) {
                printf("estimator %u, control word %#x: status %d, afterwards %#x, bits %s\n", (unsigned)estimator,
                       words[i], (int)status, after, memcmp(expected, found, sizeof found) == 0 ? "equal" : "differ");
                failures++;
            }
        }
    }
    free(room);
    free(memory);
    return failures != 0;
}
