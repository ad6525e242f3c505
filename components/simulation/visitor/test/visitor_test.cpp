#include "simulation/visitor/core/visitor.hpp"

#include <gtest/gtest.h>

namespace usher::visitor {
namespace {

TEST(Visitor, ReadsBeforeAnsweringAndAnswersOnce) {
  Visitor visitor("kitchen", 2.0);
  visitor.see({1, "guide_options", {"lab", "kitchen", "cancel"}}, 10.0);
  EXPECT_FALSE(visitor.answer(11.9));
  EXPECT_EQ(visitor.answer(12.0), "kitchen");
  EXPECT_FALSE(visitor.answer(13.0));
}

TEST(Visitor, TurnsPagesUntilTheDestinationIsOffered) {
  Visitor visitor("kitchen", 0.0);
  visitor.see({1, "guide_options", {"lab", "more", "cancel"}}, 0.0);
  EXPECT_EQ(visitor.answer(0.0), "more");
  visitor.see({2, "guide_options", {"kitchen", "cancel"}}, 1.0);
  EXPECT_EQ(visitor.answer(1.0), "kitchen");
}

TEST(Visitor, NeverStopsOrCancelsByItself) {
  Visitor visitor("kitchen", 0.0);
  visitor.see({1, "guide_active", {"stop", "cancel"}}, 0.0);
  EXPECT_FALSE(visitor.answer(100.0));
  EXPECT_TRUE(visitor.follows());
}

TEST(Visitor, ThanksAfterTheArrival) {
  Visitor visitor("kitchen", 0.0);
  visitor.see({1, "guide_active", {"stop"}}, 0.0);
  visitor.see({2, "guide_success", {}}, 1.0);
  EXPECT_TRUE(visitor.arrived());
  visitor.see({3, "end_ask", {"yes", "no"}}, 2.0);
  EXPECT_EQ(visitor.answer(2.0), "no");
  visitor.see({4, "end", {}}, 3.0);
  EXPECT_FALSE(visitor.follows());
}

}  // namespace
}  // namespace usher::visitor
