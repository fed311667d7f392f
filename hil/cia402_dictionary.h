#pragma once

#include <cstdint>
#include <vector>

#include "firmware/can/canopen_sdo.h"
#include "firmware/can/cia402_objects.h"

namespace armada {

/// Object dictionary of an emulated CiA 402 drive: values, and what a write may do to them.
class Cia402Dictionary {
 public:
  explicit Cia402Dictionary(const JointDriveConfig& joint);

  /// Objects with an index in [first, last] as when the drive was switched on.
  void Reset(uint16_t first, uint16_t last);

  /// @pre the object exists
  uint32_t Raw(cia402::Entry entry) const;
  int64_t Get(cia402::Entry entry) const;
  void Set(cia402::Entry entry, int64_t value);

  /// Access over SDO. A write of `bytes` 0 left its length open.
  canopen::SdoAbort Read(cia402::Entry entry, uint8_t* bytes, uint32_t* raw) const;
  canopen::SdoAbort Write(cia402::Entry entry, uint8_t bytes, uint32_t raw);

  /// Write out of a PDO: a value that may not be is dropped.
  void WriteMapped(cia402::Entry entry, uint32_t raw);

  /// True when the PDO with communication parameters at `pdo` exists.
  bool Exists(uint16_t pdo) const;

 private:
  canopen::SdoAbort CheckValue(const cia402::Object& object, uint32_t raw) const;
  canopen::SdoAbort CheckCommunication(cia402::Entry entry, uint32_t raw) const;
  canopen::SdoAbort CheckMapping(cia402::Entry entry, uint32_t raw) const;

  JointDriveConfig joint_;
  std::vector<uint32_t> raw_;  ///< one an object
};

}  // namespace armada
