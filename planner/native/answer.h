// What a search found, as levels of the tree; planner/answers.py makes a plan of it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace sendworthy {

struct Found {
    std::vector<std::int32_t> sends;                    // of the plan
    std::optional<std::vector<std::int32_t>> opposite;  // of the best plan that decides the current message otherwise
    double bound = 0.0;                                 // no plan exceeds it
    std::vector<double> asked;  // by constraint: what sending the current message is charged within the window
    std::int32_t nodes = 0;
};

}  // namespace sendworthy
