#include "host/run/watched_program.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>

namespace armada {
namespace {

std::string ContentOf(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

// Whether the second version's freezer has it: such a process is asleep, to proc(5). Where control groups are
// mounted elsewhere it is not seen.
bool IsFrozen(const std::string& proc) {
  std::istringstream groups(ContentOf(proc + "/cgroup"));
  for (std::string line; std::getline(groups, line);) {
    if (!line.starts_with("0::")) continue;
    for (const char* mount : {"/sys/fs/cgroup", "/sys/fs/cgroup/unified"}) {
      if (ContentOf(mount + line.substr(3) + "/cgroup.events").find("frozen 1") != std::string::npos)
        return true;
    }
  }
  return false;
}

// In the order of Doing.
constexpr const char* TextOf(Doing doing) {
  constexpr std::array kTexts = {"at work or waiting for a processor", "asleep", "stopped by a signal",
                                 "frozen, or waiting for a disk", "dead"};
  return kTexts[static_cast<size_t>(doing)];
}

}  // namespace

Doing DoingOf(pid_t pid) {
  const std::string proc = "/proc/" + std::to_string(pid);
  const std::string status = ContentOf(proc + "/stat");
  const size_t name_end = status.rfind(')');  // a name may have anything in it
  switch (name_end + 2 < status.size() ? status[name_end + 2] : 'X') {
    case 'R':
      return Doing::kWork;
    case 'T':
    case 't':
      return Doing::kStopped;
    case 'D':
      return Doing::kFrozen;
    case 'Z':
    case 'X':
      return Doing::kDead;
    default:
      return IsFrozen(proc) ? Doing::kFrozen : Doing::kAsleep;
  }
}

std::string Describe(const std::string& program, pid_t pid) {
  return program + " (pid " + std::to_string(pid) + ", " + TextOf(DoingOf(pid)) + ")";
}

int64_t Patience::Look(pid_t pid, int64_t now_ns) {
  const Doing doing = DoingOf(pid);
  if (doing != Doing::kStopped && doing != Doing::kFrozen)
    used_ns_ += std::min(now_ns - last_look_ns_, kLongestLook_ns);
  last_look_ns_ = now_ns;
  return used_ns_;
}

}  // namespace armada
