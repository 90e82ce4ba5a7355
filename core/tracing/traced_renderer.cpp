// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/traced_renderer.h"

namespace verglas {

class TracedRenderer::Device {};

TracedRenderer::TracedRenderer() : device_(std::make_unique<Device>()) {}
TracedRenderer::~TracedRenderer() = default;

std::optional<Frame> TracedRenderer::render(const Scene&, const Settings& settings, const Progress&) {
    Frame frame;
    frame.size = rendered_rect(settings.size, settings.region).size();
    const std::size_t pixels = std::size_t(frame.size.x) * frame.size.y;
    frame.combined.assign(pixels, glm::vec4(0.0F));
    frame.normal_depth.assign(pixels, glm::vec4(0.0F, 0.0F, 0.0F, 1e10F));
    return frame;
}

}  // namespace verglas
