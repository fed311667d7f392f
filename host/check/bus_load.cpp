#include "host/check/bus_load.h"

#include "firmware/can/odrive_cansimple.h"
#include "hil/odrive_emulator.h"

namespace armada {
namespace {

// Frames and their worst bits that one joint's drive and its master put on the bus.
struct Traffic {
  double bits_tick = 0.0;
  double bits_s = 0.0;
};

Traffic ODriveTraffic(const JointDriveConfig& joint, double feedback_period_s) {
  FrameList tick;
  ODriveCanSimple drive(joint);
  drive.RequestSample(&tick);
  drive.CommandTorque(0.0, &tick);
  const CanFrame estimates = odrive::EncodeEncoderEstimates(joint.node_id, {});
  tick.Push(estimates);
  const CanFrame heartbeat = odrive::EncodeHeartbeat(joint.node_id, odrive::Firmware::kV06, {});

  Traffic traffic;
  for (const CanFrame& frame : tick) traffic.bits_tick += WorstFrameBits(frame);
  traffic.bits_s = WorstFrameBits(heartbeat) / ODriveEmulator::kHeartbeatPeriod_s;
  if (feedback_period_s > 0.0) traffic.bits_s += WorstFrameBits(estimates) / feedback_period_s;
  return traffic;
}

Traffic JointTraffic(DriveProfile profile, const JointDriveConfig& joint, double feedback_period_s) {
  switch (profile) {
    case DriveProfile::kODriveCanSimple:
    case DriveProfile::kODriveCanSimpleV05:
      return ODriveTraffic(joint, feedback_period_s);
  }
  return {};
}

}  // namespace

// ISO 11898-1. Start, arbitration, control, data and the CRC sequence are stuffed: at worst, one bit after
// the first five and then one after every four. The CRC delimiter, acknowledgement, end of frame and
// intermission are not: 1 + 2 + 7 + 3.
int WorstFrameBits(const CanFrame& frame) {
  const int header = frame.extended ? 54 : 34;  // start .. control, and 15 bits of CRC
  const int stuffed = header + (frame.remote ? 0 : 8 * frame.length);
  return stuffed + (stuffed - 1) / 4 + 13;
}

double ArmBusLoad(const ArmEntry& entry, double period_s, double feedback_period_s) {
  double bits_s = 0.0;
  for (const JointDriveConfig& joint : entry.joints) {
    const Traffic traffic = JointTraffic(entry.profile, joint, feedback_period_s);
    bits_s += traffic.bits_tick / period_s + traffic.bits_s;
  }
  return bits_s / kCanBitrate;
}

}  // namespace armada
