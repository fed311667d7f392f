#include "host/can/candump_reader.h"

#include <charconv>
#include <optional>

namespace armada {
namespace {

// Flags that linux/can.h keeps beside the identifier and in an FD frame.
constexpr uint32_t kErrorFlag = 0x2000'0000;
constexpr unsigned kFdBitrateSwitch = 1;
constexpr unsigned kFdErrorState = 2;

template <class Number>
std::optional<Number> Parse(std::string_view text, int base) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// The text up to `separator`, which goes, too; all that is left when there is none.
std::string_view Take(std::string_view* text, char separator) {
  const size_t at = text->find(separator);
  const std::string_view taken = text->substr(0, at);
  *text = at == std::string_view::npos ? std::string_view() : text->substr(at + 1);
  return taken;
}

bool ParseTime(std::string_view text, int64_t* time_ns) {
  constexpr size_t kDigits = 9;
  std::string_view rest = text;
  const auto seconds = Parse<int64_t>(Take(&rest, '.'), 10);
  const auto fraction = Parse<uint32_t>(rest, 10);
  if (!seconds || !fraction || *seconds < 0 || *seconds > INT64_MAX / 1'000'000'001 ||
      rest.size() > kDigits) {
    return false;
  }
  int64_t fraction_ns = *fraction;
  for (size_t i = rest.size(); i < kDigits; ++i) fraction_ns *= 10;
  *time_ns = *seconds * 1'000'000'000 + fraction_ns;
  return true;
}

bool ParseId(std::string_view text, CanFrame* frame) {
  const auto id = Parse<uint32_t>(text, 16);
  if (!id || (text.size() != 3 && text.size() != 8)) return false;
  frame->error = text.size() == 8 && (*id & kErrorFlag) != 0;
  frame->id = frame->error ? *id & ~kErrorFlag : *id;
  frame->extended = text.size() == 8 && !frame->error;
  return true;
}

bool ParseData(std::string_view text, CanFrame* frame) {
  if (text.size() % 2 != 0 || text.size() > 2 * frame->data.size()) return false;
  for (size_t i = 0; i < text.size(); i += 2) {
    const auto byte = Parse<uint8_t>(text.substr(i, 2), 16);
    if (!byte) return false;
    frame->data[frame->length++] = *byte;
  }
  return true;
}

bool ParseFrame(std::string_view text, CanFrame* frame) {
  if (!ParseId(Take(&text, '#'), frame)) return false;
  if (text.starts_with('#')) {
    if (text.size() < 2) return false;
    const auto flags = Parse<unsigned>(text.substr(1, 1), 16);
    if (!flags) return false;
    frame->fd = true;
    frame->bitrate_switch = (*flags & kFdBitrateSwitch) != 0;
    frame->error_state_indicator = (*flags & kFdErrorState) != 0;
    return ParseData(text.substr(2), frame);
  }
  if (text.starts_with('R')) {
    frame->remote = true;
    if (text.size() == 1) return true;
    const auto length = Parse<uint8_t>(text.substr(1), 10);
    if (length) frame->length = *length;
    return length.has_value();
  }
  return ParseData(text, frame);
}

}  // namespace

bool ParseCandumpLine(std::string_view text, CandumpLine* line) {
  CandumpLine read;
  if (text.ends_with('\r')) text.remove_suffix(1);
  std::string_view time = Take(&text, ' ');
  if (time.size() < 3 || !time.starts_with('(') || !time.ends_with(')')) return false;
  if (!ParseTime(time.substr(1, time.size() - 2), &read.time_ns)) return false;
  read.channel = Take(&text, ' ');
  if (read.channel.empty() || text.find('#') == std::string_view::npos) return false;
  if (!ParseFrame(Take(&text, ' '), &read.frame) || !IsValid(read.frame)) return false;
  *line = read;
  return true;
}

}  // namespace armada
