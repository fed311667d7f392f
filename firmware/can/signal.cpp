#include "firmware/can/signal.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace armada {
namespace {

constexpr uint32_t Mask(const CanSignal& signal) {
  return signal.bits == 32 ? 0xFFFF'FFFFu : (1u << signal.bits) - 1;
}

/// Place in the payload of the signal's bit `i`, counted from its lowest.
constexpr unsigned PlaceOf(const CanSignal& signal, unsigned i) {
  if (signal.byte_order == CanSignal::ByteOrder::kLittle) return signal.start_bit + i;
  // Down the bits of a byte and on at the top of the next: linear once bits are counted from the top.
  const unsigned top = signal.start_bit / 8u * 8u + (7u - signal.start_bit % 8u);
  const unsigned place = top + signal.bits - 1u - i;
  return place / 8u * 8u + (7u - place % 8u);
}

// From one byte of the payload to the next: the signal's bits from `i` up that lie in one byte.
struct Piece {
  unsigned byte, shift, bits;
};

constexpr Piece PieceOf(const CanSignal& signal, unsigned i) {
  const unsigned place = PlaceOf(signal, i);
  return {place / 8, place % 8, std::min(8 - place % 8, signal.bits - i)};
}

}  // namespace

uint32_t GetRaw(const CanFrame& frame, const CanSignal& signal) {
  uint32_t raw = 0;
  for (unsigned i = 0; i < signal.bits;) {
    const Piece piece = PieceOf(signal, i);
    const unsigned mask = (1u << piece.bits) - 1;
    raw |= (frame.data[piece.byte] >> piece.shift & mask) << i;
    i += piece.bits;
  }
  return raw;
}

void PutRaw(const CanSignal& signal, uint32_t raw, CanFrame* frame) {
  for (unsigned i = 0; i < signal.bits;) {
    const Piece piece = PieceOf(signal, i);
    const unsigned mask = ((1u << piece.bits) - 1) << piece.shift;
    uint8_t& byte = frame->data[piece.byte];
    byte = static_cast<uint8_t>((byte & ~mask) | (raw >> i << piece.shift & mask));
    i += piece.bits;
  }
}

double GetPhysical(const CanFrame& frame, const CanSignal& signal) {
  const uint32_t raw = GetRaw(frame, signal);
  switch (signal.kind) {
    case CanSignal::Kind::kFloat32:
      return std::bit_cast<float>(raw);
    case CanSignal::Kind::kSigned: {
      const uint32_t sign = 1u << (signal.bits - 1);
      const double value =
          static_cast<double>(raw & ~sign) - ((raw & sign) != 0 ? static_cast<double>(sign) : 0.0);
      return signal.scale * value + signal.offset;
    }
    case CanSignal::Kind::kUnsigned:
      break;
  }
  return signal.scale * raw + signal.offset;
}

void PutPhysical(const CanSignal& signal, double value, CanFrame* frame) {
  if (signal.kind == CanSignal::Kind::kFloat32) {
    return PutRaw(signal, std::bit_cast<uint32_t>(static_cast<float>(value)), frame);
  }
  const bool is_signed = signal.kind == CanSignal::Kind::kSigned;
  const double low = is_signed ? -std::ldexp(1.0, signal.bits - 1) : 0.0;
  const double high = low + Mask(signal);
  double raw = std::round(((std::isnan(value) ? 0.0 : value) - signal.offset) / signal.scale);
  raw = raw < low ? low : raw > high ? high : raw;
  PutRaw(signal, static_cast<uint32_t>(static_cast<int64_t>(raw)) & Mask(signal), frame);
}

}  // namespace armada
