#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "firmware/clock/clock.h"
#include "hil/fault.h"
#include "host/run/cpu_hog.h"
#include "host/run/program_control.h"

namespace armada {

/// The faults of a run that are made from outside of the programs: one is killed, stopped, started anew, a
/// CAN interface is set down, a processor kept busy; the last not in stepped time, where computing takes
/// none. Used by the main thread, like the ProcessGroup.
class ProcessFaults {
 public:
  /// What was done, and when.
  struct Made {
    std::string what;
    std::string to;  ///< the process or the interface
    double at_s;     ///< as the scenario says
    double made_s;   ///< when it was; both are times of the run
  };

  /// Names in the group.
  static std::string ArmProcess(int arm_id) { return "arm " + std::to_string(arm_id); }
  static constexpr const char* kLeaderProcess = "leader";

  /// `interfaces`: CAN interfaces that are the board's alone, by arm; another one is also the emulation's
  /// end, and stays up. What would be over after `end_ns` never is. `clock`, stepped or the machine's,
  /// outlives the object.
  ProcessFaults(const std::vector<FaultConfig>& faults, const std::map<int, std::string>& interfaces,
                Clock* clock, int64_t epoch_ns, int64_t end_ns);
  ProcessFaults(const ProcessFaults&) = delete;
  ProcessFaults& operator=(const ProcessFaults&) = delete;
  /// Interfaces that are still down are set up.
  ~ProcessFaults();

  /// From now on there is this fault, too.
  void Add(const FaultConfig& fault);

  /// Until when the caller may do something else.
  int64_t Next() const;

  /// Makes those that come within the next moment, each at its time. `start` starts a controller anew. False
  /// with `*error` set.
  bool MakeDue(ProgramControl* control, const std::function<bool(int arm_id, std::string* error)>& start,
               std::string* error);

  /// Whether the program's end was ordered here; asked once for each end.
  bool TakeOrdered(const ProcessExit& ended);

  /// Programs that are stopped and will not go on.
  size_t stopped_for_good() const { return stopped_for_good_.size(); }
  /// Kills these: asked to end, they would first go on.
  void KillStopped(ProgramControl* control);

  /// Arms whose controller there is no more.
  const std::set<int>& dead_arms() const { return dead_arms_; }
  const std::vector<Made>& made() const { return made_; }

 private:
  enum class Deed { kKill, kStop, kStopForGood, kContinue, kStart, kLinkDown, kLinkUp };
  struct Step {
    int64_t at_ns;
    Deed deed;
    int arm_id;  ///< 0: the leader
  };

  void Plan(const FaultConfig& fault);
  void AddStep(double at_s, Deed deed, int arm_id);
  bool Ends(const FaultConfig& fault) const { return TimeOf(fault.until_s) < end_ns_; }
  int64_t TimeOf(double t_s) const;
  bool Make(const Step& step, ProgramControl* control,
            const std::function<bool(int arm_id, std::string* error)>& start, std::string* error);
  void Kill(int arm_id, ProgramControl* control);
  bool Switch(int arm_id, bool up, std::string* error);
  static const char* NameOf(Deed deed);
  static std::string ProcessOf(int arm_id) { return arm_id == 0 ? kLeaderProcess : ArmProcess(arm_id); }

  void SleepThrough(int64_t until_ns) const;

  std::map<int, std::string> interfaces_;
  Clock* clock_;
  int64_t lead_ns_;  ///< before a step, in which this process takes its priority; 0 in stepped time
  int64_t epoch_ns_;
  int64_t end_ns_;
  std::vector<Step> steps_;  ///< in order
  size_t next_ = 0;
  std::list<CpuHog> hogs_;
  std::multiset<std::string> ordered_;  ///< names of programs that were killed and have not been seen to end
  std::set<int> stopped_for_good_;
  std::set<int> dead_arms_;
  std::set<int> down_;  ///< arms whose interface is
  std::vector<Made> made_;
};

}  // namespace armada
