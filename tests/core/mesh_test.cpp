// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/scene/mesh.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/error.h"

namespace verglas {
namespace {

using glm::uvec3;
using glm::vec3;

const std::vector<vec3> square = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
const std::vector<vec3> up(4, vec3(0, 0, 1));

// A user loses: the rest of a mesh when some of it is broken, and the word of what was left out.
TEST(Mesh, LeavesOutWhatCannotBeDrawn) {
    std::vector<vec3> positions = square;
    positions.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0, 0);
    const std::vector<vec3> normals(5, vec3(0, 0, 1));
    const Mesh mesh("Broken", positions, normals, {uvec3(0, 1, 2), uvec3(0, 1, 4), uvec3(0, 0, 1)}, {});
    EXPECT_EQ(mesh.triangle_count(), 1U);
    ASSERT_EQ(mesh.warnings().size(), 2U);
    for (const std::string& warning : mesh.warnings()) EXPECT_NE(warning.find("Broken"), std::string::npos);
}

// A user loses: an empty object that just isn't seen, rather than an error.
TEST(Mesh, MayBeEmpty) {
    const Mesh mesh("Empty", {}, {}, {}, {});
    EXPECT_EQ(mesh.triangle_count(), 0U);
    EXPECT_TRUE(mesh.warnings().empty());
}

// A user loses: the right material on every face of an object with several.
TEST(Mesh, SortsTrianglesBySlot) {
    const Mesh mesh("Two", square, up, {uvec3(0, 1, 2), uvec3(0, 2, 3), uvec3(1, 2, 3)}, {3, 0, 3});
    ASSERT_EQ(mesh.parts().size(), 2U);
    EXPECT_EQ(mesh.parts()[0].slot, 0);
    EXPECT_EQ(mesh.parts()[0].count, 3U);
    EXPECT_EQ(mesh.parts()[1].slot, 3);
    EXPECT_EQ(mesh.parts()[1].count, 6U);
    EXPECT_EQ(mesh.indices()[2], 3U);
}

// A user loses: shading where a mesh comes with normals of no length.
TEST(Mesh, GivesMissingNormalsTheTrianglesOwn) {
    const Mesh mesh("Bare", square, std::vector<vec3>(4, vec3(0)), {uvec3(0, 1, 2)}, {});
    EXPECT_EQ(mesh.normals()[1], vec3(0, 0, 1));
}

// A scripter loses: a clear sentence in place of a crash for arrays that don't fit.
TEST(Mesh, RefusesArraysThatDoNotFit) {
    EXPECT_THROW(Mesh("m", square, {}, {uvec3(0, 1, 2)}, {}), Error);
    EXPECT_THROW(Mesh("m", square, up, {uvec3(0, 1, 9)}, {}), Error);
    EXPECT_THROW(Mesh("m", square, up, {uvec3(0, 1, 2)}, {0, 0}), Error);
}

}  // namespace
}  // namespace verglas
