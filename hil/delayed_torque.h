#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace armada {

/// Torque of a drive, or torques of an arm's drives, that follow their commands one latency later: constant
/// from one change to the next, zero before the first.
template <class Torque = double>
class DelayedTorque {
 public:
  explicit DelayedTorque(double latency_s) : latency_s_(latency_s) {}

  double latency_s() const { return latency_s_; }

  /// The torque is `tau_Nm` from one latency after `t_s` on. Times do not decrease.
  void Schedule(double t_s, const Torque& tau_Nm) {
    Apply(t_s);
    // More commands within one latency than there is room for: the last of them wins.
    if (count_ == pending_.size()) --count_;
    pending_[count_++] = {t_s + latency_s_, tau_Nm};
  }

  /// The power stage goes off: no torque from now on, and nothing that was under way.
  void Cut() {
    tau_Nm_ = {};
    count_ = 0;
  }

  /// Forgets changes that have happened by `t_s`.
  void Apply(double t_s) {
    size_t applied = 0;
    while (applied < count_ && pending_[applied].t_s <= t_s) tau_Nm_ = pending_[applied++].tau_Nm;
    std::move(pending_.begin() + applied, pending_.begin() + count_, pending_.begin());
    count_ -= applied;
  }

  /// Torque at `t_s`; a change at that very time has happened.
  Torque At(double t_s) const {
    Torque tau_Nm = tau_Nm_;
    for (size_t i = 0; i < count_ && pending_[i].t_s <= t_s; ++i) tau_Nm = pending_[i].tau_Nm;
    return tau_Nm;
  }

  /// First change after `t_s`; infinity when there is none.
  double NextChange(double t_s) const {
    for (size_t i = 0; i < count_; ++i) {
      if (pending_[i].t_s > t_s) return pending_[i].t_s;
    }
    return std::numeric_limits<double>::infinity();
  }

 private:
  struct Change {
    double t_s = 0.0;
    Torque tau_Nm{};
  };

  double latency_s_;
  Torque tau_Nm_{};  ///< in force before the first of the pending changes
  std::array<Change, 16> pending_{};
  size_t count_ = 0;
};

}  // namespace armada
