#include "host/sweep/seed_range.h"

#include <charconv>

namespace armada {
namespace {

// "<first><separator><second>" as two numbers.
bool ParsePair(const std::string& text, char separator, uint64_t* first, uint64_t* second) {
  const char* end = text.data() + text.size();
  auto [middle, code] = std::from_chars(text.data(), end, *first);
  if (code != std::errc() || middle == end || *middle != separator) return false;
  auto [rest, second_code] = std::from_chars(middle + 1, end, *second);
  return second_code == std::errc() && rest == end;
}

}  // namespace

std::optional<SeedRange> ParseSeeds(const std::string& text) {
  SeedRange seeds;
  if (!ParsePair(text, ':', &seeds.first, &seeds.last) || seeds.last < seeds.first) return std::nullopt;
  return seeds;
}

std::optional<SeedRange> ShardOf(const SeedRange& seeds, const std::string& text) {
  uint64_t shard = 0;
  uint64_t shards = 0;
  if (!ParsePair(text, '/', &shard, &shards) || shard < 1 || shard > shards) return std::nullopt;
  return SeedRange{seeds.first + (shard - 1) * seeds.step, seeds.last, seeds.step * shards};
}

}  // namespace armada
