#pragma once

#include <string>
#include <vector>

#include "tests/fuzz/byte_source.h"

namespace armada {

/// What an input of the fuzzers of configuration files tells to do to a file: a byte, then the bytes that the
/// edit reads. Which line or value is 2 bytes.
enum class TextEdit : uint8_t {
  kValue,   ///< a value becomes one that is likely to matter: 1 byte, which
  kCopy,    ///< a value becomes another one of the file or of the files of its kind
  kScale,   ///< a number is multiplied: 2 bytes, 256 for 1
  kNumber,  ///< a value becomes any number: 8 bytes
  kDelete,  ///< a line goes
  kRepeat,  ///< a line comes twice
  kMove,    ///< a line goes elsewhere: 2 bytes, where
  kBorrow,  ///< a line of one of the files is put in: 2 bytes, where
  kKey,     ///< a key loses its last letter
  kInsert,  ///< any bytes come in: 2 bytes, where; 1 byte, how many; then they. They name no other file
  kCount,
};

/// A configuration file, edited: what is wrong with a file is more often a value or a line than its syntax.
class EditedText {
 public:
  /// `sources`: files of its kind.
  EditedText(std::string text, const std::vector<std::string>& sources);

  /// One edit, as the choices say.
  void Edit(ByteSource* choices);

  const std::string& text() const { return text_; }

 private:
  struct Part {
    size_t begin = 0;
    size_t size = 0;
  };

  static Part AnyLine(const std::string& text, ByteSource* choices);
  static Part AnyValue(const std::string& text, ByteSource* choices);
  size_t AnyLineStart(ByteSource* choices) const { return AnyLine(text_, choices).begin; }
  void Put(const Part& part, const std::string& replacement) {
    text_.replace(part.begin, part.size, replacement);
  }
  void Scale(ByteSource* choices);
  void ShortenKey(ByteSource* choices);
  void Insert(ByteSource* choices);

  std::string text_;
  std::string all_;  ///< the sources, one after the other
};

}  // namespace armada
