#pragma once

#include <cstdint>
#include <vector>

#include "firmware/can/frame.h"

namespace armada {

/// One field of a frame's payload. The codecs read and write the wire through these, and the DBC files and
/// `armada can decode` are made of the same tables: what is documented is what is sent.
struct CanSignal {
  enum class Kind : uint8_t { kUnsigned, kSigned, kFloat32 };
  enum class ByteOrder : uint8_t { kLittle, kBig };

  const char* name;
  /// Little-endian: position of the lowest bit. Big-endian: position of the highest bit. Both count as DBC
  /// files do: bit b of byte n is 8 n + b.
  uint16_t start_bit;
  uint8_t bits;  ///< 1 to 32; 32 for kFloat32
  Kind kind = Kind::kUnsigned;
  ByteOrder byte_order = ByteOrder::kLittle;
  const char* unit = "";
  double scale = 1.0;  ///< physical = scale raw + offset; not used for kFloat32
  double offset = 0.0;
};

/// Bits of the signal, not interpreted. @pre the signal lies within the frame's 64 bytes
uint32_t GetRaw(const CanFrame& frame, const CanSignal& signal);
void PutRaw(const CanSignal& signal, uint32_t raw, CanFrame* frame);

/// Physical value, in the signal's unit. Put rounds to the nearest raw value and clips to what the bits hold;
/// a NaN is written as the raw value of 0, for kFloat32 as itself.
double GetPhysical(const CanFrame& frame, const CanSignal& signal);
void PutPhysical(const CanSignal& signal, double value, CanFrame* frame);

/// A message as it stands on one bus: what a DBC file says of it.
struct CanMessage {
  const char* name;
  uint32_t id = 0;
  bool extended = false;
  bool fd = false;
  bool from_drive = false;  ///< else from the master
  uint8_t length = 0;       ///< bytes
  std::vector<CanSignal> signals;
  /// Several messages may share an identifier: those whose signal `multiplexor` (an index in `signals`) has
  /// this raw value. Negative: the identifier alone tells.
  int multiplexor = -1;
  uint32_t multiplexor_raw = 0;
  const char* meaning = "";
};

}  // namespace armada
