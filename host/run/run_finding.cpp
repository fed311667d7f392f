#include "host/run/run_finding.h"

#include <algorithm>
#include <cstdio>
#include <ostream>

#include "host/json.h"

namespace armada {

Json ToJson(const std::vector<RunFinding>& findings) {
  Json json = Json::array();
  for (const RunFinding& finding : findings) {
    json.push_back({{"kind", finding.kind},
                    {"arm", finding.arm_id == 0 ? Json(nullptr) : Json(finding.arm_id)},
                    {"at_s", finding.at_s ? Json(*finding.at_s) : Json(nullptr)},
                    {"text", finding.text}});
  }
  return json;
}

void PrintFindings(const std::vector<RunFinding>& findings, bool ok, std::ostream& out) {
  constexpr size_t kMostLines = 20;
  if (findings.empty()) return;
  out << (ok ? "noticed:\n" : "why it is not ok:\n");
  const size_t lines = std::min(findings.size(), kMostLines);
  for (size_t i = 0; i < lines; ++i) out << "  " << findings[i].text << '\n';
  if (findings.size() > lines) out << "  and " << findings.size() - lines << " more\n";
}

std::string TimeText(double t_s) {
  char text[64];
  std::snprintf(text, sizeof text, t_s < 0.0 ? "%.3f s before the start" : "%.3f s", t_s < 0.0 ? -t_s : t_s);
  return text;
}

}  // namespace armada
