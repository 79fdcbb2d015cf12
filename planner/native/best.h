// The default search: it completes every leaf by a good policy and knows what it can still gain.
//
//   first:  learn prices (prices.h), a round and a whole plan an iteration; complete both decisions about the current
//           message by the first policy and by the last
//   then:   sweep down the window once, a level an iteration (sweep.h)
//   repeat: simulate from the root; from then on walk down by the greatest promise to a decision that was not tried,
//           take it, simulate
//   simulate: go on by the policy, adding every node passed, each with the bound of the decision not taken, until
//           the plan is whole, a tantamount node is as good, or the bound does not exceed the best plan;
//           then renew the promises of the path
//   answer: the best plan found, by U and what it leaves behind at the end of the window (planner/beyond.py)
//
// The twin of planner/python_engine/best.py, where the reasons are written out.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "answer.h"
#include "path.h"
#include "prices.h"
#include "states.h"
#include "sweep.h"
#include "tree.h"

namespace sendworthy {

constexpr double kNothing = -std::numeric_limits<double>::infinity();

struct BestNode {
    double value;    // of the decisions down to it, the rest dropped
    double bound;    // no plan below exceeds it
    double untried;  // nor this, by taking the `other` decision; kNothing when it was taken or need not be
    double promise;  // the greatest `untried` of the node and all below it
    std::int32_t parent;
    std::int32_t child[2];  // drop, send
    std::int32_t level;
    bool send;
    bool other;
    bool alive;
};

class BestSearch {
  public:
    BestSearch(Tables tables, std::int32_t max_nodes)
        : tables_(std::move(tables)),
          path_(tables_),
          states_(tables_, NodeState::streams_and_windows),
          prices_(tables_, path_),
          sweep_(tables_, path_, states_, prices_),
          capacity_(max_nodes),
          nodes_(new BestNode[max_nodes]),
          tantamount_(max_nodes) {
        for (Plan& plan : best_) plan.sends.reserve(tables_.levels);
    }
    BestSearch(const BestSearch&) = delete;
    BestSearch& operator=(const BestSearch&) = delete;

    bool done() const { return done_; }
    std::int64_t iterations() const { return iterations_; }
    std::int32_t size() const { return size_; }
    const BestNode& node(std::int32_t at) const { return nodes_[at]; }

    std::int64_t run(std::int64_t iterations) {
        std::int64_t ran = 0;
        for (; ran < iterations && !done_; ++ran) iterate();
        iterations_ += ran;
        return ran;
    }

    Found found() const {
        const bool send = best_[1].value > best_[0].value;
        Found result{best_[send].sends, std::nullopt, bound(), prices_.asked(tables_.current), size_};
        if (best_[!send].value != kNothing) result.opposite = best_[!send].sends;
        return result;
    }

  private:
    struct Plan {
        double value = kNothing;
        std::vector<std::int32_t> sends;  // levels
    };

    void iterate() {
        if (prices_.learning()) {
            learn();
            return;
        }
        if (!sweep_.done()) {
            go_down();
            return;
        }
        if (size_ > 0) {
            back_up(try_most_promising());
        } else {
            reset();
            back_up(simulate(create(kNone, false, tables_.facts, prices_.bound())));
        }
        done_ = full() || nodes_[0].promise <= beaten();
    }

    double bound() const {
        if (proven_) return incumbent();
        return size_ == 0 || full() ? prices_.bound() : std::max(nodes_[0].promise, incumbent());
    }

    bool full() const { return size_ >= capacity_; }

    void reset() {
        path_.reset();
        states_.reset();
    }

    void learn() {
        const bool first = incumbent() == kNothing;
        const double bound = prices_.relax();
        prices_.learn(bound, roll_out(std::nullopt));
        if (!first && prices_.learning()) return;
        roll_out(false);
        roll_out(true);
        if (best_[1].value == kNothing) roll_out(true, true);
        done_ = proven_ = !prices_.learning() && prices_.bound() <= beaten();
    }

    // Sweep one level on; at the end keep the best plans, proven where nothing was left out.
    void go_down() {
        sweep_.descend([this](double bound) { return bound > beaten(); });
        if (!sweep_.done()) return;
        sweep_.visit([this](double value, const std::vector<std::int32_t>& sends) {
            keep(value, sends.data(), sends.data() + sends.size());
        });
        done_ = proven_ = sweep_.whole();
    }

    // Follow the policy, with the current decision forced or not, and with nothing sent before it when `clear`; return
    // the best value so far.
    double roll_out(std::optional<bool> forced, bool clear = false) {
        path_.reset();
        double value = tables_.facts;
        for (std::int32_t level = 0; level < tables_.levels; ++level) {
            bool wanted = prices_.advantage(level) > 0.0;
            if (level == tables_.current && forced) {
                wanted = *forced;
            } else if (clear && level < tables_.current) {
                wanted = false;
            }
            const bool send = wanted && path_.fits(level);
            value += send ? path_.gain(level) : 0.0;
            path_.step(level, send);
        }
        keep(value);
        return incumbent();
    }

    // Keep the plan of the path when it is the best of its decision; the first of equals stays.
    void keep(double value) { keep(value, path_.sends(), path_.sends() + path_.send_count()); }

    void keep(double value, const std::int32_t* begin, const std::int32_t* end) {
        Plan& plan = best_[std::find(begin, end, tables_.current) != end];
        if (value > plan.value) {
            plan.value = value;
            plan.sends.assign(begin, end);
        }
    }

    double incumbent() const { return std::max(best_[0].value, best_[1].value); }

    // The bound up to which nothing is worth a try.
    double beaten() const {
        const double best = incumbent();
        return best + 1e-9 * std::abs(best);
    }

    std::int32_t try_most_promising() {
        std::int32_t at = 0;
        reset();
        while (true) {
            const BestNode& node = nodes_[at];
            const double drop = promise(node.child[0]);
            const double send = promise(node.child[1]);
            if (node.untried > std::max(drop, send)) return take_other(at);
            const bool side = send > drop;
            path_.step(node.level, side);
            states_.step(node.level, side);
            at = node.child[side];
        }
    }

    double promise(std::int32_t at) const { return at == kNone ? kNothing : nodes_[at].promise; }

    std::int32_t take_other(std::int32_t at) {
        const double bound = std::exchange(nodes_[at].untried, kNothing);
        const std::int32_t child = step(at, nodes_[at].other, bound);
        return child == kNone ? at : simulate(child);
    }

    std::int32_t simulate(std::int32_t at) {
        while (nodes_[at].level < tables_.levels) {
            if (full()) return at;
            BestNode& node = nodes_[at];
            const bool fits = path_.fits(node.level);
            const bool send = fits && prices_.advantage(node.level) > 0.0;
            if (fits) {
                const double other = node.bound - prices_.loss(node.level, !send);
                if (other > beaten()) {
                    node.untried = other;
                    node.other = !send;
                }
            }
            const double bound = node.bound - prices_.loss(node.level, send);
            const std::int32_t child = bound > beaten() ? step(at, send, bound) : kNone;
            if (child == kNone) return at;
            at = child;
        }
        keep(nodes_[at].value);
        return at;
    }

    // Go on to a new child of the node where the path ends; kNone when a tantamount node is as good.
    std::int32_t step(std::int32_t parent, bool send, double bound) {
        const std::int32_t level = nodes_[parent].level;
        const double value = nodes_[parent].value + (send ? path_.gain(level) : 0.0);
        std::int32_t& rival = tantamount_.find(states_.after(level, send));
        if (rival != 0) {
            if (nodes_[rival - 1].value >= value) return kNone;
            remove(rival - 1);
        }
        path_.step(level, send);
        states_.step(level, send);
        const std::int32_t child = create(parent, send, value, bound);
        rival = child + 1;
        return child;
    }

    void remove(std::int32_t at) {
        const std::int32_t parent = nodes_[at].parent;
        if (parent != kNone) {
            nodes_[parent].child[nodes_[at].send] = kNone;
            back_up(parent);
        }
        nodes_[at].alive = false;
    }

    std::int32_t create(std::int32_t parent, bool send, double value, double bound) {
        const std::int32_t level = parent == kNone ? 0 : nodes_[parent].level + 1;
        nodes_[size_] = BestNode{value, bound, kNothing, kNothing, parent, {kNone, kNone}, level, send, false, true};
        if (parent != kNone) nodes_[parent].child[send] = size_;
        return size_++;
    }

    // Renew the promises of a node and all its ancestors.
    void back_up(std::int32_t at) {
        for (; at != kNone; at = nodes_[at].parent) {
            BestNode& node = nodes_[at];
            node.promise = std::max({node.untried, promise(node.child[0]), promise(node.child[1])});
        }
    }

    Tables tables_;
    Path path_;
    StateTracker states_;
    Prices prices_;
    Sweep sweep_;
    std::int32_t capacity_;
    std::unique_ptr<BestNode[]> nodes_;
    States tantamount_;
    Plan best_[2];  // by the decision about the current message
    std::int32_t size_ = 0;
    std::int64_t iterations_ = 0;
    bool proven_ = false;
    bool done_ = false;
};

}  // namespace sendworthy
