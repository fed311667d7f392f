#include "hil/moteus_subframes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace armada {
namespace {

using moteus::Register;

/// What one unit of each integer type is worth (docs/protocol/registers.md, "Mappings"). 0: a register that
/// is an integer.
struct Mapping {
  double int8;
  double int16;
  double int32;
};

Mapping MappingOf(Register reg) {
  switch (reg) {
    case Register::kPosition:
    case Register::kCommandPosition:
    case Register::kCommandStopPosition:
      return {0.01, 0.0001, 0.00001};
    case Register::kVelocity:
    case Register::kCommandVelocity:
      return {0.1, 0.00025, 0.00001};
    case Register::kTorque:
    case Register::kCommandTorque:
    case Register::kCommandMaxTorque:
      return {0.5, 0.01, 0.001};
    case Register::kVoltage:
      return {0.5, 0.1, 0.001};
    case Register::kTemperature:
      return {1.0, 0.1, 0.001};
    case Register::kCommandKpScale:
    case Register::kCommandKdScale:
      return {1.0 / 127.0, 1.0 / 32767.0, 1.0 / 2147483647.0};
    case Register::kCommandTimeout:
      return {0.01, 0.001, 0.000001};
    case Register::kMode:
    case Register::kFault:
    case Register::kRegisterMapVersion:
      break;
  }
  return {0.0, 0.0, 0.0};
}

double ScaleOf(MoteusType type, Register reg) {
  const Mapping mapping = MappingOf(reg);
  return type == MoteusType::kInt8    ? mapping.int8
         : type == MoteusType::kInt16 ? mapping.int16
                                      : mapping.int32;
}

unsigned SizeOf(MoteusType type) {
  return type == MoteusType::kInt8 ? 1 : type == MoteusType::kInt16 ? 2 : 4;
}

}  // namespace

std::optional<uint32_t> MoteusReader::Varuint() {
  uint32_t value = 0;
  for (unsigned shift = 0; shift < 35; shift += 7) {
    const std::optional<uint32_t> byte = Bytes(1);
    if (!byte) return std::nullopt;
    value |= (*byte & 0x7F) << shift;
    if ((*byte & 0x80) == 0) return value;
  }
  return std::nullopt;
}

std::optional<double> MoteusReader::Value(MoteusType type, Register reg) {
  const unsigned size = SizeOf(type);
  const std::optional<uint32_t> bits = Bytes(size);
  if (!bits) return std::nullopt;
  if (type == MoteusType::kFloat) return std::bit_cast<float>(*bits);
  const unsigned unused = 32 - 8 * size;
  const int32_t value = static_cast<int32_t>(*bits << unused) >> unused;
  const double scale = ScaleOf(type, reg);
  if (scale == 0.0) return value;
  const int32_t smallest = std::numeric_limits<int32_t>::min() >> unused;
  return value == smallest ? std::numeric_limits<double>::quiet_NaN() : scale * value;
}

std::optional<uint32_t> MoteusReader::Bytes(unsigned count) {
  if (at_ + count > frame_.length) return std::nullopt;
  uint32_t value = 0;
  for (unsigned i = 0; i < count; ++i) value |= static_cast<uint32_t>(frame_.data[at_ + i]) << (8 * i);
  at_ += count;
  return value;
}

void MoteusWriter::Varuint(uint32_t value) {
  for (; value >= 0x80; value >>= 7) Bytes(value | 0x80, 1);
  Bytes(value, 1);
}

void MoteusWriter::Value(MoteusType type, Register reg, double value) {
  if (type == MoteusType::kFloat) return Bytes(std::bit_cast<uint32_t>(static_cast<float>(value)), 4);
  const unsigned size = SizeOf(type);
  const int64_t largest = (int64_t{1} << (8 * size - 1)) - 1;
  const double scale = ScaleOf(type, reg);
  int64_t raw = -largest - 1;
  if (std::isfinite(value)) {
    // The firmware divides and truncates in single precision.
    const float units =
        scale == 0.0 ? static_cast<float>(value) : static_cast<float>(value) / static_cast<float>(scale);
    const auto bound = static_cast<double>(largest);
    raw = static_cast<int64_t>(std::clamp(static_cast<double>(units), -bound, bound));
  }
  Bytes(static_cast<uint32_t>(raw), size);
}

void MoteusWriter::Bytes(uint32_t value, unsigned count) {
  if (frame_->length + count > frame_->data.size()) return;
  for (unsigned i = 0; i < count; ++i)
    frame_->data[frame_->length++] = static_cast<uint8_t>(value >> (8 * i));
}

}  // namespace armada
