#pragma once

#include <cstdint>
#include <optional>

#include "firmware/can/moteus_messages.h"

namespace armada {

/// Types that a moteus register may be written and read as, in the order of the protocol.
enum class MoteusType : uint8_t { kInt8 = 0, kInt16 = 1, kInt32 = 2, kFloat = 3 };

/// Reads a frame's subframes from its first byte on. Each function gives nothing once the frame is used up.
class MoteusReader {
 public:
  explicit MoteusReader(const CanFrame& frame) : frame_(frame) {}

  std::optional<uint32_t> Varuint();
  /// A value of a register, in the unit of its float. The smallest integer means NaN, but in registers that
  /// are integers themselves.
  std::optional<double> Value(MoteusType type, moteus::Register reg);

 private:
  std::optional<uint32_t> Bytes(unsigned count);

  const CanFrame& frame_;
  unsigned at_ = 0;
};

/// Appends subframes to a frame. What does not fit is left out.
class MoteusWriter {
 public:
  explicit MoteusWriter(CanFrame* frame) : frame_(frame) {}

  void Varuint(uint32_t value);
  /// Saturates; what is not finite becomes the smallest integer.
  void Value(MoteusType type, moteus::Register reg, double value);
  unsigned length() const { return frame_->length; }
  void Truncate(unsigned length) { frame_->length = static_cast<uint8_t>(length); }

 private:
  void Bytes(uint32_t value, unsigned count);

  CanFrame* frame_;
};

}  // namespace armada
