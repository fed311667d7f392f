#include "host/run/run_in_vm.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>

#include "firmware/app/exit_codes.h"

namespace armada {

int RunInVm(const RunOptions& options) {
  namespace fs = std::filesystem;
  std::vector<std::string> words = {ARMADA_VM_RUN, "-o", options.out};
  if (!options.json.empty())
    words.insert(words.end(), {"-o", fs::absolute(options.json).parent_path().string()});
  words.insert(words.end(), {"--", (fs::path(options.program_directory) / "armada").string()});
  words.insert(words.end(), options.arguments.begin(), options.arguments.end());
  words.insert(words.end(), {"--bus", "socketcan"});  // the last one counts

  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  std::cout << "starting a virtual machine; user space is up in a few seconds" << std::endl;
  execv(argv[0], argv.data());
  std::cerr << "armada run: --bus vm: cannot run " << argv[0] << ": " << std::strerror(errno) << '\n';
  return kExitFailed;
}

}  // namespace armada
