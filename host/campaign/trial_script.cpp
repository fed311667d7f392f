#include "host/campaign/trial_script.h"

#include <filesystem>
#include <utility>
#include <vector>

#include "firmware/app/config/effective_values.h"
#include "firmware/app/config/value_text.h"

namespace armada {
namespace {

/// What is not as it would be without.
std::string TableOf(const char* header, const ParameterTable& config) {
  std::string text = std::string("\n[[") + header + "]]\n";
  for (const EffectiveValue& value : ListValues(config)) {
    if (value.value != value.fallback) text += value.key + " = " + value.value + "\n";
  }
  return text;
}

}  // namespace

std::string ScriptOf(const ScenarioConfig& trial, const std::string& name, const std::string& directory,
                     const std::string& comment) {
  namespace fs = std::filesystem;
  const std::string base = fs::relative(trial.file, directory).generic_string();
  std::string text = comment + "\nname = " + ValueText(name) + "\nbase = " + ValueText(base) + "\n";
  if (trial.start.mode != StartConfig().mode)
    text += "\n[start]\nmode = " + ValueText(trial.start.mode) + "\n";
  const ArmEntry& arm = trial.fleet.arms.front();
  const FleetStop stop = arm.control.supervisor.fleet_stop;
  text += "\n[overrides]\n\"arm.*.drive\" = " + ValueText(arm.joints.front().profile) + "\n";
  if (stop != SupervisorConfig().fleet_stop)
    text += "\"control.supervisor.fleet_stop\" = " + ValueText(stop) + "\n";
  for (FaultConfig fault : trial.faults) text += TableOf("fault", &fault);
  for (OperatorConfig operation : trial.operations) text += TableOf("operator", &operation);
  return text;
}

}  // namespace armada
