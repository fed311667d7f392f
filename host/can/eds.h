#pragma once

#include <string>

#include "firmware/can/joint_drive_config.h"

namespace armada {

/// Electronic data sheet (CiA 306-1 1.4) of the joint's drive as Armada uses it, for CANopen tools. Made of
/// the object dictionary that the master's codec and the emulated drive share. Node ids stand as $NODEID.
/// Lines end in \n. @pre the joint speaks cia402
std::string Eds(const JointDriveConfig& joint);

}  // namespace armada
