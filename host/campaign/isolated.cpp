#include "host/campaign/isolated.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "firmware/unique_fd.h"

namespace armada {
namespace {

struct Child {
  size_t piece;
  pid_t pid;
  UniqueFd output;
  std::string text;
};

[[noreturn]] void Fail(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

void WriteAll(int fd, const std::string& text) {
  size_t at = 0;
  while (at < text.size()) {
    const ssize_t written = write(fd, text.data() + at, text.size() - at);
    if (written <= 0 && errno != EINTR) _exit(1);
    at += static_cast<size_t>(std::max<ssize_t>(written, 0));
  }
}

Child Start(size_t piece, const std::function<std::string(size_t)>& work) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) Fail("pipe");
  UniqueFd output(ends[0]);
  const UniqueFd input(ends[1]);
  std::fflush(nullptr);
  const pid_t pid = fork();
  if (pid < 0) Fail("fork");
  if (pid == 0) {
    WriteAll(input.get(), work(piece));
    _exit(0);
  }
  return {piece, pid, std::move(output), {}};
}

/// Takes what there is; false at the end of it.
bool Read(Child* child) {
  std::array<char, 4096> bytes;
  const ssize_t size = read(child->output.get(), bytes.data(), bytes.size());
  if (size < 0 && errno == EINTR) return true;
  if (size <= 0) return false;
  child->text.append(bytes.data(), static_cast<size_t>(size));
  return true;
}

IsolatedResult End(Child* child) {
  int status = 0;
  while (waitpid(child->pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {std::move(child->text), {}};
  if (WIFSIGNALED(status)) return {{}, strsignal(WTERMSIG(status))};
  return {{}, "exit code " + std::to_string(WEXITSTATUS(status))};
}

}  // namespace

void RunIsolated(size_t count, int jobs, const std::function<std::string(size_t)>& work,
                 const std::function<void(size_t, const IsolatedResult&)>& done) {
  const size_t most =
      jobs > 0 ? static_cast<size_t>(jobs) : std::max<size_t>(1, std::thread::hardware_concurrency());
  std::vector<Child> children;
  size_t next = 0;
  while (next < count || !children.empty()) {
    while (next < count && children.size() < most) children.push_back(Start(next++, work));
    std::vector<pollfd> waits;
    for (const Child& child : children) waits.push_back({child.output.get(), POLLIN, 0});
    if (poll(waits.data(), waits.size(), -1) < 0 && errno != EINTR) Fail("poll");
    for (size_t i = children.size(); i-- > 0;) {
      if (waits[i].revents == 0 || Read(&children[i])) continue;
      done(children[i].piece, End(&children[i]));
      children.erase(children.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
}

}  // namespace armada
