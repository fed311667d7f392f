#include "firmware/link/fleet_key.h"

#include <fcntl.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "firmware/unique_fd.h"

namespace armada {
namespace {

constexpr mode_t kOthers = S_IRWXG | S_IRWXO;
constexpr std::string_view kNoSecret = "armada, stepped, seed: ";  // a seed follows
static_assert(kNoSecret.size() + 9 == kFleetKeySize);

std::string Octal(mode_t mode) {
  char text[8];
  std::snprintf(text, sizeof text, "%04o", static_cast<unsigned>(mode & 07777));
  return text;
}

// What is wrong with a file as a place of a secret; empty if nothing is.
std::string WhatIsWrong(const struct stat& status) {
  if (!S_ISREG(status.st_mode)) return "is no regular file";
  if (status.st_uid != geteuid() && status.st_uid != 0) {
    return "belongs to user " + std::to_string(status.st_uid) + ", allowed are this user, " +
           std::to_string(geteuid()) + ", and root";
  }
  if ((status.st_mode & kOthers) != 0) {
    return "has mode " + Octal(status.st_mode) +
           ", allowed are 0600 and 0400: chmod 600 it, and make a new key "
           "if others could have read this one";
  }
  if (status.st_size != kFleetKeySize)
    return "has " + std::to_string(status.st_size) + " bytes, a key has " + std::to_string(kFleetKeySize);
  return "";
}

}  // namespace

std::optional<FleetKey> LoadFleetKey(const std::string& path, std::string* error) {
  const auto fail = [&](const std::string& what) {
    *error = "key " + path + ": " + what;
    return std::nullopt;
  };
  if (sodium_init() < 0) return fail("libsodium does not start");
  const UniqueFd file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  struct stat status {};
  if (!file.valid() || fstat(file.get(), &status) != 0)
    return fail(std::string(std::strerror(errno)) + "; `armada key new` makes one");
  if (const std::string wrong = WhatIsWrong(status); !wrong.empty()) return fail(wrong);
  FleetKey key{};
  if (read(file.get(), key.data(), key.size()) != static_cast<ssize_t>(key.size()))
    return fail("cannot be read");
  if (std::all_of(key.begin(), key.end(), [](uint8_t byte) { return byte == 0; }))
    return fail("is all zeros, which is no secret; `armada key new` makes one");
  return key;
}

FleetKey SeededKey(uint64_t seed) {
  FleetKey key{};
  auto* next = std::copy(kNoSecret.begin(), kNoSecret.end(), key.begin());
  for (int i = 0; i < 8; ++i) *next++ = static_cast<uint8_t>(seed >> 8 * i);
  return key;
}

bool IsSeeded(const FleetKey& key) {
  return std::equal(kNoSecret.begin(), kNoSecret.end(), key.begin());
}

bool MakeFleetKey(const std::string& path, std::string* error) {
  if (sodium_init() < 0) {
    *error = "key " + path + ": libsodium does not start";
    return false;
  }
  FleetKey key{};
  randombytes_buf(key.data(), key.size());
  const bool written = WriteFleetKey(path, key, error);
  sodium_memzero(key.data(), key.size());
  return written;
}

bool WriteFleetKey(const std::string& path, const FleetKey& key, std::string* error) {
  const auto fail = [&](const std::string& what) {
    *error = "key " + path + ": " + what;
    return false;
  };
  const UniqueFd file(open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR));
  if (!file.valid()) return fail(std::strerror(errno));
  const bool written =
      write(file.get(), key.data(), key.size()) == static_cast<ssize_t>(key.size()) && fsync(file.get()) == 0;
  const int cause = errno;
  if (written) return true;
  unlink(path.c_str());
  return fail(std::strerror(cause));
}

}  // namespace armada
