#include "host/campaign/trial.h"

#include <algorithm>

#include "hil/fault_meaning.h"
#include "hil/faulty_status.h"
#include "host/campaign/dice.h"

namespace armada {
namespace {

constexpr double kArmed_s = 1.0;    // the fleet is armed before this
constexpr double kStarted_s = 2.5;  // and started between these two
constexpr double kShortest_s = 0.005;
constexpr double kLongest_s = 2.0;

/// Values worth trying: from what is hardly felt to what is gross.
struct Range {
  double low;
  double high;
  bool either_sign = false;
};

Range RangeOfWay(FaultSignal signal, FaultWay way) {
  switch (way) {
    case FaultWay::kGarbage:
      return {0.01, signal == FaultSignal::kCurrent ? 100.0 : 10.0};
    case FaultWay::kWrong:
      if (signal == FaultSignal::kCurrent) return {0.1, 3.0, true};
      return {0.001, signal == FaultSignal::kPosition ? 3.0 : 30.0, true};
    case FaultWay::kSlow:
      return {0.001, 1.0};
    case FaultWay::kDelayed:
      return {0.001, 0.1};
    case FaultWay::kIntermittent:
      return {0.01, 0.9};
    case FaultWay::kNone:
    case FaultWay::kOff:
    case FaultWay::kStuck:
      break;
  }
  return {0.0, 0.0};
}

Range RangeOf(const FaultConfig& fault) {
  switch (fault.kind) {
    case FaultKind::kDrive:
      return RangeOfWay(fault.signal, fault.way);
    case FaultKind::kBusLoss:
      return {0.01, 0.3};
    case FaultKind::kBusDelay:
      return {0.001, 0.02};
    case FaultKind::kSlowTick:
      return {0.0001, 0.05};
    case FaultKind::kLeaderJumps:
    case FaultKind::kForge:
      return {0.001, 1.0, true};
    case FaultKind::kLinkLoss:
      return {0.01, 1.0};
    case FaultKind::kReplay:
      return {0.01, 2.0};
    case FaultKind::kJunk:
      return {100.0, 10'000.0};
    default:
      return {0.0, 0.0};
  }
}

/// Half of the fleets have the drives of the file, the others drives of some family.
void DrawDrives(Dice* dice, FleetConfig* fleet) {
  if (dice->Comes(0.5)) return;
  constexpr auto kProfiles = EnumNames(DriveProfile{});
  const DriveProfile profile = dice->OneOf(kProfiles).first;
  for (ArmEntry& arm : fleet->arms) {
    for (JointDriveConfig& drive : arm.joints) drive.profile = profile;
  }
}

double DrawValue(const FaultConfig& fault, Dice* dice) {
  if (*ValueOf(fault).meaning == '\0') return 0.0;
  const Range range = RangeOf(fault);
  const double value = dice->InDecades(range.low, range.high);
  return range.either_sign && dice->Comes(0.5) ? -value : value;
}

bool TellsStatus(const ArmEntry& arm, int joint) {
  return joint != 0 ? TellsStatus(arm.joints[static_cast<size_t>(joint - 1)])
                    : std::all_of(arm.joints.begin(), arm.joints.end(),
                                  [](const JointDriveConfig& drive) { return TellsStatus(drive); });
}

/// Every kind that virtual time knows as often as every other but the drives' signals, of which there are 28.
FaultKind DrawKind(Dice* dice) {
  constexpr auto kKinds = EnumNames(FaultKind{});
  FaultKind kind = FaultKind::kDrive;
  if (dice->Comes(0.4)) return kind;
  do {
    kind = dice->OneOf(kKinds).first;
  } while (MeaningOf(kind).maker == FaultMaker::kRunOnly);
  return kind;
}

void DrawSignal(const ArmEntry& arm, Dice* dice, FaultConfig* fault) {
  constexpr std::array kSignals = {FaultSignal::kPosition, FaultSignal::kVelocity, FaultSignal::kStatus,
                                   FaultSignal::kCurrent};
  constexpr std::array kWays = {FaultWay::kOff,  FaultWay::kStuck,   FaultWay::kGarbage,     FaultWay::kWrong,
                                FaultWay::kSlow, FaultWay::kDelayed, FaultWay::kIntermittent};
  do {
    fault->signal = dice->OneOf(kSignals);
  } while (fault->signal == FaultSignal::kStatus && !TellsStatus(arm, fault->joint));
  fault->way = dice->OneOf(kWays);
}

FaultConfig DrawFault(const FleetConfig& fleet, double at_s, Dice* dice) {
  FaultConfig fault;
  fault.kind = DrawKind(dice);
  fault.at_s = at_s;
  const FaultMeaning& meaning = MeaningOf(fault.kind);
  const ArmEntry& arm = fleet.arms[dice->Below(fleet.arms.size())];
  const bool leader =
      meaning.target == FaultTarget::kLeader || (meaning.target == FaultTarget::kSender && dice->Comes(0.2));
  fault.arm = leader ? 0 : arm.id;
  if (fault.kind == FaultKind::kDrive || fault.kind == FaultKind::kDriveError) {
    fault.joint = static_cast<int>(dice->Below(arm.joints.size() + 1));
  }
  if (fault.kind == FaultKind::kDrive) DrawSignal(arm, dice, &fault);
  const bool ends = meaning.end == FaultEnd::kMust || (meaning.end == FaultEnd::kMay && dice->Comes(0.5));
  if (ends) {
    fault.until_s = std::min(kLastEvent_s, fault.at_s + dice->InDecades(kShortest_s, kLongest_s));
    fault.at_s = std::min(fault.at_s, fault.until_s - kShortest_s);
  }
  fault.value = DrawValue(fault, dice);
  return fault;
}

/// The second of a pair comes with the first, while its stop is under way, or whenever.
double DrawSecondTime(double first_s, Dice* dice) {
  switch (dice->Below(3)) {
    case 0:
      return first_s;
    case 1:
      return std::min(kLastEvent_s - kShortest_s, first_s + dice->InDecades(0.001, 0.5));
    default:
      return dice->In(0.0, kLastEvent_s - kShortest_s);
  }
}

std::vector<OperatorConfig> DrawOperations(const FleetConfig& fleet, Dice* dice) {
  constexpr std::array kRequests = {Request::kArm, Request::kStart, Request::kHold, Request::kReset,
                                    Request::kEstop};
  std::vector<OperatorConfig> operations = {{dice->In(0.6, kArmed_s), 0, Request::kArm},
                                            {dice->In(kArmed_s + 1.0, kStarted_s), 0, Request::kStart}};
  for (size_t more = dice->Below(6); more > 0; --more) {
    const int arm = dice->Comes(0.2) ? 0 : fleet.arms[dice->Below(fleet.arms.size())].id;
    operations.push_back({dice->In(0.0, kLastEvent_s), arm, dice->OneOf(kRequests)});
  }
  return operations;
}

}  // namespace

ScenarioConfig DrawTrial(const ScenarioConfig& base, uint64_t seed) {
  Dice dice(seed);
  ScenarioConfig trial = base;
  DrawDrives(&dice, &trial.fleet);
  const bool operated = dice.Comes(1.0 / 3.0);
  if (operated) {
    trial.start.mode = StartMode::kMonitor;
    trial.operations = DrawOperations(trial.fleet, &dice);
  }
  if (dice.Comes(0.25)) {
    for (ArmEntry& arm : trial.fleet.arms) arm.control.supervisor.fleet_stop = FleetStop::kHold;
  }
  // Most faults meet an arm that follows; some come while boards start or are being armed.
  const bool early = operated || dice.Comes(0.2);
  const bool from_the_start = early && dice.Comes(0.1);
  const double first_s = from_the_start ? 0.0 : dice.In(early ? 0.0 : kSettled_s, kLastEvent_s - kShortest_s);
  if (!operated || dice.Comes(0.9)) trial.faults.push_back(DrawFault(trial.fleet, first_s, &dice));
  if (!trial.faults.empty() && dice.Comes(0.5)) {
    trial.faults.push_back(DrawFault(trial.fleet, DrawSecondTime(first_s, &dice), &dice));
  }
  return trial;
}

}  // namespace armada
