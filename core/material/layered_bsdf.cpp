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

float mean_of(const glm::vec3& v) { return (v.r + v.g + v.b) / 3.0F; }

}  // namespace

LayeredBsdf::LayeredBsdf(LayerModel model, const Material& material, float alpha, float base_alpha,
                         const glm::vec3& o)
    : model_(model),
      material_(material),
      o_(o),
      layer_(material, true, alpha, base_alpha),
      normals_(FacetNormals::von_mises_fisher(alpha)),
      base_normals_(FacetNormals::von_mises_fisher(base_alpha)),
      eta_(layer_.eta()),
      t_(bent(o, eta_).value_or(glm::vec3(0.0F))) {
    bounces_[0].energy =
        material.reflection_color * (material.fresnel ? model::fresnel_dielectric(o.z, eta_) : 0.0F);
    if (t_.z > 0.0F) {
        if (model_ == LayerModel::Endf && !material.layer.diffuse)
            add_endf_bounces();
        else
            add_base_bounce();
    }
    float sum = 0.0F;
    for (int k = 0; k < count_; ++k) sum += mean_of(bounces_[k].energy);
    for (int k = 0; k < count_; ++k)
        bounces_[k].probability = sum > 0.0F ? mean_of(bounces_[k].energy) / sum : 0.0F;
}

// The NDF tree of each bounce (the ENDF paper, Fig. 12), and the energy at the lobes' mean directions, all of
// which are those of reflection and refraction by n. Visible facets cancel the masking of what an interface
// sends to the viewer; that of what comes to it stays.
void LayeredBsdf::add_endf_bounces() {
    const float cos_t = t_.z;
    const float F = material_.fresnel ? model::fresnel_dielectric(o_.z, eta_) : 0.0F;
    const glm::vec3 left = layer_.transmittance(cos_t) * layer_.transmittance(cos_t);
    const glm::vec3 at_base = layer_.base().fresnel(cos_t) * (base_normals_.masking(cos_t) * left);
    glm::vec3 energy = material_.color * material_.color * ((1.0F - F) * normals_.masking(cos_t));
    float kappa = normals_.kappa() * model::facet_jacobian(eta_, o_.z, cos_t);
    const int bounces = std::min(material_.layer.bounces, Layer::max_bounces);
    for (int k = 1; k <= bounces; ++k) {
        energy *= at_base;
        kappa = model::reflected_kappa(kappa, base_normals_.kappa(), cos_t);
        const float exit_kappa = model::refracted_kappa(kappa, normals_.kappa(), 1.0F / eta_, cos_t, o_.z);
        bounces_[count_++] = {energy * (1.0F - F), 4.0F * o_.z * exit_kappa};  // eq. 19
        energy *= F * normals_.masking(cos_t);
        kappa = model::reflected_kappa(kappa, normals_.kappa(), cos_t);
    }
}

void LayeredBsdf::add_base_bounce() {
    const float F = material_.fresnel ? model::fresnel_dielectric(o_.z, eta_) : 0.0F;
    const glm::vec3 left = layer_.transmittance(t_.z) * layer_.transmittance(t_.z);
    bounces_[count_++] = {material_.color * material_.color * (1.0F - F) * layer_.base().fresnel(t_.z) * left,
                          base_normals_.kappa()};
}

// Light that is refracted by n, meets the base once, and is refracted by n.
glm::vec3 LayeredBsdf::base_value(const glm::vec3& i, float& pdf) const {
    const glm::vec3 t = *bent(i, eta_);
    const CoatingBase::Value value = layer_.base().evaluate(t_, t);
    const float solid_angle = model::beam_jacobian(1.0F / eta_, t.z, i.z);  // of t to i
    pdf = value.pdf * solid_angle;
    const float T = material_.fresnel ? (1.0F - model::fresnel_dielectric(o_.z, eta_)) *
                                            (1.0F - model::fresnel_dielectric(i.z, eta_))
                                      : 1.0F;
    return value.f_cos * (T * solid_angle) * layer_.transmittance(t_.z) * layer_.transmittance(t.z) *
           material_.color * material_.color;
}

LayeredBsdf::Value LayeredBsdf::evaluate(const glm::vec3& i) const {
    if (o_.z <= 0.0F || i.z <= 0.0F) return {};
    const glm::vec3 m = glm::normalize(o_ + i);
    const float o_m = glm::dot(o_, m);
    const float by_m = 1.0F / (4.0F * o_m);  // d(m)/d(i), eq. 12
    const RoughInterface::Value surface = layer_.outside().evaluate(o_, i);
    Value value{surface.f_cos * material_.reflection_color,
                bounces_[0].probability * normals_.pdf(o_, m) * by_m};
    const float masking = normals_.masking(i.z);
    for (int k = 1; k < count_; ++k) {
        const Bounce& bounce = bounces_[k];
        float pdf = 0.0F;
        if (model_ == LayerModel::Endf && !material_.layer.diffuse) {
            const float alpha = std::sqrt(2.0F / bounce.kappa);
            pdf = FacetNormals::von_mises_fisher(alpha).pdf(o_, m) * by_m;
            value.f_cos += bounce.energy * (masking * pdf);
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
    if (k > 0 && (model_ != LayerModel::Endf || material_.layer.diffuse)) {
        i = sample_base(u);
    } else {
        const FacetNormals normals =
            k == 0 ? normals_ : FacetNormals::von_mises_fisher(std::sqrt(2.0F / bounces_[k].kappa));
        const glm::vec3 m = normals.sample(o_, u);
        const float o_m = glm::dot(o_, m);
        if (o_m > 0.0F) i = glm::normalize(2.0F * o_m * m - o_);
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
    const float kappa = most == 0 ? normals_.kappa() : bounces_[most].kappa;
    const bool is_diffuse = most > 0 && material_.layer.diffuse;
    return {glm::vec3(-o_.x, -o_.y, o_.z), is_diffuse ? 0.0F : kappa / (4.0F * std::max(o_.z, 1e-3F))};
}

}  // namespace verglas
