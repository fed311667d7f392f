#pragma once

#include <array>
#include <cstddef>

#include "firmware/can/frame.h"

namespace armada {

/// Frames that a codec wants sent, in order, without a heap. Sized for one arm's busiest tick:
/// 7 joints times 4 bring-up frames, one sample request and one torque.
class FrameList {
 public:
  static constexpr size_t kCapacity = 48;

  /// Appends a frame; false when the list is full (the frame is not taken).
  bool Push(const CanFrame& frame) {
    if (size_ == kCapacity) return false;
    frames_[size_++] = frame;
    return true;
  }
  void Clear() { size_ = 0; }
  size_t size() const { return size_; }
  const CanFrame& operator[](size_t i) const { return frames_[i]; }
  const CanFrame* begin() const { return frames_.data(); }
  const CanFrame* end() const { return frames_.data() + size_; }

 private:
  std::array<CanFrame, kCapacity> frames_{};
  size_t size_ = 0;
};

}  // namespace armada
