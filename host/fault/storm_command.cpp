#include "host/fault/storm_command.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "firmware/app/command_line.h"
#include "firmware/app/config/fleet_file.h"
#include "firmware/app/exit_codes.h"
#include "firmware/app/realtime.h"
#include "host/fault/stranger.h"

namespace armada {
namespace {

constexpr int64_t kStepNs = 1'000'000;

struct Options {
  std::string fleet;
  std::string url = LcmLinkConfig().lcm_url;
  std::vector<std::string> kinds;  // empty: all
  double rate_1_s = 10'000.0;
  double seconds = 10.0;
  double wait_s = 0.0;
  uint64_t seed = 1;
  std::string json;
};

int Fail(const std::string& message) {
  std::cerr << "armada storm: " << message << '\n';
  return kExitFailed;
}

std::vector<std::string> AllNames() {
  std::vector<std::string> names;
  for (int kind = 0; kind < kJunkKinds; ++kind) names.emplace_back(NameOf(static_cast<JunkKind>(kind)));
  return names;
}

std::vector<JunkKind> KindsOf(const std::vector<std::string>& names) {
  std::vector<JunkKind> kinds;
  for (int i = 0; i < kJunkKinds; ++i) {
    const auto kind = static_cast<JunkKind>(i);
    if (names.empty() || std::find(names.begin(), names.end(), NameOf(kind)) != names.end())
      kinds.push_back(kind);
  }
  return kinds;
}

/// False when nobody was heard in that time.
bool WaitForTheFleet(double wait_s, Stranger* stranger) {
  const int64_t begin_ns = MonotonicNow();
  const int64_t end_ns = begin_ns + static_cast<int64_t>(wait_s * 1e9);
  for (int64_t now_ns = begin_ns; now_ns < end_ns && !stranger->has_heard_a_board(); now_ns += kStepNs) {
    SleepUntil(now_ns);
    stranger->Listen();
  }
  return stranger->has_heard_a_board();
}

/// The kinds in turn, as many each millisecond as the rate asks for.
void Send(const Options& options, const std::vector<JunkKind>& kinds, Stranger* stranger) {
  const int64_t begin_ns = MonotonicNow();
  const auto steps = static_cast<int64_t>(options.seconds * 1e9) / kStepNs;
  size_t next = 0;
  for (int64_t step = 1; step <= steps; ++step) {
    SleepUntil(begin_ns + step * kStepNs);
    stranger->Listen();
    const auto due = static_cast<size_t>(options.rate_1_s * 1e-9 * static_cast<double>(step * kStepNs));
    for (; next < due; ++next) stranger->Send(kinds[next % kinds.size()]);
  }
}

bool Report(const Stranger& stranger, const std::string& json_file) {
  nlohmann::ordered_json json;
  int64_t total = 0;
  for (const JunkKind kind : KindsOf({})) {
    if (stranger.sent(kind) == 0) continue;
    total += stranger.sent(kind);
    std::printf("%-14s %8lld\n", NameOf(kind), static_cast<long long>(stranger.sent(kind)));
    json["sent"][NameOf(kind)] = stranger.sent(kind);
  }
  std::printf("%-14s %8lld\n", "all", static_cast<long long>(total));
  if (json_file.empty()) return true;
  json["channels"] = stranger.sent_on();
  std::ofstream file(json_file);
  file << json.dump(2) << '\n';
  return static_cast<bool>(file.flush());
}

int Storm(const Options& options) {
  std::string url_text = options.url;
  if (!options.fleet.empty()) {
    std::vector<ConfigError> errors;
    const auto fleet = LoadFleet(options.fleet, {}, &errors);
    if (!fleet) {
      PrintErrors(errors, std::cerr);
      return kExitBadConfig;
    }
    url_text = fleet->link.lcm_url;
  }
  std::string error;
  const auto url = ParseLcmUrl(url_text, &error);
  if (!url) return Fail(error);
  auto socket = GroupSocket::Open(*url, &error);
  if (!socket) return Fail(error);
  Stranger stranger(std::move(*socket), options.seed);
  if (options.wait_s > 0.0 && !WaitForTheFleet(options.wait_s, &stranger))
    return Fail("no board is heard on " + url_text);
  Send(options, KindsOf(options.kinds), &stranger);
  return Report(stranger, options.json) ? kExitOk : Fail("cannot write " + options.json);
}

}  // namespace

void AddStormCommand(Command* app, int* code) {
  auto options = std::make_shared<Options>();
  Command* command = app->add_subcommand(
      "storm", "a stranger on a fleet's network: junk, fragments, replayed and forged messages. For tests");
  auto* fleet = command->add_option("--fleet", options->fleet, "fleet file: its link.lcm_url");
  command->add_option("--url", options->url, "this LCM url")->capture_default_str()->excludes(fleet);
  command->add_option("--rate", options->rate_1_s, "datagrams a second")
      ->range(1.0, 1e6)
      ->capture_default_str();
  command->add_option("--seconds", options->seconds, "how long")->range(1e-3, 1e6)->capture_default_str();
  command
      ->add_option("--wait", options->wait_s,
                   "seconds to wait for a board's first message before it begins; 0: no")
      ->capture_default_str();
  command->add_option("--kind", options->kinds, "only this kind; may be repeated; default: all in turn")
      ->allow_extra_args(false)
      ->one_of(AllNames());
  command->add_option("--seed", options->seed, "seed of the junk")->capture_default_str();
  command->add_option("--json", options->json, "write what was sent here, by kind and by channel");
  command->callback([=] { *code = Storm(*options); });
}

}  // namespace armada
