#include "firmware/app/program_clock.h"

#include <charconv>

#include "firmware/can/bus_name.h"
#include "firmware/clock/machine_clock.h"
#include "firmware/clock/stepped_clock.h"

namespace armada {
namespace {

// Why time may not wait beside this bus; empty when it may.
std::string WhyReal(const std::string& bus) {
  std::string error;
  const auto name = ParseBusName(bus, &error);
  if (!name) return error;
  if (name->kind != BusKind::kUdp) return "bus " + bus + " is of the kernel";
  return name->ttl > 0 ? "bus " + bus + " reaches beyond this host" : "";
}

}  // namespace

std::unique_ptr<Clock> OpenProgramClock(const std::string& stepped, const LcmUrl& url,
                                        const std::vector<std::string>& buses, std::string* error) {
  if (stepped.empty()) return std::make_unique<MachineClock>();
  const auto refuse = [&](const std::string& why) {
    *error = "--stepped-clock " + stepped + ": " + why;
    return nullptr;
  };
  constexpr const char* kEmulationOnly = "; stepped time is for emulated arms on this host alone";
  if (url.ttl > 0) return refuse("link.lcm_url has ttl=" + std::to_string(url.ttl) + kEmulationOnly);
  for (const std::string& bus : buses) {
    if (const std::string why = WhyReal(bus); !why.empty()) return refuse(why + kEmulationOnly);
  }
  int descriptor = 0;
  int slot = 0;
  const char* const end = stepped.data() + stepped.size();
  const auto first = std::from_chars(stepped.data(), end, descriptor);
  if (first.ec != std::errc() || first.ptr == end || *first.ptr != ':') return refuse("must be FD:SLOT");
  const auto second = std::from_chars(first.ptr + 1, end, slot);
  if (second.ec != std::errc() || second.ptr != end) return refuse("must be FD:SLOT");
  return SteppedClock::Attach(descriptor, slot, error);
}

}  // namespace armada
