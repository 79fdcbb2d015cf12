// The native tables and search kernels without Python, for the sanitizers: reads problems, prints plans.
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "best.h"
#include "paper.h"
#include "tabulate.h"
#include "window.h"

using namespace sendworthy;

namespace {

template <typename T>
T next() {
    T value{};
    if (!(std::cin >> value)) std::exit(2);
    return value;
}

template <typename T, typename Read>
void fill(std::vector<T>& values, Read read) {
    const auto count = next<std::size_t>();
    for (std::size_t at = 0; at < count; ++at) values.push_back(read());
}

std::int32_t number() { return next<std::int32_t>(); }

double real() { return std::stod(next<std::string>()); }  // hexadecimal, infinity: what streams do not read

// Points of utilities, which windows only refer to.
std::deque<std::vector<double>> curves;

Utility read_utility() {
    const auto kind = static_cast<UtilityKind>(number());
    const double first = real(), second = real(), third = real();
    Utility utility(kind, first, second, third);
    fill(curves.emplace_back(), real);
    utility.points = curves.back().data();
    utility.count = static_cast<std::ptrdiff_t>(curves.back().size() / 4);
    return utility;
}

Window read_window() {
    Window window;
    window.current = number();
    window.t_start = real();
    window.t_end = real();
    window.goes_on = number() != 0;
    fill(window.stream, [] {
        const auto robot = number(), aggregation = number(), receiver_start = number();
        const bool has_newest = number() != 0;
        const double t_gen = real(), scale = real();
        return Stream{robot, static_cast<Aggregation>(aggregation), receiver_start, has_newest, Latest{t_gen, scale}};
    });
    fill(window.receiver, [] {
        const double delay = real(), share = real();
        return Receiver{delay, share};
    });
    fill(window.utility, read_utility);
    fill(window.message, [] {
        Message message{};
        message.stream = number();
        message.utility = number();
        message.t_gen = real();
        message.t_sent = real();
        message.t_rcv = real();
        message.scale = real();
        message.sent = number() != 0;
        return message;
    });
    fill(window.constraint, [] {
        const double length = real(), limit = real();
        return Constraint{length, limit};
    });
    fill(window.use, real);
    fill(window.traffic_sent, real);
    fill(window.traffic_use, real);
    return window;
}

void print(const std::vector<std::int32_t>& sends) {
    for (const auto level : sends) std::cout << level << ' ';
    std::cout << '\n';
}

}  // namespace

int main() {
    const auto problems = next<int>();
    for (int at = 0; at < problems; ++at) {
        const Window window = read_window();
        const auto iterations = number();
        const auto nodes = number();
        const bool is_best = next<std::string>() == "best";
        const auto tabulated = window.valid() ? tabulate(window, is_best) : std::nullopt;
        if (!tabulated) return 3;
        const Tables tables = tabulated->tables();
        if (is_best) {
            BestSearch best(tables, nodes);
            best.run(iterations);
            const std::vector<std::int32_t> sends = best.found().sends;
            tabulated->worth(sends);
            tabulated->overfilled(sends);
            print(sends);
            continue;
        }
        for (const auto reduction : {ReductionKind::off, ReductionKind::paper, ReductionKind::exact}) {
            PaperSearch paper(tables, 0.35, reduction, nodes);
            paper.run(iterations);
            print(paper.found().sends);
        }
    }
}
