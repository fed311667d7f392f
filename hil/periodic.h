#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace armada {

/// Something that falls due at k period, k = 0, 1, 2, ...
class Periodic {
 public:
  explicit Periodic(double period_s) : period_s_(period_s) {}  ///< 0: never

  double due_s() const {
    return period_s_ > 0.0 ? static_cast<double>(next_) * period_s_ : std::numeric_limits<double>::infinity();
  }

  /// True when it has fallen due by `t_s`, once however often it has.
  bool Take(double t_s) {
    if (due_s() > t_s) return false;
    next_ = std::max(next_, static_cast<uint64_t>(t_s / period_s_));
    while (due_s() <= t_s) ++next_;  // once or twice: the quotient above is rounded
    return true;
  }

 private:
  double period_s_;
  uint64_t next_ = 0;
};

}  // namespace armada
