#include "tests/fuzz/edited_text.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>

namespace armada {
namespace {

constexpr size_t kMostBytes = size_t{64} * 1024;  // files stay small, however often a line is repeated

constexpr auto kValues = std::to_array<const char*>({"0",
                                                     "1",
                                                     "-1",
                                                     "2",
                                                     "7",
                                                     "8",
                                                     "64",
                                                     "65",
                                                     "0.0",
                                                     "1e-300",
                                                     "1e-3",
                                                     "0.5",
                                                     "1e3",
                                                     "1e6",
                                                     "1e308",
                                                     "-1e308",
                                                     "nan",
                                                     "inf",
                                                     "-inf",
                                                     "9223372036854775807",
                                                     "-9223372036854775808",
                                                     "true",
                                                     "false",
                                                     "\"\"",
                                                     "\"none\"",
                                                     "\"\\u0000\\U0010FFFF\"",
                                                     "[]",
                                                     "{}",
                                                     "[[]]",
                                                     "[{}]",
                                                     "[1.0, 2.0]",
                                                     "[1.0, 2.0, 3.0]",
                                                     "[1, 2]",
                                                     "1979-05-27"});

std::string NumberText(double number) {
  std::array<char, 40> text;
  std::snprintf(text.data(), text.size(), "%.17g", number);
  return text.data();
}

}  // namespace

EditedText::EditedText(std::string text, const std::vector<std::string>& sources) : text_(std::move(text)) {
  for (const std::string& source : sources) all_ += source;
}

EditedText::Part EditedText::AnyLine(const std::string& text, ByteSource* choices) {
  std::vector<size_t> starts = {0};
  for (size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', end + 1))
    starts.push_back(end + 1);
  starts.push_back(text.size());
  const size_t line = choices->Unsigned(2) % (starts.size() - 1);
  return {starts[line], starts[line + 1] - starts[line]};
}

// What stands behind an equals sign or between the commas of a list.
EditedText::Part EditedText::AnyValue(const std::string& text, ByteSource* choices) {
  std::vector<size_t> starts;
  for (size_t at = text.find_first_of("=[,"); at != std::string::npos; at = text.find_first_of("=[,", at + 1))
    starts.push_back(at + 1);
  if (starts.empty()) return {};
  const size_t begin = starts[choices->Unsigned(2) % starts.size()];
  const size_t end = std::min(text.find_first_of(",]}#\n", begin), text.size());
  return {begin, end - begin};
}

void EditedText::Edit(ByteSource* choices) {
  const auto edit = static_cast<TextEdit>(choices->Byte() % static_cast<int>(TextEdit::kCount));
  switch (edit) {
    case TextEdit::kValue: {
      const Part value = AnyValue(text_, choices);
      return Put(value, std::string(" ") + kValues[choices->Byte() % kValues.size()]);
    }
    case TextEdit::kCopy: {
      const Part value = AnyValue(text_, choices);
      const Part other = AnyValue(all_, choices);
      return Put(value, all_.substr(other.begin, other.size));
    }
    case TextEdit::kScale:
      return Scale(choices);
    case TextEdit::kNumber: {
      const Part value = AnyValue(text_, choices);
      return Put(value, " " + NumberText(choices->Double()));
    }
    case TextEdit::kDelete:
      return Put(AnyLine(text_, choices), "");
    case TextEdit::kRepeat: {
      const Part line = AnyLine(text_, choices);
      return Put({line.begin, 0}, text_.substr(line.begin, line.size));
    }
    case TextEdit::kMove: {
      const Part line = AnyLine(text_, choices);
      const std::string moved = text_.substr(line.begin, line.size);
      Put(line, "");
      return Put({AnyLineStart(choices), 0}, moved);
    }
    case TextEdit::kBorrow: {
      const Part line = AnyLine(all_, choices);
      return Put({AnyLineStart(choices), 0}, all_.substr(line.begin, line.size));
    }
    case TextEdit::kKey:
      return ShortenKey(choices);
    case TextEdit::kInsert:
      return Insert(choices);
    case TextEdit::kCount:
      break;
  }
}

void EditedText::Scale(ByteSource* choices) {
  const Part value = AnyValue(text_, choices);
  const double number = std::strtod(text_.substr(value.begin, value.size).c_str(), nullptr);
  Put(value, " " + NumberText(number * choices->Signed16() / 256.0));
}

void EditedText::ShortenKey(ByteSource* choices) {
  const Part value = AnyValue(text_, choices);
  const size_t last = text_.substr(0, value.begin).find_last_not_of(" =[,");
  if (last != std::string::npos) text_.erase(last, 1);
}

void EditedText::Insert(ByteSource* choices) {
  const size_t at = choices->Unsigned(2) % (text_.size() + 1);
  std::vector<uint8_t> bytes(choices->Byte());
  choices->Take(bytes);
  for (const char of_path : {'/', '\\'}) std::replace(bytes.begin(), bytes.end(), of_path, '?');
  if (text_.size() < kMostBytes) text_.insert(at, std::string(bytes.begin(), bytes.end()));
}

}  // namespace armada
