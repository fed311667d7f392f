#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/can/frame.h"
#include "firmware/can/joint_drive_config.h"
#include "firmware/can/signal.h"
#include "hil/fault.h"

namespace armada {

/// Whether a drive of the joint's profile says on the bus in which state it is.
bool TellsStatus(const JointDriveConfig& joint);

/// Withholds the frames in which a drive tells its state, or changes what they say. Where the state travels
/// with a sample, the frame goes out without it. Allocates in the constructor only.
class FaultyStatus {
 public:
  FaultyStatus(const JointDriveConfig& joint, const FaultConfig& fault, uint64_t seed);

  /// A frame that the drive sends; with `active` the fault holds. False: it does not reach the bus.
  bool Pass(double t_s, bool active, CanFrame* frame);

 private:
  static constexpr size_t kMaxSignals = 2;
  using Raw = std::array<uint32_t, kMaxSignals>;

  /// What was told at a time.
  struct Told {
    double t_s = 0.0;
    Raw raw{};
  };
  /// A message that tells the state.
  struct Teller {
    CanMessage message;  ///< as on the bus; its `signals` are those of the state alone
    std::optional<CanSignal> multiplexor;
    bool alone;  ///< the message is about nothing else
    Raw error;   ///< what it says when the drive has one
    std::array<Told, 64> past{};
    size_t count = 0;  ///< told so far
    Told held{};       ///< stuck, slow: what is told
    bool holds = false;
    double next_s = 0.0;  ///< slow
  };

  static std::vector<Teller> TellersOf(const JointDriveConfig& joint);
  static bool Is(const CanFrame& frame, const Teller& teller);

  bool Change(double t_s, Teller& teller, Raw* raw);
  bool Withhold(const Teller& teller, Raw* raw) const;
  Raw RawAt(double t_s, const Teller& teller) const;

  FaultWay way_;
  double value_;
  uint64_t seed_;
  uint64_t frames_ = 0;  ///< changed so far
  std::vector<Teller> tellers_;
};

}  // namespace armada
