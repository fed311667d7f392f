#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "firmware/link/lcm_message.h"

namespace armada {

/// A log of LCM messages in the format of lcm-logger, which lcm-logplayer and the liblcm of every language
/// read. For runs in stepped time, whose log must have their time and all of their messages; in real time
/// lcm-logger itself listens.
class LcmLog {
 public:
  /// Creates the file, or empties it. Null, and the reason in `error`, when it cannot be written.
  static std::unique_ptr<LcmLog> Create(const std::string& path, std::string* error);

  /// `wall_ns`: when it came, ns since 1970.
  void Write(const LcmMessage& message, int64_t wall_ns);

  /// Puts all on the disk. False with *error set, when something could not be written since the start.
  bool Close(std::string* error);

 private:
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
  LcmLog(File file, std::string path) : file_(std::move(file)), path_(std::move(path)) {}
  void Put(const void* bytes, size_t size);

  File file_;
  std::string path_;
  int64_t events_ = 0;
  int failure_ = 0;  ///< errno of the first
};

}  // namespace armada
