// A problem as plain data: what planner/columns.py reads of planner/problem.py, and whether it has a meaning.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "utility.h"

namespace sendworthy {

enum class Aggregation : std::int8_t { most_recent, best, sum, once, current };

// Whether of the messages of a stream the one received last is all that counts.
inline bool is_markovian(Aggregation kind) { return kind == Aggregation::most_recent || kind == Aggregation::current; }

// When the newest sample of a stream was generated that is known, and its scale.
struct Latest {
    double t_gen;
    double scale;
};

struct Receiver {
    double delay;
    double share;
};

struct Stream {
    std::int64_t robot;
    Aggregation aggregation;
    std::int32_t receiver_start;  // up to the next stream's
    bool has_newest = false;
    Latest newest{};
};

struct Message {
    std::int32_t stream;
    std::int32_t utility;
    double t_gen;
    double t_sent;
    double t_rcv;
    double scale;
    bool sent;
};

struct Constraint {
    double window;
    double limit;
};

struct Window {
    std::vector<Stream> stream;  // one more than there are: the end of the receivers
    std::vector<Receiver> receiver;
    std::vector<Message> message;
    std::vector<Utility> utility;  // those that messages share are there once
    std::vector<Constraint> constraint;
    std::vector<double> use;  // [message * constraints + k]
    std::vector<double> traffic_sent;
    std::vector<double> traffic_use;  // [traffic * constraints + k]
    std::int64_t current = 0;
    double t_start = 0.0;
    double t_end = 0.0;
    bool goes_on = true;

    std::int32_t streams() const { return static_cast<std::int32_t>(stream.size()) - 1; }
    std::int32_t messages() const { return static_cast<std::int32_t>(message.size()); }
    std::int32_t constraints() const { return static_cast<std::int32_t>(constraint.size()); }
    const double* use_of(std::int32_t at) const {
        return use.data() + static_cast<std::size_t>(at) * constraint.size();
    }

    // Whether it has a meaning; planner/validation.py says what is wrong if not.
    bool valid() const {
        if (message.empty() || message.size() > kMaxMessages) return false;
        if (current < 0 || current >= messages() || message[static_cast<std::size_t>(current)].sent) return false;
        if (!(std::isfinite(t_start) && std::isfinite(t_end) && t_start < t_end)) return false;
        const auto limits = [](const Constraint& c) { return amount(c.window) && c.window > 0 && amount(c.limit); };
        const auto receives = [](const Receiver& r) { return amount(r.delay) && amount(r.share); };
        return std::all_of(constraint.begin(), constraint.end(), limits) &&
               std::all_of(receiver.begin(), receiver.end(), receives) &&
               std::all_of(stream.begin(), stream.end(), [](const Stream& s) { return newest_valid(s); }) &&
               std::all_of(use.begin(), use.end(), amount) &&
               std::all_of(traffic_use.begin(), traffic_use.end(), amount) &&
               std::all_of(traffic_sent.begin(), traffic_sent.end(), [](double t) { return std::isfinite(t); }) &&
               messages_valid() && receipts_valid();
    }

  private:
    static constexpr std::size_t kMaxMessages = 16'384;

    static bool amount(double value) { return std::isfinite(value) && value >= 0.0; }

    static bool newest_valid(const Stream& s) {
        return !s.has_newest || (std::isfinite(s.newest.t_gen) && amount(s.newest.scale));
    }

    bool messages_valid() const {
        for (std::size_t at = 0; at < message.size(); ++at) {
            const Message& m = message[at];
            if (m.stream < 0 || m.stream >= streams() || !amount(m.scale)) return false;
            if (!(std::isfinite(m.t_gen) && std::isfinite(m.t_rcv))) return false;
            if (!(m.t_gen <= m.t_sent && m.t_sent <= m.t_rcv)) return false;
            const bool current = stream[m.stream].aggregation == Aggregation::current;
            if (current && !std::isfinite(utility[m.utility].initial())) return false;
            if (at > 0 && before(m, message[at - 1])) return false;
        }
        return true;
    }

    // By t_gen, then robot, then stream.
    bool before(const Message& one, const Message& other) const {
        if (one.t_gen != other.t_gen) return one.t_gen < other.t_gen;
        const std::int64_t robot = stream[one.stream].robot;
        const std::int64_t other_robot = stream[other.stream].robot;
        return robot != other_robot ? robot < other_robot : one.stream < other.stream;
    }

    // Open messages are sent in order, and those of one stream received in order.
    bool receipts_valid() const {
        constexpr double kNever = -std::numeric_limits<double>::infinity();
        double sent = kNever;
        std::vector<double> received(stream.size(), kNever);
        for (const Message& m : message) {
            if (m.sent) continue;
            if (m.t_sent < sent || m.t_rcv < received[m.stream]) return false;
            sent = m.t_sent;
            received[m.stream] = m.t_rcv;
        }
        return true;
    }
};

}  // namespace sendworthy
