// Constraints as checks: what must hold for sending the message of each level.
// The twin of planner/constraints.py, where the reasons are written out.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "tables.h"
#include "window.h"

namespace sendworthy {

// As Checks of planner/constraints.py.
struct Checks {
    std::int32_t columns = 0;              // the constraints, and the exclusions
    std::vector<double> use;               // [level * columns + k]
    std::vector<double> share;             // the same, but at most the limit
    std::vector<std::int32_t> start;       // [level]; one more than levels
    std::vector<Check> check;
    std::vector<std::int32_t> held;        // [depth]
    std::vector<char> never;               // [level]
    std::vector<Row> row;
    std::vector<std::int32_t> constraint;  // [column]
};

class TabulateChecks {
  public:
    TabulateChecks(const Window& window, const std::vector<std::int32_t>& opened)
        : window_(window), levels_(static_cast<std::int32_t>(opened.size())), constraints_(window.constraints()) {
        for (const std::int32_t at : opened) {
            times_.push_back(window.message[at].t_sent);
            for (std::int32_t k = 0; k < constraints_; ++k) {
                use_.push_back(window.use_of(at)[k]);
                share_.push_back(std::min(use_.back(), window.constraint[k].limit));
            }
        }
    }

    Checks tabulate() {
        for (std::int32_t k = 0; k < constraints_; ++k) {
            find_fixed(k);
            find_own_windows(k);
            find_later_windows(k);
        }
        assemble();
        for (std::int32_t k = 0; k < constraints_; ++k) find_exclusions(k);
        exclude();
        return std::move(checks_);
    }

  private:
    static constexpr double kClosed = 1e-9;
    static constexpr double kSlack = 1e-9;
    static constexpr double kStretched = 16.0;
    static constexpr std::size_t kMostExclusions = 16;

    // What is sent whatever the search decides.
    struct Fixed {
        double time;
        double use;
        bool operator<(const Fixed& other) const { return std::tie(time, use) < std::tie(other.time, other.use); }
    };
    struct Found {
        std::int32_t level;
        Check check;
        bool always;  // it binds even if its level is dropped
    };
    struct Exclusion {
        std::int32_t of;
        Row row;
        std::vector<double> column;  // [level]
    };

    double use(std::int32_t level, std::int32_t k) const {
        return use_[static_cast<std::size_t>(level) * constraints_ + k];
    }
    double share(std::int32_t level, std::int32_t k) const {
        return share_[static_cast<std::size_t>(level) * constraints_ + k];
    }

    // Length and capacity of a window that ends with a message of this use; longer for an oversized one.
    std::pair<double, double> stretched(const Constraint& constraint, double use) const {
        const double most = std::max(use, constraint.limit);
        const double factor = constraint.limit > 0.0 ? most / constraint.limit : 1.0;
        return {constraint.window * factor + kClosed, (constraint.limit > 0.0 ? most : 0.0) * (1.0 + kSlack)};
    }

    void find_fixed(std::int32_t k) {
        fixed_.clear();
        for (std::int32_t at = 0; at < window_.messages(); ++at) {
            if (window_.message[at].sent) add_fixed(window_.message[at].t_sent, window_.use_of(at)[k]);
        }
        for (std::size_t at = 0; at < window_.traffic_sent.size(); ++at) {
            add_fixed(window_.traffic_sent[at], window_.traffic_use[at * constraints_ + k]);
        }
        std::sort(fixed_.begin(), fixed_.end());
        total_.assign(1, 0.0);
        for (const Fixed& fixed : fixed_) total_.push_back(total_.back() + fixed.use);
    }

    void add_fixed(double time, double use) {
        if (use > 0.0) fixed_.push_back({time, use});
    }

    // What is used in the closed interval.
    double within(double begin, double end) const {
        const auto earlier = [](const Fixed& fixed, double time) { return fixed.time < time; };
        const auto later = [](double time, const Fixed& fixed) { return time < fixed.time; };
        const auto last = std::upper_bound(fixed_.begin(), fixed_.end(), end, later) - fixed_.begin();
        const auto first = std::lower_bound(fixed_.begin(), fixed_.end(), begin, earlier) - fixed_.begin();
        return total_[static_cast<std::size_t>(last)] - total_[static_cast<std::size_t>(first)];
    }

    std::int32_t first_since(double time) const {
        return static_cast<std::int32_t>(std::lower_bound(times_.begin(), times_.end(), time) - times_.begin());
    }

    // The window that ends with each open message.
    void find_own_windows(std::int32_t k) {
        const Constraint& constraint = window_.constraint[k];
        for (std::int32_t level = 0; level < levels_; ++level) {
            const double use = this->use(level, k);
            if (!(use > 0.0)) continue;
            const auto [length, capacity] = stretched(constraint, use);
            const double begin = times_[level] - length;
            const double room = capacity - within(begin, times_[level]) - use;
            found_.push_back({level, {k, first_since(begin), room}, use <= constraint.limit});
        }
    }

    // The windows that hold open messages and end with something sent later, whatever is decided. Left out are those
    // that an earlier one of the message implies: it reaches farther, with less spare.
    void find_later_windows(std::int32_t k) {
        struct Ending {
            double begin;
            double time;
            double spare;
            bool oversized;
        };
        const Constraint& constraint = window_.constraint[k];
        std::vector<Ending> ending;
        for (const Fixed& fixed : fixed_) {
            if (fixed.time < times_.front()) continue;
            const auto [length, capacity] = stretched(constraint, fixed.use);
            const double begin = fixed.time - length;
            ending.push_back({begin, fixed.time, capacity - within(begin, fixed.time), fixed.use > constraint.limit});
        }
        for (std::int32_t level = 0; level < levels_; ++level) {
            if (!(use(level, k) > 0.0)) continue;
            double least = std::numeric_limits<double>::infinity();
            for (const Ending& each : ending) {
                if (!(each.begin <= times_[level] && times_[level] <= each.time)) continue;
                if (each.spare < least || each.oversized) {
                    found_.push_back({level, {k, first_since(each.begin), each.spare - use(level, k)}, true});
                }
                least = std::min(least, each.spare);
            }
        }
    }

    // Order the checks by level, those found first of a level first.
    void assemble() {
        const auto by_level = [](const Found& one, const Found& other) { return one.level < other.level; };
        std::stable_sort(found_.begin(), found_.end(), by_level);
        checks_.held.resize(static_cast<std::size_t>(levels_) + 1);
        std::iota(checks_.held.begin(), checks_.held.end(), 0);
        checks_.never.assign(static_cast<std::size_t>(levels_), 0);
        checks_.start.assign(static_cast<std::size_t>(levels_) + 1, 0);
        for (const Found& found : found_) {
            checks_.check.push_back(found.check);
            checks_.start[static_cast<std::size_t>(found.level) + 1] += 1;
            checks_.held[found.level] = std::min(checks_.held[found.level], found.check.first);
            if (found.check.room < 0.0) checks_.never[found.level] = 1;
            if (!found.always || found.check.room < 0.0) continue;
            const Check& check = found.check;
            checks_.row.push_back({check.of, check.first, found.level, check.room + use(found.level, check.of)});
        }
        std::partial_sum(checks_.start.begin(), checks_.start.end(), checks_.start.begin());
        for (std::int32_t level = levels_ - 1; level >= 0; --level) {
            checks_.held[level] = std::min(checks_.held[level], checks_.held[level + 1]);
        }
        keep_binding();
    }

    // Leave out the rows that cannot bind, and those that a longer one of the same begin implies.
    void keep_binding() {
        std::vector<Row>& rows = checks_.row;
        std::stable_sort(rows.begin(), rows.end(), [](const Row& one, const Row& other) {
            return std::tie(one.of, one.first, one.last) < std::tie(other.of, other.first, other.last);
        });
        std::vector<double> total(static_cast<std::size_t>(levels_ + 1) * constraints_, 0.0);
        for (std::size_t at = 0; at < share_.size(); ++at) total[at + constraints_] = total[at] + share_[at];
        const auto up_to = [&](std::int32_t level, std::int32_t k) {
            return total[static_cast<std::size_t>(level) * constraints_ + k];
        };
        std::size_t kept = 0;
        for (std::size_t at = 0; at < rows.size(); ++at) {
            const Row row = rows[at];
            const bool longer = at + 1 < rows.size() && rows[at + 1].of == row.of && rows[at + 1].first == row.first;
            const bool implied = longer && rows[at + 1].capacity <= row.capacity;
            if (!implied && up_to(row.last + 1, row.of) - up_to(row.first, row.of) > row.capacity) rows[kept++] = row;
        }
        rows.resize(kept);
    }

    // For each oversized message that may be sent at all, what cannot be sent beside it.
    void find_exclusions(std::int32_t k) {
        const Constraint& constraint = window_.constraint[k];
        for (std::int32_t level = 0; level < levels_ && exclusions_.size() < kMostExclusions; ++level) {
            const double use = this->use(level, k);
            if (!(use > constraint.limit && use <= kStretched * constraint.limit) || checks_.never[level]) continue;
            const double end = times_[level] + constraint.window;
            const std::int32_t first = first_since(times_[level] - stretched(constraint, use).first);
            const auto after = std::upper_bound(times_.begin(), times_.end(), end) - times_.begin();
            const auto last = static_cast<std::int32_t>(after) - 1;
            std::vector<double> column(levels_, 0.0);
            double sum = 0.0;
            for (std::int32_t at = first; at <= last; ++at) {
                if (at == level) continue;
                column[at] = share(at, k);
                sum += column[at];
            }
            if (!(sum > 0.0)) continue;
            column[level] = sum;
            const std::int32_t of = constraints_ + static_cast<std::int32_t>(exclusions_.size());
            exclusions_.push_back({k, {of, first, last, sum}, std::move(column)});
        }
    }

    // Add a row for every exclusion: either the oversized message is sent, or any of the others.
    void exclude() {
        checks_.columns = constraints_ + static_cast<std::int32_t>(exclusions_.size());
        for (std::int32_t k = 0; k < constraints_; ++k) checks_.constraint.push_back(k);
        for (const Exclusion& each : exclusions_) {
            checks_.constraint.push_back(each.of);
            checks_.row.push_back(each.row);
        }
        for (std::int32_t level = 0; level < levels_; ++level) {
            for (std::int32_t k = 0; k < constraints_; ++k) {
                checks_.use.push_back(use(level, k));
                checks_.share.push_back(share(level, k));
            }
            for (const Exclusion& each : exclusions_) {
                checks_.use.push_back(each.column[level]);
                checks_.share.push_back(each.column[level]);
            }
        }
    }

    const Window& window_;
    std::int32_t levels_;
    std::int32_t constraints_;
    std::vector<double> times_;  // [level]
    std::vector<double> use_;    // [level * constraints + k]
    std::vector<double> share_;
    std::vector<Fixed> fixed_;   // of the constraint at hand, by time
    std::vector<double> total_;  // [j]: the use of the first j
    std::vector<Found> found_;
    std::vector<Exclusion> exclusions_;
    Checks checks_;
};

}  // namespace sendworthy
