// Reduction for Markovian types (paper, 3.2.2): of tantamount nodes only the best lives.
// The twin of planner/python_engine/reduction.py, where the rules are written out.
#pragma once

#include <cstdint>
#include <memory>

#include "path.h"
#include "states.h"
#include "tree.h"

namespace sendworthy {

enum class ReductionKind { off, paper, exact };

class Reduction {
  public:
    Reduction(const Tables& tables, Tree& tree, Path& path, ReductionKind kind)
        : tables_(tables),
          tree_(tree),
          path_(path),
          exact_(kind == ReductionKind::exact),
          states_(tables, exact_ ? NodeState::messages_and_windows : NodeState::messages),
          best_(kind == ReductionKind::off ? 0 : tree.capacity()),
          moved_(kind == ReductionKind::off ? nullptr : new double[tree.capacity()]) {}

    void reset() { states_.reset(); }
    void step(std::int32_t level, bool send) { states_.step(level, send); }

    // Find the tantamount node of a would-be child of the node where the path ends; kNone when there is none.
    std::int32_t rival(std::int32_t level, bool send) {
        slot_ = &best_.find(states_.after(level, send));
        const std::int32_t found = *slot_ - 1;
        return found != kNone && tree_[found].alive ? found : kNone;
    }

    // Make a new node the best of the state that rival() looked up; it replaces the node that was.
    void enter(std::int32_t child, std::int32_t rival) {
        *slot_ = child + 1;
        if (rival != kNone) replace(rival, child);
    }

    // Cut a node all of whose children were cancelled, and so on upwards; return whether it was one.
    bool cut_if_barren(std::int32_t node) {
        if (!tree_[node].barren()) return false;
        while (tree_[node].parent != kNone && tree_[node].barren()) {
            const std::int32_t above = tree_[node].parent;
            tree_.detach(node);
            node = above;
        }
        return true;
    }

  private:
    void replace(std::int32_t old, std::int32_t fresh) {
        const std::int32_t above = tree_[old].parent;
        tree_[fresh].visits = tree_[old].visits;
        tree_[fresh].sum = tree_[old].sum;
        tree_[fresh].expanded = tree_[old].expanded;
        tree_.detach(old);
        for (int side = 0; side < 2; ++side) {
            const std::int32_t child = tree_[old].child[side];
            tree_[fresh].child[side] = child;
            tree_[old].child[side] = kNone;
            if (child != kNone) tree_[child].parent = fresh;
        }
        cut_if_barren(above);
        settle(fresh, tree_[fresh].utility - tree_[old].utility);
        for (std::int32_t at = tree_[fresh].parent; at != kNone; at = tree_[at].parent) {
            tree_[at].visits += tree_[fresh].visits;
            tree_[at].sum += tree_[fresh].sum;
        }
    }

    // Give what moved below `fresh` its utilities and scores there, children before parents.
    void settle(std::int32_t fresh, double shift) {
        const std::int32_t above = tree_[fresh].parent;
        tree_[fresh].parent = kNone;
        if (!exact_) cut_what_breaks(fresh);
        const Tree::Span span = tree_.subtree(fresh);
        for (std::int32_t at = span.end - 1; at >= span.begin; --at) {
            const std::int32_t index = tree_.order(at);
            Node& node = tree_[index];
            if (index != fresh) {
                if (node.expanded && node.barren()) {
                    tree_.detach(index);
                    continue;
                }
                node.utility += shift;
            }
            std::int32_t own = node.visits;
            double moved = 0.0;
            for (const std::int32_t child : node.child) {
                if (child == kNone) continue;
                own -= tree_[child].visits;
                moved += moved_[child];
            }
            moved += static_cast<double>(own) * shift / tables_.scale[node.level];
            moved_[index] = moved;
            node.sum += moved;
        }
        tree_[fresh].parent = above;
        tree_[fresh].expanded = !tree_[fresh].barren();
    }

    // Cut below `fresh` what breaks a constraint in its new place.
    void cut_what_breaks(std::int32_t fresh) {
        path_.count(tree_[fresh].level - 1, tree_[fresh].send);
        const Tree::Span span = tree_.subtree(fresh);
        for (std::int32_t at = span.begin + 1; at < span.end; ++at) {
            const std::int32_t index = tree_.order(at);
            const Node& node = tree_[index];
            if (!node.alive) continue;
            if (node.send && !path_.fits(node.level - 1)) {
                const Tree::Span lost = tree_.subtree(index, span.end);
                for (std::int32_t gone = lost.end - 1; gone >= lost.begin; --gone) tree_[tree_.order(gone)].alive = false;
                tree_.detach(index);
                continue;
            }
            path_.count(node.level - 1, node.send);
        }
    }

    const Tables& tables_;
    Tree& tree_;
    Path& path_;
    bool exact_;
    StateTracker states_;
    States best_;
    std::unique_ptr<double[]> moved_;  // by node: what the shift of utilities adds to its sum
    std::int32_t* slot_ = nullptr;
};

}  // namespace sendworthy
