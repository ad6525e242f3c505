#include "tasks/meeting/core/faces.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "meeting_rig.hpp"

namespace usher::meeting {
namespace {

constexpr double kView = 0.9948;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A face whose rectangle has its middle there.
Face face(double column, double row, double side, double depth) {
  Face face;
  face.left = column - 0.5 * side;
  face.top = row - 0.5 * side;
  face.width = face.height = side;
  face.depth = face.range = depth;
  return face;
}
Faces message(std::vector<Face> faces, double yaw = 0.0) {
  Faces all{640.0, Pose2{0.0, 0.0, yaw}, std::move(faces)};
  all.place();
  return all;
}

TEST(FaceTrack, BeginsWithTheNearestByDepth) {
  FaceTrack track(kView);
  EXPECT_TRUE(track.take(message({face(100, 200, 40, 2.5), face(500, 200, 30, 1.5)})));
  EXPECT_EQ(track.face().depth, 1.5);
  EXPECT_EQ(track.successive(), 1);
}

TEST(FaceTrack, GoesOnWithTheClosestOneWithinTheLastRectangle) {
  FaceTrack track(kView);
  track.take(message({face(300, 200, 40, 2.0)}));
  EXPECT_TRUE(track.take(message({face(500, 200, 60, 1.0), face(318, 190, 40, 2.0)})));
  EXPECT_EQ(track.face().depth, 2.0);
  EXPECT_EQ(track.successive(), 2);
  EXPECT_FALSE(track.take(message({face(340, 190, 40, 2.0)})))
      << "22 pixels off, half a side is 20";
  EXPECT_EQ(track.successive(), 0);
}

TEST(FaceTrack, EndsWithAMessageWithoutAFace) {
  FaceTrack track(kView);
  track.take(message({face(300, 200, 40, 2.0)}));
  EXPECT_FALSE(track.take(message({})));
  EXPECT_EQ(track.successive(), 0);
}

TEST(FaceTrack, TakesOffWhatTheRobotTurned) {
  // A person stands still at 0.2 rad of map; the camera turns 0.1 rad to the left each message.
  FaceTrack track(kView);
  const double focal = 320.0 / std::tan(0.5 * kView);
  for (int i = 0; i < 4; ++i) {
    const double yaw = 0.1 * i;
    EXPECT_TRUE(
        track.take(message({face(320.0 - focal * std::tan(0.2 - yaw), 200, 40, 2.0)}, yaw)));
  }
  EXPECT_EQ(track.successive(), 4);
  FaceTrack still(kView);
  still.take(message({face(320.0 - focal * std::tan(0.2), 200, 40, 2.0)}));
  EXPECT_FALSE(still.take(message({face(320.0 - focal * std::tan(0.1), 200, 40, 2.0)})))
      << "without a turn the same shift is another face";
}

TEST(Faces, KnowWhereEachIsInTheMap) {
  Rig rig;
  Faces faces{640.0, Pose2{1.0, 2.0, geometry::kPi / 2.0}, {rig.face(2.0, 0.0)}};
  EXPECT_EQ(faces.place(), 0U);
  EXPECT_NEAR(faces.faces[0].at.x(), 1.0, 1e-9);
  EXPECT_NEAR(faces.faces[0].at.y(), 4.0, 1e-9);
}

TEST(Faces, LeaveOutWhatIsNone) {
  Rig rig;
  const Face good = rig.face(2.0, 0.1);
  std::vector<Face> bad;
  for (double Face::*field : {&Face::left, &Face::top, &Face::width, &Face::height, &Face::depth,
                              &Face::range, &Face::bearing}) {
    for (const double value : {kNan, std::numeric_limits<double>::infinity(), 1e30, -1e30}) {
      bad.push_back(good);
      bad.back().*field = value;
    }
  }
  for (double Face::*field : {&Face::width, &Face::height, &Face::depth}) {
    bad.push_back(good);
    bad.back().*field = 0.0;
  }
  const std::size_t count = bad.size();
  bad.push_back(good);
  Faces faces{640.0, Pose2{}, bad};
  EXPECT_EQ(faces.place(), count);
  ASSERT_EQ(faces.faces.size(), 1U);
  EXPECT_EQ(faces.faces[0].width, good.width);
  for (const auto& pose : {std::optional<Pose2>(), std::optional<Pose2>(Pose2{kNan, 0, 0})}) {
    Faces nowhere{640.0, pose, {good}};
    EXPECT_EQ(nowhere.place(), 1U);
  }
  for (const double width : {kNan, 0.0, -1.0, 1e9}) {
    Faces no_image{width, Pose2{}, {good}};
    EXPECT_EQ(no_image.place(), 1U);
  }
}

}  // namespace
}  // namespace usher::meeting
