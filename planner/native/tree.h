// The decision tree in one bounded arena: nodes are indices, nothing is allocated while a search runs.
// The twin of planner/python_engine/tree.py.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

namespace sendworthy {

constexpr std::int32_t kNone = -1;
constexpr std::int32_t kCut = -2;  // the parent of a node that was cut

struct Node {
    double utility;
    double sum;
    std::int32_t visits;
    std::int32_t parent;
    std::int32_t child[2];  // drop, send
    std::int32_t level;
    bool send;
    bool expanded;
    bool alive;

    bool barren() const { return child[0] == kNone && child[1] == kNone; }
};

class Tree {
  public:
    explicit Tree(std::int32_t capacity)
        : capacity_(capacity), nodes_(new Node[capacity]), order_(new std::int32_t[2 * static_cast<std::size_t>(capacity)]) {}

    std::int32_t create(std::int32_t parent, std::int32_t level, bool send, double utility) {
        nodes_[size_] = Node{utility, 0.0, 0, parent, {kNone, kNone}, level, send, false, true};
        return size_++;
    }

    Node& operator[](std::int32_t index) { return nodes_[index]; }
    const Node& operator[](std::int32_t index) const { return nodes_[index]; }
    std::int32_t size() const { return size_; }
    std::int32_t capacity() const { return capacity_; }

    // Take a node out: its visits and its sum leave its ancestors.
    void detach(std::int32_t index) {
        Node& node = nodes_[index];
        for (std::int32_t at = node.parent; at != kNone; at = nodes_[at].parent) {
            nodes_[at].visits -= node.visits;
            nodes_[at].sum -= node.sum;
        }
        if (node.parent != kNone) nodes_[node.parent].child[node.send] = kNone;
        node.parent = kNone;
        node.alive = false;
    }

    // The node and all below it, parents before children, drop before send. A second walk may nest after the first
    // one's `end`; returns where the nodes stand in order().
    struct Span {
        std::int32_t begin;
        std::int32_t end;
    };
    Span subtree(std::int32_t root, std::int32_t begin = 0) {
        std::int32_t end = begin;
        std::int32_t at = root;
        while (true) {
            order_[end++] = at;
            if (nodes_[at].child[0] != kNone) {
                at = nodes_[at].child[0];
            } else if (nodes_[at].child[1] != kNone) {
                at = nodes_[at].child[1];
            } else {
                at = next_branch(root, at);
                if (at == kNone) return {begin, end};
            }
        }
    }
    std::int32_t order(std::int32_t at) const { return order_[at]; }

  private:
    // The next node after a leaf in a walk below `root`.
    std::int32_t next_branch(std::int32_t root, std::int32_t at) const {
        while (at != root) {
            const Node& parent = nodes_[nodes_[at].parent];
            if (!nodes_[at].send && parent.child[1] != kNone) return parent.child[1];
            at = nodes_[at].parent;
        }
        return kNone;
    }

    std::int32_t capacity_;
    std::int32_t size_ = 0;
    std::unique_ptr<Node[]> nodes_;
    std::unique_ptr<std::int32_t[]> order_;
};

}  // namespace sendworthy
