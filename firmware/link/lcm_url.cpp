#include "firmware/link/lcm_url.h"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <charconv>

namespace armada {
namespace {

constexpr std::string_view kScheme = "udpm://";
constexpr std::string_view kTtl = "ttl=";

bool ParseInRange(std::string_view text, int min, int max, int* value) {
  const char* end = text.data() + text.size();
  const auto [stop, code] = std::from_chars(text.data(), end, *value);
  return code == std::errc() && stop == end && *value >= min && *value <= max;
}

bool IsMulticast(const std::string& address) {
  in_addr parsed{};
  return inet_pton(AF_INET, address.c_str(), &parsed) == 1 && IN_MULTICAST(ntohl(parsed.s_addr));
}

}  // namespace

std::optional<LcmUrl> ParseLcmUrl(std::string_view text, std::string* error) {
  const auto fail = [&](const std::string& what) {
    *error = "LCM URL \"" + std::string(text) + "\": " + what +
             "; expected udpm://<multicast group>:<port>?ttl=<hops>, for example " + ToString(LcmUrl());
    return std::nullopt;
  };

  if (text.substr(0, kScheme.size()) != kScheme) return fail("does not start with udpm://");
  std::string_view address = text.substr(kScheme.size());
  std::string_view options;
  if (const size_t mark = address.find('?'); mark != std::string_view::npos) {
    options = address.substr(mark + 1);
    address = address.substr(0, mark);
    if (options.empty()) return fail("nothing after \"?\"");
  }
  const size_t colon = address.find(':');
  if (colon == std::string_view::npos) return fail("no port");

  LcmUrl url;
  url.group = address.substr(0, colon);
  if (!IsMulticast(url.group)) {
    return fail("group \"" + url.group + "\" is not in 224.0.0.0 to 239.255.255.255");
  }
  const std::string_view port = address.substr(colon + 1);
  int port_number = 0;
  if (!ParseInRange(port, 1, 65535, &port_number)) {
    return fail("port \"" + std::string(port) + "\" is not in 1 to 65535");
  }
  url.port = static_cast<uint16_t>(port_number);
  if (!options.empty()) {
    if (options.substr(0, kTtl.size()) != kTtl) {
      return fail("unknown option \"" + std::string(options) + "\", only ttl is known");
    }
    const std::string_view ttl = options.substr(kTtl.size());
    if (!ParseInRange(ttl, 0, 255, &url.ttl))
      return fail("ttl \"" + std::string(ttl) + "\" is not in 0 to 255");
  }
  return url;
}

std::string ToString(const LcmUrl& url) {
  return std::string(kScheme) + url.group + ":" + std::to_string(url.port) +
         "?ttl=" + std::to_string(url.ttl);
}

}  // namespace armada
