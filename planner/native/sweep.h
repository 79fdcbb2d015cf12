// A sweep: level by level from the root to the end of the window, with the best few nodes of each level.
// The twin of planner/python_engine/sweep.py, where the reasons are written out.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "path.h"
#include "prices.h"
#include "states.h"
#include "tables.h"

namespace sendworthy {

class Sweep {
  public:
    Sweep(const Tables& tables, Path& path, StateTracker& states, const Prices& prices)
        : tables_(tables), path_(path), states_(states), prices_(prices), found_(4 * kWidth) {}
    Sweep(const Sweep&) = delete;
    Sweep& operator=(const Sweep&) = delete;

    // Whether it has come to the end of the window, or nothing is left that is worth trying.
    bool done() const { return done_; }

    // Whether nothing was left out that might be better.
    bool whole() const { return whole_; }

    // Go down one level, along what `worth_trying` says of its bound.
    template <class WorthTrying>
    void descend(WorthTrying worth_trying) {
        if (level_ == 0) begin();
        found_.clear();
        next_count_ = 0;
        for (std::int32_t at = 0; at < count_; ++at) {
            path_.load(places_[order_[at]].path, level_);  // and stays there when the message is dropped first
            for (const bool send : {false, true}) extend(places_[order_[at]], send, worth_trying);
        }
        rank();
        level_ += 1;
        done_ = level_ == tables_.levels || count_ == 0;
    }

    // Visit the plans at the end: value and the levels that each sends.
    template <class Visit>
    void visit(Visit visit) {
        for (std::int32_t at = 0; at < count_; ++at) {
            const Place& place = places_[order_[at]];
            sends_.clear();
            for (std::int32_t step = place.trail; step != kRoot; step = trail_[step].before) {
                if (trail_[step].send >= 0) sends_.push_back(trail_[step].send);
            }
            std::reverse(sends_.begin(), sends_.end());
            visit(place.value, sends_);
        }
    }

  private:
    static constexpr std::int32_t kWidth = 10;
    static constexpr std::int32_t kRoot = -1;

    struct Place {
        double value = 0.0;
        double bound = 0.0;
        std::int32_t trail = kRoot;
        Path::Snapshot path;
        StateTracker::Snapshot states;
    };
    struct Step {
        std::int32_t before;
        std::int32_t send;  // the level, or -1 when it is dropped
    };

    // Memory is for searches that come so far: most end before.
    void begin() {
        for (auto* level : {&places_, &next_}) {
            level->resize(2 * kWidth);
            for (Place& place : *level) {
                place.path.reserve(tables_);
                place.states.reserve(tables_);
            }
        }
        trail_.reserve(static_cast<std::size_t>(tables_.levels) * 2 * kWidth);
        order_.reserve(2 * kWidth);
        sends_.reserve(tables_.levels);
        path_.reset();
        states_.reset();
        Place& root = places_[0];
        root.value = tables_.facts;
        root.bound = prices_.bound();
        path_.save(root.path, 0);
        states_.save(root.states);
        order_.assign(1, 0);
        count_ = 1;
    }

    template <class WorthTrying>
    void extend(const Place& place, bool send, WorthTrying worth_trying) {
        states_.load(place.states);
        if (send && !path_.fits(level_)) return;
        const double bound = place.bound - prices_.loss(level_, send);
        if (!worth_trying(bound)) return;
        const double value = place.value + (send ? path_.gain(level_) : 0.0);
        std::int32_t& rival = found_.find(states_.after(level_, send));
        if (rival != 0 && value <= next_[rival - 1].value) return;
        if (rival == 0) rival = ++next_count_;
        Place& child = next_[rival - 1];
        child.value = value;
        child.bound = bound;
        child.trail = static_cast<std::int32_t>(trail_.size());
        trail_.push_back({place.trail, send ? level_ : -1});
        path_.step(level_, send);
        states_.step(level_, send);
        path_.save(child.path, level_ + 1);
        states_.save(child.states);
    }

    // Keep the best of the next level, by rising bound; equal ones in the order they were found.
    void rank() {
        std::swap(places_, next_);
        order_.resize(next_count_);
        for (std::int32_t at = 0; at < next_count_; ++at) {
            std::int32_t to = at;
            for (; to > 0 && places_[at].bound < places_[order_[to - 1]].bound; --to) order_[to] = order_[to - 1];
            order_[to] = at;
        }
        whole_ = whole_ && next_count_ <= kWidth;
        count_ = std::min(next_count_, kWidth);
        order_.erase(order_.begin(), order_.end() - count_);
    }

    const Tables& tables_;
    Path& path_;
    StateTracker& states_;
    const Prices& prices_;
    States found_;
    std::vector<Place> places_;
    std::vector<Place> next_;
    std::vector<Step> trail_;
    std::vector<std::int32_t> order_;  // the places to extend
    std::vector<std::int32_t> sends_;
    std::int32_t count_ = 0;
    std::int32_t next_count_ = 0;
    std::int32_t level_ = 0;
    bool whole_ = true;
    bool done_ = false;
};

}  // namespace sendworthy
