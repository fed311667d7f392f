#pragma once

#include <sys/types.h>

#include <cstdio>
#include <string>
#include <vector>

namespace armada {

/// A Python process that runs python_can_judge.py, asked in lines and answering in lines: python-can as an
/// independent reader and writer of the user-space bus.
class PythonJudge {
 public:
  explicit PythonJudge(const std::vector<std::string>& arguments);
  PythonJudge(const PythonJudge&) = delete;
  PythonJudge& operator=(const PythonJudge&) = delete;
  ~PythonJudge();  ///< ends its input and waits for it

  void Ask(const std::string& line);
  /// Next line of its answer; empty when it has ended.
  std::string Answer();

 private:
  pid_t process_ = -1;
  FILE* to_ = nullptr;
  FILE* from_ = nullptr;
};

}  // namespace armada
