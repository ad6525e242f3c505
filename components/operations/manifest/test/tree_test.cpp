#include "operations/manifest/tree.hpp"

#include <gmock/gmock.h>

#include "foundation/random/random.hpp"
#include "support/folder.hpp"

namespace usher::operations {
namespace {

using testing::HasSubstr;

Tree parsed(const std::string& text) {
  auto tree = parse_tree(text, "x.yaml");
  EXPECT_TRUE(tree) << (tree ? "" : tree.error());
  return tree ? *tree : Tree{};
}

std::string refused(const std::string& text) {
  const auto tree = parse_tree(text, "x.yaml");
  return tree ? "accepted: " + tree->yaml() : tree.error();
}

TEST(Tree, KnowsWhereEverythingIsWritten) {
  const Tree tree = parsed("a: 1\n\nb:\n  # a comment\n  c: [1,\n   2]\n  d: {e: f}\n");
  EXPECT_EQ(tree.origin, "x.yaml:1");
  EXPECT_EQ(tree.find("a")->origin, "x.yaml:1");
  EXPECT_EQ(tree.find("b")->origin, "x.yaml:3") << "that of the key, not of the value";
  EXPECT_EQ(tree.find("b")->find("c")->origin, "x.yaml:5");
  EXPECT_EQ(tree.find("b")->find("c")->items.at(1).origin, "x.yaml:6");
  EXPECT_EQ(tree.find("b")->find("d")->find("e")->origin, "x.yaml:7");
  EXPECT_EQ(tree.find("z"), nullptr);
}

TEST(Tree, DistinguishesNothingFromAnEmptyWord) {
  const Tree tree = parsed("a:\nb: ~\nc: ''\nd: null\ne: 'null'\n");
  EXPECT_EQ(tree.find("a")->kind, Tree::Kind::kNull);
  EXPECT_EQ(tree.find("b")->kind, Tree::Kind::kNull);
  EXPECT_EQ(tree.find("c")->kind, Tree::Kind::kScalar);
  EXPECT_EQ(tree.find("d")->kind, Tree::Kind::kNull);
  EXPECT_EQ(tree.find("e")->kind, Tree::Kind::kScalar);
  EXPECT_EQ(parsed("").kind, Tree::Kind::kNull);
  EXPECT_EQ(parsed("").origin, "x.yaml:1");
  EXPECT_EQ(parsed("# only a comment\n").kind, Tree::Kind::kNull);
}

TEST(Tree, RefusesWhatCouldBeReadInTwoWays) {
  EXPECT_EQ(refused("a: 1\nb: 2\na: 3\n"), "key 'a' is given twice (x.yaml:3)");
  EXPECT_EQ(refused("a: {b: 1, b: 2}\n"), "key 'b' is given twice (x.yaml:1)");
  EXPECT_EQ(refused("a: 1\n? [1, 2]\n: 3\n"), "a key must be a word (x.yaml:2)");
  EXPECT_EQ(refused("a: 1\n~: 3\n"), "a key must be a word (x.yaml:2)");
  EXPECT_EQ(refused("a: 1\n---\nb: 2\n"), "a second document starts (x.yaml:2)");
}

TEST(Tree, RefusesAnchorsAndAliases) {
  EXPECT_EQ(refused("a: &x 1\nb: *x\n"), "anchors are not allowed (x.yaml:1)");
  EXPECT_THAT(refused("a: 1\nb: *x\n"), HasSubstr("x.yaml:2"));
  std::string bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string below = "*a" + std::to_string(i - 1);
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + below;
    for (int j = 0; j < 9; ++j) bomb += ", " + below;
    bomb += "]\n";
  }
  EXPECT_EQ(refused(bomb), "anchors are not allowed (x.yaml:1)");
}

TEST(Tree, RefusesBadYamlWithItsLine) {
  EXPECT_THAT(refused("a: 1\nb: [1, 2\nc: 3\n"), HasSubstr("not valid YAML"));
  EXPECT_THAT(refused("a: 1\n b: 2\n"), HasSubstr("x.yaml:2"));
  EXPECT_THAT(refused("\t- a\n"), HasSubstr("x.yaml:1"));
}

TEST(Tree, IsAtMost32LevelsDeep) {
  const auto nested = [](std::size_t levels) {
    return std::string(levels, '[') + "1" + std::string(levels, ']');
  };
  EXPECT_TRUE(parse_tree(nested(32), "x.yaml"));
  EXPECT_EQ(refused(nested(33)), "nested deeper than 32 levels (x.yaml:1)");
  EXPECT_THAT(refused(nested(200'000)), HasSubstr("x.yaml:1"));
}

TEST(Tree, IsAtMostOneMegabyte) {
  const test::Folder folder;
  const std::string start = "a: '";
  const auto sized = [&](std::size_t bytes) {
    return start + std::string(bytes - start.size() - 1, 'x') + "'";
  };
  EXPECT_TRUE(read_tree(folder.file("fits.yaml", sized(1 << 20))));
  const auto path = folder.file("large.yaml", sized((1 << 20) + 1));
  const auto large = read_tree(path);
  ASSERT_FALSE(large);
  EXPECT_EQ(large.error(), "it must be at most 1 MB (" + path + ")");
  const auto endless = read_tree("/dev/zero");
  ASSERT_FALSE(endless);
  EXPECT_EQ(endless.error(), "it must be at most 1 MB (/dev/zero)");
}

TEST(Tree, SaysWhichFileCannotBeRead) {
  const test::Folder folder;
  EXPECT_EQ(read_tree(folder.path() + "/none.yaml").error(),
            "it cannot be read (" + folder.path() + "/none.yaml)");
  EXPECT_EQ(read_tree(folder.path()).error(), "it is a directory (" + folder.path() + ")");
}

TEST(Tree, ShowsOneShortLineOfWhatItFound) {
  EXPECT_EQ(brief("lms100"), "lms100");
  EXPECT_EQ(brief("a\nb\x1b[2Jc"), "a?b?[2Jc");
  EXPECT_EQ(brief(std::string(80, 'x')), std::string(80, 'x'));
  EXPECT_EQ(brief(std::string(81, 'x')), std::string(80, 'x') + "...");
  EXPECT_EQ(brief(std::string(79, 'x') + "\xc3\xa4."), std::string(79, 'x') + "...")
      << "no half of a letter";
  const std::string long_key(300, 'k');
  EXPECT_EQ(refused(long_key + ": 1\n" + long_key + ": 2\n"),
            "key '" + std::string(80, 'k') + "...' is given twice (x.yaml:2)");
}

TEST(Tree, WritesOneLineThatReadsTheSameInAnyPlace) {
  EXPECT_EQ(parsed("a: 0.2 m").find("a")->yaml(), "0.2 m");
  EXPECT_EQ(parsed("a:\n- 1\n- -2.5\n- .inf").find("a")->yaml(), "[1, -2.5, .inf]");
  EXPECT_EQ(parsed("a: {b: [x, {c: ~}]}").yaml(), "{a: {b: [x, {c: ~}]}}");
  EXPECT_EQ(parsed("title: 'Lab, north: {1}'").yaml(), "{title: \"Lab, north: {1}\"}");
  EXPECT_EQ(parsed("a: '~'\nb: ''\nc: 'null'\nd: '# no'\n").yaml(),
            "{a: \"~\", b: \"\", c: \"null\", d: \"# no\"}");
}

TEST(Tree, ReadsBackWhatItWrites) {
  Random random(7);
  constexpr std::string_view kAlphabet = "aZ09 .,:;-+*&!|>'\"\\/%@`#{}[]~?_=\n\t\x01\xc3\xa4";
  for (int round = 0; round < 3000; ++round) {
    std::string word;
    const auto length = random.below(12);
    for (std::uint64_t i = 0; i < length; ++i) {
      const char c = kAlphabet[random.below(kAlphabet.size() - 2)];
      word += c;
    }
    if (random.below(4) == 0) word += "\xc3\xa4";
    Tree map;
    map.kind = Tree::Kind::kMap;
    map.entries.push_back({"k" + word, Tree::word(word, {})});
    Tree list;
    list.kind = Tree::Kind::kList;
    list.items = {Tree::word(word, {}), map, Tree::word(word, {})};
    const std::string written = list.yaml();
    ASSERT_EQ(written.find('\n'), std::string::npos);
    const auto again = parse_tree(written, "x.yaml");
    ASSERT_TRUE(again) << written << ": " << again.error();
    ASSERT_EQ(again->items.size(), 3U) << written;
    EXPECT_EQ(again->items[0].scalar, word);
    EXPECT_EQ(again->items[0].kind, Tree::Kind::kScalar) << written;
    ASSERT_EQ(again->items[1].entries.size(), 1U) << written;
    EXPECT_EQ(again->items[1].entries[0].key, "k" + word);
    EXPECT_EQ(again->items[2].scalar, word);
    const auto alone = parse_tree(Tree::word(word, {}).yaml(), "x.yaml");
    ASSERT_TRUE(alone) << written;
    EXPECT_EQ(alone->scalar, word);
  }
}

TEST(Overlay, MergesMapsAndReplacesAllElse) {
  const Tree base = parse_tree("a: {x: 1, y: [1, 2]}\nb: 5\n", "base.yaml").value();
  const Tree over = parse_tree("\na: {y: [3], z: 4}\nc: 6\n", "over.yaml").value();
  std::vector<Finding> findings;
  const Tree merged = overlay(base, over, findings);
  EXPECT_TRUE(findings.empty());
  EXPECT_EQ(merged.yaml(), "{a: {x: 1, y: [3], z: 4}, b: 5, c: 6}");
  EXPECT_EQ(merged.find("a")->find("x")->origin, "base.yaml:1");
  EXPECT_EQ(merged.find("a")->find("y")->origin, "over.yaml:2");
  EXPECT_EQ(merged.find("a")->find("z")->origin, "over.yaml:2");
  EXPECT_EQ(merged.find("c")->origin, "over.yaml:3");
}

TEST(Overlay, RemovesWithNull) {
  const Tree base = parse_tree("a: {x: 1, y: 2}\nb: 5\n", "base.yaml").value();
  std::vector<Finding> findings;
  EXPECT_EQ(overlay(base, parsed("a: {x: ~}\nb:\n"), findings).yaml(), "{a: {y: 2}}");
  EXPECT_TRUE(findings.empty());
  EXPECT_EQ(overlay(base, parsed("a: {xx: ~}\n"), findings).yaml(), base.yaml());
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].origin, "x.yaml:1");
}

TEST(Overlay, ReplacesAMapByAWordAndBack) {
  const Tree base = parse_tree("a: {x: 1}\nb: 5\n", "base.yaml").value();
  std::vector<Finding> findings;
  EXPECT_EQ(overlay(base, parsed("a: 2\nb: {y: 3}\n"), findings).yaml(), "{a: 2, b: {y: 3}}");
}

}  // namespace
}  // namespace usher::operations
