// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/passes/shading.h"

#include <string>
#include <vector>

#include "core/material/model.h"

namespace verglas {
namespace {

// Texture units.
enum Unit : GLuint {
    front_unit,
    back_unit,
    map_unit,
    atlas_unit,
    tables_unit,
    normals_unit,
    depths_unit,
    shaded_unit,
    nearest_back_unit,
    farthest_front_unit,
    front_roughness_unit,
    back_classes_unit,
    coatings_unit,
    behind_radiance_unit,
    behind_depth_unit
};

void begin(const gl::Framebuffer& target, const View& view, const Rect& rect) {
    glBindFramebuffer(GL_FRAMEBUFFER, target.id());
    glViewport(0, 0, view.size.x, view.size.y);
    glEnable(GL_SCISSOR_TEST);
    glScissor(rect.begin.x, rect.begin.y, rect.size().x, rect.size().y);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
}

void set_texture(const gl::Program& program, const char* name, Unit unit, const gl::Texture& texture) {
    glBindTextureUnit(unit, texture.id());
    program.set(name, static_cast<int>(unit));
}

// The uniforms of shaders/environment.glsl.
void set_environment(const gl::Program& program, const ShadingInputs& inputs) {
    const FilteredEnvironment& environment = inputs.environment;
    set_texture(program, "environment_map", map_unit, environment.raw);
    set_texture(program, "environment_atlas", atlas_unit, environment.atlas);
    for (std::size_t l = 0; l < environment.levels.size(); ++l) {
        const EnvironmentLevel& level = environment.levels[l];
        program.set(("environment_levels[" + std::to_string(l) + "]").c_str(),
                    glm::vec4(level.columns, level.intervals, level.first_row,
                              model::spread_from_kappa(level.kappa)));
    }
    program.set("environment_level_count", static_cast<int>(environment.levels.size()));
    program.set("environment_color", inputs.scene.environment_color);
    program.set("view_to_environment",
                inputs.scene.environment_rotation * glm::transpose(glm::mat3(inputs.view.view)));
}

// Those of shaders/local_lights.glsl.
void set_lights(const gl::Program& program, const LightBuffer& lights) {
    program.set("light_count", lights.count());
    if (lights.count() > 0) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, lights.buffer().id());
}

void set_lobes(const gl::Program& program, const ShadingInputs& inputs, const MaterialCache& materials) {
    if (inputs.settings.lobes == Lobes::Table)
        set_texture(program, "lobe_tables", tables_unit, materials.lobe_tables());
}

void define_lobes(std::vector<std::string>& defines, Lobes lobes) {
    if (lobes == Lobes::Analytic) defines.emplace_back("ANALYTIC_LOBES");
}

// The uniforms of shaders/screen_space.glsl.
void set_screen_space(const gl::Program& program, const ShadingInputs& inputs) {
    set_texture(program, "front_faces", front_unit, inputs.front.texels());
    program.set("projection", inputs.view.projection);
    program.set("frame_size", glm::vec2(inputs.view.size));
}

}  // namespace

bool RefractionPass::needs_pyramid(const Settings& settings) {
    return settings.transport == Transport::Paper || settings.intersection == Intersection::March;
}

// The baselines are as they were published, with the farthest back faces alone.
bool RefractionPass::needs_layers(const Settings& settings) {
    return settings.transport == Transport::Bundle && settings.intersection == Intersection::Newton;
}

RoughnessData RefractionPass::back_data(const Settings& settings, int classes) {
    const bool has_classes =
        settings.transport != Transport::DepthMip && settings.transport != Transport::Specular;
    if (settings.back_roughness == BackRoughness::Simple || !has_classes || classes < 2)
        return RoughnessData::None;
    return classes > 4 ? RoughnessData::Classes8 : RoughnessData::Classes4;
}

bool RefractionPass::follows_reflections(const Settings& settings) {
    return settings.tir == Tir::Bounce && needs_layers(settings);
}

const gl::Program& RefractionPass::program(const Settings& settings, RoughnessData front, int classes) {
    const std::tuple key(settings.transport, settings.intersection, settings.lobes,
                         follows_reflections(settings), front, classes);
    const auto found = programs_.find(key);
    if (found != programs_.end()) return found->second;
    constexpr const char* transports[] = {"TRANSPORT_BUNDLE", "TRANSPORT_PAPER", "TRANSPORT_SINGLE",
                                          "TRANSPORT_DEPTH_MIP", "TRANSPORT_SPECULAR"};
    constexpr const char* intersections[] = {"INTERSECTION_NEWTON", "INTERSECTION_MARCH"};
    std::vector<std::string> defines = {transports[static_cast<int>(settings.transport)],
                                        intersections[static_cast<int>(settings.intersection)]};
    define_lobes(defines, settings.lobes);
    if (needs_layers(settings)) defines.emplace_back("LAYERS");
    if (front != RoughnessData::None) defines.emplace_back("FRONT_ROUGHNESS");
    if (classes > 0) {
        defines.push_back("CLASSES " + std::to_string(classes));
        defines.push_back("CLASS_LAYERS " + std::to_string(classes > 4 ? 2 : 1));
    }
    if (follows_reflections(settings)) defines.emplace_back("BOUNCE");
    return programs_.emplace(key, gl::Program("full_screen.vert.glsl", "refraction.frag.glsl", defines))
        .first->second;
}

Tir RefractionPass::tir_of_exits(const Settings& settings) {
    if (settings.tir != Tir::Bounce) return settings.tir;
    return follows_reflections(settings) ? Tir::None : Tir::Clamp;
}

void RefractionPass::draw(const ShadingInputs& inputs, const gl::Framebuffer& target,
                          const BackGeometry& back, const MaterialCache& materials, const ViewGroup& group,
                          int number) {
    const RoughnessData back_data = back.farthest.roughness_data();
    const int classes = back_data == RoughnessData::None ? 0 : inputs.classes;
    const gl::Program& shader = program(inputs.settings, inputs.front.roughness_data(), classes);
    shader.use();
    set_environment(shader, inputs);
    set_lights(shader, inputs.lights);
    set_screen_space(shader, inputs);
    set_texture(shader, "back_faces", back_unit, back.farthest.texels());
    set_lobes(shader, inputs, materials);
    if (back_data != RoughnessData::None)
        set_texture(shader, "back_classes", back_classes_unit, back.class_pyramid);
    if (inputs.front.roughness_data() != RoughnessData::None)
        set_texture(shader, "front_roughness", front_roughness_unit, inputs.front.roughness());
    if (back.inner != nullptr) {
        set_texture(shader, "nearest_back_faces", nearest_back_unit, back.inner->nearest_back.texels());
        set_texture(shader, "farthest_front_faces", farthest_front_unit, back.inner->farthest_front.texels());
    }
    if (back.pyramid != nullptr) {
        set_texture(shader, "pyramid_normals", normals_unit, back.pyramid->normals());
        set_texture(shader, "pyramid_depths", depths_unit, back.pyramid->depths());
    }
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, materials.buffer().id());
    shader.set("group", number);
    shader.set("tir", static_cast<int>(tir_of_exits(inputs.settings)));
    shader.set("reflection", inputs.settings.reflection ? 1 : 0);
    for (const ViewObject& item : group.objects) {
        if (!item.has(MaterialKind::Solid)) continue;
        begin(target, inputs.view, item.rect);
        shader.set("bound", item.diagonal);
        shader.set("object_rect", glm::vec4(item.rect.begin, item.rect.end));
        gl::draw_full_screen(empty_);
    }
}

void ThinLayerPass::draw(const ShadingInputs& inputs, const gl::Framebuffer& target,
                         const MaterialCache& materials, const BehindPass* behind, const ViewGroup& group,
                         int number) {
    for (const MaterialKind kind : {MaterialKind::Pane, MaterialKind::Coated}) {
        if (!group.has(kind)) continue;
        const bool has_behind = kind == MaterialKind::Pane && behind != nullptr;
        const gl::Program& shader = program(kind, inputs.settings.lobes, has_behind);
        shader.use();
        set_environment(shader, inputs);
        set_lights(shader, inputs.lights);
        set_screen_space(shader, inputs);
        if (kind == MaterialKind::Pane)
            set_lobes(shader, inputs, materials);
        else
            set_texture(shader, "coating_rows", coatings_unit, materials.coating_rows());
        if (has_behind) {
            set_texture(shader, "behind_radiance", behind_radiance_unit, behind->radiance());
            set_texture(shader, "behind_depth", behind_depth_unit, behind->depth());
        }
        set_texture(shader, "front_roughness", front_roughness_unit, inputs.front.roughness());
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, materials.buffer().id());
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, materials.layers().id());
        shader.set("group", number);
        shader.set("reflection", inputs.settings.reflection ? 1 : 0);
        for (const ViewObject& item : group.objects) {
            if (!item.has(kind)) continue;
            begin(target, inputs.view, item.rect);
            gl::draw_full_screen(empty_);
        }
    }
}

const gl::Program& ThinLayerPass::program(MaterialKind kind, Lobes lobes, bool has_behind) {
    const std::tuple key(kind, lobes, has_behind);
    const auto found = programs_.find(key);
    if (found != programs_.end()) return found->second;
    std::vector<std::string> defines = {kind == MaterialKind::Pane ? "PANE" : "COATED"};
    define_lobes(defines, lobes);
    if (has_behind) defines.emplace_back("BEHIND");
    return programs_.emplace(key, gl::Program("full_screen.vert.glsl", "thin_layers.frag.glsl", defines))
        .first->second;
}

BackgroundPass::BackgroundPass()
    : program_("full_screen.vert.glsl", "background.frag.glsl"), empty_(gl::make_vertex_array()) {}

void BackgroundPass::draw(const ShadingInputs& inputs, const gl::Framebuffer& target,
                          const gl::Texture& shaded, const Rect& region) const {
    program_.use();
    set_environment(program_, inputs);
    set_screen_space(program_, inputs);
    set_texture(program_, "shaded", shaded_unit, shaded);
    program_.set("background_alpha", inputs.settings.background_alpha);
    program_.set("background_spread", inputs.settings.background_spread);
    begin(target, inputs.view, region);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    gl::draw_full_screen(empty_);
    glDisable(GL_BLEND);
}

DataPass::DataPass()
    : program_("full_screen.vert.glsl", "data_passes.frag.glsl"), empty_(gl::make_vertex_array()) {}

void DataPass::draw(const ShadingInputs& inputs, const gl::Framebuffer& target, const Rect& region) const {
    program_.use();
    set_texture(program_, "front_faces", front_unit, inputs.front.texels());
    program_.set("view_to_world", glm::transpose(glm::mat3(inputs.view.view)));
    begin(target, inputs.view, region);
    gl::draw_full_screen(empty_);
}

}  // namespace verglas
