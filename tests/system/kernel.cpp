// The native search kernels without Python, for the sanitizers: reads tabulated problems, prints plans.
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include "best.h"
#include "paper.h"
#include "tables.h"

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

Tables read_tables() {
    Tables tables;
    tables.levels = number();
    tables.streams = number();
    tables.constraints = number();
    tables.current = number();
    tables.facts = real();
    fill(tables.level, [] {
        Level level{};
        level.stream = number();
        level.gain_start = number();
        level.check_start = number();
        level.held = number();
        level.never = number() != 0;
        return level;
    });
    fill(tables.gain, real);
    fill(tables.after, number);
    fill(tables.state_start, number);
    fill(tables.markovian, [] { return static_cast<char>(number()); });
    fill(tables.check, [] {
        Check check{};
        check.of = number();
        check.first = number();
        check.room = real();
        return check;
    });
    fill(tables.row, [] {
        Row row{};
        row.of = number();
        row.first = number();
        row.last = number();
        row.capacity = real();
        return row;
    });
    fill(tables.use, real);
    fill(tables.share, real);
    fill(tables.scale, real);
    return tables;
}

void print(const std::vector<std::int32_t>& sends) {
    for (const auto level : sends) std::cout << level << ' ';
    std::cout << '\n';
}

}  // namespace

int main() {
    const auto problems = next<int>();
    for (int at = 0; at < problems; ++at) {
        const Tables tables = read_tables();
        const auto iterations = number();
        const auto nodes = number();
        if (next<std::string>() == "best") {
            BestSearch best(tables, nodes);
            best.run(iterations);
            print(best.found().sends);
            continue;
        }
        for (const auto reduction : {ReductionKind::off, ReductionKind::paper, ReductionKind::exact}) {
            PaperSearch paper(tables, 0.35, reduction, nodes);
            paper.run(iterations);
            print(paper.found().sends);
        }
    }
}
