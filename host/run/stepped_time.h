#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/clock/stepped_clock.h"
#include "firmware/unique_fd.h"
#include "host/process_group.h"
#include "host/run/watched_program.h"

namespace armada {

/// Stepped time as the run keeps it: makes the page, gives each program a slot, has slot 0 itself, and
/// notices within a second of the machine's time when a program dies or hangs. Used by the main thread, like
/// the ProcessGroup.
class SteppedTime final : public SteppedClock {
 public:
  /// `pace`: stepped seconds a real one, 0: as fast as it goes. Null, and the reason in `error`, on failure.
  static std::unique_ptr<SteppedTime> Create(double pace, std::string* error);
  ~SteppedTime() override;

  /// Words of its command line by which a program takes its time from here; a slot is given in the order of
  /// the first calls. Call before the program starts; again, if it starts anew after its end. The program is
  /// to keep descriptor().
  std::vector<std::string> ArgumentsFor(const std::string& program);
  int descriptor() const { return file_.get(); }
  /// Time stands until every program that was started is there. False with *error set.
  bool AwaitPrograms(ProcessGroup* group, std::string* error);

  /// Lets time pass until `until_ns`, or until one of `inputs` has something. Returns a program that has
  /// ended, if one has.
  std::optional<ProcessExit> Pass(ProcessGroup* group, std::span<pollfd> inputs, int64_t until_ns);
  /// Why no time passes any more; empty while all is well. A program that died is told by Pass alone.
  const std::string& trouble() const { return trouble_; }

  /// Kills a program. False if there is none of that name.
  bool Kill(ProcessGroup* group, const std::string& program);
  /// Gives a program no more turns, or turns again. False if there is none of that name.
  bool Suspend(const std::string& program, bool suspended);

  /// Lets go of all programs: from now on time passes by itself for them.
  void Release();

  /// Simulated seconds since the start, and the machine's that they took.
  double stepped_s() const;
  double real_s() const;
  /// Datagrams that came late or never: what was run is then not what another run would be.
  uint64_t late() const { return page()->late; }
  uint64_t lost() const { return page()->lost; }
  /// That waited so long to be read that when they were sent is forgotten.
  uint64_t forgotten() const { return page()->forgotten; }
  uint64_t dropped() const { return page()->dropped; }
  uint64_t strangers() const { return page()->strangers; }

 private:
  SteppedTime(ClockPage* page, UniqueFd file) : SteppedClock(page, 0), file_(std::move(file)) {}
  bool MayWaitOn() override;
  /// Takes note of a program that has ended; false when it left the others waiting.
  bool NoteEnd(const ProcessExit& ended);
  /// Whether the program whose turn it is gets on; else trouble_ says what it does.
  bool HolderGetsOn();
  ClockPage::Slot* Find(const std::string& program);
  /// A program that has left, or was killed, and whose end has not been taken note of; empty: none.
  std::string WhoseEndIsAwaited() const;
  bool AwaitsAnEnd() const { return !WhoseEndIsAwaited().empty(); }

  UniqueFd file_;
  ProcessGroup* group_ = nullptr;
  std::vector<std::string> programs_;  ///< of slots 1, 2, ..
  std::vector<bool> running_;
  std::deque<ProcessExit> ended_;
  std::string trouble_;
  int64_t began_ns_ = 0;
  // Of the present turn.
  uint64_t turn_ = 0;
  int64_t turn_since_ns_ = 0;
  int64_t turn_cpu_ns_ = 0;
  Patience turn_patience_{0};
  bool told_ = false;
};

}  // namespace armada
