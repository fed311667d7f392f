#pragma once

#include <csignal>
#include <string>

#include "host/process_group.h"
#include "host/run/stepped_time.h"

namespace armada {

/// How programs of a run are killed, stopped and let go on, by their names in the group; false if there is
/// none of that name.
class ProgramControl {
 public:
  virtual ~ProgramControl() = default;
  virtual bool Kill(const std::string& program) = 0;
  virtual bool Stop(const std::string& program) = 0;
  virtual bool Continue(const std::string& program) = 0;
};

/// By signals.
class SignalControl final : public ProgramControl {
 public:
  explicit SignalControl(ProcessGroup* group) : group_(group) {}
  bool Kill(const std::string& program) override { return group_->Signal(program, SIGKILL); }
  bool Stop(const std::string& program) override { return group_->Signal(program, SIGSTOP); }
  bool Continue(const std::string& program) override { return group_->Signal(program, SIGCONT); }

 private:
  ProcessGroup* group_;
};

/// In stepped time, where a signal would stop time with the program: it gets no turns.
class SteppedControl final : public ProgramControl {
 public:
  SteppedControl(SteppedTime* time, ProcessGroup* group) : time_(time), group_(group) {}
  bool Kill(const std::string& program) override { return time_->Kill(group_, program); }
  bool Stop(const std::string& program) override { return time_->Suspend(program, true); }
  bool Continue(const std::string& program) override { return time_->Suspend(program, false); }

 private:
  SteppedTime* time_;
  ProcessGroup* group_;
};

}  // namespace armada
