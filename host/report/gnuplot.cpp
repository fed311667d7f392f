#include "host/report/gnuplot.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>

#include "host/report/report_error.h"

namespace armada {
namespace {

/// What a child process is to be started with; frees itself.
class SpawnActions {
 public:
  SpawnActions() { posix_spawn_file_actions_init(&actions_); }
  SpawnActions(const SpawnActions&) = delete;
  SpawnActions& operator=(const SpawnActions&) = delete;
  ~SpawnActions() { posix_spawn_file_actions_destroy(&actions_); }
  posix_spawn_file_actions_t* get() { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_;
};

std::string ReadAll(int descriptor) {
  std::string text;
  std::array<char, 4096> buffer;
  for (ssize_t count; (count = read(descriptor, buffer.data(), buffer.size())) != 0;) {
    if (count > 0) text.append(buffer.data(), static_cast<size_t>(count));
    if (count < 0 && errno != EINTR) break;
  }
  return text;
}

}  // namespace

void RunGnuplot(const std::filesystem::path& folder, const std::string& script) {
  std::array<int, 2> messages;
  if (pipe2(messages.data(), O_CLOEXEC) != 0)
    throw ReportError(std::string("gnuplot: pipe: ") + std::strerror(errno));

  SpawnActions actions;
  posix_spawn_file_actions_addchdir_np(actions.get(), folder.c_str());
  posix_spawn_file_actions_addopen(actions.get(), STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(actions.get(), messages[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(actions.get(), messages[1], STDERR_FILENO);
  const std::array<const char*, 4> arguments = {"gnuplot", "--default-settings", script.c_str(), nullptr};
  pid_t child = 0;
  const int failure = posix_spawnp(&child, arguments[0], actions.get(), nullptr,
                                   const_cast<char* const*>(arguments.data()), environ);
  close(messages[1]);
  const std::string output = failure == 0 ? ReadAll(messages[0]) : "";
  close(messages[0]);
  if (failure != 0) {
    throw ReportError(std::string("gnuplot cannot be started (") + std::strerror(failure) +
                      "): install the Debian package gnuplot-nox");
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw ReportError("gnuplot failed on " + (folder / script).string() + ":\n" + output);
  }
}

}  // namespace armada
