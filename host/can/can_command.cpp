#include "host/can/can_command.h"

#include <array>
#include <fstream>
#include <iostream>
#include <memory>

#include "firmware/app/command_line.h"
#include "firmware/app/config/fleet_file.h"
#include "firmware/app/exit_codes.h"
#include "firmware/app/realtime.h"
#include "firmware/can/open_bus.h"
#include "firmware/clock/machine_clock.h"
#include "host/can/bus_source.h"
#include "host/can/can_check.h"
#include "host/can/candump_reader.h"
#include "host/can/dbc.h"
#include "host/can/decode.h"
#include "host/can/eds.h"
#include "host/can/scan_output.h"

namespace armada {
namespace {

constexpr double kForever_s = 1e9;

int Fail(const std::string& text) {
  std::cerr << "armada: " << text << '\n';
  return kExitFailed;
}

void AddSource(Command* command, BusSource* source) {
  auto* fleet = command->add_option("--fleet", source->fleet, "fleet file: the tables of one of its arms");
  command->add_option("--arm", source->arm, "id of the arm; may be left out of a fleet of one")->needs(fleet);
  command->add_option("--set", source->sets, "key=value: any parameter of the fleet")->needs(fleet);
  command->add_option("--profile", source->profile, "drive profile, with default ranges and units")
      ->excludes(fleet);
}

bool IsGiven(const BusSource& source) {
  if (!source.fleet.empty() || !source.profile.empty()) return true;
  std::cerr << "armada: one of --fleet and --profile is required\n";
  return false;
}

int RunDbc(const BusSource& source) {
  if (!IsGiven(source)) return kExitUsage;
  std::string name = source.profile + ", default ranges";
  std::vector<JointDriveConfig> joints;
  if (source.fleet.empty()) {
    const auto profile = ParseProfile(source.profile);
    if (!profile) return kExitUsage;
    for (const int node : {1, 2}) joints.push_back({.profile = *profile, .node_id = node});
  } else {
    int code = kExitOk;
    const auto arm = FindArm(source, &code);
    if (!arm) return code;
    joints = arm->joints;
    name = "arm " + std::to_string(arm->id);
  }
  const Dbc dbc = MakeDbc(name, MessagesOfBus(joints));
  std::cout << dbc.text;
  if (dbc.dropped.empty()) return kExitOk;
  std::cerr << "armada: left out, a DBC file cannot tell them apart:";
  for (const std::string& message : dbc.dropped) std::cerr << ' ' << message;
  std::cerr << '\n';
  return kExitOk;
}

struct DecodeOptions {
  BusSource source;
  std::string file;
  std::string bus;
  double seconds = kForever_s;
};

std::optional<std::vector<BusMessage>> TablesOf(const BusSource& source, int* code) {
  *code = kExitUsage;
  if (!IsGiven(source)) return std::nullopt;
  if (!source.profile.empty()) {
    const auto profile = ParseProfile(source.profile);
    return profile ? std::optional(MessagesOfProfile(*profile)) : std::nullopt;
  }
  const auto arm = FindArm(source, code);
  return arm ? std::optional(MessagesOfBus(arm->joints)) : std::nullopt;
}

std::string TimeText(int64_t time_ns) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "(%lld.%06lld)", static_cast<long long>(time_ns / 1'000'000'000),
                static_cast<long long>(time_ns % 1'000'000'000 / 1000));
  return text.data();
}

int NotALine(const std::string& file, size_t number, const std::string& text) {
  std::cerr << "armada: " << file << ':' << number << ": '" << text
            << "' is no line of a candump log, such as (1.000000) can0 123#0102\n";
  return kExitFailed;
}

int DecodeLog(std::istream& in, const std::string& name, const std::vector<BusMessage>& messages) {
  size_t number = 0;
  for (std::string text; std::getline(in, text);) {
    ++number;
    if (text.empty()) continue;
    CandumpLine line;
    if (!ParseCandumpLine(text, &line)) {
      return NotALine(name, number, text);
    }
    std::cout << TimeText(line.time_ns) << ' ' << line.channel << "  " << Decode(messages, line.frame)
              << '\n';
  }
  return kExitOk;
}

int DecodeBus(const DecodeOptions& options, const std::vector<BusMessage>& messages) {
  std::string error;
  const auto bus = OpenBus(options.bus, OptionsAsFound(options.bus), MachineClock::Get(), &error);
  if (bus == nullptr) return Fail(error);
  const int64_t begin_ns = MonotonicNow();
  const int64_t end_ns = begin_ns + static_cast<int64_t>(options.seconds * 1e9);
  for (;;) {
    CanFrame frame;
    const char* event = nullptr;
    switch (bus->Receive(end_ns, &frame)) {
      case BusStatus::kOk:
        std::cout << TimeText(frame.stamp_ns - begin_ns) << "  " << Decode(messages, frame) << std::endl;
        break;
      case BusStatus::kTimeout:
        return kExitOk;
      case BusStatus::kErrorPassive:
        event = "error frame: error passive";
        break;
      case BusStatus::kErrorActive:
        event = "error frame: no longer error passive";
        break;
      case BusStatus::kRestarted:
        event = "error frame: restarted";
        break;
      case BusStatus::kBusOff:
        event = "error frame: bus off";
        break;
      case BusStatus::kQueueFull:
      case BusStatus::kDown:
        return Fail("bus " + options.bus + " went down");
    }
    if (event != nullptr) std::cout << TimeText(MonotonicNow() - begin_ns) << "  " << event << std::endl;
  }
}

int RunDecode(const DecodeOptions& options) {
  int code = kExitOk;
  const auto messages = TablesOf(options.source, &code);
  if (!messages) return code;
  std::cout << "# values as on the wire: motor side\n";
  if (!options.bus.empty()) return DecodeBus(options, *messages);
  if (options.file == "-") return DecodeLog(std::cin, "standard input", *messages);
  std::ifstream file(options.file);
  if (!file) return Fail("cannot read " + options.file);
  return DecodeLog(file, options.file, *messages);
}

struct ScanCommand {
  std::string bus;
  std::string profile;
  double seconds = 1.0;
  bool json = false;
};

int RunScan(const ScanCommand& command) {
  ScanOptions options;
  options.listen_s = command.seconds;
  if (!command.profile.empty()) {
    options.profile = ParseProfile(command.profile);
    if (!options.profile) return kExitUsage;
  }
  const BusOptions as_found = OptionsAsFound(command.bus);
  options.fd = as_found.fd;
  std::string error;
  const auto bus = OpenBus(command.bus, as_found, MachineClock::Get(), &error);
  if (bus == nullptr) return Fail(error);
  const ScanResult result = Scan(bus.get(), options, MonotonicNow());
  command.json ? PrintJson(result, std::cout) : PrintText(result, std::cout);
  if (result.status != BusStatus::kOk) return Fail("bus " + command.bus + " went down or off");
  return kExitOk;
}

struct CheckCommand {
  std::string fleet;
  std::vector<std::string> sets;
  bool json = false;
};

int RunCanCheck(const CheckCommand& command) {
  std::vector<ConfigError> errors;
  const auto fleet = LoadFleet(command.fleet, command.sets, &errors);
  if (!fleet) {
    PrintErrors(errors, std::cerr);
    return kExitBadConfig;
  }
  const CanCheckResult result = CheckCan(*fleet);
  command.json ? PrintJson(result, std::cout) : PrintText(result, std::cout);
  return result.ok() ? kExitOk : kExitFailed;
}

}  // namespace

void AddCanCommand(Command* app, int* code) {
  Command* can = app->add_subcommand("can", "tools for the arms' CAN buses");
  can->require_subcommand(1);

  // Options live as long as the callbacks that read them.
  const auto dbc = std::make_shared<BusSource>();
  Command* command = can->add_subcommand("dbc", "print a bus as a DBC file, out of the codecs' tables");
  AddSource(command, dbc.get());
  command->callback([=] { *code = RunDbc(*dbc); });

  can->add_subcommand("eds", "print the EDS file of a CiA 402 drive, out of the codec's table")
      ->callback([=] {
        std::cout << Eds({});
        *code = kExitOk;
      });

  const auto decode = std::make_shared<DecodeOptions>();
  command = can->add_subcommand("decode", "print a candump log or a bus in physical units");
  auto* input = command->add_option_group("input");
  input->add_option("FILE", decode->file, "candump log; -: standard input");
  input->add_option("--bus", decode->bus, "listen to udp:<group>:<port> or socketcan:<interface>");
  input->require_option(1);
  AddSource(command, &decode->source);
  command->add_option("--seconds", decode->seconds, "listen this long; default: until Ctrl-C")->positive();
  command->callback([=] { *code = RunDecode(*decode); });

  const auto scan = std::make_shared<ScanCommand>();
  command = can->add_subcommand("scan", "find the drives of a bus; it listens, then asks, never commands");
  command->add_option("BUS", scan->bus, "udp:<group>:<port> or socketcan:<interface>")->required();
  command->add_option("--seconds", scan->seconds, "listen this long before asking")
      ->range(0.2, 3600.0)
      ->capture_default_str();
  command->add_option("--profile", scan->profile, "ask drives of this profile only");
  command->add_flag("--json", scan->json, "print JSON");
  command->callback([=] { *code = RunScan(*scan); });

  const auto check = std::make_shared<CheckCommand>();
  command = can->add_subcommand("check", "judge the buses of a fleet: load, watchdogs, interfaces");
  command->add_option("FLEET", check->fleet, "fleet file")->required();
  command->add_option("--set", check->sets, "key=value: any parameter of the fleet")->take_all();
  command->add_flag("--json", check->json, "print JSON");
  command->callback([=] { *code = RunCanCheck(*check); });
}

}  // namespace armada
