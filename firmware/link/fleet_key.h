#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace armada {

inline constexpr size_t kFleetKeySize = 32;

/// The secret that the boards, the leader and the operator of one fleet share. Who has it can speak as any of
/// them.
using FleetKey = std::array<uint8_t, kFleetKeySize>;

/// Reads a key: a regular file of 32 bytes that only its owner may read or write, and that belongs to this
/// user or to root. Nothing, with *error set, for any other. Start-up only.
std::optional<FleetKey> LoadFleetKey(const std::string& path, std::string* error);

/// The key of a run in stepped time, where nothing is random. It says of itself that it is no secret.
FleetKey SeededKey(uint64_t seed);
bool IsSeeded(const FleetKey& key);

/// Makes a file with this key, as MakeFleetKey does.
bool WriteFleetKey(const std::string& path, const FleetKey& key, std::string* error);

/// Makes a file with a new random key, mode 0600, on the disk when this returns; never over an existing one.
/// False with *error set.
bool MakeFleetKey(const std::string& path, std::string* error);

}  // namespace armada
