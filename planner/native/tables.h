// A problem as plain arrays: what planner/tables.py tabulates, laid out for the search loop.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sendworthy {

// The messages sent at the levels `first` to i - 1 may use at most `room` of constraint `of` (constraints.py).
struct Check {
    std::int32_t of;
    std::int32_t first;
    double room;
};

// What the levels `first` to `last` use of constraint `of` is at most `capacity`, in any plan (constraints.py).
struct Row {
    std::int32_t of;
    std::int32_t first;
    std::int32_t last;
    double capacity;
};

// What the search needs to know of the message that one level decides (evaluation.py).
struct Level {
    std::int32_t stream;
    std::int32_t gain_start;   // gain[gain_start + state] is what sending adds, after[gain_start + state] leads to
    std::int32_t check_start;  // checks up to the next level's check_start
    std::int32_t held;         // first level that a check of this level or a later one looks back to
    bool never;                // no plan can send it
};

struct Tables {
    std::vector<Level> level;  // one more than there are messages: the end of the checks and of the held sends
    std::vector<double> gain;  // to what the search maximises: `aim` of planner/evaluation.py, `facts` is `aim_facts`
    std::vector<std::int32_t> after;        // the state that sending leads to
    std::vector<std::int32_t> state_start;  // [stream]: the states of the streams before; one more than streams
    std::vector<char> markovian;            // [stream]: whether the message received last is all that counts
    std::vector<Check> check;
    std::vector<Row> row;
    std::vector<double> use;    // [level * constraints + k]
    std::vector<double> share;  // the same, but at most the limit
    std::vector<double> scale;  // [depth]: psi * U(M) of Eq. 2
    std::int32_t levels = 0;
    std::int32_t streams = 0;
    std::int32_t constraints = 0;
    std::int32_t current = 0;
    double facts = 0.0;

    const double* share_of(std::int32_t at) const { return share.data() + static_cast<std::size_t>(at) * constraints; }
    const double* use_of(std::int32_t at) const { return use.data() + static_cast<std::size_t>(at) * constraints; }
};

}  // namespace sendworthy
