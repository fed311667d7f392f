#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace armada {

/// Seeds of a sweep, or of one of its shards: first, first + step, and on up to last.
struct SeedRange {
  uint64_t first = 1;
  uint64_t last = 1;
  uint64_t step = 1;

  size_t size() const { return last < first ? 0 : (last - first) / step + 1; }
  uint64_t operator[](size_t i) const { return first + i * step; }
};

/// "A:B", both included; nothing when the text is anything else, or A > B.
std::optional<SeedRange> ParseSeeds(const std::string& text);

/// "I/N": of `seeds` every N-th from the I-th, 1 <= I <= N; nothing when the text is anything else.
std::optional<SeedRange> ShardOf(const SeedRange& seeds, const std::string& text);

}  // namespace armada
