#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "firmware/can/canopen_messages.h"
#include "firmware/can/cia402_objects.h"

namespace armada::cia402 {

/// Process data of a CiA 402 drive in cyclic synchronous torque, for both sides of the bus, in the drive's
/// units, and the words that run its state machine (CiA 402-2 4.1, 8.4).

inline constexpr int8_t kCyclicSynchronousTorque = 10;

/// States of the power drive system.
enum class PowerState : uint8_t {
  kNotReady,
  kSwitchOnDisabled,
  kReady,
  kSwitchedOn,
  kEnabled,
  kQuickStop,
  kFaultReaction,
  kFault,
};
const char* NameOf(PowerState state);

/// What the statusword says. False for bits that no state has.
bool DecodeState(uint16_t statusword, PowerState* state);

inline constexpr uint16_t kDisableVoltage = 0x00;
inline constexpr uint16_t kQuickStop = 0x02;
inline constexpr uint16_t kShutDown = 0x06;
inline constexpr uint16_t kSwitchOn = 0x07;
inline constexpr uint16_t kEnableOperation = 0x0F;
inline constexpr uint16_t kFaultReset = 0x80;  ///< acts when the bit rises

/// One object in a PDO.
struct PdoField {
  CanSignal signal;
  Entry entry;
};
/// As objects 1600h:01 and on and 1A00h:01 and on have it.
constexpr uint32_t MappingOf(const PdoField& field) {
  return uint32_t{field.entry.index} << 16 | uint32_t{field.entry.sub} << 8 | field.signal.bits;
}

inline constexpr std::array<PdoField, 3> kRpdo1Fields = {{
    {{"controlword", 0, 16}, kControlword},
    {{"target_torque", 16, 16, CanSignal::Kind::kSigned}, kTargetTorque},
    {{"mode", 32, 8, CanSignal::Kind::kSigned}, kMode},
}};
inline constexpr std::array<PdoField, 3> kTpdo1Fields = {{
    {{"statusword", 0, 16}, kStatusword},
    {{"torque", 16, 16, CanSignal::Kind::kSigned}, kTorque},
    {{"mode_display", 32, 8, CanSignal::Kind::kSigned}, kModeDisplay},
}};
inline constexpr std::array<PdoField, 2> kTpdo2Fields = {{
    {{"position", 0, 32, CanSignal::Kind::kSigned}, kPosition},
    {{"velocity", 32, 32, CanSignal::Kind::kSigned}, kVelocity},
}};

struct Command {
  uint16_t controlword = 0;
  int16_t target_torque = 0;
  int8_t mode = kCyclicSynchronousTorque;
};
struct Status {
  uint16_t statusword = 0;
  int16_t torque = 0;
  int8_t mode = 0;
};
struct Motion {
  int32_t position = 0;
  int32_t velocity = 0;
};

/// RPDO 1, TPDO 1 and TPDO 2 as mapped above.
CanFrame EncodeCommand(int node, const Command& command);
bool DecodeStatus(const CanFrame& frame, int node, Status* status);
bool DecodeMotion(const CanFrame& frame, int node, Motion* motion);

/// Motor-side torque of one unit of 6071h and 6077h, given 6072h.
double TorqueUnit_Nm(const Cia402Config& config, uint16_t max_torque);
/// The joint's torque limit as 6072h: the largest number that does not pass it.
uint16_t MaxTorqueOf(const JointDriveConfig& joint);

/// All that goes over the wire between the joint's drive and its master.
std::vector<CanMessage> Messages(const JointDriveConfig& joint);

}  // namespace armada::cia402
