#include <algorithm>
#include <cmath>
#include <filesystem>

#include "firmware/app/config/toml_parser.h"
#include "hil/emulated_arm.h"
#include "hil/fault_meaning.h"
#include "hil/scenario_file.h"
#include "hil/start_state.h"
#include "host/sim/link_faults.h"
#include "tests/fuzz/config_world.h"
#include "tests/fuzz/edited_text.h"
#include "tests/fuzz/require.h"

namespace armada {
namespace {

constexpr const char* kFile = ARMADA_FUZZ_SCENARIOS "/faults/edited.toml";

/// The fault scripts, on a small fleet.
const std::vector<std::string>& Scripts() {
  static const std::vector<std::string> scripts = [] {
    constexpr std::string_view kLarge = "../paper.toml";
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(ARMADA_FUZZ_SCENARIOS "/faults"))
      paths.push_back(entry.path());
    std::sort(paths.begin(), paths.end());
    std::vector<std::string> texts;
    for (const auto& path : paths) {
      std::string text = ReadText(path);
      const size_t base = text.find(kLarge);
      if (base != std::string::npos) text.replace(base, kLarge.size(), "../two_arms.toml");
      texts.push_back(text);
    }
    return texts;
  }();
  return scripts;
}

void RequireMeaningful(const FaultConfig& fault, const FleetConfig& fleet) {
  Require(fault.kind != FaultKind::kNone, "a fault is of a kind");
  const FaultMeaning& meaning = MeaningOf(fault.kind);
  Require(fault.at_s >= 0.0 && fault.at_s < fault.until_s && fault.until_s <= FaultConfig::kForGood_s,
          "it begins, and then it ends");
  const int index = fleet.IndexOf(fault.arm);
  Require(index >= 0 || (fault.arm == 0 && meaning.target != FaultTarget::kArm),
          "it is of an arm or the leader");
  Require(index < 0 || meaning.target != FaultTarget::kLeader, "of the leader's kind only the leader's");
  const size_t joints = index < 0 ? 0 : fleet.arms[static_cast<size_t>(index)].joints.size();
  Require(fault.joint >= 0 && static_cast<size_t>(fault.joint) <= joints, "of a joint that there is");
  const FaultValue value = ValueOf(fault);
  Require(fault.value >= value.min && fault.value <= value.max, "its value is in its range");
}

/// The benches and the link, with all faults at once from the beginning.
void RequireRuns(ScenarioConfig scenario) {
  constexpr double kAdvance_s = 0.005;
  for (FaultConfig& fault : scenario.faults) fault.at_s = 0.0;
  std::optional<LeaderPath> leader;
  if (scenario.leader.kind != LeaderKind::kNone) leader.emplace(scenario.leader);
  const LeaderPath* const path = leader ? &*leader : nullptr;
  const LinkFaults link(scenario, 1);
  FrameList frames;
  for (size_t i = 0; i < scenario.fleet.arms.size(); ++i) {
    const ArmStart start = DrawStart(scenario, i, 1, path);
    EmulatedArm bench(scenario, i, 1, start, path, -kAdvance_s);
    bench.AdvanceTo(kAdvance_s, &frames);
    frames.Clear();
    for (const double q_rad : bench.plant().q_rad) Require(std::isfinite(q_rad), "joints are somewhere");
    for (const double tau_Nm : bench.Torque()) Require(tau_Nm == 0.0, "drives that are off give no torque");
    const std::vector<uint8_t> sent(100);
    int64_t handed = 0;
    link.Deliver(
        0, scenario.fleet.arms[i].id, 1, [&](int64_t) { return LinkFaults::Payload(sent); },
        [&](LinkFaults::Payload) { ++handed; });
    Require(handed <= 1'000'000, "a link carries no more than faults say");
  }
}

void TestScript(const std::string& text) {
  std::vector<ConfigError> errors;
  auto tree = ParseToml(text, kFile, &errors);
  const auto scenario = tree ? ScenarioFromTree(std::move(*tree), kFile, {}, &errors) : std::nullopt;
  if (!scenario) return RequireExplained(errors, kFile, text);
  Require(errors.empty(), "what is accepted has no errors");
  for (const FaultConfig& fault : scenario->faults) RequireMeaningful(fault, scenario->fleet);
  RequireRuns(*scenario);
}

}  // namespace
}  // namespace armada

/// A scenario with faults, edited: it is refused with a reason, or its faults mean something.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace armada;
  ByteSource choices({data, size});
  EditedText file(Scripts()[choices.Byte() % Scripts().size()], Scripts());
  while (!choices.empty()) file.Edit(&choices);
  TestScript(file.text());
  return 0;
}
