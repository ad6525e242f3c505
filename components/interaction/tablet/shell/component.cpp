#include "interaction/tablet/shell/component.hpp"

#include "interaction/phrases/shell/read_phrases.hpp"
#include "wire/conversions.hpp"
#include "wire/own_stop.hpp"

namespace usher::tablet {

namespace {

using std::chrono::milliseconds;
namespace command = usher_msgs::msg::SupervisorRequest_Constants;
namespace speech_state = usher_msgs::msg::SpeechStatus_Constants;

constexpr auto kRobotAge = milliseconds(1500);
constexpr auto kDialogueAge = milliseconds(3000);
constexpr auto kLocalizationAge = milliseconds(2000);
constexpr auto kStep = milliseconds(20);  ///< a touch waits no longer
constexpr const char* kHeldKey = "held";
constexpr std::uint64_t kShowEvery = 5;
constexpr int kMapMargin = 10;         ///< [cells]
constexpr double kRouteDetail = 0.05;  ///< [m]

}  // namespace

TabletComponent::TabletComponent(runtime::Host& host)
    : TabletComponent(host, std::make_unique<NullWindow>(), nullptr) {}
TabletComponent::TabletComponent(runtime::Host& host, Window& window)
    : TabletComponent(host, nullptr, &window) {}

TabletComponent::TabletComponent(runtime::Host& host, std::unique_ptr<Window> own, Window* window)
    : host_(host),
      own_window_(std::move(own)),
      window_(own_window_ ? *own_window_ : *window),
      core_(phrases::read_phrases(host, "tablet", kTextKeys)),
      titles_(phrases::read_place_titles(host)),
      rejected_(host.health().counter("inputs: rejected")),
      memory_(host, kHeldKey),
      answers_(host, topics::kDialogueAnswer),
      requests_(host, topics::kSupervisorRequest) {
  auto& parameters = host.parameters();
  Window::Settings settings;
  settings.full_screen = parameters.flag("full_screen", true, "Covers the whole display.");
  settings.pictures = parameters.text(
      "pictures", "", "Folder for a picture of every screen that is passed; empty = none.");
  open_finger(parameters.text("finger", "",
                              "Where a simulated visitor's finger touches the screen, for example "
                              "listen://127.0.0.1:7431; empty = nowhere."));
  screen_ = host.input(topics::kDialogueScreen, {},
                       [this](const auto& screen, const auto&) { take_screen(screen); });
  guide_ = host.input(
      topics::kGuideStatus,
      {.max_age = kDialogueAge, .on_loss = "asks for a moment; Stop still works", .optional = true},
      [this](const auto& status, const auto&) {
        const auto* supervisor = supervisor_.latest();
        const bool navigates = supervisor != nullptr && !supervisor->current_goal().empty();
        act(core_.hear_visit(status.serves(), navigates, now()));
      },
      [this] { show(); });
  meeting_ = host.input(
      topics::kMeetingStatus,
      {.max_age = kDialogueAge, .on_loss = "asks for a moment; Stop still works", .optional = true},
      [this](const auto&, const auto&) { show(); }, [this] { show(); });
  speech_ = host.input(
      topics::kSpeechStatus,
      {.max_age = kDialogueAge,
       .on_loss = "shows no question back; answers by touch go on",
       .optional = true},
      [this](const auto&, const auto&) { show(); }, [this] { show(); });
  supervisor_ = host.input(
      topics::kSupervisorStatus,
      {.max_age = kRobotAge, .on_loss = "says that the robot is out of reach"},
      [this](const auto& status, const auto&) { take_supervisor(status); }, [this] { show(); });
  map_ = host.input(topics::kMap, {.optional = true},
                    [this](const auto& map, const auto&) { take_map(map); });
  pose_ = host.input(topics::kAmclPose, {.optional = true});
  localization_ =
      host.input(topics::kLocalizationStatus, {.max_age = kLocalizationAge,
                                               .on_loss = "shows the map without the robot",
                                               .optional = true});
  plan_ = host.input(topics::kPlan, {.optional = true},
                     [this](const auto& path, const auto&) { take_plan(path); });
  locations_ =
      host.input(topics::kLocations, {.optional = true},
                 [this](const auto& locations, const auto&) { take_locations(locations); });
  timer_ = host.timer("step", kStep, [this](auto) { tick(); });
  if (!memory_.found().empty()) core_.hold_again();
  window_.open(settings);
  show();
}

void TabletComponent::open_finger(const std::string& address) {
  if (address.empty()) return;
  host_.open_stream(address, {.on_open = [this] { finger_.restart(); },
                              .on_bytes =
                                  [this](std::span<const std::uint8_t> bytes) {
                                    const std::uint64_t before = finger_.rejected();
                                    for (const auto& tap : finger_.take(bytes)) window_.tap(tap);
                                    rejected_ += finger_.rejected() - before;
                                  }});
}

void TabletComponent::take_screen(const usher_msgs::msg::DialogueScreen& screen) {
  if (answers_.answered(screen.answer_id(), screen.answer_client())) core_.replied();
  if (screen.language() != language_) {
    language_ = screen.language();
    if (const auto* locations = locations_.latest()) take_locations(*locations);
  }
  Screen taken;
  taken.id = screen.id();
  taken.state = screen.state();
  taken.language = screen.language();
  taken.content = screen.content();
  taken.title = screen.title();
  taken.text = screen.text();
  taken.status = screen.status();
  for (const auto& option : screen.options()) {
    taken.options.push_back(
        {option.id(), option.label(), option.kind(), option.panel(), option.takes_text()});
  }
  taken.place = screen.place();
  taken.progress = screen.progress();
  taken.eta = screen.eta();
  taken.remaining = screen.remaining();
  taken.time_left = screen.time_left();
  act(core_.take(taken, now()));
}

void TabletComponent::take_supervisor(const usher_msgs::msg::SupervisorStatus& status) {
  requests_.answered(status.last_request(), status.last_request_client());
  const auto holds = wire::own_stop(status, host_.name(), requests_);
  if (holds && core_.hear_stop(*holds, now())) act({});
}

void TabletComponent::take_map(const nav_msgs::msg::OccupancyGrid& map) {
  const auto grid = wire::from_message(map);
  if (!grid) {
    ++rejected_;
    return;
  }
  window_.show_building(draw_floor_plan(*grid, kMapMargin));
}

void TabletComponent::take_plan(const nav_msgs::msg::Path& path) {
  std::vector<geometry::Point2> points;
  if (const auto poses = wire::from_message(path)) {
    for (const auto& pose : *poses) points.push_back(pose.position());
  }
  window_.show_route(simplified(points, kRouteDetail));
}

void TabletComponent::take_locations(const usher_msgs::msg::Locations& locations) {
  std::vector<Place> places;
  for (const auto& location : locations.locations()) {
    const auto& at = location.pose().position();
    std::string title = location.title();
    if (const auto place = titles_.find(location.name()); place != titles_.end()) {
      if (const auto own = place->second.find(language_); own != place->second.end())
        title = own->second;
    }
    places.push_back({location.name(), std::move(title), {at.x(), at.y()}});
  }
  window_.show_places(places);
}

void TabletComponent::ask(std::uint8_t what) {
  usher_msgs::msg::SupervisorRequest request;
  request.id(requests_.next_id());
  request.command(what);
  requests_.give_up();  // the newest touch is what counts
  requests_.ask(std::move(request));
}

void TabletComponent::act(const Touched& touched) {
  if (touched.stop) ask(command::COMMAND_STOP);
  if (touched.move) ask(command::COMMAND_MOVEMENT_ON);
  if (touched.answer) {
    usher_msgs::msg::DialogueAnswer answer;
    answer.id(answers_.next_id());
    answer.screen_id(touched.answer->screen_id);
    answer.option_id(touched.answer->option_id);
    answer.text(touched.answer->text);
    answer.input(usher_msgs::msg::DialogueAnswer_Constants::INPUT_TOUCH);
    answers_.give_up();
    answers_.ask(std::move(answer));
  }
  memory_.keep(core_.holds() ? kHeldKey : "");
  show();
}

void TabletComponent::tick() {
  for (const auto& touch : window_.take_touches()) {
    act(touch.typed ? core_.type(touch.text) : core_.touch(touch.text, now()));
  }
  if (++ticks_ % kShowEvery != 0) return;
  show();
  using runtime::HealthState;
  const std::string reason = supervisor_.fresh() == nullptr ? "the robot is out of reach"
                             : !dialogue()                  ? "nobody leads the dialogue"
                                                            : window_.hidden();
  host_.health().set(reason.empty() ? HealthState::kOk : HealthState::kDegraded, reason);
}

void TabletComponent::show() {
  core_.hear(supervisor_.fresh() != nullptr, dialogue(), now());
  const auto* speech = speech_.fresh();
  core_.hear_speech(speech != nullptr ? speech->hint() : "",
                    speech != nullptr && speech->state() == speech_state::STATE_ASKING);
  std::optional<geometry::Pose2> pose;
  const auto* localization = localization_.fresh();
  if (localization != nullptr && pose_.latest() != nullptr &&
      localization->state() != usher_msgs::msg::LocalizationStatus_Constants::STATE_LOST) {
    if (const auto planar = wire::to_planar(pose_.latest()->pose().pose())) pose = *planar;
  }
  core_.locate(pose);
  View view = core_.view(now());
  if (view == shown_) return;
  shown_ = std::move(view);
  window_.show(shown_);
}

}  // namespace usher::tablet
