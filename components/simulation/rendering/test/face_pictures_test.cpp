#include "simulation/rendering/core/face_pictures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/folder.hpp"

namespace usher::rendering {
namespace {

using testing::HasSubstr;

/// A gray picture of 4 x 2 pixels.
std::string gray(char value) { return "P5 4 2 255\n" + std::string(8, value); }

TEST(FacePictures, AreTakenInTheOrderOfTheirNames) {
  const test::Folder folder;
  folder.file("b.pgm", gray(20));
  folder.file("a.pgm", gray(90));
  folder.file("readme.txt", "no picture");
  const auto faces = load_faces(folder.path());
  ASSERT_TRUE(faces.ok()) << faces.error();
  ASSERT_EQ(faces->size(), 2U);
  EXPECT_NEAR((*faces)[0].at(0.0F, 0.0F, 0.01F)[1], 90.0F, 1.0F);
  EXPECT_NEAR((*faces)[1].at(0.5F, -0.5F, 0.01F)[0], 20.0F, 1.0F);
}

TEST(FacePictures, RefuseAFolderWithTheReason) {
  const test::Folder folder;
  EXPECT_THAT(load_faces(folder.path() + "/none").error(), HasSubstr("/none: No such file"));
  EXPECT_THAT(load_faces(folder.path()).error(), HasSubstr("found 0"));
  folder.file("broken.png", "not a picture");
  EXPECT_THAT(load_faces(folder.path()).error(), HasSubstr("broken.png: no picture"));
}

}  // namespace
}  // namespace usher::rendering
