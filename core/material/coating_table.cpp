// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/material/coating_table.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <numeric>

#include "core/material/layered_surface.h"
#include "core/material/model.h"
#include "core/math/sobol.h"

namespace verglas {
namespace {

using glm::dvec3;
using model::COATING_ANGLES;
using model::COATING_GROUPS;
using model::COATING_ITEMS;
using model::COATING_SLICES;

// Of the roughness' axis between its ends; a texture with all values has so many nodes.
constexpr int most_nodes = 10;

// Points for the one row of a constant coating. Many rows share more.
constexpr int most_points = 2048;
constexpr int least_points = 512;

// A group with wider lobes than this is divided.
constexpr float most_undivided = 0.02F;

// Bounces that are followed; further ones go on as the last.
constexpr int followed_bounces = 3;
constexpr int dimensions = 2 + 4 * followed_bounces;
using Point = std::array<float, dimensions>;

glm::vec2 pair(const Point& point, int dimension) { return {point[dimension], point[dimension + 1]}; }

struct Weighted {
    glm::vec3 direction;  // where the light comes from
    float weight;
};

// What a direction's light is made of.
struct Scattered {
    std::array<std::vector<Weighted>, COATING_GROUPS> groups;
    std::array<double, followed_bounces> energies{};  // sums of weights
    std::array<double, followed_bounces> ways{};      // of weights times ways
    double slant_5 = 0.0;                             // of the first bounce's weights times x^5
    double slant_6 = 0.0;
};

float way_of(const glm::vec3& direction) { return 1.0F / std::max(std::abs(direction.z), 0.05F); }

// Follows one point's light. The outer side's frame from within is its mirror image.
void follow(const LayeredSurface& layer, bool reflects_inside, const glm::vec3& o, const Point& point,
            Scattered& scattered) {
    using Event = RoughInterface::Event;
    if (const auto mirrored = layer.outside().sample(o, pair(point, 0), Event::Reflect))
        scattered.groups[model::COATING_MIRRORED].push_back({mirrored->direction, mirrored->weight});
    const auto entered = layer.outside().sample(o, pair(point, 0), Event::Refract);
    if (!entered) return;
    glm::vec3 down = entered->direction;
    float weight = entered->weight;
    float way = 0.0F;
    for (int bounce = 0; bounce < followed_bounces; ++bounce) {
        const auto from_base = layer.base().sample(-down, pair(point, 2 + 4 * bounce));
        if (!from_base) return;
        const glm::vec3 up = from_base->direction;
        weight *= from_base->weight.x;
        way += way_of(down) + way_of(up);
        const glm::vec3 seen(-up.x, -up.y, up.z);
        const glm::vec2 facet = pair(point, 4 + 4 * bounce);
        if (const auto left = layer.near().sample(seen, facet, Event::Refract)) {
            const float w = weight * left->weight;
            const int group = bounce == 0 ? model::COATING_FIRST : model::COATING_FURTHER;
            scattered.groups[group].push_back({{left->direction.x, left->direction.y, -left->direction.z}, w});
            scattered.energies[bounce] += w;
            scattered.ways[bounce] += double{w} * way;
            if (bounce == 0) {
                const double x = 1.0 - std::min(glm::dot(-down, glm::normalize(up - down)), 1.0F);
                scattered.slant_5 += w * std::pow(x, 5.0);
                scattered.slant_6 += w * (1.0 - x) * std::pow(x, 6.0);
            }
        }
        if (!reflects_inside) return;
        const auto kept = layer.near().sample(seen, facet, Event::Reflect);
        if (!kept) return;
        down = {kept->direction.x, kept->direction.y, -kept->direction.z};
        weight *= kept->weight;
    }
}

// Sums over weighted directions, which are folded to one side of the plane of incidence or not.
class LobeSums {
  public:
    void add(const glm::vec3& direction, double weight) {
        weight_ += weight;
        vector_ += weight * dvec3(direction);
    }
    double weight() const { return weight_; }
    dvec3 mean() const { return vector_ / weight_; }

  private:
    double weight_ = 0.0;
    dvec3 vector_{0.0};
};

// (direction, log2(spread)). mean: of directions; variance: their mean squared distance from it. 1 - |mean|
// keeps its precision: |mean|^2 = 1 - variance.
glm::vec4 lobe_item(const dvec3& mean, double variance) {
    const double v = std::clamp(variance, 1e-14, 1.0 - 1e-6);
    const double spread = v / (1.0 + std::sqrt(1.0 - v));
    return {glm::vec3(mean / std::max(glm::length(mean), 1e-12)), static_cast<float>(std::log2(spread))};
}

// All of a group as one lobe, which lies in the plane of incidence.
glm::vec4 whole_lobe(const std::vector<Weighted>& group) {
    LobeSums sums;
    for (const Weighted& i : group) sums.add({i.direction.x, 0.0F, i.direction.z}, i.weight);
    double squared = 0.0;
    for (const Weighted& i : group) {
        const dvec3 off = dvec3(i.direction) - sums.mean();
        squared += i.weight * glm::dot(off, off);
    }
    return lobe_item(sums.mean(), squared / sums.weight());
}

// In slices of equal energy by the angle in the plane of incidence; what lies on a border is shared.
std::array<glm::vec4, COATING_SLICES> sliced_lobes(const std::vector<Weighted>& group) {
    std::vector<float> angles;
    double total = 0.0;
    for (const Weighted& i : group) {
        angles.push_back(std::atan2(i.direction.x, i.direction.z));
        total += i.weight;
    }
    std::vector<int> order(group.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) { return angles[a] < angles[b]; });
    std::array<LobeSums, COATING_SLICES> sums;
    const double share = total / COATING_SLICES;
    int slice = 0;
    for (const int j : order) {
        const glm::vec3& i = group[j].direction;
        const glm::vec3 folded(i.x, std::abs(i.y), i.z);
        double left = group[j].weight;
        while (slice < COATING_SLICES - 1 && sums[slice].weight() + left > share) {
            const double part = share - sums[slice].weight();
            sums[slice].add(folded, part);
            left -= part;
            ++slice;
        }
        sums[slice].add(folded, left);
    }
    std::array<glm::vec4, COATING_SLICES> lobes;
    std::transform(sums.begin(), sums.end(), lobes.begin(), [](const LobeSums& slice_sums) {
        const dvec3 mean = slice_sums.mean();
        return lobe_item(mean, 1.0 - glm::dot(mean, mean));
    });
    return lobes;
}

// Of one direction of the viewer.
struct Node {
    glm::vec4 energies{0.0F};
    glm::vec4 means{0.0F};
    std::array<glm::vec4, COATING_GROUPS> whole{};
    std::array<std::array<glm::vec4, COATING_SLICES>, COATING_GROUPS> sliced{};
};

Node node_of(const LayeredSurface& layer, bool reflects_inside, const std::vector<Point>& points,
             float cos_theta) {
    const glm::vec3 o(-std::sqrt(1.0F - cos_theta * cos_theta), 0.0F, cos_theta);
    Scattered scattered;
    for (const Point& point : points) follow(layer, reflects_inside, o, point, scattered);
    Node node;
    const auto count = static_cast<double>(points.size());
    std::array<double, COATING_GROUPS> sums{};
    for (int group = 0; group < COATING_GROUPS; ++group) {
        const std::vector<Weighted>& light = scattered.groups[group];
        for (const Weighted& i : light) sums[group] += i.weight;
        if (sums[group] <= 1e-6 * count) continue;
        node.whole[group] = whole_lobe(light);
        node.sliced[group] = sliced_lobes(light);
    }
    const auto ratio = [](double a, double b) { return b > 0.0 ? a / b : 0.0; };
    const auto& energies = scattered.energies;
    node.energies = {sums[model::COATING_MIRRORED] / count, energies[0] / count, energies[1] / count,
                     ratio(energies[2], energies[1])};
    node.means = {ratio(scattered.slant_5, energies[0]), ratio(scattered.slant_6, energies[0]),
                  ratio(scattered.ways[0], energies[0]), ratio(scattered.ways[1], energies[1])};
    return node;
}

using Row = std::array<Node, COATING_ANGLES>;

// From straight to grazing: where no light of a group is left, the shape of the last lobes stays.
void fill_dark(Row& row) {
    for (int column = COATING_ANGLES - 2; column >= 0; --column) {
        for (int group = 0; group < COATING_GROUPS; ++group) {
            if (glm::vec3(row[column].whole[group]) != glm::vec3(0.0F)) continue;
            row[column].whole[group] = row[column + 1].whole[group];
            row[column].sliced[group] = row[column + 1].sliced[group];
        }
    }
}

std::vector<Point> sobol_points(int count) {
    std::vector<Point> points(count);
    for (int j = 0; j < count; ++j) {
        const SobolPoint point(0, static_cast<std::uint32_t>(j), 0);
        for (int k = 0; k < dimensions; ++k) points[j][k] = point[k];
    }
    return points;
}

// Nodes on the axis of roughness: one for a constant.
int nodes_of(float least, float greatest) {
    if (greatest <= least) return 1;
    const float whole = model::coating_axis(model::MAX_ROUGHNESS) - model::coating_axis(0.0F);
    return 2 + static_cast<int>(std::ceil((most_nodes - 2) * (greatest - least) / whole - 1e-4F));
}

float alpha_of_node(const RoughnessRange& range, float least, float greatest, int node, int nodes) {
    if (nodes == 1) return std::max(model::alpha_from_roughness(range.least), 1e-4F);
    const float y = glm::mix(least, greatest, static_cast<float>(node) / static_cast<float>(nodes - 1));
    return model::alpha_from_roughness(y * y * y);
}

RoughnessRange range_of(float roughness, const std::shared_ptr<const Texture>& texture) {
    const float least = texture ? texture->least() : roughness;
    const float greatest = texture ? texture->greatest() : roughness;
    const float most = model::MAX_ROUGHNESS;
    return {std::clamp(least, 0.0F, most), std::clamp(greatest, 0.0F, most)};
}

// A material with this key, whose base reflects all light.
Material coating_of(const CoatingKey& key) {
    Material material;
    material.kind = MaterialKind::Coated;
    material.ior = key.ior;
    material.fresnel = key.fresnel;
    material.layer.diffuse = key.diffuse;
    material.layer.base_color = material.layer.edge_tint = glm::vec3(1.0F);
    return material;
}

}  // namespace

CoatingKey::CoatingKey(const Material& material)
    : ior(material.ior),
      fresnel(material.fresnel),
      diffuse(material.layer.diffuse),
      outer(range_of(material.roughness, material.roughness_texture)),
      base(diffuse ? RoughnessRange{1.0F, 1.0F}  // of no account
                   : range_of(material.layer.roughness, material.layer.roughness_texture)) {}

CoatingTable CoatingTable::build(const CoatingKey& key) {
    CoatingTable table;
    model::CoatingTable& layout = table.layout;
    layout = {.first_row = 0,
              .outer_nodes = 0,
              .base_nodes = 0,
              .divided = 0,
              .outer_least = model::coating_axis(key.outer.least),
              .outer_greatest = model::coating_axis(key.outer.greatest),
              .base_least = model::coating_axis(key.base.least),
              .base_greatest = model::coating_axis(key.base.greatest)};
    layout.outer_nodes = nodes_of(layout.outer_least, layout.outer_greatest);
    layout.base_nodes = nodes_of(layout.base_least, layout.base_greatest);
    const int rows = layout.outer_nodes * layout.base_nodes;
    const std::vector<Point> points = sobol_points(std::max(most_points / rows, least_points));
    const Material material = coating_of(key);

    std::vector<Row> nodes(rows);
    tbb::parallel_for(0, rows * COATING_ANGLES, [&](int task) {
        const int row = task / COATING_ANGLES;
        const int column = task % COATING_ANGLES;
        const LayeredSurface layer(material, true,
                                   alpha_of_node(key.outer, layout.outer_least, layout.outer_greatest,
                                                 row / layout.base_nodes, layout.outer_nodes),
                                   alpha_of_node(key.base, layout.base_least, layout.base_greatest,
                                                 row % layout.base_nodes, layout.base_nodes));
        const float x = static_cast<float>(column) / (COATING_ANGLES - 1);
        const float cos_theta = std::sin(0.5F * glm::pi<float>() * x);
        nodes[row][column] = node_of(layer, key.fresnel, points, std::clamp(cos_theta, 1e-4F, 1.0F - 1e-6F));
    });
    for (Row& row : nodes) fill_dark(row);

    for (int group = 0; group < COATING_GROUPS; ++group) {
        for (const Row& row : nodes)
            for (const Node& node : row)
                if (node.whole[group].w > std::log2(most_undivided)) layout.divided |= 1 << group;
    }
    table.nodes.reserve(std::size_t(rows) * COATING_ITEMS * COATING_ANGLES);
    for (const Row& row : nodes) {
        for (const Node& node : row) table.nodes.push_back(node.energies);
        for (const Node& node : row) table.nodes.push_back(node.means);
        for (int group = 0; group < COATING_GROUPS; ++group) {
            const bool divided = (layout.divided >> group & 1) != 0;
            for (int slice = 0; slice < COATING_SLICES; ++slice)
                for (const Node& node : row)
                    table.nodes.push_back(divided ? node.sliced[group][slice] : node.whole[group]);
        }
    }
    return table;
}

}  // namespace verglas
