#pragma once

#include <cstdio>
#include <memory>
#include <string>

#include "firmware/unique_fd.h"

namespace armada {

/// A folder that one run, or one report of a run, has to itself for as long as the object lives: it holds a
/// lock on the file run.lock, which has its process id. The file goes with the object, and so do the pipes
/// of `armada fault`, also when this process is killed.
class RunFolder {
 public:
  static constexpr const char* kLock = "run.lock";

  /// Makes the folder where there is none. Null when somebody else has it, then with `in_use`, or when it
  /// cannot be written, with the reason in `error`; nothing in it has been touched then.
  static std::unique_ptr<RunFolder> Take(const std::string& directory, bool* in_use, std::string* error);
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;
  ~RunFolder();

  /// Whether its path still leads to it: who moves or removes a folder gives its path to others.
  bool IsThere() const;

  /// A program that takes the place of this one (execve) keeps the folder.
  void KeepAcrossExec();

 private:
  RunFolder(std::string path, UniqueFd lock, FILE* janitor)
      : path_(std::move(path)), lock_(std::move(lock)), janitor_(janitor) {}

  std::string path_;  ///< of the lock
  UniqueFd lock_;
  FILE* janitor_;
};

/// Removes what an earlier run has left in a folder that was taken: it must not pass for a result of the next
/// one.
void EmptyRunFolder(const std::string& directory);

}  // namespace armada
