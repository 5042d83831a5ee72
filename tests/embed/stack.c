/* How much stack the library uses: a thread runs on memory that was painted before, and what it painted over is counted.
 * Prints "capacity estimator bytes" for each. What a thread uses that does nothing is taken off. */
#define _GNU_SOURCE
#include "etendue.h"
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STACK = 256 * 1024, PAINT = 0xa5 };

static unsigned char blob[1 << 20];
static EtdSum own[64 * 64], others[64 * 64];

typedef struct Work {
    const EtdScene *scene;
    EtdScratch *scratch;
    EtdSettings settings;
    EtdTile tile;
    EtdStatus status;
} Work;

static void *nothing(void *argument)
{
    return argument;
}

static void *render(void *argument)
{
    Work *work = argument;
    size_t pixels = (size_t)work->tile.width * work->tile.height;
    work->status = etd_render_film(work->scene, &work->settings, NULL, work->scratch, &work->tile, own, others, pixels);
    return NULL;
}

static size_t used(void *(*run)(void *), void *argument)
{
    unsigned char *stack = aligned_alloc(4096, STACK);
    size_t untouched = 0;
    pthread_attr_t attributes;
    pthread_t thread;
    memset(stack, PAINT, STACK);
    pthread_attr_init(&attributes);
    if (pthread_attr_setstack(&attributes, stack, STACK) != 0 ||
        pthread_create(&thread, &attributes, run, argument) != 0) {
        exit(2);
    }
    pthread_join(thread, NULL);
    pthread_attr_destroy(&attributes);
    while (untouched < STACK && stack[untouched] == PAINT) {
        untouched++;
    }
    free(stack);
    return STACK - untouched;
}

int main(int argc, char **argv)
{
    static const uint32_t capacities[] = {8, 32, 128};
    static const char *const names[] = {"path", "light", "bidirectional"};
    FILE *file = argc == 2 ? fopen(argv[1], "rb") : NULL;
    if (file == NULL) {
        return 2;
    }
    size_t size = fread(blob, 1, sizeof blob, file);
    fclose(file);
    void *memory = malloc(ETD_SCENE_SIZE);
    Work work = {0};
    EtdSceneInfo info = {.struct_size = sizeof info};
    if (etd_scene_open(ETD_ABI_VERSION, blob, size, memory, ETD_SCENE_SIZE, &work.scene, NULL) != ETD_OK ||
        etd_scene_inspect(work.scene, &info) != ETD_OK) {
        return 2;
    }
    size_t idle = used(nothing, NULL);
    for (size_t i = 0; i < 3; i++) {
        void *room = malloc(etd_scratch_size(capacities[i]));
        etd_scratch_init(room, etd_scratch_size(capacities[i]), capacities[i], &work.scratch);
        for (uint32_t estimator = 0; estimator < 3; estimator++) {
            etd_settings_default(&work.settings);
            work.settings.estimator = estimator;
            work.tile = (EtdTile){sizeof work.tile, 0, 0, info.width, info.height, 4, 0};
            size_t bytes = used(render, &work);
            if (work.status != ETD_OK) {
                return 1;
            }
            printf("%u %s %zu\n", (unsigned)capacities[i], names[estimator], bytes - idle);
        }
        free(room);
    }
    free(memory);
    return 0;
}
