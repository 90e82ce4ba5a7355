// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/gl/objects.h"

namespace verglas::gl {

// GPU time by pass, from timer queries; passes of the same name are summed. Not for nested passes.
class Timers {
  public:
    // Time between here and the scope's end counts for the pass.
    class Scope {
      public:
        explicit Scope(Timers& timers, const char* pass);
        ~Scope();
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;
    };

    // Seconds by pass since the last call; waits for the GPU.
    std::map<std::string, double> collect();

  private:
    std::vector<std::pair<std::string, Query>> running_;
    std::vector<Query> free_;
};

}  // namespace verglas::gl
