// Every screen of the dialogue in every language, drawn as the tablet draws it. The pictures are
// kept in the build folder (tablet_screens/); a cut text, an overlap or a button that is too small
// fails.
#include <gtest/gtest.h>

#include <QDir>
#include <QGuiApplication>
#include <QImage>
#include <QQmlEngine>
#include <QQuickItem>
#include <QQuickView>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

#include "foundation/grid/map_file.hpp"
#include "interaction/tablet/core/tablet.hpp"
#include "interaction/tablet/window/place_names_item.hpp"
#include "interaction/tablet/window/screen_model.hpp"
#include "tasks/guide/core/guide.hpp"
#include "tasks/meeting/test/meeting_rig.hpp"

extern void qml_register_types_Usher_Tablet();

namespace usher {
namespace {

using std::chrono::milliseconds;

const std::string kTexts = USHER_SOURCE_DIR "/config/dialogue";
const std::vector<std::string> kLanguages{"en", "mi", "de", "fr"};
constexpr double kMapShare = 0.28;  ///< of a page of 3:2; the building is 1.4 times as wide as high
constexpr int kAcrossWalls = 10;    ///< names, of 16: letters that can be read are wider than rooms
constexpr std::array<std::string_view, 3> kSpeechTexts{"did_you_say", "by_touch", "held"};

/// The places of the office, with the longest names that a building might have among them.
std::vector<guide::Location> office() {
  return {{"foyer", "Foyer", {4.5, 4.5}},
          {"reception", "Reception", {10.2, 4.6}},
          {"electronics_lab",
           "Electronics lab",
           {24.5, 15.2},
           {{"de", "Elektroniklabor"}, {"fr", "Électronique"}}},
          {"meeting_room",
           "Meeting room",
           {16.0, 7.4},
           {{"de", "Besprechungsraum"}, {"fr", "Salle de réunion"}, {"mi", "Rūma hui"}}},
          {"kitchen", "Kitchen", {21.5, 6.6}},
          {"robotics_lab", "Robotics lab", {26.6, 6.8}},
          {"library", "Library", {7.0, 12.6}, {{"de", "Bibliothek"}, {"mi", "Whare pukapuka"}}},
          {"office_201", "Office 201", {14.2, 12.8}, {{"de", "Büro 201"}, {"mi", "Tari 201"}}},
          {"seminar_room",
           "Seminar room",
           {19.6, 20.6},
           {{"de", "Seminarraum"}, {"fr", "Salle de séminaire"}}},
          {"workshop", "Workshop", {8.4, 18.4}, {{"de", "Werkstatt"}, {"fr", "Atelier"}}},
          {"office_202", "Office 202", {19.2, 12.7}, {{"de", "Büro 202"}, {"mi", "Tari 202"}}},
          {"vision_lab", "Vision lab", {13.5, 20.8}, {{"de", "Bildlabor"}, {"fr", "Vision"}}},
          {"office_203", "Office 203", {24.6, 20.6}, {{"de", "Büro 203"}, {"mi", "Tari 203"}}},
          {"office_204", "Office 204", {30.6, 11.5}, {{"de", "Büro 204"}, {"mi", "Tari 204"}}},
          {"print_room", "Print room", {30.8, 15.6}, {{"de", "Druckerraum"}}},
          {"lounge", "Lounge", {30.4, 21.4}, {{"fr", "Salon"}}}};
}

tablet::Screen to_tablet(const guide::Screen& screen) {
  tablet::Screen out;
  out.id = screen.id;
  out.state = screen.state;
  out.language = screen.language;
  out.content = static_cast<std::uint8_t>(screen.content);
  out.title = screen.title;
  out.text = screen.text;
  out.status = screen.status;
  for (const auto& option : screen.options) {
    out.options.push_back({option.id, option.label, static_cast<std::uint8_t>(option.kind),
                           static_cast<std::uint8_t>(option.panel), option.takes_text});
  }
  out.place = screen.place;
  out.progress = screen.progress;
  out.eta = screen.eta;
  out.remaining = screen.remaining;
  out.time_left = screen.time_left;
  return out;
}

/// A visit through every screen; `shown` is called at each.
class Visit {
 public:
  Visit(const std::string& language, std::function<void(const guide::Screen&, const char*)> shown)
      : shown_(std::move(shown)),
        guide_(with_questionnaire(),
               *phrases::PhraseBook::load(kTexts, kLanguages, "guide", guide::kTextKeys), 1, {},
               {}) {
    EXPECT_TRUE(guide_.set_locations(office(), {}).ok());
    around_.pose = geometry::Pose2{10.0, 5.0, 0.5};
    around_.navigation = guide::Navigation{};
    show("");
    around_.supervisor = guide::Supervisor::kAvailable;
    wait(100), show("");
    press("language:" + language), show("");
    wait(3000), show("");
    press("yes"), show("");
    press("where_is"), show("");
    press("electronics_lab"), show("-place");
    press("done"), show("");
    wait(41000), show("-still_there");
    around_.visitor = guide::VisitorSighting{true, 1.2, 0.0, 0.0};
    wait(100), press("where_is"), press("cancel"), show("-somebody_seen");
    press("follow_me"), show("");
    around_.visitor = guide::VisitorSighting{};
    wait(1500), show("-come_back");
    around_.visitor.reset();
    press("done"), press("yes"), press("no"), press("yes"), show("");
    press("more"), show("-page_2");
    press("more"), show("-last_page");
    press("search"), show("-search");
    press("back"), press("electronics_lab"), show("");
    press("start"), show("");
    around_.supervisor = guide::Supervisor::kNavigation;
    wait(1000);
    around_.navigation =
        guide::Navigation{guide_.memory().goal_id, GoalState::kActive, 0.4, 147.0, 105.0};
    wait(6000), show("-way");
    around_.navigation->blocked = true;
    wait(3200), show("-excuse_me");
    around_.navigation->blocked = false;
    around_.visitor = guide::VisitorSighting{true, -5.0, 0.0, 0.0};
    wait(200), show("-waiting_for_you");
    around_.visitor = guide::VisitorSighting{true, -1.0, 0.0, 0.0};
    wait(1500);
    press("stop"), show("");
    press("continue"), wait(1100);
    around_.navigation->state = GoalState::kFailed;
    wait(100), show("");
    press("yes"), press("foyer"), press("start");
    wait(1000);
    around_.navigation = guide::Navigation{guide_.memory().goal_id, GoalState::kSucceeded};
    wait(100), show("");
    around_.supervisor = guide::Supervisor::kAvailable;
    wait(4000), show("");
    around_.speech = guide::Speech{~0ULL, true, true};
    around_.torso = true;
    wait(100);
    press("no"), show("");
    for (int i = 1; i <= 12; ++i) press("rating:3"), show(("-" + std::to_string(i + 1)).c_str());
    press("rating:3"), show("");
  }

 private:
  static guide::Parameters with_questionnaire() {
    guide::Parameters parameters;
    parameters.questionnaire = true;
    parameters.introduction = std::chrono::seconds(3);
    return parameters;
  }
  void wait(int ms) {
    for (const int end = now_ + ms; now_ < end;) guide_.step(around_, milliseconds(now_ += 100));
  }
  void press(const std::string& id) {
    guide_.answer({guide_.screen().id, id, "", guide::Input::kTouch}, milliseconds(now_));
    EXPECT_EQ(guide_.last_result(), guide::AnswerResult::kDone)
        << id << " in " << guide_.screen().state;
  }
  void show(const char* suffix) { shown_(guide_.screen(), suffix); }

  std::function<void(const guide::Screen&, const char*)> shown_;
  guide::Guide guide_;
  guide::Surroundings around_;
  int now_ = 0;
};

/// The assistant in each of its states.
void show_meeting(std::size_t language, const std::function<void(const service::Screen&)>& shown) {
  using meeting::Rig;
  void (*const ways[])(Rig&) = {
      [](Rig& r) { r.robot.sees = false, r.wait(100); },
      [](Rig& r) { r.wait(100); },
      [](Rig& r) { r.to_room(12); },
      [](Rig& r) { r.to_scan(12); },
      [](Rig& r) { r.to_check_room(); },
      [](Rig& r) { r.to_explore(12); },
      [](Rig& r) { r.to_check_face(); },
      [](Rig& r) { r.to_revisit(); },
      [](Rig& r) { r.to_approach(12); },
      [](Rig& r) { r.to_invite(12); },
      [](Rig& r) { r.to_guide(12); },
      [](Rig& r) { r.to_look_back(12); },
      [](Rig& r) { r.to_arrived(12); },
      [](Rig& r) { r.to_arrived(), r.wait(3000); },
      [](Rig& r) { r.to_guide(12), r.note(r.meeting.cancel(0, r.now())); }};
  for (const auto& way : ways) {
    Rig rig({}, meeting::rooms(), language);
    rig.meeting.set_places({{"west", "Large meeting room 1", {2.0, 2.0}},
                            {"east", "Large meeting room 2", {18.0, 8.0}}});
    way(rig);
    auto screen = rig.meeting.screen();
    if (rig.state() == meeting::State::kGuide) {  // what the shell adds
      screen.progress = 0.4;
      screen.remaining = 28.0;
      screen.eta = 43.0;
    }
    shown(screen);
  }
}

class Screens : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    qputenv("QT_QPA_PLATFORM", "offscreen");
    qputenv("QT_QUICK_BACKEND", "software");
    static int argc = 1;
    static char name[] = "screens_test";
    static char* argv[] = {name, nullptr};
    static const auto* const application = new QGuiApplication(argc, argv);  // as the process
    static_cast<void>(application);
    qml_register_types_Usher_Tablet();
  }

  void SetUp() override {
    view_ = std::make_unique<QQuickView>();
    view_->engine()->addImportPath("qrc:/");
    view_->setResizeMode(QQuickView::SizeRootObjectToView);
    view_->setInitialProperties({{"model", QVariant::fromValue(&model_)}, {"animate", false}});
    view_->setSource(QUrl("qrc:/Usher/Tablet/Kiosk.qml"));
    ASSERT_EQ(view_->status(), QQuickView::Ready)
        << view_->errors().value(0).toString().toStdString();
    resize(1080, 720);
    view_->show();
    const auto map = grid::load_map(USHER_SOURCE_DIR "/config/sites/office/map.yaml");
    ASSERT_TRUE(map.ok()) << map.error();
    model_.show_building(tablet::draw_floor_plan(*map, 10));
    show_places("en");
    model_.show_route({{10, 5}, {10, 10}, {28, 10}, {28, 18}, {24.5, 18}, {24.5, 15.2}});
  }
  void show_places(const std::string& language) {
    std::vector<tablet::Place> places;
    for (const auto& each : office()) places.push_back({each.name, each.label(language), each.at});
    model_.show_places(places);
  }
  void resize(int width, int height) {
    view_->resize(width, height);
    settle();
  }
  void settle() {
    for (int i = 0; i < 4; ++i) QCoreApplication::processEvents(QEventLoop::AllEvents, 20);
  }
  void draw(const tablet::View& view) {
    model_.show(view);
    settle();
  }
  QImage picture() { return view_->grabWindow(); }

  static QRectF scene(const QQuickItem* item) {
    return item->mapRectToScene(QRectF(0, 0, item->width(), item->height()));
  }
  static void collect(QQuickItem* item, std::vector<QQuickItem*>& out) {
    if (!item->isVisible() || item->opacity() <= 0.0) return;
    out.push_back(item);
    for (QQuickItem* child : item->childItems()) collect(child, out);
  }

  /// Whether all that is visible has room, and nothing lies on anything else.
  void judge(const std::string& what) {
    SCOPED_TRACE(what);
    static_cast<void>(picture());  // everything is laid out now
    std::vector<QQuickItem*> items;
    collect(view_->rootObject(), items);
    const QRectF window(0, 0, view_->width(), view_->height());
    const double u =
        std::min(window.width() / tablet::Sizes::kWidth, window.height() / tablet::Sizes::kHeight);
    std::vector<std::pair<std::string, QRectF>> solid;
    for (QQuickItem* item : items) {
      const std::string name = item->objectName().toStdString();
      const QRectF box = scene(item);
      const QString type = item->metaObject()->className();
      if (type.startsWith("QQuickText")) {
        const QString text = item->property("text").toString();
        if (text.isEmpty()) continue;
        EXPECT_FALSE(item->property("truncated").toBool()) << "cut: " << text.toStdString();
        EXPECT_LE(item->property("contentWidth").toDouble(), item->width() + 1.0)
            << text.toStdString();
        EXPECT_LE(item->property("contentHeight").toDouble(), item->height() + 1.0)
            << text.toStdString();
        EXPECT_TRUE(window.adjusted(-1, -1, 1, 1).contains(box))
            << "outside: " << text.toStdString();
        if (name == "title") {
          EXPECT_GE(item->property("font").value<QFont>().pixelSize(),
                    std::floor(tablet::Sizes::kTitle * u));
        }
        if (name == "title" || name == "body" || name == "status" || name == "timeLeft" ||
            name == "way" || name == "typed")
          solid.emplace_back(text.toStdString(), box);
      }
      if (name.starts_with("button:") || name.starts_with("key:")) {
        solid.emplace_back(name, box);
        EXPECT_TRUE(window.adjusted(-1, -1, 1, 1).contains(box)) << "outside: " << name;
      }
      if (name == "floorPlan" || name == "timeBar") solid.emplace_back(name, box);
      if (name.starts_with("button:")) {
        EXPECT_GE(box.width(), tablet::Sizes::kButtonWidth * u - 1.0) << name;
        EXPECT_GE(box.height(), tablet::Sizes::kButtonHeight * u - 1.0) << name;
        EXPECT_FALSE(item->property("cut").toBool()) << name << " is too narrow for its label";
        if (name == "button:languages") judge_globe(*item, u);
      }
    }
    for (std::size_t i = 0; i < solid.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const QRectF both = solid[i].second.intersected(solid[j].second);
        EXPECT_FALSE(both.width() > 1.0 && both.height() > 1.0)
            << solid[i].first << " lies on " << solid[j].first;
      }
    }
    for (const QQuickItem* item : items) {
      if (const auto* names = qobject_cast<const tablet::PlaceNamesItem*>(item))
        judge_map(*names, u);
    }
  }

  /// Drawn, and not on the word beside it.
  void judge_globe(const QQuickItem& button, double u) {
    const auto* globe = button.findChild<QQuickItem*>("globe");
    ASSERT_TRUE(globe != nullptr && globe->isVisible());
    const QRect box = scene(globe).toAlignedRect();
    EXPECT_GE(box.width(), 80.0 * u);
    const QImage sign = picture().copy(box);
    int ink = 0;
    for (int y = 0; y < sign.height(); ++y) {
      for (int x = 0; x < sign.width(); ++x) ink += qGray(sign.pixel(x, y)) < 100 ? 1 : 0;
    }
    EXPECT_NEAR(ink, 0.35 * box.width() * box.height(), 0.2 * box.width() * box.height());
    const QList<QQuickItem*> parts = button.childItems();
    for (const QQuickItem* part : parts) {
      if (!QString(part->metaObject()->className()).startsWith("QQuickText")) continue;
      const double free = (part->width() - part->property("contentWidth").toDouble()) / 2;
      EXPECT_GE(scene(part).left() + free, scene(globe).right());
    }
  }

  /// The map is most of what the page has room for, and its names can be read.
  void judge_map(const tablet::PlaceNamesItem& names, double u) {
    EXPECT_GE(names.width() * names.height(),
              kMapShare * tablet::Sizes::kWidth * u * tablet::Sizes::kHeight * u);
    const auto* title = view_->rootObject()->findChild<QQuickItem*>("title");
    EXPECT_LE(title->property("lineCount").toInt(), 2)
        << title->property("text").toString().toStdString();
    const QRectF map(0, 0, names.width(), names.height());
    const auto places = names.places();
    std::vector<QRectF> apart;
    int across_walls = 0;
    for (const auto& name : names.names()) {
      const QRectF box = name.box();
      apart.push_back(box);
      across_walls += name.stands.crosses_wall ? 1 : 0;
      EXPECT_GE(box.height(), tablet::Sizes::kMapName * u - 1.0);
      EXPECT_TRUE(map.contains(box)) << name.text.toStdString();
      EXPECT_TRUE(std::none_of(places.begin(), places.end(),
                               [&](const QPointF& place) { return box.contains(place); }))
          << name.text.toStdString() << " on another place";
    }
    EXPECT_GE(apart.size(), model_.places().size() * 3 / 4) << "too few names find room";
    EXPECT_LE(across_walls, kAcrossWalls);
    const auto* here = names.parentItem()->findChild<QQuickItem*>("here");
    if (here->isVisible()) apart.push_back(box_of(*here));
    for (std::size_t i = 0; i < apart.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j)
        EXPECT_FALSE(apart[i].intersects(apart[j])) << "name " << j;
    }
  }
  static QRectF box_of(const QQuickItem& item) {
    return {item.x(), item.y(), item.width(), item.height()};
  }

  tablet::ScreenModel model_;
  std::unique_ptr<QQuickView> view_;
};

TEST_F(Screens, HaveRoomForEveryTextInEveryLanguage) {
  const QString folder = USHER_BINARY_DIR "/tablet_screens";
  QDir().mkpath(folder);
  std::set<std::string> states;
  for (const std::string& language : kLanguages) {
    tablet::Tablet tablet(
        *phrases::PhraseBook::load(kTexts, kLanguages, "tablet", tablet::kTextKeys));
    tablet.hear(true, true, {});
    tablet.locate(geometry::Pose2{10.0, 5.0, 0.5});
    show_places(language);
    int number = 0;
    tablet::Screen paused, hurries;  // what the status has to share its line with
    Visit visit(language, [&](const guide::Screen& screen, const char* suffix) {
      static_cast<void>(tablet.take(to_tablet(screen), {}));
      states.insert(screen.state);
      if (screen.state == "guide_paused") paused = to_tablet(screen);
      if (std::string(suffix) == "-still_there") hurries = to_tablet(screen);
      ++number;
      const std::string name = language + "-" + (number < 10 ? "0" : "") + std::to_string(number) +
                               "-" + screen.state + suffix;
      for (const auto& [width, height] :
           {std::pair{1280, 800}, std::pair{2160, 1440}, std::pair{1080, 720}}) {
        resize(width, height);
        draw(tablet.view({}));
        judge(name + " at " + std::to_string(width));
      }
      EXPECT_TRUE(picture().save(folder + "/" + QString::fromStdString(name) + ".png"));
    });
    tablet.hear(false, false, {});
    draw(tablet.view({}));
    judge(language + " away");
    EXPECT_TRUE(picture().save(folder + "/" + QString::fromStdString(language) + "-90-away.png"));
    tablet.hear(true, true, {});
    static_cast<void>(tablet.take(hurries, {}));
    static_cast<void>(tablet.touch(tablet::Tablet::kStop, {}));
    draw(tablet.view({}));
    judge(language + " held");
    EXPECT_TRUE(picture().save(folder + "/" + QString::fromStdString(language) + "-91-held.png"));
    static_cast<void>(tablet.take(paused, {}));
    draw(tablet.view({}));
    judge(language + " just stopped");
    EXPECT_TRUE(
        picture().save(folder + "/" + QString::fromStdString(language) + "-92-just_stopped.png"));
    static_cast<void>(tablet.take(hurries, {}));
    static_cast<void>(tablet.touch(tablet::Tablet::kStart, tablet::Tablet::kCalms));
    const auto said = *phrases::PhraseBook::load(kTexts, kLanguages, "speech", kSpeechTexts);
    for (const std::size_t text : {1U, 2U}) {
      tablet.hear_speech(said.phrase(said.find(language), text), false);
      draw(tablet.view({}));
      judge(language + ", what speech has to say");
    }
  }
  EXPECT_EQ(states.size(), static_cast<std::size_t>(guide::State::kEnd) + 1) << "every state";
}

TEST_F(Screens, OfTheMeetingAssistantHaveRoomInEveryLanguage) {
  const QString folder = USHER_BINARY_DIR "/tablet_screens";
  QDir().mkpath(folder);
  for (std::size_t language = 0; language < kLanguages.size(); ++language) {
    tablet::Tablet tablet(
        *phrases::PhraseBook::load(kTexts, kLanguages, "tablet", tablet::kTextKeys));
    tablet.hear(true, true, {});
    tablet.locate(geometry::Pose2{10.0, 5.0, 0.5});
    show_places(kLanguages[language]);
    std::set<std::string> states;
    show_meeting(language, [&](const service::Screen& screen) {
      static_cast<void>(tablet.take(to_tablet(screen), {}));
      EXPECT_TRUE(states.insert(screen.state).second) << screen.state;
      const std::string name = kLanguages[language] + "-meeting-" + screen.state;
      for (const auto& [width, height] : {std::pair{1280, 800}, std::pair{1080, 720}}) {
        resize(width, height);
        draw(tablet.view({}));
        judge(name + " at " + std::to_string(width));
      }
      EXPECT_TRUE(picture().save(folder + "/" + QString::fromStdString(name) + ".png"));
    });
    EXPECT_EQ(states.size(), meeting::kStates);
  }
}

TEST_F(Screens, TitleTheMapInTwoLinesWhateverThePlace) {
  const auto phrases = *phrases::PhraseBook::load(kTexts, kLanguages, "guide", guide::kTextKeys);
  for (std::size_t language = 0; language < kLanguages.size(); ++language) {
    show_places(kLanguages[language]);
    for (const auto& place : office()) {
      tablet::View view;
      view.page = tablet::Page::kMap;
      view.place = place.name;
      view.title = phrases::filled(
          phrases.phrase(language, static_cast<std::size_t>(guide::Text::kPlaceShow)),
          {{"place", place.label(kLanguages[language])}});
      draw(view);
      judge(view.title);
    }
  }
}

TEST_F(Screens, KeepTheNamesOfPlacesWhereTheyAreWhileTheRobotMoves) {
  tablet::View view;
  view.page = tablet::Page::kJourney;
  view.place = "electronics_lab";
  view.title = "?";
  view.located = true;
  view.robot = {10.0, 5.0, 0.0};
  draw(view);
  const auto* names = view_->rootObject()->findChild<tablet::PlaceNamesItem*>("placeNames");
  const auto boxes = [&] {
    static_cast<void>(picture());  // everything is laid out now
    std::vector<QRectF> out;
    for (const auto& name : names->names()) out.push_back(name.box());
    return out;
  };
  const auto before = boxes();
  ASSERT_FALSE(before.empty());
  const QQuickItem* robot = view_->rootObject()->findChild<QQuickItem*>("robot");
  for (double x = 10.0; x < 30.0; x += 0.5) {
    view.robot = {x, 10.0, 0.0};
    model_.show_route({{x, 10}, {28, 10}, {28, 18}, {24.5, 18}, {24.5, 15.2}});
    draw(view);
    EXPECT_EQ(boxes(), before) << "the robot at " << x;
  }
  const QList<QQuickItem*> drawn = names->parentItem()->childItems();
  EXPECT_GT(drawn.indexOf(const_cast<tablet::PlaceNamesItem*>(names)),
            drawn.indexOf(const_cast<QQuickItem*>(robot)))
      << "names lie over the robot";
  resize(2160, 1440);
  draw(view);
  EXPECT_NE(boxes(), before) << "another zoom";
}

/// How soon, `usher bench tablet` measures.
TEST_F(Screens, ShowATouchAndPassItOn) {
  tablet::View view;
  view.page = tablet::Page::kButtons;
  view.title = "?";
  view.primary = {{"yes", "Yes", tablet::Kind::kYes}, {"no", "No", tablet::Kind::kNo}};
  draw(view);
  std::vector<std::string> pressed;
  model_.on_press = [&](const std::string& id) { pressed.push_back(id); };
  std::vector<QQuickItem*> items;
  collect(view_->rootObject(), items);
  const auto yes = std::find_if(items.begin(), items.end(), [](const QQuickItem* item) {
    return item->objectName() == "button:yes";
  });
  ASSERT_NE(yes, items.end());
  const QPointF at = scene(*yes).center();
  const auto mouse = [&](QEvent::Type type) {
    QMouseEvent event(type, at, at, Qt::LeftButton,
                      type == QEvent::MouseButtonPress ? Qt::LeftButton : Qt::NoButton, {});
    QCoreApplication::sendEvent(view_.get(), &event);
  };
  const QImage before = picture();
  mouse(QEvent::MouseButtonPress);
  settle();
  EXPECT_NE(picture(), before) << "the button shows that it is touched";
  mouse(QEvent::MouseButtonRelease);
  settle();
  EXPECT_EQ(pressed, std::vector<std::string>{"yes"});
}

}  // namespace
}  // namespace usher
