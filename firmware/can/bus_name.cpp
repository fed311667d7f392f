#include "firmware/can/bus_name.h"

#include <arpa/inet.h>
#include <net/if.h>

#include <charconv>

namespace armada {
namespace {

/// The whole of `text` as a decimal number in [low, high].
std::optional<int> ParseNumber(std::string_view text, int low, int high) {
  int value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, status] = std::from_chars(text.data(), end, value);
  if (status != std::errc() || stop != end || value < low || value > high) return std::nullopt;
  return value;
}

bool IsMulticastGroup(const std::string& group) {
  in_addr address{};
  return inet_pton(AF_INET, group.c_str(), &address) == 1 && IN_MULTICAST(ntohl(address.s_addr));
}

bool IsInterfaceName(std::string_view name) {
  return !name.empty() && name.size() < IFNAMSIZ && name.find_first_of("/: \t\r\n") == std::string_view::npos;
}

/// What is wrong with the part after `udp:`; empty when nothing is.
std::string ParseUdp(std::string_view rest, BusName* name) {
  constexpr std::string_view kTtl = "?ttl=";
  if (const size_t at = rest.find('?'); at != std::string_view::npos) {
    const std::string_view option = rest.substr(at);
    const auto ttl =
        option.starts_with(kTtl) ? ParseNumber(option.substr(kTtl.size()), 0, 255) : std::nullopt;
    if (!ttl) return "option \"" + std::string(option) + "\" is not ?ttl=<0 to 255>";
    name->ttl = static_cast<uint8_t>(*ttl);
    rest = rest.substr(0, at);
  }
  const size_t colon = rest.rfind(':');
  if (colon == std::string_view::npos) return "the port is missing";
  name->group = rest.substr(0, colon);
  if (!IsMulticastGroup(name->group)) {
    return "group \"" + name->group + "\" is not an IPv4 multicast address (224.0.0.0 to 239.255.255.255)";
  }
  const auto port = ParseNumber(rest.substr(colon + 1), 1, 65535);
  if (!port) return "port \"" + std::string(rest.substr(colon + 1)) + "\" is not a number from 1 to 65535";
  name->port = static_cast<uint16_t>(*port);
  return {};
}

/// What is wrong with `text`; empty when nothing is.
std::string Parse(std::string_view text, BusName* name) {
  constexpr std::string_view kUdp = "udp:";
  constexpr std::string_view kSocketCan = "socketcan:";
  if (text.starts_with(kUdp)) return ParseUdp(text.substr(kUdp.size()), name);
  if (!text.starts_with(kSocketCan)) return "unknown kind of bus";
  name->kind = BusKind::kSocketCan;
  name->interface_name = text.substr(kSocketCan.size());
  if (!IsInterfaceName(name->interface_name)) {
    return "interface \"" + name->interface_name +
           "\" is not a name of 1 to 15 characters without / : or spaces";
  }
  return {};
}

}  // namespace

std::optional<BusName> ParseBusName(std::string_view text, std::string* error) {
  BusName name;
  const std::string problem = Parse(text, &name);
  if (problem.empty()) return name;
  *error = "bus name \"" + std::string(text) + "\": " + problem +
           "; allowed are udp:<group>:<port>, udp:<group>:<port>?ttl=<hops> and socketcan:<interface>";
  return std::nullopt;
}

}  // namespace armada
