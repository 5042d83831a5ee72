// A sphere under a sky, from C++: errors become exceptions, handles are freed by destructors. The albedo of a white sphere is 1 and the sky's
// radiance 1, so every pixel is 1: a furnace.

#include <etendue_host.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <vector>

static void check(EtdStatus status)
{
    if (status != ETD_OK)
        throw std::runtime_error(etd_error_string(status));
}

struct FreeBuilder {
    void operator()(EtdBuilder *builder) const { etd_builder_free(builder); }
};

struct Blob : EtdBlob {
    Blob() : EtdBlob() { struct_size = sizeof(EtdBlob); }
    ~Blob() { etd_blob_free(this); }
    Blob(const Blob &) = delete;
    Blob &operator=(const Blob &) = delete;
};

static std::vector<float> render(const Blob &blob)
{
    alignas(ETD_SCENE_ALIGN) unsigned char memory[ETD_SCENE_SIZE];
    const EtdScene *scene = nullptr;
    check(etd_scene_open(ETD_ABI_VERSION, blob.data, blob.size, memory, sizeof memory, &scene, nullptr));
    EtdSceneInfo info = EtdSceneInfo();
    info.struct_size = sizeof info;
    check(etd_scene_inspect(scene, &info));
    EtdSettings settings = EtdSettings();
    check(etd_settings_default(&settings));
    EtdRender how = EtdRender();
    how.struct_size = sizeof how;
    how.samples = 64;
    std::vector<float> rgb(std::size_t(3) * info.width * info.height);
    check(etd_host_render(scene, &settings, &how, rgb.data(), rgb.size(), nullptr));
    return rgb;
}

int main()
try {
    EtdBuilder *made = nullptr;
    check(etd_builder_create(ETD_ABI_VERSION, nullptr, &made));
    const std::unique_ptr<EtdBuilder, FreeBuilder> builder(made);
    std::uint32_t id = 0;
    EtdMaterial white = EtdMaterial();
    check(etd_material_default(&white));
    check(etd_builder_add_material(builder.get(), &white, &id));
    EtdSphere sphere = EtdSphere();
    check(etd_sphere_default(&sphere));
    sphere.front = id;
    sphere.center[2] = 4;
    check(etd_builder_add_sphere(builder.get(), &sphere, &id));
    EtdLight sky = EtdLight();
    check(etd_light_default(&sky));
    check(etd_builder_add_light(builder.get(), &sky, &id));
    EtdCamera camera = EtdCamera();
    check(etd_camera_default(&camera));
    camera.width = camera.height = 16;
    check(etd_builder_set_camera(builder.get(), &camera));
    Blob blob;
    check(etd_builder_build(builder.get(), &blob, nullptr));
    double sum = 0;
    const std::vector<float> rgb = render(blob);
    for (float x : rgb)
        sum += x;
    const double mean = sum / double(rgb.size());
    std::printf("%.3f\n", mean);
    return std::fabs(mean - 1) < 0.01 ? 0 : 1;
} catch (const std::exception &e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
}
