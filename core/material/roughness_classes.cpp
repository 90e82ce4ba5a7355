// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/material/roughness_classes.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace verglas {
namespace {

constexpr int bin_count = 256;

// Less error than this is none.
constexpr double negligible = 1e-9;

}  // namespace

RoughnessHistogram::RoughnessHistogram(const Texture& texture) {
    std::array<double, bin_count> count{};
    std::array<double, bin_count> sum{};
    for (const float value : texture.values()) {
        const float roughness = std::clamp(value, 0.0F, 1.0F);
        const int bin = std::min(static_cast<int>(roughness * bin_count), bin_count - 1);
        count[bin] += 1.0;
        sum[bin] += roughness;
    }
    const auto texels = static_cast<double>(texture.values().size());
    double total = 0.0;
    for (int bin = 0; bin < bin_count; ++bin) {
        total += sum[bin];
        if (count[bin] == 0.0) continue;
        roughness_.push_back(sum[bin] / count[bin]);
        weight_.push_back(count[bin] / texels);
    }
    mean_ = static_cast<float>(total / texels);
}

// Dynamic programming: error[j] of the best classes so far of which bin j is the last.
std::vector<float> RoughnessHistogram::classes(int most) const {
    const int bins = static_cast<int>(roughness_.size());
    // Moments of the bins before each.
    std::vector<std::array<double, 3>> moments(bins + 1);
    for (int i = 0; i < bins; ++i) {
        const double x = roughness_[i];
        const double w = weight_[i];
        moments[i + 1] = {moments[i][0] + w, moments[i][1] + w * x, moments[i][2] + w * x * x};
    }
    const auto error_between = [&](int a, int b) {
        const double w = moments[b][0] - moments[a + 1][0];
        const double wx = moments[b][1] - moments[a + 1][1];
        const double wxx = moments[b][2] - moments[a + 1][2];
        return wx * (roughness_[a] + roughness_[b]) - wxx - w * roughness_[a] * roughness_[b];
    };

    constexpr double never = std::numeric_limits<double>::max();
    std::vector<double> error(bins, never);
    error[0] = 0.0;
    std::vector<std::vector<int>> before;  // of each further class: the bin of the one before
    while (error.back() > negligible && static_cast<int>(before.size()) + 1 < most) {
        std::vector<double> next(bins, never);
        std::vector<int>& from = before.emplace_back(bins, 0);
        for (int b = 1; b < bins; ++b) {
            for (int a = 0; a < b; ++a) {
                if (error[a] == never) continue;
                const double candidate = error[a] + error_between(a, b);
                if (candidate < next[b]) {
                    next[b] = candidate;
                    from[b] = a;
                }
            }
        }
        error = std::move(next);
    }

    std::vector<float> result = {static_cast<float>(roughness_.back())};
    int bin = bins - 1;
    for (auto from = before.rbegin(); from != before.rend(); ++from) {
        bin = (*from)[bin];
        result.insert(result.begin(), static_cast<float>(roughness_[bin]));
    }
    return result;
}

}  // namespace verglas
