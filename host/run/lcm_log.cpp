#include "host/run/lcm_log.h"

#include <array>
#include <cerrno>
#include <cstring>

namespace armada {
namespace {

constexpr uint32_t kSync = 0xEDA1DA01;  // lcm/eventlog.c
constexpr size_t kHeader = 28;

template <class Number>
uint8_t* PutBe(Number number, uint8_t* to) {
  for (size_t i = 0; i < sizeof number; ++i)
    to[i] = static_cast<uint8_t>(number >> 8 * (sizeof number - 1 - i));
  return to + sizeof number;
}

}  // namespace

std::unique_ptr<LcmLog> LcmLog::Create(const std::string& path, std::string* error) {
  File file(std::fopen(path.c_str(), "we"), std::fclose);
  if (file != nullptr) return std::unique_ptr<LcmLog>(new LcmLog(std::move(file), path));
  *error = "cannot write " + path + ": " + std::strerror(errno);
  return nullptr;
}

// Sync word, number, time in us, sizes of channel and data; all big-endian.
void LcmLog::Write(const LcmMessage& message, int64_t wall_ns) {
  std::array<uint8_t, kHeader> header{};
  uint8_t* at = PutBe(kSync, header.data());
  at = PutBe(static_cast<uint64_t>(events_++), at);
  at = PutBe(static_cast<uint64_t>(wall_ns / 1000), at);
  at = PutBe(static_cast<uint32_t>(message.channel.size()), at);
  PutBe(static_cast<uint32_t>(message.payload.size()), at);
  Put(header.data(), header.size());
  Put(message.channel.data(), message.channel.size());
  Put(message.payload.data(), message.payload.size());
}

void LcmLog::Put(const void* bytes, size_t size) {
  if (failure_ == 0 && std::fwrite(bytes, 1, size, file_.get()) != size) failure_ = errno;
}

bool LcmLog::Close(std::string* error) {
  if (std::fflush(file_.get()) != 0 && failure_ == 0) failure_ = errno;
  if (failure_ == 0) return true;
  *error = "cannot write " + path_ + ": " + std::strerror(failure_);
  return false;
}

}  // namespace armada
