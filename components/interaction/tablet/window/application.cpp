#include "interaction/tablet/window/application.hpp"

#include <QDir>
#include <QGuiApplication>
#include <QImage>
#include <QQmlApplicationEngine>
#include <QQuickWindow>
#include <QTimer>
#include <chrono>
#include <csignal>
#include <mutex>
#include <thread>

#include "interaction/tablet/window/screen_model.hpp"

extern void qml_register_types_Usher_Tablet();

namespace usher::tablet {

namespace {

constexpr auto kSettled = std::chrono::milliseconds(400);  ///< a screen has been drawn by then

constexpr std::size_t kMostTouches = 64;  ///< between two questions of the component

/// Without a session Qt would end the program; without a graphics driver it draws by itself.
void choose_platform() {
  const bool session =
      qEnvironmentVariableIsSet("DISPLAY") || qEnvironmentVariableIsSet("WAYLAND_DISPLAY");
  if (!session && !qEnvironmentVariableIsSet("QT_QPA_PLATFORM")) {
    qputenv("QT_QPA_PLATFORM", "offscreen");
  }
  if (qgetenv("QT_QPA_PLATFORM") == "offscreen" && !qEnvironmentVariableIsSet("QT_QUICK_BACKEND")) {
    qputenv("QT_QUICK_BACKEND", "software");
  }
}

}  // namespace

class Application::Implementation final : public Window {
 public:
  Implementation(int& argc, char** argv) : application(argc, argv) {
    qml_register_types_Usher_Tablet();
    engine.addImportPath("qrc:/");
    engine.setInitialProperties({{"model", QVariant::fromValue(&model)}});
    engine.load(QUrl("qrc:/Usher/Tablet/Main.qml"));
    if (!engine.rootObjects().isEmpty()) {
      display = qobject_cast<QQuickWindow*>(engine.rootObjects().constFirst());
    }
    model.on_press = [this](const std::string& id) { touched({false, id}); };
    model.on_typed = [this](const std::string& text) { touched({true, text}); };
    picture_timer.setSingleShot(true);
    picture_timer.setInterval(kSettled);
    QObject::connect(&picture_timer, &QTimer::timeout, &model, [this] { take_picture(); });
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
      const bool another =
          view.screen_id != model.view().screen_id || view.page != model.view().page;
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

  void touched(Touch touch) {
    const std::lock_guard lock(mutex);
    if (touches.size() < kMostTouches) touches.push_back(std::move(touch));
  }

  template <class Work>
  void later(Work work) {
    QMetaObject::invokeMethod(&model, std::move(work), Qt::QueuedConnection);
  }

  void take_picture() {
    if (display == nullptr) return;
    const QImage picture = display->grabWindow();
    const QString name = QString("%1/%2-%3.png")
                             .arg(QString::fromStdString(settings.pictures))
                             .arg(++pictures, 2, 10, QChar('0'))
                             .arg(model.state());
    picture.save(name);
  }

  std::mutex mutex;
  std::vector<Touch> touches;  ///< under the mutex
  QGuiApplication application;
  ScreenModel model;
  QQmlApplicationEngine engine;
  QQuickWindow* display = nullptr;
  Settings settings;
  QTimer picture_timer;
  int pictures = 0;
};

Application::Application(int& argc, char** argv) {
  choose_platform();
  implementation_ = std::make_unique<Implementation>(argc, argv);
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
