// `best`: at any time the received message with the greatest utility counts; the state is their upper envelope.
// The twin of planner/aggregations/best.py, where the reasons are written out.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "receipts.h"
#include "window.h"

namespace sendworthy {

class Envelopes {
  public:
    // When the utility of the stream ends for what the search maximises is `until`.
    Envelopes(const Receipts& receipts, std::int32_t stream, double until)
        : receipts_(receipts), stream_(stream), window_(receipts.window()), count_(receipts.count(stream)) {
        const Stream& of = window_.stream[stream];
        for (auto at = of.receiver_start; at < window_.stream[stream + 1].receiver_start && fits_; ++at) {
            cut(window_.receiver[at], until);
        }
        if (fits_) integrate();
    }

    // Whether the cells are not too many to look at, and finite.
    bool fits() const { return fits_; }
    // Whether no state stands for another one that there was no room for.
    bool exact() const { return exact_; }

    double facts() const { return facts_.inside; }
    double aim_facts() const { return facts_.inside + facts_.outside; }
    double everything() const { return everything_; }

    // Follow the envelopes from receipt to receipt; `entry(gain, aim, after)` is told of each, `level(message, states)`
    // of each open message before its entries.
    template <class Level, class Entry>
    void follow(Level level, Entry entry) {
        std::vector<std::int32_t> rows;  // of the open messages
        for (std::int32_t row = 0; row < count_; ++row) {
            if (!message(row).sent) rows.push_back(row);
        }
        for (std::size_t at = 0; at < rows.size(); ++at) {
            const double next = at + 1 < rows.size() ? message(rows[at + 1]).t_rcv : kForever;
            level(receipts_.begin(stream_)[rows[at]], static_cast<std::int32_t>(states_));
            send(rows[at], next, entry);
        }
    }

  private:
    static constexpr int kCells = 128;
    static constexpr int kCellsBeyond = 32;
    static constexpr std::size_t kMaxStates = 256;
    static constexpr std::size_t kMaxAreas = 1'000'000;

    // The cells of one receiver, in a row: those from `end_inside` on do not count in U.
    struct Part {
        std::size_t begin;
        std::size_t end_inside;
        std::size_t end;
        Receiver receiver;
    };
    struct Sums {
        double inside = 0.0;
        double outside = 0.0;
    };

    const Message& message(std::int32_t row) const { return window_.message[receipts_.begin(stream_)[row]]; }
    std::size_t cells() const { return begin_.size(); }

    // Cut the time of a receiver into cells, on the clock of t_rcv.
    void cut(const Receiver& receiver, double until) {
        const double t_end = window_.t_end - receiver.delay;
        const double end = until - receiver.delay;
        std::vector<double> edges;
        even(edges, std::min(message(0).t_rcv, t_end), t_end, kCells);
        even(edges, t_end, end, kCellsBeyond);
        const auto evenly = static_cast<std::ptrdiff_t>(edges.size());
        for (std::int32_t row = 0; row < count_ && message(row).t_rcv < end; ++row) edges.push_back(message(row).t_rcv);
        std::inplace_merge(edges.begin(), edges.begin() + evenly, edges.end());
        edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
        const std::size_t count = edges.size() - 1;
        fits_ = fits_ && static_cast<std::size_t>(count_) * count <= kMaxAreas;
        const auto inside = std::lower_bound(edges.begin(), edges.end() - 1, t_end) - edges.begin();
        parts_.push_back({cells(), cells() + static_cast<std::size_t>(inside), cells() + count, receiver});
        begin_.insert(begin_.end(), edges.begin(), edges.end() - 1);
        close_.insert(close_.end(), edges.begin() + 1, edges.end());
    }

    void even(std::vector<double>& edges, double begin, double end, int cells) const {
        edges.reserve(static_cast<std::size_t>(kCells + kCellsBeyond + 2 + count_));
        const double step = (end - begin) / cells;
        for (int at = 0; at < cells; ++at) {
            edges.push_back(begin + (step == 0.0 ? at / static_cast<double>(cells) * (end - begin) : at * step));
        }
        edges.push_back(end);
    }

    // Where the cells of a part begin in which what is received at `t_rcv` counts.
    std::size_t counting(const Part& part, double t_rcv) const {
        const auto begin = begin_.begin() + static_cast<std::ptrdiff_t>(part.begin);
        const auto end = begin_.begin() + static_cast<std::ptrdiff_t>(part.end);
        return static_cast<std::size_t>(std::lower_bound(begin, end, t_rcv) - begin_.begin());
    }

    // Integrate every message over the cells in which it counts.
    void integrate() {
        areas_.assign(static_cast<std::size_t>(count_) * cells(), 0.0);
        envelopes_.assign(cells(), 0.0);
        std::vector<double> all(cells(), 0.0);
        for (std::int32_t row = 0; row < count_; ++row) {
            const Message& m = message(row);
            double* area = areas_.data() + static_cast<std::size_t>(row) * cells();
            for (const Part& part : parts_) {
                std::size_t at = counting(part, m.t_rcv);
                if (at == part.end) continue;
                const double born = m.t_gen - part.receiver.delay;
                const double factor = part.receiver.share * m.scale;
                Integral integral(window_.utility[m.utility], std::max(begin_[at] - born, 0.0));
                for (; at < part.end; ++at) {
                    area[at] = integral.step(close_[at] - born) * factor + 0.0;  // no -0
                    fits_ = fits_ && std::isfinite(area[at]);
                }
            }
            for (std::size_t at = 0; at < cells(); ++at) {
                all[at] = std::max(all[at], area[at]);
                if (m.sent) envelopes_[at] = std::max(envelopes_[at], area[at]);
            }
        }
        for (const Part& part : parts_) {
            for (std::size_t at = part.begin; at < part.end; ++at) {
                (at < part.end_inside ? facts_.inside : facts_.outside) += envelopes_[at];
                if (at < part.end_inside) everything_ += all[at];
            }
        }
    }

    // Send the message of a row in all states; go on with the states after it.
    template <class Entry>
    void send(std::int32_t row, double next, Entry entry) {
        const std::size_t states = states_;
        const std::size_t width = cells();
        const double* area = areas_.data() + static_cast<std::size_t>(row) * width;
        from_.clear();
        coming_.clear();
        for (const Part& part : parts_) {
            from_.push_back(counting(part, message(row).t_rcv));
            coming_.push_back(counting(part, next));
        }
        sent_.assign(envelopes_.begin(), envelopes_.end());
        envelopes_.reserve(std::min(2 * states, kMaxStates) * width);  // so that what is known stays where it is
        known_.clear();
        slot_.fill(kFree);
        for (std::size_t state = 0; state < states; ++state) number_of(envelopes_.data() + state * width, state);
        for (std::size_t state = 0; state < states; ++state) {
            double* envelope = sent_.data() + state * width;
            Sums more;
            for (std::size_t at = 0; at < parts_.size(); ++at) {
                const std::size_t middle = std::max(from_[at], parts_[at].end_inside);
                more.inside += raise(envelope, area, from_[at], parts_[at].end_inside);
                more.outside += raise(envelope, area, middle, parts_[at].end);
            }
            std::size_t& after = number_of(envelope, states_);
            if (after == kMaxStates) {
                after = nearest(envelope);
                exact_ = false;
            } else if (after == states_) {
                envelopes_.insert(envelopes_.end(), envelope, envelope + width);
                ++states_;
            }
            entry(more.inside, more.inside + more.outside, static_cast<std::int32_t>(after));
        }
    }

    // Raise an envelope by what is better; return by how much.
    static double raise(double* envelope, const double* area, std::size_t begin, std::size_t end) {
        double more = 0.0;
        for (std::size_t at = begin; at < end; ++at) {
            const double raised = std::max(envelope[at], area[at]);
            more += raised - envelope[at];
            envelope[at] = raised;
        }
        return more;
    }

    // The state of the first envelope that is the same in the coming cells; `number` when it is the first.
    std::size_t& number_of(const double* envelope, std::size_t number) {
        std::uint64_t hash = 0;  // of some of the cells: all are compared where it is the same
        for (std::size_t at = 0; at < parts_.size(); ++at) {
            const std::size_t apart = (parts_[at].end - coming_[at]) / kHashed + 1;
            for (std::size_t cell = coming_[at]; cell < parts_[at].end; cell += apart) {
                std::uint64_t bits;
                std::memcpy(&bits, envelope + cell, sizeof bits);
                hash = (hash ^ bits) * 0x9E3779B97F4A7C15u;
                hash ^= hash >> 29;
            }
        }
        std::size_t at = hash % kSlots;
        for (; slot_[at] != kFree; at = (at + 1) % kSlots) {
            Known& known = known_[static_cast<std::size_t>(slot_[at])];
            if (known.hash == hash && alike(known.envelope, envelope)) return known.number;
        }
        slot_[at] = static_cast<std::int32_t>(known_.size());
        known_.push_back({hash, envelope, number});
        return known_.back().number;
    }

    bool alike(const double* one, const double* other) const {
        for (std::size_t at = 0; at < parts_.size(); ++at) {
            if (!std::equal(one + coming_[at], one + parts_[at].end, other + coming_[at])) return false;
        }
        return true;
    }

    // The state whose envelope differs least in the coming cells.
    std::size_t nearest(const double* envelope) const {
        std::size_t best = 0;
        double least = kForever;
        for (std::size_t state = 0; state < states_; ++state) {
            const double* other = envelopes_.data() + state * cells();
            double apart = 0.0;
            for (std::size_t at = 0; at < parts_.size(); ++at) {
                for (std::size_t cell = coming_[at]; cell < parts_[at].end; ++cell) {
                    apart += std::abs(other[cell] - envelope[cell]);
                }
            }
            if (apart < least) {
                least = apart;
                best = state;
            }
        }
        return best;
    }

    static constexpr std::size_t kSlots = 1024;  // twice what may be known: all states before, and all after
    static constexpr std::size_t kHashed = 16;
    static constexpr std::int32_t kFree = -1;

    struct Known {
        std::uint64_t hash;
        const double* envelope;
        std::size_t number;
    };

    const Receipts& receipts_;
    std::int32_t stream_;
    const Window& window_;
    std::int32_t count_;
    std::vector<Part> parts_;
    std::vector<double> begin_;  // of each cell
    std::vector<double> close_;
    std::vector<double> areas_;      // [row * cells + cell]: what each message is worth in each cell
    std::vector<double> envelopes_;  // [state * cells + cell]
    std::vector<double> sent_;       // the same once the message at hand is sent
    std::vector<std::size_t> from_;    // by part: the first cell in which the message at hand counts
    std::vector<std::size_t> coming_;  // and the first that matters from the next receipt on
    std::array<std::int32_t, kSlots> slot_{};
    std::vector<Known> known_;
    std::size_t states_ = 1;
    Sums facts_;
    double everything_ = 0.0;
    bool fits_ = true;
    bool exact_ = true;
};

}  // namespace sendworthy
