// The steady state: every stream sends at the regular interval that pays best when limits have a price.
// The twin of planner/steady.py, where the reasons are written out.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "window.h"

namespace sendworthy {

constexpr std::size_t kIntervals = 16;
constexpr std::array<double, kIntervals> kInterval{1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 25, 32, 50, 100, 300};
constexpr double kLongest = kInterval.back();

// What rounding may change of a sum, as a part of it.
constexpr double kRounding = 1e-9;

// What a stream that goes on earns and sends a second, by the interval between its sends.
struct Steady {
    std::int32_t stream;
    std::array<double, kIntervals> value;
    std::array<double, kIntervals> rate;

    // The shortest interval that pays best at this charge for a message, but for rounding, and what it pays.
    std::pair<std::size_t, double> best(double charge) const {
        std::array<double, kIntervals> net;
        for (std::size_t j = 0; j < kIntervals; ++j) net[j] = value[j] - rate[j] * charge;
        const double most = *std::max_element(net.begin(), net.end());
        const double enough = most - kRounding * *std::max_element(value.begin(), value.end());
        const auto first = std::find_if(net.begin(), net.end(), [enough](double each) { return each >= enough; });
        return {static_cast<std::size_t>(first - net.begin()) % kIntervals, most};
    }
};

class Clearing {
  public:
    // `use[i * constraints + k]` is what a message of the i-th of these streams uses.
    Clearing(const std::vector<Steady>& steady, const std::vector<double>& use, std::size_t constraints)
        : steady_(steady), use_(use), constraints_(constraints), marginal_(steady.size()), more_(steady.size()) {
        for (std::size_t i = 0; i < steady.size(); ++i) {
            for (std::size_t j = 0; j < kIntervals; ++j) {
                const bool last = j + 1 == kIntervals;
                more_[i][j] = steady[i].rate[j] - (last ? 0.0 : steady[i].rate[j + 1]);
                const double earned = (steady[i].value[j] - (last ? 0.0 : steady[i].value[j + 1])) / more_[i][j];
                finite_ = finite_ && std::isfinite(earned);
                marginal_[i][j] = j == 0 ? earned : std::max(marginal_[i][j - 1], earned);
            }
        }
        bids_.reserve(steady.size() * kIntervals);
    }

    // The price of each constraint at which the streams use up what is offered of it a second, no more.
    std::vector<double> prices(const std::vector<Constraint>& constraint) {
        std::vector<double> price(constraints_, 0.0);
        for (int sweep = 0; sweep < (constraints_ > 1 ? kSweeps : 1); ++sweep) {
            for (std::size_t k = 0; k < constraints_; ++k) {
                price[k] = 0.0;  // so that the others alone are charged
                bid(price, k);
                price[k] = clearing(constraint[k].limit / constraint[k].window * (1.0 + kRounding));
            }
        }
        return price;
    }

    // What a message of the i-th stream is charged.
    double charge(const std::vector<double>& price, std::size_t i) const {
        double charge = 0.0;
        for (std::size_t k = 0; k < constraints_; ++k) charge += use_[i * constraints_ + k] * price[k];
        return charge;
    }

  private:
    static constexpr int kSweeps = 3;

    struct Bid {
        double paid;    // for a unit
        double wanted;  // units a second
    };

    void bid(const std::vector<double>& price, std::size_t k) {
        bids_.clear();
        for (std::size_t i = 0; i < steady_.size(); ++i) {
            const double use = use_[i * constraints_ + k];
            if (!(use > 0.0)) continue;
            const double others = charge(price, i);
            for (std::size_t j = 0; j < kIntervals; ++j) {
                const Bid bid{(marginal_[i][j] - others) / use, more_[i][j] * use};
                finite_ = finite_ && std::isfinite(bid.paid) && std::isfinite(bid.wanted);
                bids_.push_back(bid);
            }
        }
    }

    // The first bid, in the order of what is paid, that is not wholly served by what is offered; 0 when all are. The
    // bids are not sorted for it, but parted again and again by one of them. Not finite where bids are not.
    double clearing(double offered) {
        if (!finite_) return std::numeric_limits<double>::quiet_NaN();
        auto begin = bids_.begin();
        auto end = bids_.end();
        while (begin != end) {
            const double pivot = (begin + (end - begin) / 2)->paid;
            double above = 0.0;
            double equal = 0.0;
            for (auto bid = begin; bid != end; ++bid) {
                (bid->paid > pivot ? above : equal) += bid->paid >= pivot ? bid->wanted : 0.0;
            }
            if (above > offered) {
                end = std::partition(begin, end, [pivot](const Bid& bid) { return bid.paid > pivot; });
            } else if (above + equal > offered) {
                return std::max(pivot, 0.0);
            } else {
                offered -= above + equal;
                begin = std::partition(begin, end, [pivot](const Bid& bid) { return bid.paid >= pivot; });
            }
        }
        return 0.0;
    }

    const std::vector<Steady>& steady_;
    const std::vector<double>& use_;
    std::size_t constraints_;
    std::vector<std::array<double, kIntervals>> marginal_;
    std::vector<std::array<double, kIntervals>> more_;
    std::vector<Bid> bids_;
    bool finite_ = true;
};

}  // namespace sendworthy
