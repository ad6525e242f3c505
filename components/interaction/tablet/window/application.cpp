#include "interaction/tablet/window/application.hpp"

#include <QDir>
#include <QGuiApplication>
#include <QImage>
#include <QMouseEvent>
#include <QQmlApplicationEngine>
#include <QQuickItem>
#include <QQuickWindow>
#include <QTimer>
#include <chrono>
#include <csignal>
#include <deque>
#include <mutex>
#include <thread>

#include "interaction/tablet/window/screen_model.hpp"

extern void qml_register_types_Usher_Tablet();

namespace usher::tablet {

namespace {

constexpr auto kSettled = std::chrono::milliseconds(400);  ///< a screen has been drawn by then

constexpr int kMostPictures = 999;

constexpr std::size_t kMostTouches = 64;  ///< between two questions of the component

constexpr std::size_t kMostTaps = 64;                      ///< that wait for the finger
constexpr auto kTapLasts = std::chrono::milliseconds(80);  ///< of a person's finger
/// Frames after which a view has been drawn: the first may have been on its way already.
constexpr int kDrawn = 2;
constexpr auto kFrame = std::chrono::milliseconds(16);         ///< at 60 Hz
constexpr auto kBetweenTaps = std::chrono::milliseconds(120);  ///< and until it is there again

/// What is drawn and has this name.
QQuickItem* visible_item(QQuickItem* item, const QString& name) {
  if (!item->isVisible() || item->opacity() <= 0.0) return nullptr;
  if (item->objectName() == name) return item;
  for (QQuickItem* child : item->childItems()) {
    if (QQuickItem* found = visible_item(child, name)) return found;
  }
  return nullptr;
}

/// Without a session Qt would end the program; without a graphics driver it draws by itself.
/// Whether it found neither a session nor anybody's choice.
bool choose_platform() {
  const bool session =
      qEnvironmentVariableIsSet("DISPLAY") || qEnvironmentVariableIsSet("WAYLAND_DISPLAY");
  const bool none = !session && !qEnvironmentVariableIsSet("QT_QPA_PLATFORM");
  if (none) qputenv("QT_QPA_PLATFORM", "offscreen");
  if (qgetenv("QT_QPA_PLATFORM") == "offscreen" && !qEnvironmentVariableIsSet("QT_QUICK_BACKEND")) {
    qputenv("QT_QUICK_BACKEND", "software");
  }
  return none;
}

}  // namespace

class Application::Implementation final : public Window {
 public:
  Implementation(int& argc, char** argv, bool has_no_display)
      : no_display(has_no_display), application(argc, argv) {
    qml_register_types_Usher_Tablet();
    engine.addImportPath("qrc:/");
    engine.setInitialProperties({{"model", QVariant::fromValue(&model)}});
    engine.load(QUrl("qrc:/Usher/Tablet/Main.qml"));
    if (!engine.rootObjects().isEmpty()) {
      display = qobject_cast<QQuickWindow*>(engine.rootObjects().constFirst());
    }
    if (display != nullptr) {
      QObject::connect(display, &QQuickWindow::frameSwapped, &model, [this] {
        if (++drawn < kDrawn) display->update();
      });
    }
    model.on_press = [this](const std::string& id) { touched({false, id}); };
    model.on_typed = [this](const std::string& text) { touched({true, text}); };
    for (auto* timer : {&press_timer, &release_timer}) timer->setSingleShot(true);
    release_timer.setInterval(kTapLasts);
    QObject::connect(&release_timer, &QTimer::timeout, &model, [this] { lift_finger(); });
    QObject::connect(&press_timer, &QTimer::timeout, &model, [this] { press_next(); });
    picture_timer.setSingleShot(true);
    picture_timer.setInterval(kSettled);
    QObject::connect(&picture_timer, &QTimer::timeout, &model, [this] { take_picture(); });
  }

  std::string hidden() const override {
    return no_display
               ? "no display: draws into memory (set QT_QPA_PLATFORM=offscreen where that is meant)"
               : "";
  }
  void open(const Settings& given) override {
    later([this, given] {
      settings = given;
      if (display == nullptr) return;
      if (!settings.pictures.empty()) QDir().mkpath(QString::fromStdString(settings.pictures));
      if (settings.full_screen && QGuiApplication::platformName() != "offscreen") {
        display->showFullScreen();
      } else {
        display->show();
      }
    });
  }
  std::vector<Touch> take_touches() override {
    const std::lock_guard lock(mutex);
    return std::exchange(touches, {});
  }
  void show(const View& view) override {
    later([this, view] {
      const View& shown = model.view();
      const bool another = view.screen_id != shown.screen_id || view.page != shown.page ||
                           view.text != shown.text || view.status != shown.status;
      if (view != shown) drawn = 0;
      model.show(view);
      if (another && !settings.pictures.empty()) picture_timer.start();
    });
  }
  void show_building(const FloorPlan& plan) override {
    later([this, plan] { model.show_building(plan); });
  }
  void show_places(const std::vector<Place>& places) override {
    later([this, places] { model.show_places(places); });
  }
  void show_route(const std::vector<geometry::Point2>& route) override {
    later([this, route] { model.show_route(route); });
  }

  void tap(const finger::Tap& tap) override {
    later([this, tap] {
      if (taps.size() == kMostTaps) return;
      taps.push_back(tap);
      if (!release_timer.isActive() && !press_timer.isActive()) press_next();
    });
  }

  /// As a touch screen would tell of it: to the window, at a place.
  void point(QEvent::Type type) {
    const bool press = type == QEvent::MouseButtonPress;
    QMouseEvent event(type, finger_at, display->mapToGlobal(finger_at), Qt::LeftButton,
                      press ? Qt::LeftButton : Qt::NoButton, {});
    QCoreApplication::sendEvent(display, &event);
  }
  void press_next() {
    while (!taps.empty() && display != nullptr) {
      if (drawn < kDrawn) {  // nobody touches a button before it has its place
        display->update();
        press_timer.start(kFrame);
        return;
      }
      const finger::Tap next = taps.front();
      taps.pop_front();
      const QString name = (next.key ? "key:" : "button:") + QString::fromStdString(next.target);
      const auto* item = next.screen_id == model.view().screen_id
                             ? visible_item(display->contentItem(), name)
                             : nullptr;
      if (item == nullptr) continue;
      finger_at = item->mapRectToScene(item->boundingRect()).center();
      point(QEvent::MouseButtonPress);
      release_timer.start();
      return;
    }
  }
  void lift_finger() {
    point(QEvent::MouseButtonRelease);
    press_timer.start(kBetweenTaps);
  }

  void touched(Touch touch) {
    const std::lock_guard lock(mutex);
    if (touches.size() < kMostTouches) touches.push_back(std::move(touch));
  }

  template <class Work>
  void later(Work work) {
    QMetaObject::invokeMethod(&model, std::move(work), Qt::QueuedConnection);
  }

  void take_picture() {
    if (display == nullptr || pictures == kMostPictures) return;
    const QImage picture = display->grabWindow();
    const QString name = QString("%1/%2-%3.png")
                             .arg(QString::fromStdString(settings.pictures))
                             .arg(++pictures, 3, 10, QChar('0'))
                             .arg(model.state());
    picture.save(name);
  }

  const bool no_display;
  std::mutex mutex;
  std::vector<Touch> touches;  ///< under the mutex
  QGuiApplication application;
  ScreenModel model;
  QQmlApplicationEngine engine;
  QQuickWindow* display = nullptr;
  Settings settings;
  std::deque<finger::Tap> taps;
  QPointF finger_at;
  int drawn = 0;  ///< frames since the view changed
  QTimer press_timer, release_timer, picture_timer;
  int pictures = 0;
};

Application::Application(int& argc, char** argv) {
  const bool no_display = choose_platform();
  implementation_ = std::make_unique<Implementation>(argc, argv, no_display);
}
Application::~Application() = default;

Window& Application::window() { return *implementation_; }

int Application::run(const std::function<int()>& component) {
  if (implementation_->display == nullptr) return 2;  // Qt has said why
  int code = 0;
  std::thread thread([&] {
    code = component();
    QMetaObject::invokeMethod(&implementation_->application, &QCoreApplication::quit,
                              Qt::QueuedConnection);
  });
  QGuiApplication::setQuitOnLastWindowClosed(false);
  QObject::connect(&implementation_->application, &QGuiApplication::lastWindowClosed,
                   [] { std::raise(SIGTERM); });
  QGuiApplication::exec();
  thread.join();
  return code;
}

}  // namespace usher::tablet
