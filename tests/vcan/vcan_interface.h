#pragma once

#include <string>

namespace armada {

/// Runs a command of iproute2 or can-utils, without single quotes; fails the test when it fails.
void Shell(const std::string& command);

/// A virtual CAN interface that echoes frames as a controller does, once they are sent. Needs root in a
/// kernel with vcan loaded with echo=1.
class VcanInterface {
 public:
  explicit VcanInterface(std::string name);
  VcanInterface(const VcanInterface&) = delete;
  VcanInterface& operator=(const VcanInterface&) = delete;
  ~VcanInterface();

  const std::string& name() const { return name_; }
  std::string bus() const { return "socketcan:" + name_; }
  void SetUp() { Shell("ip link set " + name_ + " up"); }
  void SetDown() { Shell("ip link set " + name_ + " down"); }
  /// From now on frames wait `delay_ms` in a transmit queue of `limit` frames.
  void Delay(int delay_ms, int limit) {
    Shell("tc qdisc replace dev " + name_ + " root netem delay " + std::to_string(delay_ms) + "ms limit " +
          std::to_string(limit));
  }
  /// An error frame as a driver makes it: cansend's "<id with the error flag>#<data>".
  void InjectError(const std::string& frame) { Shell("cansend " + name_ + " " + frame); }

 private:
  std::string name_;
};

inline constexpr char kBusOff[] = "20000040#0000000000000000";
inline constexpr char kRestarted[] = "20000100#0000000000000000";
inline constexpr char kTxPassive[] = "20000004#0020000000000000";
inline constexpr char kTxWarning[] = "20000004#0008000000000000";  // from passive: better
inline constexpr char kLostArbitration[] = "20000002#0000000000000000";

}  // namespace armada
