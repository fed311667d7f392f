#include "firmware/link/seal.h"

#include <sodium.h>

#include <algorithm>
#include <cassert>
#include <tuple>

namespace armada {
namespace {

constexpr char kContext[crypto_kdf_CONTEXTBYTES + 1] = "armadaLK";
static_assert(crypto_kdf_KEYBYTES == kFleetKeySize && crypto_generichash_KEYBYTES == kFleetKeySize &&
              crypto_generichash_BYTES_MIN <= kSealTagSize);

using Tag = std::array<uint8_t, kSealTagSize>;

// libsodium's key derivation: BLAKE2b keyed with the fleet's key, the sender's number as its salt.
FleetKey DeriveKey(const FleetKey& fleet_key, int sender) {
  FleetKey key{};
  crypto_kdf_derive_from_key(key.data(), key.size(), static_cast<uint64_t>(sender), kContext,
                             fleet_key.data());
  return key;
}

void WriteBe64(uint64_t value, uint8_t* to) {
  for (int i = 0; i < 8; ++i) to[i] = static_cast<uint8_t>(value >> (56 - 8 * i));
}

uint64_t ReadBe64(const uint8_t* from) {
  uint64_t value = 0;
  for (int i = 0; i < 8; ++i) value = value << 8 | from[i];
  return value;
}

// `times` are the seal's first 16 bytes.
Tag TagOf(const FleetKey& key, const uint8_t* times, std::string_view channel,
          std::span<const uint8_t> payload) {
  crypto_generichash_state state;
  const auto channel_size = static_cast<uint8_t>(channel.size());
  crypto_generichash_init(&state, key.data(), key.size(), kSealTagSize);
  crypto_generichash_update(&state, times, kSealSize - kSealTagSize);
  crypto_generichash_update(&state, &channel_size, 1);
  crypto_generichash_update(&state, reinterpret_cast<const uint8_t*>(channel.data()), channel.size());
  crypto_generichash_update(&state, payload.data(), payload.size());
  Tag tag;
  crypto_generichash_final(&state, tag.data(), tag.size());
  return tag;
}

}  // namespace

Sealer::Sealer(const LinkIdentity& identity, int sender)
    : key_(DeriveKey(identity.key, sender)), epoch_(identity.epoch) {}

std::span<const uint8_t> Sealer::Seal(std::string_view channel, std::span<const uint8_t> message,
                                      MessageBuffer* buffer) {
  assert(message.data() == buffer->data() && message.size() + kSealSize <= buffer->size());
  uint8_t* const seal = buffer->data() + message.size();
  WriteBe64(epoch_, seal);
  WriteBe64(++count_, seal + 8);
  const Tag tag = TagOf(key_, seal, channel, message);
  std::copy(tag.begin(), tag.end(), seal + 16);
  return std::span(*buffer).first(message.size() + kSealSize);
}

SealCheck::SealCheck(const FleetKey& fleet_key, int sender) : key_(DeriveKey(fleet_key, sender)) {}

SealVerdict SealCheck::Open(std::string_view channel, std::span<const uint8_t>* message) {
  if (message->size() < kSealSize) return SealVerdict::kForged;
  const std::span<const uint8_t> payload = message->first(message->size() - kSealSize);
  const uint8_t* const seal = message->data() + payload.size();
  const Tag tag = TagOf(key_, seal, channel, payload);
  if (sodium_memcmp(tag.data(), seal + 16, tag.size()) != 0) return SealVerdict::kForged;
  const uint64_t epoch = ReadBe64(seal);
  const uint64_t count = ReadBe64(seal + 8);
  if (std::tie(epoch, count) <= std::tie(epoch_, count_)) return SealVerdict::kReplayed;
  epoch_ = epoch;
  count_ = count;
  *message = payload;
  return SealVerdict::kGenuine;
}

}  // namespace armada
