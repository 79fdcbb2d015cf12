// planner._native: tables and search kernels for Python. Both are computed without the GIL.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "best.h"
#include "paper.h"
#include "reading.h"
#include "tables.h"
#include "tabulate.h"
#include "window.h"

namespace nb = nanobind;
using namespace nb::literals;
using namespace sendworthy;

namespace {

using Ints = nb::ndarray<const std::int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Floats = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Flags = nb::ndarray<const bool, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Matrix = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using PaperRow = std::tuple<std::int32_t, std::int32_t, int, std::int32_t, double, double>;

std::int32_t narrow(const Ints& values, std::size_t at) { return static_cast<std::int32_t>(values(at)); }

void add_rows(Tables& tables, nb::handle rows) {
    const auto of = nb::cast<Ints>(rows.attr("of"));
    const auto first = nb::cast<Ints>(rows.attr("first"));
    const auto last = nb::cast<Ints>(rows.attr("last"));
    const auto capacity = nb::cast<Floats>(rows.attr("capacity"));
    for (std::size_t at = 0; at < of.size(); ++at) {
        tables.row.push_back({narrow(of, at), narrow(first, at), narrow(last, at), capacity(at)});
    }
}

// The arrays of planner/tables.py's NumpyTables; `gains` and `checks` are its parts. Their shapes are checked there.
Tables make_tables(nb::handle source) {
    if (nb::isinstance<Tabulated>(source)) return nb::cast<const Tabulated&>(source).tables();
    const nb::object gains = source.attr("gains");
    const nb::object checks = source.attr("checks");
    const auto scale = nb::cast<Floats>(source.attr("scale"));
    const auto stream = nb::cast<Ints>(gains.attr("stream"));
    const auto gain_start = nb::cast<Ints>(gains.attr("start"));
    const auto gain = nb::cast<Floats>(gains.attr("aim"));
    const auto after = nb::cast<Ints>(gains.attr("after"));
    const auto markovian = nb::cast<Flags>(gains.attr("markovian"));
    const auto states = nb::cast<Ints>(source.attr("states"));
    const auto use = nb::cast<Matrix>(checks.attr("use"));
    const auto share = nb::cast<Matrix>(checks.attr("share"));
    const auto check_start = nb::cast<Ints>(checks.attr("start"));
    const auto of = nb::cast<Ints>(checks.attr("of"));
    const auto first = nb::cast<Ints>(checks.attr("first"));
    const auto room = nb::cast<Floats>(checks.attr("room"));
    const auto never = nb::cast<Flags>(checks.attr("never"));
    const auto held = nb::cast<Ints>(checks.attr("held"));

    Tables tables;
    tables.levels = static_cast<std::int32_t>(stream.shape(0));
    tables.streams = nb::cast<std::int32_t>(source.attr("streams"));
    tables.constraints = static_cast<std::int32_t>(use.shape(1));
    tables.current = nb::cast<std::int32_t>(source.attr("current"));
    tables.facts = nb::cast<double>(gains.attr("aim_facts"));
    tables.gain.assign(gain.data(), gain.data() + gain.size());
    tables.use.assign(use.data(), use.data() + use.size());
    tables.share.assign(share.data(), share.data() + share.size());
    tables.scale.assign(scale.data(), scale.data() + scale.size());
    for (std::size_t at = 0; at < room.size(); ++at) {
        tables.check.push_back({narrow(of, at), narrow(first, at), room(at)});
    }
    add_rows(tables, checks.attr("rows"));
    for (std::size_t at = 0; at < after.size(); ++at) tables.after.push_back(narrow(after, at));
    tables.state_start.push_back(0);
    for (std::size_t at = 0; at < states.size(); ++at) {
        tables.state_start.push_back(tables.state_start.back() + narrow(states, at));
        tables.markovian.push_back(markovian(at));
    }
    for (std::size_t at = 0; at < stream.size(); ++at) {
        tables.level.push_back({narrow(stream, at), narrow(gain_start, at), narrow(check_start, at), narrow(held, at),
                                never(at)});
    }
    tables.level.push_back({0, static_cast<std::int32_t>(gain.size()), static_cast<std::int32_t>(room.size()),
                            tables.levels, false});
    return tables;
}

// NumPy arrays of what was tabulated here, for the Python engine.
template <class To, class From>
auto array_of(const std::vector<From>& values) {
    To* copy = new To[values.size()];
    std::copy(values.begin(), values.end(), copy);
    nb::capsule owner(copy, [](void* held) noexcept { delete[] static_cast<To*>(held); });
    return nb::ndarray<nb::numpy, To, nb::ndim<1>>(copy, {values.size()}, owner);
}

auto ints(const std::vector<std::int32_t>& values) { return array_of<std::int64_t>(values); }
auto floats(const std::vector<double>& values) { return array_of<double>(values); }
auto flags(const std::vector<char>& values) { return array_of<bool>(values); }

template <class Struct, class Field>
auto column(const std::vector<Struct>& values, Field Struct::* field) {
    std::vector<Field> result;
    for (const Struct& value : values) result.push_back(value.*field);
    if constexpr (std::is_same_v<Field, double>) {
        return floats(result);
    } else {
        return ints(result);
    }
}

// In the order of the fields of planner/evaluation.py's Gains.
nb::tuple gains_of(const Tabulated& tables) {
    const Gains& gains = tables.gains;
    return nb::make_tuple(ints(gains.stream), ints(gains.start), ints(gains.after), floats(gains.gain), gains.facts,
                          gains.everything, floats(gains.aim), gains.aim_facts, gains.exact, flags(gains.markovian));
}

// In the order of the fields of planner/beyond.py's Beyond.
std::optional<nb::tuple> beyond_of(const Tabulated& tables) {
    if (!tables.beyond) return std::nullopt;
    const Beyond& beyond = *tables.beyond;
    return nb::make_tuple(floats(beyond.worth), floats(beyond.charges), floats(beyond.price), floats(beyond.rent),
                          floats(beyond.until));
}

// In the order of the fields of planner/constraints.py's Checks.
nb::tuple checks_of(const Tabulated& tables) {
    const Checks& checks = tables.checks;
    const nb::tuple rows = nb::make_tuple(column(checks.row, &Row::of), column(checks.row, &Row::first),
                                          column(checks.row, &Row::last), column(checks.row, &Row::capacity));
    return nb::make_tuple(floats(checks.use), floats(checks.share), ints(checks.start),
                          column(checks.check, &Check::of), column(checks.check, &Check::first),
                          column(checks.check, &Check::room), ints(checks.held), flags(checks.never), rows,
                          ints(checks.constraint));
}

std::optional<Tabulated> tabulated(nb::handle problem, const nb::tuple& kinds, bool beyond) {
    Window window;
    if (!Reader(kinds).read(problem, window)) return std::nullopt;
    const nb::gil_scoped_release released;
    return window.valid() ? tabulate(window, beyond) : std::nullopt;
}

std::optional<double> integral(nb::handle utility, const nb::tuple& kinds, double until) {
    const std::optional<Utility> read = Reader::utility_of(utility.ptr(), kinds);
    if (!read) return std::nullopt;
    return Integral(*read, 0.0).to(until);
}

ReductionKind reduction_of(const std::string& name) {
    if (name == "paper") return ReductionKind::paper;
    return name == "exact" ? ReductionKind::exact : ReductionKind::off;
}

using BestRow = std::tuple<std::int32_t, std::int32_t, int, double, double, double, double>;

std::vector<BestRow> best_rows(const BestSearch& search) {
    std::vector<BestRow> result;
    for (std::int32_t at = 0; at < search.size(); ++at) {
        const BestNode& node = search.node(at);
        result.emplace_back(node.alive ? node.parent : kCut, node.level, node.send, node.value, node.bound, node.untried,
                            node.promise);
    }
    return result;
}

std::vector<PaperRow> rows(const Tree& tree) {
    std::vector<PaperRow> result;
    for (std::int32_t at = 0; at < tree.size(); ++at) {
        const Node& node = tree[at];
        result.emplace_back(node.alive ? node.parent : kCut, node.level, node.send, node.visits, node.sum, node.utility);
    }
    return result;
}

using Parts = std::tuple<std::vector<std::int32_t>, std::optional<std::vector<std::int32_t>>, double, std::vector<double>,
                         std::int32_t>;

Parts parts(const Found& found) { return {found.sends, found.opposite, found.bound, found.asked, found.nodes}; }

}  // namespace

NB_MODULE(_native, m) {
    m.doc() = "The native tables and search kernels.";
    nb::class_<Tabulated>(m, "Tabulated", "A problem as tables: see planner/native_tables.py.")
        .def_ro("current", &Tabulated::current)
        .def_prop_ro("levels", &Tabulated::levels)
        .def_prop_ro("streams", &Tabulated::streams)
        .def_prop_ro("exact", [](const Tabulated& self) { return self.gains.exact; })
        .def_prop_ro("message", [](const Tabulated& self) { return self.gains.message; })
        .def_prop_ro("constraint", [](const Tabulated& self) { return self.checks.constraint; })
        .def("states", [](const Tabulated& self) { return ints(self.states()); })
        .def("scale", [](const Tabulated& self) { return floats(self.scale); })
        .def("gains", &gains_of)
        .def("beyond", &beyond_of)
        .def("checks", &checks_of)
        .def("charged", &Tabulated::charged)
        .def("worth", &Tabulated::worth, "sends"_a)
        .def("overfilled", &Tabulated::overfilled, "sends"_a);
    m.def("integral", &integral, "utility"_a, "kinds"_a, "until"_a,
          "What a message is worth up to an age [s]; None for a utility of another kind.");
    m.def("tabulate", &tabulated, "problem"_a, "kinds"_a, "beyond"_a,
          "Tabulate a valid problem of standard kinds; None for any other.");
    nb::class_<PaperSearch>(m, "PaperSearch", "The paper's search: see planner/python_engine/paper.py.")
        .def("__init__",
             [](PaperSearch* self, nb::handle tables, double exploration, const std::string& reduction,
                std::int32_t max_nodes) {
                 new (self) PaperSearch(make_tables(tables), exploration, reduction_of(reduction), max_nodes);
             },
             "tables"_a, "exploration"_a, "reduction"_a, "max_nodes"_a)
        .def_prop_ro("iterations", &PaperSearch::iterations)
        .def_prop_ro("done", &PaperSearch::done)
        .def("run", &PaperSearch::run, "iterations"_a, nb::call_guard<nb::gil_scoped_release>())
        .def("plan", [](const PaperSearch& self) { return parts(self.found()); })
        .def("tree", [](const PaperSearch& self) { return rows(self.tree()); });
    nb::class_<BestSearch>(m, "BestSearch", "The default search: see planner/python_engine/best.py.")
        .def("__init__",
             [](BestSearch* self, nb::handle tables, std::int32_t max_nodes) {
                 new (self) BestSearch(make_tables(tables), max_nodes);
             },
             "tables"_a, "max_nodes"_a)
        .def_prop_ro("iterations", &BestSearch::iterations)
        .def_prop_ro("done", &BestSearch::done)
        .def("run", &BestSearch::run, "iterations"_a, nb::call_guard<nb::gil_scoped_release>())
        .def("plan", [](const BestSearch& self) { return parts(self.found()); })
        .def("tree", &best_rows);
}
