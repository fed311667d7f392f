#include "host/run/outside_findings.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "hil/fault_meaning.h"
#include "host/run/board_lateness.h"

namespace armada {
namespace {

double Length_s(const Stall& stall) {
  return 1e-9 * static_cast<double>(stall.end_ns - stall.begin_ns);
}

// Whether the board ticked in more than half of the stall. Its own count of missed ticks tells, also where
// its messages were lost meanwhile; a board that was started anew tells nothing.
bool WentOn(std::span<const telemetry_t> ticks, const Stall& stall, int64_t period_ns) {
  const auto first_from = [&](int64_t at_ns) {
    return std::lower_bound(ticks.begin(), ticks.end(), at_ns,
                            [](const telemetry_t& tick, int64_t t_ns) { return tick.stamp_ns < t_ns; });
  };
  const auto first = first_from(stall.begin_ns);
  if (first == ticks.begin() || first == ticks.end()) return false;
  const auto after = first_from(stall.end_ns);
  const telemetry_t& before = *(first - 1);
  const telemetry_t& last = after == ticks.end() ? ticks.back() : *after;
  if (last.sequence <= before.sequence) return false;
  const int64_t missed_ns = period_ns * (last.missed_ticks - before.missed_ticks);
  const int64_t ticked_ns = std::min(last.stamp_ns, stall.end_ns) - stall.begin_ns - missed_ns;
  return 2 * ticked_ns > stall.end_ns - stall.begin_ns;
}

// Too short a stall tells nothing.
bool BoardsWentOn(const RunEvidence& evidence, const Stall& stall) {
  const auto period_ns = static_cast<int64_t>(1e9 * evidence.scenario->fleet.timing.period_s);
  if (stall.end_ns - stall.begin_ns < 4 * period_ns) return false;
  return std::any_of(evidence.arms.begin(), evidence.arms.end(),
                     [&](const RunEvidence::Arm& arm) { return WentOn(arm.ticks, stall, period_ns); });
}

std::string StallText(const RunEvidence& evidence, const Stall& stall) {
  const bool all = stall.processors == evidence.processors;
  const bool went_on = all && BoardsWentOn(evidence, stall);
  std::string text;
  if (went_on) {
    text = "`armada run` stood still, while boards went on,";
  } else if (all) {
    text = "the machine stood still (or every program of the run was stopped)";
  } else if (stall.processors == 1) {
    text = "processor " + std::to_string(stall.processor) + " of the machine stood still";
  } else {
    text = std::to_string(stall.processors) + " of " + std::to_string(evidence.processors) +
           " processors of the machine stood still";
  }
  char when[64];
  std::snprintf(when, sizeof when, " for %.3f s at ", Length_s(stall));
  text += when + TimeText(evidence.TimeOf(stall.begin_ns));
  if (!evidence.heartbeat_is_foremost) text += "; the heartbeat had no priority: it may have been load";
  return text;
}

RunFinding FaultFinding(int arm_id, double at_s, const std::string& what) {
  return {"fault", arm_id, at_s, what + " at " + TimeText(at_s) + ", as was ordered"};
}

// Whether the leader was stopped or killed then, as was ordered: about when it was last heard, or later.
bool WasOrdered(const RunEvidence& evidence, const Silence& silence) {
  const double begin_s = silence.begin_s - 1.0 / evidence.scenario->leader.rate_hz;
  return std::any_of(evidence.faults_made.begin(), evidence.faults_made.end(),
                     [&](const ProcessFaults::Made& made) {
                       return made.to == ProcessFaults::kLeaderProcess && made.made_s > begin_s &&
                              made.made_s < silence.end_s;
                     });
}

std::string OfArm(int arm_id) {
  return arm_id == 0 ? "" : ", arm " + std::to_string(arm_id) + ",";
}

std::optional<RunFinding> LeaderFinding(const RunEvidence& evidence, std::span<const Moment> moments) {
  std::vector<Silence> silences = evidence.leader_silences;
  std::erase_if(silences, [&](const Silence& silence) { return WasOrdered(evidence, silence); });
  const auto longest =
      std::max_element(silences.begin(), silences.end(), [&](const Silence& a, const Silence& b) {
        const auto rank = [&](const Silence& s) {
          return std::pair(IsOf(moments, s.begin_s, s.end_s), s.end_s - s.begin_s);
        };
        return rank(a) < rank(b);
      });
  if (longest == silences.end()) return std::nullopt;
  char text[64];
  std::snprintf(text, sizeof text, "the leader was not heard for %.3f s until ",
                longest->end_s - longest->begin_s);
  return RunFinding{"leader", 0, longest->end_s, text + TimeText(longest->end_s)};
}

}  // namespace

std::vector<RunFinding> FaultFindings(const RunEvidence& evidence, double until_s) {
  std::vector<RunFinding> findings;
  for (const FaultConfig& fault : evidence.scenario->faults) {
    const FaultMaker maker = MeaningOf(fault.kind).maker;
    const bool hog = fault.kind == FaultKind::kCpuHog && evidence.real_time;
    if (maker != FaultMaker::kEmulation && !hog) continue;
    findings.push_back(
        FaultFinding(fault.arm, fault.at_s, "fault " + std::string(NameOf(fault.kind)) + OfArm(fault.arm)));
  }
  if (evidence.hil.is_object() && evidence.hil.contains("faults_taken")) {
    for (const auto& fault : evidence.hil.at("faults_taken")) {
      const int arm_id = fault.at("arm").get<int>();
      findings.push_back(FaultFinding(arm_id, fault.at("at_s").get<double>(),
                                      "fault " + fault.at("kind").get<std::string>() + OfArm(arm_id)));
    }
  }
  for (const ProcessFaults::Made& made : evidence.faults_made)
    findings.push_back(FaultFinding(0, made.made_s, made.to + ": " + made.what));
  std::erase_if(findings, [&](const RunFinding& finding) { return *finding.at_s > until_s; });
  std::stable_sort(findings.begin(), findings.end(),
                   [](const RunFinding& a, const RunFinding& b) { return *a.at_s < *b.at_s; });
  return findings;
}

std::vector<RunFinding> StallFindings(const RunEvidence& evidence, std::vector<Stall> stalls, size_t most) {
  std::stable_sort(stalls.begin(), stalls.end(),
                   [](const Stall& a, const Stall& b) { return Length_s(a) > Length_s(b); });
  const auto listed = stalls.begin() + static_cast<std::ptrdiff_t>(std::min(most, stalls.size()));
  std::sort(stalls.begin(), listed, [](const Stall& a, const Stall& b) { return a.begin_ns < b.begin_ns; });
  std::vector<RunFinding> findings;
  for (auto stall = stalls.begin(); stall != listed; ++stall)
    findings.push_back({"stall", 0, evidence.TimeOf(stall->begin_ns), StallText(evidence, *stall)});
  if (listed != stalls.end()) {
    char text[96];
    const auto count = static_cast<size_t>(stalls.end() - listed);
    std::snprintf(text, sizeof text, "%zu further %s of at most %.3f s", count,
                  count == 1 ? "stall" : "stalls", Length_s(*listed));
    findings.push_back({"stall", 0, std::nullopt, text});
  }
  return findings;
}

std::vector<RunFinding> ProgramFindings(const RunEvidence& evidence, std::span<const Moment> moments) {
  std::vector<RunFinding> findings;
  if (auto leader = LeaderFinding(evidence, moments)) findings.push_back(std::move(*leader));
  bool has_priority = true;
  const auto look = [&](const Json& program) {
    if (program.is_object() && !program.at("timing").at("realtime_priority").get<bool>())
      has_priority = false;
  };
  look(evidence.hil);
  for (const RunEvidence::Arm& arm : evidence.arms) look(arm.board);
  if (evidence.hil.is_object()) {
    const Json& timing = evidence.hil.at("timing");
    const double late_s = 1e-6 * timing.at("pacing_us").at("max").get<double>();
    const double at_s = timing.at("latest_at_s").get<double>();
    if (late_s >= TolerableLateness_s(evidence.scenario->fleet.timing)) {
      char text[96];
      std::snprintf(text, sizeof text, "the emulation (armada-hil) was %.1f ms late at ", late_s * 1e3);
      findings.push_back({"emulation", 0, at_s, text + TimeText(at_s)});
    }
  }
  const double bring_up_s = evidence.scenario->fleet.timing.bring_up_s;
  if (evidence.started_s > -bring_up_s && evidence.real_time) {
    char text[96];
    std::snprintf(text, sizeof text, "; timing.bring_up_s is %g s: the machine was busy", bring_up_s);
    findings.push_back({"start", 0, evidence.started_s,
                        "the last program was started at " + TimeText(evidence.started_s) + text});
  }
  if (!has_priority && evidence.real_time)
    findings.push_back({"priority", 0, std::nullopt, "boards or emulation had no real-time priority"});
  return findings;
}

}  // namespace armada
