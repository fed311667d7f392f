#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/spy/message_types.h"

namespace armada {

/// Where Armada keeps what it can make again: `armada` in XDG_CACHE_HOME, else in ~/.cache. Nothing, with the
/// reason in `*error`, where the environment names neither.
std::optional<std::filesystem::path> CacheDirectory(std::string* error);

/// The jar of Java classes of `types` in the folder `cache`, which is made if need be. Its name holds a
/// checksum of the types: a change of theirs makes another jar. It appears whole or not at all, so several
/// programs may want it at once.
std::filesystem::path TypeJarPath(const std::vector<MessageType>& types, const std::filesystem::path& cache);

/// Makes that jar with Debian's lcm-gen, javac and jar, in about two seconds. False, with what the tool said
/// in `*error`, when it cannot be made; nothing else is left in `cache`.
bool MakeTypeJar(const std::vector<MessageType>& types, const std::filesystem::path& cache,
                 std::string* error);

}  // namespace armada
