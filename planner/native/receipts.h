// The messages of a window stream by stream in the order of receipt, and what each is worth between two receipts.
// The twin of planner/received.py.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "excess.h"
#include "window.h"

namespace sendworthy {

constexpr double kForever = std::numeric_limits<double>::infinity();

class Receipts {
  public:
    explicit Receipts(const Window& window)
        : window_(window), excess_(window), start_(window.stream.size(), 0), message_(window.messages()) {
        for (const Message& m : window.message) start_[m.stream + 1] += 1;
        for (std::size_t at = 1; at < start_.size(); ++at) start_[at] += start_[at - 1];
        std::vector<std::int32_t> next(start_.begin(), start_.end());
        for (std::int32_t at = 0; at < window.messages(); ++at) message_[next[window.message[at].stream]++] = at;
        for (std::size_t at = 0; at + 1 < start_.size(); ++at) {
            in_order(message_.begin() + start_[at], message_.begin() + start_[at + 1]);
        }
    }
    Receipts(const Receipts&) = delete;
    Receipts& operator=(const Receipts&) = delete;

    const Window& window() const { return window_; }

    // The messages of a stream, in the order of receipt; ties as in the window.
    const std::int32_t* begin(std::int32_t stream) const { return message_.data() + start_[stream]; }
    const std::int32_t* end(std::int32_t stream) const { return message_.data() + start_[stream + 1]; }
    std::int32_t count(std::int32_t stream) const { return start_[stream + 1] - start_[stream]; }

    // What a message is worth to all receivers from `begin` to `until` on the clock of t_rcv, less what is lost where it
    // is one of `current`; a receiver with a delay sees both later, but nothing after t_end.
    double worth(std::int32_t at, double begin, double until) const {
        const bool loses = window_.stream[window_.message[at].stream].aggregation == Aggregation::current;
        return unspoilt(at, begin, until) - (loses ? lost(at, begin, until) : 0.0);
    }

    // The same where nothing is lost.
    double unspoilt(std::int32_t at, double begin, double until) const {
        const Message& m = window_.message[at];
        double total = 0.0;
        for (auto r = window_.stream[m.stream].receiver_start; r < window_.stream[m.stream + 1].receiver_start; ++r) {
            const Receiver& receiver = window_.receiver[r];
            const double start = std::max(begin + receiver.delay - m.t_gen, 0.0);
            const double end = std::max(std::min(until + receiver.delay, window_.t_end) - m.t_gen, start);
            if (end > start) total += receiver.share * Integral(window_.utility[m.utility], start).to(end);
        }
        return m.scale * total;
    }

  private:
    double lost(std::int32_t at, double begin, double until) const {
        const Message& m = window_.message[at];
        double total = 0.0;
        for (auto r = window_.stream[m.stream].receiver_start; r < window_.stream[m.stream + 1].receiver_start; ++r) {
            const Receiver& receiver = window_.receiver[r];
            const double end = std::min(until + receiver.delay, window_.t_end);
            total += receiver.share * excess_.lost(at, begin + receiver.delay, end);
        }
        return total;
    }

    // Nearly always they are in order, but for a fact that came late.
    template <class Iterator>
    void in_order(Iterator begin, Iterator end) {
        for (Iterator at = begin; at != end; ++at) {
            const double t_rcv = window_.message[*at].t_rcv;
            const auto later = [&](double t, std::int32_t other) { return t < window_.message[other].t_rcv; };
            std::rotate(std::upper_bound(begin, at, t_rcv, later), at, at + 1);
        }
    }

    const Window& window_;
    Excess excess_;
    std::vector<std::int32_t> start_;
    std::vector<std::int32_t> message_;
};

}  // namespace sendworthy
