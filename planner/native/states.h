// The states of nodes, to find tantamount ones: 128 bits of hash stand for the states of the streams and for what
// the constraint windows hold. Two different states of one search that share all bits will not be met.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

#include "tables.h"

namespace sendworthy {

struct StateHash {
    std::uint64_t low = 0;
    std::uint64_t high = 0;

    void toggle(const StateHash& other) {
        low ^= other.low;
        high ^= other.high;
    }
    bool operator==(const StateHash&) const = default;
};

// splitmix64: well mixed bits for the numbers 0, 1, 2, ...
inline std::uint64_t mixed(std::uint64_t number) {
    number = (number + 1) * 0x9E3779B97F4A7C15ull;
    number = (number ^ (number >> 30)) * 0xBF58476D1CE4E5B9ull;
    number = (number ^ (number >> 27)) * 0x94D049BB133111EBull;
    return number ^ (number >> 31);
}

// What makes two nodes of one level tantamount.
enum class NodeState {
    messages,              // the last message of every Markovian stream, the set of messages of the others (Eq. 7)
    messages_and_windows,  // and what the constraint windows hold
    streams_and_windows,   // the states of the streams, and what the windows hold
};

// The state at the end of a path, kept up to date decision by decision in constant time, whatever the number of streams.
class StateTracker {
  public:
    StateTracker(const Tables& tables, NodeState kind)
        : tables_(tables),
          held_(kind != NodeState::messages),
          by_stream_(kind == NodeState::streams_and_windows),
          known_(tables.streams, 0) {
        sends_.reserve(tables.levels);
        const auto levels = static_cast<std::uint64_t>(tables.levels) + 1;
        for (std::uint64_t at = 0; at < levels; ++at) {
            depth_.push_back({mixed(6 * at), mixed(6 * at + 1)});
            message_.push_back({mixed(6 * at + 2), mixed(6 * at + 3)});
            in_window_.push_back({mixed(6 * at + 4), mixed(6 * at + 5)});
        }
        const std::int32_t states = by_stream_ ? tables.state_start[tables.streams] : 0;
        for (std::uint64_t at = 0; at < static_cast<std::uint64_t>(states); ++at) {
            in_state_.push_back({mixed(6 * levels + 2 * at), mixed(6 * levels + 2 * at + 1)});
        }
        reset();
    }

    // Where the tracker stands, to come back to.
    struct Snapshot {
        std::vector<std::int32_t> known;
        std::vector<std::int32_t> held;
        StateHash hash;

        void reserve(const Tables& tables) {
            known.reserve(tables.streams);
            held.reserve(tables.levels);
        }
    };

    void save(Snapshot& snapshot) const {
        snapshot.known = known_;
        snapshot.held.assign(sends_.begin() + static_cast<std::ptrdiff_t>(oldest_), sends_.end());
        snapshot.hash = hash_;
    }

    void load(const Snapshot& snapshot) {
        known_ = snapshot.known;
        sends_ = snapshot.held;
        oldest_ = 0;
        hash_ = snapshot.hash;
    }

    void reset() {
        std::fill(known_.begin(), known_.end(), by_stream_ ? 0 : -1);
        sends_.clear();
        oldest_ = 0;
        hash_ = {};
    }

    // The state once this level is decided.
    StateHash after(std::int32_t level, bool send) const {
        StateHash hash = moved(level, send);
        hash.toggle(depth_[level]);
        return hash;
    }

    void step(std::int32_t level, bool send) {
        hash_ = moved(level, send);
        const std::int32_t held = tables_.level[level + 1].held;
        while (oldest_ < sends_.size() && sends_[oldest_] < held) ++oldest_;
        if (!send) return;
        const std::int32_t stream = tables_.level[level].stream;
        known_[stream] = by_stream_ ? next_state(level) : level;
        if (level >= held && counts(level)) sends_.push_back(level);
    }

  private:
    // The state once this level is decided, of whatever depth.
    StateHash moved(std::int32_t level, bool send) const {
        StateHash hash = hash_;
        const std::int32_t held = tables_.level[level + 1].held;
        for (std::size_t at = oldest_; at < sends_.size() && sends_[at] < held; ++at) hash.toggle(in_window_[sends_[at]]);
        if (!send) return hash;
        if (by_stream_) {
            toggle_state(hash, level);
        } else {
            toggle_message(hash, level);
        }
        if (level >= held && counts(level)) hash.toggle(in_window_[level]);
        return hash;
    }

    std::int32_t next_state(std::int32_t level) const {
        return tables_.after[tables_.level[level].gain_start + known_[tables_.level[level].stream]];
    }

    void toggle_state(StateHash& hash, std::int32_t level) const {
        const std::int32_t stream = tables_.level[level].stream;
        hash.toggle(in_state_[tables_.state_start[stream] + known_[stream]]);
        hash.toggle(in_state_[tables_.state_start[stream] + next_state(level)]);
    }

    void toggle_message(StateHash& hash, std::int32_t level) const {
        const std::int32_t stream = tables_.level[level].stream;
        if (tables_.markovian[stream] && known_[stream] >= 0) hash.toggle(message_[known_[stream]]);
        hash.toggle(message_[level]);
    }

    bool counts(std::int32_t level) const {
        if (!held_) return false;
        const double* use = tables_.use_of(level);
        for (std::int32_t k = 0; k < tables_.constraints; ++k) {
            if (use[k] > 0.0) return true;
        }
        return false;
    }

    const Tables& tables_;
    bool held_;       // whether what the windows hold is part of the state
    bool by_stream_;  // whether the states of the streams stand for their messages
    std::vector<std::int32_t> known_;  // [stream]: its state, or else the level that it sent last, -1 for none
    std::vector<std::int32_t> sends_;  // those that some window may hold, from `oldest_` on
    std::size_t oldest_ = 0;
    StateHash hash_;
    std::vector<StateHash> depth_;
    std::vector<StateHash> message_;
    std::vector<StateHash> in_window_;
    std::vector<StateHash> in_state_;
};

// A bounded hash table from states to nodes; never allocates after construction. It begins small and grows within
// its memory, so that a small search touches, and clears, little of it.
class States {
  public:
    explicit States(std::int32_t nodes) {
        while (most_ < 2 * static_cast<std::size_t>(nodes)) most_ *= 2;
        mask_ = std::min(most_, kFirst) - 1;
        slots_.reset(static_cast<Slot*>(std::malloc((most_ + most_ / 2) * sizeof(Slot))));
        if (!slots_) throw std::bad_alloc();
        clear();
    }

    // 1 + the node of the state; 0 when the state is new. Holds until the next one is looked up.
    std::int32_t& find(const StateHash& hash) {
        if (2 * taken_ > mask_ && mask_ + 1 < most_) grow();
        Slot& slot = place_of(hash);
        if (slot.node_plus_one == 0) {
            slot.hash = hash;
            ++taken_;
        }
        return slot.node_plus_one;
    }

    // Forget all states.
    void clear() {
        std::fill_n(slots_.get(), mask_ + 1, Slot{});
        taken_ = 0;
    }

  private:
    static constexpr std::size_t kFirst = 1024;

    struct Slot {
        StateHash hash;
        std::int32_t node_plus_one;
    };
    struct Free {
        void operator()(Slot* slots) const { std::free(slots); }
    };

    Slot& place_of(const StateHash& hash) {
        std::size_t at = hash.low & mask_;
        while (slots_.get()[at].node_plus_one != 0 && !(slots_.get()[at].hash == hash)) at = (at + 1) & mask_;
        return slots_.get()[at];
    }

    // Take four times as much, by way of the memory behind what the table may ever take: to double it moves more.
    void grow() {
        Slot* const before = slots_.get() + most_;
        Slot* const end = std::copy_n(slots_.get(), mask_ + 1, before);
        mask_ = std::min(most_, 4 * (mask_ + 1)) - 1;
        clear();
        for (const Slot* slot = before; slot != end; ++slot) {
            if (slot->node_plus_one == 0) continue;
            place_of(slot->hash) = *slot;
            ++taken_;
        }
    }

    std::size_t most_ = 16;
    std::size_t mask_ = 0;
    std::size_t taken_ = 0;  // lookups that found nothing: at least as many as there are states
    std::unique_ptr<Slot, Free> slots_;
};

}  // namespace sendworthy
