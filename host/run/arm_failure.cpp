#include "host/run/arm_failure.h"

#include <algorithm>

#include "firmware/core/cause.h"
#include "host/number_format.h"
#include "host/run/board_lateness.h"
#include "host/run/failure_moment.h"

namespace armada {
namespace {

constexpr double kTelling_s = 0.1;  // a tick that was late tells of it later

// The last tick at which the arm went to a state in which it does not follow; null: it never did.
const telemetry_t* StopOf(std::span<const telemetry_t> ticks) {
  const telemetry_t* stop = nullptr;
  bool stopped = false;
  for (const telemetry_t& tick : ticks) {
    const bool stops = HasStopped(static_cast<ControllerState>(tick.state));
    if (stops && !stopped) stop = &tick;
    stopped = stops;
  }
  return stopped ? stop : nullptr;
}

std::string StopText(const telemetry_t& stop, const telemetry_t& last, double at_s) {
  const auto state = [](const telemetry_t& tick) { return NameOf(static_cast<ControllerState>(tick.state)); };
  const auto cause = [](const telemetry_t& tick) { return NameOf(static_cast<Cause>(tick.cause)); };
  std::string text =
      std::string("went to ") + state(stop) + " at " + TimeText(at_s) + " (" + cause(stop) + ")";
  if (stop.state != last.state) text += std::string(", then ") + state(last) + " (" + cause(last) + ")";
  return text;
}

/// Collects what the arm misses, the most telling first, and when that showed.
class Words {
 public:
  void Add(const std::string& kind, std::optional<double> at_s, const std::string& text) {
    if (text_.empty()) kind_ = kind;
    text_ += (text_.empty() ? "" : ", ") + text;
    if (!at_s_) at_s_ = at_s;
  }
  bool empty() const { return text_.empty(); }
  const std::string& kind() const { return kind_; }
  const std::string& text() const { return text_; }
  std::optional<double> at_s() const { return at_s_; }

 private:
  std::string kind_;
  std::string text_;
  std::optional<double> at_s_;
};

std::string ErrorText(const ArmMetrics& arm, const ScenarioConfig& scenario) {
  const bool leaderless = scenario.leader.kind == LeaderKind::kNone;
  std::string text =
      "was " + NumberAs("%.1f mm from ", arm.max_m * 1e3) + (leaderless ? "the agreed point" : "the leader");
  if (arm.max_at_s) text += " at " + TimeText(*arm.max_at_s);
  text += NumberAs(" (criterion.error_max_m is %g mm)", scenario.criterion.error_max_m * 1e3);
  return text;
}

void AddMisses(const RunEvidence& evidence, const ArmMetrics& arm, Words* words) {
  for (const Miss& miss : evidence.metrics->misses) {
    if (miss.arm_id != arm.id) continue;
    if (miss.kind == MissKind::kError)
      words->Add("error", arm.beyond_at_s, ErrorText(arm, *evidence.scenario));
    if (miss.kind == MissKind::kDiverged) words->Add("diverged", arm.beyond_at_s, "diverged");
    if (miss.kind == MissKind::kMoved) {
      words->Add("moved", std::nullopt,
                 "was to stand still and moved at " + NumberAs("%.2f rad/s", arm.joint_speed_max_rad_s));
    }
  }
}

bool Misses(const RunEvidence& evidence, MissKind kind, int arm_id) {
  const auto& misses = evidence.metrics->misses;
  return std::any_of(misses.begin(), misses.end(),
                     [&](const Miss& miss) { return miss.kind == kind && miss.arm_id == arm_id; });
}

// Joints whose drive had lost its power by then, in order.
std::string DrivesOff(const Json& bench, double until_s) {
  std::string text;
  if (!bench.is_object()) return text;
  const Json& drives = bench.at("drives");
  for (size_t joint = 0; joint < drives.size(); ++joint) {
    const Json& off_s = drives[joint].at("off_s");
    if (off_s.is_null() || off_s.get<double>() > until_s) continue;
    text += (text.empty() ? "" : ", ") + ("drive " + std::to_string(joint + 1)) + " off at " +
            TimeText(off_s.get<double>());
  }
  return text;
}

std::string LateText(const RunEvidence& evidence, size_t index, double from_s, double to_s) {
  const TimingConfig& timing = evidence.scenario->fleet.timing;
  return LatenessBetween(evidence.arms[index].ticks, timing.period_s, evidence.epoch_ns, from_s, to_s)
      .Text(timing);
}

// What was late or lost on the board at that moment; where nothing was, before it; empty: nothing ever.
std::string MomentText(const RunEvidence& evidence, size_t index, const Moment& moment) {
  // In its last tick a board puts its drives to rest.
  const double rest_s = evidence.scenario->seconds - 1.5 * evidence.scenario->fleet.timing.period_s;
  const std::string off = DrivesOff(evidence.arms[index].bench, std::min(moment.to_s, rest_s));
  std::string late = LateText(evidence, index, moment.from_s, moment.to_s + kTelling_s);
  if (late.empty()) {
    late = LateText(evidence, index, -kMoment_s, moment.to_s);
    if (!late.empty()) late = "before: " + late;
  }
  return off.empty() || late.empty() ? off + late : off + "; " + late;
}

}  // namespace

std::optional<ArmFailure> FailureOf(const RunEvidence& evidence, size_t index) {
  const int id = evidence.scenario->fleet.arms[index].id;
  const std::span<const telemetry_t> ticks = evidence.arms[index].ticks;
  const std::string name = "arm " + std::to_string(id) + " ";
  if (ticks.empty()) {
    if (evidence.broke_off_s < kMoment_s && evidence.metrics == nullptr) return std::nullopt;  // too early
    return ArmFailure{{"not_heard", id, std::nullopt, name + "was never heard on LCM"}, false};
  }
  Words words;
  const telemetry_t* stop = StopOf(ticks);
  const ArmMetrics* arm = evidence.metrics == nullptr ? nullptr : &evidence.metrics->arms[index];
  const bool misses_stop = arm == nullptr || Misses(evidence, MissKind::kStopped, id);
  if (stop != nullptr && misses_stop) {
    const double at_s = evidence.TimeOf(stop->stamp_ns);
    words.Add("stopped", at_s, StopText(*stop, ticks.back(), at_s));
  } else if (arm != nullptr && misses_stop) {
    words.Add("stopped", evidence.TimeOf(ticks.back().stamp_ns),
              "ended in " + arm->state + " (" + arm->faults.front() + ")");
  }
  if (arm != nullptr) AddMisses(evidence, *arm, &words);
  if (words.empty()) return std::nullopt;

  const double last_s = evidence.TimeOf(ticks.back().stamp_ns);
  std::string text = name + words.text();
  bool in_time = false;
  const double end_s = arm == nullptr ? evidence.broke_off_s : evidence.scenario->seconds;
  const bool silent = last_s < end_s - kMoment_s;
  if (silent) text += "; last heard at " + TimeText(last_s);
  const std::string late = MomentText(evidence, index, MomentOf(evidence, words.at_s()));
  if (!late.empty()) {
    text += "; " + late;
  } else if (!silent) {
    text += "; nothing was late or lost on its board before";
    in_time = true;
  }
  return ArmFailure{{words.kind(), id, words.at_s(), text}, in_time};
}

std::optional<RunFinding> LatenessOf(const RunEvidence& evidence, size_t index) {
  const std::string late = MomentText(evidence, index, MomentOf(evidence, std::nullopt));
  if (late.empty()) return std::nullopt;
  const int id = evidence.scenario->fleet.arms[index].id;
  return RunFinding{"late", id, std::nullopt, "arm " + std::to_string(id) + ": " + late};
}

std::optional<RunFinding> LossesOf(const RunEvidence& evidence, size_t index) {
  const Json& board = evidence.arms[index].board;
  if (!board.is_object()) return std::nullopt;
  std::string text;
  const auto add = [&](int64_t count, const std::string& words) {
    if (count > 0) text += (text.empty() ? "" : ", ") + words + " " + std::to_string(count);
  };
  const auto count = [&](const char* section, const char* key) {
    return board.at(section).at(key).get<int64_t>();
  };
  add(count("timing", "missed_ticks"), "missed ticks");
  add(count("timing", "incomplete_samples"), "ticks without every sample");
  add(count("timing", "unsent_ticks"), "ticks whose torques were not on the wire in time");
  add(count("bus", "can_dropped") + count("bus", "can_dropped_late"), "dropped CAN frames");
  add(count("bus", "can_receive_overflowed"), "overflowed CAN frames");
  add(count("bus", "can_errors"), "CAN errors");
  add(count("bus", "lcm_overflowed"), "overflowed LCM messages");
  add(count("bus", "lcm_rejected"), "rejected LCM messages");
  for (const Json& sender : board.at("bus").at("lcm_heard")) {
    const int from = sender.at("from").get<int>();
    add(sender.at("missed").get<int64_t>(),
        std::string("missed messages of ") +
            (from == 0 ? "the leader:" : "arm " + std::to_string(from) + ":"));
  }
  if (text.empty()) return std::nullopt;
  const int id = evidence.scenario->fleet.arms[index].id;
  return RunFinding{"losses", id, std::nullopt, "arm " + std::to_string(id) + " in the whole run: " + text};
}

}  // namespace armada
