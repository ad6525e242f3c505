#pragma once

// The topic catalogue: every topic that exists, with type, quality of service, nominal rate and who
// may write it. The contracts, `usher check`, `usher topics` and the security permissions come from
// here.

#include <tuple>

#include "idl/topic.hpp"
#include "ros2.h"
#include "usher_msgs.h"
#include "usher_sim_msgs.h"

namespace usher::topics {

// --- Health
inline constexpr Topic<usher_msgs::msg::Heartbeat> kHeartbeat{
    "heartbeat",
    Kind::kStream,  // the next one comes before a lost one could be sent again
    4,
    10,
    "*",
    "State of every component; critical ones write at 50 Hz."};
inline constexpr Topic<diagnostic_msgs::msg::DiagnosticArray> kDiagnostics{
    "diagnostics", Kind::kEvent, 4, 1, "supervisor", "The supervisor's table for ROS 2 tools."};

// --- Sensors
inline constexpr Topic<sensor_msgs::msg::LaserScan> kScan{
    "scan", Kind::kStream,    5,
    50,     "lms100 urg04lx", "Laser scan as measured, in the frame `laser`."};
inline constexpr Topic<sensor_msgs::msg::LaserScan> kScanFiltered{
    "scan/filtered",
    Kind::kStream,
    5,
    50,
    "scan_filter",
    "Own body and floor removed, projected to the horizontal."};
inline constexpr Topic<sensor_msgs::msg::LaserScan> kUltrasonic{
    "ultrasonic",
    Kind::kStream,
    5,
    20,
    "sensor_board p3dx",
    "Narrow ultrasonic ranges as one scan; NaN where there is no sensor."};
inline constexpr Topic<sensor_msgs::msg::LaserScan> kUltrasonicFiltered{
    "ultrasonic/filtered",
    Kind::kStream,
    5,
    20,
    "scan_filter",
    "The same without the floor, projected."};
inline constexpr Topic<usher_msgs::msg::Whiskers> kWhiskers{
    "whiskers", Kind::kStream, 2, 50, "sensor_board", "Contact at the four corners."};
inline constexpr Topic<sensor_msgs::msg::BatteryState> kBattery{
    "battery", Kind::kStream, 1, 1, "segway_rmp p3dx", "Drive battery."};
inline constexpr Topic<tf2_msgs::msg::TFMessage> kTf{
    "tf",
    Kind::kStream,
    32,
    100,
    "segway_rmp p3dx amcl depth_pipeline people_detector",
    "Moving frames: map -> odom -> base_footprint -> base_link; for rviz odom -> person_<id>."};
inline constexpr Topic<tf2_msgs::msg::TFMessage> kTfStatic{
    "tf_static",
    Kind::kLatched,
    1,
    0,
    "lms100 urg04lx sensor_board p3dx scan_filter",
    "Mounts of the sensors."};

// --- Depth cameras
inline constexpr Topic<sensor_msgs::msg::Image> kKinectDepth{
    "kinect/depth", Kind::kStream, 2, 30, "kinect", "Depth as measured, 16UC1 in mm, 0 = none."};
inline constexpr Topic<sensor_msgs::msg::Image> kKinectColor{
    "kinect/color",
    Kind::kStream,
    2,
    30,
    "kinect",
    "Colour image, rgb8; its pixels are those of the depth image of that time."};
inline constexpr Topic<sensor_msgs::msg::CameraInfo> kKinectInfo{
    "kinect/depth/camera_info", Kind::kLatched, 1, 0, "kinect", "Intrinsics of the depth image."};
inline constexpr Topic<sensor_msgs::msg::Image> kRearDepth{
    "rear_camera/depth", Kind::kStream, 2, 15, "kinect", "The same of the camera that looks back."};
inline constexpr Topic<sensor_msgs::msg::Image> kRearColor{
    "rear_camera/color", Kind::kStream, 2, 15, "kinect", "Its colour image, likewise."};
inline constexpr Topic<sensor_msgs::msg::CameraInfo> kRearInfo{
    "rear_camera/depth/camera_info", Kind::kLatched, 1, 0, "kinect",
    "Intrinsics of its depth image."};
inline constexpr Topic<sensor_msgs::msg::Image> kKinectProcessed{
    "kinect/depth/processed",
    Kind::kStream,
    2,
    30,
    "depth_pipeline",
    "Depth without floor, ceiling and noise, 16UC1 in mm, 0 = nothing; its frame is in tf."};
inline constexpr Topic<sensor_msgs::msg::Image> kRearProcessed{
    "rear_camera/depth/processed", Kind::kStream, 2, 15, "depth_pipeline",
    "The same of the rear camera."};
inline constexpr Topic<sensor_msgs::msg::LaserScan> kKinectScan{
    "kinect/scan",
    Kind::kStream,
    2,
    30,
    "depth_pipeline",
    "Nearest obstacle or missing floor of each bearing; intensity = confidence."};
inline constexpr Topic<sensor_msgs::msg::LaserScan> kKinectScanLow{
    "kinect/scan/low",
    Kind::kStream,
    2,
    30,
    "depth_pipeline",
    "Only what is too low to be seen from near: to be remembered there. -r: nothing low up to r; "
    "intensity 2: floor is missing there, 3: behind floor that is seen, else the confidence."};
inline constexpr Topic<sensor_msgs::msg::LaserScan> kRearScan{
    "rear_camera/scan", Kind::kStream, 2, 15, "depth_pipeline", "Nearest obstacle behind."};
inline constexpr Topic<usher_msgs::msg::CameraTilt> kKinectTilt{
    "kinect/tilt", Kind::kStream, 2, 20, "sensor_board", "Where the tilt servo stands."};
inline constexpr Topic<usher_msgs::msg::CameraTilt> kKinectTiltCommand{
    "kinect/tilt/command",
    Kind::kCommand,
    1,
    10,
    "depth_pipeline",
    "Where the tilt servo shall go, by equation 4.1."};
inline constexpr Topic<usher_msgs::msg::CameraTilt> kKinectTiltRequest{
    "kinect/tilt/request",
    Kind::kEvent,
    32,
    0,
    "operator",
    "Holds the servo there for the next 2 s (calibration)."};

// --- Base and drive chain
inline constexpr Topic<usher_msgs::msg::BaseStatus> kBaseStatus{
    "base/status", Kind::kStream,     5,
    100,           "segway_rmp p3dx", "Pitch, velocity and obedience of the base."};
inline constexpr Topic<nav_msgs::msg::Odometry> kOdom{
    "odom", Kind::kStream, 5, 100, "segway_rmp p3dx", "Odometry, corrected for the pitch."};
inline constexpr Topic<usher_msgs::msg::BaseRequest> kBaseRequest{
    "base/request", Kind::kEvent, 32, 0, "supervisor", "Emergency stop and reset."};
inline constexpr Topic<geometry_msgs::msg::TwistStamped> kCmdVelManual{
    "cmd_vel/manual", Kind::kCommand, 1, 20, "manual_control", "Velocity wanted by the operator."};
inline constexpr Topic<geometry_msgs::msg::TwistStamped> kCmdVelInteraction{
    "cmd_vel/interaction",
    Kind::kCommand,
    1,
    20,
    "interaction_control",
    "Velocity wanted to face a person."};
inline constexpr Topic<geometry_msgs::msg::TwistStamped> kCmdVelNavigation{
    "cmd_vel/navigation",
    Kind::kCommand,
    1,
    20,
    "local_planner waypoint_follower",
    "Velocity wanted to reach the goal; the stamp is that of the newest scan behind it, where it "
    "only stands that of writing."};
inline constexpr Topic<usher_msgs::msg::DriveCommand> kDriveCommand{
    "drive/command",
    Kind::kCommand,
    1,
    50,
    "movement_control",
    "The one command that the base obeys."};
inline constexpr Topic<usher_msgs::msg::DriveGrant> kDriveGrant{
    "drive/grant", Kind::kCommand, 1, 50, "supervisor", "Who may drive, for how long."};
inline constexpr Topic<usher_msgs::msg::MovementEnable> kMovementEnable{
    "movement/enable", Kind::kCommand, 1, 50, "supervisor", "Which sources may move the robot."};
inline constexpr Topic<usher_msgs::msg::MovementStatus> kMovementStatus{
    "movement/status", Kind::kStream, 1, 10, "movement_control", "Appendix A.1 of the thesis."};

inline constexpr Topic<sensor_msgs::msg::Joy> kJoy{
    "joy", Kind::kStream,      5,
    20,    "gamepad operator", "Sticks and buttons of the operator's gamepad."};
inline constexpr Topic<usher_msgs::msg::FaceTarget> kInteractionTarget{
    "interaction/target",        Kind::kStream, 1, 10, "guide meeting people_detector operator",
    "Whom the robot shall face."};
inline constexpr Topic<usher_msgs::msg::InteractionStatus> kInteractionStatus{
    "interaction/status",
    Kind::kLatched,
    1,
    5,
    "interaction_control",
    "Whom it poses the robot for, and how."};
inline constexpr Topic<usher_msgs::msg::TorsoFrame> kTorsoFrame{
    "torso/frame", Kind::kCommand, 1, 20, "interaction_control", "Where joints and eyes shall be."};
inline constexpr Topic<usher_msgs::msg::TorsoStatus> kTorsoStatus{
    "torso/status", Kind::kStream, 1, 20, "torso", "Where the joints are."};
inline constexpr Topic<usher_msgs::msg::People> kPeople{
    "people", Kind::kStream, 1, 15, "people_detector", "Everybody around, followed over time."};
inline constexpr Topic<usher_msgs::msg::PersonAhead> kPersonAhead{
    "people/ahead",
    Kind::kStream,
    1,
    15,
    "people_detector",
    "Whether somebody is where the robot drives."};
inline constexpr Topic<usher_msgs::msg::Faces> kFaces{
    "faces", Kind::kStream,   1,
    10,      "face_detector", "Faces that the Kinect sees, one message a pair of images."};

// --- Supervisor
inline constexpr Topic<usher_msgs::msg::SupervisorStatus> kSupervisorStatus{
    "supervisor/status",
    Kind::kLatched,
    1,
    10,
    "supervisor",
    "Appendix A.3 of the thesis, health and faults."};
inline constexpr Topic<usher_msgs::msg::SupervisorRequest> kSupervisorRequest{
    "supervisor/request",
    Kind::kEvent,
    32,
    0,
    "guide manual_control meeting navigator tablet speech operator",
    "Changes of the supervisor's state."};

// --- Localization and maps
inline constexpr Topic<nav_msgs::msg::OccupancyGrid> kMap{
    "map", Kind::kLatched, 1, 0, "map_server", "The static map, frame map."};
inline constexpr Topic<geometry_msgs::msg::PoseWithCovarianceStamped> kInitialPose{
    "initialpose",
    Kind::kEvent,
    32,
    0,
    "operator",
    "Where the robot is, said by an operator; frame map."};
inline constexpr Topic<geometry_msgs::msg::PoseWithCovarianceStamped> kAmclPose{
    "amcl_pose", Kind::kLatched, 1, 5, "amcl", "Estimated pose of base_footprint in map."};
inline constexpr Topic<geometry_msgs::msg::PoseArray> kParticleCloud{
    "particle_cloud", Kind::kStream, 1, 2, "amcl", "A sample of the particles, for viewers."};
inline constexpr Topic<usher_msgs::msg::LocalizationStatus> kLocalizationStatus{
    "localization/status", Kind::kLatched, 1, 10, "amcl", "Whether the pose can be trusted."};

// --- Costmaps
inline constexpr Topic<usher_msgs::msg::Costmap> kLocalCosts{
    "local_costmap/costs",
    Kind::kStream,
    1,
    20,
    "costmap",
    "Rolling window around the robot, frame odom."};
inline constexpr Topic<usher_msgs::msg::Costmap> kGlobalCosts{
    "global_costmap/costs", Kind::kLatched, 1, 1, "costmap", "The whole map, frame map."};
inline constexpr Topic<nav_msgs::msg::OccupancyGrid> kLocalCostmap{
    "local_costmap/costmap", Kind::kLatched, 1, 5, "costmap", "The local costs for ROS 2 viewers."};
inline constexpr Topic<nav_msgs::msg::OccupancyGrid> kGlobalCostmap{
    "global_costmap/costmap",
    Kind::kLatched,
    1,
    1,
    "costmap",
    "The global costs for ROS 2 viewers."};
inline constexpr Topic<usher_msgs::msg::CostmapRequest> kCostmapRequest{
    "costmap/request", Kind::kEvent, 32, 0, "navigator", "Forget observations around the robot."};

// --- Planning
inline constexpr Topic<usher_msgs::msg::PlanRequest> kPlanRequest{
    "plan/request", Kind::kEvent, 32, 0, "navigator", "Ask for a path."};
inline constexpr Topic<usher_msgs::msg::PlanReply> kPlanReply{"plan/reply",
                                                              Kind::kLatched,
                                                              1,
                                                              0,
                                                              "global_planner roadmap",
                                                              "The answer to the last request."};
inline constexpr Topic<nav_msgs::msg::Path> kPlan{
    "plan", Kind::kLatched, 1, 0, "global_planner roadmap", "The last path, for viewers."};
inline constexpr Topic<usher_msgs::msg::FollowGoal> kFollowGoal{
    "follow/goal", Kind::kEvent, 32, 0, "navigator", "The path to follow."};
inline constexpr Topic<usher_msgs::msg::GoalCancel> kFollowCancel{
    "follow/cancel", Kind::kEvent, 32, 0, "navigator", "Stop following."};
inline constexpr Topic<usher_msgs::msg::FollowStatus> kFollowStatus{
    "follow/status",          Kind::kLatched, 1, 20, "local_planner waypoint_follower",
    "How the following goes."};
inline constexpr Topic<nav_msgs::msg::Path> kLocalPlan{"local_plan",
                                                       Kind::kStream,
                                                       1,
                                                       10,
                                                       "local_planner waypoint_follower",
                                                       "The chosen trajectory, for viewers."};
inline constexpr Topic<usher_msgs::msg::NavigateGoal> kNavigateGoal{
    "navigate/goal",
    Kind::kEvent,
    32,
    0,
    "guide explorer meeting operator",
    "Where to go; the newest goal wins."};
inline constexpr Topic<geometry_msgs::msg::PoseStamped> kGoalPose{
    "goal_pose", Kind::kEvent, 32, 0, "operator", "The same from rviz."};
inline constexpr Topic<usher_msgs::msg::GoalCancel> kNavigateCancel{
    "navigate/cancel", Kind::kEvent, 32, 0, "guide explorer meeting operator", "Give up the goal."};
inline constexpr Topic<usher_msgs::msg::NavigateStatus> kNavigateStatus{
    "navigate/status", Kind::kLatched, 1, 5, "navigator", "Progress, time left, outcome."};
inline constexpr Topic<usher_msgs::msg::NavigatePace> kNavigatePace{
    "navigate/pace", Kind::kCommand, 1, 5, "guide", "How fast the visitor can follow."};
inline constexpr Topic<usher_msgs::msg::Locations> kLocations{
    "locations", Kind::kLatched, 1, 0, "navigator", "Known locations of the site."};

// --- Exploration
inline constexpr Topic<usher_msgs::msg::ExploreGoal> kExploreGoal{
    "explore/goal", Kind::kEvent, 32, 0, "meeting operator", "Look at everything; newest wins."};
inline constexpr Topic<usher_msgs::msg::GoalCancel> kExploreCancel{
    "explore/cancel", Kind::kEvent, 32, 0, "meeting operator", "Give up exploring."};
inline constexpr Topic<usher_msgs::msg::ExploreStatus> kExploreStatus{
    "explore/status", Kind::kLatched, 1, 5, "explorer", "What was seen, what comes next, outcome."};
inline constexpr Topic<nav_msgs::msg::OccupancyGrid> kExploreCoverage{
    "explore/coverage",
    Kind::kLatched,
    1,
    1,
    "explorer",
    "For viewers: 100 not seen in this round, 0 seen, -1 not to be looked at; frame map."};

inline constexpr Topic<usher_msgs::msg::ExploreShare> kExploreShare{
    "explore/share", Kind::kLatched, 1, 0, "meeting", "What to look at first; the rest after it."};

// --- Dialogue
inline constexpr Topic<usher_msgs::msg::DialogueScreen> kDialogueScreen{
    "dialogue/screen", Kind::kLatched, 1, 0, "guide meeting", "What the visitor sees and hears."};
inline constexpr Topic<usher_msgs::msg::DialogueAnswer> kDialogueAnswer{
    "dialogue/answer",        Kind::kEvent, 32, 0, "attendees visitor tablet speech operator",
    "What the visitor chose."};
inline constexpr Topic<usher_msgs::msg::GuideStatus> kGuideStatus{
    "guide/status", Kind::kLatched, 1, 1, "guide", "This visit and the funnel of all visits."};
inline constexpr Topic<usher_msgs::msg::GuideVisit> kGuideVisit{
    "guide/visit", Kind::kEvent, 32, 0, "guide", "A visit is over."};
inline constexpr Topic<usher_msgs::msg::Visitor> kVisitor{
    "visitor", Kind::kStream, 1, 10, "visitor_tracker", "The person whom the robot serves."};
inline constexpr Topic<usher_msgs::msg::SpeechStatus> kSpeechStatus{
    "speech/status", Kind::kLatched, 1, 2, "speech", "What is said, what is heard."};
inline constexpr Topic<usher_msgs::msg::SpeechLevel> kSpeechLevel{
    "speech/level", Kind::kStream, 1, 25, "speech", "How loud the robot speaks."};

// --- Meeting assistant
inline constexpr Topic<usher_msgs::msg::MeetingRequest> kMeetingRequest{
    "meeting/request", Kind::kEvent, 32, 0, "tablet operator", "Call a meeting; one at a time."};
inline constexpr Topic<usher_msgs::msg::GoalCancel> kMeetingCancel{
    "meeting/cancel", Kind::kEvent, 32, 0, "tablet operator", "Give up the meeting."};
inline constexpr Topic<usher_msgs::msg::MeetingStatus> kMeetingStatus{
    "meeting/status", Kind::kLatched, 1, 2, "meeting", "What the assistant does, who is there."};
inline constexpr Topic<usher_msgs::msg::MeetingReport> kMeetingReport{
    "meeting/report", Kind::kEvent, 32, 0, "meeting", "A mission is over."};

// --- Fleet
inline constexpr Topic<usher_msgs::msg::FleetMeeting> kFleetMeeting{
    "fleet/meeting",
    Kind::kLatched,
    1,
    2,
    "meeting",
    "What each robot of a fleet knows of the meeting that they call together.",
    Scope::kFleet};
inline constexpr Topic<usher_msgs::msg::FleetLook> kFleetLook{
    "fleet/look", Kind::kStream, 1, 10, "explorer", "Where each robot of a fleet looks now.",
    Scope::kFleet};

// --- Simulated devices
inline constexpr Topic<usher_sim_msgs::msg::BaseCommand> kSimBaseCommand{
    "sim/base/command",        Kind::kCommand, 1, 50, "segway_rmp segway_emulator p3dx",
    "To the simulated wheels."};
inline constexpr Topic<usher_sim_msgs::msg::BaseFeedback> kSimBaseFeedback{
    "sim/base/feedback",
    Kind::kStream,
    5,
    100,
    "world",
    "From the simulated wheels and gyroscope."};
inline constexpr Topic<sensor_msgs::msg::LaserScan> kSimScan{
    "sim/scan", Kind::kStream, 5, 50, "world", "From the simulated laser."};
inline constexpr Topic<usher_sim_msgs::msg::SensorBoardReading> kSimSensorBoard{
    "sim/sensor_board", Kind::kStream, 5, 50, "world", "From the simulated sensor board."};
inline constexpr Topic<usher_sim_msgs::msg::SensorBoardCommand> kSimSensorBoardCommand{
    "sim/sensor_board/command", Kind::kCommand, 1, 20, "sensor_board", "To the simulated board."};
inline constexpr Topic<usher_sim_msgs::msg::TorsoReading> kSimTorso{
    "sim/torso", Kind::kStream, 5, 50, "world", "From the simulated torso."};
inline constexpr Topic<usher_sim_msgs::msg::TorsoCommand> kSimTorsoCommand{
    "sim/torso/command", Kind::kCommand, 1, 20, "torso", "To the simulated torso."};
inline constexpr Topic<sensor_msgs::msg::Image> kSimKinectDepth{
    "sim/kinect/depth", Kind::kStream, 2, 30, "world", "From the simulated Kinect, 16UC1 in mm."};
inline constexpr Topic<sensor_msgs::msg::Image> kSimKinectColor{
    "sim/kinect/color", Kind::kStream, 2, 30, "world", "From its colour camera, rgb8."};
inline constexpr Topic<sensor_msgs::msg::CameraInfo> kSimKinectInfo{
    "sim/kinect/camera_info", Kind::kLatched, 1, 0, "world", "Intrinsics of its depth image."};
inline constexpr Topic<sensor_msgs::msg::Image> kSimRearDepth{
    "sim/rear_camera/depth", Kind::kStream, 2, 15, "world", "From the simulated rear camera."};
inline constexpr Topic<sensor_msgs::msg::Image> kSimRearColor{
    "sim/rear_camera/color", Kind::kStream, 2, 15, "world", "From its colour camera, rgb8."};
inline constexpr Topic<sensor_msgs::msg::CameraInfo> kSimRearInfo{
    "sim/rear_camera/camera_info", Kind::kLatched, 1, 0, "world", "Intrinsics of its image."};
inline constexpr Topic<sensor_msgs::msg::LaserScan> kSimKinectScan{
    "sim/kinect/scan",
    Kind::kStream,
    2,
    30,
    "world",
    "What the depth pipeline would make of the Kinect's pixels, by the fitted model."};
inline constexpr Topic<sensor_msgs::msg::LaserScan> kSimKinectScanLow{
    "sim/kinect/scan/low", Kind::kStream, 2, 30, "world", "Its low obstacles."};
inline constexpr Topic<sensor_msgs::msg::LaserScan> kSimRearScan{
    "sim/rear_camera/scan", Kind::kStream, 2, 15, "world", "The same of the rear camera."};
inline constexpr Topic<usher_sim_msgs::msg::Sightings> kSimKinectPeople{
    "sim/kinect/people",
    Kind::kStream,
    2,
    15,
    "world",
    "Whom the people detector would find in the Kinect's image, by the fitted model."};
inline constexpr Topic<usher_sim_msgs::msg::Sightings> kSimRearPeople{
    "sim/rear_camera/people", Kind::kStream, 2, 15, "world", "The same of the rear camera."};
inline constexpr Topic<usher_msgs::msg::Faces> kSimKinectFaces{
    "sim/kinect/faces",
    Kind::kStream,
    2,
    10,
    "world",
    "Faces that the face detector would tell of the Kinect's images, by a model of it."};
inline constexpr Topic<usher_sim_msgs::msg::GroundTruth> kSimGroundTruth{
    "sim/ground_truth",
    Kind::kStream,
    5,
    50,
    "world",
    "What really happened; for judges, never for the robot."};
inline constexpr Topic<usher_sim_msgs::msg::PersonGoal> kSimPersonGoal{
    "sim/person/goal", Kind::kEvent, 32, 0, "attendees visitor", "Moves a scripted person."};

inline constexpr Topic<usher_sim_msgs::msg::FleetBody> kFleetSimBody{
    "fleet/sim/body",
    Kind::kStream,
    1,
    100,
    "world",
    "Where each simulated robot of a fleet is, for the worlds of the others.",
    Scope::kFleet};
inline constexpr Topic<usher_sim_msgs::msg::FleetPeople> kFleetSimPeople{
    "fleet/sim/people",
    Kind::kStream,
    1,
    100,
    "world",
    "Everybody, from the one world of a fleet that moves them.",
    Scope::kFleet};
inline constexpr Topic<usher_sim_msgs::msg::FleetPersonGoal> kFleetSimPersonGoal{
    "fleet/sim/person/goal",
    Kind::kEvent,
    32,
    0,
    "world",
    "Moves a scripted person, to the world that moves them.",
    Scope::kFleet};

inline constexpr auto kAll = std::tie(
    kHeartbeat, kDiagnostics, kScan, kScanFiltered, kUltrasonic, kUltrasonicFiltered, kWhiskers,
    kBattery, kTf, kTfStatic, kKinectDepth, kKinectColor, kKinectInfo, kRearDepth, kRearColor,
    kRearInfo, kKinectProcessed, kRearProcessed, kKinectScan, kKinectScanLow, kRearScan,
    kKinectTilt, kKinectTiltCommand, kKinectTiltRequest, kBaseStatus, kOdom, kBaseRequest,
    kCmdVelManual, kCmdVelInteraction, kCmdVelNavigation, kDriveCommand, kDriveGrant,
    kMovementEnable, kMovementStatus, kPeople, kPersonAhead, kFaces, kJoy, kInteractionTarget,
    kInteractionStatus, kTorsoFrame, kTorsoStatus, kSupervisorStatus, kSupervisorRequest, kMap,
    kInitialPose, kAmclPose, kParticleCloud, kLocalizationStatus, kLocalCosts, kGlobalCosts,
    kLocalCostmap, kGlobalCostmap, kCostmapRequest, kPlanRequest, kPlanReply, kPlan, kFollowGoal,
    kFollowCancel, kFollowStatus, kLocalPlan, kNavigateGoal, kGoalPose, kNavigateCancel,
    kNavigateStatus, kNavigatePace, kLocations, kExploreGoal, kExploreCancel, kExploreStatus,
    kExploreCoverage, kDialogueScreen, kDialogueAnswer, kGuideStatus, kGuideVisit, kVisitor,
    kSpeechStatus, kSpeechLevel, kMeetingRequest, kMeetingCancel, kMeetingStatus, kMeetingReport,
    kSimKinectFaces, kSimBaseCommand, kSimBaseFeedback, kSimScan, kSimSensorBoard,
    kSimSensorBoardCommand, kSimTorso, kSimTorsoCommand, kSimKinectDepth, kSimKinectColor,
    kSimKinectInfo, kSimRearDepth, kSimRearColor, kSimRearInfo, kSimKinectScan, kSimKinectScanLow,
    kSimRearScan, kSimKinectPeople, kSimRearPeople, kSimGroundTruth, kSimPersonGoal, kExploreShare,
    kFleetMeeting, kFleetLook, kFleetSimBody, kFleetSimPeople, kFleetSimPersonGoal);

}  // namespace usher::topics
