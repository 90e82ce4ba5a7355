// SPDX-License-Identifier: GPL-3.0-or-later
// The passes over the whole frame: refraction, background and data passes.
#pragma once

#include <map>
#include <tuple>

#include "core/gl/objects.h"
#include "core/gl/program.h"
#include "core/passes/behind.h"
#include "core/passes/geometry.h"
#include "core/passes/gpu_scene.h"
#include "core/passes/pyramid.h"
#include "core/passes/view.h"

namespace verglas {

// What the shading passes read.
struct ShadingInputs {
    const View& view;
    const Scene& scene;
    const Settings& settings;
    const FilteredEnvironment& environment;
    const GeometryBuffer& front;
    int classes;  // of roughness that varies
    const LightBuffer& lights;
};

// Layers between the nearest front and the farthest back faces, where an object lies before itself.
struct InnerLayers {
    // class_pyramid: whose second buffer the nearest backs are.
    InnerLayers(glm::ivec2 size, RoughnessData of_back, const gl::Texture& class_pyramid)
        : nearest_back(size, of_back, class_pyramid, 1), farthest_front(size) {}

    GeometryBuffer nearest_back;
    GeometryBuffer farthest_front;
};

// What lies behind the front faces of a group.
struct BackGeometry {
    const GeometryBuffer& farthest;
    const gl::Texture& class_pyramid;  // of the farthest and the nearest
    const InnerLayers* inner;          // may be null where it isn't needed
    const PyramidPass* pyramid;        // likewise
};

// Shades the front faces of a group from its front and back faces (de Rousiers et al. 2012, third pass), once
// for each covered pixel.
class RefractionPass {
  public:
    RefractionPass() : empty_(gl::make_vertex_array()) {}
    // Whether the settings need the pyramid over the back faces.
    static bool needs_pyramid(const Settings& settings);
    // Whether they need the inner layers.
    static bool needs_layers(const Settings& settings);
    // What back faces have to hold of roughness that varies.
    static RoughnessData back_data(const Settings& settings, int classes);
    void draw(const ShadingInputs& inputs, const gl::Framebuffer& target, const BackGeometry& back,
              const MaterialCache& materials, const ViewGroup& group, int number);

  private:
    // Whether Tir::Bounce is wanted and there is what it needs: a bundle, and layers to follow its rays in.
    static bool follows_reflections(const Settings& settings);
    // What becomes of rays at their exits: without what bounces need, they are clamped.
    static Tir tir_of_exits(const Settings& settings);
    // classes: of the back; 0 where one roughness stands for all of it.
    const gl::Program& program(const Settings& settings, RoughnessData front, int classes);

    std::map<std::tuple<Transport, Intersection, Lobes, bool, RoughnessData, int>, gl::Program> programs_;
    gl::VertexArray empty_;
};

// Shades the front faces of a group that are thin layers: panes and coated surfaces.
class ThinLayerPass {
  public:
    ThinLayerPass() : empty_(gl::make_vertex_array()) {}
    // behind: what panes show; may be null.
    void draw(const ShadingInputs& inputs, const gl::Framebuffer& target, const MaterialCache& materials,
              const BehindPass* behind, const ViewGroup& group, int number);

  private:
    const gl::Program& program(MaterialKind kind, Lobes lobes, bool has_behind);

    // Each from when it is needed first.
    std::map<std::tuple<MaterialKind, Lobes, bool>, gl::Program> programs_;
    gl::VertexArray empty_;
};

// Completes a sample with the environment where nothing is, and adds it to the frame.
class BackgroundPass {
  public:
    BackgroundPass();
    void draw(const ShadingInputs& inputs, const gl::Framebuffer& target, const gl::Texture& shaded,
              const Rect& region) const;

  private:
    gl::Program program_;
    gl::VertexArray empty_;
};

// Normals in world space (RGB) and depth (A).
class DataPass {
  public:
    DataPass();
    void draw(const ShadingInputs& inputs, const gl::Framebuffer& target, const Rect& region) const;

  private:
    gl::Program program_;
    gl::VertexArray empty_;
};

}  // namespace verglas
