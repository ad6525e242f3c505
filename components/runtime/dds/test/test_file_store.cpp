#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "runtime/dds/file_store.hpp"
#include "support/folder.hpp"

namespace usher::runtime {
namespace {

using testing::HasSubstr;

TEST(FileStore, ReturnsWhatWasKeptAlsoToTheNextProcess) {
  const usher::test::Folder folder;
  const Bytes bytes{1, 2, 0, 255};
  ASSERT_TRUE(FileStore(folder.path() + "/a/b").keep("last_pose", bytes).ok());
  const auto kept = FileStore(folder.path() + "/a/b").kept("last_pose");
  ASSERT_TRUE(kept.ok()) << kept.error();
  EXPECT_EQ(*kept, bytes);
}

TEST(FileStore, ReplacesAndKeepsEmptyValues) {
  const usher::test::Folder folder;
  const FileStore store(folder.path());
  ASSERT_TRUE(store.keep("latch", Bytes(1000, 7)).ok());
  ASSERT_TRUE(store.keep("latch", Bytes{}).ok());
  const auto kept = store.kept("latch");
  ASSERT_TRUE(kept.ok());
  EXPECT_EQ(*kept, Bytes{});
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path()))
    ++files;
  EXPECT_EQ(files, 1U);  // no temporary is left
}

TEST(FileStore, HasNothingBeforeTheFirstTime) {
  const usher::test::Folder folder;
  for (const auto& path : {folder.path(), folder.path() + "/none/yet"}) {
    const auto kept = FileStore(path).kept("epoch");
    ASSERT_TRUE(kept.ok()) << kept.error();
    EXPECT_FALSE(*kept);
  }
}

TEST(FileStore, WhatCannotBeReadIsNotNothing) {
  const usher::test::Folder folder;
  const FileStore store(folder.path());
  const auto error = [&](const char* key) {
    const auto kept = store.kept(key);
    return kept.ok() ? std::string("no error") : kept.error();
  };
  std::filesystem::create_directory(folder.path() + "/latch");
  EXPECT_EQ(error("latch"), "cannot read " + folder.path() + "/latch: Is a directory");
  std::filesystem::create_symlink("loop", folder.path() + "/loop");
  EXPECT_THAT(error("loop"), HasSubstr("/loop: Too many levels of symbolic links"));
  folder.file("large", std::string(FileStore::kMaxBytes + 1, 'x'));
  EXPECT_THAT(error("large"), HasSubstr("/large: it has more than 1 MB"));
  const FileStore beside(folder.file("plain", "x"));
  EXPECT_THAT(beside.kept("latch").error(), HasSubstr("Not a directory"));
}

TEST(FileStore, RefusesKeysThatLeaveTheFolderAndValuesThatAreTooLarge) {
  const usher::test::Folder folder;
  const FileStore store(folder.path());
  for (const char* key : {"", "../x", "a/b", ".hidden", "Upper", "sp ace"}) {
    EXPECT_FALSE(store.keep(key, Bytes{1}).ok()) << key;
    EXPECT_FALSE(store.kept(key).ok()) << key;
  }
  EXPECT_FALSE(store.keep(std::string(65, 'a'), Bytes{1}).ok());
  EXPECT_TRUE(store.keep("large", Bytes(FileStore::kMaxBytes)).ok());
  const Status status = store.keep("larger", Bytes(FileStore::kMaxBytes + 1));
  ASSERT_FALSE(status.ok());
  EXPECT_THAT(status.error(), HasSubstr("1048577"));
}

TEST(FileStore, SaysWhenTheFolderCannotBeUsed) {
  const usher::test::Folder folder;
  const std::string file = folder.file("plain", "x");
  const Status status = FileStore(file).keep("pose", Bytes{1});
  ASSERT_FALSE(status.ok());
  EXPECT_THAT(status.error(), HasSubstr(file));
}

TEST(FileStore, StoresNothingWithoutAFolder) {
  EXPECT_TRUE(FileStore("").keep("pose", Bytes{1}).ok());
  EXPECT_FALSE(FileStore("").kept("pose").value());
}

}  // namespace
}  // namespace usher::runtime
