// armada-leader: publishes the leader's state on LEADER, on an absolute time grid.
//
// Exit codes: 0 stopped by a signal or after --seconds; 1 the network cannot be used; 2 usage; 78 bad
// configuration.

#include <algorithm>
#include <cmath>
#include <csignal>
#include <iostream>
#include <limits>

#include "firmware/app/command_line.h"
#include "firmware/app/exit_codes.h"
#include "firmware/app/link_identity.h"
#include "firmware/app/program_clock.h"
#include "firmware/app/realtime.h"
#include "firmware/app/standard_files.h"
#include "firmware/link/channels.h"
#include "firmware/link/lcm_endpoint.h"
#include "firmware/link/messages.h"
#include "hil/leader_path.h"
#include "hil/scenario_file.h"

namespace armada {
namespace {

volatile std::sig_atomic_t stop_requested = 0;

void StopOnSignals() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_requested = 1; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

struct Options {
  std::string scenario;
  std::vector<std::string> sets;
  int64_t epoch_ns = 0;  // 0: with the first message
  double seconds = std::numeric_limits<double>::infinity();
  std::string state = DefaultStateFolder();
  std::string stepped_clock;
  int priority = 80;
};

// Times of the messages: epoch + k / rate, for every integer k.
class Grid {
 public:
  Grid(int64_t epoch_ns, double rate_hz) : epoch_ns_(epoch_ns), rate_hz_(rate_hz) {}

  int64_t Stamp(int64_t k) const { return epoch_ns_ + std::llround(1e9 * static_cast<double>(k) / rate_hz_); }
  /// Fleet time of the stamp: the state that is sent is exactly that of the stamp.
  double PathTime(int64_t k) const { return static_cast<double>(Stamp(k) - epoch_ns_) / 1e9; }
  /// First k whose time is not before now.
  int64_t Next(int64_t now_ns) const {
    auto k = static_cast<int64_t>(std::floor(1e-9 * static_cast<double>(now_ns - epoch_ns_) * rate_hz_));
    while (Stamp(k) < now_ns) ++k;
    return k;
  }

 private:
  int64_t epoch_ns_;
  double rate_hz_;
};

leader_t MessageAt(const LeaderPath& path, double path_time_s) {
  const Zeta zeta = path.At(path_time_s);
  leader_t message{};
  message.path_time_s = path_time_s;
  message.task_dim = static_cast<int8_t>(zeta.x_m.size());
  std::copy(zeta.x_m.begin(), zeta.x_m.end(), message.x_m);
  std::copy(zeta.v_m_s.begin(), zeta.v_m_s.end(), message.v_m_s);
  std::copy(zeta.a_m_s2.begin(), zeta.a_m_s2.end(), message.a_m_s2);
  const TaskVector jerk_m_s3 = path.Jerk(path_time_s);
  std::copy(jerk_m_s3.begin(), jerk_m_s3.end(), message.jerk_m_s3);
  return message;
}

struct Tally {
  int64_t sent = 0;
  int64_t refused = 0;  // by the kernel
  int64_t skipped = 0;  // grid times that passed before the process woke up: never sent late in a burst
  bool ended = false;   // sent all of its run
};

Tally Publish(const LeaderPath& path, const Grid& grid, double seconds, std::optional<Sealer>& sealer,
              LcmEndpoint& lcm, Clock& clock) {
  Tally tally;
  MessageBuffer buffer;
  int64_t k = grid.Next(clock.Now());
  while (stop_requested == 0 && grid.PathTime(k) < seconds) {
    clock.SleepUntil(grid.Stamp(k));
    if (clock.Now() < grid.Stamp(k)) continue;  // a signal woke it

    leader_t message = MessageAt(path, grid.PathTime(k));
    message.stamp_ns = grid.Stamp(k);
    message.sequence = tally.sent + 1;
    const auto sealed = SealIfKeyed(sealer, kLeaderChannel, Encode(message, &buffer), &buffer);
    lcm.Publish(kLeaderChannel, sealed) ? ++tally.sent : ++tally.refused;

    const int64_t next = std::max(k + 1, grid.Next(clock.Now()));
    tally.skipped += next - (k + 1);
    k = next;
  }
  tally.ended = grid.PathTime(k) >= seconds;
  return tally;
}

int Run(const Options& options) {
  std::vector<ConfigError> errors;
  const auto scenario = LoadScenario(options.scenario, options.sets, &errors);
  if (!scenario) {
    PrintErrors(errors, std::cerr);
    return kExitBadConfig;
  }
  if (scenario->leader.kind == LeaderKind::kNone) {
    std::cerr << "armada-leader: " << options.scenario
              << " has no leader (leader.kind = \"none\"): nothing to publish\n";
    return kExitUsage;
  }
  std::string error;
  std::optional<LinkIdentity> identity;
  if (!TakeIdentity(scenario->fleet.link, kLeaderSender, options.state, &identity, &error)) {
    std::cerr << "armada-leader: " << error << '\n';
    return kExitBadConfig;
  }
  std::optional<Sealer> sealer;
  if (identity) {
    sealer.emplace(*identity, kLeaderSender);
  } else {
    std::cerr << "armada-leader: " << WarningOf(scenario->fleet.link) << '\n';
  }
  const bool stepped = !options.stepped_clock.empty();
  const auto url = ParseLcmUrl(scenario->fleet.link.lcm_url, &error);
  if (url && !stepped) error = WhyNotReal(identity, scenario->fleet.link);
  const auto clock = error.empty() ? OpenProgramClock(options.stepped_clock, *url, {}, &error) : nullptr;
  if (!clock) {
    std::cerr << "armada-leader: " << error << '\n';
    return kExitBadConfig;
  }
  const auto lcm = LcmEndpoint::Open(*url, clock.get(), &error);
  if (!lcm) {
    std::cerr << "armada-leader: " << error << '\n';
    return kExitFailed;
  }

  const RealtimeGrant grant = stepped ? RealtimeGrant{} : EnterRealtime(options.priority);
  if (!grant.complaint.empty()) std::cerr << "armada-leader: " << grant.complaint << '\n';
  const double rate_hz = scenario->leader.rate_hz;
  const int64_t first_ns = clock->Now() + std::llround(1e9 / rate_hz);
  const int64_t epoch_ns = options.epoch_ns > 0 ? options.epoch_ns : first_ns;
  std::cout << "armada-leader: " << kLeaderChannel << " at " << rate_hz << " Hz on " << ToString(*url)
            << ", epoch " << epoch_ns << " ns" << std::endl;
  const Tally tally =
      Publish(LeaderPath(scenario->leader), Grid(epoch_ns, rate_hz), options.seconds, sealer, *lcm, *clock);
  std::cout << "armada-leader: " << tally.sent << " messages sent, " << tally.refused
            << " refused by the kernel, " << tally.skipped << " skipped" << std::endl;
  if (!tally.ended && std::isfinite(options.seconds)) return kExitInterrupted;
  return tally.sent == 0 && tally.refused > 0 ? kExitFailed : kExitOk;
}

}  // namespace
}  // namespace armada

int main(int argc, char** argv) {
  armada::OpenStandardFiles();
  armada::Options options;
  armada::CommandLine app("Publishes the leader of a scenario on LCM, channel LEADER.", "armada-leader");
  app.add_option("SCENARIO", options.scenario, "scenario file")->required();
  app.add_option("--epoch-ns", options.epoch_ns,
                 "fleet's time 0 on CLOCK_MONOTONIC, ns; default: the first message")
      ->range(int64_t{1}, armada::kMaxStampNs);
  app.add_option("--seconds", options.seconds,
                 "length of the run from the epoch; default: until SIGINT or SIGTERM")
      ->range(1e-3, 1e9);
  app.add_option("--set", options.sets, "key=value in place of the scenario's; may be repeated")->expected(1);
  app.add_option("--state", options.state, "folder for what must survive restarts: the number of starts")
      ->capture_default_str();
  app.add_option("--stepped-clock", options.stepped_clock, armada::kSteppedClockHelp);
  app.add_option("--priority", options.priority, "SCHED_FIFO priority; 0 asks for none")->range(0, 99);
  if (const auto code = app.parse(argc, argv)) return *code;
  armada::StopOnSignals();
  return armada::Run(options);
}
