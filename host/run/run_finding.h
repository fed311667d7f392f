#pragma once

#include <iosfwd>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace armada {

/// One thing that a run has to say of itself: an entry of `diagnosis` in metrics.json.
struct RunFinding {
  std::string kind;  ///< docs/metrics.md lists them
  int arm_id = 0;    ///< 0: of no arm
  std::optional<double> at_s;
  std::string text;
};

/// For metrics.json.
nlohmann::ordered_json ToJson(const std::vector<RunFinding>& findings);

/// A heading and a line each; of many the first.
void PrintFindings(const std::vector<RunFinding>& findings, bool ok, std::ostream& out);

/// "5.204 s"; "0.300 s before the start".
std::string TimeText(double t_s);

}  // namespace armada
