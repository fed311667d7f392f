#include "host/ctl/ctl_command.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "firmware/app/command_line.h"
#include "firmware/app/config/fleet_file.h"
#include "firmware/app/exit_codes.h"
#include "firmware/clock/machine_clock.h"
#include "firmware/link/fleet_key.h"
#include "host/ctl/operator_call.h"

namespace armada {
namespace {

struct Options {
  std::string fleet;
  std::vector<int> arms;  // empty: all
  double timeout_s = 5.0;
};

std::string DefaultFleet() {
  const char* name = std::getenv("ARMADA_FLEET");
  return name != nullptr && *name != '\0' ? name : "/etc/armada/fleet.toml";
}

int Fail(const std::string& message, int code = kExitFailed) {
  std::cerr << "armada ctl: " << message << '\n';
  return code;
}

int Call(const Options& options, Request request) {
  std::vector<ConfigError> errors;
  const auto fleet = LoadFleet(options.fleet, {}, &errors);
  if (!fleet) {
    PrintErrors(errors, std::cerr);
    return kExitBadConfig;
  }
  std::vector<int> ids = options.arms;
  for (const int id : ids) {
    if (fleet->IndexOf(id) < 0)
      return Fail("--arm " + std::to_string(id) + ": " + options.fleet + " has no such arm", kExitUsage);
  }
  if (ids.empty()) {
    std::transform(fleet->arms.begin(), fleet->arms.end(), std::back_inserter(ids),
                   [](const ArmEntry& arm) { return arm.id; });
  }
  std::string error;
  std::optional<FleetKey> key;
  if (fleet->link.has_key()) {
    key = LoadFleetKey(fleet->link.key_file, &error);
    if (!key) return Fail(error, kExitBadConfig);
  }
  const auto url = ParseLcmUrl(fleet->link.lcm_url, &error);
  const auto link = url ? LcmEndpoint::Open(*url, MachineClock::Get(), &error) : nullptr;
  if (!link) return Fail(error);

  OperatorCall call(FleetDigest(*fleet), request, ids, key);
  call.Run(link.get(), options.timeout_s);
  for (const CallResult& result : call.results()) std::cout << result.Describe() << '\n';
  return call.all_accepted() ? kExitOk : kExitFailed;
}

constexpr const char* TextOf(Request request) {
  switch (request) {
    case Request::kArm:
      return "enable the drives; the arm then holds its posture";
    case Request::kStart:
      return "follow the leader, from HOLD";
    case Request::kHold:
      return "come to rest and hold the posture";
    case Request::kReset:
      return "leave FAULT, or disarm from HOLD: drives off";
    case Request::kNone:
    case Request::kEstop:
      break;
  }
  return "brake to rest, drives off, until reset: always possible";
}

}  // namespace

void AddCtlCommand(Command* app, int* code) {
  Command* command = app->add_subcommand("ctl", "an operator's commands to running boards");
  command->require_subcommand(1);
  for (const Request request :
       {Request::kArm, Request::kStart, Request::kHold, Request::kReset, Request::kEstop}) {
    auto options = std::make_shared<Options>();
    options->fleet = DefaultFleet();
    Command* sub = command->add_subcommand(NameOf(request), TextOf(request));
    sub->add_option("--fleet", options->fleet, "fleet file; default: $ARMADA_FLEET or /etc/armada/fleet.toml")
        ->capture_default_str();
    sub->add_option("--arm", options->arms, "id of an arm; may be repeated; default: all")
        ->allow_extra_args(false);
    sub->add_option("--timeout", options->timeout_s, "seconds to wait for answers")->capture_default_str();
    sub->callback([=] { *code = Call(*options, request); });
  }
}

}  // namespace armada
