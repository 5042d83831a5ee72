/* A Cornell box from C arrays, rendered on all cores and through a job callback, then with a box moved.
 *
 *   cc -std=c99 build_scene.c $(pkg-config --cflags --libs etendue_host) -o build_scene
 *   ./build_scene cornell.ppm 64
 *
 * Prints a hash of each image: the same on every machine. */

#define _POSIX_C_SOURCE 200809L

#include <etendue_host.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 128, FLOATS = 3 * SIZE * SIZE };

static void check(EtdStatus status, const char *what, const EtdBuilder *builder)
{
    char message[256] = "";
    if (status == ETD_OK)
        return;
    if (builder)
        etd_builder_message(builder, message, sizeof message);
    fprintf(stderr, "%s: %s (%d) %s\n", what, etd_error_string(status), (int)status, message);
    exit(1);
}

/* The library's words, and its blobs' memory: hooks. */

static void say(void *user, uint32_t severity, const char *message)
{
    (void)user;
    if (severity <= ETD_LOG_WARNING)
        fprintf(stderr, "%s\n", message);
}

static void *take(void *user, size_t size, size_t alignment)
{
    void *memory = NULL;
    if (posix_memalign(&memory, alignment, size) != 0)
        return NULL;
    ++*(int *)user;
    return memory;
}

static void give(void *user, void *memory, size_t size, size_t alignment)
{
    (void)size;
    (void)alignment;
    --*(int *)user;
    free(memory);
}

/* Threads of our own: each takes the next job until there are none. */

enum { THREADS = 3 };

typedef struct {
    pthread_mutex_t lock;
    uint32_t next, jobs;
    void (*job)(void *context, uint32_t index);
    void *context;
} Queue;

static void *work(void *argument)
{
    Queue *queue = argument;
    for (;;) {
        uint32_t index;
        pthread_mutex_lock(&queue->lock);
        index = queue->next++;
        pthread_mutex_unlock(&queue->lock);
        if (index >= queue->jobs)
            return NULL;
        queue->job(queue->context, index);
    }
}

static void run(void *user, uint32_t jobs, void (*job)(void *context, uint32_t index), void *context)
{
    pthread_t threads[THREADS];
    int started = 0, i;
    Queue queue;
    (void)user;
    pthread_mutex_init(&queue.lock, NULL);
    queue.next = 0;
    queue.jobs = jobs;
    queue.job = job;
    queue.context = context;
    for (i = 0; i < THREADS; ++i)
        if (pthread_create(&threads[started], NULL, work, &queue) == 0)
            ++started;
    work(&queue); /* so that all is done even if there are no threads */
    for (i = 0; i < started; ++i)
        pthread_join(threads[i], NULL);
    pthread_mutex_destroy(&queue.lock);
}

static int32_t watch(void *user, uint64_t samples, double share)
{
    *(double *)user = share;
    (void)samples;
    return 0; /* go on */
}

/* The scene. */

static uint32_t material(EtdBuilder *builder, float r, float g, float b)
{
    EtdMaterial m;
    uint32_t id;
    etd_material_default(&m);
    m.color[0][0] = r;
    m.color[0][1] = g;
    m.color[0][2] = b;
    check(etd_builder_add_material(builder, &m, &id), "material", builder);
    return id;
}

/* Corners counter-clockwise, seen from the front. */
static uint32_t quad(EtdBuilder *builder, uint32_t material_id, const float corners[12], const float emission[3])
{
    static const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
    EtdMesh mesh;
    uint32_t id;
    etd_mesh_default(&mesh);
    mesh.vertices = 4;
    mesh.triangles = 2;
    mesh.positions = corners;
    mesh.indices = indices;
    mesh.front = mesh.back = material_id;
    if (emission)
        memcpy(mesh.emission, emission, sizeof mesh.emission);
    check(etd_builder_add_mesh(builder, &mesh, &id), "quad", builder);
    return id;
}

/* The unit cube. */
static uint32_t box(EtdBuilder *builder, uint32_t material_id)
{
    static const float positions[24] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1};
    static const uint32_t indices[36] = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                         3, 7, 6, 3, 6, 2, 0, 4, 7, 0, 7, 3, 1, 2, 6, 1, 6, 5};
    EtdMesh mesh;
    uint32_t id;
    etd_mesh_default(&mesh);
    mesh.vertices = 8;
    mesh.triangles = 12;
    mesh.positions = positions;
    mesh.indices = indices;
    mesh.front = mesh.back = material_id;
    check(etd_builder_add_mesh(builder, &mesh, &id), "box", builder);
    return id;
}

/* A box of width × height × width, its corner at (x, 0, z), turned by an angle whose cosine and sine are given. */
static void put(EtdBuilder *builder, uint32_t id, float width, float height, float x, float z, float c, float s)
{
    float m[12];
    m[0] = width * c, m[1] = 0, m[2] = width * s, m[3] = x;
    m[4] = 0, m[5] = height, m[6] = 0, m[7] = 0;
    m[8] = -width * s, m[9] = 0, m[10] = width * c, m[11] = z;
    check(etd_builder_set_transform(builder, id, m), "put", builder);
}

static void describe(EtdBuilder *builder, uint32_t boxes[2])
{
    static const float floor_[12] = {0, 0, 0, 0, 0, 560, 560, 0, 560, 560, 0, 0};
    static const float ceiling[12] = {0, 550, 0, 560, 550, 0, 560, 550, 560, 0, 550, 560};
    static const float back[12] = {0, 0, 560, 0, 550, 560, 560, 550, 560, 560, 0, 560};
    static const float right[12] = {0, 0, 0, 0, 550, 0, 0, 550, 560, 0, 0, 560};
    static const float left[12] = {560, 0, 0, 560, 0, 560, 560, 550, 560, 560, 550, 0};
    static const float lamp[12] = {213, 549, 227, 343, 549, 227, 343, 549, 332, 213, 549, 332};
    static const float radiance[3] = {17, 12, 4};
    const uint32_t white = material(builder, 0.725f, 0.71f, 0.68f);
    const uint32_t red = material(builder, 0.63f, 0.065f, 0.05f);
    const uint32_t green = material(builder, 0.14f, 0.45f, 0.091f);
    EtdCamera camera;
    quad(builder, white, floor_, NULL);
    quad(builder, white, ceiling, NULL);
    quad(builder, white, back, NULL);
    quad(builder, green, right, NULL);
    quad(builder, red, left, NULL);
    quad(builder, white, lamp, radiance);
    boxes[0] = box(builder, white);
    boxes[1] = box(builder, white);
    put(builder, boxes[0], 165, 165, 82, 225, 0.96f, 0.28f);
    put(builder, boxes[1], 165, 330, 314, 245, 0.96f, -0.28f);
    etd_camera_default(&camera);
    camera.origin[0] = 278, camera.origin[1] = 273, camera.origin[2] = -800;
    camera.field = 0.686f;
    camera.width = camera.height = SIZE;
    check(etd_builder_set_camera(builder, &camera), "camera", builder);
}

/* Images. */

static void render(const EtdBlob *blob, uint32_t estimator, uint64_t samples, int ours, float *rgb)
{
    EtdBlobError where;
    void *memory = NULL;
    const EtdScene *scene;
    EtdSettings settings;
    EtdRender how;
    EtdRendered done;
    double share = 0;
    where.struct_size = sizeof where;
    if (posix_memalign(&memory, ETD_SCENE_ALIGN, ETD_SCENE_SIZE) != 0)
        exit(1);
    check(etd_scene_open(ETD_ABI_VERSION, blob->data, blob->size, memory, ETD_SCENE_SIZE, &scene, &where), "open", NULL);
    etd_settings_default(&settings);
    settings.estimator = estimator;
    memset(&how, 0, sizeof how);
    how.struct_size = sizeof how;
    how.samples = samples;
    how.user = &share;
    how.progress = watch;
    if (ours)
        how.run = run;
    done.struct_size = sizeof done;
    check(etd_host_render(scene, &settings, &how, rgb, FLOATS, &done), "render", NULL);
    if (done.samples != samples || share != 1 || done.rejected != 0) {
        fprintf(stderr, "render: %lu samples\n", (unsigned long)done.samples);
        exit(1);
    }
    free(memory); /* the handle is no more than that */
}

/* FNV-1a over the floats' bits. */
static uint64_t hash(const float *rgb)
{
    uint64_t h = 0xcbf29ce484222325u;
    uint32_t bits;
    int i, byte;
    for (i = 0; i < FLOATS; ++i) {
        memcpy(&bits, rgb + i, sizeof bits);
        for (byte = 0; byte < 4; ++byte)
            h = (h ^ (bits >> (8 * byte) & 255)) * 0x100000001b3u;
    }
    return h;
}

static void write_ppm(const char *path, const float *rgb)
{
    FILE *file = fopen(path, "wb");
    int i;
    if (!file) {
        perror(path);
        exit(1);
    }
    fprintf(file, "P6\n%d %d\n255\n", SIZE, SIZE);
    for (i = 0; i < FLOATS; ++i)
        fputc((int)(255 * powf(rgb[i] < 1 ? rgb[i] : 1, 1 / 2.2f) + 0.5f), file);
    fclose(file);
}

int main(int count, char **arguments)
{
    const char *path = count > 1 ? arguments[1] : "cornell.ppm";
    const uint64_t samples = count > 2 ? strtoull(arguments[2], NULL, 10) : 64;
    static float all_cores[FLOATS], jobs[FLOATS], moved[FLOATS];
    uint32_t boxes[2], estimator;
    int blobs = 0;
    EtdHost host;
    EtdBuilder *builder;
    EtdBlob blob, refitted;
    EtdBuilt built;

    memset(&host, 0, sizeof host);
    host.struct_size = sizeof host;
    host.user = &blobs;
    host.allocate = take;
    host.release = give;
    host.log = say;
    check(etd_builder_create(ETD_ABI_VERSION, &host, &builder), "create", NULL);
    describe(builder, boxes);
    blob.struct_size = refitted.struct_size = sizeof blob;
    built.struct_size = sizeof built;
    check(etd_builder_build(builder, &blob, &built), "build", builder);

    for (estimator = ETD_PATH; estimator <= ETD_BIDIRECTIONAL; ++estimator) {
        render(&blob, estimator, samples, 0, all_cores);
        render(&blob, estimator, samples, 1, jobs);
        if (memcmp(all_cores, jobs, sizeof jobs) != 0) {
            fprintf(stderr, "the image depends on who renders it\n");
            return 1;
        }
        printf("%016llx\n", (unsigned long long)hash(jobs));
    }

    /* The small box moves; the tree keeps its shape. */
    put(builder, boxes[0], 165, 165, 150, 100, 0.8f, 0.6f);
    check(etd_builder_refit(builder, &refitted, &built), "refit", builder);
    render(&refitted, ETD_BIDIRECTIONAL, samples, 0, moved);
    if (built.refitted != 1 || memcmp(moved, jobs, sizeof jobs) == 0) {
        fprintf(stderr, "the box didn't move\n");
        return 1;
    }
    printf("%016llx\n", (unsigned long long)hash(moved));
    write_ppm(path, moved);

    etd_builder_free(builder);
    etd_blob_free(&blob);
    etd_blob_free(&refitted);
    if (blobs != 0) {
        fprintf(stderr, "%d blobs were not given back\n", blobs);
        return 1;
    }
    return 0;
}
