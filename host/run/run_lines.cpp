#include "host/run/run_lines.h"

#include <filesystem>

#include "firmware/app/initial_state.h"
#include "host/run/board_networks.h"

namespace armada {

namespace fs = std::filesystem;

std::vector<std::string> RunLines::Emulation(int64_t epoch_ns) const {
  std::vector<std::string> line = {Program("armada-hil"),
                                   In("scenario.toml"),
                                   "--seed",
                                   std::to_string(options_.seed),
                                   "--epoch-ns",
                                   std::to_string(epoch_ns),
                                   "--seconds",
                                   Seconds(),
                                   "--out",
                                   options_.out};
  for (const std::string& bus : options_.hil_buses) line.insert(line.end(), {"--bus", bus});
  return line;
}

std::vector<std::string> RunLines::Leader(int64_t epoch_ns) const {
  return {Program("armada-leader"),
          In("scenario.toml"),
          "--epoch-ns",
          std::to_string(epoch_ns),
          "--seconds",
          Seconds(),
          "--state",
          In("state")};
}

std::vector<std::string> RunLines::Board(int arm_id, bool anew, int64_t epoch_ns) const {
  const std::string id = std::to_string(arm_id);
  std::vector<std::string> line;
  if (options_.namespaces) line = BoardNetworks::Prefix(arm_id);
  line.insert(line.end(),
              {Program("armada-arm"), In("fleet.toml"), "--arm", id, "--epoch-ns", std::to_string(epoch_ns),
               "--seconds", Seconds(), "--learned", LearnedFile(In("learned"), arm_id), "--state",
               In("state"), "--json", In("arm_" + id + ".json")});
  if (!anew) line.insert(line.end(), {"--initial", In("initial_" + id + ".toml")});
  if (!anew && scenario_.start.mode == StartMode::kRunning) line.emplace_back("--running");
  return line;
}

std::vector<std::string> RunLines::LcmLogger() const {
  return {"/usr/bin/lcm-logger", "--quiet", "--force", "--lcm-url=" + scenario_.fleet.link.lcm_url,
          In("lcm.log")};
}

std::string RunLines::In(const std::string& name) const {
  return (fs::path(options_.out) / name).string();
}

std::string RunLines::Program(const char* name) const {
  return (fs::path(options_.program_directory) / name).string();
}

}  // namespace armada
