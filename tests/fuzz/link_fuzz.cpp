#include <cmath>
#include <iterator>
#include <vector>

#include "firmware/app/arm_node.h"
#include "firmware/app/config/fleet_file.h"
#include "firmware/app/initial_state.h"
#include "tests/fuzz/byte_source.h"
#include "tests/fuzz/input_key.h"
#include "tests/fuzz/link_actions.h"
#include "tests/fuzz/require.h"

namespace armada {
namespace {

constexpr int64_t kEpochNs = 1'000'000'000;
constexpr int64_t kPeriodNs = 10'000'000;
constexpr FleetKey kStrangersKey = {2};
constexpr const char* kChannels[] = {"LEADER", "EST_1", "EST_2", "TEL_1", "CMD"};

const FleetConfig& Fleet() {
  static const FleetConfig fleet = [] {
    std::vector<ConfigError> errors;
    const auto loaded = LoadFleet(ARMADA_FUZZ_FLEET, {"graph=[{pins=[1,2],edges=[{from=1,to=2}]}]"}, &errors);
    Require(loaded.has_value(), "the fuzzer's fleet is read");
    return *loaded;
  }();
  return fleet;
}

/// A message as it was on the wire.
struct Sent {
  std::string_view channel;
  std::vector<uint8_t> bytes;
};

/// A board that hears the leader and another arm, and a network on which anyone may speak. What is not sealed
/// by its sender, or was there before, changes nothing; whatever genuine senders say, the board's own
/// estimate stays a number.
class LinkWorld {
 public:
  explicit LinkWorld(const FleetKey& key)
      : key_(key),
        node_(Fleet(), Listener(), NominalInitialState(Fleet().arms[Listener()]), kEpochNs,
              {StartMode::kMonitor, 0, LinkIdentity{key, 1}}),
        leader_({key, 1}, kLeaderSender),
        arm_({key, 1}, kOther),
        stranger_({kStrangersKey, 9}, kLeaderSender) {}

  void Do(LinkAction action, ByteSource* choices) {
    switch (action) {
      case LinkAction::kTick:
        return Tick();
      case LinkAction::kLeader:
        return SpeakAsLeader(choices->Signed16());
      case LinkAction::kArm: {
        const int move = choices->Signed16();
        return SpeakAsArm(move, choices->Byte());
      }
      case LinkAction::kRepeat:
        if (const Sent* sent = Earlier(choices)) Deliver(*sent, false);
        return;
      case LinkAction::kDamage:
        return Damage(choices);
      case LinkAction::kNoSeal:
        if (const Sent* sent = Earlier(choices)) {
          Deliver(
              {sent->channel, {sent->bytes.begin(), sent->bytes.end() - static_cast<ptrdiff_t>(kSealSize)}},
              false);
        }
        return;
      case LinkAction::kForeign:
        return SpeakAsStranger();
      case LinkAction::kJunk:
        return Junk(choices);
      case LinkAction::kRestart:
        leader_ = Sealer({key_, ++leader_epoch_}, kLeaderSender);
        leader_sequence_ = 0;
        leader_clock_ns_ = now_ns_ - kEpochNs;
        return;
      case LinkAction::kCount:
        break;
    }
  }

 private:
  static constexpr int kOther = 1;
  static size_t Listener() { return 1; }  // arm 2

  template <class Message>
  void Speak(Message message, std::string_view channel, int move, Sealer* sealer) {
    x_m_ += 1e-3 * move;
    message.task_dim = PlanarArm::kTaskDim;
    message.x_m[0] = x_m_;
    const auto sealed = sealer->Seal(channel, Encode(message, &buffer_), &buffer_);
    past_.push_back({channel, {sealed.begin(), sealed.end()}});
    Deliver(past_.back(), true);
  }
  void SpeakAsLeader(int move) {
    leader_t message{};
    message.stamp_ns = now_ns_ - leader_clock_ns_;
    message.sequence = ++leader_sequence_;
    Speak(message, kChannels[0], move, &leader_);
  }
  void SpeakAsArm(int move, uint8_t agreement) {
    estimate_t message{};
    message.stamp_ns = now_ns_;
    message.sequence = ++arm_sequence_;
    message.arm_id = kOther;
    message.agreement = agreement;
    Speak(message, kChannels[1], move, &arm_);
  }
  void SpeakAsStranger() {
    leader_t message{};
    message.stamp_ns = now_ns_;
    message.sequence = leader_sequence_ + 1;
    message.task_dim = PlanarArm::kTaskDim;
    const auto sealed = stranger_.Seal(kChannels[0], Encode(message, &buffer_), &buffer_);
    Deliver({kChannels[0], {sealed.begin(), sealed.end()}}, false);
  }
  const Sent* Earlier(ByteSource* choices) const {
    const uint8_t choice = choices->Byte();
    return past_.empty() ? nullptr : &past_[choice % past_.size()];
  }
  void Damage(ByteSource* choices) {
    const Sent* sent = Earlier(choices);
    if (sent == nullptr) return;
    Sent damaged = *sent;
    const size_t bit = choices->Unsigned(2) % (8 * damaged.bytes.size());
    damaged.bytes[bit / 8] ^= static_cast<uint8_t>(1 << bit % 8);
    Deliver(damaged, false);
  }
  void Junk(ByteSource* choices) {
    Sent junk{kChannels[choices->Byte() % std::size(kChannels)], {}};
    junk.bytes.resize(choices->Byte());
    choices->Take(junk.bytes);
    Deliver(junk, false);
  }

  /// Only what is genuine may be taken; what is genuine may be refused for other reasons.
  void Deliver(const Sent& sent, bool genuine) {
    const RejectedMessages before = node_.rejected_messages();
    node_.OnMessage({sent.channel, sent.bytes, now_ns_});
    const RejectedMessages& after = node_.rejected_messages();
    const bool heard = sent.channel == kChannels[0] || sent.channel == kChannels[1];
    const int64_t by_seal = after.forged + after.replayed - before.forged - before.replayed;
    Require(by_seal == (heard && !genuine ? 1 : 0), "the seal refuses what is not genuine, and nothing else");
    Require(genuine || after.total() - before.total() == by_seal, "and what it refuses goes no further");
  }

  void Tick() {
    node_.EncodeEstimate(now_ns_, &buffer_);
    FrameList frames;
    node_.RequestSamples(now_ns_, &frames);
    frames.Clear();
    node_.Step(now_ns_, &frames);
    Require(!GivesTorque(node_.state()), "without drives there is no torque");
    now_ns_ += kPeriodNs;
    std::span<const uint8_t> sealed = node_.EncodeEstimate(now_ns_, &buffer_);
    estimate_t estimate;
    Require(check_.Open("EST_2", &sealed) == SealVerdict::kGenuine && Decode(sealed, &estimate),
            "its own estimate is valid and sealed");
  }

  FleetKey key_;
  int64_t now_ns_ = kEpochNs;
  int64_t leader_clock_ns_ = 0;
  uint64_t leader_epoch_ = 1;
  int64_t leader_sequence_ = 0;
  int64_t arm_sequence_ = 0;
  double x_m_ = 0.0;
  MessageBuffer buffer_{};
  ArmNode node_;
  Sealer leader_, arm_, stranger_;
  SealCheck check_{key_, 2};
  std::vector<Sent> past_;
};

}  // namespace
}  // namespace armada

/// A board's link, with genuine senders and strangers on it.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace armada;
  ByteSource choices({data, size});
  LinkWorld world(KeyOf({data, size}));
  while (!choices.empty()) {
    world.Do(static_cast<LinkAction>(choices.Byte() % static_cast<int>(LinkAction::kCount)), &choices);
  }
  return 0;
}
