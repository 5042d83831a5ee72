/* A light-map baker: irradiance at the texels of a rectangle, by several threads, into a PFM image.
 *
 *   bake SCENE.etd OUT.pfm   bakes the floor of the Cornell box (host/scenes/cornell-box.xml)
 *
 * Each thread has a scratch of its own and takes rows from a counter. A texel's random numbers depend on its number alone, so
 * that any number of threads gives the same bits.
 */
#include "etendue.h"
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 32, HEIGHT = 32, THREADS = 4, SAMPLES = 64 };

/* corner + s·across + t·along, with s, t in [0, 1]. */
static const float corner[3] = {0, 0, 0}, across[3] = {550, 0, 0}, along[3] = {0, 0, 559}, normal[3] = {0, 1, 0};

typedef struct Bake {
    const EtdScene *scene;
    EtdSettings settings;
    atomic_int next_row;
    atomic_int status; /* the first failure */
    float texels[HEIGHT][WIDTH][3];
} Bake;

static void *work(void *argument)
{
    Bake *bake = argument;
    void *memory = malloc(etd_scratch_size(32));
    EtdScratch *scratch = NULL;
    EtdStatus status = etd_scratch_init(memory, etd_scratch_size(32), 32, &scratch);
    for (int row; status == ETD_OK && (row = atomic_fetch_add(&bake->next_row, 1)) < HEIGHT;) {
        float positions[WIDTH][3], normals[WIDTH][3];
        for (int column = 0; column < WIDTH; column++) {
            float s = ((float)column + 0.5f) / WIDTH, t = ((float)row + 0.5f) / HEIGHT;
            for (int axis = 0; axis < 3; axis++) {
                positions[column][axis] = corner[axis] + s * across[axis] + t * along[axis];
                normals[column][axis] = normal[axis];
            }
        }
        EtdSamples samples = {sizeof samples, SAMPLES, 0, (uint64_t)row * WIDTH};
        status = etd_estimate_irradiance(bake->scene, &bake->settings, NULL, scratch, positions[0], normals[0], WIDTH,
                                         &samples, bake->texels[row][0]);
    }
    if (status != ETD_OK) {
        int none = ETD_OK;
        atomic_compare_exchange_strong(&bake->status, &none, status);
    }
    free(memory);
    return NULL;
}

static unsigned char *read_file(const char *name, size_t *size)
{
    FILE *file = fopen(name, "rb");
    unsigned char *bytes = NULL;
    long length;
    if (file == NULL) {
        return NULL;
    }
    if (fseek(file, 0, SEEK_END) == 0 && (length = ftell(file)) > 0 && fseek(file, 0, SEEK_SET) == 0) {
        *size = (size_t)length;
        bytes = malloc(*size);
        if (bytes != NULL && fread(bytes, 1, *size, file) != *size) {
            free(bytes);
            bytes = NULL;
        }
    }
    fclose(file);
    return bytes;
}

static int write_pfm(const char *name, const Bake *bake)
{
    FILE *file = fopen(name, "wb");
    if (file == NULL) {
        return 0;
    }
    fprintf(file, "PF\n%d %d\n-1.0\n", WIDTH, HEIGHT);
    size_t written = fwrite(bake->texels, sizeof bake->texels, 1, file);
    return (fclose(file) == 0) & (written == 1);
}

int main(int argc, char **argv)
{
    static Bake bake;
    pthread_t threads[THREADS];
    size_t size = 0;
    if (argc != 3) {
        fprintf(stderr, "usage: bake SCENE.etd OUT.pfm\n");
        return 2;
    }
    unsigned char *blob = read_file(argv[1], &size);
    if (blob == NULL) {
        fprintf(stderr, "%s: can't be read\n", argv[1]);
        return 1;
    }
    void *memory = malloc(ETD_SCENE_SIZE);
    EtdBlobError where = {sizeof where, 0, 0, 0};
    EtdStatus status =
        etd_scene_open(ETD_ABI_VERSION, blob, size, memory, ETD_SCENE_SIZE, &bake.scene, &where);
    if (status != ETD_OK) {
        fprintf(stderr, "%s: %s: %s (section %u, record %u)\n", argv[1], etd_error_string(status),
                etd_rule_string(where.rule), (unsigned)where.section, (unsigned)where.index);
    } else {
        etd_settings_default(&bake.settings);
        bake.settings.estimator = ETD_BIDIRECTIONAL;
        int started = 0;
        while (started < THREADS && pthread_create(&threads[started], NULL, work, &bake) == 0) {
            started++;
        }
        if (started == 0) {
            work(&bake);
        }
        while (started > 0) {
            pthread_join(threads[--started], NULL);
        }
        status = atomic_load(&bake.status);
        if (status != ETD_OK) {
            fprintf(stderr, "%s\n", etd_error_string(status));
        } else if (!write_pfm(argv[2], &bake)) {
            fprintf(stderr, "%s: can't be written\n", argv[2]);
            status = -1;
        }
    }
    free(memory);
    free(blob);
    return status == ETD_OK ? 0 : 1;
}
