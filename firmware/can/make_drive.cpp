#include "firmware/can/make_drive.h"

#include "firmware/can/cia402_drive.h"
#include "firmware/can/mit_drive.h"
#include "firmware/can/moteus_drive.h"
#include "firmware/can/odrive_cansimple.h"

namespace armada {

std::vector<std::unique_ptr<JointDrive>> MakeDrives(std::span<const JointDriveConfig> joints) {
  std::vector<std::unique_ptr<JointDrive>> drives;
  bool has_sync_producer = false;
  for (const JointDriveConfig& joint : joints) {
    switch (joint.profile) {
      case DriveProfile::kODriveCanSimple:
      case DriveProfile::kODriveCanSimpleV05:
        drives.push_back(std::make_unique<ODriveCanSimple>(joint));
        break;
      case DriveProfile::kMiniCheetah:
      case DriveProfile::kCubeMars:
      case DriveProfile::kDamiao:
        drives.push_back(std::make_unique<MitDrive>(joint));
        break;
      case DriveProfile::kMoteus:
        drives.push_back(std::make_unique<MoteusDrive>(joint));
        break;
      case DriveProfile::kCia402:
        drives.push_back(std::make_unique<Cia402Drive>(joint, !has_sync_producer));
        has_sync_producer = true;
        break;
    }
  }
  return drives;
}

std::vector<CanMessage> MessagesOf(const JointDriveConfig& joint) {
  switch (joint.profile) {
    case DriveProfile::kODriveCanSimple:
    case DriveProfile::kODriveCanSimpleV05:
      return odrive::Messages(joint);
    case DriveProfile::kMiniCheetah:
    case DriveProfile::kCubeMars:
    case DriveProfile::kDamiao:
      return mit::Messages(joint);
    case DriveProfile::kMoteus:
      return moteus::Messages(joint);
    case DriveProfile::kCia402:
      return cia402::Messages(joint);
  }
  return {};
}

}  // namespace armada
