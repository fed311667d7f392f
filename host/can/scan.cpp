#include "host/can/scan.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <utility>

#include "firmware/can/canopen_messages.h"
#include "firmware/can/canopen_sdo.h"
#include "firmware/can/cia402_objects.h"
#include "firmware/can/damiao_messages.h"
#include "firmware/can/moteus_messages.h"
#include "firmware/can/odrive_messages.h"

namespace armada {
namespace {

constexpr int64_t kPace_ns = 2'000'000;     ///< between questions: a bus of 125 kbit/s carries them
constexpr int64_t kAnswer_ns = 50'000'000;  ///< after the last of a kind
constexpr int kCanopenNodes = 127;

constexpr canopen::Entry kDeviceName{0x1008, 0};
constexpr canopen::Entry kSoftwareVersion{0x100A, 0};
constexpr canopen::Entry kVendor{0x1018, 1};
constexpr canopen::Entry kRevision{0x1018, 3};
constexpr uint32_t kCia402 = 402;  ///< low half of object 1000h

/// Of an ODrive whose heartbeats do not tell.
constexpr char kEitherFirmware[] = "0.5 or 0.6";

/// Not among those that the master uses; Damiao's DM_CAN.
constexpr auto kDamiaoSoftware = static_cast<damiao::Register>(14);

std::string Text(const char* format, unsigned value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

bool IsODriveHeartbeat(const CanFrame& frame) {
  constexpr uint8_t kLastState = 14;
  odrive::Command command{};
  const int node = static_cast<int>(frame.id >> 5);
  return odrive::IsForNode(frame, node, &command) && command == odrive::Command::kHeartbeat &&
         !frame.remote && frame.length == 8 && frame.data[4] <= kLastState && frame.data[6] <= 1 &&
         (frame.data[7] & 0x7E) == 0;
}

/// What drives send by themselves while nobody commands them.
bool IsSpontaneous(const CanFrame& frame, const std::map<int, odrive::Heartbeat>& odrives) {
  const auto node = static_cast<int>(frame.id & canopen::kNodeMask);
  canopen::NmtState state{};
  canopen::Emergency emergency;
  if (canopen::DecodeHeartbeat(frame, node, &state) && node > 0) return true;
  if (canopen::DecodeEmergency(frame, node, &emergency) && node > 0) return true;
  // Cyclic messages of an ODrive: estimates, counts, currents, temperatures, voltage, torques, powers.
  constexpr std::array<uint32_t, 10> kCyclic = {0x01, 0x03, 0x09, 0x0A, 0x14, 0x15, 0x17, 0x1B, 0x1C, 0x1D};
  const bool cyclic = std::find(kCyclic.begin(), kCyclic.end(), frame.id & 0x1F) != kCyclic.end();
  return canopen::IsPlain(frame) && cyclic && odrives.contains(static_cast<int>(frame.id >> 5));
}

class Scanner {
 public:
  Scanner(CanBus* bus, const ScanOptions& options, int64_t now_ns)
      : bus_(bus), options_(options), now_ns_(now_ns) {}

  ScanResult Run() {
    std::vector<CanFrame> heard;
    Hear(static_cast<int64_t>(options_.listen_s * 1e9),
         [&](const CanFrame& frame) { heard.push_back(frame); });
    TakeHeard(heard);
    if (MayAsk(heard)) Ask();
    for (auto& [key, drive] : found_) result_.drives.push_back(std::move(drive));
    return std::move(result_);
  }

 private:
  using Handler = std::function<void(const CanFrame&)>;

  /// Time is counted, not read: a bus of an emulation may have a clock of its own.
  void Hear(int64_t for_ns, const Handler& handle) {
    now_ns_ += for_ns;
    CanFrame frame;
    while (result_.status == BusStatus::kOk) {
      const BusStatus status = bus_->Receive(now_ns_, &frame);
      if (status == BusStatus::kTimeout) return;
      if (status == BusStatus::kOk) {
        handle(frame);
      } else if (status == BusStatus::kBusOff || status == BusStatus::kDown) {
        result_.status = status;
      }
    }
  }

  void Question(const CanFrame& frame, const Handler& handle) {
    if (result_.status != BusStatus::kOk) return;
    if (const BusStatus status = bus_->Send(frame);
        status == BusStatus::kBusOff || status == BusStatus::kDown) {
      result_.status = status;
    }
    Hear(kPace_ns, handle);
  }

  FoundDrive& Found(const char* profile, int node) {
    FoundDrive& drive = found_[{profile, node}];
    drive.profile = profile;
    drive.node_id = node;
    return drive;
  }

  void TakeHeard(const std::vector<CanFrame>& heard) {
    result_.heard = heard.size();
    for (const CanFrame& frame : heard) {
      if (IsODriveHeartbeat(frame)) {
        const auto node = static_cast<int>(frame.id >> 5);
        const bool is_v05 = (frame.data[7] & 0x80) != 0;  // "trajectory done", which 0.6 has elsewhere
        odrive::Heartbeat heartbeat;
        if (odrive::DecodeHeartbeat(frame, node, odrive::Firmware::kV06, &heartbeat)) {
          odrives_[node] = heartbeat;
          odrive_is_v05_[node] = is_v05;
        }
      }
      const auto node = static_cast<int>(frame.id & canopen::kNodeMask);
      canopen::NmtState state{};
      if (node > 0 && canopen::DecodeHeartbeat(frame, node, &state)) canopen_states_[node] = state;
    }
    for (const auto& [node, heartbeat] : odrives_) {
      FoundDrive& drive = Found(odrive_is_v05_[node] ? "odrive_cansimple_v05" : "odrive_cansimple", node);
      drive.firmware = odrive_is_v05_[node] ? "0.5" : kEitherFirmware;
      drive.state = (heartbeat.state == odrive::AxisState::kClosedLoop
                         ? "closed loop"
                         : "axis state " + std::to_string(static_cast<int>(heartbeat.state))) +
                    Text(", error %Xh", heartbeat.error);
    }
    for (const auto& [node, state] : canopen_states_) {
      Found("canopen", node).state = Text("NMT state %u", static_cast<unsigned>(state));
    }
  }

  bool MayAsk(const std::vector<CanFrame>& heard) {
    for (const auto& [node, heartbeat] : odrives_) {
      if (heartbeat.state != odrive::AxisState::kClosedLoop) continue;
      result_.notes.push_back("ODrive " + std::to_string(node) + " is armed: nothing was asked");
      return false;
    }
    const auto other = std::find_if(heard.begin(), heard.end(), [&](const CanFrame& frame) {
      return !frame.error && !IsSpontaneous(frame, odrives_);
    });
    if (other == heard.end()) return true;
    result_.notes.push_back(Text("the bus is in use (frame %Xh): nothing was asked", other->id));
    return false;
  }

  bool Wants(DriveProfile profile) const { return !options_.profile || *options_.profile == profile; }

  void Ask() {
    if (Wants(DriveProfile::kODriveCanSimple) || Wants(DriveProfile::kODriveCanSimpleV05)) AskODrives();
    if (Wants(DriveProfile::kCia402)) AskCanopen();
    if (Wants(DriveProfile::kDamiao)) AskDamiao();
    if (Wants(DriveProfile::kMoteus)) AskMoteus();
    if (Wants(DriveProfile::kMiniCheetah) || Wants(DriveProfile::kCubeMars)) {
      result_.notes.emplace_back("mini_cheetah and cubemars cannot be asked without commanding them");
    }
  }

  /// Only those that were heard: their identifiers may be commands to a drive of another family.
  void AskODrives() {
    const Handler take = [&](const CanFrame& frame) {
      odrive::Version version;
      const auto node = static_cast<int>(frame.id >> 5);
      if (!odrives_.contains(node) || !odrive::DecodeVersion(frame, node, &version)) return;
      const auto& [major, minor, revision] = version.firmware;
      Found("odrive_cansimple", node).firmware =
          std::to_string(major) + '.' + std::to_string(minor) + '.' + std::to_string(revision);
    };
    for (const auto& [node, heartbeat] : odrives_) {
      if (!odrive_is_v05_[node]) Question(odrive::EncodeVersionRequest(node), take);
    }
    if (!odrives_.empty()) Hear(kAnswer_ns, take);
    for (const auto& [node, heartbeat] : odrives_) {
      const auto entry = found_.find({"odrive_cansimple", node});
      if (entry == found_.end() || entry->second.firmware != kEitherFirmware) continue;
      FoundDrive drive = entry->second;  // 0.5 has no such message
      found_.erase(entry);
      drive.profile = "odrive_cansimple_v05";
      drive.firmware = "0.5 (does not tell)";
      found_[{drive.profile, node}] = drive;
    }
  }

  /// Identifiers 601h to 67Fh are those of ODrives 48 to 51: where one of these is, none is asked.
  void AskCanopen() {
    constexpr int kFirstODrive = 48;
    constexpr int kLastODrive = 51;
    if (const auto odrive = odrives_.lower_bound(kFirstODrive);
        odrive != odrives_.end() && odrive->first <= kLastODrive) {
      result_.notes.push_back("ODrive " + std::to_string(odrive->first) +
                              " has identifiers of CANopen requests: CANopen was not asked");
      return;
    }
    std::map<int, std::map<std::pair<uint16_t, uint8_t>, canopen::Sdo>> answers;
    const Handler take = [&](const CanFrame& frame) {
      const auto node = static_cast<int>(frame.id & canopen::kNodeMask);
      canopen::Sdo sdo;
      if (node == 0 || !canopen::DecodeSdoReply(frame, node, &sdo)) return;
      answers[node][{sdo.entry.index, sdo.entry.sub}] = sdo;
    };
    for (int node = 1; node <= kCanopenNodes; ++node) {
      Question(canopen::EncodeSdoUpload(node, cia402::kDeviceType), take);
    }
    Hear(kAnswer_ns, take);
    std::vector<int> nodes;
    for (const auto& [node, answer] : answers) {
      if (answer.contains({cia402::kDeviceType.index, cia402::kDeviceType.sub})) nodes.push_back(node);
    }
    for (const int node : nodes) {
      for (const canopen::Entry entry :
           {kVendor, kRevision, kSoftwareVersion, kDeviceName, cia402::kSupportedModes}) {
        Question(canopen::EncodeSdoUpload(node, entry), take);
        Hear(kAnswer_ns, take);
      }
      TakeCanopen(node, answers[node]);
    }
  }

  void TakeCanopen(int node, const std::map<std::pair<uint16_t, uint8_t>, canopen::Sdo>& answers) {
    const auto value = [&](canopen::Entry entry) -> std::optional<canopen::Sdo> {
      const auto at = answers.find({entry.index, entry.sub});
      if (at == answers.end() || at->second.kind != canopen::SdoKind::kUpload) return std::nullopt;
      return at->second;
    };
    const auto text = [&](canopen::Entry entry) {  // four letters fit one frame; longer ones are not fetched
      std::string letters;
      const auto sdo = value(entry);
      for (unsigned i = 0; sdo && i < sdo->bytes; ++i) letters += static_cast<char>(sdo->value >> (8 * i));
      return letters;
    };
    const auto type = value(cia402::kDeviceType);
    const bool is_402 = type && (type->value & 0xFFFF) == kCia402;
    const std::string heard = std::exchange(found_[{"canopen", node}].state, {});
    found_.erase({"canopen", node});
    FoundDrive& drive = Found(is_402 ? "cia402" : "canopen", node);
    drive.state = heard;
    const auto add = [&](const std::string& word) {
      drive.firmware += (drive.firmware.empty() ? "" : ", ") + word;
    };
    if (const std::string name = text(kDeviceName); !name.empty()) add(name);
    if (const std::string version = text(kSoftwareVersion); !version.empty()) add("software " + version);
    if (const auto vendor = value(kVendor)) add(Text("vendor %Xh", vendor->value));
    if (const auto revision = value(kRevision)) add(Text("revision %Xh", revision->value));
    if (!is_402) return add(Text("device profile %u", type ? type->value & 0xFFFF : 0));
    constexpr uint32_t kCyclicTorqueBit = 1u << 9;
    const auto modes = value(cia402::kSupportedModes);
    if (modes && (modes->value & kCyclicTorqueBit) == 0) add("no cyclic synchronous torque");
  }

  void AskDamiao() {
    const Handler take = [&](const CanFrame& frame) {
      for (int node = NodeIdsOf(DriveProfile::kDamiao).min; node <= NodeIdsOf(DriveProfile::kDamiao).max;
           ++node) {
        JointDriveConfig joint{.profile = DriveProfile::kDamiao, .node_id = node};
        joint.mit.master_id = static_cast<int>(frame.id);  // whichever the drive has
        damiao::RegisterAccess answer;
        if (frame.id == kDamiaoRequests || !damiao::DecodeAnswer(frame, joint, &answer)) continue;
        if (answer.reg == damiao::Register::kNodeId && answer.raw == static_cast<uint32_t>(node)) {
          Found("damiao", node).state = Text("answers on %Xh", frame.id);
        } else if (answer.reg == kDamiaoSoftware) {
          Found("damiao", node).firmware = std::to_string(answer.raw);
        }
      }
    };
    const NodeIdRange range = NodeIdsOf(DriveProfile::kDamiao);
    const auto read = [&](int node, damiao::Register reg) {
      const JointDriveConfig joint{.profile = DriveProfile::kDamiao, .node_id = node};
      Question(damiao::EncodeRequest(joint, {damiao::Access::kRead, reg, 0}), take);
    };
    for (int node = range.min; node <= range.max; ++node) read(node, damiao::Register::kNodeId);
    Hear(kAnswer_ns, take);
    for (int node = range.min; node <= range.max; ++node) {
      if (found_.contains({"damiao", node})) read(node, kDamiaoSoftware);
    }
    Hear(kAnswer_ns, take);
  }

  /// CAN FD frames are errors to a classic controller: they are sent only where the interface has CAN FD.
  void AskMoteus() {
    if (!options_.fd) {
      result_.notes.emplace_back("the interface has no CAN FD: moteus was not asked");
      return;
    }
    const Handler take = [&](const CanFrame& frame) {
      const JointDriveConfig joint{.profile = DriveProfile::kMoteus,
                                   .node_id = static_cast<int>(frame.id >> 8 & 0x7F)};
      moteus::Setup setup;
      if (joint.node_id == 0 || !frame.fd || !moteus::IsFromDrive(frame, joint)) return;
      FoundDrive& drive = Found("moteus", joint.node_id);
      if (!moteus::DecodeSetup(frame, &setup)) return;
      drive.firmware = "register map " + std::to_string(setup.register_map);
      drive.state = "mode " + std::to_string(static_cast<int>(setup.state.mode));
    };
    const NodeIdRange range = NodeIdsOf(DriveProfile::kMoteus);
    for (int node = range.min; node <= range.max; ++node) {
      Question(moteus::EncodeSetupQuery({.profile = DriveProfile::kMoteus, .node_id = node}), take);
    }
    Hear(kAnswer_ns, take);
  }

  static constexpr uint32_t kDamiaoRequests = 0x7FF;

  CanBus* bus_;
  ScanOptions options_;
  int64_t now_ns_;
  ScanResult result_;
  std::map<int, odrive::Heartbeat> odrives_;
  std::map<int, bool> odrive_is_v05_;
  std::map<int, canopen::NmtState> canopen_states_;
  std::map<std::pair<std::string, int>, FoundDrive> found_;
};

}  // namespace

ScanResult Scan(CanBus* bus, const ScanOptions& options, int64_t now_ns) {
  return Scanner(bus, options, now_ns).Run();
}

}  // namespace armada
