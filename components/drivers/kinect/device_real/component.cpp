#include "drivers/kinect/device_real/component.hpp"

#include <algorithm>

namespace usher::kinect {

namespace {

using runtime::HealthState;
using std::chrono::milliseconds;

constexpr auto kTick = milliseconds(5);
constexpr auto kSilence = milliseconds(300);  // no read of a Kinect that is well takes longer
constexpr auto kHang = milliseconds(5000);    // a read that ends later never does
constexpr auto kAgain = milliseconds(1000);   // a Kinect that is not there is looked for
constexpr auto kOnItsWay = milliseconds(33);  // exposure and transfer of an image, a period (ours)

}  // namespace

void KinectComponent::Job::run() {
  error.clear();
  color.rgb.clear();
  rectified_color.rgb.clear();
  Status done = fetch();
  if (done) done = rectifier->rectify(read, rectified);
  if (done && !color.rgb.empty()) done = rectifier->rectify(color, rectified_color);
  if (!done) error = done.error();
}

Status KinectComponent::Job::fetch() {
  if (live) return fetch_live();
  auto frame = recording->read(index);
  if (!frame) return Error{frame.error()};
  read = std::move(frame).value();
  if (!recording->has_color(index)) return {};
  auto colors = recording->read_color(index);
  if (!colors) return Error{colors.error()};
  color = std::move(colors).value();
  return {};
}

Status KinectComponent::Job::fetch_live() {
  const auto done = live->read(read, color);
  if (!done) return Error{done.error()};
  stamps = *done;
  return {};
}

KinectComponent::KinectComponent(runtime::Host& host, runtime::Duration reading)
    : host_(host),
      reading_time_(reading),
      publisher_(host),
      rejected_(host.health().counter("frames: rejected")) {
  auto& p = host.parameters();
  const auto model = p.choice("robot.kinect.model", {"v2", "v1"}, "v2",
                              "Kinect v2 (512 x 424) or v1 (640 x 480), simulated or recorded.");
  live_ = p.choice("source", {"recording", "live"}, "recording",
                   "Recorded images, or a Kinect v1 at the USB, whatever the model.") == "live";
  const bool v1 = live_ || model == "v1";
  const auto given = p.numbers("robot.kinect.distortion", "-", {-10, 10}, 0, 5, {},
                               "k1, k2, p1, p2, k3; none: the images are rectified already.");
  Distortion distortion{};
  std::copy_n(given.begin(), std::min(given.size(), distortion.size()), distortion.begin());
  const bool mirrored =
      p.flag("mirrored", false, "Whether the images are mirrored, as a Kinect v2 delivers them.");
  folder_ = p.file("recording", "", "Folder with recorded depth images (*.pgm, INDEX.txt).");
  values_ = p.choice("values", {"millimeters", "raw_11_bit"}, "millimeters",
                     "What the values of the images are.") == "raw_11_bit"
                ? Values::kRaw11
                : Values::kMillimeters;
  const bool laid_on_color = live_ && values_ == Values::kMillimeters;
  intrinsics_ = laid_on_color ? kinect_v1_registered() : v1 ? kinect_v1() : kinect_v2();
  const auto lens = p.numbers("robot.kinect.intrinsics", "-", {0, 5000}, 0, 4, {},
                              "fx, fy, cx, cy in pixels; none: the model's usual ones.");
  if (!lens.empty() && lens.size() != 4)
    host.fault("robot.kinect.intrinsics: expected fx, fy, cx, cy or nothing, got " +
               std::to_string(lens.size()) + " values");
  if (lens.size() == 4) {
    intrinsics_.fx = lens[0], intrinsics_.fy = lens[1];
    intrinsics_.cx = lens[2], intrinsics_.cy = lens[3];
  }
  repeat_ = p.flag("repeat", true, "Begins anew at the end of the recording.");
  auto rectifier = Rectifier::make(intrinsics_, distortion, mirrored);
  if (!rectifier) host.fault(rectifier.error());
  job_->rectifier.emplace(std::move(rectifier).value());
  timer_ = host.timer("frame", kTick, [this](auto) {
    if (!job_->recording && !job_->live && host_.now() >= again_) open();
    start_reading();
    take_frame();
    if (live_ && reading_) watch_reading();
  });
}

void KinectComponent::open() {
  if (live_) {
    job_->live.emplace(values_);
    publisher_.publish_info(host_.now(), intrinsics_);
    return;
  }
  if (folder_.empty()) {
    host_.health().set(HealthState::kDegraded, "no recording is set");
    return;
  }
  auto recording = Recording::open(folder_, values_);
  if (!recording) {
    again_ = host_.now() + kAgain;
    host_.health().set(HealthState::kDegraded, recording.error());
    return;
  }
  job_->recording.emplace(std::move(recording).value());
  publisher_.publish_info(host_.now(), intrinsics_);
  started_ = host_.now();
}

void KinectComponent::start_reading() {
  if ((!job_->recording && !job_->live) || reading_ || ready_ || host_.now() < again_) return;
  if (job_->recording && job_->index == job_->recording->size()) {
    if (!repeat_) return;
    job_->index = 0;
    started_ = host_.now();
  }
  reading_ = true;
  read_at_ = host_.now();
  host_.offload(
      reading_time_, [job = job_] { job->run(); },
      [this] {
        reading_ = false;
        ready_ = true;
        arrived_ = host_.now();
      });
}

/// libfreenect's read waits without a limit and cannot be broken off: only another process reads
/// on. The host waits for the job even at its end, so that the launcher ends it, for its silence.
void KinectComponent::watch_reading() {
  const auto lasts = host_.now() - read_at_;
  if (lasts > kHang) host_.fault("the Kinect hangs: a read takes over 5 s");
  if (lasts > kSilence)
    host_.health().set(HealthState::kDegraded, "the Kinect is silent: a read takes over 0.3 s");
}

/// When what was read last was measured: an image of before the read began may have waited for it.
runtime::Time KinectComponent::measured() {
  return runtime::Time(came_at(job_->stamps, arrived_.time_since_epoch(), clock_)) - kOnItsWay;
}

/// Publishes the frame that was read, when its time has come.
void KinectComponent::take_frame() {
  if (!ready_) return;
  if (job_->recording) {
    const double due = job_->recording->time(job_->index);
    if (runtime::seconds(host_.now() - started_) < due) return;
    ++job_->index;
  }
  ready_ = false;
  if (!job_->error.empty()) {
    ++rejected_;
    host_.health().set(HealthState::kDegraded, job_->error);
    if (live_) again_ = host_.now() + kAgain;
    clock_.reset();
    return;
  }
  const runtime::Time stamp = live_ ? measured() : host_.now();
  // Whoever has the depths of a moment has its colors, too.
  if (!job_->rectified_color.rgb.empty()) publisher_.publish(stamp, job_->rectified_color);
  publisher_.publish(stamp, job_->rectified);
  host_.health().set(HealthState::kOk);
}

}  // namespace usher::kinect
