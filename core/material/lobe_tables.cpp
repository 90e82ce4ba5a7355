// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/material/lobe_tables.h"

#include <tbb/parallel_for.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <glm/gtc/constants.hpp>
#include <string>
#include <system_error>

#include "core/math/low_discrepancy.h"

namespace verglas {
namespace {

using glm::dvec2;
using model::LOBE_COSINES;
using model::LOBE_ROUGHNESSES;

constexpr int eta_count = 24;
constexpr int side_count = 2;  // 0: eta >= 1, 1: eta < 1
constexpr int sample_count = 4096;
// The first node of the index axis stands for 1, where all lobes become a point.
constexpr double min_log_eta = 5e-4;

// The index axis is |ln eta|, closer near 1, where grazing lobes change fast.
double log_eta_of_node(int node) {
    const double t = static_cast<double>(node) / (eta_count - 1);
    return std::max(std::log(static_cast<double>(max_eta)) * t * t, min_log_eta);
}

double node_of_log_eta(double log_eta) {
    return std::sqrt(std::min(log_eta / std::log(static_cast<double>(max_eta)), 1.0)) * (eta_count - 1);
}

std::size_t node_index(LobeEvent event, int side, int eta_node, int roughness_node, int cosine_node) {
    std::size_t index = static_cast<int>(event);
    index = index * side_count + side;
    index = index * eta_count + eta_node;
    index = index * LOBE_ROUGHNESSES + roughness_node;
    return index * LOBE_COSINES + cosine_node;
}

constexpr std::size_t node_count =
    std::size_t{lobe_event_count} * side_count * eta_count * LOBE_ROUGHNESSES * LOBE_COSINES;

// Squared sine of a normal drawn in proportion to D(m) (m.n), with the share `rest` in (0, 1) of all normals
// farther from n: Walter et al. 2007, eqs. 28, 31, 35.
double sample_sine_squared(Ndf ndf, double alpha, double rest) {
    if (ndf == Ndf::BlinnPhong) return -std::expm1(alpha * alpha * std::log(rest));
    const double tan2 = alpha * alpha * (ndf == Ndf::Ggx ? (1.0 - rest) / rest : -std::log(rest));
    return tan2 / (1.0 + tan2);
}

// Weighted microfacet normals in the frame (x in the plane of incidence, z along n). y is positive, since the
// lobe is symmetric in it.
struct Normals {
    std::array<float, sample_count> x;
    std::array<float, sample_count> y;
    std::array<float, sample_count> z;
    std::array<float, sample_count> weight;
};

// The tail of the distribution gets more points of less weight: it alone is seen below the critical angle,
// and GGX' tail decides on its spread. rest = t^3, d(rest) = 3 t^2 dt.
Normals draw_normals(Ndf ndf, double alpha) {
    Normals normals;
    for (int j = 0; j < sample_count; ++j) {
        const dvec2 u = r2_point(j);
        const double sine_squared = sample_sine_squared(ndf, alpha, u.x * u.x * u.x);
        const double azimuth = glm::pi<double>() * u.y;
        normals.x[j] = static_cast<float>(std::sqrt(sine_squared) * std::cos(azimuth));
        normals.y[j] = static_cast<float>(std::sqrt(sine_squared) * std::sin(azimuth));
        normals.z[j] = static_cast<float>(std::sqrt(1.0 - sine_squared));
        normals.weight[j] = static_cast<float>(3.0 * u.x * u.x / sample_count);
    }
    return normals;
}

// Weighted sums over directions i: of 1, i - i_0 and |i - i_0|^2, for a fixed unit direction i_0 within the
// lobe, so that narrow lobes keep their precision in floats. x: along the tangent of propagation; z: along
// the normal on the lobe's own side.
struct Sums {
    float weight = 0.0F;
    float x = 0.0F;
    float z = 0.0F;
    float squared = 0.0F;
};

// 1 - |mean(i)|: with |i| = |i_0| = 1, |mean(i)|^2 = 1 - mean(|i - i_0|^2) + |mean(i - i_0)|^2.
double spread_of(const Sums& sums) {
    const double W = sums.weight;
    const double variance = sums.squared / W - (double{sums.x} * sums.x + double{sums.z} * sums.z) / (W * W);
    const double v = std::clamp(variance, 1e-14, 1.0);
    return v / (1.0 + std::sqrt(1.0 - v));
}

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define VERGLAS_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define VERGLAS_VECTOR_CLONES
#endif

// A sum for each lane of a vector unit: the order of additions is fixed, and the loop over lanes is vector
// code.
constexpr int lanes = 16;
struct LaneSums {
    std::array<float, lanes> weight{};
    std::array<float, lanes> x{};
    std::array<float, lanes> z{};
    std::array<float, lanes> squared{};

    void add(int lane, float w, float dx, float dz, float d_squared) {
        weight[lane] += w;
        x[lane] += w * dx;
        z[lane] += w * dz;
        squared[lane] += w * d_squared;
    }

    Sums total() const {
        Sums sums;
        for (int lane = 0; lane < lanes; ++lane) {
            sums.weight += weight[lane];
            sums.x += x[lane];
            sums.z += z[lane];
            sums.squared += squared[lane];
        }
        return sums;
    }
};

// Without branches in the loop, so that it becomes vector code.
template <int ndf>
[[gnu::always_inline]] inline void integrate(float alpha, const Normals& normals, float cos_o, float eta,
                                             glm::vec2 reflected_0, glm::vec2 refracted_0,
                                             std::array<Sums, lobe_event_count>& result) {
    const float sin_o = std::sqrt(1.0F - cos_o * cos_o);
    const float inverse_eta = 1.0F / eta;
    const float masking_o = model::smith_masking(ndf, alpha, cos_o) / cos_o;
    LaneSums glass;
    LaneSums without;
    LaneSums mirror;
    for (int first = 0; first < sample_count; first += lanes) {
        for (int lane = 0; lane < lanes; ++lane) {
            const int j = first + lane;
            const float m_x = normals.x[j];
            const float m_y = normals.y[j];
            const float m_z = normals.z[j];
            const float o_m = sin_o * m_x + cos_o * m_z;
            const float cos_m = std::max(o_m, 1e-9F);
            const float weight = o_m > 0.0F ? normals.weight[j] * cos_m * masking_o / m_z : 0.0F;
            const float fresnel = model::fresnel_dielectric(cos_m, eta);

            const float z = 2.0F * cos_m * m_z - cos_o;
            const float w_mirror = z > 0.0F ? weight * fresnel * model::smith_masking(ndf, alpha, z) : 0.0F;
            const float mirror_x = sin_o - 2.0F * cos_m * m_x - reflected_0.x;
            const float mirror_y = 2.0F * cos_m * m_y;
            const float mirror_z = z - reflected_0.y;
            const float mirror_squared = mirror_x * mirror_x + mirror_y * mirror_y + mirror_z * mirror_z;
            mirror.add(lane, w_mirror, mirror_x, mirror_z, mirror_squared);

            // Snell: i = -o / eta + (o.m / eta - cos theta_t) m, cos^2 theta_t = 1 - (1 - (o.m)^2) / eta^2.
            const float cos2_t = 1.0F - (1.0F - cos_m * cos_m) * inverse_eta * inverse_eta;
            const float k = std::sqrt(std::max(cos2_t, 0.0F)) - cos_m * inverse_eta;
            const float away = cos_o * inverse_eta + k * m_z;
            const float w =
                cos2_t > 0.0F && away > 0.0F ? weight * model::smith_masking(ndf, alpha, away) : 0.0F;
            const float x = sin_o * inverse_eta + k * m_x - refracted_0.x;
            const float y = k * m_y;
            const float dz = away - refracted_0.y;
            const float squared = x * x + y * y + dz * dz;
            const float w_glass = w * (1.0F - fresnel);
            glass.add(lane, w_glass, x, dz, squared);
            without.add(lane, w, x, dz, squared);
        }
    }
    result = {glass.total(), without.total(), mirror.total()};
}

VERGLAS_VECTOR_CLONES
void integrate(Ndf ndf, float alpha, const Normals& normals, float cos_o, float eta, glm::vec2 reflected_0,
               glm::vec2 refracted_0, std::array<Sums, lobe_event_count>& result) {
    switch (ndf) {
        case Ndf::Beckmann:
            return integrate<model::NDF_BECKMANN>(alpha, normals, cos_o, eta, reflected_0, refracted_0,
                                                  result);
        case Ndf::Ggx:
            return integrate<model::NDF_GGX>(alpha, normals, cos_o, eta, reflected_0, refracted_0, result);
        case Ndf::BlinnPhong:
            return integrate<model::NDF_BLINN_PHONG>(alpha, normals, cos_o, eta, reflected_0, refracted_0,
                                                     result);
    }
}

// Directions (along the tangent, along the normal) of light at a smooth interface, by event; beyond the
// critical angle the refracted one lies in the tangent plane.
std::array<glm::vec2, lobe_event_count> specular_directions(float cos_o, float eta) {
    const float sin_o = std::sqrt(1.0F - cos_o * cos_o);
    const float sin_t = std::min(sin_o / eta, 1.0F);
    const glm::vec2 refracted(sin_t, std::sqrt(1.0F - sin_t * sin_t));
    return {refracted, refracted, glm::vec2(sin_o, cos_o)};
}

// Spreads grow with alpha^2 and, for refraction, with ln(eta)^2; what is stored is free of both.
double spread_scale(LobeEvent event, double alpha, double log_eta) {
    return event == LobeEvent::Reflect ? alpha * alpha : alpha * alpha * log_eta * log_eta;
}

}  // namespace

std::shared_ptr<const LobeTables> LobeTables::build(Ndf ndf) {
    std::shared_ptr<LobeTables> tables(new LobeTables);
    tables->nodes_.resize(node_count);
    tbb::parallel_for(0, LOBE_ROUGHNESSES * eta_count, [&](int task) {
        const int roughness_node = task / eta_count;
        const int eta_node = task % eta_count;
        const double roughness =
            model::lobe_table_roughness(static_cast<float>(roughness_node) / (LOBE_ROUGHNESSES - 1));
        const double alpha = roughness * roughness;
        const Normals normals = draw_normals(ndf, alpha);
        const double log_eta = log_eta_of_node(eta_node);
        for (int side = 0; side < side_count; ++side) {
            const auto eta = static_cast<float>(std::exp(side == 0 ? log_eta : -log_eta));
            std::array<Node, lobe_event_count> last{};
            // From straight to grazing: where nothing passes, the shape of the last lobe stays.
            for (int cosine_node = LOBE_COSINES - 1; cosine_node >= 0; --cosine_node) {
                const float x = static_cast<float>(cosine_node) / (LOBE_COSINES - 1);
                const float cosine = std::clamp(model::lobe_table_cosine(x, eta), 1e-4F, 1.0F - 1e-4F);
                const float sin_o = std::sqrt(1.0F - cosine * cosine);
                const std::array<glm::vec2, lobe_event_count> i_0 = specular_directions(cosine, eta);
                std::array<Sums, lobe_event_count> sums;
                integrate(ndf, static_cast<float>(alpha), normals, cosine, eta,
                          i_0[static_cast<int>(LobeEvent::Reflect)],
                          i_0[static_cast<int>(LobeEvent::Refract)], sums);
                for (int e = 0; e < lobe_event_count; ++e) {
                    const auto event = static_cast<LobeEvent>(e);
                    Node& node = last[e];
                    node.energy = sums[e].weight;
                    if (sums[e].weight > 0.0F) {
                        const glm::vec2 mean = i_0[e] + glm::vec2(sums[e].x, sums[e].z) / sums[e].weight;
                        node.bend = mean.x / glm::length(mean) / sin_o;
                        node.away = mean.y / glm::length(mean);
                        node.log_spread = static_cast<float>(
                            std::log2(spread_of(sums[e]) / spread_scale(event, alpha, log_eta)));
                    }
                    tables->nodes_[node_index(event, side, eta_node, roughness_node, cosine_node)] = node;
                }
            }
        }
    });
    return tables;
}

LobeSlice LobeTables::slice(float eta, LobeEvent event) const {
    const int side = eta >= 1.0F ? 0 : 1;
    const double log_eta = std::clamp(std::abs(std::log(static_cast<double>(eta))), min_log_eta,
                                      std::log(static_cast<double>(max_eta)));
    const double position = node_of_log_eta(log_eta);
    const int first = std::min(static_cast<int>(position), eta_count - 2);
    const auto t = static_cast<float>(position - first);
    const auto scale = static_cast<float>(std::log2(spread_scale(event, 1.0, log_eta)));
    LobeSlice slice;
    slice.reserve(std::size_t{LOBE_COSINES} * LOBE_ROUGHNESSES);
    for (int roughness_node = 0; roughness_node < LOBE_ROUGHNESSES; ++roughness_node) {
        for (int cosine_node = 0; cosine_node < LOBE_COSINES; ++cosine_node) {
            const Node& a = nodes_[node_index(event, side, first, roughness_node, cosine_node)];
            const Node& b = nodes_[node_index(event, side, first + 1, roughness_node, cosine_node)];
            slice.emplace_back(glm::mix(a.energy, b.energy, t),
                               glm::mix(a.log_spread, b.log_spread, t) + scale, glm::mix(a.bend, b.bend, t),
                               glm::mix(a.away, b.away, t));
        }
    }
    return slice;
}

// The file: magic, checksum, nodes. VERGLAS_LOBE_TABLE_KEY is a hash of the sources of this file and of the
// shader library, set by the build.
namespace {

constexpr std::array<char, 8> magic = {'V', 'G', 'L', 'O', 'B', 'E', 'S', '1'};

// FNV-1a, 64 bits.
std::uint64_t checksum(const void* data, std::size_t size) {
    std::uint64_t hash = 0xcbf29ce484222325U;
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 0x100000001b3U;
    return hash;
}

}  // namespace

std::filesystem::path LobeTables::cache_file(Ndf ndf, const std::filesystem::path& folder) {
    constexpr std::array<const char*, 3> names = {"beckmann", "ggx", "blinn_phong"};
    return folder /
           (std::string("lobes-") + names[static_cast<int>(ndf)] + "-" VERGLAS_LOBE_TABLE_KEY ".bin");
}

std::shared_ptr<LobeTables> LobeTables::read(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::array<char, magic.size()> head{};
    std::uint64_t sum = 0;
    std::shared_ptr<LobeTables> tables(new LobeTables);
    tables->nodes_.resize(node_count);
    const std::size_t size = node_count * sizeof(Node);
    stream.read(head.data(), head.size());
    stream.read(reinterpret_cast<char*>(&sum), sizeof(sum));
    stream.read(reinterpret_cast<char*>(tables->nodes_.data()), static_cast<std::streamsize>(size));
    if (!stream || head != magic || checksum(tables->nodes_.data(), size) != sum) return nullptr;
    return tables;
}

void LobeTables::write(const std::filesystem::path& file) const {
    std::error_code ignored;
    std::filesystem::create_directories(file.parent_path(), ignored);
    // Written beside and renamed, so that another process never reads half a file.
    const std::filesystem::path part = file.string() + "." + std::to_string(getpid());
    const std::size_t size = nodes_.size() * sizeof(Node);
    const std::uint64_t sum = checksum(nodes_.data(), size);
    std::ofstream stream(part, std::ios::binary);
    stream.write(magic.data(), magic.size());
    stream.write(reinterpret_cast<const char*>(&sum), sizeof(sum));
    stream.write(reinterpret_cast<const char*>(nodes_.data()), static_cast<std::streamsize>(size));
    stream.close();
    if (stream) std::filesystem::rename(part, file, ignored);
    if (!stream || ignored) std::filesystem::remove(part, ignored);
}

std::shared_ptr<const LobeTables> LobeTables::load_or_build(Ndf ndf, const std::filesystem::path& folder) {
    const std::filesystem::path file = cache_file(ndf, folder);
    if (auto tables = read(file)) return tables;
    auto tables = build(ndf);
    tables->write(file);
    return tables;
}

std::filesystem::path user_cache_folder() {
    if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache != '\0')
        return std::filesystem::path(cache) / "verglas";
    const char* home = std::getenv("HOME");
    return std::filesystem::path(home != nullptr ? home : "/tmp") / ".cache" / "verglas";
}

}  // namespace verglas
