// What a unit of the constraints is worth: the default policy of `best` mode and a bound for every node.
//
//   worth(level, state) = max(worth(level + 1, state), gain - price + worth(level + 1, state after sending))
//   advantage           = the second term less the first
//
// The prices are sums of the multipliers of the rows; the subgradient method finds them (Lagrangian relaxation).
// The twin of planner/python_engine/prices.py, where the reasons are written out; sums run in the same order.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "path.h"
#include "tables.h"

namespace sendworthy {

class Prices {
  public:
    Prices(const Tables& tables, const Path& path)
        : tables_(tables),
          path_(path),
          multiplier_(tables.row.size(), 0.0),
          best_(tables.row.size(), 0.0),
          excess_(tables.row.size(), 0.0),
          price_(tables.levels, 0.0),
          sums_(tables.constraints, 0.0),
          change_(cells(), 0.0),
          used_(cells(), 0.0),
          state_(tables.streams, 0),
          worth_(tables.state_start[tables.streams], 0.0),
          advantage_(tables.gain.size(), 0.0),
          closing_start_(tables.levels + 1, 0) {
        closing_.reserve(tables.row.size());
        next_.reserve(tables.levels);
    }

    // What sending gains over dropping at the end of the path, net of prices.
    double advantage(std::int32_t level) const { return advantage_[path_.entry(level)]; }

    // What a decision takes off the bound: what it loses, and what it leaves unused.
    double loss(std::int32_t level, bool send) const {
        const double advantage = this->advantage(level);
        return (send ? std::max(0.0, -advantage) : std::max(0.0, advantage)) + left_unused(level, send);
    }

    // No plan is worth more than this.
    double bound() const { return bound_; }

    // What the rows that end with this level lose when `sent` is what the level itself uses.
    double left_unused(std::int32_t level, bool send) const {
        double loss = 0.0;
        const double* use = tables_.use_of(level);
        for (std::int32_t at = closing_start_[level]; at < closing_start_[level + 1]; ++at) {
            const Row& row = tables_.row[closing_[at]];
            const double sent = send ? use[row.of] : 0.0;
            const double used = path_.used(level)[row.of] + sent - path_.used(row.first)[row.of];
            loss += multiplier_[closing_[at]] * std::max(0.0, row.capacity - used);
        }
        return loss;
    }

    // What sending the message of a level is charged by each constraint, at the prices that bound best.
    std::vector<double> asked(std::int32_t level) const {
        std::vector<double> asked(tables_.constraints, 0.0);
        for (std::size_t at = 0; at < multiplier_.size(); ++at) {
            const Row& row = tables_.row[at];
            if (row.first <= level && level <= row.last) {
                asked[row.of] += best_[at] * tables_.share_of(level)[row.of];
            }
        }
        return asked;
    }

    // Whether another round may find a better bound.
    bool learning() const { return learning_; }

    // Begin a round: take the next prices, return the optimum of the relaxed problem.
    double relax() {
        double bound = solve();
        stale_ = bound < bound_ - kProgress * std::abs(bound) ? 0 : stale_ + 1;
        if (bound < bound_) {
            bound_ = bound;
            best_ = multiplier_;
        }
        if (stale_ > kPatience) {
            step_ *= kStepShrinks;
            stale_ = 0;
            multiplier_ = best_;
            bound = solve();
        }
        return bound;
    }

    // End a round that relaxed to `bound`, when the best plan so far has `reached` a value.
    void learn(double bound, double reached) {
        const double gap = bound - reached;
        round_ += 1;
        const bool closed = gap <= kClosedGap * std::abs(bound);
        if (closed || !move(step_ * gap) || round_ == kRounds) settle();
    }

  private:
    static constexpr int kRounds = 100;
    static constexpr double kFirstStep = 1.0;
    static constexpr double kStepShrinks = 0.7;
    static constexpr int kPatience = 4;
    static constexpr double kProgress = 1e-4;
    static constexpr double kClosedGap = 1e-9;

    // Keep the prices of the best bound.
    void settle() {
        learning_ = false;
        multiplier_ = best_;
        bound_ = solve();
        list_closing();
    }

    std::size_t cells() const { return static_cast<std::size_t>(tables_.levels + 1) * tables_.constraints; }

    // Solve the relaxed problem: write the advantages, return its optimum.
    double solve() {
        write_prices();
        std::fill(worth_.begin(), worth_.end(), 0.0);
        for (std::int32_t at = tables_.levels - 1; at >= 0; --at) {
            const Level& level = tables_.level[at];
            double* __restrict worth = worth_.data() + tables_.state_start[level.stream];
            const double* __restrict gain = tables_.gain.data() + level.gain_start;
            const std::int32_t* after = tables_.after.data() + level.gain_start;
            double* __restrict advantage = advantage_.data() + level.gain_start;
            const std::int32_t width = tables_.level[at + 1].gain_start - level.gain_start;
            if (tables_.markovian[level.stream]) {  // whatever was sent before, sending leads to one state
                const double sent = worth[after[0]] - price_[at];
                for (std::int32_t state = 0; state < width; ++state) {
                    const double more = gain[state] + sent - worth[state];
                    advantage[state] = more;
                    worth[state] = std::max(worth[state], worth[state] + more);
                }
                continue;
            }
            for (std::int32_t state = 0; state < width; ++state) {
                advantage[state] = gain[state] + (worth[after[state]] - price_[at]) - worth[state];
            }
            for (std::int32_t state = 0; state < width; ++state) {
                worth[state] = std::max(worth[state], worth[state] + advantage[state]);
            }
        }
        double bound = tables_.facts;
        for (std::size_t at = 0; at < multiplier_.size(); ++at) bound += multiplier_[at] * tables_.row[at].capacity;
        for (std::int32_t at = 0; at < tables_.streams; ++at) bound += worth_[tables_.state_start[at]];
        return bound;
    }

    // What sending each level is charged; no price is high enough for what never fits.
    void write_prices() {
        const std::int32_t constraints = tables_.constraints;
        std::fill(change_.begin(), change_.end(), 0.0);
        for (std::size_t at = 0; at < multiplier_.size(); ++at) {
            const Row& row = tables_.row[at];
            change_[static_cast<std::size_t>(row.first) * constraints + row.of] += multiplier_[at];
            change_[static_cast<std::size_t>(row.last + 1) * constraints + row.of] -= multiplier_[at];
        }
        std::fill(sums_.begin(), sums_.end(), 0.0);
        for (std::int32_t at = 0; at < tables_.levels; ++at) {
            double price = tables_.level[at].never ? std::numeric_limits<double>::infinity() : 0.0;
            const double* share = tables_.share_of(at);
            for (std::int32_t k = 0; k < constraints; ++k) {
                sums_[k] += change_[static_cast<std::size_t>(at) * constraints + k];
                price += sums_[k] * share[k];
            }
            price_[at] = price;
        }
    }

    // Move the multipliers by `length` along the subgradient; return whether there is any way to go.
    bool move(double length) {
        write_excess();
        double norm = 0.0;
        for (std::size_t at = 0; at < excess_.size(); ++at) {
            if (multiplier_[at] > 0.0 || excess_[at] > 0.0) norm += excess_[at] * excess_[at];
        }
        if (norm <= 0.0) return false;
        for (std::size_t at = 0; at < excess_.size(); ++at) {
            multiplier_[at] = std::max(0.0, multiplier_[at] + length / norm * excess_[at]);
        }
        return true;
    }

    // The subgradient: what the relaxed plan uses of each row beyond its capacity.
    void write_excess() {
        const std::int32_t constraints = tables_.constraints;
        std::fill(state_.begin(), state_.end(), 0);
        for (std::int32_t at = 0; at < tables_.levels; ++at) {
            const Level& level = tables_.level[at];
            const std::int32_t entry = level.gain_start + state_[level.stream];
            const bool send = advantage_[entry] > 0.0;
            if (send) state_[level.stream] = tables_.after[entry];
            const double* share = tables_.share_of(at);
            const double* before = used_.data() + static_cast<std::size_t>(at) * constraints;
            double* after = used_.data() + static_cast<std::size_t>(at + 1) * constraints;
            for (std::int32_t k = 0; k < constraints; ++k) after[k] = send ? before[k] + share[k] : before[k];
        }
        for (std::size_t at = 0; at < excess_.size(); ++at) {
            const Row& row = tables_.row[at];
            const double until = used_[static_cast<std::size_t>(row.last + 1) * constraints + row.of];
            excess_[at] = until - used_[static_cast<std::size_t>(row.first) * constraints + row.of] - row.capacity;
        }
    }

    // The rows with a price, by their last level, in their own order among equals.
    void list_closing() {
        for (std::size_t at = 0; at < multiplier_.size(); ++at) {
            if (multiplier_[at] > 0.0) closing_start_[tables_.row[at].last + 1] += 1;
        }
        for (std::int32_t at = 0; at < tables_.levels; ++at) closing_start_[at + 1] += closing_start_[at];
        closing_.assign(closing_start_[tables_.levels], 0);
        next_.assign(closing_start_.begin(), closing_start_.end() - 1);
        for (std::size_t at = 0; at < multiplier_.size(); ++at) {
            if (multiplier_[at] > 0.0) closing_[next_[tables_.row[at].last]++] = static_cast<std::int32_t>(at);
        }
    }

    const Tables& tables_;
    const Path& path_;
    std::vector<double> multiplier_;
    std::vector<double> best_;
    std::vector<double> excess_;
    std::vector<double> price_;
    std::vector<double> sums_;
    std::vector<double> change_;
    std::vector<double> used_;
    std::vector<std::int32_t> state_;
    std::vector<double> worth_;  // by stream and state
    std::vector<double> advantage_;
    std::vector<std::int32_t> closing_start_;
    std::vector<std::int32_t> closing_;
    std::vector<std::int32_t> next_;  // where the next row of each level goes
    double bound_ = std::numeric_limits<double>::infinity();
    double step_ = kFirstStep;
    int stale_ = 0;
    int round_ = 0;
    bool learning_ = true;
};

}  // namespace sendworthy
