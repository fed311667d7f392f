#include "host/can/decode.h"

#include <array>
#include <cstdio>

#include "hil/can_log.h"

namespace armada {
namespace {

std::string Label(const BusMessage& message) {
  return (message.owner.empty() ? "" : message.owner + ' ') + message.message.name;
}

std::string Value(const CanFrame& frame, const CanSignal& signal) {
  char text[48];
  const bool is_integer =
      signal.kind != CanSignal::Kind::kFloat32 && signal.scale == 1.0 && signal.offset == 0.0;
  std::snprintf(text, sizeof text, is_integer ? "%.0f" : "%.7g", GetPhysical(frame, signal));
  const std::string unit = signal.unit;
  return ' ' + std::string(signal.name) + '=' + text + (unit.empty() ? "" : ' ' + unit);
}

}  // namespace

std::string Decode(std::span<const BusMessage> messages, const CanFrame& frame) {
  if (frame.error) return "error frame: " + ErrorClassName(frame.id) + "  " + RawText(frame);
  const BusMessage* const found = FindMessage(messages, frame);
  if (found == nullptr) return "unknown  " + RawText(frame);
  if (frame.remote) return Label(*found) + " asked for";
  if (frame.length < found->message.length) {
    return Label(*found) + " too short: " + std::to_string(frame.length) + " of " +
           std::to_string(found->message.length) + " bytes  " + RawText(frame);
  }
  std::string text = Label(*found);
  for (const CanSignal& signal : found->message.signals) text += Value(frame, signal);
  return text;
}

std::string ErrorClassName(uint32_t error_class) {
  constexpr std::array<const char*, 10> kNames = {"transmit time-out",
                                                  "lost arbitration",
                                                  "controller problem",
                                                  "protocol violation",
                                                  "transceiver problem",
                                                  "no acknowledgement",
                                                  "bus off",
                                                  "bus error",
                                                  "restarted",
                                                  "error counters"};
  std::string text;
  for (size_t bit = 0; bit < kNames.size(); ++bit) {
    if ((error_class >> bit & 1) != 0) text += (text.empty() ? "" : ", ") + std::string(kNames[bit]);
  }
  return text.empty() ? "unspecified" : text;
}

std::string RawText(const CanFrame& frame) {
  std::array<char, kMaxCanLogLine> line{};
  const size_t size = FormatCanLogLine(0, "-", frame, line);
  const std::string_view text(line.data(), size - 1);
  return std::string(text.substr(text.rfind(' ') + 1));
}

}  // namespace armada
