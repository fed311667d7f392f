#pragma once

#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "host/metrics.h"
#include "host/run/process_faults.h"
#include "host/run/run_recorder.h"

namespace armada {

/// Joins what the emulation measured (hil.json: true errors), what the boards measured (arm_<id>.json:
/// timing, memory, bus; a dead one has left none), what was heard on LCM and which faults were made into the
/// result of a run. False with *error naming the file that is missing or broken.
bool CollectRunResult(const ScenarioConfig& scenario, uint64_t seed, const RunRecorder& recorder,
                      const ProcessFaults& faults, const std::string& directory, RunMetrics* metrics,
                      nlohmann::ordered_json* json, std::string* error);

/// The boards' timing and memory for people: one line an arm.
void PrintProcessTable(const nlohmann::ordered_json& json, std::ostream& out);

}  // namespace armada
