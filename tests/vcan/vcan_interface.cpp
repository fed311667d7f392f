#include "tests/vcan/vcan_interface.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace armada {

void Shell(const std::string& command) {
  // busybox's shell, the guest's, would take its own tc before the real one.
  ASSERT_EQ(std::system(("bash -c '" + command + "'").c_str()), 0) << command;
}

VcanInterface::VcanInterface(std::string name) : name_(std::move(name)) {
  Shell("ip link add " + name_ + " type vcan && ip link set " + name_ + " mtu 72 up");
}

VcanInterface::~VcanInterface() {
  Shell("ip link delete " + name_);
}

}  // namespace armada
