// What sending each open message adds, by level and state of its stream, aggregation by aggregation.
// The twin of planner/evaluation.py and planner/aggregations/.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "beyond.h"
#include "envelopes.h"
#include "receipts.h"
#include "window.h"

namespace sendworthy {

// As Gains of planner/evaluation.py.
struct Gains {
    std::vector<std::int32_t> message;    // [level]
    std::vector<std::int32_t> stream;     // [level]: among the streams that have open messages
    std::vector<std::int32_t> start;      // [level]: the first entry; one more than levels
    std::vector<std::int32_t> after;      // [entry]
    std::vector<double> gain;             // [entry]
    std::vector<double> aim;              // [entry]
    std::vector<char> markovian;          // [stream]
    double facts = 0.0;
    double everything = 0.0;
    double aim_facts = 0.0;
    bool exact = true;

    bool finite() const {
        const auto all = [](const std::vector<double>& values) {
            return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
        };
        return all(gain) && all(aim) && std::isfinite(facts) && std::isfinite(everything) && std::isfinite(aim_facts);
    }
};

class TabulateGains {
  public:
    // To maximise U, or what is left beyond the window, too.
    TabulateGains(const Window& window, const Beyond* beyond)
        : window_(window),
          receipts_(window),
          beyond_(beyond),
          begin_(window.messages(), 0),
          states_(window.messages(), 0) {}

    // Tabulate all; false when there are too many.
    bool tabulate(Gains& gains) {
        for (std::int32_t stream = 0; stream < window_.streams(); ++stream) {
            if (receipts_.count(stream) == 0) continue;
            switch (window_.stream[stream].aggregation) {
                case Aggregation::most_recent:
                case Aggregation::current:
                    if (!most_recent(stream, gains)) return false;
                    break;
                case Aggregation::sum:
                    sum(stream, gains);
                    break;
                case Aggregation::once:
                    once(stream, gains);
                    break;
                case Aggregation::best:
                    if (!best(stream, gains)) return false;
                    break;
            }
        }
        order_by_level(gains);
        return true;
    }

  private:
    static constexpr std::size_t kMaxGains = 4'000'000;
    static constexpr std::int32_t kNobody = -1;

    struct Entry {
        double gain;
        double aim;
        std::int32_t after;
    };

    const Message& message(std::int32_t at) const { return window_.message[at]; }
    double beyond(std::int32_t at) const { return beyond_ == nullptr || at == kNobody ? 0.0 : beyond_->worth[at]; }
    double receipt(std::int32_t at) const { return at == kNobody ? kForever : message(at).t_rcv; }

    void open(std::int32_t at, std::int32_t states) {
        begin_[at] = static_cast<std::int32_t>(entries_.size());
        states_[at] = states;
    }

    // The first fact after each message of a stream, by its place in the order of receipt.
    void find_facts_after(std::int32_t stream) {
        fact_after_.assign(receipts_.count(stream), kNobody);
        for (std::int32_t place = receipts_.count(stream) - 1; place > 0; --place) {
            const std::int32_t at = receipts_.begin(stream)[place];
            fact_after_[place - 1] = message(at).sent ? at : fact_after_[place];
        }
    }

    // A message adds its own utility and takes that of the one before, from its receipt on. The state is 0, or 1 + the
    // number of the open message sent last.
    bool most_recent(std::int32_t stream, Gains& gains) {
        find_facts_after(stream);
        const std::int32_t* order = receipts_.begin(stream);
        const std::int32_t count = receipts_.count(stream);
        std::int32_t fact = kNobody;  // the last one before
        std::int32_t fact_place = kNobody;
        opened_.clear();  // places
        for (std::int32_t place = 0; place < count; ++place) {
            const std::int32_t at = order[place];
            const std::int32_t after = fact_after_[place];
            const double begin = message(at).t_rcv;
            gains.everything += receipts_.unspoilt(at, begin, receipt(place + 1 < count ? order[place + 1] : kNobody));
            if (message(at).sent) {
                const double worth = receipts_.worth(at, begin, receipt(after));
                gains.facts += worth;
                gains.aim_facts += worth + (after == kNobody ? beyond(at) : 0.0);
                fact = at;
                fact_place = place;
                continue;
            }
            const auto states = static_cast<std::int32_t>(opened_.size()) + 1;
            if (entries_.size() + static_cast<std::size_t>(states) > kMaxGains) return false;
            open(at, states);
            const double own = receipts_.worth(at, begin, receipt(after));
            const Entry first = replacing(at, fact, after, own, states);
            for (std::int32_t state = 0; state < states; ++state) {
                const bool older = state == 0 || opened_[state - 1] < fact_place;
                entries_.push_back(older ? first : replacing(at, order[opened_[state - 1]], after, own, states));
            }
            opened_.push_back(place);
        }
        return true;
    }

    Entry replacing(std::int32_t at, std::int32_t before, std::int32_t after, double own, std::int32_t state) const {
        const double lost = before == kNobody ? 0.0 : receipts_.worth(before, message(at).t_rcv, receipt(after));
        const double gain = own - lost;
        return {gain, gain + (after == kNobody ? beyond(at) - beyond(before) : 0.0), state};
    }

    // Every message counts, whatever else was received: one state.
    void sum(std::int32_t stream, Gains& gains) {
        for (const std::int32_t* at = receipts_.begin(stream); at != receipts_.end(stream); ++at) {
            const double worth = receipts_.worth(*at, message(*at).t_rcv, kForever);
            gains.everything += worth;
            if (message(*at).sent) {
                gains.facts += worth;
                gains.aim_facts += worth + beyond(*at);
                continue;
            }
            open(*at, 1);
            entries_.push_back({worth, worth + beyond(*at), 0});
        }
    }

    // The first message adds its own utility, less that of a fact received later. The state is whether any open one
    // was sent.
    void once(std::int32_t stream, Gains& gains) {
        find_facts_after(stream);
        const auto whole = [this](std::int32_t at) {
            return at == kNobody ? 0.0 : receipts_.worth(at, message(at).t_rcv, kForever);
        };
        bool known = false;  // whether a fact came before
        bool first = true;
        for (std::int32_t place = 0; place < receipts_.count(stream); ++place) {
            const std::int32_t at = receipts_.begin(stream)[place];
            if (place == 0) gains.everything += whole(at);
            if (message(at).sent) {
                gains.facts += known ? 0.0 : whole(at);
                gains.aim_facts += known ? 0.0 : whole(at) + beyond(at);
                known = true;
                continue;
            }
            open(at, first ? 1 : 2);
            const double gain = known ? 0.0 : whole(at) - whole(fact_after_[place]);
            const double left = known ? 0.0 : beyond(at) - beyond(fact_after_[place]);
            entries_.push_back({gain, gain + left, 1});
            if (!first) entries_.push_back({0.0, 0.0, 1});
            first = false;
        }
    }

    bool best(std::int32_t stream, Gains& gains) {
        Envelopes envelopes(receipts_, stream, beyond_ == nullptr ? window_.t_end : beyond_->until[stream]);
        if (!envelopes.fits()) return false;
        gains.facts += envelopes.facts();
        gains.aim_facts += envelopes.aim_facts();
        gains.everything += envelopes.everything();
        envelopes.follow(
            [this](std::int32_t at, std::int32_t states) { open(at, states); },
            [this](double gain, double aim, std::int32_t after) { entries_.push_back({gain, aim, after}); });
        gains.exact = gains.exact && envelopes.exact();
        return true;
    }

    // Put the entries in the order of the levels, and take off the charges.
    void order_by_level(Gains& gains) {
        std::vector<std::int32_t> number(window_.stream.size(), 0);
        for (std::int32_t at = 0; at < window_.messages(); ++at) {
            if (message(at).sent) continue;
            gains.message.push_back(at);
            number[message(at).stream] = 1;
        }
        std::int32_t streams = 0;
        for (std::int32_t stream = 0; stream < window_.streams(); ++stream) {
            if (number[stream] == 0) continue;
            number[stream] = streams++;
            gains.markovian.push_back(is_markovian(window_.stream[stream].aggregation));
        }
        gains.after.reserve(entries_.size());
        gains.gain.reserve(entries_.size());
        gains.aim.reserve(entries_.size());
        for (const std::int32_t at : gains.message) {
            gains.stream.push_back(number[message(at).stream]);
            gains.start.push_back(static_cast<std::int32_t>(gains.gain.size()));
            const double charge = beyond_ == nullptr ? 0.0 : beyond_->charge[at];
            for (std::int32_t entry = begin_[at]; entry < begin_[at] + states_[at]; ++entry) {
                gains.after.push_back(entries_[entry].after);
                gains.gain.push_back(entries_[entry].gain);
                gains.aim.push_back(entries_[entry].aim - charge);
            }
        }
        gains.start.push_back(static_cast<std::int32_t>(gains.gain.size()));
    }

    const Window& window_;
    Receipts receipts_;
    const Beyond* beyond_;
    std::vector<Entry> entries_;          // stream by stream
    std::vector<std::int32_t> begin_;     // [message]: its first entry
    std::vector<std::int32_t> states_;    // [message]
    std::vector<std::int32_t> fact_after_;
    std::vector<std::int32_t> opened_;
};

}  // namespace sendworthy
