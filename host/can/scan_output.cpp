#include "host/can/scan_output.h"

#include <iomanip>
#include <ostream>

#include "host/json.h"

namespace armada {

void PrintText(const ScanResult& result, std::ostream& out) {
  const auto row = [&](const std::string& profile, const std::string& node, const std::string& firmware,
                       const std::string& state) {
    out << std::left << std::setw(22) << profile << std::setw(6) << node << std::setw(32) << firmware << "  "
        << state << '\n';
  };
  if (!result.drives.empty()) row("profile", "node", "firmware", "state");
  for (const FoundDrive& drive : result.drives) {
    row(drive.profile, std::to_string(drive.node_id), drive.firmware, drive.state);
  }
  for (const std::string& note : result.notes) out << "note: " << note << '\n';
  out << result.drives.size() << " drives; " << result.heard << " frames heard before asking\n";
}

void PrintJson(const ScanResult& result, std::ostream& out) {
  Json json = {{"schema", 1}, {"heard", result.heard}, {"drives", Json::array()}, {"notes", result.notes}};
  for (const FoundDrive& drive : result.drives) {
    json["drives"].push_back({{"profile", drive.profile},
                              {"node_id", drive.node_id},
                              {"firmware", drive.firmware},
                              {"state", drive.state}});
  }
  out << json.dump(2) << '\n';
}

}  // namespace armada
