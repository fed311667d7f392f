#include "hil/fault_meaning.h"

#include <array>
#include <initializer_list>
#include <string_view>

namespace armada {
namespace {

constexpr double kMost = 1e6;
constexpr FaultValue kShare = {"share of them", "", 1e-6, 1.0};

constexpr auto kMeanings = std::to_array<FaultMeaning>({
    {FaultKind::kDrive,
     FaultTarget::kArm,
     FaultEnd::kMay,
     FaultMaker::kEmulation,
     {},
     "a signal of a drive is wrong: below"},
    {FaultKind::kDriveError,
     FaultTarget::kArm,
     FaultEnd::kNever,
     FaultMaker::kEmulation,
     {},
     "the drive fails by itself: it reports an error and takes its power away"},
    {FaultKind::kBusLoss, FaultTarget::kArm, FaultEnd::kMay, FaultMaker::kEmulation, kShare,
     "CAN frames are lost, both ways"},
    {FaultKind::kBusDelay,
     FaultTarget::kArm,
     FaultEnd::kMay,
     FaultMaker::kEmulation,
     {"delay", "s", 1e-4, 0.1},
     "CAN frames are late, both ways, in order"},
    {FaultKind::kBusOff,
     FaultTarget::kArm,
     FaultEnd::kMay,
     FaultMaker::kEmulation,
     {},
     "the board's CAN controller is bus-off, and restarted in the end: no frame passes"},
    {FaultKind::kErrorPassive,
     FaultTarget::kArm,
     FaultEnd::kMay,
     FaultMaker::kNobody,
     {},
     "the board's CAN controller is error-passive: frames pass"},
    {FaultKind::kBusDown,
     FaultTarget::kArm,
     FaultEnd::kMay,
     FaultMaker::kEmulation,
     {},
     "the board's CAN interface is down: no frame passes"},
    {FaultKind::kQueueFull,
     FaultTarget::kArm,
     FaultEnd::kMay,
     FaultMaker::kNobody,
     {},
     "the board's transmit queue is full: its torques are not sent"},
    {FaultKind::kControllerDies,
     FaultTarget::kArm,
     FaultEnd::kNever,
     FaultMaker::kRun,
     {},
     "the controller is killed, for good"},
    {FaultKind::kControllerStops,
     FaultTarget::kArm,
     FaultEnd::kMay,
     FaultMaker::kRun,
     {},
     "the controller gets no time, as after SIGSTOP, and then goes on"},
    {FaultKind::kControllerRestarts,
     FaultTarget::kArm,
     FaultEnd::kMust,
     FaultMaker::kRun,
     {},
     "the controller is killed, and a new one starts at until_s"},
    {FaultKind::kSlowTick,
     FaultTarget::kArm,
     FaultEnd::kMay,
     FaultMaker::kNobody,
     {"time", "s", 1e-4, 1.0},
     "each tick takes the controller that long"},
    {FaultKind::kCpuHog,
     FaultTarget::kComputer,
     FaultEnd::kMust,
     FaultMaker::kRunOnly,
     {"SCHED_FIFO priority, 0: none", "", 0.0, 99.0},
     "a program of that priority keeps a processor busy"},
    {FaultKind::kLeaderDies,
     FaultTarget::kLeader,
     FaultEnd::kNever,
     FaultMaker::kRun,
     {},
     "the leader falls silent"},
    {FaultKind::kLeaderStops,
     FaultTarget::kLeader,
     FaultEnd::kMust,
     FaultMaker::kRun,
     {},
     "the leader is silent for a while"},
    {FaultKind::kLeaderJumps,
     FaultTarget::kLeader,
     FaultEnd::kMay,
     FaultMaker::kNobody,
     {"distance on each axis", "m", -1e3, 1e3},
     "the leader's position is off"},
    {FaultKind::kLeaderNonfinite,
     FaultTarget::kLeader,
     FaultEnd::kMay,
     FaultMaker::kNobody,
     {},
     "the leader's position is no number"},
    {FaultKind::kLinkLoss, FaultTarget::kSender, FaultEnd::kMay, FaultMaker::kNobody, kShare,
     "messages to and from it are lost, each receiver on its own"},
    {FaultKind::kPartition,
     FaultTarget::kSender,
     FaultEnd::kMay,
     FaultMaker::kNobody,
     {},
     "it neither hears nor is heard"},
    {FaultKind::kReplay,
     FaultTarget::kSender,
     FaultEnd::kMay,
     FaultMaker::kNobody,
     {"age", "s", 1e-3, 10.0},
     "its messages of that age are sent again, beside the new ones"},
    {FaultKind::kReorder,
     FaultTarget::kSender,
     FaultEnd::kMay,
     FaultMaker::kNobody,
     {},
     "its messages come in pairs, the newer one first"},
    {FaultKind::kForge,
     FaultTarget::kSender,
     FaultEnd::kMay,
     FaultMaker::kNobody,
     {"distance on each axis", "m", -1e3, 1e3},
     "before each of its messages comes one that is off, under a wrong seal"},
    {FaultKind::kJunk,
     FaultTarget::kSender,
     FaultEnd::kMay,
     FaultMaker::kNobody,
     {"messages a second", "1/s", 1.0, 1e5},
     "random bytes come on its channel"},
});

constexpr FaultValue WrongOf(FaultSignal signal) {
  switch (signal) {
    case FaultSignal::kPosition:
      return {"added", "rad", -kMost, kMost};
    case FaultSignal::kVelocity:
      return {"added", "rad/s", -kMost, kMost};
    case FaultSignal::kCurrent:
      return {"factor", "", -kMost, kMost};
    case FaultSignal::kNone:
    case FaultSignal::kStatus:
      break;
  }
  return {};
}

constexpr FaultValue GarbageOf(FaultSignal signal) {
  switch (signal) {
    case FaultSignal::kPosition:
      return {"largest", "rad", 1e-6, kMost};
    case FaultSignal::kVelocity:
      return {"largest", "rad/s", 1e-6, kMost};
    case FaultSignal::kCurrent:
      return {"largest", "N m", 1e-6, kMost};
    case FaultSignal::kNone:
    case FaultSignal::kStatus:
      break;
  }
  return {};
}

constexpr FaultValue ValueOf(FaultSignal signal, FaultWay way) {
  switch (way) {
    case FaultWay::kNone:
    case FaultWay::kOff:
    case FaultWay::kStuck:
      break;
    case FaultWay::kGarbage:
      return GarbageOf(signal);
    case FaultWay::kWrong:
      return WrongOf(signal);
    case FaultWay::kSlow:
      return {"period", "s", 1e-3, 10.0};
    case FaultWay::kDelayed:
      return {"delay", "s", 1e-3, 0.1};
    case FaultWay::kIntermittent:
      return {"share of the time", "", 1e-6, 1.0};
  }
  return {};
}

/// What becomes of a sensed or produced value, and of a status.
struct WayMeaning {
  FaultWay way;
  const char* of_value;
  const char* of_status;
};
constexpr auto kWays = std::to_array<WayMeaning>({
    {FaultWay::kOff, "is 0", "is not told"},
    {FaultWay::kStuck, "stays as it was", "stays as it was"},
    {FaultWay::kGarbage, "is random, another each millisecond", "is random bits"},
    {FaultWay::kWrong, "is off; of `current`: has another factor", "claims an error that is none"},
    {FaultWay::kSlow, "is renewed once a period", "is told once a period"},
    {FaultWay::kDelayed, "is that of some time ago", "is that of some time ago"},
    {FaultWay::kIntermittent, "is 0 now and then", "is not told now and then"},
});

std::string TextOf(FaultTarget target) {
  if (target == FaultTarget::kArm) return "an arm";
  if (target == FaultTarget::kComputer) return "the computer";
  return target == FaultTarget::kLeader ? "the leader" : "an arm or the leader";
}

std::string TextOf(FaultEnd end) {
  if (end == FaultEnd::kMay) return "";
  return end == FaultEnd::kMust ? "required" : "none";
}

std::string TextOf(FaultMaker maker) {
  switch (maker) {
    case FaultMaker::kNobody:
      break;
    case FaultMaker::kEmulation:
      return "`armada-hil`";
    case FaultMaker::kRun:
      return "`armada run`";
    case FaultMaker::kRunOnly:
      return "`armada run`, only there";
  }
  return "";
}

std::string TextOf(const FaultValue& value) {
  std::string text = value.meaning;
  if (*value.unit != '\0') text.append(", ").append(value.unit);
  return text;
}

/// Of the signals that share a way: each unit that `value` may have.
std::string TextOf(FaultWay way) {
  std::string text;
  std::string last;
  for (const FaultSignal signal : {FaultSignal::kPosition, FaultSignal::kVelocity, FaultSignal::kCurrent}) {
    const FaultValue value = ValueOf(signal, way);
    const std::string all = TextOf(value);
    if (all == last) continue;
    const bool same_meaning = !last.empty() && last.rfind(value.meaning, 0) == 0;
    text.append(text.empty() ? "" : same_meaning ? ", " : "; ").append(same_meaning ? value.unit : all);
    last = all;
  }
  return text;
}

std::string Row(std::initializer_list<std::string> cells) {
  std::string row = "|";
  for (const std::string& cell : cells) row += (cell.empty() ? "" : " " + cell) + " |";
  return row + "\n";
}
std::string Code(std::string_view name) {
  return "`" + std::string(name) + "`";
}

}  // namespace

const FaultMeaning& MeaningOf(FaultKind kind) {
  for (const FaultMeaning& meaning : kMeanings) {
    if (meaning.kind == kind) return meaning;
  }
  return kMeanings.front();  // not reached: every kind that has a name is there, as a test sees
}

FaultValue ValueOf(const FaultConfig& fault) {
  return fault.kind == FaultKind::kDrive ? ValueOf(fault.signal, fault.way) : MeaningOf(fault.kind).value;
}

std::string FaultTables() {
  std::string text =
      "| `kind` | of | `until_s` | `value` | what | made in real time by |\n|---|---|---|---|---|---|\n";
  for (const FaultMeaning& meaning : kMeanings) {
    text += Row({Code(NameOf(meaning.kind)), TextOf(meaning.target), TextOf(meaning.end),
                 TextOf(meaning.value), meaning.what, TextOf(meaning.maker)});
  }
  text += "\n| `way` | a position, velocity or torque | `value` | a status |\n|---|---|---|---|\n";
  for (const WayMeaning& way : kWays) {
    text += Row({Code(NameOf(way.way)), way.of_value, TextOf(way.way), way.of_status});
  }
  return text;
}

}  // namespace armada
