#include "interaction/phrases/core/phrase_file.hpp"

#include <gtest/gtest.h>

#include <array>

#include "support/folder.hpp"

namespace usher::phrases {
namespace {

constexpr std::array<std::string_view, 2> kKeys{"hello", "take"};

class PhraseFile : public testing::Test {
 protected:
  void write(const std::string& tag, const std::string& text) { folder_.file(tag + ".yaml", text); }
  Result<PhraseBook> load(const std::vector<std::string>& tags) {
    return PhraseBook::load(folder_.path(), tags, "guide", kKeys);
  }
  void expect_error(const std::string& text, const std::string& part) {
    write("de", text);
    const auto book = load({"en", "de"});
    ASSERT_FALSE(book.ok()) << text;
    EXPECT_NE(book.error().find(part), std::string::npos) << book.error();
    EXPECT_NE(book.error().find("de.yaml"), std::string::npos) << book.error();
  }
  void SetUp() override {
    write("en",
          "language: {tag: en, name: English}\nguide: {hello: Hello, take: \"To {place}\"}\n");
  }
  test::Folder folder_;
};

TEST_F(PhraseFile, GivesPhrasesByLanguageAndKey) {
  write("de", "language: {tag: de, name: Deutsch}\nguide: {take: \"{place}!\", hello: Hallo}\n");
  const auto book = load({"en", "de"});
  ASSERT_TRUE(book.ok()) << book.error();
  EXPECT_EQ(book->phrase(book->find("de"), 0), "Hallo");
  EXPECT_EQ(book->phrase(book->find("de"), 1), "{place}!");
  EXPECT_EQ(book->languages()[1].name, "Deutsch");
  EXPECT_EQ(book->find("xx"), 0U);
}

TEST_F(PhraseFile, RefusesWhatDoesNotFit) {
  expect_error("", "language");
  expect_error("][", "de.yaml");
  expect_error("language: {tag: de}\nguide: {}\n", "'name'");
  expect_error("language: {tag: fr, name: x}\nguide: {hello: a, take: \"{place}\"}\n", "tag 'de'");
  expect_error("language: {tag: de, name: x}\n", "'guide'");
  expect_error("language: {tag: de, name: x}\nguide: {hello: a}\n", "guide.take");
  expect_error("language: {tag: de, name: x}\nguide: {hello: a, take: b}\n", "placeholders");
  expect_error("language: {tag: de, name: x}\nguide: {hello: '', take: \"{place}\"}\n", "'hello'");
  expect_error("language: {tag: de, name: x}\nguide: {hello: [a], take: \"{place}\"}\n", "'hello'");
  expect_error("language: {tag: de, name: x}\nguide: {hello: a, take: \"{place}\", bye: b}\n",
               "nobody says 'guide.bye'");
  EXPECT_FALSE(load({}).ok());
  EXPECT_FALSE(load({"en", "en"}).ok());
  EXPECT_FALSE(load({"xx"}).ok());
}

TEST_F(PhraseFile, NamesEveryMisprintWithItsLine) {
  write("de",
        "language: {tag: de, name: Deutsch}\nguide:\n  hallo: Hallo\n  take: \"Nach {ort}\"\n");
  std::vector<std::string> found;
  for (const auto& [origin, text] :
       PhraseBook::misprints(folder_.path(), {"en", "de"}, "guide", kKeys))
    found.push_back(origin.substr(folder_.path().size() + 1) + ": " + text);
  EXPECT_EQ(found, (std::vector<std::string>{
                       "de.yaml:3: 'guide.hello' is missing",
                       "de.yaml:4: 'take' must have the placeholders of \"To {place}\", got "
                       "\"Nach {ort}\"",
                       "de.yaml:3: nobody says 'guide.hallo'"}));
  EXPECT_TRUE(PhraseBook::misprints(folder_.path(), {"en"}, "guide", kKeys).empty());
}

TEST(Phrases, FillsPlaceholders) {
  EXPECT_EQ(filled("{a} to {b}, {a}", {{"a", "x{a}"}, {"b", "y"}}), "x{a} to y, x{a}");
  EXPECT_EQ(placeholders("{b} {a} {b} {"), (std::vector<std::string>{"a", "b"}));
}

}  // namespace
}  // namespace usher::phrases
