#include "host/run/run_evidence.h"

#include <fstream>

namespace armada {
namespace {

// Null where there is none: a program that was ended has left no report.
Json ReadIfThere(const std::string& path) {
  std::ifstream file(path);
  Json json = Json::parse(file, nullptr, false);
  return json.is_discarded() ? Json() : json;
}

}  // namespace

RunEvidence GatherEvidence(const ScenarioConfig& scenario, uint64_t seed, int64_t epoch_ns,
                           const RunRecorder& recorder, const ProcessFaults* faults,
                           const Heartbeat* heartbeat, const std::string& directory) {
  RunEvidence evidence;
  evidence.scenario = &scenario;
  evidence.seed = seed;
  evidence.epoch_ns = epoch_ns;
  evidence.hil = ReadIfThere(directory + "/hil.json");
  const Json benches = evidence.hil.is_object() ? evidence.hil.value("arms", Json::array()) : Json::array();
  for (size_t i = 0; i < scenario.fleet.arms.size(); ++i) {
    const std::string file = "/arm_" + std::to_string(scenario.fleet.arms[i].id) + ".json";
    evidence.arms.push_back(
        {recorder.Ticks(i), ReadIfThere(directory + file), i < benches.size() ? benches[i] : Json()});
  }
  if (faults != nullptr) evidence.faults_made = faults->made();
  evidence.real_time = heartbeat != nullptr;
  if (evidence.real_time) {
    evidence.stalls = heartbeat->Stalls();
    evidence.leader_silences = recorder.LeaderSilences();
    evidence.heartbeat_is_foremost = heartbeat->is_foremost();
    evidence.processors = heartbeat->processors();
  }
  return evidence;
}

}  // namespace armada
