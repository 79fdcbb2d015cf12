// What a message is worth by its age, integrated in closed form: the standard kinds of planner/utility/.
// The twin of the `integrals` there: the same operations in the same order.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace sendworthy {

enum class UtilityKind : std::int8_t { linear, video, exponential, step, polynomial, power, table, custom };

// `points` are those of a PiecewiseLinear: `count` ages, values, slopes and areas, one row after the other.
struct Utility {
    UtilityKind kind;
    double first = 0.0;   // u0, a0 of video, beta of power, `until` of custom
    double second = 0.0;  // slope, a1, tau, lifetime
    double third = 0.0;   // u0 / slope of linear, ln(a1 / a0) of video, k of polynomial
    const double* points = nullptr;
    std::ptrdiff_t count = 0;

    Utility(UtilityKind kind, double first, double second, double third)
        : kind(kind), first(first), second(second), third(third) {
        if (kind == UtilityKind::linear) this->third = first / second;
        if (kind == UtilityKind::video) this->third = std::log(second / first);
    }

    // The value at the age 0; infinite where it has no limit.
    double initial() const {
        switch (kind) {
            case UtilityKind::video:
                return 1.0;
            case UtilityKind::power:
                return std::numeric_limits<double>::infinity();
            case UtilityKind::table:
            case UtilityKind::custom:
                return std::max(points[count], 0.0);
            default:
                return first;
        }
    }

    // The antiderivative at an age, 0 at the age 0; of all kinds but exponential.
    double area(double age) const {
        switch (kind) {
            case UtilityKind::linear: {
                const double lived = std::min(age, third);
                return lived * (first - 0.5 * second * lived);
            }
            case UtilityKind::video: {
                const double aged = std::min(std::max(age, first), second);
                const double middle = aged + (aged * (1.0 - std::log(aged / first)) - first) / third;
                return std::min(age, first) - first + middle;
            }
            case UtilityKind::step:
                return std::min(age, second);
            case UtilityKind::polynomial: {
                const double lived = std::min(age, second);
                const double part = lived / second;
                const double power = third == 2.0 ? part * part : std::pow(part, third);  // in the plane it is often 2
                return first * lived * (1.0 - power / (third + 1.0));
            }
            case UtilityKind::power:
                return std::pow(age, 1.0 - first);
            case UtilityKind::table:
                return curve(std::upper_bound(points, points + count, age) - points - 1, age);
            case UtilityKind::custom: {
                constexpr double kCells = 512.0;
                const double part = std::sqrt(std::sqrt(std::min(age / first, 1.0)));
                return curve(static_cast<std::ptrdiff_t>(kCells * part), age);
            }
            case UtilityKind::exponential:
                break;
        }
        return 0.0;
    }

  private:
    double curve(std::ptrdiff_t at, double age) const {
        const double gone = age - points[at];
        return points[3 * count + at] + gone * (points[count + at] + 0.5 * gone * points[2 * count + at]);
    }
};

// Integrals that begin at one age; what they have in common is computed once.
class Integral {
  public:
    Integral(const Utility& utility, double start) : utility_(utility), start_(start), begin_(at(start)) {}

    // The integral up to an age that is not before the start.
    double to(double end) const { return end > start_ ? between(ending(end)) : 0.0; }

    // The same, and begin there from now on.
    double step(double end) {
        if (end <= start_) return 0.0;
        const double until = ending(end);
        const double area = between(until);
        start_ = end;
        begin_ = utility_.kind == UtilityKind::exponential ? at(end) : until;
        return area;
    }

  private:
    double at(double age) const {
        if (utility_.kind != UtilityKind::exponential) return utility_.area(age);
        return utility_.first * utility_.second * std::exp(-age / utility_.second);
    }

    double ending(double age) const {
        if (utility_.kind != UtilityKind::exponential) return utility_.area(age);
        return -std::expm1((start_ - age) / utility_.second);
    }

    double between(double until) const {
        switch (utility_.kind) {
            case UtilityKind::exponential:
                return begin_ * until;
            case UtilityKind::step:
                return utility_.first * (until - begin_);
            case UtilityKind::linear:
            case UtilityKind::video:
                return until - begin_;
            default:
                return std::max(until - begin_, 0.0);
        }
    }

    const Utility& utility_;
    double start_;
    double begin_;
};

}  // namespace sendworthy
