#pragma once

#include <netinet/in.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "firmware/link/lcm_url.h"
#include "firmware/unique_fd.h"

namespace armada {

/// Any datagrams to an LCM network's group, and all that others send there. Never blocks.
class GroupSocket {
 public:
  /// On failure returns nothing and sets *error.
  static std::optional<GroupSocket> Open(const LcmUrl& url, std::string* error);

  /// False when the kernel does not take it.
  bool Send(std::span<const uint8_t> datagram) const;
  /// The next datagram that somebody else has sent, valid until the next call; nothing when none waits.
  std::optional<std::span<const uint8_t>> Receive();

 private:
  UniqueFd sender_;
  UniqueFd receiver_;
  sockaddr_in group_{};
  in_port_t own_port_ = 0;  ///< of what this one sends; LCM's own processes send from the group's port
  std::array<uint8_t, 2048> buffer_;
};

}  // namespace armada
