#include "host/spy/java_packages.h"

#include <algorithm>

namespace armada {
namespace {

namespace fs = std::filesystem;

struct Requirement {
  const char* file;
  const char* package;
};

std::vector<std::string> Missing(const fs::path& root, const std::vector<Requirement>& requirements) {
  std::vector<std::string> packages;
  for (const auto& [file, package] : requirements) {
    std::error_code ignored;
    if (fs::exists(root / fs::path(file).relative_path(), ignored)) continue;
    if (std::find(packages.begin(), packages.end(), package) == packages.end())
      packages.emplace_back(package);
  }
  return packages;
}

// A Java without windows has everything but this library, which lies beside it.
bool JavaHasWindows(const fs::path& root) {
  std::error_code error;
  const fs::path java = fs::canonical(root / "usr/bin/java", error);
  return !error && fs::exists(java.parent_path().parent_path() / "lib/libawt_xawt.so", error);
}

}  // namespace

std::vector<std::string> PackagesMissingForJar(const fs::path& root) {
  return Missing(root, {{kLcmGen, "liblcm-bin"},
                        {kLcmJar, "liblcm-java"},
                        {kJavac, "default-jdk-headless"},
                        {kJar, "default-jdk-headless"}});
}

std::vector<std::string> PackagesMissingForSpy(const fs::path& root) {
  auto packages = Missing(root, {{kLcmSpy, "liblcm-bin"},
                                 {kLcmJar, "liblcm-java"},
                                 {"/usr/share/java/jchart2d.jar", "libjchart2d-java"}});
  if (!JavaHasWindows(root)) packages.emplace_back("default-jre");
  return packages;
}

}  // namespace armada
