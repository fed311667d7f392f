#include "host/campaign/shrink.h"

#include <cmath>
#include <vector>

#include "hil/fault_meaning.h"

namespace armada {
namespace {

using Change = std::function<bool(ScenarioConfig*)>;  ///< false: there is nothing to change

template <class Element>
void AddRemovals(std::vector<Element> ScenarioConfig::*list, size_t count, std::vector<Change>* changes) {
  for (size_t i = 0; i < count; ++i) {
    changes->push_back([=](ScenarioConfig* trial) {
      std::vector<Element>& elements = trial->*list;
      elements.erase(elements.begin() + static_cast<std::ptrdiff_t>(i));
      return true;
    });
  }
}

bool Round(double digits, double* value) {
  const double scale = std::pow(10.0, digits);
  const double rounded = std::round(*value * scale) / scale;
  if (rounded == *value) return false;
  *value = rounded;
  return true;
}

/// To so many significant digits.
bool RoundValue(double digits, double* value) {
  return *value != 0.0 && Round(digits - 1.0 - std::floor(std::log10(std::abs(*value))), value);
}

bool HasStops(const ScenarioConfig& trial) {
  return trial.fleet.arms.front().control.supervisor.fleet_stop != FleetStop::kCarryOn;
}

bool LastsForGood(FaultConfig* fault) {
  const bool may = MeaningOf(fault->kind).end == FaultEnd::kMay && fault->until_s != FaultConfig::kForGood_s;
  if (may) fault->until_s = FaultConfig::kForGood_s;
  return may;
}

std::vector<Change> ChangesOf(const ScenarioConfig& trial) {
  std::vector<Change> changes;
  AddRemovals(&ScenarioConfig::faults, trial.faults.size(), &changes);
  AddRemovals(&ScenarioConfig::operations, trial.operations.size(), &changes);
  changes.emplace_back([](ScenarioConfig* t) {
    const bool stops = HasStops(*t);
    for (ArmEntry& arm : t->fleet.arms) arm.control.supervisor.fleet_stop = FleetStop::kCarryOn;
    return stops;
  });
  changes.emplace_back([](ScenarioConfig* t) {
    const bool monitor = t->operations.empty() && t->start.mode == StartMode::kMonitor;
    if (monitor) t->start.mode = StartMode::kRunning;
    return monitor;
  });
  for (size_t i = 0; i < trial.faults.size(); ++i) {
    changes.emplace_back([=](ScenarioConfig* t) { return LastsForGood(&t->faults[i]); });
    for (const double digits : {0.0, 1.0, 2.0}) {
      changes.emplace_back([=](ScenarioConfig* t) { return Round(digits, &t->faults[i].at_s); });
      changes.emplace_back([=](ScenarioConfig* t) { return Round(digits, &t->faults[i].until_s); });
      changes.emplace_back([=](ScenarioConfig* t) { return RoundValue(digits + 1.0, &t->faults[i].value); });
    }
  }
  for (size_t i = 0; i < trial.operations.size(); ++i) {
    for (const double digits : {0.0, 1.0, 2.0}) {
      changes.emplace_back([=](ScenarioConfig* t) { return Round(digits, &t->operations[i].at_s); });
    }
  }
  return changes;
}

/// Rounding may have put an end before its beginning.
bool MakesSense(const ScenarioConfig& trial) {
  for (const FaultConfig& fault : trial.faults) {
    if (fault.until_s <= fault.at_s) return false;
  }
  return true;
}

}  // namespace

ScenarioConfig Shrink(ScenarioConfig trial, const std::function<bool(const ScenarioConfig&)>& fails) {
  for (bool shrunk = true; shrunk;) {
    shrunk = false;
    for (const Change& change : ChangesOf(trial)) {
      ScenarioConfig simpler = trial;
      if (!change(&simpler) || !MakesSense(simpler) || !fails(simpler)) continue;
      trial = std::move(simpler);
      shrunk = true;
      break;
    }
  }
  return trial;
}

}  // namespace armada
