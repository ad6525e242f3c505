#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <tuple>

#include "idl/topics.hpp"
#include "runtime/api/message_type.hpp"

namespace usher::topics {
namespace {

struct Entry {
  std::string name, writers, text, type;
  Kind kind = Kind::kStream;
  int depth = 0;
  double rate_hz = 0.0;
};

std::vector<Entry> entries() {
  std::vector<Entry> result;
  std::apply(
      [&](const auto&... topic) {
        (result.push_back(
             {std::string(topic.name), std::string(topic.writers), std::string(topic.text),
              std::string(
                  runtime::message_type<typename std::decay_t<decltype(topic)>::Message>().name),
              topic.kind, topic.depth, topic.rate_hz}),
         ...);
      },
      kAll);
  return result;
}

std::string catalogue_text() {
  std::ifstream stream(std::filesystem::path(USHER_SOURCE_DIR) / "idl/topics.hpp");
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

TEST(Catalogue, ListsEveryTopicOnce) {
  const std::string text = std::regex_replace(catalogue_text(), std::regex("\\s+"), " ");
  const auto list = text.find("kAll = std::tie(");
  ASSERT_NE(list, std::string::npos);
  const std::regex declaration(R"(inline constexpr Topic<[\w:]+> (k\w+)\{)");
  std::size_t declared = 0;
  for (auto match = std::sregex_iterator(text.begin(), text.end(), declaration);
       match != std::sregex_iterator(); ++match) {
    ++declared;
    const std::regex name("\\b" + (*match)[1].str() + "\\b");
    const std::string all = text.substr(list);
    const auto count =
        std::distance(std::sregex_iterator(all.begin(), all.end(), name), std::sregex_iterator());
    EXPECT_EQ(count, 1) << (*match)[1] << " in kAll";
  }
  EXPECT_EQ(declared, entries().size());
  EXPECT_GT(declared, 40U);
}

TEST(Catalogue, NamesAreUniqueAndSnakeCase) {
  std::set<std::string> names;
  const std::regex form("[a-z][a-z0-9_]*(/[a-z][a-z0-9_]*)*");
  for (const Entry& entry : entries()) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name << " is there twice";
    EXPECT_TRUE(std::regex_match(entry.name, form)) << entry.name;
  }
}

TEST(Catalogue, EveryTopicSaysWhatItIs) {
  for (const Entry& entry : entries()) {
    EXPECT_TRUE(entry.text.ends_with(".")) << entry.name << ": " << entry.text;
    EXPECT_FALSE(entry.type.empty()) << entry.name;
    EXPECT_GE(entry.rate_hz, 0.0) << entry.name;
    EXPECT_FALSE(entry.writers.empty()) << entry.name;
  }
}

TEST(Catalogue, DepthsFollowTheKindOfTopic) {
  for (const Entry& entry : entries()) {
    int least = 1, most = 1;
    if (entry.kind == Kind::kStream) most = entry.name == "tf" ? 32 : 5;  // tf has many writers
    if (entry.kind == Kind::kEvent) least = 4, most = 32;
    EXPECT_GE(entry.depth, least) << entry.name;
    EXPECT_LE(entry.depth, most) << entry.name;
  }
}

/// Component types are folders of components/. Roles are participants that are no component, and
/// components that later work brings or that live in another's folder; a role that has become a
/// folder must leave this list.
const std::set<std::string> kRoles{"waypoint_follower", "operator", "segway_emulator", "attendees"};

TEST(Catalogue, WritersAreComponentsOrKnownRoles) {
  std::set<std::string> types;
  const auto root = std::filesystem::path(USHER_SOURCE_DIR) / "components";
  for (const auto& area : std::filesystem::directory_iterator(root)) {
    if (!area.is_directory()) continue;
    for (const auto& folder : std::filesystem::directory_iterator(area)) {
      if (std::filesystem::exists(folder.path() / "shell"))
        types.insert(folder.path().filename().string());
    }
  }
  EXPECT_GT(types.size(), 5U);
  for (const std::string& role : kRoles) {
    EXPECT_EQ(types.count(role), 0U) << role << " is a component now";
  }
  for (const Entry& entry : entries()) {
    std::istringstream words(entry.writers);
    for (std::string writer; words >> writer;) {
      EXPECT_TRUE(writer == "*" || types.count(writer) > 0 || kRoles.count(writer) > 0)
          << entry.name << " is written by an unknown " << writer;
    }
  }
}

}  // namespace
}  // namespace usher::topics
