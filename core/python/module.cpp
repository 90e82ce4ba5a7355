// SPDX-License-Identifier: GPL-3.0-or-later
// Python bindings; verglas_core.pyi documents them.
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <glm/gtc/type_ptr.hpp>
#include <optional>
#include <tuple>
#include <utility>

#include "core/error.h"
#include "core/material/interface_lobe.h"
#include "core/renderer.h"
#include "core/tracing/path_tracer.h"
#include "core/tracing/ray_scene.h"
#include "core/tracing/traced_renderer.h"
#include "core/viewport_renderer.h"

namespace py = pybind11;

namespace verglas {
namespace {

template <typename T>
using Array = py::array_t<T, py::array::c_style | py::array::forcecast>;

// Rows of an (N, columns) array as vectors of another type.
template <typename Vector, typename T>
std::vector<Vector> rows_of(const Array<T>& array, int columns, const char* what) {
    if (array.ndim() != 2 || array.shape(1) != columns)
        throw Error(std::string(what) + " must have the shape (N, " + std::to_string(columns) + ").");
    const auto* first = reinterpret_cast<const Vector*>(array.data());
    return {first, first + array.shape(0)};
}

// None without an array.
template <typename Vector, typename T>
std::vector<Vector> rows_of(const std::optional<Array<T>>& array, int columns, const char* what) {
    return array ? rows_of<Vector>(*array, columns, what) : std::vector<Vector>();
}

// numpy's matrices are row-major, GLM's column-major.
template <typename Matrix>
Matrix matrix_of(const Array<float>& array) {
    constexpr int n = Matrix::length();
    if (array.ndim() != 2 || array.shape(0) != n || array.shape(1) != n)
        throw Error("A matrix must have the shape (" + std::to_string(n) + ", " + std::to_string(n) + ").");
    Matrix matrix;
    for (int row = 0; row < n; ++row) {
        for (int column = 0; column < n; ++column) matrix[column][row] = array.at(row, column);
    }
    return matrix;
}

template <typename Matrix>
Array<float> array_of(const Matrix& matrix) {
    constexpr int n = Matrix::length();
    Array<float> array({n, n});
    for (int row = 0; row < n; ++row) {
        for (int column = 0; column < n; ++column) array.mutable_at(row, column) = matrix[column][row];
    }
    return array;
}

using Rgb = std::array<float, 3>;
glm::vec3 vector_of(const Rgb& rgb) { return {rgb[0], rgb[1], rgb[2]}; }
Rgb rgb_of(const glm::vec3& v) { return {v.r, v.g, v.b}; }

// Names of an enumeration's values, in their order.
constexpr std::array<const char*, 3> material_kind_names = {"SOLID", "PANE", "COATED"};
constexpr std::array<const char*, 3> light_kind_names = {"SPHERE", "DISK", "SUN"};
constexpr std::array<const char*, 3> ndf_names = {"BECKMANN", "GGX", "BLINN_PHONG"};
constexpr std::array<const char*, 3> lobe_event_names = {"REFRACT", "REFRACT_WITHOUT_FRESNEL", "REFLECT"};
constexpr std::array<const char*, 3> extension_names = {"REPEAT", "EXTEND", "CLIP"};
constexpr std::array<const char*, 3> normal_space_names = {"TANGENT", "OBJECT", "WORLD"};
constexpr std::array<const char*, 2> interpolation_names = {"LINEAR", "CLOSEST"};
constexpr std::array<const char*, 5> transport_names = {"BUNDLE", "PAPER", "SINGLE", "DEPTH_MIP", "SPECULAR"};
constexpr std::array<const char*, 2> intersection_names = {"NEWTON", "MARCH"};
constexpr std::array<const char*, 2> lobes_names = {"TABLE", "ANALYTIC"};
constexpr std::array<const char*, 2> path_mode_names = {"TWO_INTERFACE", "FULL"};
constexpr std::array<const char*, 3> layer_model_names = {"RECURSIVE", "ENDF", "WEIDLICH_WILKIE"};
constexpr std::array<const char*, 2> back_roughness_names = {"SIMPLE", "COVERAGE"};
constexpr std::array<const char*, 4> tir_names = {"NONE", "INCIDENT", "CLAMP", "BOUNCE"};

template <typename Enum, std::size_t N>
Enum enum_of(const std::array<const char*, N>& names, const std::string& name) {
    std::string all;
    for (std::size_t i = 0; i < N; ++i) {
        if (name == names[i]) return static_cast<Enum>(i);
        all += std::string(i == 0 ? "" : ", ") + names[i];
    }
    throw Error("'" + name + "' is none of " + all + ".");
}

template <typename Class, typename Enum, std::size_t N>
void def_enum(py::class_<Class>& cls, const char* property, Enum Class::*member,
              const std::array<const char*, N>& names) {
    cls.def_property(
        property, [member, &names](const Class& self) { return names[static_cast<int>(self.*member)]; },
        [member, &names](Class& self, const std::string& name) {
            self.*member = enum_of<Enum>(names, name);
        });
}

template <typename Class>
void def_rgb(py::class_<Class>& cls, const char* property, glm::vec3 Class::*member) {
    cls.def_property(
        property, [member](const Class& self) { return rgb_of(self.*member); },
        [member](Class& self, const Rgb& rgb) { self.*member = vector_of(rgb); });
}

template <typename Class, typename Matrix>
void def_matrix(py::class_<Class>& cls, const char* property, Matrix Class::*member) {
    cls.def_property(
        property, [member](const Class& self) { return array_of(self.*member); },
        [member](Class& self, const Array<float>& array) { self.*member = matrix_of<Matrix>(array); });
}

std::shared_ptr<Mesh> make_mesh(const std::string& name, const Array<float>& positions,
                                const Array<float>& normals, const Array<std::uint32_t>& triangles,
                                const std::optional<Array<std::uint16_t>>& slots,
                                const std::optional<Array<float>>& uvs,
                                const std::optional<Array<float>>& normal_uvs,
                                const std::optional<Array<float>>& tangents,
                                const std::optional<Array<float>>& height_uvs) {
    auto p = rows_of<glm::vec3>(positions, 3, "positions");
    auto n = rows_of<glm::vec3>(normals, 3, "normals");
    const auto t = rows_of<glm::uvec3>(triangles, 3, "triangles");
    std::vector<std::uint16_t> s;
    if (slots) s.assign(slots->data(), slots->data() + slots->size());
    auto uv = rows_of<glm::vec2>(uvs, 2, "uvs");
    ReliefCoordinates relief{rows_of<glm::vec2>(normal_uvs, 2, "normal_uvs"),
                             rows_of<glm::vec4>(tangents, 4, "tangents"),
                             rows_of<glm::vec2>(height_uvs, 2, "height_uvs")};
    const py::gil_scoped_release release;
    return std::make_shared<Mesh>(name, std::move(p), std::move(n), t, s, std::move(uv), std::move(relief));
}

// values: (H, W), and as many floats again as a Value has, unless that is one.
template <typename Value>
std::shared_ptr<TextureOf<Value>> make_texture(const std::string& name, const Array<float>& values,
                                               const std::string& extension, const std::string& interpolation,
                                               bool is_atlas) {
    constexpr py::ssize_t channels = sizeof(Value) / sizeof(float);
    const bool is_right =
        channels == 1 ? values.ndim() == 2 : values.ndim() == 3 && values.shape(2) == channels;
    if (!is_right)
        throw Error("Texture '" + name + "' must have the shape (H, W" +
                    (channels == 1 ? "" : ", " + std::to_string(channels)) + ").");
    const auto* first = reinterpret_cast<const Value*>(values.data());
    return std::make_shared<TextureOf<Value>>(
        name, static_cast<int>(values.shape(1)), static_cast<int>(values.shape(0)),
        std::vector<Value>(first, first + values.size() / channels),
        enum_of<Extension>(extension_names, extension),
        enum_of<Interpolation>(interpolation_names, interpolation), is_atlas);
}

template <typename Class, typename Value>
void def_texture(py::class_<Class>& cls, const char* property,
                 std::shared_ptr<const TextureOf<Value>> Class::*member) {
    cls.def_property(
        property,
        [member](const Class& self) { return std::const_pointer_cast<TextureOf<Value>>(self.*member); },
        [member](Class& self, std::shared_ptr<TextureOf<Value>> texture) {
            self.*member = std::move(texture);
        });
}

std::shared_ptr<EnvironmentMap> make_map(const std::string& name, const Array<float>& pixels) {
    if (pixels.ndim() != 3 || (pixels.shape(2) != 3 && pixels.shape(2) != 4))
        throw Error("The environment map '" + name + "' must have the shape (H, W, 3 or 4).");
    const py::ssize_t channels = pixels.shape(2);
    std::vector<glm::vec3> rgb(pixels.shape(0) * pixels.shape(1));
    for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] = glm::make_vec3(pixels.data() + i * channels);
    return std::make_shared<EnvironmentMap>(name, static_cast<int>(pixels.shape(1)),
                                            static_cast<int>(pixels.shape(0)), std::move(rgb));
}

void add_object(Scene& scene, const std::string& name, std::shared_ptr<Mesh> mesh, const Array<float>& matrix,
                const std::vector<int>& materials) {
    Object object{name, std::move(mesh), matrix_of<glm::mat4>(matrix), materials};
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) {
            if (!std::isfinite(object.matrix[column][row]))
                throw Error("Object '" + name + "' has a matrix with values that aren't finite numbers.");
        }
    }
    if (materials.empty()) throw Error("Object '" + name + "' has no material.");
    for (const int material : materials) {
        if (material < 0 || material >= static_cast<int>(scene.materials.size()))
            throw Error("Object '" + name + "' has a material that the scene doesn't know.");
    }
    scene.objects.push_back(std::move(object));
}

void add_light(Scene& scene, const std::string& name, const std::string& kind,
               const std::array<float, 3>& place, const std::array<float, 3>& intensity, float radius,
               const std::array<float, 3>& axis) {
    const auto vector = [](const std::array<float, 3>& values) { return glm::make_vec3(values.data()); };
    const Light light{name,          enum_of<LightKind>(light_kind_names, kind),
                      vector(place), radius,
                      vector(axis),  vector(intensity)};
    const auto is_finite = [](const glm::vec3& v) { return !glm::any(glm::isnan(v) || glm::isinf(v)); };
    if (!is_finite(light.place) || !is_finite(light.axis) || !is_finite(light.intensity) ||
        !std::isfinite(radius) || radius < 0.0F)
        throw Error("Light '" + name + "' has values that aren't finite numbers, or a radius below 0.");
    scene.lights.push_back(light);
}

// A view of part of the pixels, which keeps the frame alive: `count` channels from `first`, none for a plane.
py::array_t<float> channels(const py::object& self, const Unfilled<glm::vec4>& pixels, glm::ivec2 size,
                            int first, int count) {
    const auto step = static_cast<py::ssize_t>(sizeof(glm::vec4));
    const float* data = reinterpret_cast<const float*>(pixels.data()) + first;
    if (count == 1) return py::array_t<float>({size.y, size.x}, {step * size.x, step}, data, self);
    return py::array_t<float>({size.y, size.x, count}, {step * size.x, step, py::ssize_t{sizeof(float)}},
                              data, self);
}

// A beam on facets of vMF normals about n = +Z, as the functions of shaders/lib/spherical_warping.glsl take
// it.
struct BeamOnFacets {
    float kappa_o;
    float kappa_m;
    float cos_o;
    std::optional<float> eta;  // of a refraction; none reflects
    float cos_t;

    BeamOnFacets(float kappa_o_, float kappa_m_, float cos_theta_o, std::optional<float> eta_)
        : kappa_o(kappa_o_), kappa_m(kappa_m_), cos_o(cos_theta_o), eta(eta_) {
        if (!(kappa_o > 0.0F && kappa_m > 0.0F)) throw Error("A concentration must be greater than 0.");
        if (!(cos_o > 0.0F && cos_o <= 1.0F)) throw Error("A cosine must lie between 0 and 1.");
        const float index = eta.value_or(1.0F);
        if (!(index > 0.0F)) throw Error("A relative index of refraction must be greater than 0.");
        if (!(cos_o > model::critical_cosine(index))) throw Error("A beam must not be totally reflected.");
        cos_t = std::sqrt(1.0F - (1.0F - cos_o * cos_o) / (index * index));
    }

    model::Lobe warped() const {
        const glm::vec3 n(0.0F, 0.0F, 1.0F);
        const glm::vec3 d(-std::sqrt(1.0F - cos_o * cos_o), 0.0F, -cos_o);
        const model::Lobe beam{1.0F, model::spread_from_kappa(kappa_o), d};
        return eta ? model::refracted_beam(beam, *eta, kappa_m, n) : model::reflected_beam(beam, kappa_m, n);
    }

    float kappa_by_jacobians() const {
        return eta ? model::refracted_kappa(kappa_o, kappa_m, *eta, cos_o, cos_t)
                   : model::reflected_kappa(kappa_o, kappa_m, cos_o);
    }
};

void bind_material_model(py::module_& module) {
    module.def(
        "interface_lobe",
        [](const std::string& ndf, float roughness, float eta, float cos_theta_o, const std::string& event,
           const std::string& lobes) {
            const auto ndf_value = enum_of<Ndf>(ndf_names, ndf);
            const auto event_value = enum_of<LobeEvent>(lobe_event_names, event);
            const auto lobes_value = enum_of<Lobes>(lobes_names, lobes);
            const py::gil_scoped_release release;
            const model::Lobe lobe =
                interface_lobe(ndf_value, roughness, eta, cos_theta_o, event_value, lobes_value);
            const glm::vec3& p = lobe.direction;
            return std::tuple(lobe.energy, model::kappa_from_spread(lobe.spread), std::array{p.x, p.y, p.z});
        },
        py::arg("ndf"), py::arg("roughness"), py::arg("eta"), py::arg("cos_theta_o"), py::arg("event"),
        py::arg("lobes") = lobes_names[0]);
    module.def(
        "warped_beam",
        [](float kappa_o, float kappa_m, float cos_theta_o, std::optional<float> eta) {
            const model::Lobe lobe = BeamOnFacets(kappa_o, kappa_m, cos_theta_o, eta).warped();
            const glm::vec3& p = lobe.direction;
            return std::tuple(model::kappa_from_spread(lobe.spread), std::array{p.x, p.y, p.z});
        },
        py::arg("kappa_o"), py::arg("kappa_m"), py::arg("cos_theta_o"), py::arg("eta") = py::none());
    module.def(
        "kappa_by_jacobians",
        [](float kappa_o, float kappa_m, float cos_theta_o, std::optional<float> eta) {
            return BeamOnFacets(kappa_o, kappa_m, cos_theta_o, eta).kappa_by_jacobians();
        },
        py::arg("kappa_o"), py::arg("kappa_m"), py::arg("cos_theta_o"), py::arg("eta") = py::none());
    module.def(
        "vmf_facing_area",
        [](float kappa, float cos_theta_o) {
            if (!(kappa > 0.0F)) throw Error("A concentration must be greater than 0.");
            if (!(cos_theta_o >= 0.0F && cos_theta_o <= 1.0F))
                throw Error("A cosine must lie between 0 and 1.");
            return model::approximate_facing_area(kappa, cos_theta_o);
        },
        py::arg("kappa"), py::arg("cos_theta_o"));
}

void bind_scene(py::module_& module) {
    py::class_<Mesh, std::shared_ptr<Mesh>>(module, "Mesh")
        .def(py::init(&make_mesh), py::arg("name"), py::arg("positions"), py::arg("normals"),
             py::arg("triangles"), py::arg("slots") = py::none(), py::arg("uvs") = py::none(),
             py::arg("normal_uvs") = py::none(), py::arg("tangents") = py::none(),
             py::arg("height_uvs") = py::none())
        .def_property_readonly("name", &Mesh::name)
        .def_property_readonly("triangle_count", &Mesh::triangle_count)
        .def_property_readonly("has_tangents",
                               [](const Mesh& self) { return !self.relief().tangents.empty(); })
        .def_property_readonly("warnings", &Mesh::warnings);

    py::class_<VectorTexture, std::shared_ptr<VectorTexture>>(module, "VectorTexture")
        .def(py::init(&make_texture<glm::vec3>), py::arg("name"), py::arg("values"),
             py::arg("extension") = "REPEAT", py::arg("interpolation") = "LINEAR",
             py::arg("is_atlas") = false)
        .def_property_readonly("name", &VectorTexture::name);

    py::class_<Texture, std::shared_ptr<Texture>>(module, "Texture")
        .def(py::init(&make_texture<float>), py::arg("name"), py::arg("values"),
             py::arg("extension") = "REPEAT", py::arg("interpolation") = "LINEAR",
             py::arg("is_atlas") = false)
        .def(
            "sample",
            [](const Texture& self, const Array<float>& uvs) {
                const auto places = rows_of<glm::vec2>(uvs, 2, "uvs");
                py::array_t<float> values(static_cast<py::ssize_t>(places.size()));
                std::transform(places.begin(), places.end(), values.mutable_data(),
                               [&self](const glm::vec2& uv) { return self.sample(uv); });
                return values;
            },
            py::arg("uvs"))
        .def_property_readonly("name", &Texture::name)
        .def_property_readonly("width", &Texture::width)
        .def_property_readonly("height", &Texture::height);

    py::class_<NormalMap> normal_map(module, "NormalMap");
    normal_map.def_readwrite("steepness", &NormalMap::steepness)
        .def_readwrite("strength", &NormalMap::strength);
    def_texture(normal_map, "texture", &NormalMap::texture);
    def_enum(normal_map, "space", &NormalMap::space, normal_space_names);

    py::class_<BumpMap> bump_map(module, "BumpMap");
    bump_map.def_readwrite("strength", &BumpMap::strength).def_readwrite("distance", &BumpMap::distance);
    def_texture(bump_map, "height", &BumpMap::height);

    py::class_<Layer> layer(module, "Layer");
    layer.def_readwrite("roughness", &Layer::roughness)
        .def_readwrite("inner_reflections", &Layer::inner_reflections)
        .def_readwrite("thickness", &Layer::thickness)
        .def_readwrite("bounces", &Layer::bounces)
        .def_readwrite("diffuse", &Layer::diffuse);
    def_texture(layer, "roughness_texture", &Layer::roughness_texture);
    def_rgb(layer, "base_color", &Layer::base_color);
    def_rgb(layer, "edge_tint", &Layer::edge_tint);

    py::class_<Material> material(module, "Material");
    material.def(py::init([](const std::string& name) {
                     Material result;
                     result.name = name;
                     return result;
                 }),
                 py::arg("name") = "");
    material.def_readwrite("name", &Material::name)
        .def_readwrite("roughness", &Material::roughness)
        .def_readwrite("ior", &Material::ior)
        .def_readwrite("priority", &Material::priority)
        .def_readwrite("fresnel", &Material::fresnel)
        .def_property_readonly("layer", [](Material& self) { return &self.layer; })
        .def_property_readonly("normal_map", [](Material& self) { return &self.relief.normals; })
        .def_property_readonly("bump_map", [](Material& self) { return &self.relief.bump; });
    def_texture(material, "roughness_texture", &Material::roughness_texture);
    def_enum(material, "kind", &Material::kind, material_kind_names);
    def_enum(material, "ndf", &Material::ndf, ndf_names);
    def_rgb(material, "color", &Material::color);
    def_rgb(material, "reflection_color", &Material::reflection_color);
    def_rgb(material, "absorption", &Material::absorption);

    py::class_<EnvironmentMap, std::shared_ptr<EnvironmentMap>>(module, "EnvironmentMap")
        .def(py::init(&make_map), py::arg("name"), py::arg("pixels"))
        .def_static(
            "load",
            [](const std::string& path, bool srgb) {
                const py::gil_scoped_release release;
                return std::const_pointer_cast<EnvironmentMap>(EnvironmentMap::load(path, srgb));
            },
            py::arg("path"), py::arg("srgb") = false)
        .def_property_readonly("name", &EnvironmentMap::name)
        .def_property_readonly("width", &EnvironmentMap::width)
        .def_property_readonly("height", &EnvironmentMap::height)
        .def_property_readonly(
            "pixels",
            [](const py::object& self) {
                const auto& map = self.cast<const EnvironmentMap&>();
                return py::array_t<float>({map.height(), map.width(), 3}, &map.pixels().front().x, self);
            })
        .def_property_readonly("warnings", &EnvironmentMap::warnings);

    py::class_<Camera> camera(module, "Camera");
    camera.def(
        py::init([](const std::optional<Array<float>>& view, const std::optional<Array<float>>& projection) {
            Camera result;
            if (view) result.view = matrix_of<glm::mat4>(*view);
            if (projection) result.projection = matrix_of<glm::mat4>(*projection);
            return result;
        }),
        py::arg("view") = py::none(), py::arg("projection") = py::none());
    def_matrix(camera, "view", &Camera::view);
    def_matrix(camera, "projection", &Camera::projection);

    py::class_<Scene> scene(module, "Scene");
    scene.def(py::init<>())
        .def(
            "__eq__", [](const Scene& a, const Scene& b) { return a == b; }, py::is_operator())
        .def_readwrite("camera", &Scene::camera)
        .def_property(
            "environment_map",
            [](const Scene& self) { return std::const_pointer_cast<EnvironmentMap>(self.environment_map); },
            [](Scene& self, std::shared_ptr<EnvironmentMap> map) { self.environment_map = std::move(map); })
        .def("add_material",
             [](Scene& self, const Material& added) {
                 self.materials.push_back(added);
                 return static_cast<int>(self.materials.size()) - 1;
             })
        .def("add_light", &add_light, py::arg("name"), py::arg("kind"), py::arg("place"),
             py::arg("intensity"), py::arg("radius") = 0.0F,
             py::arg("axis") = std::array<float, 3>{0.0F, 0.0F, -1.0F})
        .def("add_object", &add_object, py::arg("name"), py::arg("mesh"), py::arg("matrix"),
             py::arg("materials"))
        .def_property_readonly("materials", [](const Scene& self) { return self.materials; })
        .def_property_readonly("triangle_count", [](const Scene& self) {
            std::size_t count = 0;
            for (const Object& object : self.objects) count += object.mesh->triangle_count();
            return count;
        });
    def_rgb(scene, "environment_color", &Scene::environment_color);
    def_matrix(scene, "environment_rotation", &Scene::environment_rotation);
}

// Any settings with a `size`.
template <typename Class>
void def_size(py::class_<Class>& cls) {
    cls.def_property(
           "width", [](const Class& self) { return self.size.x; },
           [](Class& self, int width) { self.size.x = width; })
        .def_property(
            "height", [](const Class& self) { return self.size.y; },
            [](Class& self, int height) { self.size.y = height; });
}

// Any settings with a `region`.
template <typename Class>
void def_region(py::class_<Class>& cls) {
    cls.def_property(
        "region",
        [](const Class& self) -> std::optional<std::array<int, 4>> {
            if (!self.region) return std::nullopt;
            const Rect& r = *self.region;
            return std::array<int, 4>{r.begin.x, r.begin.y, r.size().x, r.size().y};
        },
        [](Class& self, const std::optional<std::array<int, 4>>& region) {
            self.region.reset();
            if (!region) return;
            const auto [x, y, width, height] = *region;
            self.region = Rect{{x, y}, {x + width, y + height}};
        });
}

void bind_settings(py::module_& module) {
    py::class_<Settings> settings(module, "Settings");
    def_size(settings);
    def_region(settings);
    settings.def(py::init<>())
        .def(
            "__eq__", [](const Settings& a, const Settings& b) { return a == b; }, py::is_operator())
        .def_readwrite("samples", &Settings::samples)
        .def_readwrite("pixel_size", &Settings::pixel_size)
        .def_readwrite("filter_width", &Settings::filter_width)
        .def_readwrite("reflection", &Settings::reflection)
        .def_readwrite("background_alpha", &Settings::background_alpha)
        .def_readwrite("background_spread", &Settings::background_spread)
        .def_readwrite("roughness_classes", &Settings::roughness_classes)
        .def_readwrite("max_interfaces", &Settings::max_interfaces)
        .def_readwrite("threads", &Settings::threads);
    def_enum(settings, "transport", &Settings::transport, transport_names);
    def_enum(settings, "intersection", &Settings::intersection, intersection_names);
    def_enum(settings, "lobes", &Settings::lobes, lobes_names);
    def_enum(settings, "tir", &Settings::tir, tir_names);
    def_enum(settings, "back_roughness", &Settings::back_roughness, back_roughness_names);
    def_enum(settings, "paths", &Settings::paths, path_mode_names);
}

using PythonProgress = std::optional<std::function<bool(int, int)>>;

// The callback, which takes the GIL for itself; nothing where there is none.
Progress progress_of(const PythonProgress& progress) {
    if (!progress) return {};
    return [&progress](int done, int total) {
        const py::gil_scoped_acquire acquire;
        return (*progress)(done, total);
    };
}

// What rays meet first, as arrays by the name of Hit's members.
py::dict intersect(const RayScene& self, const Array<float>& origins, const Array<float>& directions) {
    const auto from = rows_of<glm::vec3>(origins, 3, "origins");
    const auto to = rows_of<glm::vec3>(directions, 3, "directions");
    if (from.size() != to.size()) throw Error("Rays need as many origins as directions.");
    const auto count = static_cast<py::ssize_t>(from.size());
    py::array_t<float> t(count);
    py::array_t<float> geometric_normal({count, py::ssize_t{3}});
    py::array_t<float> normal({count, py::ssize_t{3}});
    py::array_t<int> material(count);
    py::array_t<int> object(count);
    float* const ts = t.mutable_data();
    auto* const geometric_normals = reinterpret_cast<glm::vec3*>(geometric_normal.mutable_data());
    auto* const normals = reinterpret_cast<glm::vec3*>(normal.mutable_data());
    int* const materials = material.mutable_data();
    int* const objects = object.mutable_data();
    {
        const py::gil_scoped_release release;
        tbb::parallel_for(std::size_t{0}, from.size(), [&](std::size_t i) {
            const Hit hit = self.intersect(from[i], glm::normalize(to[i])).value_or(Hit::none());
            ts[i] = hit.t;
            geometric_normals[i] = hit.geometric_normal;
            normals[i] = hit.normal;
            materials[i] = hit.material;
            objects[i] = hit.object;
        });
    }
    py::dict hits;
    hits["t"] = t;
    hits["geometric_normal"] = geometric_normal;
    hits["normal"] = normal;
    hits["material"] = material;
    hits["object"] = object;
    return hits;
}

void bind_path_tracer(py::module_& module) {
    py::class_<RayScene>(module, "RayScene")
        .def(py::init<const Scene&>(), py::arg("scene"))
        .def("intersect", &intersect, py::arg("origins"), py::arg("directions"));

    py::class_<PathSettings> settings(module, "PathSettings");
    settings.def(py::init<>())
        .def_readwrite("filter_width", &PathSettings::filter_width)
        .def_readwrite("tir", &PathSettings::tir)
        .def_readwrite("transparent", &PathSettings::transparent)
        .def_readwrite("max_interfaces", &PathSettings::max_interfaces)
        .def_readwrite("seed", &PathSettings::seed);
    def_size(settings);
    def_region(settings);
    def_enum(settings, "mode", &PathSettings::mode, path_mode_names);
    def_enum(settings, "layers", &PathSettings::layers, layer_model_names);
    settings.def_readwrite("bounce", &PathSettings::bounce);

    py::class_<PathTracer>(module, "PathTracer")
        .def(py::init<Scene, const PathSettings&>(), py::arg("scene"), py::arg("settings"),
             py::call_guard<py::gil_scoped_release>())
        .def(
            "render",
            [](PathTracer& self, int samples, const PythonProgress& progress) {
                const py::gil_scoped_release release;
                return self.render(samples, progress_of(progress));
            },
            py::arg("samples"), py::arg("progress") = py::none())
        .def_property_readonly("samples", &PathTracer::samples)
        .def("frame", &PathTracer::frame, py::call_guard<py::gil_scoped_release>());
}

void bind_renderer(py::module_& module) {
    py::class_<Frame, std::shared_ptr<Frame>>(module, "Frame")
        .def_property_readonly("combined",
                               [](const py::object& self) {
                                   const auto& frame = self.cast<const Frame&>();
                                   return channels(self, frame.combined, frame.size, 0, 4);
                               })
        .def_property_readonly("depth",
                               [](const py::object& self) {
                                   const auto& frame = self.cast<const Frame&>();
                                   return channels(self, frame.normal_depth, frame.size, 3, 1);
                               })
        .def_property_readonly("normal",
                               [](const py::object& self) {
                                   const auto& frame = self.cast<const Frame&>();
                                   return channels(self, frame.normal_depth, frame.size, 0, 3);
                               })
        .def_readonly("seconds", &Frame::seconds)
        .def_readonly("pass_seconds", &Frame::pass_seconds)
        .def_readonly("prepare_seconds", &Frame::prepare_seconds);

    py::class_<TracedRenderer>(module, "TracedRenderer")
        .def(py::init<>())
        .def(
            "render",
            [](TracedRenderer& self, const Scene& scene, const Settings& settings,
               const PythonProgress& progress) {
                const py::gil_scoped_release release;
                return self.render(scene, settings, progress_of(progress));
            },
            py::arg("scene"), py::arg("settings"), py::arg("progress") = py::none());

    // The destructor waits for the GL thread, which needs no GIL.
    py::class_<Renderer>(module, "Renderer")
        .def(py::init<>(), py::call_guard<py::gil_scoped_release>())
        .def_property_readonly("device", &Renderer::device)
        .def(
            "render",
            [](Renderer& self, const Scene& scene, const Settings& settings, const PythonProgress& progress) {
                const py::gil_scoped_release release;
                return self.render(scene, settings, progress_of(progress));
            },
            py::arg("scene"), py::arg("settings"), py::arg("progress") = py::none());
}

void bind_viewport(py::module_& module) {
    py::class_<ViewportRenderer>(module, "ViewportRenderer")
        .def(py::init([](Renderer& device) {
                 return std::make_unique<ViewportRenderer>([&device] { return device.make_picture(); });
             }),
             py::arg("device"), py::keep_alive<1, 2>())
        .def(py::init([](TracedRenderer& device) {
                 return std::make_unique<ViewportRenderer>([&device] { return device.make_picture(); });
             }),
             py::arg("device"), py::keep_alive<1, 2>())
        .def("stop", &ViewportRenderer::stop, py::call_guard<py::gil_scoped_release>());

    using View = ViewportRenderer::View;
    py::class_<View>(module, "ViewportView")
        .def(py::init<const ViewportRenderer&>(), py::arg("renderer"))
        .def("show", &View::show, py::arg("scene"), py::arg("settings"), py::arg("seconds"))
        .def("take",
             [](View& self) -> std::optional<std::tuple<std::shared_ptr<Frame>, Settings>> {
                 const std::optional<Shown> shown = self.take();
                 if (!shown) return std::nullopt;
                 return std::tuple(std::const_pointer_cast<Frame>(shown->frame), shown->settings);
             })
        .def_property_readonly("has_news", &View::has_news)
        .def_property_readonly("is_done", &View::is_done)
        .def_property_readonly("fault", &View::fault);
}

}  // namespace
}  // namespace verglas

PYBIND11_MODULE(verglas_core, module) {
    module.doc() = "Verglas' render core.";
    module.attr("__version__") = VERGLAS_VERSION;
    py::register_exception<verglas::Error>(module, "Error", PyExc_RuntimeError);
    verglas::bind_material_model(module);
    verglas::bind_scene(module);
    verglas::bind_settings(module);
    verglas::bind_renderer(module);
    verglas::bind_path_tracer(module);
    verglas::bind_viewport(module);
}
