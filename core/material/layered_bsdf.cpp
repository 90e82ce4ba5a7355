// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/material/layered_bsdf.h"

#include <algorithm>
#include <cmath>

#include "core/material/model.h"

namespace verglas {
namespace {

// Across the normal's side, by Snell's law with eta = n_behind / n_before; none beyond the critical angle.
std::optional<glm::vec3> bent(const glm::vec3& up, float eta) {
    const float cos2 = 1.0F - (1.0F - up.z * up.z) / (eta * eta);
    if (cos2 <= 0.0F) return std::nullopt;
    return glm::vec3(up.x / eta, up.y / eta, std::sqrt(cos2));
}

// Where a facet mirrors o to; none below the surface.
std::optional<glm::vec3> mirrored(const glm::vec3& o, const glm::vec3& m) {
    const float o_m = glm::dot(o, m);
    const glm::vec3 i = 2.0F * o_m * m - o;
    return o_m > 0.0F && i.z > 0.0F ? std::optional(glm::normalize(i)) : std::nullopt;
}

glm::vec3 turned(const glm::vec3& m) { return {-m.x, -m.y, m.z}; }

float mean_of(const glm::vec3& v) { return (v.r + v.g + v.b) / 3.0F; }

}  // namespace

LayeredBsdf::LayeredBsdf(LayerModel model, const Material& material, const LayeredSurface& layer,
                         const glm::vec3& o, std::optional<int> only)
    : material_(material),
      layer_(layer),
      is_endf_(model == LayerModel::Endf && !material.layer.diffuse),
      eta_(layer.eta()),
      o_(o),
      t_(bent(o, eta_).value_or(glm::vec3(0.0F))),
      facing_area_(vmf_facing_area(normals().kappa(), o.z)),
      only_(only) {
    bounces_[0] = {material.reflection_color * fresnel(o.z), layer.outside().normals().kappa()};
    if (t_.z > 0.0F && material.layer.bounces > 0) {
        if (is_endf_)
            add_endf_bounces();
        else
            add_base_bounce();
    }
    for (int k = 0; k < count_; ++k)
        if (!is_shown(k)) bounces_[k].energy = glm::vec3(0.0F);
    float sum = 0.0F;
    for (int k = 0; k < count_; ++k) sum += mean_of(bounces_[k].energy);
    for (int k = 0; k < count_; ++k)
        bounces_[k].probability = sum > 0.0F ? mean_of(bounces_[k].energy) / sum : 0.0F;
}

float LayeredBsdf::fresnel(float cos_theta) const {
    return material_.fresnel ? model::fresnel_dielectric(cos_theta, eta_) : 0.0F;
}

// The NDF tree of each bounce (the ENDF paper, Fig. 12), and the energy at the lobes' mean directions, all of
// which are those of reflection and refraction by n. Visible facets cancel the masking of what an interface
// sends to the viewer; that of what comes to it stays.
void LayeredBsdf::add_endf_bounces() {
    const float cos_t = t_.z;
    const float F = fresnel(o_.z);
    const float base_spread = model::spread_from_kappa(base_normals().kappa() / (4.0F * cos_t));
    const float inner_spread = model::spread_from_kappa(normals().kappa() / (4.0F * cos_t));
    const float exit_spread =
        model::spread_from_kappa(normals().kappa() * model::facet_jacobian(1.0F / eta_, cos_t, o_.z));
    const float masking = normals().masking(cos_t);
    const glm::vec3 left = layer_.transmittance(cos_t);
    const glm::vec3 at_base = layer_.base().fresnel(cos_t) * (base_normals().masking(cos_t) * left * left);
    glm::vec3 energy = material_.color * material_.color * ((1.0F - F) * masking);
    float spread = model::spread_from_kappa(normals().kappa() * model::facet_jacobian(eta_, o_.z, cos_t));
    const int bounces = std::min(material_.layer.bounces, Layer::max_bounces);
    for (int k = 1; k <= bounces; ++k) {
        energy *= at_base;
        spread = model::convolved_spread(base_spread, spread);
        const float kappa =
            model::kappa_from_spread(model::warped_spread(spread, exit_spread, 1.0F / eta_, cos_t, o_.z));
        bounces_[count_++] = {energy * (1.0F - F), std::max(4.0F * o_.z * kappa, 1.0F)};  // eq. 19
        energy *= F * masking;
        spread = model::convolved_spread(inner_spread, spread);
    }
}

void LayeredBsdf::add_base_bounce() {
    const glm::vec3 left = layer_.transmittance(t_.z);
    bounces_[count_++] = {material_.color * material_.color * (1.0F - fresnel(o_.z)) *
                              layer_.base().fresnel(t_.z) * left * left,
                          base_normals().kappa()};
}

// Light that is refracted by n, meets the base once, and is refracted by n.
glm::vec3 LayeredBsdf::base_value(const glm::vec3& i, float& pdf) const {
    const glm::vec3 t = *bent(i, eta_);
    const CoatingBase::Value value = layer_.base().evaluate(t_, t);
    const float solid_angle = model::beam_jacobian(1.0F / eta_, t.z, i.z);  // of t to i
    pdf = value.pdf * solid_angle;
    const float T = (1.0F - fresnel(o_.z)) * (1.0F - fresnel(i.z));
    return value.f_cos * (T * solid_angle) * layer_.transmittance(t_.z) * layer_.transmittance(t.z) *
           material_.color * material_.color;
}

// Light that facets of vMF normals mirror to the viewer is their density times F o.m / (their area that faces
// the viewer), and the masking of i.
LayeredBsdf::Value LayeredBsdf::evaluate(const glm::vec3& i) const {
    if (o_.z <= 0.0F || i.z <= 0.0F) return {};
    const glm::vec3 m = glm::normalize(o_ + i);
    const float o_m = std::min(glm::dot(o_, m), 1.0F);
    const float by_m = 1.0F / (4.0F * o_m);  // d(m)/d(i), eq. 12
    const float masking = normals().masking(i.z);
    // sample() turns normals that mirror o below the surface: those opposite are drawn twice as often.
    const float drawn = mirrored(o_, turned(m)) ? 1.0F : 2.0F;
    const float surface_density = normals().pdf(o_, m) * by_m;
    Value value;
    if (is_shown(0))
        value = {material_.reflection_color * (fresnel(o_m) * o_m / facing_area_ * masking * surface_density),
                 bounces_[0].probability * drawn * surface_density};
    for (int k = 1; k < count_; ++k) {
        if (!is_shown(k)) continue;
        const Bounce& bounce = bounces_[k];
        float pdf = 0.0F;
        if (is_endf_) {
            const float density = VonMisesFisher(bounce.kappa).density(m.z) * by_m;
            value.f_cos += bounce.energy * (masking * density);
            pdf = drawn * density;
        } else {
            value.f_cos += base_value(i, pdf);
        }
        value.pdf += bounce.probability * pdf;
    }
    return value;
}

std::optional<glm::vec3> LayeredBsdf::sample_base(glm::vec2 u) const {
    const auto sample = layer_.base().sample(t_, u);
    return sample ? bent(sample->direction, 1.0F / eta_) : std::nullopt;
}

std::optional<LayeredBsdf::Sample> LayeredBsdf::sample(glm::vec2 u, float choice) const {
    int k = 0;
    while (k + 1 < count_ && choice >= bounces_[k].probability) choice -= bounces_[k++].probability;
    std::optional<glm::vec3> i;
    if (k > 0 && !is_endf_) {
        i = sample_base(u);
    } else {
        const glm::vec3 m = VonMisesFisher(bounces_[k].kappa).sample(u);
        i = mirrored(o_, m);
        if (!i) i = mirrored(o_, turned(m));
    }
    if (!i || i->z <= 0.0F) return std::nullopt;
    const Value value = evaluate(*i);
    if (!(value.pdf > 0.0F)) return std::nullopt;
    return Sample{*i, value.f_cos / value.pdf, value.pdf};
}

RoughInterface::Lobe LayeredBsdf::lobe() const {
    int most = 0;
    for (int k = 1; k < count_; ++k) {
        if (bounces_[k].probability > bounces_[most].probability) most = k;
    }
    const bool is_diffuse = most > 0 && material_.layer.diffuse;
    return {glm::vec3(-o_.x, -o_.y, o_.z),
            is_diffuse ? 0.0F : bounces_[most].kappa / (4.0F * std::max(o_.z, 1e-3F))};
}

}  // namespace verglas
