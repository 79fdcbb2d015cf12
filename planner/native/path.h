// The decisions from the root to where a search stands: states of the streams and use of the constraints.
// The twin of planner/python_engine/path.py.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tables.h"

namespace sendworthy {

class Path {
  public:
    explicit Path(const Tables& tables)
        : tables_(tables),
          used_(static_cast<std::size_t>(tables.levels + 1) * tables.constraints, 0.0),
          state_(tables.streams, 0),
          sends_(tables.levels, 0) {}

    void reset() {
        std::fill(state_.begin(), state_.end(), 0);
        count_ = 0;
    }

    // What later levels need of a path that ends before some level.
    struct Snapshot {
        std::vector<double> used;  // from the first depth that a check looks back to
        std::vector<std::int32_t> state;

        void reserve(const Tables& tables) {
            std::int32_t most = 0;
            for (std::int32_t depth = 0; depth <= tables.levels; ++depth) {
                most = std::max(most, depth + 1 - tables.level[depth].held);
            }
            used.reserve(static_cast<std::size_t>(most) * tables.constraints);
            state.reserve(tables.streams);
        }
    };

    void save(Snapshot& snapshot, std::int32_t depth) const {
        snapshot.used.assign(used(tables_.level[depth].held), used(depth) + tables_.constraints);
        snapshot.state = state_;
    }

    void load(const Snapshot& snapshot, std::int32_t depth) {
        const auto begin = static_cast<std::size_t>(tables_.level[depth].held) * tables_.constraints;
        std::copy(snapshot.used.begin(), snapshot.used.end(), used_.begin() + static_cast<std::ptrdiff_t>(begin));
        state_ = snapshot.state;
        count_ = 0;
    }

    // Where the gain of this level stands, in the present state of its stream.
    std::int32_t entry(std::int32_t at) const {
        const Level& level = tables_.level[at];
        return level.gain_start + state_[level.stream];
    }
    double gain(std::int32_t at) const { return tables_.gain[entry(at)]; }

    // Whether every constraint (Eq. 5) allows to send the message of this level.
    bool fits(std::int32_t at) const {
        const double* now = used(at);
        const Check* end = tables_.check.data() + tables_.level[at + 1].check_start;
        for (const Check* check = tables_.check.data() + tables_.level[at].check_start; check != end; ++check) {
            if (now[check->of] - used(check->first)[check->of] > check->room) return false;
        }
        return true;
    }

    void step(std::int32_t at, bool send) {
        count(at, send);
        if (!send) return;
        state_[tables_.level[at].stream] = tables_.after[entry(at)];
        sends_[count_++] = at;
    }

    // Count what the message of this level uses, and no more.
    void count(std::int32_t at, bool send) {
        const double* before = used(at);
        double* after = used_.data() + static_cast<std::size_t>(at + 1) * tables_.constraints;
        const double* use = tables_.use_of(at);
        for (std::int32_t k = 0; k < tables_.constraints; ++k) after[k] = send ? before[k] + use[k] : before[k];
    }

    const double* used(std::int32_t depth) const {
        return used_.data() + static_cast<std::size_t>(depth) * tables_.constraints;
    }

    const std::int32_t* sends() const { return sends_.data(); }
    std::int32_t send_count() const { return count_; }

  private:
    const Tables& tables_;
    std::vector<double> used_;  // [depth * constraints + k]: what the levels before the depth use
    std::vector<std::int32_t> state_;
    std::vector<std::int32_t> sends_;
    std::int32_t count_ = 0;
};

}  // namespace sendworthy
