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

std::optional<CheckResult> LoadAndCheck(const CheckOptions& options, std::vector<ConfigError>* errors) {
  const auto root = LoadToml(options.path, errors);
  if (!root) return std::nullopt;
  if (IsFleetFile(*root)) {
    const auto fleet = LoadFleet(options.path, options.sets, errors);
    return fleet ? std::optional(BuildCheck(*fleet)) : std::nullopt;
  }
  const auto scenario = LoadScenario(options.path, options.sets, errors);
  return scenario ? std::optional(BuildCheck(*scenario)) : std::nullopt;
}

std::optional<std::vector<EffectiveValue>> LoadValues(const CheckOptions& options,
                                                      std::vector<ConfigError>* errors) {
  const auto root = LoadToml(options.path, errors);
  if (!root) return std::nullopt;
  if (IsFleetFile(*root)) {
    const auto fleet = LoadFleet(options.path, options.sets, errors);
    return fleet ? std::optional(EffectiveValues(*fleet)) : std::nullopt;
  }
  const auto scenario = LoadScenario(options.path, options.sets, errors);
  if (!scenario) return std::nullopt;
  std::vector<EffectiveValue> values = EffectiveValues(*scenario);
  const std::vector<EffectiveValue> of_fleet = EffectiveValues(scenario->fleet);
  values.insert(values.end(), of_fleet.begin(), of_fleet.end());
  return values;
}

}  // namespace

int RunCheck(const CheckOptions& options) {
  std::vector<ConfigError> errors;
  if (!options.explain.empty()) {
    const auto values = LoadValues(options, &errors);
    if (values && Explain(*values, options.explain, std::cout)) return kExitOk;
    if (!values) {
      PrintErrors(errors, std::cerr);
      return kExitBadConfig;
    }
    std::cerr << "armada check: --explain " << options.explain << ": no parameter's key has this in it\n";
    return kExitUsage;
  }
  const auto result = LoadAndCheck(options, &errors);
  if (!result) {
    PrintErrors(errors, std::cerr);
    return kExitBadConfig;
  }
  options.json ? PrintJson(*result, std::cout) : PrintText(*result, std::cout);
  return result->ok() ? kExitOk : kExitFailed;
}

}  // namespace armada
