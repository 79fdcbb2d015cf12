// The paper's search (3.1), exactly as planner/python_engine/paper.py states it:
//
//   repeat: walk down from the root to a node without children, each time to the child with the greatest
//               UCT = sum / visits + c * sqrt(ln(visits of the parent) / visits)          (Eq. 3)
//           (an unvisited child counts as infinite, drop comes first, the first of equals wins);
//           unless it is terminal give it a drop child, and a send child when no constraint is broken (Eq. 5);
//           add its score S = U / (psi * U(M)) (Eq. 2) and one visit to it and all its ancestors.
//   answer: the path of most visits, down to the level of the current message; drop when it does not get there.
//
// The twin of planner/python_engine/paper.py.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "answer.h"
#include "path.h"
#include "prices.h"
#include "reduction.h"
#include "tree.h"

namespace sendworthy {

// ln of small counts, from the same function as the larger ones.
inline double log_of(std::int32_t count) {
    static const auto table = [] {
        std::array<double, 4096> logs{};
        for (std::size_t at = 1; at < logs.size(); ++at) logs[at] = std::log(static_cast<double>(at));
        return logs;
    }();
    return count < static_cast<std::int32_t>(table.size()) ? table[count] : std::log(static_cast<double>(count));
}

class PaperSearch {
  public:
    PaperSearch(Tables tables, double exploration, ReductionKind reduction, std::int32_t max_nodes)
        : tables_(std::move(tables)),
          exploration_(exploration),
          reduced_(reduction != ReductionKind::off),
          tree_(max_nodes),
          path_(tables_),
          reduction_(tables_, tree_, path_, reduction) {
        tree_.create(kNone, 0, false, tables_.facts);
    }
    PaperSearch(const PaperSearch&) = delete;
    PaperSearch& operator=(const PaperSearch&) = delete;

    bool done() const { return tree_.size() + 2 > tree_.capacity(); }
    std::int64_t iterations() const { return iterations_; }
    const Tree& tree() const { return tree_; }

    std::int64_t run(std::int64_t iterations) {
        std::int64_t ran = 0;
        for (; ran < iterations && !done(); ++ran) iterate();
        iterations_ += ran;
        return ran;
    }

    Found found() const {
        Found result;
        std::vector<std::int32_t> before;  // what is sent before the current message
        std::int32_t other = kNone;
        std::int32_t at = 0;
        for (std::int32_t next = most_visited(at); next != kNone; next = most_visited(at)) {
            if (tree_[at].level == tables_.current) {
                before = result.sends;
                other = tree_[at].child[!tree_[next].send];
            }
            if (tree_[next].send) result.sends.push_back(tree_[at].level);
            at = next;
        }
        if (other != kNone) result.opposite = followed(other, std::move(before));
        Prices prices(tables_, path_);
        while (prices.learning()) prices.learn(prices.relax(), tree_[at].utility);
        result.bound = prices.bound();
        result.asked = prices.asked(tables_.current);
        result.nodes = tree_.size();
        return result;
    }

  private:
    void iterate() {
        const std::int32_t node = select();
        if (tree_[node].level < tables_.levels) {
            expand(node);
            if (reduced_ && reduction_.cut_if_barren(node)) return;
        }
        const double score = tree_[node].utility / tables_.scale[tree_[node].level];
        for (std::int32_t at = node; at != kNone; at = tree_[at].parent) {
            tree_[at].visits += 1;
            tree_[at].sum += score;
        }
    }

    std::int32_t select() {
        std::int32_t at = 0;
        path_.reset();
        if (reduced_) reduction_.reset();
        while (tree_[at].expanded) {
            const Node& node = tree_[at];
            const bool send = prefers_send(node);
            path_.step(node.level, send);
            if (reduced_) reduction_.step(node.level, send);
            at = node.child[send];
        }
        return at;
    }

    bool prefers_send(const Node& parent) const {
        if (parent.child[1] == kNone) return false;
        if (parent.child[0] == kNone) return true;
        const Node& drop = tree_[parent.child[0]];
        const Node& send = tree_[parent.child[1]];
        if (drop.visits == 0 || send.visits == 0) return drop.visits > 0;
        const double log_visits = log_of(parent.visits);
        return uct(send, log_visits) > uct(drop, log_visits);
    }

    double uct(const Node& node, double log_visits) const {
        const auto visits = static_cast<double>(node.visits);
        return node.sum / visits + exploration_ * std::sqrt(log_visits / visits);
    }

    void expand(std::int32_t node) {
        tree_[node].expanded = true;
        const std::int32_t level = tree_[node].level;
        const double utility = tree_[node].utility;
        create(node, false, utility);
        if (path_.fits(level)) create(node, true, utility + path_.gain(level));
    }

    void create(std::int32_t parent, bool send, double utility) {
        const std::int32_t level = tree_[parent].level;
        const std::int32_t rival = reduced_ ? reduction_.rival(level, send) : kNone;
        if (rival != kNone && !(utility > tree_[rival].utility)) return;
        const std::int32_t child = tree_.create(parent, level + 1, send, utility);
        tree_[parent].child[send] = child;
        if (reduced_) reduction_.enter(child, rival);
    }

    // The child with most visits, drop among equals; kNone when there is no child.
    std::int32_t most_visited(std::int32_t at) const {
        const auto [drop, send] = tree_[at].child;
        if (drop == kNone || send == kNone) return drop == kNone ? send : drop;
        return tree_[send].visits > tree_[drop].visits ? send : drop;
    }

    // The levels sent by the path of most visits to and below a node, after `sends`.
    std::vector<std::int32_t> followed(std::int32_t at, std::vector<std::int32_t> sends) const {
        for (; at != kNone; at = most_visited(at)) {
            if (tree_[at].send) sends.push_back(tree_[at].level - 1);
        }
        return sends;
    }

    Tables tables_;
    double exploration_;
    bool reduced_;
    std::int64_t iterations_ = 0;
    Tree tree_;
    Path path_;
    Reduction reduction_;
};

}  // namespace sendworthy
