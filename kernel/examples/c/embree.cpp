// An engine that brings its own ray tracer: Embree answers for the scene's triangles, the library does the rest. Renders the
// same tile with Embree and with the library's own tree, from the same random numbers, and compares.
//
//   embree SCENE.etd
//
// Prints the mean of both images, the standard error of their difference and how many pixels differ by more than a percent (rays
// that graze an edge may be decided differently; everything else may not).
#include "etendue.h"
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <vector>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace {

void check(EtdStatus status)
{
    if (status != ETD_OK) {
        throw std::runtime_error(etd_error_string(status));
    }
}

// Embree's device and scene over the triangles of ours, and their numbers.
class Tracer {
public:
    explicit Tracer(const EtdScene *scene)
    {
        std::size_t count = 0, spheres = 0;
        check(etd_scene_triangles(scene, nullptr, nullptr, 0, &count));
        check(etd_scene_spheres(scene, nullptr, nullptr, 0, &spheres));
        if (spheres != 0) {
            throw std::runtime_error("this example hands triangles to Embree, and the scene has spheres");
        }
        RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto *vertices = static_cast<float *>(rtcSetNewGeometryBuffer(
            mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3 * count));
        auto *indices = static_cast<unsigned *>(rtcSetNewGeometryBuffer(
            mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), count));
        primitives.resize(count);
        check(etd_scene_triangles(scene, vertices, primitives.data(), count, &count));
        for (std::size_t i = 0; i < 3 * count; i++) {
            indices[i] = static_cast<unsigned>(i);
        }
        rtcCommitGeometry(mesh);
        rtcAttachGeometry(tree, mesh);
        rtcReleaseGeometry(mesh);
        rtcSetSceneFlags(tree, RTC_SCENE_FLAG_ROBUST);
        rtcCommitScene(tree);
    }
    ~Tracer()
    {
        rtcReleaseScene(tree);
        rtcReleaseDevice(device);
    }
    Tracer(const Tracer &) = delete;
    Tracer &operator=(const Tracer &) = delete;

    EtdHooks hooks()
    {
        EtdHooks hooks = EtdHooks();
        hooks.struct_size = sizeof hooks;
        hooks.user = this;
        hooks.closest = closest;
        hooks.occluded = occluded;
        return hooks;
    }

private:
    // Embree's interval includes its ends, ours doesn't.
    static RTCRay convert(const EtdRay &ray)
    {
        RTCRay r = RTCRay();
        r.org_x = ray.origin[0];
        r.org_y = ray.origin[1];
        r.org_z = ray.origin[2];
        r.dir_x = ray.direction[0];
        r.dir_y = ray.direction[1];
        r.dir_z = ray.direction[2];
        r.tnear = std::nextafter(ray.t_min, ray.t_max);
        r.tfar = std::nextafter(ray.t_max, ray.t_min);
        r.mask = ~0u;
        return r;
    }

    static std::int32_t closest(void *user, const EtdRay *ray, EtdHit *hit)
    {
        const Tracer &self = *static_cast<Tracer *>(user);
        RTCRayHit query;
        query.ray = convert(*ray);
        query.hit = RTCHit();
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
        rtcIntersect1(self.tree, &query, nullptr);
#else
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(self.tree, &context, &query);
#endif
        if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
            return 0;
        }
        hit->primitive = self.primitives[query.hit.primID];
        hit->t = query.ray.tfar;
        hit->u = query.hit.u;
        hit->v = query.hit.v;
        return 1;
    }

    static std::int32_t occluded(void *user, const EtdRay *ray)
    {
        const Tracer &self = *static_cast<Tracer *>(user);
        RTCRay query = convert(*ray);
#if RTC_VERSION_MAJOR >= 4
        rtcOccluded1(self.tree, &query, nullptr);
#else
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcOccluded1(self.tree, &context, &query);
#endif
        return query.tfar < 0;
    }

    RTCDevice device = rtcNewDevice(nullptr);
    RTCScene tree = rtcNewScene(device);
    std::vector<std::uint32_t> primitives;
};

std::vector<char> read(const char *name)
{
    std::ifstream file(name, std::ios::binary);
    if (!file) {
        throw std::runtime_error(std::string(name) + ": can't be read");
    }
    return std::vector<char>(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
}

int compare(const char *name)
{
    std::vector<char> blob = read(name);
    alignas(ETD_SCENE_ALIGN) unsigned char memory[ETD_SCENE_SIZE];
    const EtdScene *scene = nullptr;
    check(etd_scene_open(ETD_ABI_VERSION, reinterpret_cast<unsigned char *>(blob.data()), blob.size(), memory,
                         sizeof memory, &scene, nullptr));
    EtdSceneInfo info = EtdSceneInfo();
    info.struct_size = sizeof info;
    check(etd_scene_inspect(scene, &info));
    std::vector<std::max_align_t> scratch_memory(etd_scratch_size(32) / sizeof(std::max_align_t) + 1);
    EtdScratch *scratch = nullptr;
    check(etd_scratch_init(scratch_memory.data(), scratch_memory.size() * sizeof(std::max_align_t), 32, &scratch));
    EtdSettings settings;
    check(etd_settings_default(&settings));

    Tracer tracer(scene);
    const EtdHooks embree = tracer.hooks();
    const EtdTile tile = {sizeof tile, 0, 0, info.width, info.height, 16, 0};
    const std::size_t floats = std::size_t(3) * info.width * info.height;
    std::vector<float> ours(floats), theirs(floats);
    check(etd_render_tile(scene, &settings, nullptr, scratch, &tile, ours.data(), floats));
    check(etd_render_tile(scene, &settings, &embree, scratch, &tile, theirs.data(), floats));

    double sum_ours = 0, sum_theirs = 0, squares = 0;
    std::size_t different = 0;
    for (std::size_t i = 0; i < floats; i++) {
        const double difference = double(theirs[i]) - ours[i];
        sum_ours += ours[i];
        sum_theirs += theirs[i];
        squares += difference * difference;
        different += std::abs(difference) > 0.01 * ours[i] + 1e-6;
    }
    std::printf("%.9g %.9g %.3g %.6f\n", sum_ours / double(floats), sum_theirs / double(floats),
                std::sqrt(squares) / double(floats), double(different) / double(floats));
    return 0;
}

} // namespace

int main(int argc, char **argv)
{
    if (argc != 2) {
        std::fprintf(stderr, "usage: embree SCENE.etd\n");
        return 2;
    }
    try {
        return compare(argv[1]);
    } catch (const std::exception &e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
