#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace armada {

/// Debian's programs and libraries that show messages in Java.
inline constexpr const char* kLcmGen = "/usr/bin/lcm-gen";
inline constexpr const char* kLcmSpy = "/usr/bin/lcm-spy";
inline constexpr const char* kLcmJar = "/usr/share/java/lcm.jar";
inline constexpr const char* kJavac = "/usr/bin/javac";
inline constexpr const char* kJar = "/usr/bin/jar";

/// Names of the Debian packages that making the jar of message types needs and the machine lacks. `root` is
/// where the file system begins.
std::vector<std::string> PackagesMissingForJar(const std::filesystem::path& root = "/");

/// The same for lcm-spy itself, its windows included.
std::vector<std::string> PackagesMissingForSpy(const std::filesystem::path& root = "/");

}  // namespace armada
