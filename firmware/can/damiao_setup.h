#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "firmware/can/damiao_messages.h"
#include "firmware/can/frame_list.h"

namespace armada {

/// Brings the registers of a Damiao drive in line with the fleet file, one after the other: the ranges must
/// agree, mode and time-out are written if they do not, and read back. A register that does not answer is
/// asked again. Without I/O, clock and heap, but for Explain.
class DamiaoSetup {
 public:
  explicit DamiaoSetup(const JointDriveConfig& joint);

  /// Appends what is to be sent now, two frames at most. Once a control period.
  void Step(FrameList* out);
  void OnAnswer(const damiao::RegisterAccess& answer);

  bool done() const { return step_ == steps_.size(); }
  bool refused() const { return refused_; }
  /// What is missing, or differs, with both values.
  std::string Explain() const;

  /// Writes of one register whose read-back may differ before the drive is refused: a write may be lost.

 private:
  struct Setting {
    damiao::Register reg;
    const char* name;
    uint32_t raw;    ///< the bits wanted
    bool is_float;   ///< else u32
    bool may_write;  ///< else the two must agree as they are
  };

  JointDriveConfig joint_;
  std::array<Setting, 5> steps_;
  size_t step_ = 0;
  int writes_ = 0;
  bool differs_ = false;  ///< the register was read, and is not what it should be
  uint32_t found_ = 0;
  bool refused_ = false;
};

}  // namespace armada
