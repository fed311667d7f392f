#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace armada {

/// Where an LCM network lives: a multicast group, a port and how far datagrams go.
struct LcmUrl {
  std::string group = "239.255.76.67";  ///< IPv4 multicast address, dotted
  uint16_t port = 7667;
  int ttl = 0;  ///< 0: this host only; 1: the boards on one Ethernet segment
};

/// Parses `udpm://<group>:<port>` with an optional `?ttl=<hops>`, the form that liblcm takes, too.
/// On failure returns nothing and sets `*error` to what was given and what is allowed. Start-up only.
std::optional<LcmUrl> ParseLcmUrl(std::string_view text, std::string* error);

/// The text that ParseLcmUrl reads back to the same value.
std::string ToString(const LcmUrl& url);

}  // namespace armada
