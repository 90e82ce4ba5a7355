// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace verglas::gl {

// Collects the driver's messages of high severity (KHR_debug) of the calling thread's context.
void install_debug_callback();

// Names the pass that runs on this thread, for messages. When it ends, check() throws what the driver
// reported.
class PassScope {
  public:
    // name: as a user may read it, such as "back faces".
    explicit PassScope(std::string name);
    ~PassScope();
    PassScope(const PassScope&) = delete;
    PassScope& operator=(const PassScope&) = delete;

    // Throws Error that names the pass if the driver has reported a fault since the pass began.
    void check() const;

  private:
    std::string name_;
};

}  // namespace verglas::gl
