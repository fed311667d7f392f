#include "host/run/ip_command.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "firmware/unique_fd.h"

namespace armada {
namespace {

// All that is written to the descriptor until it is closed, its lines joined.
std::string ReadLines(int descriptor) {
  std::string text;
  std::array<char, 512> buffer{};
  for (ssize_t count = 0; (count = read(descriptor, buffer.data(), buffer.size())) != 0;) {
    if (count > 0) text.append(buffer.data(), static_cast<size_t>(count));
    if (count < 0 && errno != EINTR) break;
  }
  while (text.ends_with('\n')) text.pop_back();
  for (char& c : text) c = c == '\n' ? ' ' : c;
  return text;
}

}  // namespace

bool RunIp(const std::vector<std::string>& arguments, std::string* complaint) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    *complaint = std::string("pipe: ") + std::strerror(errno);
    return false;
  }
  const UniqueFd said(ends[0]);
  UniqueFd speaker(ends[1]);
  std::vector<std::string> words = {"ip"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, speaker.get(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, speaker.get(), STDERR_FILENO);
  pid_t child = 0;
  const int failure = posix_spawnp(&child, "ip", &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) {
    *complaint = std::string("cannot run ip (package iproute2): ") + std::strerror(failure);
    return false;
  }
  speaker = UniqueFd();
  *complaint = ReadLines(said.get());
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace armada
