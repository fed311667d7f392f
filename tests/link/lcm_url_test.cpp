#include "firmware/link/lcm_url.h"

#include <gtest/gtest.h>

namespace armada {
namespace {

TEST(LcmUrl, NamesGroupPortAndTtl) {
  std::string error;
  const auto url = ParseLcmUrl("udpm://239.1.2.3:7700?ttl=1", &error);
  ASSERT_TRUE(url) << error;
  EXPECT_EQ(url->group, "239.1.2.3");
  EXPECT_EQ(url->port, 7700);
  EXPECT_EQ(url->ttl, 1);
  EXPECT_EQ(ToString(*url), "udpm://239.1.2.3:7700?ttl=1");
}

TEST(LcmUrl, WithoutTtlStaysOnTheHost) {
  std::string error;
  const auto url = ParseLcmUrl("udpm://239.255.76.67:7667", &error);
  ASSERT_TRUE(url) << error;
  EXPECT_EQ(ToString(*url), ToString(LcmUrl()));
  EXPECT_EQ(ToString(*url), "udpm://239.255.76.67:7667?ttl=0");
}

struct BadUrl {
  const char* text;
  const char* complaint;
};

constexpr BadUrl kBadUrls[] = {
    {"", "does not start with udpm://"},
    {"tcpq://localhost:7700", "does not start with udpm://"},
    {"udpm://", "no port"},
    {"udpm://239.255.76.67", "no port"},
    {"udpm://192.168.0.1:7667", "group \"192.168.0.1\" is not in 224.0.0.0 to"},
    {"udpm://group:7667", "group \"group\""},
    {"udpm://239.255.76.67:0", "port \"0\" is not in 1 to 65535"},
    {"udpm://239.255.76.67:65536", "port \"65536\""},
    {"udpm://239.255.76.67:99999999999", "port \"99999999999\""},
    {"udpm://239.255.76.67:76x", "port \"76x\""},
    {"udpm://239.255.76.67:", "port \"\""},
    {"udpm://239.255.76.67:7667?", "nothing after \"?\""},
    {"udpm://239.255.76.67:7667?ttl=256", "ttl \"256\" is not in 0 to 255"},
    {"udpm://239.255.76.67:7667?ttl=-1", "ttl \"-1\""},
    {"udpm://239.255.76.67:7667?ttl=", "ttl \"\""},
    {"udpm://239.255.76.67:7667?hops=1", "unknown option \"hops=1\""},
};

TEST(LcmUrl, IsRefusedWithWhatWasGivenAndWhatIsAllowed) {
  for (const BadUrl& bad : kBadUrls) {
    std::string error;
    EXPECT_FALSE(ParseLcmUrl(bad.text, &error)) << bad.text;
    const std::string given = std::string("LCM URL \"").append(bad.text).append("\": ");
    EXPECT_EQ(error.substr(0, given.size()), given) << error;
    EXPECT_NE(error.find(bad.complaint), std::string::npos) << error;
    EXPECT_NE(error.find("for example udpm://239.255.76.67:7667?ttl=0"), std::string::npos) << error;
  }
}

}  // namespace
}  // namespace armada
