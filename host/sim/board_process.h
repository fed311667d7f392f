#pragma once

#include <cstdint>
#include <optional>

#include "hil/scenario.h"
#include "host/sim/board_faults.h"

namespace armada {

/// The process of one arm's board in virtual time, as far as faults disturb it: whether there is one, whether
/// it begins its ticks, and when it is done with them. Without a fault of its arm: all of them, at once.
class BoardProcess {
 public:
  /// What becomes of a tick.
  enum class Turn {
    kTick,    ///< it begins
    kMissed,  ///< the process gets no time, or is still busy with an older one
    kStart,   ///< a new process starts; its controller knows nothing
    kStarts,  ///< it waits for its time 0
    kNone,    ///< there is no process
  };

  BoardProcess(const ScenarioConfig& scenario, int arm_id);

  /// Whether the board says something in tick k. Before Begin(k).
  bool IsOnTime(int64_t k) const;
  /// Each tick in turn.
  Turn Begin(int64_t k);
  /// True once a tick has begun whose torques come now. Late samples are waited for, as the process does.
  bool Answers(double t_s, bool samples_complete);

  const BoardFaults& faults() const { return faults_; }
  int64_t tick() const { return tick_; }            ///< the last that has begun
  bool busy() const { return busy_; }               ///< it is not answered yet
  int64_t missed_ticks() const { return missed_; }  ///< between it and the one before
  bool running() const { return !killed_; }
  uint64_t starts() const { return starts_; }         ///< of the process so far
  int64_t first_tick() const { return first_tick_; }  ///< of the last start

 private:
  double TimeOf(int64_t k) const { return static_cast<double>(k) * timing_.period_s; }

  TimingConfig timing_;
  BoardFaults faults_;
  bool killed_ = false;
  uint64_t starts_ = 1;
  int64_t first_tick_ = 0;
  int64_t tick_ = -1;
  bool busy_ = false;
  std::optional<double> done_s_;  ///< once the samples are there, or waited for in vain
  int64_t missed_ = 0;
  int64_t missed_since_ = 0;  ///< the last tick that has begun
};

}  // namespace armada
