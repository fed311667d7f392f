#include "host/run/run_diagnosis.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <span>

#include "host/number_format.h"
#include "host/run/arm_failure.h"
#include "host/run/failure_moment.h"
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

std::string WorstRmsText(const RunEvidence& evidence) {
  const CriterionConfig& criterion = evidence.scenario->criterion;
  const ArmMetrics* worst = nullptr;
  for (const ArmMetrics& arm : evidence.metrics->arms) {
    if (arm.standing || criterion.Excuses(arm.id)) continue;
    if (worst == nullptr || arm.rms_m > worst->rms_m) worst = &arm;
  }
  return worst == nullptr ? ""
                          : "; arm " + std::to_string(worst->id) + " has the largest, " +
                                NumberAs("%.3f mm", worst->rms_m * 1e3);
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
      failures.push_back({"fleet_rms", 0, std::nullopt, text + WorstRmsText(evidence)});
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

// Whether the fleet as a whole misses the criterion: then every arm may have had a part in it.
bool FleetMisses(const RunEvidence& evidence) {
  if (evidence.metrics == nullptr) return false;
  const std::vector<Miss>& misses = evidence.metrics->misses;
  return std::any_of(misses.begin(), misses.end(), [](const Miss& miss) { return miss.arm_id == 0; });
}

/// Of all boards.
struct Boards {
  std::vector<RunFinding> failures;  ///< of arms that miss the criterion
  std::vector<RunFinding> late;      ///< where the fleet misses it: what was late on others
  std::vector<RunFinding> losses;
  bool in_time = true;  ///< nothing was late or lost
};

Boards Examine(const RunEvidence& evidence) {
  Boards boards;
  const bool fleet_misses = FleetMisses(evidence);
  for (size_t i = 0; i < evidence.arms.size(); ++i) {
    const auto failure = FailureOf(evidence, i);
    if (!failure && !fleet_misses) continue;
    if (failure) boards.failures.push_back(failure->finding);
    if (failure && !failure->in_time) {
      boards.in_time = false;
    } else if (auto late = fleet_misses ? LatenessOf(evidence, i) : std::nullopt) {
      boards.late.push_back(std::move(*late));
    }
    if (auto lost = LossesOf(evidence, i)) boards.losses.push_back(std::move(*lost));
  }
  if (!boards.late.empty() || !boards.losses.empty()) boards.in_time = false;
  return boards;
}

void SortByTime(std::vector<RunFinding>* failures) {
  std::stable_sort(failures->begin(), failures->end(), [](const RunFinding& a, const RunFinding& b) {
    return a.at_s.value_or(kLast_s) < b.at_s.value_or(kLast_s);
  });
}

bool InTime(const RunEvidence& evidence, const std::vector<RunFinding>& programs,
            std::span<const Moment> moments) {
  const auto late = [&](const RunFinding& program) {
    return program.at_s && IsOf(moments, *program.at_s, *program.at_s);
  };
  const auto silent = [&](const Silence& leader) { return IsOf(moments, leader.begin_s, leader.end_s); };
  const auto& silences = evidence.leader_silences;
  return std::none_of(programs.begin(), programs.end(), late) &&
         std::none_of(silences.begin(), silences.end(), silent);
}

}  // namespace

std::vector<RunFinding> Diagnose(const RunEvidence& evidence) {
  if (evidence.metrics != nullptr && evidence.metrics->ok) return StallFindings(evidence, evidence.stalls, 1);

  Boards boards = Examine(evidence);
  std::vector<RunFinding> failures = FleetFailures(evidence);
  Append(std::move(boards.failures), &failures);
  SortByTime(&failures);
  std::vector<Moment> moments;
  double last_s = 0.0;
  for (const RunFinding& failure : failures) {
    moments.push_back(MomentOf(evidence, failure.at_s));
    last_s = std::max(last_s, moments.back().to_s);
  }

  // Those before the first failure, then those before a later one, then the others.
  std::vector<Stall> stalls = evidence.stalls;
  const auto part = [&](auto begin, std::span<const Moment> causes) {
    return std::stable_partition(begin, stalls.end(), [&](const Stall& stall) {
      return IsOf(causes, evidence.TimeOf(stall.begin_ns), evidence.TimeOf(stall.end_ns));
    });
  };
  const auto later = part(stalls.begin(), std::span(moments).first(std::min<size_t>(1, moments.size())));
  const auto others = part(later, moments);

  std::vector<RunFinding> findings = FaultFindings(evidence, last_s);
  Append(StallFindings(evidence, {stalls.begin(), later}, kMostStalls), &findings);
  Append(StallFindings(evidence, {later, others}, kMostStalls), &findings);
  const bool from_outside = !findings.empty();
  Append(std::move(failures), &findings);
  Append(std::move(boards.late), &findings);
  const std::vector<RunFinding> programs = ProgramFindings(evidence, moments);
  if (!from_outside && boards.in_time && InTime(evidence, programs, moments))
    findings.push_back({"none", 0, std::nullopt, NothingLate(evidence)});
  Append(programs, &findings);
  Append(std::move(boards.losses), &findings);
  Append(StallFindings(evidence, {others, stalls.end()}, 1), &findings);
  return findings;
}

}  // namespace armada
