#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "firmware/can/frame.h"
#include "firmware/unique_fd.h"

namespace armada {

/// Longest line that FormatCanLogLine writes, for channel names of at most 15 characters.
inline constexpr size_t kMaxCanLogLine = 192;

/// A frame as one line of candump's log format, `(seconds.micros) channel ID#DATA`, which can-utils and
/// python-can read: remote frames as ID#R<length>, CAN FD as ID##<flags>DATA. Returns the line's length, its
/// newline included. @pre `line` has room for kMaxCanLogLine.
size_t FormatCanLogLine(int64_t time_ns, std::string_view channel, const CanFrame& frame,
                        std::span<char> line);

/// The frames of one bus, on their way from a real-time loop to a file. The loop must never wait for a disk,
/// and how long a disk takes has no bound, so the two meet in a ring of fixed size and nowhere else: the loop
/// puts a frame in or, when the writer is a whole ring behind, counts it as dropped. No lock is shared, so
/// the loop cannot inherit the writer's low priority either.
class CanLog {
 public:
  /// What a saturated bus of 1 Mbit/s carries in about a second.
  static constexpr size_t kCapacity = 8192;

  /// Creates the file, or empties it. `wall_offset_ns`: from the frames' clock to the wall clock of the log,
  /// fixed for the whole log so that stamps never step. Null, and the reason in `error`, when it cannot be
  /// written.
  static std::unique_ptr<CanLog> Create(const std::string& path, std::string_view channel,
                                        int64_t wall_offset_ns, std::string* error);

  /// For a loop in stepped time, which waits for the disk: it writes by itself whenever the ring is full, and
  /// no writer is to run.
  void WriteInTheLoop() { in_the_loop_ = true; }

  /// The loop's side: takes the frame or counts it as dropped; neither waits nor allocates.
  void Record(int64_t stamp_ns, const CanFrame& frame);

  /// The writer's side: moves what is in the ring to the file, through memory of fixed size.
  void WriteOut();

  const std::string& path() const { return path_; }
  uint64_t recorded() const { return written_.load(std::memory_order_relaxed); }
  uint64_t dropped() const { return dropped_.load(std::memory_order_relaxed); }
  /// Why the file is not complete; empty when all is well. The writer's side.
  const std::string& error() const { return error_; }

 private:
  CanLog(UniqueFd file, std::string path, std::string_view channel, int64_t wall_offset_ns);
  void Flush();

  UniqueFd file_;
  std::string path_;
  std::string channel_;
  int64_t wall_offset_ns_;
  bool in_the_loop_ = false;
  std::vector<CanFrame> ring_;
  std::atomic<uint64_t> written_{0};  ///< frames ever put into the ring
  std::atomic<uint64_t> read_{0};     ///< frames ever taken out
  std::atomic<uint64_t> dropped_{0};
  std::vector<char> text_;
  size_t text_size_ = 0;
  std::string error_;
};

/// Thread of low priority that writes logs out, 20 times a second and once more at the end.
class CanLogWriter {
 public:
  /// The logs outlive the object.
  explicit CanLogWriter(std::vector<CanLog*> logs);
  CanLogWriter(const CanLogWriter&) = delete;
  CanLogWriter& operator=(const CanLogWriter&) = delete;
  ~CanLogWriter();

 private:
  void Run();

  std::vector<CanLog*> logs_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace armada
