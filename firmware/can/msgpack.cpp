#include "firmware/can/msgpack.h"

#include <bit>

namespace armada {
namespace {

// First bytes of the values; "fix" forms carry their size or value in the low bits.
constexpr uint8_t kFixMap = 0x80;
constexpr uint8_t kFixArray = 0x90;
constexpr uint8_t kFixString = 0xA0;
constexpr uint8_t kNil = 0xC0;
constexpr uint8_t kFalse = 0xC2;
constexpr uint8_t kTrue = 0xC3;
constexpr uint8_t kBin8 = 0xC4;
constexpr uint8_t kBin32 = 0xC6;
constexpr uint8_t kExt8 = 0xC7;
constexpr uint8_t kExt32 = 0xC9;
constexpr uint8_t kFloat32 = 0xCA;
constexpr uint8_t kFloat64 = 0xCB;
constexpr uint8_t kUint8 = 0xCC;
constexpr uint8_t kUint64 = 0xCF;
constexpr uint8_t kInt8 = 0xD0;
constexpr uint8_t kInt64 = 0xD3;
constexpr uint8_t kFixExt1 = 0xD4;
constexpr uint8_t kFixExt16 = 0xD8;
constexpr uint8_t kString8 = 0xD9;
constexpr uint8_t kString32 = 0xDB;
constexpr uint8_t kArray16 = 0xDC;
constexpr uint8_t kMap16 = 0xDE;
constexpr uint8_t kMap32 = 0xDF;
constexpr uint8_t kNegativeFixInt = 0xE0;

constexpr bool IsPositiveFixInt(uint8_t tag) {
  return tag < kFixMap;
}
constexpr bool IsFixMap(uint8_t tag) {
  return (tag & 0xF0) == kFixMap;
}
constexpr bool IsFixArray(uint8_t tag) {
  return (tag & 0xF0) == kFixArray;
}
constexpr bool IsFixString(uint8_t tag) {
  return (tag & 0xE0) == kFixString;
}
constexpr bool IsBetween(uint8_t tag, uint8_t first, uint8_t last) {
  return tag >= first && tag <= last;
}

}  // namespace

void MsgpackWriter::Byte(uint8_t value) {
  if (size_ == buffer_.size()) {
    overflow_ = true;
  } else {
    buffer_[size_++] = value;
  }
}

void MsgpackWriter::BigEndian(uint64_t value, int bytes) {
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) Byte(static_cast<uint8_t>(value >> shift));
}

void MsgpackWriter::MapHeader(uint8_t pairs) {
  Byte(static_cast<uint8_t>(kFixMap | pairs));
}
void MsgpackWriter::Nil() {
  Byte(kNil);
}
void MsgpackWriter::Bool(bool value) {
  Byte(value ? kTrue : kFalse);
}

void MsgpackWriter::Unsigned(uint32_t value) {
  const int log2_bytes = value <= UINT8_MAX ? 0 : value <= UINT16_MAX ? 1 : 2;
  if (value >= kFixMap) Byte(static_cast<uint8_t>(kUint8 + log2_bytes));
  BigEndian(value, 1 << log2_bytes);
}

void MsgpackWriter::Float64(double value) {
  Byte(kFloat64);
  BigEndian(std::bit_cast<uint64_t>(value), 8);
}

void MsgpackWriter::String(std::string_view text) {
  Byte(static_cast<uint8_t>(kFixString | text.size()));
  for (const char c : text) Byte(static_cast<uint8_t>(c));
}

void MsgpackWriter::Bytes(std::span<const uint8_t> payload) {
  Byte(kBin8);
  Byte(static_cast<uint8_t>(payload.size()));
  for (const uint8_t byte : payload) Byte(byte);
}

bool MsgpackReader::Take(uint64_t count, std::span<const uint8_t>* bytes) {
  if (count > left_.size()) return false;
  *bytes = left_.first(count);
  left_ = left_.subspan(count);
  return true;
}

bool MsgpackReader::TakeBigEndian(int bytes, uint64_t* value) {
  std::span<const uint8_t> taken;
  if (!Take(static_cast<uint64_t>(bytes), &taken)) return false;
  *value = 0;
  for (const uint8_t byte : taken) *value = *value << 8 | byte;
  return true;
}

bool MsgpackReader::TakeSize(uint8_t tag, uint8_t first, uint64_t* size) {
  return TakeBigEndian(1 << (tag - first), size);
}

bool MsgpackReader::ReadMapHeader(uint32_t* pairs) {
  uint64_t head = 0;
  if (!TakeBigEndian(1, &head)) return false;
  const auto tag = static_cast<uint8_t>(head);
  uint64_t count = tag & 0x0F;
  const bool wide = tag == kMap16 || tag == kMap32;
  if (!IsFixMap(tag) && !(wide && TakeBigEndian(tag == kMap16 ? 2 : 4, &count))) return false;
  *pairs = static_cast<uint32_t>(count);
  return true;
}

bool MsgpackReader::ReadString(std::string_view* text) {
  uint64_t head = 0;
  if (!TakeBigEndian(1, &head)) return false;
  const auto tag = static_cast<uint8_t>(head);
  uint64_t size = tag & 0x1F;
  if (!IsFixString(tag) && !(IsBetween(tag, kString8, kString32) && TakeSize(tag, kString8, &size)))
    return false;
  std::span<const uint8_t> bytes;
  if (!Take(size, &bytes)) return false;
  *text = {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  return true;
}

bool MsgpackReader::ReadBytes(std::span<const uint8_t>* payload) {
  uint64_t head = 0;
  if (!TakeBigEndian(1, &head)) return false;
  const auto tag = static_cast<uint8_t>(head);
  uint64_t size = 0;
  return IsBetween(tag, kBin8, kBin32) && TakeSize(tag, kBin8, &size) && Take(size, payload);
}

bool MsgpackReader::ReadUnsigned(uint64_t* value) {
  uint64_t head = 0;
  if (!TakeBigEndian(1, &head)) return false;
  const auto tag = static_cast<uint8_t>(head);
  if (IsPositiveFixInt(tag)) {
    *value = tag;
    return true;
  }
  if (IsBetween(tag, kUint8, kUint64)) return TakeBigEndian(1 << (tag - kUint8), value);
  if (!IsBetween(tag, kInt8, kInt64)) return false;
  const int bytes = 1 << (tag - kInt8);
  if (!TakeBigEndian(bytes, value)) return false;
  return *value >> (8 * bytes - 1) == 0;  // sign bit
}

bool MsgpackReader::ReadBool(bool* value) {
  if (left_.empty()) return false;
  if (left_[0] == kFalse || left_[0] == kTrue) {
    *value = left_[0] == kTrue;
    left_ = left_.subspan(1);
    return true;
  }
  uint64_t number = 0;
  if (!ReadUnsigned(&number) || number > 1) return false;
  *value = number == 1;
  return true;
}

bool MsgpackReader::SkipNumber() {
  if (left_.empty()) return false;
  const uint8_t tag = left_[0];
  const bool number = IsPositiveFixInt(tag) || tag >= kNegativeFixInt || IsBetween(tag, kFloat32, kInt64);
  return number && Skip();
}

bool MsgpackReader::Skip() {
  // Nesting is a count of values still to skip, not a recursion: a hostile datagram cannot exhaust the stack,
  // and each value takes at least one byte, so the loop ends.
  for (uint64_t values = 1; values > 0; --values) {
    uint64_t head = 0;
    if (!TakeBigEndian(1, &head)) return false;
    const auto tag = static_cast<uint8_t>(head);
    uint64_t payload = 0;   // bytes that belong to this value
    uint64_t children = 0;  // values that belong to it
    bool ok = true;
    if (IsFixMap(tag)) {
      children = 2 * (head & 0x0F);
    } else if (IsFixArray(tag)) {
      children = head & 0x0F;
    } else if (IsFixString(tag)) {
      payload = head & 0x1F;
    } else if (IsBetween(tag, kBin8, kBin32)) {
      ok = TakeSize(tag, kBin8, &payload);
    } else if (IsBetween(tag, kExt8, kExt32)) {
      ok = TakeSize(tag, kExt8, &payload);
      ++payload;  // its type
    } else if (tag == kFloat32 || tag == kFloat64) {
      payload = tag == kFloat32 ? 4 : 8;
    } else if (IsBetween(tag, kUint8, kUint64)) {
      payload = 1u << (tag - kUint8);
    } else if (IsBetween(tag, kInt8, kInt64)) {
      payload = 1u << (tag - kInt8);
    } else if (IsBetween(tag, kFixExt1, kFixExt16)) {
      payload = 1 + (1u << (tag - kFixExt1));
    } else if (IsBetween(tag, kString8, kString32)) {
      ok = TakeSize(tag, kString8, &payload);
    } else if (IsBetween(tag, kArray16, kMap32)) {
      ok = TakeBigEndian(tag == kArray16 || tag == kMap16 ? 2 : 4, &children);
      if (tag >= kMap16) children *= 2;
    } else {
      // The rest is a value in its one byte: fix integers, nil, false, true; 0xC1 is never used.
      ok = tag != 0xC1;
    }
    std::span<const uint8_t> skipped;
    if (!ok || !Take(payload, &skipped)) return false;
    values += children;
  }
  return true;
}

}  // namespace armada
