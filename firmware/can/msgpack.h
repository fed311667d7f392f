#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace armada {

/// As much of MessagePack as the user-space bus needs, without a heap.
/// https://github.com/msgpack/msgpack/blob/master/spec.md

/// Writes the shortest form of each value, as msgpack-python does. The caller's buffer must be large enough:
/// what does not fit is left out and `size()` becomes 0.
class MsgpackWriter {
 public:
  explicit MsgpackWriter(std::span<uint8_t> buffer) : buffer_(buffer) {}

  void MapHeader(uint8_t pairs);  ///< pairs <= 15
  void Nil();
  void Bool(bool value);
  void Unsigned(uint32_t value);
  void Float64(double value);
  void String(std::string_view text);            ///< at most 31 bytes
  void Bytes(std::span<const uint8_t> payload);  ///< at most 255 bytes

  size_t size() const { return overflow_ ? 0 : size_; }

 private:
  void Byte(uint8_t value);
  void BigEndian(uint64_t value, int bytes);

  std::span<uint8_t> buffer_;
  size_t size_ = 0;
  bool overflow_ = false;
};

/// Reads values of any width. Every call returns false when the next value is of another type or does not fit
/// in the bytes that are left; the reader is of no use after that.
class MsgpackReader {
 public:
  explicit MsgpackReader(std::span<const uint8_t> bytes) : left_(bytes) {}

  bool ReadMapHeader(uint32_t* pairs);
  bool ReadString(std::string_view* text);            ///< views into the buffer
  bool ReadBytes(std::span<const uint8_t>* payload);  ///< views into the buffer
  bool ReadUnsigned(uint64_t* value);  ///< also from signed forms of a value that is not negative
  bool ReadBool(bool* value);          ///< also from the integers 0 and 1, as Python's users write
  bool SkipNumber();                   ///< any integer or float
  bool Skip();                         ///< any value, however nested

  bool at_end() const { return left_.empty(); }

 private:
  bool Take(uint64_t count, std::span<const uint8_t>* bytes);
  bool TakeBigEndian(int bytes, uint64_t* value);
  /// Reads the size that follows `tag` in the family of three tags that starts at `first`, with sizes of 1,
  /// 2, 4 bytes.
  bool TakeSize(uint8_t tag, uint8_t first, uint64_t* size);

  std::span<const uint8_t> left_;
};

}  // namespace armada
