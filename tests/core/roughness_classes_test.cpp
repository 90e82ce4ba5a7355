// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/material/roughness_classes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/material/model.h"

namespace verglas {
namespace {

using testing::ElementsAre;
using testing::FloatNear;

RoughnessHistogram histogram_of(std::vector<float> values) {
    const int width = static_cast<int>(values.size());
    return RoughnessHistogram(Texture("Test", width, 1, std::move(values), Extension::Repeat));
}

// A user loses: a painted mask of two roughnesses, exactly, at the cost of two.
TEST(RoughnessClasses, TwoValuesAreTwoClasses) {
    const RoughnessHistogram histogram = histogram_of({0.2F, 0.7F, 0.7F, 0.2F, 0.7F, 0.7F});
    EXPECT_THAT(histogram.classes(8), ElementsAre(FloatNear(0.2F, 1e-6F), FloatNear(0.7F, 1e-6F)));
    EXPECT_NEAR(histogram.mean(), (2 * 0.2F + 4 * 0.7F) / 6, 1e-6F);
    EXPECT_THAT(histogram_of({0.4F, 0.4F}).classes(4), ElementsAre(FloatNear(0.4F, 1e-6F)));
    EXPECT_THAT(histogram_of({-1.0F, 3.0F}).classes(4), ElementsAre(0.0F, 1.0F));
}

// A user loses: gradients whose classes are where the texture needs them.
TEST(RoughnessClasses, GradientsAreDividedEvenly) {
    std::vector<float> ramp(10000);
    for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = static_cast<float>(i) / 9999.0F;
    EXPECT_THAT(histogram_of(ramp).classes(4), ElementsAre(FloatNear(0.0F, 0.01F), FloatNear(0.333F, 0.01F),
                                                           FloatNear(0.667F, 0.01F), FloatNear(1.0F, 0.01F)));
    // Two clusters: classes between them would stand for nothing.
    std::vector<float> clusters;
    for (int i = 0; i < 100; ++i) {
        clusters.push_back(0.1F + 0.001F * static_cast<float>(i));
        clusters.push_back(0.8F + 0.001F * static_cast<float>(i));
    }
    for (const float roughness : histogram_of(clusters).classes(6))
        EXPECT_TRUE(roughness < 0.2F || roughness > 0.79F) << roughness;
}

// A user loses: a lobe between two classes that is as wide as its roughness says.
TEST(RoughnessClasses, SharesKeepTheVariance) {
    for (const float roughness : {0.3F, 0.35F, 0.5F, 0.6F}) {
        const float share = model::upper_class_share(roughness, 0.3F, 0.6F);
        const auto variance = [](float r) { return r * r * r * r; };
        EXPECT_NEAR((1.0F - share) * variance(0.3F) + share * variance(0.6F), variance(roughness), 1e-6F);
    }
    EXPECT_EQ(model::upper_class_share(0.1F, 0.3F, 0.6F), 0.0F);
    EXPECT_EQ(model::upper_class_share(0.9F, 0.3F, 0.6F), 1.0F);
    EXPECT_EQ(model::upper_class_share(0.5F, 0.5F, 0.5F), 0.0F);
}

}  // namespace
}  // namespace verglas
