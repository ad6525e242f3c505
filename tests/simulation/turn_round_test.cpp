// MARVIN in a corridor of 1.4 m whose way lies behind it: turned across, its whiskers touch both
// walls.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "operations/command_line/installation.hpp"
#include "operations/experiments/commanded_robot.hpp"
#include "operations/experiments/site_facts.hpp"

namespace usher::operations {
namespace {

class TurnRound : public testing::TestWithParam<std::uint64_t> {};

TEST_P(TurnRound, InACorridorWhoseWallsItsWhiskersTouch) {
  const std::string share = std::string(USHER_BINARY_DIR) + "/share/usher";
  const Installation installation{
      .programs = {}, .contracts = share + "/contracts", .share = share};
  auto deployment = load_deployment(share + "/deploy/marvin-sim.yaml", installation, {});
  ASSERT_TRUE(deployment.ok()) << deployment.error();
  set_site_value(*deployment, "site.initial_pose", "[12.6, 10.03, 0.0]");
  const auto robot = lockstep_robot(*deployment, GetParam());
  ASSERT_TRUE(robot.ok()) << robot.error();
  const auto arrival = (*robot)->send("reception", 180.0);
  ASSERT_TRUE(arrival.ok()) << arrival.error();
  EXPECT_TRUE(arrival->reported) << arrival->reason << "\n" << (*robot)->complaints();
  const RunRecord record = (*robot)->take_record();
  bool touched = false;
  for (const auto& sample : record.samples()) touched = touched || !sample.whiskers.empty();
  EXPECT_TRUE(touched) << "else this shows nothing";
  const auto summary = record.summary();
  EXPECT_EQ(summary.contacts + summary.touches, 0U) << summary.contact_with;
}

INSTANTIATE_TEST_SUITE_P(Seeds, TurnRound, testing::Values(1U, 2U, 3U));

}  // namespace
}  // namespace usher::operations
