#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace armada {

/// An input as a sequence of choices, read from its front; zeros once it is used up.
class ByteSource {
 public:
  explicit ByteSource(std::span<const uint8_t> bytes) : left_(bytes) {}

  bool empty() const { return left_.empty(); }

  uint8_t Byte() { return static_cast<uint8_t>(Unsigned(1)); }
  int Signed16() { return std::bit_cast<int16_t>(static_cast<uint16_t>(Unsigned(2))); }
  double Double() { return std::bit_cast<double>(Unsigned(8)); }

  /// Little-endian, `bytes` <= 8.
  uint64_t Unsigned(unsigned bytes) {
    uint64_t value = 0;
    for (unsigned i = 0; i < bytes && !left_.empty(); ++i, left_ = left_.subspan(1)) {
      value |= uint64_t{left_.front()} << (8 * i);
    }
    return value;
  }

  /// Fills `out`.
  void Take(std::span<uint8_t> out) {
    const size_t count = std::min(out.size(), left_.size());
    std::copy_n(left_.begin(), count, out.begin());
    std::fill(out.begin() + static_cast<ptrdiff_t>(count), out.end(), uint8_t{0});
    left_ = left_.subspan(count);
  }

 private:
  std::span<const uint8_t> left_;
};

}  // namespace armada
