// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/gl/timer.h"

namespace verglas::gl {

Timers::Scope::Scope(Timers& timers, const char* pass) {
    if (timers.free_.empty()) {
        GLuint id = 0;
        glCreateQueries(GL_TIME_ELAPSED, 1, &id);
        timers.free_.emplace_back(id);
    }
    timers.running_.emplace_back(pass, std::move(timers.free_.back()));
    timers.free_.pop_back();
    glBeginQuery(GL_TIME_ELAPSED, timers.running_.back().second.id());
}

Timers::Scope::~Scope() { glEndQuery(GL_TIME_ELAPSED); }

std::map<std::string, double> Timers::collect() {
    std::map<std::string, double> seconds;
    for (auto& [pass, query] : running_) {
        GLuint64 nanoseconds = 0;
        glGetQueryObjectui64v(query.id(), GL_QUERY_RESULT, &nanoseconds);
        seconds[pass] += 1e-9 * static_cast<double>(nanoseconds);
        free_.push_back(std::move(query));
    }
    running_.clear();
    return seconds;
}

}  // namespace verglas::gl
