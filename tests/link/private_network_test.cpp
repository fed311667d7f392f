#include "host/private_network.h"

#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "tests/link/private_network_fixture.h"

namespace armada {
namespace {

// Exit code of a child process that calls `body`.
template <class Body>
int InChild(Body body) {
  const pid_t child = fork();
  if (child == 0) _exit(body() ? EXIT_SUCCESS : EXIT_FAILURE);
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool EnterAndProbe() {
  std::string error;
  if (!EnterPrivateNetwork(&error)) std::fprintf(stderr, "%s\n", error.c_str());
  return error.empty() && HasMulticastRoute();
}

class PrivateNetwork : public PrivateNetworkTest {};

TEST_F(PrivateNetwork, CarriesMulticast) {
  EXPECT_TRUE(HasMulticastRoute());
}

TEST_F(PrivateNetwork, IsInheritedByChildren) {
  EXPECT_EQ(InChild([] { return HasMulticastRoute(); }), EXIT_SUCCESS);
}

TEST_F(PrivateNetwork, MayBeNested) {
  EXPECT_EQ(InChild(EnterAndProbe), EXIT_SUCCESS);
}

TEST_F(PrivateNetwork, NeedsNoRoot) {
  if (geteuid() != 0) GTEST_SKIP() << "every test here runs without root already";
  constexpr uid_t kNobody = 65534;
  EXPECT_EQ(InChild([] {
              // A change of user makes the child's /proc files root's; a program started by a user has its
              // own.
              return setresgid(kNobody, kNobody, kNobody) == 0 && setresuid(kNobody, kNobody, kNobody) == 0 &&
                     prctl(PR_SET_DUMPABLE, 1) == 0 && EnterAndProbe() && geteuid() == kNobody;
            }),
            EXIT_SUCCESS);
}

TEST_F(PrivateNetwork, ProbeFailsWhereThereIsNoRoute) {
  WithoutRoutes([] { EXPECT_FALSE(HasMulticastRoute()); });
}

}  // namespace
}  // namespace armada
