// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <condition_variable>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <queue>
#include <string>
#include <thread>
#include <type_traits>

namespace verglas::gl {

// The one thread that owns the OpenGL context for its whole life. EGL on Blender's own thread fails or steals
// Blender's context.
class Thread {
  public:
    // Waits until the context is there. Throws Error as Context does.
    Thread();
    // Finishes what has been enqueued. What was made on the thread must be gone by then.
    ~Thread();
    Thread(const Thread&) = delete;
    Thread& operator=(const Thread&) = delete;

    const std::string& device() const { return device_; }

    // Runs a function on the thread and waits for its result; its exceptions arrive here.
    template <typename Function>
    std::invoke_result_t<Function> run(Function function) {
        std::packaged_task<std::invoke_result_t<Function>()> task(std::move(function));
        auto result = task.get_future();
        enqueue([&task] { task(); });
        return result.get();
    }

  private:
    void enqueue(std::function<void()> task);
    void loop(std::promise<std::string>& started);

    std::mutex mutex_;
    std::condition_variable wake_;
    std::queue<std::function<void()>> tasks_;
    bool stop_ = false;
    std::string device_;
    std::thread thread_;
};

}  // namespace verglas::gl
