/* Which estimator suits a scene: choose SCENE.etd
 *
 * A pilot of a few thousand pixels says of each how large its error is and what that costs, in rays; the product of both is to be least. Rays are
 * counted and times aren't, so that the choice is the same each time. Light that an estimator can't make has no error: `etendue inspect` names it. */
#include "etendue.h"
#include <stdio.h>
#include <stdlib.h>

enum { PIXELS = 1 << 11 };

int main(int argc, char **argv)
{
    static const struct {
        uint32_t estimator;
        const char *name;
    } candidates[] = {{ETD_PATH, "path"}, {ETD_LIGHT, "light"}, {ETD_BIDIRECTIONAL, "bidirectional"}};
    unsigned char *blob = malloc(1 << 20); /* malloc's alignment is enough */
    void *scene_memory = malloc(ETD_SCENE_SIZE), *scratch_memory = malloc(etd_scratch_size(32));
    const EtdScene *scene = NULL;
    EtdScratch *scratch = NULL;
    FILE *file = argc == 2 ? fopen(argv[1], "rb") : NULL;
    size_t size = file != NULL ? fread(blob, 1, 1 << 20, file) : 0, best = 0;
    double least = -1;
    if (file != NULL)
        fclose(file);

    EtdStatus status = etd_scene_open(ETD_ABI_VERSION, blob, size, scene_memory, ETD_SCENE_SIZE, &scene, NULL);
    etd_scratch_init(scratch_memory, etd_scratch_size(32), 32, &scratch);
    for (size_t i = 0; status == ETD_OK && i < sizeof candidates / sizeof *candidates; i++) {
        EtdPilot pilot = {.struct_size = sizeof pilot};
        EtdSettings settings;
        etd_settings_default(&settings);
        settings.estimator = candidates[i].estimator;
        status = etd_pilot(scene, &settings, NULL, scratch, 0, PIXELS, &pilot);
        if (status != ETD_OK)
            break;
        double mse = pilot.squared_error / (double)pilot.samples, rays = (double)pilot.rays / (double)pilot.samples;
        printf("%s: error %.9e at %.9e rays a sample\n", candidates[i].name, mse, rays);
        if (pilot.bright && (least < 0 || mse * rays < least)) {
            least = mse * rays;
            best = i;
        }
    }
    if (status != ETD_OK)
        fprintf(stderr, "%s\n", etd_error_string(status));
    else
        printf("%s\n", candidates[best].name);
    free(blob), free(scene_memory), free(scratch_memory);
    return status == ETD_OK ? 0 : 1;
}
