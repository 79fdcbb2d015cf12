// A whole window tabulated: what the searches need of it, and what its plans are worth.
// The twin of planner/tables.py.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "beyond.h"
#include "checks.h"
#include "gains.h"
#include "tables.h"
#include "window.h"

namespace sendworthy {

// As NumpyTables of planner/tables.py; `beyond` is there when the objective is to be maximised, not U.
struct Tabulated {
    Gains gains;
    Checks checks;
    std::optional<Beyond> beyond;
    std::vector<double> scale;  // [depth]: psi * U(M) of Eq. 2
    std::int32_t current = 0;   // the level
    std::int32_t constraints = 0;

    std::int32_t levels() const { return static_cast<std::int32_t>(gains.message.size()); }
    std::int32_t streams() const { return static_cast<std::int32_t>(gains.markovian.size()); }

    // How many states each stream may be in.
    std::vector<std::int32_t> states() const {
        std::vector<std::int32_t> states(gains.markovian.size(), 1);
        for (std::int32_t level = 0; level < levels(); ++level) {
            std::int32_t& most = states[gains.stream[level]];
            most = std::max(most, gains.start[level + 1] - gains.start[level]);
            for (auto at = gains.start[level]; at < gains.start[level + 1]; ++at) {
                most = std::max(most, gains.after[at] + 1);
            }
        }
        return states;
    }

    // What the search maximises, and U, of the plan that sends these levels, in order.
    std::pair<double, double> worth(const std::vector<std::int32_t>& sends) const {
        std::vector<std::int32_t> state(gains.markovian.size(), 0);
        double aim = 0.0;
        double gain = 0.0;
        for (const std::int32_t level : sends) {
            std::int32_t& now = state[gains.stream[level]];
            const std::int32_t entry = gains.start[level] + now;
            now = gains.after[entry];
            aim += gains.aim[entry];
            gain += gains.gain[entry];
        }
        return {gains.aim_facts + aim, gains.facts + gain};
    }

    // The columns of the checks that sending these levels, in order, breaks.
    std::vector<std::int32_t> overfilled(const std::vector<std::int32_t>& sends) const {
        const std::int32_t columns = checks.columns;
        std::vector<char> sent(gains.message.size(), 0);
        for (const std::int32_t level : sends) sent[level] = 1;
        std::vector<double> used(static_cast<std::size_t>(levels() + 1) * columns, 0.0);
        std::vector<std::int32_t> broken;
        for (std::int32_t level = 0; level < levels(); ++level) {
            const double* now = used.data() + static_cast<std::size_t>(level) * columns;
            for (std::int32_t k = 0; k < columns; ++k) {
                used[static_cast<std::size_t>(level + 1) * columns + k] =
                    now[k] + (sent[level] ? checks.use[static_cast<std::size_t>(level) * columns + k] : 0.0);
            }
            if (!sent[level]) continue;
            for (auto at = checks.start[level]; at < checks.start[level + 1]; ++at) {
                const Check& check = checks.check[at];
                const double before = used[static_cast<std::size_t>(check.first) * columns + check.of];
                if (now[check.of] - before > check.room) broken.push_back(check.of);
            }
        }
        return broken;
    }

    // What each constraint charges for the current message beyond the window.
    std::vector<double> charged() const {
        if (!beyond) return std::vector<double>(constraints, 0.0);
        const auto begin = beyond->charges.begin() + static_cast<std::ptrdiff_t>(gains.message[current]) * constraints;
        return {begin, begin + constraints};
    }

    // The same laid out for the search loop.
    Tables tables() const {
        Tables tables;
        tables.levels = levels();
        tables.streams = streams();
        tables.constraints = checks.columns;
        tables.current = current;
        tables.facts = gains.aim_facts;
        tables.gain = gains.aim;
        tables.after = gains.after;
        tables.use = checks.use;
        tables.share = checks.share;
        tables.scale = scale;
        tables.check = checks.check;
        tables.row = checks.row;
        tables.markovian = gains.markovian;
        tables.state_start.push_back(0);
        for (const std::int32_t states : states()) tables.state_start.push_back(tables.state_start.back() + states);
        for (std::int32_t at = 0; at < levels(); ++at) {
            const bool never = checks.never[at] != 0;
            tables.level.push_back({gains.stream[at], gains.start[at], checks.start[at], checks.held[at], never});
        }
        tables.level.push_back({0, gains.start.back(), checks.start.back(), tables.levels, false});
        return tables;
    }
};

// Tabulate a valid window to maximise U or, `beyond` it, the objective; nothing when it is too large, or worth too much
// for floating-point numbers.
inline std::optional<Tabulated> tabulate(const Window& window, bool beyond) {
    constexpr double kShortestProgress = 0.01;
    Tabulated result;
    if (beyond) {
        result.beyond = LookBeyond(window).look();
        if (!result.beyond->finite()) return std::nullopt;
    }
    if (!TabulateGains(window, result.beyond ? &*result.beyond : nullptr).tabulate(result.gains)) return std::nullopt;
    if (!result.gains.finite()) return std::nullopt;
    result.checks = TabulateChecks(window, result.gains.message).tabulate();
    result.constraints = window.constraints();
    const std::vector<std::int32_t>& opened = result.gains.message;
    const auto current = std::lower_bound(opened.begin(), opened.end(), window.current);
    result.current = static_cast<std::int32_t>(current - opened.begin());
    for (std::size_t depth = 0; depth <= opened.size(); ++depth) {
        const double next = depth < opened.size() ? window.message[opened[depth]].t_gen : window.t_end;
        const double progress = std::max(next - window.t_start, kShortestProgress) / (window.t_end - window.t_start);
        const double scale = progress * result.gains.everything;
        const bool enough = scale >= std::numeric_limits<double>::min();  // to divide by
        result.scale.push_back(enough ? scale : std::numeric_limits<double>::infinity());
    }
    return result;
}

}  // namespace sendworthy
