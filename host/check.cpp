#include "host/check.h"

#include <iostream>

#include "firmware/app/config/fleet_file.h"
#include "firmware/app/config/toml_parser.h"
#include "firmware/app/exit_codes.h"
#include "hil/scenario_file.h"
#include "host/check/check_output.h"
#include "host/check/explain.h"

namespace armada {
namespace {

// A scenario names its fleet; a fleet file has its arms in it.
bool IsFleetFile(const ConfigNode& root) {
  return root.Find("fleet") == nullptr && root.Find("arm") != nullptr;
}

/// What `use` makes of the fleet or the scenario that the file is; nothing, and errors, when it is neither.
template <class Use>
auto Load(const CheckOptions& options, const Use& use, std::vector<ConfigError>* errors)
    -> std::optional<decltype(use(FleetConfig()))> {
  const auto root = LoadToml(options.path, errors);
  if (!root) return std::nullopt;
  if (IsFleetFile(*root)) {
    const auto fleet = LoadFleet(options.path, options.sets, errors);
    return fleet ? std::optional(use(*fleet)) : std::nullopt;
  }
  const auto scenario = LoadScenario(options.path, options.sets, errors);
  return scenario ? std::optional(use(*scenario)) : std::nullopt;
}

std::vector<EffectiveValue> AllValues(const FleetConfig& fleet) {
  return EffectiveValues(fleet);
}
std::vector<EffectiveValue> AllValues(const ScenarioConfig& scenario) {
  std::vector<EffectiveValue> values = EffectiveValues(scenario);
  const std::vector<EffectiveValue> of_fleet = EffectiveValues(scenario.fleet);
  values.insert(values.end(), of_fleet.begin(), of_fleet.end());
  return values;
}

int BadConfig(const std::vector<ConfigError>& errors) {
  PrintErrors(errors, std::cerr);
  return kExitBadConfig;
}

int RunExplain(const CheckOptions& options) {
  std::vector<ConfigError> errors;
  const auto values = Load(
      options, [](const auto& config) { return AllValues(config); }, &errors);
  if (!values) return BadConfig(errors);
  if (Explain(*values, options.explain, std::cout)) return kExitOk;
  std::cerr << "armada check: --explain " << options.explain << ": no parameter's key has this in it\n";
  return kExitUsage;
}

}  // namespace

int RunCheck(const CheckOptions& options) {
  if (!options.explain.empty()) return RunExplain(options);
  std::vector<ConfigError> errors;
  const auto result = Load(
      options, [](const auto& config) { return BuildCheck(config); }, &errors);
  if (!result) return BadConfig(errors);
  options.json ? PrintJson(*result, std::cout) : PrintText(*result, std::cout);
  return result->ok() ? kExitOk : kExitFailed;
}

}  // namespace armada
