#include "host/run/run_in_vm.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>

#include "firmware/app/exit_codes.h"
#include "hil/scenario_file.h"

namespace armada {

int RunInVm(const RunOptions& options, const ScenarioConfig& scenario) {
  namespace fs = std::filesystem;
  const fs::path out = options.out;
  std::string error;
  ScenarioConfig guest = scenario;  // alone on its network; its run has a key of its own
  guest.fleet.link.lcm_url = LcmLinkConfig().lcm_url;
  guest.fleet.link.key_file = LcmLinkConfig().key_file;
  if (!WriteEffective(guest, out.string(), &error)) {
    std::cerr << "armada run: " << error << '\n';
    return kExitFailed;
  }
  std::vector<std::string> words = {ARMADA_VM_RUN, "-o", out.string(), "-p", "/usr/bin/lcm-logger"};
  for (const char* name : {"scenario.toml", "fleet.toml"}) words.insert(words.end(), {"-f", out / name});
  for (const char* name : {"armada", "armada-arm", "armada-hil", "armada-leader"})
    words.insert(words.end(), {"-p", fs::path(options.program_directory) / name});
  if (!options.json.empty()) words.insert(words.end(), {"-c", "metrics.json=" + options.json});
  words.insert(words.end(), {"--", "armada", "run", "scenario.toml", "--bus", "socketcan", "--seed",
                             std::to_string(options.seed), "--out", "out"});
  if (options.namespaces) words.emplace_back("--namespaces");

  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  std::cout << "in a virtual machine, in virtual time, into " << options.out << std::endl;
  execv(argv[0], argv.data());
  std::cerr << "armada run: --bus vm: cannot run " << argv[0] << ": " << std::strerror(errno) << '\n';
  return kExitFailed;
}

}  // namespace armada
