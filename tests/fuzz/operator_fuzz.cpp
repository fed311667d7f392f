#include <algorithm>
#include <cmath>
#include <vector>

#include "firmware/app/arm_node.h"
#include "firmware/app/config/fleet_file.h"
#include "hil/emulated_arm.h"
#include "hil/scenario_file.h"
#include "tests/fuzz/byte_source.h"
#include "tests/fuzz/input_key.h"
#include "tests/fuzz/operator_actions.h"
#include "tests/fuzz/require.h"

namespace armada {
namespace {

constexpr int64_t kEpochNs = 1'000'000'000;
constexpr int64_t kPeriodNs = 10'000'000;
constexpr double kPeriod_s = 0.01;
constexpr FleetKey kStrangersKey = {2};
// Drives that hear nothing trip their watchdogs after 30 ms.
constexpr int kTicksToRest = 10;
// A command counts within a second of the stamp that it quotes, and that may be a second ahead.
constexpr int64_t kTicksOfACommand = 201;

/// A board that is soon ready: an input has no time to wait.
const ScenarioConfig& Scenario() {
  static const ScenarioConfig scenario = [] {
    std::vector<ConfigError> errors;
    const auto loaded =
        LoadScenario(ARMADA_FUZZ_SCENARIO,
                     {"control.supervisor.good_samples=2", "control.supervisor.hold_clear_s=0.02",
                      "control.supervisor.law_ramp_s=0.05", "control.supervisor.safe_stop_max_s=0.2",
                      "disturbance.amplitude_Nm=0.0", "start.zeta_range=0.0"},
                     &errors);
    Require(loaded.has_value(), "the fuzzer's scenario is read");
    return *loaded;
  }();
  return scenario;
}

bool IsTransition(ControllerState from, ControllerState to) {
  return std::any_of(kTransitions.begin(), kTransitions.end(),
                     [&](const Transition& way) { return way.from == from && way.to == to; });
}

/// What only an operator may do, and with which request.
Request NeededFor(ControllerState from, ControllerState to) {
  using enum ControllerState;
  if (from == kMonitor && to == kArming) return Request::kArm;
  if (from == kHold && to == kRun) return Request::kStart;
  if ((from == kHold || from == kFault) && to == kInit) return Request::kReset;
  return Request::kNone;
}

/// A board with its drives, the leader, its operator, and strangers who know all that was sent.
class OperatedBoard {
 public:
  explicit OperatedBoard(const FleetKey& key)
      : leader_path_(Scenario().leader),
        start_(DrawStart(Scenario(), 0, 1, &leader_path_)),
        bench_(Scenario(), 0, 1, start_, &leader_path_, -1.0),
        node_(Scenario().fleet, 0, start_.controller, kEpochNs,
              {StartMode::kMonitor, kDigest, LinkIdentity{key, 1}}),
        leader_({key, 1}, kLeaderSender),
        operator_({key, 1}, kOperatorSender),
        stranger_({kStrangersKey, 9}, kOperatorSender),
        estimates_(key, 1),
        replies_(key, 1) {}

  void Do(OperatorAction action, ByteSource* choices) {
    switch (action) {
      case OperatorAction::kTicks:
        for (int left = 1 + choices->Byte() % 32; left > 0; --left) Tick();
        return;
      case OperatorAction::kCommand:
        return Speak(Wanted(choices), &operator_);
      case OperatorAction::kWrong:
        return SpeakWrongly(choices);
      case OperatorAction::kRepeat:
        if (!past_.empty()) Deliver(past_[choices->Byte() % past_.size()]);
        return;
      case OperatorAction::kDamage:
        return Damage(choices);
      case OperatorAction::kForeign:
        return Deliver(Sealed(Wanted(choices), &stranger_));
      case OperatorAction::kNoSeal: {
        const auto bare = Encode(Wanted(choices), &buffer_);
        return Deliver({bare.begin(), bare.end()});
      }
      case OperatorAction::kLeader:
        leader_speaks_ = !leader_speaks_;
        return;
      case OperatorAction::kDrives:
        drives_heard_ = !drives_heard_;
        return;
      case OperatorAction::kCount:
        break;
    }
  }

  void Tick() {
    const ControllerState before = node_.state();
    Listen();
    node_.RequestSamples(NowNs(), &to_drives_);
    Carry();
    if (leader_speaks_) SendLeader();
    node_.Step(NowNs(), &to_drives_);
    Carry();
    CheckReply();
    for (int ms = 1; ms <= 10; ++ms) Advance(TimeOf(tick_) + 1e-3 * ms);
    ++tick_;
    CheckStep(before, node_.state());
  }

 private:
  using Bytes = std::vector<uint8_t>;
  static constexpr int64_t kDigest = 7;
  /// A command that was the operator's.
  struct Asked {
    Request request;
    int64_t tick;
    bool done = false;
  };

  double TimeOf(int64_t tick) const { return kPeriod_s * static_cast<double>(tick); }
  int64_t NowNs() const { return kEpochNs + tick_ * kPeriodNs; }

  void Listen() {
    std::span<const uint8_t> sealed = node_.EncodeEstimate(NowNs(), &buffer_);
    estimate_t estimate;
    Require(estimates_.Open(node_.estimate_channel(), &sealed) == SealVerdict::kGenuine &&
                Decode(sealed, &estimate),
            "a board's estimate is valid and sealed");
    heard_ns_ = estimate.stamp_ns;
  }

  void Carry() {
    for (const CanFrame& frame : to_drives_) bench_.OnFrame(TimeOf(tick_), frame, &to_board_);
    to_drives_.Clear();
    HandOver(TimeOf(tick_));
  }
  void Advance(double t_s) {
    bench_.AdvanceTo(t_s, &to_board_);
    HandOver(t_s);
  }
  void HandOver(double t_s) {
    for (CanFrame frame : to_board_) {
      frame.stamp_ns = kEpochNs + std::llround(t_s * 1e9);
      if (drives_heard_) node_.OnFrame(frame);
    }
    to_board_.Clear();
  }

  void SendLeader() {
    const Zeta zeta = leader_path_.At(TimeOf(tick_));
    leader_t message{};
    message.stamp_ns = NowNs();
    message.sequence = ++leader_messages_;
    message.task_dim = PlanarArm::kTaskDim;
    for (int c = 0; c < PlanarArm::kTaskDim; ++c) {
      message.x_m[c] = zeta.x_m[c];
      message.v_m_s[c] = zeta.v_m_s[c];
      message.a_m_s2[c] = zeta.a_m_s2[c];
      message.jerk_m_s3[c] = leader_path_.Jerk(TimeOf(tick_))[c];
    }
    const auto sealed = leader_.Seal(kLeaderChannel, Encode(message, &buffer_), &buffer_);
    node_.OnMessage({kLeaderChannel, sealed, NowNs()});
  }

  command_t Wanted(ByteSource* choices) {
    command_t command{};
    command.stamp_ns = ++commands_;
    command.sequence = 1;
    command.arm_id = static_cast<int8_t>(node_.id());
    command.request = static_cast<int8_t>(1 + choices->Byte() % (kRequests - 1));
    command.heard_stamp_ns = heard_ns_;
    command.fleet_digest = kDigest;
    return command;
  }
  Bytes Sealed(const command_t& command, Sealer* sealer) {
    const auto sealed = sealer->Seal(kCommandChannel, Encode(command, &buffer_), &buffer_);
    return {sealed.begin(), sealed.end()};
  }
  void Speak(const command_t& command, Sealer* sealer) {
    past_.push_back(Sealed(command, sealer));
    asked_.push_back({static_cast<Request>(command.request), tick_});
    Deliver(past_.back());
  }
  void SpeakWrongly(ByteSource* choices) {
    command_t command = Wanted(choices);
    command.request = static_cast<int8_t>(choices->Byte());
    command.arm_id = static_cast<int8_t>(choices->Byte());
    command.heard_stamp_ns += int64_t{1'000'000} * choices->Signed16();
    command.fleet_digest += choices->Byte() % 2;
    Speak(command, &operator_);
  }
  void Damage(ByteSource* choices) {
    if (past_.empty()) return;
    Bytes damaged = past_[choices->Byte() % past_.size()];
    const size_t bit = choices->Unsigned(2) % (8 * damaged.size());
    damaged[bit / 8] ^= static_cast<uint8_t>(1 << bit % 8);
    Deliver(damaged);
  }
  void Deliver(const Bytes& bytes) { node_.OnMessage({kCommandChannel, bytes, NowNs()}); }

  void CheckReply() {
    std::span<const uint8_t> sealed = node_.EncodeReply(NowNs(), &buffer_);
    if (sealed.empty()) return;
    reply_t reply;
    Require(replies_.Open(node_.reply_channel(), &sealed) == SealVerdict::kGenuine && Decode(sealed, &reply),
            "a reply is valid and sealed");
    Require(!past_.empty(), "nobody is answered who has not asked");
  }

  /// Whether the operator has lately given such a command that has not had its effect.
  bool UseUp(Request request) {
    const auto found = std::find_if(asked_.begin(), asked_.end(), [&](const Asked& asked) {
      return asked.request == request && !asked.done && tick_ - asked.tick <= kTicksOfACommand;
    });
    if (found == asked_.end()) return false;
    found->done = true;
    return true;
  }

  void CheckStep(ControllerState before, ControllerState after) {
    Require(before == after || IsTransition(before, after), "the state goes a way that there is");
    const Request needed = NeededFor(before, after);
    Require(needed == Request::kNone || UseUp(needed),
            "and where an operator is needed, on a command of its own");
    const auto is_estop = [](const Asked& asked) { return asked.request == Request::kEstop; };
    Require(node_.cause() != Cause::kEstop || std::any_of(asked_.begin(), asked_.end(), is_estop),
            "an e-stop was an operator's");
    ticks_without_torque_ = GivesTorque(after) ? 0 : ticks_without_torque_ + 1;
    for (const double tau_Nm : bench_.Torque()) {
      Require(std::isfinite(tau_Nm), "torques are finite");
      Require(ticks_without_torque_ < kTicksToRest || tau_Nm == 0.0, "no torque in INIT, MONITOR and FAULT");
    }
    const JointVector& sent_Nm = node_.controller().status().tau_Nm;
    Require(GivesTorque(after) || sent_Nm.isZero(0.0), "and none is wanted");
  }

  int64_t tick_ = 0;
  LeaderPath leader_path_;
  ArmStart start_;
  EmulatedArm bench_;
  MessageBuffer buffer_{};
  ArmNode node_;
  Sealer leader_, operator_, stranger_;
  SealCheck estimates_;
  SealCheck replies_;
  FrameList to_drives_, to_board_;
  std::vector<Bytes> past_;
  std::vector<Asked> asked_;
  int64_t heard_ns_ = 0;
  int64_t commands_ = 0;
  int64_t leader_messages_ = 0;
  int ticks_without_torque_ = 0;
  bool leader_speaks_ = true;
  bool drives_heard_ = true;
};

}  // namespace
}  // namespace armada

/// A board from MONITOR to motion and back, with its operator and with strangers.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace armada;
  constexpr int kMostActions = 60;
  ByteSource choices({data, size});
  OperatedBoard board(KeyOf({data, size}));
  for (int i = 0; i < kMostActions && !choices.empty(); ++i) {
    board.Do(static_cast<OperatorAction>(choices.Byte() % static_cast<int>(OperatorAction::kCount)),
             &choices);
  }
  return 0;
}
