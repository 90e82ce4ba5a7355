// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures for 3D viewports, made in the background.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "core/growing_picture.h"

namespace verglas {

// A picture for a viewport.
struct Shown {
    std::shared_ptr<const Frame> frame;
    Settings settings;  // with its own samples and pixel_size
};

// Makes the pictures of any number of viewports by one device, on a thread of its own. Nobody waits for it.
//
// A viewport that asks for something new gets a quick picture first, of squares of pixels as large as its
// frame rate needs; when it asks for nothing else for a moment, one of all pixels follows, then pictures of
// ever more samples. Who asks is served before those that have something to show; what is being made for
// these then begins anew.
class ViewportRenderer {
  public:
    // Called on the thread; makes pictures of one device.
    using MakePicture = std::function<std::unique_ptr<GrowingPicture>()>;

    explicit ViewportRenderer(MakePicture make);
    ~ViewportRenderer() { stop(); }
    ViewportRenderer(const ViewportRenderer&) = delete;
    ViewportRenderer& operator=(const ViewportRenderer&) = delete;

    // No more pictures; waits for what is being made to end.
    void stop();

  private:
    struct Request;
    struct Job;
    struct Shared;

  public:
    // One viewport. It may outlive the renderer, and then gets no more pictures.
    class View {
      public:
        explicit View(const ViewportRenderer& renderer);
        ~View();
        View(const View&) = delete;
        View& operator=(const View&) = delete;

        // In place of what was asked for before. settings.samples: to grow to; pixel_size is chosen here.
        // seconds: what a quick picture may take.
        void show(Scene scene, const Settings& settings, double seconds);

        // The newest picture; nothing where it has been taken before.
        std::optional<Shown> take();
        bool has_news() const;

        // Whether nothing more will come of what was asked for last.
        bool is_done() const;

        // Why what was asked for last can't be made; empty where it can.
        std::string fault() const;

      private:
        std::shared_ptr<Shared> shared_;
        std::shared_ptr<Job> job_;
    };

  private:
    class Worker;

    std::shared_ptr<Shared> shared_;
    std::thread thread_;
};

}  // namespace verglas
