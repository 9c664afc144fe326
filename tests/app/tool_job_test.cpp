#include "app/engine/tool_job.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace fascia::app {
namespace {

TEST(ToolJob, ReportsItsResultAndCanBeCancelled) {
  const auto wait = [](ToolJob& job) {
    for (int i = 0; i < 1000 && !job.poll(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
  };
  ToolJob good("/bin/sh", {"-c", "echo out; echo err >&2; exit 4"}, "good");
  wait(good);
  EXPECT_TRUE(good.is_done());
  EXPECT_EQ(good.exit_code(), 4);
  EXPECT_EQ(good.output(), "out\n");
  EXPECT_EQ(good.message(), "err\n");
  ToolJob slow("/bin/sleep", {"100"}, "slow");
  EXPECT_FALSE(slow.poll());
  slow.cancel();
  wait(slow);
  EXPECT_TRUE(slow.was_cancelled());
  EXPECT_NE(slow.exit_code(), 0);
}

}  // namespace
}  // namespace fascia::app
