#pragma once

#include <gtest/gtest.h>
#include <sched.h>

#include <string>
#include <thread>

#include "host/private_network.h"

namespace armada {

/// Runs its tests in a network of the test process alone, so that they need no route and disturb no one.
class PrivateNetworkTest : public ::testing::Test {
 protected:
  void SetUp() override {
    static std::string error;
    static const bool entered = EnterPrivateNetwork(&error);
    ASSERT_TRUE(entered) << error;
  }

  /// Calls `body` in a network that has no route at all.
  template <class Body>
  static void WithoutRoutes(Body body) {
    // A namespace belongs to a thread, so that the network of the others stays as it is.
    std::thread([&body] {
      ASSERT_EQ(unshare(CLONE_NEWNET), 0);
      body();
    }).join();
  }
};

}  // namespace armada
