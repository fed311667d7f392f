#pragma once

#include <cstdint>
#include <span>

#include "firmware/can/canopen_sdo.h"
#include "firmware/can/joint_drive_config.h"

namespace armada::cia402 {

/// The object dictionary of a CiA 402 drive, as far as a master in cyclic synchronous torque needs it. What
/// the master writes, what the emulated drive holds and what the EDS file says come from this one table.
/// Sources: CiA 301 4.2 chapter 7.5 for 1000h to 1FFFh, CiA 402-2 4.1 for 6000h on.

using canopen::Entry;

/// Numbers as in CiA 301 table 44 and in EDS files.
enum class DataType : uint8_t {
  kInteger8 = 2,
  kInteger16 = 3,
  kInteger32 = 4,
  kUnsigned8 = 5,
  kUnsigned16 = 6,
  kUnsigned32 = 7,
};
constexpr bool IsSigned(DataType type) {
  return type <= DataType::kInteger32;
}
constexpr uint8_t BytesOf(DataType type) {
  switch (type) {
    case DataType::kInteger8:
    case DataType::kUnsigned8:
      return 1;
    case DataType::kInteger16:
    case DataType::kUnsigned16:
      return 2;
    case DataType::kInteger32:
    case DataType::kUnsigned32:
      break;
  }
  return 4;
}
/// The raw bits of `type` as a number.
constexpr int64_t ValueOf(DataType type, uint32_t raw) {
  switch (type) {
    case DataType::kInteger8:
      return static_cast<int8_t>(raw);
    case DataType::kInteger16:
      return static_cast<int16_t>(raw);
    case DataType::kInteger32:
      return static_cast<int32_t>(raw);
    case DataType::kUnsigned8:
    case DataType::kUnsigned16:
    case DataType::kUnsigned32:
      break;
  }
  return raw;
}

enum class Access : uint8_t { kConstant, kReadOnly, kReadWrite };

struct Object {
  Entry entry;
  const char* name;
  DataType type;
  Access access;
  uint32_t default_value;
  bool add_node = false;  ///< the default is this plus the node id
  bool mappable = false;  ///< into a PDO
  int64_t low = 0;        ///< legal values; low = high: whatever the type holds
  int64_t high = 0;
  const char* meaning = "";
};

/// In order of their entries.
std::span<const Object> Objects();

/// The object at `entry`; null when there is none.
const Object* Find(Entry entry);

/// Raw value of the joint's drive when it is switched on.
uint32_t DefaultOf(const Object& object, const JointDriveConfig& joint);

/// Objects mapped into a PDO are at most this many.
inline constexpr uint8_t kMaxMapped = 4;

inline constexpr Entry kDeviceType{0x1000, 0};
inline constexpr Entry kErrorRegister{0x1001, 0};
inline constexpr Entry kConsumerHeartbeat{0x1016, 1};
inline constexpr Entry kProducerHeartbeat{0x1017, 0};
inline constexpr Entry kErrorBehaviour{0x1029, 1};
inline constexpr Entry kRpdo1CobId{0x1400, 1};
inline constexpr Entry kRpdo1Type{0x1400, 2};
inline constexpr Entry kRpdo1Timeout{0x1400, 5};
inline constexpr Entry kAbortConnection{0x6007, 0};
inline constexpr Entry kErrorCode{0x603F, 0};
inline constexpr Entry kControlword{0x6040, 0};
inline constexpr Entry kStatusword{0x6041, 0};
inline constexpr Entry kQuickStopOption{0x605A, 0};
inline constexpr Entry kFaultReactionOption{0x605E, 0};
inline constexpr Entry kMode{0x6060, 0};
inline constexpr Entry kModeDisplay{0x6061, 0};
inline constexpr Entry kPosition{0x6064, 0};
inline constexpr Entry kVelocity{0x606C, 0};
inline constexpr Entry kTargetTorque{0x6071, 0};
inline constexpr Entry kMaxTorque{0x6072, 0};
inline constexpr Entry kRatedTorque{0x6076, 0};
inline constexpr Entry kTorque{0x6077, 0};
inline constexpr Entry kSupportedModes{0x6502, 0};

/// 1400h, 1800h, 1801h: communication parameters of a PDO. Its mapping stands 200h further on.
inline constexpr uint16_t kRpdo1 = 0x1400;
inline constexpr uint16_t kTpdo1 = 0x1800;
inline constexpr uint16_t kTpdo2 = 0x1801;
constexpr uint16_t MappingOf(uint16_t pdo) {
  return static_cast<uint16_t>(pdo + 0x200);
}

}  // namespace armada::cia402
