#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "firmware/can/damiao_messages.h"
#include "firmware/can/moteus_messages.h"
#include "firmware/can/udp_frame_codec.h"
#include "firmware/link/lcm_packet.h"
#include "firmware/link/messages.h"
#include "tests/fuzz/drive_world.h"
#include "tests/fuzz/edited_text.h"
#include "tests/fuzz/link_actions.h"
#include "tests/fuzz/operator_actions.h"

namespace armada {
namespace {

using Bytes = std::vector<uint8_t>;

constexpr uint8_t kOptions[] = {0x00, 0xFF, 0x2B};

constexpr std::pair<const char*, DriveProfile> kProfiles[] = {
    {"odrive_cansimple", DriveProfile::kODriveCanSimple},
    {"odrive_cansimple_v05", DriveProfile::kODriveCanSimpleV05},
    {"mini_cheetah", DriveProfile::kMiniCheetah},
    {"cubemars", DriveProfile::kCubeMars},
    {"damiao", DriveProfile::kDamiao},
    {"cia402", DriveProfile::kCia402},
    {"moteus", DriveProfile::kMoteus},
};

/// Writes seeds into one folder a fuzzer, as far as they can be written.
class Corpus {
 public:
  Corpus(const std::filesystem::path& root, const std::string& fuzzer) : folder_(root / fuzzer) {
    std::filesystem::create_directories(folder_);
  }

  void Add(std::span<const uint8_t> seed) {
    std::ofstream file(folder_ / ("seed_" + std::to_string(count_++)), std::ios::binary);
    file.exceptions(std::ios::failbit | std::ios::badbit);
    file.write(reinterpret_cast<const char*>(seed.data()), static_cast<std::streamsize>(seed.size()));
  }

 private:
  std::filesystem::path folder_;
  int count_ = 0;
};

uint8_t Code(DriveAction action) {
  return static_cast<uint8_t>(action);
}

/// The frame as an action; nothing when it is none of the joint's messages.
void AppendMessage(const std::vector<CanMessage>& messages, const CanFrame& frame, Bytes* seed) {
  for (size_t i = 0; i < messages.size(); ++i) {
    if (messages[i].id != frame.id || messages[i].extended != frame.extended) continue;
    seed->insert(seed->end(), {Code(DriveAction::kMessage), static_cast<uint8_t>(i), frame.length});
    seed->insert(seed->end(), frame.data.begin(), frame.data.begin() + frame.length);
    return;
  }
}

/// What master and drive do in a bring-up, in torque mode, and on the ways out of it; and the frames of such
/// a conversation for a master that has no drive to talk to.
void AddDriveSeeds(DriveProfile profile, uint8_t options, Corpus* corpus) {
  constexpr uint8_t kTorques[] = {64, 80, 48, 127, 0};
  Bytes in_torque = {options, Code(DriveAction::kRecover)};
  for (const uint8_t torque : kTorques) {
    in_torque.insert(in_torque.end(), {Code(DriveAction::kTorque), torque});
  }
  corpus->Add(in_torque);
  using enum DriveAction;
  for (const DriveAction way_out : {kQuickStop, kDisable, kPowerCycle}) {
    Bytes seed = in_torque;
    seed.insert(seed.end(), {Code(way_out), Code(kBringUp), 8, Code(kTorque), 80, Code(kPowerCycle)});
    corpus->Add(seed);
  }
  Bytes silence = in_torque;
  silence.insert(silence.end(), {Code(kTime), 255, Code(kTorque), 80, Code(kBringUp), 15, Code(kRecover)});
  corpus->Add(silence);

  DriveWorld world(SetupOf(profile, options));
  world.Recover();
  for (int tick = 0; tick < 5; ++tick) world.TorqueTick(1.0);
  Bytes heard = {options};
  for (const CanFrame& frame : world.from_drive()) {
    AppendMessage(world.messages(), frame, &heard);
    heard.insert(heard.end(), {Code(kBringUp), 0});
  }
  corpus->Add(heard);
}

/// What was found once: a range that makes every code overflow, a mode that is no number.
void AddFindings(DriveProfile profile, Corpus* corpus) {
  const JointDriveConfig joint = SetupOf(profile, 0).joint;
  Bytes seed = {0};
  if (profile == DriveProfile::kDamiao) {
    const damiao::RegisterAccess smallest_range = {damiao::Access::kWrite, damiao::Register::kPositionMax, 1};
    AppendMessage(MessagesOf(joint), damiao::EncodeRequest(joint, smallest_range), &seed);
  } else if (profile == DriveProfile::kMoteus) {
    CanFrame frame = moteus::EncodeStop(joint);
    constexpr uint8_t kModeAsNaN[] = {0x0D, 0x00, 0x00, 0x00, 0xC0, 0x7F, moteus::kNop, moteus::kNop};
    frame.length = sizeof kModeAsNaN;
    std::copy(std::begin(kModeAsNaN), std::end(kModeAsNaN), frame.data.begin());
    AppendMessage(MessagesOf(joint), frame, &seed);
  } else {
    return;
  }
  seed.insert(seed.end(), {Code(DriveAction::kMove), 1, 0, 1, 0, Code(DriveAction::kBringUp), 0});
  corpus->Add(seed);
}

void AddDatagrams(DriveProfile profile, Corpus* corpus) {
  DriveWorld world(SetupOf(profile, 0));
  world.Recover();
  for (const CanFrame& frame : world.from_drive()) {
    UdpFrameBuffer buffer;
    corpus->Add(std::span(buffer).first(EncodeUdpFrame(frame, 1.5e9, &buffer)));
  }
}

template <class Message>
Message Zero() {
  Message message{};
  message.stamp_ns = 1;
  message.sequence = 1;
  message.task_dim = 2;
  return message;
}

void AddLcmSeeds(const std::filesystem::path& root) {
  Corpus packets(root, "lcm_packet");
  Corpus messages(root, "lcm_messages");
  const auto add = [&](const char* channel, const auto& message) {
    MessageBuffer payload;
    const std::span<const uint8_t> encoded = Encode(message, &payload);
    messages.Add(encoded);
    std::array<uint8_t, 2048> datagram;
    packets.Add(std::span(datagram).first(WriteLcmPacket(7, {channel, encoded}, datagram)));
  };
  add("LEADER", Zero<leader_t>());
  auto estimate = Zero<estimate_t>();
  estimate.arm_id = 1;
  add("EST_1", estimate);
  auto telemetry = Zero<telemetry_t>();
  telemetry.arm_id = 1;
  telemetry.dof = 3;
  add("TEL_1", telemetry);
  command_t command{};
  command.sequence = 1;
  command.request = 1;
  add("CMD", command);
  reply_t reply{};
  reply.sequence = 1;
  reply.arm_id = 1;
  reply.request = 1;
  add("ACK_1", reply);
}

uint8_t Code(LinkAction action) {
  return static_cast<uint8_t>(action);
}

/// A leader and an arm that speak for ten ticks; and between them each thing that is refused.
void AddLinkSeeds(const std::filesystem::path& root) {
  Corpus corpus(root, "link");
  using enum LinkAction;
  for (const Bytes& refused : {Bytes{},
                               {Code(kRepeat), 1},
                               {Code(kDamage), 1, 9, 0},
                               {Code(kNoSeal), 1},
                               {Code(kForeign)},
                               {Code(kJunk), 0, 4, 1, 2, 3, 4},
                               {Code(kRestart)}}) {
    Bytes seed;
    for (int tick = 0; tick < 10; ++tick) {
      seed.insert(seed.end(), {Code(kLeader), 20, 0, Code(kArm), 0, 0, static_cast<uint8_t>(tick)});
      seed.insert(seed.end(), refused.begin(), refused.end());
      seed.push_back(Code(kTick));
    }
    corpus.Add(seed);
  }
}

uint8_t Code(OperatorAction action) {
  return static_cast<uint8_t>(action);
}

/// A board that is armed, started, held, started again and stopped; and between that each thing that is
/// refused.
void AddOperatorSeeds(const std::filesystem::path& root) {
  Corpus corpus(root, "operator");
  using enum OperatorAction;
  constexpr uint8_t kArm = 0, kStart = 1, kHold = 2, kReset = 3, kEstop = 4;
  constexpr uint8_t kLong = 31;
  for (const Bytes& refused : {Bytes{},
                               {Code(kWrong), 2, 1, 0, 0, 1},
                               {Code(kRepeat), 0},
                               {Code(kDamage), 0, 9, 0},
                               {Code(kForeign), kEstop},
                               {Code(kNoSeal), kEstop},
                               {Code(kLeader)},
                               {Code(kDrives)}}) {
    Bytes seed = {Code(kTicks), kLong};
    for (const uint8_t request : {kArm, kStart, kHold, kStart, kEstop, kReset, kArm}) {
      seed.insert(seed.end(), {Code(kCommand), request});
      seed.insert(seed.end(), refused.begin(), refused.end());
      seed.insert(seed.end(), {Code(kTicks), kLong});
    }
    corpus.Add(seed);
  }
}

/// Three messages, each followed by one thing of every kind.
void AddSealSeed(const std::filesystem::path& root) {
  Bytes seed;
  for (uint8_t message = 0; message < 3; ++message) {
    seed.insert(seed.end(),
                {0, message, 0, 4, 1, 2, 3, 4, 1, 2, 0, 3, 5, 0, 1, 4, 1, 0, 5, 1, 6, 0, 2, 8, 9});
  }
  Corpus(root, "seal").Add(seed);
}

/// Each file as it is, and the first two with one edit of each kind.
void AddTextSeeds(const std::filesystem::path& root, const std::string& fuzzer, int files) {
  Corpus corpus(root, fuzzer);
  for (int file = 0; file < files; ++file) {
    const auto which = static_cast<uint8_t>(file);
    corpus.Add(Bytes{which});
    for (uint8_t edit = 0; file < 2 && edit < static_cast<uint8_t>(TextEdit::kCount); ++edit)
      corpus.Add(Bytes{which, edit, static_cast<uint8_t>(17 * (file + 1)), 0, 3, 0, 5, 0, 0, 0, 0, 0});
  }
}

}  // namespace
}  // namespace armada

int main(int argc, char** argv) {
  using namespace armada;
  if (argc != 2) {
    std::fprintf(stderr, "usage: fuzz_corpus FOLDER, for one folder of seeds a fuzzer\n");
    return 2;
  }
  const std::filesystem::path root = argv[1];
  Corpus datagrams(root, "udp_frame");
  for (const auto& [name, profile] : kProfiles) {
    Corpus corpus(root, name);
    for (const uint8_t options : kOptions) AddDriveSeeds(profile, options, &corpus);
    AddFindings(profile, &corpus);
    AddDatagrams(profile, &datagrams);
  }
  AddLcmSeeds(root);
  AddLinkSeeds(root);
  AddOperatorSeeds(root);
  AddSealSeed(root);
  AddTextSeeds(root, "fleet", 2);
  AddTextSeeds(root, "scenario", 60);
  return 0;
}
