// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "core/tracing/ray_scene.h"

namespace verglas {

// The solids that a ray is in, and what follows from them at a surface. Small, to be copied with each ray;
// new, it is outside of everything.
//
// Material::priority says how a solid goes together with others. 0: its surface stands by itself, with the
// material's own index whatever is around it, and its absorption adds to that of the others; as in Cycles.
// From 1 on, dielectrics are nested (Schmidt and Budge 2002): where solids overlap, the one of highest
// priority counts, of equal ones the one entered last, and the others are as if they weren't there; indices
// are then those of the media themselves, 1 outside of all.
//
// Four solids are remembered, and the oldest is forgotten for a fifth. A solid that is left without having
// been entered (the ray began in it, or its mesh is open) counts as one that was there before all others.
class MediumStack {
  public:
    // A surface as light sees it that reaches it through these media.
    struct Interface {
        bool is_real = false;  // false where the same medium counts on both sides: there is nothing to see
        float eta = 1.0F;      // n_behind / n_before, 1 / max_eta … max_eta; 1 where not real

        // Whether light is refracted and reflected; else all of it goes straight on, whatever the roughness,
        // tinted by the material's color where is_real.
        bool bends() const { return eta != 1.0F; }
    };
    // entering: the ray comes from the side that the triangle's normal shows to.
    Interface interface(const Scene& scene, const Hit& hit, bool entering) const;

    // The share of light that is left along the ray's last segment, which ends at the hit: exp(-sigma_a t)
    // (Beer-Lambert). For a ray that escapes there is none to ask for.
    glm::vec3 transmittance(const Scene& scene, const Hit& hit, bool entering) const;

    // Follows a ray that goes through the surface, refracted or straight; one that is reflected changes
    // nothing.
    void cross(const Hit& hit, bool entering);

  private:
    static constexpr int capacity = 4;
    static constexpr int none = -1;

    int find(const Hit& hit) const;
    void enter(const Hit& hit);
    void leave(const Hit& hit);
    MediumStack with(const Hit& hit) const;
    int counted(const Scene& scene) const;
    bool is_repeated(int i) const;

    // Newest first; behind the last comes `none`.
    std::array<int, capacity> materials_{none, none, none, none};
    std::array<std::uint16_t, capacity> objects_{};  // low bits, enough to tell a few apart
};

static_assert(sizeof(MediumStack) <= 24);

}  // namespace verglas
