// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/material/lobe_tables.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <map>
#include <random>

#include "core/material/lobe_model.h"
#include "tests/core/model_device.h"
#include "tests/core/reference_lobes.h"

namespace verglas {
namespace {

using glm::vec3;
using glm::vec4;

std::shared_ptr<const LobeTables> tables_of(Ndf ndf) {
    static std::map<Ndf, std::shared_ptr<const LobeTables>> cache;
    auto& tables = cache[ndf];
    if (!tables) {
        const auto begin = std::chrono::steady_clock::now();
        tables = LobeTables::build(ndf);
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
        std::cout << "tables of distribution " << static_cast<int>(ndf) << ": " << seconds.count() << " s\n";
    }
    return tables;
}

struct Point {
    Ndf ndf;
    LobeEvent event;
    float eta;
    float roughness;
    float cosine;
};

// Half of the points anywhere, a quarter close to the critical angle (or grazing), a quarter grazing.
Point draw_point(std::mt19937& random) {
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    Point point{};
    point.ndf = static_cast<Ndf>(random() % 3);
    point.event = static_cast<LobeEvent>(random() % 3);
    point.eta = std::pow(3.0F, 2.0F * unit(random) - 1.0F);
    point.roughness = 0.02F + 0.98F * unit(random);
    const float u = unit(random);
    const float critical = model::critical_cosine(point.eta);
    switch (random() % 4) {
        case 0:
            point.cosine = glm::clamp(critical + 0.1F * (u - 0.5F), 0.01F, 1.0F);
            break;
        case 1:
            point.cosine = 0.01F + 0.14F * u;
            break;
        default:
            point.cosine = 0.01F + 0.99F * u;
            break;
    }
    return point;
}

struct Errors {
    double energy;
    double degrees;
    double kappa;
    double truth;
};

Errors errors_of(const model::Lobe& lobe, const Point& p) {
    const auto truth = reference::integrate(p.ndf, p.roughness * p.roughness, p.eta, p.event, p.cosine);
    Errors errors{std::abs(lobe.energy - truth.energy), 0.0, 0.0, truth.energy};
    // A lobe that carries next to nothing has no direction worth asking for.
    if (truth.energy > 1e-3) {
        const double cosine = glm::dot(glm::dvec3(lobe.direction), truth.direction());
        errors.degrees = glm::degrees(std::acos(std::min(cosine, 1.0)));
        const double kappa = model::kappa_from_spread(static_cast<float>(truth.spread()));
        errors.kappa = std::abs(model::kappa_from_spread(lobe.spread) / kappa - 1.0);
    }
    return errors;
}

class LobeLookup : public OnDevice {
  protected:
    static std::vector<model::Lobe> look_up(const std::vector<Point>& points);
};
ON_BOTH_DEVICES(LobeLookup);

std::vector<model::Lobe> LobeLookup::look_up(const std::vector<Point>& points) {
    std::vector<LobeSlice> tables;
    std::vector<Question> reflected;
    std::vector<Question> refracted;
    for (const Point& p : points) {
        const vec3 d(-std::sqrt(1.0F - p.cosine * p.cosine), 0.0F, -p.cosine);
        const Question question{vec4(d, p.eta), vec4(0.0F, 0.0F, 1.0F, p.roughness),
                                vec4(tables.size(), model::TIR_NONE, 0, 0)};
        (p.event == LobeEvent::Reflect ? reflected : refracted).push_back(question);
        tables.push_back(tables_of(p.ndf)->slice(p.eta, p.event));
    }
    std::vector<model::Lobe> lobes(points.size());
    const auto fill = [&](const ModelFunction& function, const std::vector<Question>& questions) {
        const auto answers = ask(function, questions, tables);
        for (std::size_t i = 0; i < questions.size(); ++i)
            lobes[std::size_t(questions[i].c.x)] = lobe_of(answers[i]);
    };
    fill(MODEL_FUNCTION(rough_reflection), reflected);
    fill(MODEL_FUNCTION(rough_refraction), refracted);
    return lobes;
}

// A user loses: glass as bright, as bent and as blurred as the microfacet model says, from every side.
TEST_P(LobeLookup, AgreesWithIntegrationOverDirections) {
    std::mt19937 random(2012);
    std::vector<Point> points(200);
    for (Point& point : points) point = draw_point(random);
    const std::vector<model::Lobe> lobes = look_up(points);
    std::vector<Errors> errors(points.size());
    tbb::parallel_for(std::size_t(0), points.size(),
                      [&](std::size_t i) { errors[i] = errors_of(lobes[i], points[i]); });
    int within = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Point& p = points[i];
        const Errors& e = errors[i];
        const bool good = e.energy <= 0.01 && e.degrees <= 0.5 && e.kappa <= 0.05;
        within += good ? 1 : 0;
        const auto text = ::testing::Message()
                          << "ndf " << static_cast<int>(p.ndf) << " event " << static_cast<int>(p.event)
                          << " eta " << p.eta << " roughness " << p.roughness << " cosine " << p.cosine
                          << ": energy off by " << e.energy << ", " << e.degrees << " degrees, kappa by "
                          << e.kappa << " W " << e.truth;
        if (!good) std::cout << text << "\n";
        EXPECT_LE(e.energy, 0.03) << text;
        EXPECT_LE(e.degrees, 1.5) << text;
        EXPECT_LE(e.kappa, 0.15) << text;
    }
    std::cout << within << " of " << points.size() << " points within 0.01, 0.5 degrees and 5 %\n";
    EXPECT_GE(within, 190);
}

// A user loses: a quick start from the cache, and correct pictures when a file of it is damaged.
TEST(LobeTables, CacheIsUsedAndMended) {
    const auto folder = std::filesystem::temp_directory_path() / "verglas_cache_test";
    std::filesystem::remove_all(folder);
    const LobeSlice built = LobeTables::load_or_build(Ndf::Ggx, folder)->slice(1.5F, LobeEvent::Refract);
    const auto file = LobeTables::cache_file(Ndf::Ggx, folder);
    ASSERT_TRUE(std::filesystem::exists(file));
    const auto size = std::filesystem::file_size(file);

    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(LobeTables::load_or_build(Ndf::Ggx, folder)->slice(1.5F, LobeEvent::Refract), built);
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), 0.5);

    std::fstream(file, std::ios::in | std::ios::out | std::ios::binary).seekp(100000).put('x').put('y');
    EXPECT_EQ(LobeTables::load_or_build(Ndf::Ggx, folder)->slice(1.5F, LobeEvent::Refract), built);
    std::filesystem::resize_file(file, size / 2);
    EXPECT_EQ(LobeTables::load_or_build(Ndf::Ggx, folder)->slice(1.5F, LobeEvent::Refract), built);
    EXPECT_EQ(std::filesystem::file_size(file), size);
    std::filesystem::remove_all(folder);
}

// A user loses: renders where the cache can't be written, such as on a read-only home.
TEST(LobeTables, WorkWithoutCache) {
    EXPECT_NE(LobeTables::load_or_build(Ndf::Beckmann, "/proc/nowhere"), nullptr);
}

}  // namespace
}  // namespace verglas
