#include "host/run/run_diagnosis.h"

#include <algorithm>
#include <cstdio>
#include <limits>

#include "host/run/arm_failure.h"
#include "host/run/outside_findings.h"

namespace armada {
namespace {

constexpr size_t kMostStalls = 3;
constexpr double kLast_s = std::numeric_limits<double>::infinity();  // what has no time comes last

void Append(std::vector<RunFinding> more, std::vector<RunFinding>* findings) {
  findings->insert(findings->end(), more.begin(), more.end());
}

// Who ended, and the last that it said.
std::string EndText(const std::string& broke_off) {
  const size_t first_end = broke_off.find('\n');
  if (first_end == std::string::npos) return broke_off;
  std::string text = broke_off.substr(0, first_end);
  if (const size_t log = text.rfind("; the end of "); log != std::string::npos) text.erase(log);
  const size_t last = broke_off.find_first_not_of(' ', broke_off.rfind('\n') + 1);
  return last == std::string::npos ? text : text + ": " + broke_off.substr(last);
}

// What is of no arm: the run broke off, or the fleet misses its criterion.
std::vector<RunFinding> FleetFailures(const RunEvidence& evidence) {
  std::vector<RunFinding> failures;
  if (!evidence.broke_off.empty()) {
    failures.push_back(
        {"program", 0, evidence.broke_off_s,
         "the run broke off at " + TimeText(evidence.broke_off_s) + ": " + EndText(evidence.broke_off)});
  }
  if (evidence.metrics == nullptr) return failures;
  const CriterionConfig& criterion = evidence.scenario->criterion;
  for (const Miss& miss : evidence.metrics->misses) {
    char text[128];
    if (miss.kind == MissKind::kFleetRms) {
      std::snprintf(text, sizeof text, "fleet RMS %.3f mm, criterion.fleet_rms_max_m is %.3f mm",
                    evidence.metrics->fleet_rms_m * 1e3, criterion.fleet_rms_max_m * 1e3);
      failures.push_back({"fleet_rms", 0, std::nullopt, text});
    } else if (miss.kind == MissKind::kAgreement) {
      std::snprintf(text, sizeof text,
                    "estimates are up to %.3f mm apart, criterion.agreement_max_m is %.3f mm",
                    evidence.metrics->estimate_spread_m * 1e3, criterion.agreement_max_m * 1e3);
      failures.push_back({"agreement", 0, std::nullopt, text});
    }
  }
  return failures;
}

std::string NothingLate(const RunEvidence& evidence) {
  std::string text = "nothing was late or lost";
  if (evidence.metrics == nullptr) return text;
  return text + ": the controller itself misses the criterion; `armada sim " + evidence.scenario->file +
         " --seed " + std::to_string(evidence.seed) + "` shows it without a machine's time";
}

}  // namespace

std::vector<RunFinding> Diagnose(const RunEvidence& evidence) {
  if (evidence.metrics != nullptr && evidence.metrics->ok) return StallFindings(evidence, evidence.stalls, 1);

  std::vector<RunFinding> failures = FleetFailures(evidence);
  std::vector<RunFinding> losses;
  bool boards_in_time = true;
  for (size_t i = 0; i < evidence.arms.size(); ++i) {
    const auto failure = FailureOf(evidence, i);
    if (!failure) continue;
    failures.push_back(failure->finding);
    if (!failure->in_time) boards_in_time = false;
    if (auto lost = LossesOf(evidence, i)) losses.push_back(std::move(*lost));
  }
  std::stable_sort(failures.begin(), failures.end(), [](const RunFinding& a, const RunFinding& b) {
    return a.at_s.value_or(kLast_s) < b.at_s.value_or(kLast_s);
  });
  const double first_s = failures.empty() ? 0.0 : failures.front().at_s.value_or(0.0);
  const double last_s = failures.empty() ? kLast_s : failures.back().at_s.value_or(kLast_s);
  std::vector<Stall> stalls = evidence.stalls;
  const auto others = std::stable_partition(stalls.begin(), stalls.end(), [&](const Stall& stall) {
    return evidence.TimeOf(stall.end_ns) > first_s - kMoment_s && evidence.TimeOf(stall.begin_ns) < last_s;
  });

  std::vector<RunFinding> findings = FaultFindings(evidence, last_s);
  Append(StallFindings(evidence, {stalls.begin(), others}, kMostStalls), &findings);
  const bool from_outside = !findings.empty();
  Append(std::move(failures), &findings);
  const std::vector<RunFinding> programs = ProgramFindings(evidence);
  const bool programs_in_time =
      std::none_of(programs.begin(), programs.end(), [&](const RunFinding& program) {
        return program.at_s.value_or(first_s) > first_s - kMoment_s &&
               program.at_s.value_or(first_s) < last_s;
      });
  if (!from_outside && boards_in_time && losses.empty() && programs_in_time)
    findings.push_back({"none", 0, std::nullopt, NothingLate(evidence)});
  Append(std::move(losses), &findings);
  Append(programs, &findings);
  Append(StallFindings(evidence, {others, stalls.end()}, 1), &findings);
  return findings;
}

}  // namespace armada
