#pragma once

#include <cstdint>
#include <vector>

#include "firmware/can/frame.h"
#include "firmware/can/joint_drive_config.h"
#include "firmware/can/signal.h"

namespace armada::damiao {

/// Parameters of Damiao drives over CAN: requests to all drives on 0x7FF with the node in bytes 0 and 1,
/// answers on the drive's master id, values little-endian. Written values hold until the drive is switched
/// off. Sources: Damiao's manuals (for example DM-J10010L-2EC 1.1) and its own driver, DM_CAN.

enum class Register : uint8_t {
  kMasterId = 7,
  kNodeId = 8,
  kTimeout = 9,       ///< u32, 50 us; 0: the drive never notices silence
  kControlMode = 10,  ///< u32, 1 is MIT
  kPositionMax = 21,  ///< float, rad
  kVelocityMax = 22,  ///< float, rad/s
  kTorqueMax = 23,    ///< float, N m
};

enum class Access : uint8_t { kRead = 0x33, kWrite = 0x55 };

constexpr double kTimeoutUnit_s = 50e-6;
constexpr uint32_t kMitMode = 1;

/// Status in the high nibble of a reply's byte 0. All but the first two are faults and mean disabled.
enum Status : uint8_t {
  kDisabled = 0x0,
  kEnabled = 0x1,
  kCommunicationLost = 0xD,
};
/// "over temperature of the rotor"; "unknown" for codes that the manuals do not list.
const char* StatusName(uint32_t status);

struct RegisterAccess {
  Access access = Access::kRead;
  Register reg = Register::kMasterId;
  uint32_t raw = 0;  ///< the value's bits
};

CanFrame EncodeRequest(const JointDriveConfig& joint, const RegisterAccess& request);
CanFrame EncodeAnswer(const JointDriveConfig& joint, const RegisterAccess& answer);

/// False for anything but a request for this drive.
bool DecodeRequest(const CanFrame& frame, const JointDriveConfig& joint, RegisterAccess* request);
/// False for anything but an answer of this drive. A state cannot be taken for one unless its position is in
/// the last 0.2 % of its range, where it is of no use.
bool DecodeAnswer(const CanFrame& frame, const JointDriveConfig& joint, RegisterAccess* answer);

std::vector<CanMessage> Messages(const JointDriveConfig& joint);

}  // namespace armada::damiao
