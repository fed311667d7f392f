#include "hil/can_log.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>

#include "firmware/clock/monotonic.h"

namespace armada {
namespace {

constexpr size_t kTextBytes = size_t{64} * 1024;
constexpr std::chrono::milliseconds kWritePeriod{50};
constexpr int kWriterNice = 10;

// Flags that linux/can.h keeps beside the identifier and in an FD frame.
constexpr uint32_t kErrorFlag = 0x2000'0000;
constexpr unsigned kFdBitrateSwitch = 1;
constexpr unsigned kFdErrorState = 2;

}  // namespace

size_t FormatCanLogLine(int64_t time_ns, std::string_view channel, const CanFrame& frame,
                        std::span<char> line) {
  const uint32_t id = frame.error ? frame.id | kErrorFlag : frame.id;
  const int id_digits = frame.extended || frame.error ? 8 : 3;
  size_t size = static_cast<size_t>(std::snprintf(
      line.data(), line.size(), "(%010lld.%06lld) %.*s %0*X#", static_cast<long long>(time_ns / kNsPerS),
      static_cast<long long>(time_ns % kNsPerS / 1000), static_cast<int>(channel.size()), channel.data(),
      id_digits, id));
  if (frame.remote) {
    line[size++] = 'R';
    if (frame.length > 0) line[size++] = static_cast<char>('0' + frame.length);
  } else {
    constexpr char kHex[] = "0123456789ABCDEF";
    if (frame.fd) {
      line[size++] = '#';
      line[size++] = kHex[(frame.bitrate_switch ? kFdBitrateSwitch : 0) |
                          (frame.error_state_indicator ? kFdErrorState : 0)];
    }
    for (size_t i = 0; i < frame.length; ++i) {
      line[size++] = kHex[frame.data[i] >> 4];
      line[size++] = kHex[frame.data[i] & 0xF];
    }
  }
  line[size++] = '\n';
  return size;
}

std::unique_ptr<CanLog> CanLog::Create(const std::string& path, std::string_view channel,
                                       int64_t wall_offset_ns, std::string* error) {
  UniqueFd file(open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644));
  if (!file.valid()) {
    *error = "cannot write " + path + ": " + std::strerror(errno);
    return nullptr;
  }
  return std::unique_ptr<CanLog>(new CanLog(std::move(file), path, channel, wall_offset_ns));
}

CanLog::CanLog(UniqueFd file, std::string path, std::string_view channel, int64_t wall_offset_ns)
    : file_(std::move(file)),
      path_(std::move(path)),
      channel_(channel),
      wall_offset_ns_(wall_offset_ns),
      ring_(kCapacity),
      text_(kTextBytes) {}

void CanLog::Record(int64_t stamp_ns, const CanFrame& frame) {
  const uint64_t at = written_.load(std::memory_order_relaxed);
  if (in_the_loop_ && at - read_.load(std::memory_order_relaxed) == kCapacity) WriteOut();
  if (at - read_.load(std::memory_order_acquire) == kCapacity) {
    dropped_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  CanFrame& slot = ring_[at % kCapacity];
  slot = frame;
  slot.stamp_ns = stamp_ns;
  written_.store(at + 1, std::memory_order_release);
}

void CanLog::WriteOut() {
  const uint64_t end = written_.load(std::memory_order_acquire);
  for (uint64_t at = read_.load(std::memory_order_relaxed); at < end; ++at) {
    const CanFrame& frame = ring_[at % kCapacity];
    if (text_.size() - text_size_ < kMaxCanLogLine) Flush();
    const std::span<char> room(text_.data() + text_size_, text_.size() - text_size_);
    text_size_ += FormatCanLogLine(frame.stamp_ns + wall_offset_ns_, channel_, frame, room);
    read_.store(at + 1, std::memory_order_release);
  }
  Flush();
}

// After a failure the rest is thrown away: the loop goes on, and the error says that the file ends early.
void CanLog::Flush() {
  size_t done = 0;
  while (done < text_size_ && error_.empty()) {
    const ssize_t count = write(file_.get(), text_.data() + done, text_size_ - done);
    if (count >= 0) {
      done += static_cast<size_t>(count);
    } else if (errno != EINTR) {
      error_ = "cannot write " + path_ + ": " + std::strerror(errno);
    }
  }
  text_size_ = 0;
}

CanLogWriter::CanLogWriter(std::vector<CanLog*> logs) : logs_(std::move(logs)), thread_([this] { Run(); }) {}

CanLogWriter::~CanLogWriter() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void CanLogWriter::Run() {
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kWriterNice);  // Linux: of this thread alone
  std::unique_lock lock(mutex_);
  for (bool last = false; !last;) {
    last = wake_.wait_for(lock, kWritePeriod, [this] { return stop_; });
    for (CanLog* log : logs_) log->WriteOut();
  }
}

}  // namespace armada
