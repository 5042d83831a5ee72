/* How much light falls on a point: hello_irradiance SCENE.etd x y z nx ny nz */
#include "etendue.h"
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv)
{
    float v[6] = {0}, irradiance[3] = {0};
    unsigned char *blob = malloc(1 << 20); /* malloc's alignment is enough */
    void *scene_memory = malloc(ETD_SCENE_SIZE), *scratch_memory = malloc(etd_scratch_size(8));
    const EtdScene *scene = NULL;
    EtdScratch *scratch = NULL;
    EtdSettings settings;
    EtdSamples samples = {sizeof samples, 4096, 0, 0};
    FILE *file = argc == 8 ? fopen(argv[1], "rb") : NULL;
    size_t size = file != NULL ? fread(blob, 1, 1 << 20, file) : 0;
    for (int i = 2; i < argc && i < 8; i++)
        v[i - 2] = strtof(argv[i], NULL);

    EtdStatus status = etd_scene_open(ETD_ABI_VERSION, blob, size, scene_memory, ETD_SCENE_SIZE, &scene, NULL);
    etd_scratch_init(scratch_memory, etd_scratch_size(8), 8, &scratch);
    etd_settings_default(&settings);
    if (status == ETD_OK)
        status = etd_estimate_irradiance(scene, &settings, NULL, scratch, v, v + 3, 1, &samples, irradiance);
    if (status == ETD_OK)
        printf("%g %g %g W/m2\n", irradiance[0], irradiance[1], irradiance[2]);
    else
        fprintf(stderr, "%s\n", etd_error_string(status));
    return file == NULL || fclose(file) != 0 || (free(blob), free(scene_memory), free(scratch_memory), status != ETD_OK);
}
