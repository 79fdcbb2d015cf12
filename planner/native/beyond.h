// What lies beyond the window: what each message is worth as what is left of its stream, and what it is charged.
// The twin of planner/beyond.py, where the reasons are written out.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "excess.h"
#include "steady.h"
#include "window.h"

namespace sendworthy {

struct Beyond {
    std::vector<double> worth;    // [message]
    std::vector<double> charges;  // [message * constraints + k]
    std::vector<double> charge;   // [message]: their sum
    std::vector<double> price;    // [constraint]
    std::vector<double> rent;     // [stream]
    std::vector<double> until;    // [stream]

    bool finite() const {
        const auto all = [](const std::vector<double>& values) {
            return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
        };
        return all(worth) && all(charge) && all(price) && all(until);
    }
};

class LookBeyond {
  public:
    explicit LookBeyond(const Window& window)
        : window_(window),
          excess_(window),
          mean_(window.streams()),
          t_rcv_(window.messages()),
          scale_(window.messages()),
          share_(window.streams(), 0.0),
          beyond_{std::vector<double>(window.messages(), 0.0),
                  std::vector<double>(window.use.size(), 0.0),
                  std::vector<double>(window.messages(), 0.0),
                  std::vector<double>(window.constraint.size(), 0.0),
                  std::vector<double>(window.streams(), 0.0),
                  std::vector<double>(window.streams(), window.t_end)} {}

    // Nothing is left behind when the mission ends with the window.
    Beyond look() {
        if (!window_.goes_on) return std::move(beyond_);
        take_receivers_together();
        take_means();
        earn();
        Clearing clearing(steady_, use_, window_.constraint.size());
        beyond_.price = clearing.prices(window_.constraint);
        for (std::int32_t at = 0; at < window_.streams(); ++at) replace(at, kLongest * mean_[at].interval);
        for (std::size_t i = 0; i < steady_.size(); ++i) settle(steady_[i], clearing.charge(beyond_.price, i));
        for (std::int32_t at = 0; at < window_.messages(); ++at) {
            beyond_.worth[at] = worth(at);
            charge(at);
        }
        for (std::int32_t at = 0; at < window_.streams(); ++at) take_off_first(at);
        return std::move(beyond_);
    }

  private:
    static constexpr double kShortest = 1e-6;

    // The means over the open messages of a stream, and what follows from them.
    struct Mean {
        double first = kInfinity;  // t_gen
        double last = -kInfinity;
        double interval = 1.0;
        double coming = 0.0;  // when the first message after the window is received
        double charge = 0.0;  // of a message
        std::int32_t count = 0;
    };
    static constexpr double kInfinity = std::numeric_limits<double>::infinity();

    Aggregation aggregation(std::int32_t stream) const { return window_.stream[stream].aggregation; }

    double area(const Message& m, double begin, double end) const {
        return Integral(window_.utility[m.utility], begin).to(end);
    }

    // Take all receivers of a message together: when they get it, and what it is worth.
    void take_receivers_together() {
        std::vector<double> late(window_.streams(), 0.0);
        for (std::int32_t at = 0; at < window_.streams(); ++at) {
            for (auto r = window_.stream[at].receiver_start; r < window_.stream[at + 1].receiver_start; ++r) {
                late[at] += window_.receiver[r].delay * window_.receiver[r].share;
                share_[at] += window_.receiver[r].share;
            }
            late[at] /= share_[at] > 0.0 ? share_[at] : 1.0;
        }
        for (std::int32_t at = 0; at < window_.messages(); ++at) {
            const Message& m = window_.message[at];
            t_rcv_[at] = m.t_rcv + late[m.stream];
            scale_[at] = m.scale * share_[m.stream];
        }
    }

    void take_means() {
        double last_receipt = -kInfinity;
        t_last_ = -kInfinity;
        for (std::int32_t at = 0; at < window_.messages(); ++at) {
            const Message& m = window_.message[at];
            if (m.sent) continue;
            Mean& mean = mean_[m.stream];
            mean.first = std::min(mean.first, m.t_gen);
            mean.last = std::max(mean.last, m.t_gen);
            mean.count += 1;
            last_receipt = std::max(last_receipt, t_rcv_[at]);
            t_last_ = std::max(t_last_, m.t_sent);
        }
        t_c_ = std::min(window_.t_end, last_receipt);
        const double first = first_opened();
        for (Mean& mean : mean_) {
            if (mean.count == 0) continue;
            const bool lone = mean.count < 2 || mean.last <= mean.first;
            const double rarely = std::max(mean.first - first, window_.t_end - mean.first);
            mean.interval = std::max(lone ? rarely : (mean.last - mean.first) / (mean.count - 1), kShortest);
        }
        for (std::int32_t at = 0; at < window_.messages(); ++at) {
            Mean& mean = mean_[window_.message[at].stream];
            if (!window_.message[at].sent) mean.coming = std::max(mean.coming, t_rcv_[at] + mean.interval);
        }
    }

    double first_opened() const {
        const auto opened = [](const Message& m) { return !m.sent; };
        return std::find_if(window_.message.begin(), window_.message.end(), opened)->t_gen;
    }

    // Write what each stream that goes on earns, and uses: means as a matrix product takes them, rounded once a message,
    // on any processor.
    void earn() {
        const std::size_t constraints = window_.constraint.size();
        std::vector<std::int32_t> number(window_.streams(), 0);
        for (std::int32_t at = 0; at < window_.streams(); ++at) {
            number[at] = static_cast<std::int32_t>(steady_.size());
            if (mean_[at].count > 0) steady_.push_back({at, {}, {}});
        }
        use_.assign(steady_.size() * constraints, 0.0);
        for (std::int32_t at = 0; at < window_.messages(); ++at) {
            const Message& m = window_.message[at];
            if (m.sent) continue;
            const double part = 1.0 / mean_[m.stream].count;
            add_areas(at, part, steady_[number[m.stream]]);
            double* use = use_.data() + number[m.stream] * constraints;
            for (std::size_t k = 0; k < constraints; ++k) use[k] = std::fma(part, window_.use_of(at)[k], use[k]);
        }
        for (std::size_t i = 0; i < steady_.size(); ++i) {
            const Mean& mean = mean_[steady_[i].stream];
            for (std::size_t j = 0; j < kIntervals; ++j) {
                const double apart = mean.interval * kInterval[j];
                steady_[i].value[j] /= apart;
                steady_[i].rate[j] = 1.0 / apart;
            }
        }
    }

    // Add what a message is worth when it lasts for each interval, its `part` in the mean.
    void add_areas(std::int32_t at, double part, Steady& steady) const {
        const Message& m = window_.message[at];
        if (aggregation(m.stream) == Aggregation::once) return;
        const double age = t_rcv_[at] - m.t_gen;
        const double interval = mean_[m.stream].interval;
        const Integral integral(window_.utility[m.utility], age);
        const double whole = integral.to(age + interval * kLongest);
        for (std::size_t j = 0; j < kIntervals; ++j) {
            const bool lasts = aggregation(m.stream) == Aggregation::sum;
            const double area = (lasts ? whole : integral.to(age + interval * kInterval[j])) * scale_[at];
            steady.value[j] = std::fma(part, area, steady.value[j]);
        }
    }

    // Write the rent of a stream, and when what was received of it will have been replaced.
    void settle(const Steady& steady, double charge) {
        Mean& mean = mean_[steady.stream];
        mean.charge = charge;
        const auto [best, net] = steady.best(charge);
        const bool pays = net > kRounding * *std::max_element(steady.value.begin(), steady.value.end());
        beyond_.rent[steady.stream] = std::max(net, 0.0);
        if (pays) replace(steady.stream, 1.0 / steady.rate[best]);
    }

    // What was received of a stream will have been replaced in the midst of the pause after t_c.
    void replace(std::int32_t stream, double pause) {
        beyond_.until[stream] = std::max(window_.t_end, std::max(mean_[stream].coming, t_c_ + 0.5 * pause));
    }

    // What a message is worth beyond the window, as its aggregation has it.
    double worth(std::int32_t at) const {
        const Message& m = window_.message[at];
        const Mean& mean = mean_[m.stream];
        switch (aggregation(m.stream)) {
            case Aggregation::best:
                return 0.0;
            case Aggregation::sum:
            case Aggregation::once: {
                const double begin = std::max(t_rcv_[at], window_.t_end) - m.t_gen;
                return area(m, begin, begin + kLongest * mean.interval) * scale_[at];
            }
            case Aggregation::most_recent:
            case Aggregation::current:
                break;
        }
        if (t_rcv_[at] >= window_.t_end) return 0.0;
        const double begin = std::max(t_c_ - m.t_gen, 0.0);
        const double soonest = begin + std::max(mean.coming - t_c_, 0.0);
        const Integral integral(window_.utility[m.utility], begin);
        const double rent = beyond_.rent[m.stream];
        const double lost = excess_.finally_lost(at) * share_[m.stream];  // a second
        const auto earned_by = [&](double end) { return integral.to(end) * scale_[at] - lost * (end - begin); };
        double most = earned_by(soonest);
        bool finite = true;  // the greatest of numbers may be finite where one of them is not
        for (const double interval : kInterval) {
            const double later = mean.interval * interval;
            const double earned = earned_by(soonest + later) - rent * later;
            finite = finite && std::isfinite(earned);
            most = std::max(most, earned);
        }
        if (!finite) return std::numeric_limits<double>::quiet_NaN();
        return most - earned_by(std::max(window_.t_end - m.t_gen, begin));
    }

    // Of `once`: the first message takes the place of the one that would be sent after the window.
    void take_off_first(std::int32_t stream) {
        const Mean& mean = mean_[stream];
        if (aggregation(stream) != Aggregation::once || mean.count < 2) return;
        double whole = 0.0;
        for (std::int32_t at = 0; at < window_.messages(); ++at) {
            const Message& m = window_.message[at];
            if (m.sent || m.stream != stream) continue;
            const double age = t_rcv_[at] - m.t_gen;
            whole += area(m, age, age + kLongest * mean.interval) * scale_[at];
        }
        const double off = std::max(whole / mean.count - mean.charge, 0.0);
        for (std::int32_t at = 0; at < window_.messages(); ++at) {
            if (window_.message[at].stream == stream) beyond_.worth[at] -= off;
        }
    }

    // What the windows after the last decision charge for a message.
    void charge(std::int32_t at) {
        const std::size_t constraints = window_.constraint.size();
        const double sent = window_.message[at].t_sent;
        for (std::size_t k = 0; k < constraints; ++k) {
            const Constraint& constraint = window_.constraint[k];
            if (!(beyond_.price[k] > 0.0 && constraint.limit > 0.0)) continue;
            const double use = window_.use_of(at)[k];
            const double length = constraint.window * std::max(use / constraint.limit, 1.0);
            const double left = std::max(sent + length - t_last_, 0.0);
            const double charge = beyond_.price[k] * std::min(use, constraint.limit) * left / constraint.window;
            beyond_.charges[static_cast<std::size_t>(at) * constraints + k] = charge;
            beyond_.charge[at] += charge;
        }
    }

    const Window& window_;
    Excess excess_;
    std::vector<Mean> mean_;     // [stream]
    std::vector<double> t_rcv_;  // [message]: when its receivers get it in the mean
    std::vector<double> scale_;  // [message]: what all its receivers together multiply its utility by
    std::vector<double> share_;  // [stream]: all its receivers together
    std::vector<Steady> steady_;
    std::vector<double> use_;  // [steady * constraints + k]: the mean
    double t_c_ = 0.0;
    double t_last_ = 0.0;
    Beyond beyond_;
};

}  // namespace sendworthy
