#include "tasks/guide/core/visit_log.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace usher::guide {
namespace {

Visit visit() {
  Visit visit;
  visit.id = 7;
  visit.outcome = Outcome::kArrived;
  visit.place = "lab \"1\", west";
  visit.greeted = true;
  visit.touches = 5;
  visit.started = visit.arrived = 1;
  visit.waits = 2;
  visit.duration = std::chrono::milliseconds(61900);
  visit.ratings = {5, 0, 3};
  return visit;
}

TEST(VisitLog, HasALineForEachVisit) {
  VisitLog log;
  log.add(visit(), "de", 1000.4);
  const std::string& text = log.text();
  EXPECT_EQ(text.substr(text.find('\n') + 1),
            "1000,7,de,arrived,\"lab \"\"1\"\", west\",1,1,1,1,5,0,61,2,5,,3,,,,,,,,,,\n");
  const auto columns = std::count(text.begin(), text.begin() + text.find('\n'), ',');
  EXPECT_EQ(columns, 12 + 13);
}

TEST(VisitLog, GoesOnFromWhatWasKept) {
  VisitLog before;
  before.add(visit(), "en", 1.0);
  VisitLog after(before.text());
  after.add(visit(), "en", 2.0);
  EXPECT_EQ(std::count(after.text().begin(), after.text().end(), '\n'), 3);
  EXPECT_EQ(VisitLog("something else\n1,2\n").text(), VisitLog().text());
  EXPECT_EQ(VisitLog("").text(), VisitLog().text());
}

TEST(VisitLog, LosesTheOldestWhenItIsLong) {
  VisitLog log;
  Visit many = visit();
  many.place = std::string(4000, 'x');
  for (std::uint64_t i = 1; i <= 200; ++i) {
    many.id = i;
    log.add(many, "en", 0.0);
  }
  EXPECT_LE(log.text().size(), 512U * 1024U);
  EXPECT_TRUE(log.text().starts_with("time,visit"));
  EXPECT_EQ(log.text().find("\n0,1,en"), std::string::npos);
  EXPECT_NE(log.text().find("\n0,200,en"), std::string::npos);
}

}  // namespace
}  // namespace usher::guide
