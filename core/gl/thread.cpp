// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/gl/thread.h"

#include <utility>

#include "core/gl/context.h"
#include "core/gl/debug.h"

namespace verglas::gl {

Thread::Thread() {
    std::promise<std::string> started;
    std::future<std::string> device = started.get_future();
    thread_ = std::thread([this, &started] { loop(started); });
    try {
        device_ = device.get();
    } catch (...) {
        thread_.join();
        throw;
    }
}

Thread::~Thread() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    wake_.notify_one();
    thread_.join();
}

void Thread::enqueue(std::function<void()> task) {
    {
        const std::lock_guard lock(mutex_);
        tasks_.push(std::move(task));
    }
    wake_.notify_one();
}

void Thread::loop(std::promise<std::string>& started) {
    std::unique_ptr<Context> context;
    try {
        context = std::make_unique<Context>();
        install_debug_callback();
        started.set_value(context->device());
    } catch (...) {
        started.set_exception(std::current_exception());
        return;
    }
    while (true) {
        std::function<void()> task;
        {
            std::unique_lock lock(mutex_);
            wake_.wait(lock, [this] { return stop_ || !tasks_.empty(); });
            if (tasks_.empty()) return;
            task = std::move(tasks_.front());
            tasks_.pop();
        }
        task();
    }
}

}  // namespace verglas::gl
