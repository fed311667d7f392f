#include "firmware/can/cia402_messages.h"

#include <algorithm>
#include <cmath>

namespace armada::cia402 {
namespace {

template <size_t n>
constexpr uint8_t LengthOf(const std::array<PdoField, n>& fields) {
  unsigned bits = 0;
  for (const PdoField& field : fields) bits += field.signal.bits;
  return static_cast<uint8_t>(bits / 8);
}

bool IsPdo(const CanFrame& frame, uint32_t id, uint8_t length) {
  return canopen::IsPlain(frame) && frame.id == id && frame.length == length;
}

CanSignal Scaled(const PdoField& field, const char* unit, double scale) {
  CanSignal signal = field.signal;
  signal.unit = unit;
  signal.scale = scale;
  return signal;
}

}  // namespace

const char* NameOf(PowerState state) {
  switch (state) {
    case PowerState::kNotReady:
      return "not ready to switch on";
    case PowerState::kSwitchOnDisabled:
      return "switch on disabled";
    case PowerState::kReady:
      return "ready to switch on";
    case PowerState::kSwitchedOn:
      return "switched on";
    case PowerState::kEnabled:
      return "operation enabled";
    case PowerState::kQuickStop:
      return "quick stop active";
    case PowerState::kFaultReaction:
      return "fault reaction active";
    case PowerState::kFault:
      return "fault";
  }
  return "no state";
}

bool DecodeState(uint16_t statusword, PowerState* state) {
  // Bit 5, "quick stop" when 0, tells only the states in which the drive may be switched on from the rest.
  switch (statusword & 0x4F) {
    case 0x00:
      *state = PowerState::kNotReady;
      return true;
    case 0x40:
      *state = PowerState::kSwitchOnDisabled;
      return true;
    case 0x0F:
      *state = PowerState::kFaultReaction;
      return true;
    case 0x08:
      *state = PowerState::kFault;
      return true;
    default:
      break;
  }
  switch (statusword & 0x6F) {
    case 0x21:
      *state = PowerState::kReady;
      return true;
    case 0x23:
      *state = PowerState::kSwitchedOn;
      return true;
    case 0x27:
      *state = PowerState::kEnabled;
      return true;
    case 0x07:
      *state = PowerState::kQuickStop;
      return true;
    default:
      return false;
  }
}

CanFrame EncodeCommand(int node, const Command& command) {
  CanFrame frame = canopen::PlainFrame(canopen::NodeId(canopen::kRpdo1Id, node), LengthOf(kRpdo1Fields));
  PutRaw(kRpdo1Fields[0].signal, command.controlword, &frame);
  PutRaw(kRpdo1Fields[1].signal, static_cast<uint16_t>(command.target_torque), &frame);
  PutRaw(kRpdo1Fields[2].signal, static_cast<uint8_t>(command.mode), &frame);
  frame.latest_only = true;
  return frame;
}

bool DecodeStatus(const CanFrame& frame, int node, Status* status) {
  if (!IsPdo(frame, canopen::NodeId(canopen::kTpdo1Id, node), LengthOf(kTpdo1Fields))) return false;
  *status = {static_cast<uint16_t>(GetRaw(frame, kTpdo1Fields[0].signal)),
             static_cast<int16_t>(GetRaw(frame, kTpdo1Fields[1].signal)),
             static_cast<int8_t>(GetRaw(frame, kTpdo1Fields[2].signal))};
  return true;
}

bool DecodeMotion(const CanFrame& frame, int node, Motion* motion) {
  if (!IsPdo(frame, canopen::NodeId(canopen::kTpdo2Id, node), LengthOf(kTpdo2Fields))) return false;
  *motion = {static_cast<int32_t>(GetRaw(frame, kTpdo2Fields[0].signal)),
             static_cast<int32_t>(GetRaw(frame, kTpdo2Fields[1].signal))};
  return true;
}

double TorqueUnit_Nm(const Cia402Config& config, uint16_t max_torque) {
  const double base_Nm =
      config.torque_of_max ? config.rated_torque_Nm * max_torque / 1000.0 : config.rated_torque_Nm;
  return base_Nm / 1000.0;
}

uint16_t MaxTorqueOf(const JointDriveConfig& joint) {
  const double motor_Nm = joint.torque_limit_Nm / joint.gear_ratio;
  const double thousandths = std::floor(1000.0 * motor_Nm / joint.cia402.rated_torque_Nm);
  // Also for a file that forgot the limit, which is not a number then: 0, until the file is refused.
  return static_cast<uint16_t>(std::min(std::fmax(thousandths, 0.0), double{UINT16_MAX}));
}

std::vector<CanMessage> Messages(const JointDriveConfig& joint) {
  const int node = joint.node_id;
  const Cia402Config& config = joint.cia402;
  const double torque_Nm = TorqueUnit_Nm(config, MaxTorqueOf(joint));
  std::vector<CanMessage> messages = canopen::Messages(node, config.master_node_id);
  messages.push_back(
      {.name = "Command",
       .id = canopen::NodeId(canopen::kRpdo1Id, node),
       .length = LengthOf(kRpdo1Fields),
       .signals = {kRpdo1Fields[0].signal, Scaled(kRpdo1Fields[1], "N m", torque_Nm), kRpdo1Fields[2].signal},
       .meaning = "RPDO 1, motor side; acts at once"});
  messages.push_back(
      {.name = "Status",
       .id = canopen::NodeId(canopen::kTpdo1Id, node),
       .from_drive = true,
       .length = LengthOf(kTpdo1Fields),
       .signals = {kTpdo1Fields[0].signal, Scaled(kTpdo1Fields[1], "N m", torque_Nm), kTpdo1Fields[2].signal},
       .meaning = "TPDO 1 on SYNC, motor side"});
  messages.push_back({.name = "Motion",
                      .id = canopen::NodeId(canopen::kTpdo2Id, node),
                      .from_drive = true,
                      .length = LengthOf(kTpdo2Fields),
                      .signals = {Scaled(kTpdo2Fields[0], "rev", 1.0 / config.counts_per_turn),
                                  Scaled(kTpdo2Fields[1], "rev/s", 1.0 / config.velocity_per_turn_s)},
                      .meaning = "TPDO 2 on SYNC, motor side"});
  return messages;
}

}  // namespace armada::cia402
