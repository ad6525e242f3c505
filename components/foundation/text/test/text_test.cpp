#include <gtest/gtest.h>

#include "foundation/text/edits.hpp"
#include "foundation/text/shortened.hpp"

namespace usher {
namespace {

TEST(Shortened, CutsBetweenLetters) {
  const std::string kitchen = "K\xC3\xBC";  // and an umlaut of two bytes
  EXPECT_EQ(shortened("kitchen", 7), "kitchen");
  EXPECT_EQ(shortened("kitchen", 3), "kit");
  EXPECT_EQ(shortened(kitchen + "che", 3), kitchen);
  EXPECT_EQ(shortened(kitchen + "che", 2), "K");
  EXPECT_EQ(shortened("\xC3\xBC", 1), "");
}

TEST(Edits, CountInsertedDeletedAndChangedLetters) {
  EXPECT_EQ(edits("amcl", "amcl"), 0U);
  EXPECT_EQ(edits("amcl", "acml"), 2U);
  EXPECT_EQ(edits("", "amcl"), 4U);
  EXPECT_EQ(edits("kitten", "sitting"), 3U);
}

}  // namespace
}  // namespace usher
