// What a search answers: the native form of planner/search.py's Plan.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace sendworthy {

struct Answer {
    bool send = false;
    std::vector<std::int32_t> sends;
    double utility = 0.0;
    std::optional<double> opposite;
    std::int32_t nodes = 0;
};

// The levels that the best plan found sends, and the best one of the opposite decision; planner/answers.py weighs them.
struct Found {
    std::vector<std::int32_t> sends;
    std::optional<std::vector<std::int32_t>> opposite;
    std::int32_t nodes = 0;
};

}  // namespace sendworthy
