// From the Python objects of planner/problem.py to a Window, in one pass.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "window.h"

namespace sendworthy {

// Reads problems of standard kinds. Whatever else they hold, own models, numbers of other types or nonsense, it
// declines: planner/tables.py then says what is wrong, or tabulates it.
class Reader {
  public:
    // The classes Message, Traffic, Stream, Receiver and Constraint, the members of Aggregation and the classes of
    // utilities, the latter in the order of the enumerations here.
    explicit Reader(nanobind::tuple kinds)
        : message_(kinds[0].ptr()),
          traffic_(kinds[1].ptr()),
          stream_(kinds[2].ptr()),
          receiver_(kinds[3].ptr()),
          constraint_(kinds[4].ptr()),
          aggregations_(kinds[5]),
          utilities_(kinds[6]) {}

    // Read a problem; false when it is declined.
    bool read(nanobind::handle problem, Window& window) {
        const nanobind::object streams = problem.attr("streams");
        const nanobind::object messages = problem.attr("messages");
        const nanobind::object constraints = problem.attr("constraints");
        const nanobind::object traffic = problem.attr("traffic");
        const auto constraint = [&](PyObject* each) { return read_constraint(each, window); };
        const auto stream = [&](PyObject* each) { return read_stream(each, window); };
        const auto message = [&](PyObject* each) { return read_message(each, window); };
        const auto other = [&](PyObject* each) { return read_traffic(each, window); };
        if (!all(constraints.ptr(), constraint) || !all(streams.ptr(), stream)) return false;
        window.stream.push_back({0, Aggregation::most_recent, static_cast<std::int32_t>(window.receiver.size())});
        return all(messages.ptr(), message) && all(traffic.ptr(), other) &&
               whole(problem.attr("current").ptr(), window.current) && number(problem, "t_start", window.t_start) &&
               number(problem, "t_end", window.t_end) && flag(problem.attr("goes_on").ptr(), window.goes_on);
    }

    // One utility, which must live as long as what is read of it; `kinds` are those of UtilityKind.
    static std::optional<Utility> utility_of(PyObject* object, const nanobind::tuple& kinds) {
        std::int8_t at = 0;
        for (const nanobind::handle kind : kinds) {
            if (reinterpret_cast<PyObject*>(Py_TYPE(object)) == kind.ptr()) break;  // another class may differ
            ++at;
        }
        if (static_cast<std::size_t>(at) == kinds.size()) return std::nullopt;
        std::array<double, 3> parameters{};
        for (std::size_t name = 0; name < parameters.size() && kParameters[at][name] != nullptr; ++name) {
            if (!number(nanobind::handle(object), kParameters[at][name], parameters[name])) return std::nullopt;
        }
        Utility utility(static_cast<UtilityKind>(at), parameters[0], parameters[1], parameters[2]);
        if (utility.kind == UtilityKind::table || utility.kind == UtilityKind::custom) read_points(object, utility);
        return utility;
    }

  private:
    static constexpr Py_ssize_t kFields = 8;      // of a message
    static constexpr Py_ssize_t kStreamFields = 4;
    static constexpr std::int8_t kAggregations = 5;
    static constexpr Py_ssize_t kMost = 1 << 20;  // of anything: a window of more is a mistake

    template <class Read>
    static bool all(PyObject* values, Read read) {
        if (!PyTuple_Check(values) && !PyList_Check(values)) return false;
        if (PySequence_Fast_GET_SIZE(values) > kMost) return false;
        for (Py_ssize_t at = 0; at < PySequence_Fast_GET_SIZE(values); ++at) {  // a property of theirs might change it
            const nanobind::object each = nanobind::borrow(PySequence_Fast_GET_ITEM(values, at));
            if (!read(each.ptr())) return false;
        }
        return true;
    }

    static bool number(PyObject* value, double& result) {
        if (PyFloat_Check(value)) {
            result = PyFloat_AS_DOUBLE(value);
            return true;
        }
        if (!PyLong_Check(value)) return false;
        result = PyLong_AsDouble(value);
        return !failed();
    }

    static bool number(nanobind::handle object, const char* name, double& result) {
        return number(object.attr(name).ptr(), result);
    }

    static bool whole(PyObject* value, std::int64_t& result) {
        if (!PyLong_Check(value)) return false;
        result = PyLong_AsLongLong(value);
        return !failed();
    }

    static bool flag(PyObject* value, bool& result) {
        result = value == Py_True;
        return PyBool_Check(value) != 0;
    }

    // Whether a conversion failed: numbers may be too large.
    static bool failed() {
        if (PyErr_Occurred() == nullptr) return false;
        PyErr_Clear();
        return true;
    }

    static bool is(PyObject* object, PyObject* kind) {
        return PyObject_TypeCheck(object, reinterpret_cast<PyTypeObject*>(kind)) != 0;
    }

    static bool numbers(PyObject* values, std::size_t count, std::vector<double>& result) {
        const auto read = [&](PyObject* each) {
            double value = 0.0;
            if (!number(each, value)) return false;
            result.push_back(value);
            return true;
        };
        const std::size_t before = result.size();
        return all(values, read) && result.size() == before + count;
    }

    bool read_constraint(PyObject* object, Window& window) const {
        // Whoever makes problems may know more of a constraint than its window and its limit.
        if (PyObject_IsInstance(object, constraint_) != 1) return false;
        Constraint constraint{};
        if (!number(nanobind::handle(object), "window", constraint.window)) return false;
        if (!number(nanobind::handle(object), "limit", constraint.limit)) return false;
        window.constraint.push_back(constraint);
        return true;
    }

    bool read_stream(PyObject* object, Window& window) {
        if (!is(object, stream_) || PyTuple_GET_SIZE(object) != kStreamFields) return false;
        const auto field = [object](Py_ssize_t at) { return PyTuple_GET_ITEM(object, at); };
        Stream read{0, Aggregation::most_recent, static_cast<std::int32_t>(window.receiver.size())};
        if (!whole(field(0), read.robot)) return false;
        std::int8_t at = 0;
        for (const nanobind::handle known : aggregations_) {
            if (known.ptr() == field(1)) break;
            ++at;
        }
        if (at >= kAggregations || static_cast<std::size_t>(at) == aggregations_.size()) return false;
        read.aggregation = static_cast<Aggregation>(at);
        if (field(3) != Py_None && !read_newest(field(3), read)) return false;
        window.stream.push_back(read);
        return all(field(2), [&](PyObject* each) { return read_receiver(each, window); });
    }

    static bool read_newest(PyObject* object, Stream& stream) {
        if (!PyTuple_Check(object) || PyTuple_GET_SIZE(object) != 2) return false;
        stream.has_newest = true;
        return number(PyTuple_GET_ITEM(object, 0), stream.newest.t_gen) &&
               number(PyTuple_GET_ITEM(object, 1), stream.newest.scale);
    }

    bool read_receiver(PyObject* object, Window& window) const {
        if (!is(object, receiver_) || PyTuple_GET_SIZE(object) != 2) return false;
        Receiver receiver{};
        if (!number(PyTuple_GET_ITEM(object, 0), receiver.delay)) return false;
        if (!number(PyTuple_GET_ITEM(object, 1), receiver.share)) return false;
        window.receiver.push_back(receiver);
        return true;
    }

    bool read_message(PyObject* object, Window& window) {
        if (!is(object, message_) || PyTuple_GET_SIZE(object) != kFields) return false;
        const auto field = [object](Py_ssize_t at) { return PyTuple_GET_ITEM(object, at); };
        Message read{};
        std::int64_t stream = 0;
        if (!whole(field(0), stream) || stream < 0 || stream >= window.streams()) return false;
        read.stream = static_cast<std::int32_t>(stream);
        if (!number(field(1), read.t_gen) || !number(field(2), read.t_sent)) return false;
        if (!number(field(3), read.t_rcv)) return false;
        if (!read_utility(field(4), read.utility, window) || !number(field(5), read.scale)) return false;
        window.message.push_back(read);
        return numbers(field(6), window.constraint.size(), window.use) && flag(field(7), window.message.back().sent);
    }

    bool read_traffic(PyObject* object, Window& window) const {
        if (!is(object, traffic_) || PyTuple_GET_SIZE(object) != 2) return false;
        double sent = 0.0;
        if (!number(PyTuple_GET_ITEM(object, 0), sent)) return false;
        window.traffic_sent.push_back(sent);
        return numbers(PyTuple_GET_ITEM(object, 1), window.constraint.size(), window.traffic_use);
    }

    // Most messages share theirs.
    bool read_utility(PyObject* object, std::int32_t& place, Window& window) {
        const auto [known, unseen] = seen_.try_emplace(object, static_cast<std::int32_t>(window.utility.size()));
        place = known->second;
        if (!unseen) return true;
        const std::optional<Utility> utility = utility_of(object, utilities_);
        if (!utility) return false;
        window.utility.push_back(*utility);
        return true;
    }

    static constexpr const char* kParameters[][3] = {
        {"u0", "slope", nullptr}, {"a0", "a1", nullptr},   {"u0", "tau", nullptr},    {"u0", "lifetime", nullptr},
        {"u0", "a1", "k"},        {"beta", nullptr, nullptr}, {nullptr, nullptr, nullptr}, {"until", nullptr, nullptr},
    };

    // The array belongs to the utility, which lives as long as the problem.
    static void read_points(nanobind::handle object, Utility& utility) {
        using Shape = nanobind::shape<4, -1>;
        using Points = nanobind::ndarray<const double, Shape, nanobind::c_contig, nanobind::device::cpu>;
        const auto points = nanobind::cast<Points>(object.attr("curve").attr("points"));
        utility.points = points.data();
        utility.count = static_cast<std::ptrdiff_t>(points.shape(1));
    }

    PyObject* message_;
    PyObject* traffic_;
    PyObject* stream_;
    PyObject* receiver_;
    PyObject* constraint_;
    nanobind::tuple aggregations_;
    nanobind::tuple utilities_;
    std::unordered_map<PyObject*, std::int32_t> seen_;
};

}  // namespace sendworthy
