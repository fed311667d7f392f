#include "firmware/can/cia402_objects.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "firmware/can/canopen_messages.h"

namespace armada::cia402 {
namespace {

using enum DataType;
using enum Access;

constexpr Object Highest(uint16_t index, uint32_t sub) {
  return {.entry = {index, 0},
          .name = "Highest sub-index supported",
          .type = kUnsigned8,
          .access = kConstant,
          .default_value = sub};
}
constexpr Object PdoId(uint16_t index, uint32_t id) {
  return {.entry = {index, 1},
          .name = "COB-ID used by PDO",
          .type = kUnsigned32,
          .access = kReadWrite,
          .default_value = id,
          .add_node = true,
          .meaning = "bit 31: does not exist, bit 30: no remote frames, then the identifier"};
}
constexpr Object PdoType(uint16_t index) {
  return {.entry = {index, 2},
          .name = "Transmission type",
          .type = kUnsigned8,
          .access = kReadWrite,
          .default_value = canopen::kOnEvent,
          .meaning = "1 to 240: every so many SYNCs; 255: on event"};
}
constexpr Object Mapped(uint16_t index, uint32_t count) {
  return {.entry = {index, 0},
          .name = "Number of mapped objects",
          .type = kUnsigned8,
          .access = kReadWrite,
          .default_value = count,
          .low = 0,
          .high = kMaxMapped};
}
constexpr Object Mapping(uint16_t index, uint8_t sub, uint32_t what) {
  constexpr std::array<const char*, kMaxMapped> kNames = {"Mapped object 1", "Mapped object 2",
                                                          "Mapped object 3", "Mapped object 4"};
  return {.entry = {index, sub},
          .name = kNames[sub - 1u],
          .type = kUnsigned32,
          .access = kReadWrite,
          .default_value = what,
          .meaning = "index, sub-index, bits"};
}

// The default mappings are the general ones of CiA 402-3.
constexpr uint32_t kRpdoFlags = 0;
constexpr uint32_t kTpdoFlags = canopen::kNoRemoteFrame;
constexpr auto kObjects = std::to_array<Object>({
    {.entry = kDeviceType,
     .name = "Device type",
     .type = kUnsigned32,
     .access = kConstant,
     .default_value = 0x0002'0192,
     .meaning = "profile 402 (192h), servo drive"},
    {.entry = kErrorRegister,
     .name = "Error register",
     .type = kUnsigned8,
     .access = kReadOnly,
     .default_value = 0,
     .mappable = true,
     .meaning = "bit 0 any error, bit 4 communication"},
    {.entry = {0x1005, 0},
     .name = "COB-ID SYNC message",
     .type = kUnsigned32,
     .access = kReadOnly,
     .default_value = canopen::kSyncId},
    {.entry = {0x1014, 0},
     .name = "COB-ID EMCY",
     .type = kUnsigned32,
     .access = kReadOnly,
     .default_value = canopen::kEmergencyId,
     .add_node = true},
    Highest(0x1016, 1),
    {.entry = kConsumerHeartbeat,
     .name = "Consumer heartbeat time",
     .type = kUnsigned32,
     .access = kReadWrite,
     .default_value = 0,
     .meaning = "node << 16 | ms: silence of the node that is an error; 0 ms: not watched"},
    {.entry = kProducerHeartbeat,
     .name = "Producer heartbeat time",
     .type = kUnsigned16,
     .access = kReadWrite,
     .default_value = 0,
     .meaning = "ms; 0: none"},
    Highest(0x1018, 1),
    {.entry = {0x1018, 1},
     .name = "Vendor-ID",
     .type = kUnsigned32,
     .access = kReadOnly,
     .default_value = 0,
     .meaning = "0: not one that CiA has given out"},
    Highest(0x1029, 1),
    {.entry = kErrorBehaviour,
     .name = "Communication error",
     .type = kUnsigned8,
     .access = kReadWrite,
     .default_value = 0,
     .low = 0,
     .high = 2,
     .meaning = "state on a lost heartbeat: 0 pre-operational, 1 as it is, 2 stopped"},
    Highest(0x1200, 2),
    {.entry = {0x1200, 1},
     .name = "COB-ID client to server (rx)",
     .type = kUnsigned32,
     .access = kReadOnly,
     .default_value = canopen::kSdoRequestId,
     .add_node = true},
    {.entry = {0x1200, 2},
     .name = "COB-ID server to client (tx)",
     .type = kUnsigned32,
     .access = kReadOnly,
     .default_value = canopen::kSdoReplyId,
     .add_node = true},
    Highest(kRpdo1, 5),
    PdoId(kRpdo1, kRpdoFlags | canopen::kRpdo1Id),
    PdoType(kRpdo1),
    {.entry = kRpdo1Timeout,
     .name = "Event timer",
     .type = kUnsigned16,
     .access = kReadWrite,
     .default_value = 0,
     .meaning = "ms: silence after the first of these PDOs that is an error; 0: none"},
    Mapped(MappingOf(kRpdo1), 1),
    Mapping(MappingOf(kRpdo1), 1, 0x6040'0010),
    Mapping(MappingOf(kRpdo1), 2, 0),
    Mapping(MappingOf(kRpdo1), 3, 0),
    Mapping(MappingOf(kRpdo1), 4, 0),
    Highest(kTpdo1, 2),
    PdoId(kTpdo1, kTpdoFlags | canopen::kTpdo1Id),
    PdoType(kTpdo1),
    Highest(kTpdo2, 2),
    PdoId(kTpdo2, kTpdoFlags | canopen::kTpdo2Id),
    PdoType(kTpdo2),
    Mapped(MappingOf(kTpdo1), 1),
    Mapping(MappingOf(kTpdo1), 1, 0x6041'0010),
    Mapping(MappingOf(kTpdo1), 2, 0),
    Mapping(MappingOf(kTpdo1), 3, 0),
    Mapping(MappingOf(kTpdo1), 4, 0),
    Mapped(MappingOf(kTpdo2), 2),
    Mapping(MappingOf(kTpdo2), 1, 0x6041'0010),
    Mapping(MappingOf(kTpdo2), 2, 0x6061'0008),
    Mapping(MappingOf(kTpdo2), 3, 0),
    Mapping(MappingOf(kTpdo2), 4, 0),
    {.entry = kAbortConnection,
     .name = "Abort connection option code",
     .type = kInteger16,
     .access = kReadWrite,
     .default_value = 1,
     .low = 0,
     .high = 3,
     .meaning = "on a lost master: 0 nothing, 1 fault, 2 disable voltage, 3 quick stop"},
    {.entry = kErrorCode,
     .name = "Error code",
     .type = kUnsigned16,
     .access = kReadOnly,
     .default_value = 0,
     .mappable = true,
     .meaning = "of the last error, as in EMCY"},
    {.entry = kControlword,
     .name = "Controlword",
     .type = kUnsigned16,
     .access = kReadWrite,
     .default_value = 0,
     .mappable = true,
     .meaning =
         "6 shut down, 7 switch on, Fh enable, 2 quick stop, 0 disable voltage, bit 7 rising: fault reset"},
    {.entry = kStatusword,
     .name = "Statusword",
     .type = kUnsigned16,
     .access = kReadOnly,
     .default_value = 0,
     .mappable = true,
     .meaning = "state of the power drive system"},
    {.entry = kQuickStopOption,
     .name = "Quick stop option code",
     .type = kInteger16,
     .access = kReadWrite,
     .default_value = 2,
     .low = 0,
     .high = 8,
     .meaning = "0 no braking, 1 slow-down ramp, 2 quick-stop ramp, 3 current limit, 4 voltage limit, then "
                "disabled; 5 to 8 as 1 to 4, then still in quick stop"},
    {.entry = kFaultReactionOption,
     .name = "Fault reaction option code",
     .type = kInteger16,
     .access = kReadWrite,
     .default_value = 2,
     .low = 0,
     .high = 4,
     .meaning = "0 no braking, 1 slow-down ramp, 2 quick-stop ramp, 3 current limit, 4 voltage limit"},
    {.entry = kMode,
     .name = "Modes of operation",
     .type = kInteger8,
     .access = kReadWrite,
     .default_value = 0,
     .mappable = true,
     .low = 0,
     .high = 10,
     .meaning = "10: cyclic synchronous torque"},
    {.entry = kModeDisplay,
     .name = "Modes of operation display",
     .type = kInteger8,
     .access = kReadOnly,
     .default_value = 0,
     .mappable = true,
     .meaning = "the mode in force"},
    {.entry = kPosition,
     .name = "Position actual value",
     .type = kInteger32,
     .access = kReadOnly,
     .default_value = 0,
     .mappable = true,
     .meaning = "position units, motor side"},
    {.entry = kVelocity,
     .name = "Velocity actual value",
     .type = kInteger32,
     .access = kReadOnly,
     .default_value = 0,
     .mappable = true,
     .meaning = "velocity units, motor side"},
    {.entry = kTargetTorque,
     .name = "Target torque",
     .type = kInteger16,
     .access = kReadWrite,
     .default_value = 0,
     .mappable = true,
     .meaning = "thousandths of the rated torque"},
    {.entry = kMaxTorque,
     .name = "Max torque",
     .type = kUnsigned16,
     .access = kReadWrite,
     .default_value = 1000,
     .meaning = "thousandths of the rated torque; the drive clips to it"},
    {.entry = kRatedTorque,
     .name = "Motor rated torque",
     .type = kUnsigned32,
     .access = kReadOnly,
     .default_value = 0,
     .meaning = "mN m"},
    {.entry = kTorque,
     .name = "Torque actual value",
     .type = kInteger16,
     .access = kReadOnly,
     .default_value = 0,
     .mappable = true,
     .meaning = "thousandths of the rated torque"},
    {.entry = kSupportedModes,
     .name = "Supported drive modes",
     .type = kUnsigned32,
     .access = kReadOnly,
     .default_value = 0x200,
     .meaning = "bit 9: cyclic synchronous torque"},
});

constexpr bool Before(const Entry& a, const Entry& b) {
  return a.index != b.index ? a.index < b.index : a.sub < b.sub;
}
static_assert(std::is_sorted(kObjects.begin(), kObjects.end(),
                             [](const Object& a, const Object& b) { return Before(a.entry, b.entry); }));

}  // namespace

std::span<const Object> Objects() {
  return kObjects;
}

const Object* Find(Entry entry) {
  const auto* at = std::lower_bound(kObjects.begin(), kObjects.end(), entry,
                                    [](const Object& object, Entry e) { return Before(object.entry, e); });
  return at != kObjects.end() && at->entry == entry ? at : nullptr;
}

uint32_t DefaultOf(const Object& object, const JointDriveConfig& joint) {
  if (object.entry == kRatedTorque) {
    return static_cast<uint32_t>(std::llround(1000.0 * joint.cia402.rated_torque_Nm));
  }
  return object.default_value + (object.add_node ? static_cast<uint32_t>(joint.node_id) : 0u);
}

}  // namespace armada::cia402
