#pragma once

#include <cstdio>
#include <string>
#include <vector>

namespace armada {

/// Virtual CAN interfaces (vcan) of one run. They go with the object, and also when this process is killed.
class VirtualCan {
 public:
  VirtualCan() = default;
  VirtualCan(const VirtualCan&) = delete;
  VirtualCan& operator=(const VirtualCan&) = delete;
  ~VirtualCan();

  /// Whether this network namespace has an interface of that name, of whatever kind.
  static bool Exists(const std::string& interface_name);

  /// Makes those interfaces that are missing: up, and with room for CAN FD. Others are left as they are.
  /// Needs a kernel with CAN, and CAP_NET_ADMIN; on failure `error` says what is missing and which commands
  /// help.
  bool Provide(const std::vector<std::string>& interfaces, std::string* error);

  /// What Provide made, in order.
  const std::vector<std::string>& made() const { return made_; }

 private:
  bool Make(const std::string& interface_name, std::string* complaint);

  FILE* janitor_ = nullptr;
  std::vector<std::string> made_;
};

}  // namespace armada
