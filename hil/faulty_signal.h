#pragma once

#include <array>
#include <cstdint>

#include "hil/fault.h"

namespace armada {

/// A number that a fault makes something else of: what a drive senses, or the torque that it produces. No
/// heap; the same seed gives the same numbers.
class FaultySignal {
 public:
  static constexpr double kPeriod_s = 0.001;  ///< of random values, of drop-outs and of what a delay knows
  static constexpr double kMaxDelay_s = 0.1;

  FaultySignal(const FaultConfig& fault, uint64_t seed);

  /// The fault holds from now on, and the true value is `truth`; again at due_s(), or later.
  void Update(double t_s, double truth);
  /// When Update is next needed while the fault holds; infinity when what comes out follows from the truth.
  double due_s() const;
  /// What the true value becomes. @pre Update was called
  double Of(double truth) const;

 private:
  void Begin(double t_s, double truth);
  void Take(double truth);

  FaultWay way_;
  bool is_factor_;  ///< wrong: times `value_`, not plus
  double value_;
  uint64_t seed_;
  double period_s_;  ///< 0: nothing to renew
  bool begun_ = false;
  double start_s_ = 0.0;
  uint64_t count_ = 0;  ///< of renewals
  double held_ = 0.0;
  bool dropped_ = false;
  std::array<double, 101> past_{};  ///< delayed: a ring, one a period
};

}  // namespace armada
