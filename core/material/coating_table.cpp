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
using model::COATING_PARTS;

// Of the roughness' axis between its ends; a texture with all values has so many nodes.
constexpr int most_nodes = 10;

// Points for the one row of a constant coating. Many rows share more.
constexpr int most_points = 2048;
constexpr int least_points = 1024;

// A group with wider lobes than this is divided.
constexpr float most_undivided = 0.05F;

// Divided lobes of the further bounces that are so many times wider than those of the first one aren't
// joined.
constexpr float most_joined = 1.5F;

constexpr int slice_parts = COATING_PARTS / model::COATING_SLICES;

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
            scattered.groups[group].push_back(
                {{left->direction.x, left->direction.y, -left->direction.z}, w});
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

// Of directions i, each as `of` has it, by their weight.
template <typename Of>
dvec3 mean_of(const std::vector<Weighted>& light, Of of) {
    double weight = 0.0;
    dvec3 vector(0.0);
    for (const Weighted& i : light) {
        weight += i.weight;
        vector += double{i.weight} * dvec3(of(i.direction));
    }
    return vector / weight;
}

// (direction, log2(spread)). mean: of directions; variance: their mean squared distance from it. 1 - |mean|
// keeps its precision: |mean|^2 = 1 - variance.
glm::vec4 lobe_item(const dvec3& mean, double variance) {
    const double v = std::clamp(variance, 1e-14, 1.0 - 1e-6);
    const double spread = v / (1.0 + std::sqrt(1.0 - v));
    return {glm::vec3(mean / std::max(glm::length(mean), 1e-12)), static_cast<float>(std::log2(spread))};
}

// All of a group as one lobe, which lies in the plane of incidence.
glm::vec4 whole_lobe(const std::vector<Weighted>& group) {
    const dvec3 mean = mean_of(group, [](const glm::vec3& i) { return glm::vec3(i.x, 0.0F, i.z); });
    const dvec3 squared = mean_of(group, [&](const glm::vec3& i) {
        const dvec3 off = dvec3(i) - mean;
        return off * off;
    });
    return lobe_item(mean, squared.x + squared.y + squared.z);
}

// In parts of equal energy by a coordinate of their directions; what lies on a border is shared.
template <typename Coordinate>
std::vector<std::vector<Weighted>> divided(const std::vector<Weighted>& light, int parts,
                                           Coordinate coordinate) {
    std::vector<std::pair<float, Weighted>> sorted;
    double total = 0.0;
    for (const Weighted& i : light) {
        sorted.emplace_back(coordinate(i.direction), i);
        total += i.weight;
    }
    std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<std::vector<Weighted>> result(parts);
    const double share = total / parts;
    double filled = 0.0;
    int part = 0;
    for (const auto& [place, i] : sorted) {
        double left = i.weight;
        while (part < parts - 1 && filled + left > share) {
            result[part].push_back({i.direction, static_cast<float>(share - filled)});
            left -= share - filled;
            filled = 0.0;
            ++part;
        }
        result[part].push_back({i.direction, static_cast<float>(left)});
        filled += left;
    }
    return result;
}

// Lobes with the means of their parts would stand apart, with gaps between them: their mean vectors are drawn
// together so far, which leaves that of the whole as it is and makes each of them wider. Measured under the
// forest map, on coatings of kappa 1 to 1e6, where it is flat.
constexpr double drawn_together = 0.1;

using Parts = std::array<glm::vec4, COATING_PARTS>;

// Of a group, in parts by the angle in the plane of incidence and by the distance from it, folded to one
// side.
Parts divided_lobes(const std::vector<Weighted>& light) {
    const dvec3 whole = mean_of(light, [](const glm::vec3& i) { return glm::vec3(i.x, 0.0F, i.z); });
    Parts lobes;
    auto lobe = lobes.begin();
    for (const auto& slice :
         divided(light, model::COATING_SLICES, [](const glm::vec3& i) { return std::atan2(i.x, i.z); })) {
        for (const auto& part :
             divided(slice, slice_parts, [](const glm::vec3& i) { return std::abs(i.y); })) {
            const dvec3 folded =
                mean_of(part, [](const glm::vec3& i) { return glm::vec3(i.x, std::abs(i.y), i.z); });
            const dvec3 mean = glm::mix(folded, whole, drawn_together);
            *lobe++ = lobe_item(mean, 1.0 - glm::dot(mean, mean));
        }
    }
    return lobes;
}

// Of one direction of the viewer.
struct Node {
    glm::vec4 energies{0.0F};
    glm::vec4 means{0.0F};
    std::array<glm::vec4, COATING_GROUPS> whole{};
    std::array<Parts, COATING_GROUPS> divided{};
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
        node.divided[group] = divided_lobes(light);
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
            row[column].divided[group] = row[column + 1].divided[group];
        }
    }
}

// Behind a rough outer side little light leaves, and the points are too few for it; but then all changes
// slowly with the angle, and means over neighbours, each with points of its own, stand for more. At straight
// views there are fewer neighbours, and more points.
constexpr float least_smoothed_alpha = 0.2F;
constexpr int smoothed_neighbours = 3;
constexpr int points_at_the_end = 4;  // times as many

// The mirrored light has enough.
void smooth(Row& row) {
    const Row rough = row;
    for (int column = 0; column < COATING_ANGLES; ++column) {
        const int reach = std::min({smoothed_neighbours, column, COATING_ANGLES - 1 - column});
        const auto average = [&](auto member) {
            glm::vec4 sum(0.0F);
            for (int i = column - reach; i <= column + reach; ++i) sum += member(rough[i]);
            return sum / static_cast<float>(2 * reach + 1);
        };
        Node& node = row[column];
        const glm::vec4 energies = average([](const Node& n) { return n.energies; });
        node.energies = {node.energies.x, energies.y, energies.z, energies.w};
        node.means = average([](const Node& n) { return n.means; });
        for (int group = model::COATING_FIRST; group < COATING_GROUPS; ++group) {
            node.whole[group] = average([=](const Node& n) { return n.whole[group]; });
            for (int i = 0; i < COATING_PARTS; ++i)
                node.divided[group][i] = average([=](const Node& n) { return n.divided[group][i]; });
        }
    }
}

// set: points of another scrambling.
std::vector<Point> sobol_points(int count, int set) {
    std::vector<Point> points(count);
    for (int j = 0; j < count; ++j) {
        const SobolPoint point(static_cast<std::uint64_t>(set), static_cast<std::uint32_t>(j), 0);
        for (int k = 0; k < dimensions; ++k) points[j][k] = point[k];
    }
    return points;
}

// How much wider parts of the further bounces are than those of the first one: the mean log2 of a row.
float widening(const Row& row) {
    float sum = 0.0F;
    for (const Node& node : row)
        for (int i = 0; i < COATING_PARTS; ++i)
            sum += node.divided[model::COATING_FURTHER][i].w - node.divided[model::COATING_FIRST][i].w;
    return sum / static_cast<float>(COATING_ANGLES * COATING_PARTS);
}

// As CoatingTable::divided.
int divided_groups(const std::vector<Row>& nodes) {
    std::array<bool, COATING_GROUPS> wide{};
    for (int group = 0; group < COATING_GROUPS; ++group)
        for (const Row& row : nodes)
            for (const Node& node : row)
                wide[group] = wide[group] || node.whole[group].w > std::log2(most_undivided);
    const bool wider = std::any_of(nodes.begin(), nodes.end(),
                                   [](const Row& row) { return widening(row) > std::log2(most_joined); });
    wide[model::COATING_FURTHER] = wide[model::COATING_FURTHER] && (wider || !wide[model::COATING_FIRST]);
    int divided = 0;
    for (int group = 0; group < COATING_GROUPS; ++group) divided |= int{wide[group]} << group;
    return divided;
}

// The parts of a slice as one.
glm::vec4 slice_item(const Parts& parts, int slice) {
    dvec3 mean(0.0);
    for (int i = 0; i < slice_parts; ++i) {
        const glm::vec4& part = parts[slice * slice_parts + i];
        mean += dvec3(part) * (1.0 - std::exp2(double{part.w})) / double{slice_parts};
    }
    return lobe_item(mean, 1.0 - glm::dot(mean, mean));
}

// Of a part as coated.glsl has it.
glm::vec4 item(const Node& node, int divided, int group, int part) {
    const auto is_divided = [=](int of) { return (divided >> of & 1) != 0; };
    const bool further = group == model::COATING_FURTHER;
    if (further && is_divided(group)) return slice_item(node.divided[group], part % model::COATING_SLICES);
    return is_divided(further ? model::COATING_FIRST : group) ? node.divided[group][part] : node.whole[group];
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
    const int count = std::max(most_points / rows, least_points);
    const Material material = coating_of(key);
    const auto outer_alpha = [&](int row) {
        return alpha_of_node(key.outer, layout.outer_least, layout.outer_greatest, row / layout.base_nodes,
                             layout.outer_nodes);
    };

    std::vector<Row> nodes(rows);
    tbb::parallel_for(0, rows * COATING_ANGLES, [&](int task) {
        const int row = task / COATING_ANGLES;
        const int column = task % COATING_ANGLES;
        const float alpha = outer_alpha(row);
        const float base_alpha = alpha_of_node(key.base, layout.base_least, layout.base_greatest,
                                               row % layout.base_nodes, layout.base_nodes);
        const LayeredSurface layer(material, true, alpha, base_alpha);
        const bool smoothed = alpha > least_smoothed_alpha;
        const bool at_the_end = column > COATING_ANGLES - 1 - smoothed_neighbours;
        // The rougher both sides, the more points are lost.
        int node_count = static_cast<int>((1.0F + alpha * base_alpha) * static_cast<float>(count));
        if (smoothed && at_the_end) node_count *= points_at_the_end;
        const std::vector<Point> points = sobol_points(node_count, smoothed ? task : 0);
        const float x = static_cast<float>(column) / (COATING_ANGLES - 1);
        const float cos_theta = std::sin(0.5F * glm::pi<float>() * x);
        nodes[row][column] = node_of(layer, key.fresnel, points, std::clamp(cos_theta, 1e-4F, 1.0F - 1e-6F));
    });
    for (int row = 0; row < rows; ++row) {
        fill_dark(nodes[row]);
        if (outer_alpha(row) > least_smoothed_alpha) smooth(nodes[row]);
    }

    layout.divided = divided_groups(nodes);
    table.nodes.reserve(std::size_t(rows) * COATING_ITEMS * COATING_ANGLES);
    for (const Row& row : nodes) {
        for (const Node& node : row) table.nodes.push_back(node.energies);
        for (const Node& node : row) table.nodes.push_back(node.means);
        for (int group = 0; group < COATING_GROUPS; ++group)
            for (int part = 0; part < COATING_PARTS; ++part)
                for (const Node& node : row) table.nodes.push_back(item(node, layout.divided, group, part));
    }
    return table;
}

}  // namespace verglas
