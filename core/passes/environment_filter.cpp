// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/passes/environment_filter.h"

#include <utility>

#include "core/gl/debug.h"

namespace verglas {
namespace {

gl::Texture upload(GLenum format, int width, int height, GLenum filter,
                   const std::vector<glm::vec3>& pixels) {
    gl::Texture texture(format, width, height, filter);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTextureSubImage2D(texture.id(), 0, 0, 0, width, height, GL_RGB, GL_FLOAT, pixels.data());
    return texture;
}

gl::Texture upload_raw(const EnvironmentMap& map) {
    GLint greatest = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &greatest);
    const bool fits = map.width() <= greatest && map.height() <= greatest;
    gl::Texture texture =
        fits ? upload(GL_RGBA32F, map.width(), map.height(), GL_LINEAR, map.pixels())
             : upload(GL_RGBA32F, greatest, greatest / 2, GL_LINEAR, map.resampled(greatest));
    glTextureParameteri(texture.id(), GL_TEXTURE_WRAP_S, GL_REPEAT);
    return texture;
}

}  // namespace

EnvironmentFilter::EnvironmentFilter()
    : program_("full_screen.vert.glsl", "environment_filter.frag.glsl"), empty_(gl::make_vertex_array()) {}

FilteredEnvironment EnvironmentFilter::filter(std::shared_ptr<const EnvironmentMap> map) const {
    const gl::PassScope scope("environment");
    const EnvironmentPicture picture = make_source_picture(*map);
    const int columns = picture.columns;
    FilteredEnvironment result;
    result.raw = upload_raw(*map);
    result.levels = plan_levels(columns);
    const gl::Texture source_map = upload(GL_RGBA32F, columns, columns / 2, GL_NEAREST, picture.pixels);
    const EnvironmentLevel& last = result.levels.back();
    result.atlas = gl::Texture(GL_RGBA32F, columns + 1, last.first_row + last.intervals + 1, GL_LINEAR);

    std::vector<gl::Texture> lattices;
    lattices.reserve(result.levels.size());  // sources are referred to while more are added
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_SCISSOR_TEST);
    program_.use();
    for (int l = 0; l < static_cast<int>(result.levels.size()); ++l) {
        const EnvironmentLevel& level = result.levels[l];
        const glm::ivec2 size(level.columns, level.intervals);
        const EnvironmentSource source = plan_source(result.levels, l);
        const gl::Texture& source_texture = source.level == map_source ? source_map : lattices[source.level];
        gl::Texture& lattice = lattices.emplace_back(GL_RGBA32F, size.x + 1, size.y + 1, GL_NEAREST);
        const gl::Framebuffer framebuffer({{lattice}});
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
        glViewport(0, 0, size.x + 1, size.y + 1);
        const int band_count = static_cast<int>(source.bands.size());
        const gl::Texture bands(GL_RGBA32F, 2, band_count, GL_NEAREST);
        glTextureSubImage2D(bands.id(), 0, 0, 0, 2, band_count, GL_RGBA, GL_FLOAT, source.bands.data());
        glBindTextureUnit(0, source_texture.id());
        glBindTextureUnit(1, bands.id());
        program_.set("source", 0);
        program_.set("bands", 1);
        program_.set("source_columns", source.columns);
        program_.set("target_size", size);
        program_.set("kappa", source.kappa);
        program_.set("block_center", source.block_center);
        gl::draw_full_screen(empty_);
        glCopyImageSubData(lattice.id(), GL_TEXTURE_2D, 0, 0, 0, 0, result.atlas.id(), GL_TEXTURE_2D, 0, 0,
                           level.first_row, 0, size.x + 1, size.y + 1, 1);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    scope.check();
    result.map = std::move(map);
    return result;
}

}  // namespace verglas
