#include "host/can/bus_source.h"

#include <algorithm>
#include <iostream>

#include "firmware/app/config/fleet_file.h"
#include "firmware/app/exit_codes.h"
#include "firmware/can/bus_name.h"
#include "firmware/can/can_link.h"
#include "firmware/core/named_enum.h"

namespace armada {

std::optional<ArmEntry> FindArm(const BusSource& source, int* code) {
  std::vector<ConfigError> errors;
  const auto fleet = LoadFleet(source.fleet, source.sets, &errors);
  if (!fleet) {
    PrintErrors(errors, std::cerr);
    *code = kExitBadConfig;
    return std::nullopt;
  }
  const auto found = std::find_if(fleet->arms.begin(), fleet->arms.end(), [&](const ArmEntry& entry) {
    return source.arm ? entry.id == *source.arm : fleet->arms.size() == 1;
  });
  if (found != fleet->arms.end()) return *found;
  std::string ids;
  for (const ArmEntry& entry : fleet->arms) ids += ' ' + std::to_string(entry.id);
  std::cerr << "armada: "
            << (source.arm ? "--arm " + std::to_string(*source.arm) + ": no such arm" : "--arm is missing")
            << "; " << source.fleet << " has" << ids << '\n';
  *code = kExitUsage;
  return std::nullopt;
}

std::optional<DriveProfile> ParseProfile(const std::string& name) {
  if (const auto profile = EnumNamed<DriveProfile>(name)) return profile;
  std::string names;
  for (const auto& [profile, known] : EnumNames(DriveProfile{})) {
    names += (names.empty() ? "" : ", ") + std::string(known);
  }
  std::cerr << "armada: --profile " << name << ": there are " << names << '\n';
  return std::nullopt;
}

BusOptions OptionsAsFound(const std::string& bus) {
  constexpr uint32_t kFdMtu = 72;
  BusOptions options;
  std::string unused;
  const auto name = ParseBusName(bus, &unused);
  if (!name || name->kind == BusKind::kUdp) {
    options.fd = true;
    return options;
  }
  const auto link = ReadCanLink(name->interface_name, &unused);
  if (!link) return options;
  options.fd = link->mtu == kFdMtu;
  if (link->bitrate_bit_s) options.config.bitrate_bit_s = *link->bitrate_bit_s;
  if (link->data_bitrate_bit_s) options.config.data_bitrate_bit_s = *link->data_bitrate_bit_s;
  options.config.tx_queue_length_max =
      std::max(options.config.tx_queue_length_max, static_cast<int>(link->tx_queue_length));
  return options;
}

}  // namespace armada
