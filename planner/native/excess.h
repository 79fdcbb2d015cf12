// What `current` takes off: a message shows more than the newest one generated, sent or not, is worth.
// The twin of planner/excess.py.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "window.h"

namespace sendworthy {

class Excess {
  public:
    explicit Excess(const Window& window) : window_(window) {
        const auto current = [](const Stream& stream) { return stream.aggregation == Aggregation::current; };
        if (std::none_of(window.stream.begin(), window.stream.end(), current)) return;
        steps_.resize(window.stream.size());
        for (std::int32_t at = 0; at < window.streams(); ++at) {
            const Stream& stream = window.stream[at];
            if (current(stream) && stream.has_newest) steps_[at].push_back(stream.newest);
        }
        for (const Message& m : window.message) {
            if (current(window.stream[m.stream])) steps_[m.stream].push_back({m.t_gen, m.scale});
        }
        for (std::vector<Latest>& steps : steps_) {
            const auto earlier = [](const Latest& one, const Latest& other) { return one.t_gen < other.t_gen; };
            const auto same = [](const Latest& one, const Latest& other) { return one.scale == other.scale; };
            std::stable_sort(steps.begin(), steps.end(), earlier);
            steps.erase(std::unique(steps.begin(), steps.end(), same), steps.end());
        }
    }

    // What a message loses where it is shown from `begin` to `end`.
    double lost(std::int32_t at, double begin, double end) const {
        const Message& m = window_.message[at];
        if (steps_.empty() || steps_[m.stream].empty()) return 0.0;
        const std::vector<Latest>& steps = steps_[m.stream];
        const auto later = [](double t, const Latest& step) { return t < step.t_gen; };
        auto step = std::upper_bound(steps.begin() + 1, steps.end(), begin, later) - 1;
        double total = 0.0;
        for (; step != steps.end() && (step == steps.begin() || step->t_gen < end); ++step) {
            const double since = step == steps.begin() ? begin : std::max(begin, step->t_gen);
            const double until = step + 1 == steps.end() ? end : std::min(end, (step + 1)->t_gen);
            total += std::max(m.scale - step->scale, 0.0) * std::max(until - since, 0.0);
        }
        return window_.utility[m.utility].initial() * total;
    }

    // What it loses a second once all others are generated.
    double finally_lost(std::int32_t at) const {
        const Message& m = window_.message[at];
        if (steps_.empty() || steps_[m.stream].empty()) return 0.0;
        const double over = std::max(m.scale - steps_[m.stream].back().scale, 0.0);
        return window_.utility[m.utility].initial() * over;
    }

  private:
    const Window& window_;
    std::vector<std::vector<Latest>> steps_;  // [stream]: of those of `current`; empty where there is none
};

}  // namespace sendworthy
