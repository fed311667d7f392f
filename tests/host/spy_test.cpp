#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>

#include "host/spy/java_packages.h"
#include "host/spy/type_jar.h"

namespace armada {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Spy : public ::testing::Test {
 protected:
  Spy() {
    std::string name = ::testing::TempDir() + "armada_spy_XXXXXX";
    folder_ = mkdtemp(name.data());
  }
  ~Spy() override { fs::remove_all(folder_); }

  void Touch(const std::string& file) const {
    fs::create_directories((folder_ / file).parent_path());
    std::ofstream(folder_ / file).flush();
  }

  size_t FilesLeft() const {
    return static_cast<size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
};

TEST_F(Spy, AnotherFieldOfATypeMakesAnotherJarBesideTheFirst) {
  const std::vector<MessageType> before = {{"point_t.lcm", "package armada; struct point_t { double x_m; }"}};
  const std::vector<MessageType> after = {{"point_t.lcm", "package armada; struct point_t { double y_m; }"}};
  std::string error;
  ASSERT_TRUE(MakeTypeJar(before, folder_, &error)) << error;
  EXPECT_TRUE(fs::exists(TypeJarPath(before, folder_)));
  EXPECT_FALSE(fs::exists(TypeJarPath(after, folder_)));
  ASSERT_TRUE(MakeTypeJar(after, folder_, &error)) << error;
  EXPECT_TRUE(fs::exists(TypeJarPath(after, folder_)));
  EXPECT_EQ(FilesLeft(), 2U);
}

TEST_F(Spy, AFileOfAnotherNameIsAnotherType) {
  EXPECT_NE(TypeJarPath({{"a.lcm", "text"}}, folder_), TypeJarPath({{"b.lcm", "text"}}, folder_));
  EXPECT_NE(TypeJarPath({{"a.lcm", "text"}}, folder_), TypeJarPath({{"a.lcmt", "ext"}}, folder_));
}

TEST_F(Spy, ATypeThatLcmGenRefusesIsReportedWithWhatItSaid) {
  std::string error;
  EXPECT_FALSE(MakeTypeJar({{"broken_t.lcm", "struct broken_t { double }"}}, folder_, &error));
  EXPECT_THAT(error, HasSubstr("lcm-gen"));
  EXPECT_THAT(error, HasSubstr("broken_t.lcm"));
  EXPECT_EQ(FilesLeft(), 0U);
}

TEST_F(Spy, ACacheThatCannotBeWrittenIsNamed) {
  Touch("file");
  std::string error;
  EXPECT_FALSE(MakeTypeJar({}, folder_ / "file", &error));
  EXPECT_THAT(error, HasSubstr((folder_ / "file").string()));
}

TEST_F(Spy, MissingPackagesAreNamedOnceEach) {
  EXPECT_THAT(PackagesMissingForJar(folder_),
              ElementsAre("liblcm-bin", "liblcm-java", "default-jdk-headless"));
  EXPECT_THAT(PackagesMissingForSpy(folder_),
              ElementsAre("liblcm-bin", "liblcm-java", "libjchart2d-java", "default-jre"));
}

TEST_F(Spy, AJavaWithoutWindowsIsNotEnoughForTheSpy) {
  for (const char* file :
       {"usr/bin/lcm-spy", "usr/share/java/lcm.jar", "usr/share/java/jchart2d.jar", "usr/lib/jvm/bin/java"}) {
    Touch(file);
  }
  fs::create_symlink(folder_ / "usr/lib/jvm/bin/java", folder_ / "usr/bin/java");
  EXPECT_THAT(PackagesMissingForSpy(folder_), ElementsAre("default-jre"));
  Touch("usr/lib/jvm/lib/libawt_xawt.so");
  EXPECT_THAT(PackagesMissingForSpy(folder_), IsEmpty());
}

}  // namespace
}  // namespace armada
