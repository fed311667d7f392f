#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/can/frame.h"
#include "hil/fault.h"

namespace armada {

/// The CAN bus between a board and its drives when it has faults: frames are lost or late. Allocates in the
/// constructor only.
class FaultyWire {
 public:
  enum class Way { kToDrives, kFromDrives };

  /// A frame that was kept until `due_s`.
  struct Late {
    double due_s = 0.0;
    Way way = Way::kToDrives;
    CanFrame frame;
  };

  /// `faults` of one arm's bus.
  FaultyWire(std::vector<FaultConfig> faults, uint64_t seed);

  void Add(const FaultConfig& fault) { faults_.push_back(fault); }

  /// A frame is sent at the run's time `t_s`. True: it arrives at once. Otherwise it is lost, or it arrives
  /// later.
  bool Passes(double t_s, const CanFrame& frame, Way way);

  /// When the next late frame arrives; infinity when there is none.
  double NextArrival() const;
  /// A frame that has arrived by `t_s`, the oldest first.
  std::optional<Late> TakeArrived(double t_s);

 private:
  static constexpr size_t kCapacity = 1024;  ///< frames under way: more than a busy arm sends in 0.1 s

  std::vector<FaultConfig> faults_;
  uint64_t seed_;
  uint64_t frames_ = 0;      ///< sent so far
  std::vector<Late> queue_;  ///< a ring
  size_t first_ = 0;
  size_t count_ = 0;
};

/// Nothing when no fault is the bus's.
std::optional<FaultyWire> MakeFaultyWire(const std::vector<FaultConfig>& faults, int arm_id, uint64_t seed);

}  // namespace armada
